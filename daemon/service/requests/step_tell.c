/* step_tell.c - what is counted and told of a step, or a question, that is over. */
#include "hold.h"
#include "invariant.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_batch.h"
#include "srv_step.h"
#include "watcher.h"

/* All scenes together, where stats and list.session look. */
static void count(const struct srv_request *request)
{
    const struct srv_batch *batch = request->plan.batch;
    const struct proto_answer *answer = &request->result.answer;
    struct srv_metrics *metrics = &request->session->service->metrics;
    struct proto_LIST_SESSION_result *stats = &request->session->stats;
    stats->upload_bytes += request->upload_bytes;
    if (batch != NULL) {
        srv_metrics_add_all(metrics, &batch->tallies[0].metrics);
        srv_stats_add_all(stats, &batch->tallies[0].stats);
        stats->ns_queue += request->result.BATCH_SUBMIT.ns_queue;
        stats->result_bytes += batch->count * sizeof(struct pccd_scene_answer);
        return;
    }
    if (request->method == PROTO_METHOD_FRAME_SUBMIT) {
        srv_metrics_add_step(metrics, answer);
        srv_stats_add_step(stats, answer);
        stats->ns_queue += answer->ns_queue;
    } else if (srv_request_state(request) == SRV_REQUEST_EARLY) {
        return; /* it was counted when it was answered */
    } else {
        srv_metrics_add_near(metrics, answer);
    }
    stats->result_bytes += answer->count * answer->record_bytes;
}

/* One scene: those whose frames went along, those who take part, list.scene. Returns the
 * step's number in this epoch; 0: it did not run. */
static uint64_t tell_scene(const struct srv_request *request, struct srv_item *item)
{
    struct srv_service *service = request->session->service;
    const struct proto_STEP_request *event = &item->event;
    bool places = request->method == PROTO_METHOD_FRAME_SUBMIT &&
                  request->params.FRAME_SUBMIT.place;
    if (item->member != NULL) {
        srv_hold_answer(item->taken, item->answer);
        item->taken = NULL;
    }
    if (!item->has_stepped) {
        return 0;
    }
    if (item->member != NULL && !places) {
        srv_shared_stepped(item->scene, request->session, item->answer);
    }
    uint64_t number = ++service->step_last;
    if (request->status == 0) {
        struct proto_LIST_SCENE_result *scene = &item->scene->stats;
        scene->steps++;
        scene->number = number;
        scene->total = event->total;
        scene->hash_hi = event->hash_hi;
        scene->hash_lo = event->hash_lo;
        scene->ns_step = event->ns_step;
    }
    return number;
}

/* Those who watch. */
static void tell_watchers(const struct srv_request *request,
                          const struct srv_step_params *params, struct srv_item *item,
                          uint64_t number)
{
    const struct srv_batch *batch = request->plan.batch;
    struct proto_STEP_request *event = &item->event;
    int status = request->status != 0 ? request->status : item->status;
    if (batch == NULL) {
        event->scene = params->scene;
    }
    if (status != 0) {
        *event =
            (struct proto_STEP_request){.scene = event->scene, .code = (uint32_t)-status};
    } else {
        event->number = number;
        event->ns_queue = batch != NULL ? request->result.BATCH_SUBMIT.ns_queue
                                        : request->result.answer.ns_queue;
    }
    event->session = request->session->id;
    event->step = params->step + (batch != NULL ? (uint64_t)(item - batch->items) : 0);
    event->mode = params->mode;
    srv_watcher_step(request->session->service, event);
}

/* For stats.thread. */
static void tell_threads(struct srv_request *request)
{
    struct srv_service *service = request->session->service;
    const struct srv_batch *batch = request->plan.batch;
    struct srv_laststep *last = request->last_step;
    if (last == NULL) {
        return;
    }
    last->number = service->step_last;
    if (batch != NULL) {
        const struct proto_STATS_result *counted = &batch->tallies[0].metrics.counters;
        last->batch = batch->count;
        last->answer =
            (struct proto_answer){.ns_ingest = counted->ns_ingest,
                                  .ns_refit = counted->ns_refit,
                                  .ns_low = counted->ns_low,
                                  .ns_high = counted->ns_high,
                                  .ns_merge = counted->ns_merge,
                                  .ns_step = request->result.BATCH_SUBMIT.ns_batch};
    } else {
        last->answer = request->result.answer;
    }
    srv_laststep_set(&service->spare_step, &request->session->last_step, last);
    srv_laststep_set(&service->spare_step, &service->last_step, last);
}

void srv_step_finish(struct srv_request *request)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct srv_batch *batch = request->plan.batch;
    struct srv_item *items = batch != NULL ? batch->items : &request->item;
    uint32_t item_count = batch != NULL ? batch->count : 1;
    bool are_watched = request->session->service->watchers != NULL && !params.is_near;
    if (request->status == 0) {
        count(request);
    }
    for (uint32_t i = 0; i < item_count; i++) {
        uint64_t number = tell_scene(request, &items[i]);
        if (are_watched) {
            tell_watchers(request, &params, &items[i], number);
        }
    }
    tell_threads(request);
    if (batch != NULL) {
        srv_batch_end(batch);
    }
}
