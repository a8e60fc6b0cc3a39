/* handlers_journal.c - scene.journal. */
#include "call.h"
#include "request.h"
#include "session.h"
#include "shared.h"
#include "srv_journal.h"

static int refuse(struct srv_request *request, int status)
{
    const struct proto_SCENE_JOURNAL_request *asked = &request->params.SCENE_JOURNAL;
    const char *why = status == PCCD_E_STATE ? "this session keeps a journal already"
                      : status == PCCD_E_LIMIT
                          ? "what is in the scene does not fit in so many bytes"
                          : "no memory for a journal";
    return proto_error_set(&request->error, status, "scene 0x%x: %s", asked->scene, why);
}

/* Drop what has been taken, and write a page of what comes after it. */
static int write_page(struct srv_request *request, struct srv_journal *journal)
{
    const struct proto_SCENE_JOURNAL_request *asked = &request->params.SCENE_JOURNAL;
    struct srv_page page;
    void *data = NULL;
    if (asked->cursor < journal->begin || asked->cursor > journal->end) {
        return proto_error_set(
            &request->error, PCCD_E_INVAL, "cursor is %llu, bytes %llu to %llu are kept",
            (unsigned long long)asked->cursor, (unsigned long long)journal->begin,
            (unsigned long long)journal->end);
    }
    srv_journal_forget(journal, asked->cursor);
    int status = srv_ring_reserve(request->plan.ring, 1, journal->end - asked->cursor,
                                  &page, &data, &request->error);
    if (status != 0) {
        return status;
    }
    srv_journal_copy(journal, asked->cursor, page.count, data);
    request->result.SCENE_JOURNAL =
        (struct proto_SCENE_JOURNAL_result){.cursor = asked->cursor,
                                            .count = page.count,
                                            .end = journal->end,
                                            .full = journal->status != 0,
                                            .offset = page.position,
                                            .release = page.release};
    return 0;
}

static int work_journal(struct srv_request *request)
{
    const struct proto_SCENE_JOURNAL_request *asked = &request->params.SCENE_JOURNAL;
    struct srv_scene *scene = request->plan.scene;
    if (asked->begin != 0) {
        int status = srv_journal_begin(scene, request->plan.member, asked->begin);
        if (status != 0) {
            return refuse(request, status);
        }
    }
    struct srv_journal *journal = request->plan.member->journal;
    if (journal == NULL) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "this session keeps no journal of scene 0x%x",
                               asked->scene);
    }
    if (asked->stop) {
        srv_journal_end(scene, request->plan.member);
        request->result.SCENE_JOURNAL =
            (struct proto_SCENE_JOURNAL_result){.cursor = asked->cursor};
        return 0;
    }
    int status = write_page(request, journal);
    if (status != 0 && asked->begin != 0) {
        srv_journal_end(scene,
                        request->plan.member); /* it was refused: nobody pays for it */
    }
    return status;
}

/* End the charge of what could not be begun, or has ended. */
static void finish_journal(struct srv_request *request)
{
    const struct proto_SCENE_JOURNAL_request *asked = &request->params.SCENE_JOURNAL;
    if (request->status == 0 ? asked->stop : asked->begin != 0) {
        srv_shared_refund_journal(request->plan.member);
    }
}

int srv_on_SCENE_JOURNAL(struct srv_call *call)
{
    const struct proto_SCENE_JOURNAL_request *asked = &call->params.SCENE_JOURNAL;
    struct srv_session *session = call->session;
    struct srv_scene *scene = srv_admit_scene(call, session, asked->scene);
    struct srv_ring *ring = NULL;
    if (scene == NULL) {
        return call->error.code;
    }
    if (scene->shared == NULL || (asked->begin != 0 && asked->stop)) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "%s",
                               scene->shared == NULL
                                   ? "only of a shared scene there is a journal"
                                   : "begin and stop at once");
    }
    int status = srv_admit_ring(call, &ring);
    if (status == 0 && asked->begin != 0) {
        status = srv_shared_charge_journal(srv_shared_member(scene, session),
                                           asked->begin, &call->error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_journal,
                            .finish = finish_journal,
                            .ring = ring,
                            .scene = scene,
                            .member = srv_shared_member(scene, session)};
    status = srv_request_start(call, &plan);
    if (status < 0 && asked->begin != 0) {
        srv_shared_refund_journal(plan.member);
    }
    return status;
}
