/* handlers_fetch.c - frame.fetch and near.fetch, and the pages of an answer.
 *
 * Threads: functions say; [loop] else, but for functions named work_ and their helpers.
 */
#include <string.h>

#include "admission.h"
#include "call.h"
#include "frame.h"
#include "invariant.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"

static_assert(sizeof(struct proto_FRAME_SUBMIT_result) ==
                  sizeof(struct proto_FRAME_FETCH_result),
              "submit and fetch answer alike");
static_assert(sizeof(struct proto_SCENE_NEAR_result) ==
                  sizeof(struct proto_NEAR_FETCH_result),
              "near and fetch answer alike");

/* Copied between two looks at the cancel flag, some 100 us; and in any case: a step that
 * was cancelled keeps no more. */
#define COPY_RECORDS 8192u

/* Copy `count` records, or fewer if the request is cancelled. Returns how many. */
static uint64_t copy_records(struct srv_request *request, uint8_t *to,
                             const uint8_t *from, uint64_t count, uint32_t record_bytes,
                             bool is_of_step)
{
    const struct srv_service *service = request->session->service;
    uint64_t done = 0;
    if (is_of_step && service->write != NULL && count > 0) {
        service->write(service->writer, to, from, count);
        return count;
    }
    while (done < count && (done == 0 || !atomic_load_explicit(&request->job.cancel,
                                                               memory_order_relaxed))) {
        uint64_t n = count - done < COPY_RECORDS ? count - done : COPY_RECORDS;
        memcpy(to + done * record_bytes, from + done * record_bytes, n * record_bytes);
        done += n;
    }
    return done;
}

int srv_records_write(struct srv_request *request, const struct srv_records *records,
                      uint64_t first, struct srv_records_page *page)
{
    struct srv_page place;
    void *data = NULL;
    PCCD_ASSERT(first <= records->total);
    int status = srv_ring_reserve(request->plan.ring, records->record_bytes,
                                  records->total - first, &place, &data, &request->error);
    if (status != 0) {
        return status;
    }
    const uint8_t *from = records->data;
    if (first > 0) {
        from += first * records->record_bytes;
    }
    uint64_t count = copy_records(request, data, from, place.count, records->record_bytes,
                                  records->is_of_step);
    *page = (struct srv_records_page){.first = first,
                                      .count = count,
                                      .cursor = first + count,
                                      .offset = place.position,
                                      .release = place.release,
                                      .incomplete = records->incomplete};
    if (page->incomplete == PCCD_COMPLETE && page->cursor < records->total) {
        page->incomplete =
            count < place.count ? PCCD_INCOMPLETE_CANCELLED : PCCD_INCOMPLETE_RESULT_FULL;
    }
    return 0;
}

int srv_frame_page(struct srv_request *request, uint64_t first,
                   struct proto_FRAME_SUBMIT_result *answer)
{
    const struct srv_scene *scene = request->plan.scene;
    const struct srv_records records = {scene->records, scene->answer.record_bytes,
                                        scene->answer.total, scene->answer.incomplete,
                                        true};
    struct srv_records_page page;
    PCCD_ASSERT(scene->has_answer);
    *answer = scene->answer; /* also of a step without a page: others hear of it */
    int status = srv_records_write(request, &records, first, &page);
    if (status == 0) {
        SRV_RECORDS_PAGE(answer, &page);
    }
    return status;
}

int srv_near_page(struct srv_request *request, uint64_t first,
                  struct proto_SCENE_NEAR_result *answer)
{
    const struct srv_scene *scene = request->plan.scene;
    const struct srv_records records = {scene->near_records, scene->near.record_bytes,
                                        scene->near.total, scene->near.incomplete, false};
    struct srv_records_page page;
    PCCD_ASSERT(scene->has_near);
    int status = srv_records_write(request, &records, first, &page);
    if (status == 0) {
        *answer = scene->near;
        SRV_RECORDS_PAGE(answer, &page);
    }
    return status;
}

