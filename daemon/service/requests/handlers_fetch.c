/* handlers_fetch.c - frame.fetch and near.fetch, and how an answer is written, page by
 * page.
 *
 * Threads: functions say; [loop] else, but for functions named work_ and their helpers.
 */
#include <string.h>

#include "call.h"
#include "invariant.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "srv_step.h"

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

int srv_answer_page(struct srv_request *request, const struct srv_kept *kept,
                    uint64_t first, struct proto_answer *answer)
{
    const struct srv_scene *scene = request->plan.scene;
    struct srv_page place;
    void *data = NULL;
    *answer = kept->answer;
    PCCD_ASSERT(kept->is_there && first <= answer->total);
    int status = srv_ring_reserve(request->plan.ring, answer->record_bytes,
                                  answer->total - first, &place, &data, &request->error);
    if (status != 0) {
        return status;
    }
    const uint8_t *from = kept->records;
    if (first > 0) {
        from += first * answer->record_bytes;
    }
    answer->first = first;
    answer->count = copy_records(request, data, from, place.count, answer->record_bytes,
                                 kept == &scene->stepped);
    answer->cursor = first + answer->count;
    answer->offset = place.position;
    answer->release = place.release;
    if (answer->incomplete == PCCD_COMPLETE && answer->cursor < answer->total) {
        answer->incomplete = answer->count < place.count ? PCCD_INCOMPLETE_CANCELLED
                                                         : PCCD_INCOMPLETE_RESULT_FULL;
    }
    return 0;
}

/* Page that is wanted, and of which answer. */
struct wanted {
    const char *what; /* it is the answer to, with a number after it; and without one */
    const char *any;
    uint32_t scene;
    uint64_t step;   /* by its asker's number */
    uint64_t number; /* among those of the scene, in the place of that; or 0 */
    uint64_t cursor;
};

/* Check that the scene keeps that answer, and it has this record. */
static int check_fetch(struct srv_request *request, const struct srv_kept *kept,
                       const struct wanted *wanted)
{
    bool is_own = kept->asker == request->session->id;
    bool is_meant = wanted->number != 0 ? wanted->number == kept->answer.number
                                        : is_own && wanted->step == kept->answer.step;
    if (!kept->is_there) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "scene 0x%x has no answer to %s: none since it "
                               "changed",
                               wanted->scene, wanted->any);
    }
    if (!is_meant) {
        bool is_numbered = wanted->number != 0;
        return proto_error_set(
            &request->error, PCCD_E_STATE,
            "scene 0x%x keeps its last answer alone, to %s %s %llu, not to %llu",
            wanted->scene,
            is_numbered ? "its"
            : is_own    ? "this session's"
                        : "another session's",
            wanted->what,
            (unsigned long long)(is_numbered ? kept->answer.number : kept->answer.step),
            (unsigned long long)(is_numbered ? wanted->number : wanted->step));
    }
    if (wanted->cursor > kept->answer.total) {
        return proto_error_set(&request->error, PCCD_E_INVAL,
                               "cursor %llu is beyond the answer's %llu records",
                               (unsigned long long)wanted->cursor,
                               (unsigned long long)kept->answer.total);
    }
    return 0;
}

static int fetch(struct srv_request *request, const struct srv_kept *kept,
                 const struct wanted *wanted)
{
    uint64_t start_ns = common_now_ns();
    struct proto_answer answer;
    int status = check_fetch(request, kept, wanted);
    status =
        status != 0 ? status : srv_answer_page(request, kept, wanted->cursor, &answer);
    if (status == 0) {
        answer.ns_queue = start_ns - request->arrival_ns;
        request->result.answer = answer;
    }
    return status;
}

static int work_fetch(struct srv_request *request)
{
    const struct proto_FRAME_FETCH_request *asked = &request->params.FRAME_FETCH;
    const struct wanted wanted = {.what = "step",
                                  .any = "a step",
                                  .scene = asked->scene,
                                  .step = asked->step,
                                  .number = asked->number,
                                  .cursor = asked->cursor};
    return fetch(request, &request->plan.scene->stepped, &wanted);
}

static int work_near_fetch(struct srv_request *request)
{
    const struct proto_NEAR_FETCH_request *asked = &request->params.NEAR_FETCH;
    const struct wanted wanted = {.what = "scene.near",
                                  .any = "scene.near",
                                  .scene = asked->scene,
                                  .step = asked->step,
                                  .cursor = asked->cursor};
    return fetch(request, &request->plan.scene->near, &wanted);
}

static int fetch_from(struct srv_call *call, uint32_t handle,
                      int (*work)(struct srv_request *request))
{
    struct srv_scene *scene = srv_admit_scene(call, call->session, handle);
    if (scene == NULL) {
        return call->error.code;
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