/* An answer that a scene keeps, or does not. */
struct kept {
    uint32_t scene;
    const char *what; /* it is the answer to, with a number after it; and without one */
    const char *any;
    bool is_there;
    bool is_own;   /* this session asked */
    uint64_t step; /* by its asker's number */
    uint64_t total;
};

/* Is that the answer which was meant, `is_meant`, and has it this record? */
static int check_fetch(struct srv_request *request, const struct kept *kept,
                       uint64_t asked, bool is_meant, uint64_t cursor)
{
    if (!kept->is_there) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "scene 0x%x has no answer to %s: none since it "
                               "changed",
                               kept->scene, kept->any);
    }
    if (!is_meant) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "the answer to %s %llu is gone, %s %s %llu has been "
                               "answered since",
                               kept->what, (unsigned long long)asked,
                               kept->is_own ? "this session's" : "another session's",
                               kept->what, (unsigned long long)kept->step);
    }
    if (cursor > kept->total) {
        return proto_error_set(&request->error, PCCD_E_INVAL,
                               "cursor %llu is beyond the answer's %llu records",
                               (unsigned long long)cursor,
                               (unsigned long long)kept->total);
    }
    return 0;
}

static int work_fetch(struct srv_request *request)
{
    const struct proto_FRAME_FETCH_request *fetch = &request->params.FRAME_FETCH;
    const struct srv_scene *scene = request->plan.scene;
    const struct kept kept = {fetch->scene,
                              "step",
                              "a step",
                              scene->has_answer,
                              scene->stepper == request->session->id,
                              scene->answer.step,
                              scene->answer.total};
    bool is_meant = fetch->number != 0 ? fetch->number == scene->answer.number
                                       : kept.is_own && fetch->step == kept.step;
    uint64_t start_ns = common_now_ns();
    struct proto_FRAME_SUBMIT_result answer;
    int status =
        check_fetch(request, &kept, fetch->number != 0 ? fetch->number : fetch->step,
                    is_meant, fetch->cursor);
    status = status != 0 ? status : srv_frame_page(request, fetch->cursor, &answer);
    if (status == 0) {
        answer.ns_queue = start_ns - request->arrival_ns;
        memcpy(&request->result.FRAME_FETCH, &answer, sizeof answer);
    }
    return status;
}

static int work_near_fetch(struct srv_request *request)
{
    const struct proto_NEAR_FETCH_request *fetch = &request->params.NEAR_FETCH;
    const struct srv_scene *scene = request->plan.scene;
    const struct kept kept = {fetch->scene,
                              "scene.near",
                              "scene.near",
                              scene->has_near,
                              scene->near_asker == request->session->id,
                              scene->near.step,
                              scene->near.total};
    uint64_t start_ns = common_now_ns();
    struct proto_SCENE_NEAR_result answer;
    int status = check_fetch(request, &kept, fetch->step,
                             kept.is_own && fetch->step == kept.step, fetch->cursor);
    status = status != 0 ? status : srv_near_page(request, fetch->cursor, &answer);
    if (status == 0) {
        answer.ns_queue = start_ns - request->arrival_ns;
        memcpy(&request->result.NEAR_FETCH, &answer, sizeof answer);
    }
    return status;
}

static int fetch_from(struct srv_call *call, uint32_t handle,
                      int (*work)(struct srv_request *request))
{
    struct srv_scene *scene = srv_handles_get(&call->session->scenes, handle);
    if (scene == NULL) {
        return proto_error_set(&call->error, PCCD_E_HANDLE, "there is no scene 0x%x",
                               handle);
    }
    struct srv_ring *ring = NULL;
    int status = srv_admit_ring(call, &ring);
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work, .ring = ring, .scene = scene};
    return srv_request_start(call, &plan);
}

int srv_on_FRAME_FETCH(struct srv_call *call)
{
    return fetch_from(call, call->params.FRAME_FETCH.scene, work_fetch);
}

int srv_on_NEAR_FETCH(struct srv_call *call)
{
    return fetch_from(call, call->params.NEAR_FETCH.scene, work_near_fetch);
}
