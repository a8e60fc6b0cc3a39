/* handlers_batch.c - batch.submit: a step of each of many scenes.
 *
 * Check on [loop] what all scenes have in common. Then, on [compute], step the scenes:
 * first those that are shared, and those that are a large part of the work, by the whole
 * team, as by itself; then the others by one thread each, whichever is free. What each
 * scene does is what frame.submit does (frame.h). A scene that fails says why in its own
 * answer.
 */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "admission.h"
#include "call.h"
#include "engine.h"
#include "enginemem.h"
#include "frame.h"
#include "held.h"
#include "holding.h"
#include "invariant.h"
#include "metrics.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "srv_batch.h"
#include "srv_journal.h"
#include "staging.h"
#include "stepping.h"
#include "tracing.h"
#include "watcher.h"

/* Records are written in such units, so that those of each scene are aligned. */
#define UNIT_BYTES 64u

_Static_assert(sizeof(struct pccd_scene_answer) % UNIT_BYTES == 0, "whole units");

/* ---- computed ---------------------------------------------------------------------- */

struct work {
    struct srv_request *request;
    struct srv_batch *batch;
    struct pccd_scene_answer *answers; /* [batch->count], in the result region */
    uint64_t tables_bytes;
    struct eng_question settings; /* of a scene that the whole team steps */
    struct srv_enginemem memory;  /* as the batch began */
};

/* Stage what moves in a scene, which has its engine: first what others hold for its step,
 * if it is shared. */
static int stage(const struct work *work, const struct srv_batch_item *item,
                 uint64_t *bytes, struct proto_error *error)
{
    const struct proto_BATCH_SUBMIT_request *submit = &work->request->params.BATCH_SUBMIT;
    const struct srv_cargo cargo = {submit->slot, item->segments, submit->seq};
    int status = item->shared != NULL ? srv_held_stage(item->scene, error) : 0;
    return status != 0 || item->segments == 0
               ? status
               : srv_stage_scene(work->request->plan.ring, &cargo, work->tables_bytes,
                                 item->shared != NULL ? item->shared->member : NULL,
                                 item->scene, work->batch->segments + item->first, bytes,
                                 error);
}

/* What the threads of a step did; that of one alone is the lane's. */
static void add_records(const struct work *work, const struct eng_step_result *step,
                        struct srv_batch_lane *lane)
{
    for (uint32_t i = 0; i < step->threads && i < work->batch->lane_count; i++) {
        struct srv_batch_lane *to = step->threads == 1 ? lane : &work->batch->lanes[i];
#define ADD(type, name, need, text) to->record.name += step->thread_records[i].name;
        PROTO_THREAD_RECORD(ADD)
#undef ADD
        to->scenes++;
    }
}

/* The step of one scene, as frame.submit makes it. 0, or a status with *error set. */
static int step_scene(const struct work *work, const struct srv_batch_item *item,
                      const struct eng_question *settings, struct srv_batch_lane *lane)
{
    struct srv_scene *scene = item->scene;
    struct proto_error *error = &lane->error;
    struct proto_error *owed =
        item->shared != NULL ? &item->shared->member->owed : &scene->owed;
    struct eng_scene *engine = NULL;
    uint64_t bytes = 0;
    if (owed->code != 0) { /* a step that was answered before has failed */
        *error = *owed;
        owed->code = 0;
        return error->code;
    }
    int status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(error, status, "no memory for the scene");
    }
    if (item->shared != NULL) {
        srv_shared_hide(scene);
        srv_held_check(scene, &item->shared->taken);
        srv_journal_open(scene, item->segments);
    }
    eng_stage_begin(engine);
    if (settings->threads > 1) {
        eng_stage_share(engine, settings->threads, settings->affinity);
    }
    status = stage(work, item, &bytes, error);
    if (status == 0) {
        const struct srv_stepper by = {.session = work->request->session->id,
                                       .step = work->request->params.BATCH_SUBMIT.step +
                                               (uint64_t)(item - work->batch->items)};
        struct eng_step_result step;
        status = srv_frame_compute(scene, settings, &by, &step, error);
        PCCD_ASSERT(status != PCCD_E_AGAIN); /* none is brief */
        if (status == 0) {
            add_records(work, &step, lane);
        }
    }
    if (status != 0) {
        eng_stage_abort(engine);
        return status;
    }
    lane->upload_bytes += bytes;
    return 0;
}

/* What came of it, but for where its records are. */
static void describe(const struct proto_answer *from, struct pccd_scene_answer *answer)
{
    answer->incomplete = from->incomplete;
    answer->verdict = from->verdict;
    answer->number = from->number;
    answer->total = from->total;
    answer->possible = from->possible;
    answer->initial = from->initial;
    answer->inside = from->inside;
    answer->toi_first = from->toi_first;
    answer->safe_step = from->safe_step;
    answer->hash[0] = from->hash_hi;
    answer->hash[1] = from->hash_lo;
    answer->ns_step = from->ns_step;
    answer->threads = from->threads;
    answer->crowded = from->crowded;
#define GET(unused, type, name, of_step, of_near, member, meaning)                       \
    answer->member = from->name;
    COMMON_KINDS(GET, )
#undef GET
}

/* Its answer, and what the loop will tell of it. */
static void note(struct srv_batch_item *item, struct pccd_scene_answer *answer,
                 struct srv_batch_lane *lane)
{
    const struct proto_answer *from = &item->scene->stepped.answer;
    describe(from, answer);
    item->total = from->total;
    item->hash[0] = from->hash_hi;
    item->hash[1] = from->hash_lo;
    item->ns_step = from->ns_step;
    item->incomplete = from->incomplete;
    item->verdict = from->verdict;
    item->threads = from->threads;
    srv_metrics_add_step(&lane->metrics, from);
    lane->ns_steps += from->ns_step;
    lane->incomplete += from->incomplete != PCCD_COMPLETE;
}

static void refuse(const struct srv_batch_item *item, const char *why,
                   struct pccd_scene_answer *answer, struct srv_batch_lane *lane)
{
    answer->status = item->status;
    (void)snprintf(answer->why, sizeof answer->why, "%.*s", (int)sizeof answer->why - 1,
                   why);
    lane->failed++;
    srv_metrics_add_error(&lane->metrics, item->status);
}

static void work_scene(struct work *work, uint32_t i, const struct eng_question *settings,
                       struct srv_batch_lane *lane)
{
    struct srv_batch_item *item = &work->batch->items[i];
    struct pccd_scene_answer *answer = &work->answers[i];
    int status = step_scene(work, item, settings, lane);
    item->status =
        status == 0 ? 0 : srv_enginemem_tell(&work->memory, status, &lane->error);
    if (item->status == 0) {
        note(item, answer, lane);
    } else {
        refuse(item, lane->error.text, answer, lane);
    }
    atomic_fetch_add_explicit(&work->batch->done, 1, memory_order_relaxed);
}

/* The request that a step of the scene by itself would have been. */
static struct proto_FRAME_SUBMIT_request frame_of(const struct work *work, uint32_t i)
{
    const struct proto_BATCH_SUBMIT_request *batch = &work->request->params.BATCH_SUBMIT;
    struct proto_FRAME_SUBMIT_request frame = {.scene = work->batch->items[i].handle,
                                               .step = batch->step + i,
                                               .mode = batch->mode,
                                               .method = batch->method,
                                               .threads = batch->threads,
                                               .tolerance = batch->tolerance,
                                               .deadline_ns = batch->deadline_ns,
                                               .separation = batch->separation,
                                               .approach = batch->approach};
    static_assert(sizeof frame.tuning == sizeof batch->tuning, "the same text");
    memcpy(frame.tuning, batch->tuning, sizeof frame.tuning);
    return frame;
}

/* A scene that others share, whose memory may be another user's, and whose step takes
 * along what is held for it and is noted in journals. */
static void work_shared(struct work *work, uint32_t i)
{
    struct srv_batch_item *item = &work->batch->items[i];
    struct srv_batch_shared *shared = item->shared;
    struct srv_enginemem memory = work->memory;
    srv_enginemem_begin(&work->memory, item->scene->resource.owner->user);
    work_scene(work, i, &work->settings, &work->batch->lanes[0]);
    work->memory = memory;
    eng_payer()->account = &work->request->session->owner.user->engine;
    if (item->status == 0) {
        const struct proto_FRAME_SUBMIT_request frame = frame_of(work, i);
        srv_held_take(item->scene, &shared->taken);
        srv_journal_step(item->scene, &frame, shared->member, shared->taken);
        shared->answer = item->scene->stepped.answer;
        shared->has_stepped = true;
    }
}

/* One scene by one thread, which uses the worker of its first scene for all. [team] */
static void work_item(void *context, uint32_t at, uint32_t thread)
{
    struct work *work = context;
    struct eng_question settings = work->settings;
    const uint32_t *rest = work->batch->rest;
    const struct srv_scene *first = work->batch->items[rest[thread]].scene;
    if (thread != 0) {
        srv_thread_enter(SRV_THREAD_COMPUTE);
    }
    settings.threads = 1;
    settings.affinity = NULL;
    settings.is_stopped = thread == 0 ? settings.is_stopped : NULL; /* its own thread */
    settings.lane = thread;
    settings.lender = first->engine; /* NULL: the first has none yet */
    work_scene(work, rest[at], &settings, &work->batch->lanes[thread]);
    if (thread != 0) {
        srv_thread_enter(SRV_THREAD_OTHER);
    }
}

/* ---- who computes what ------------------------------------------------------------- */

#define SIZES 64u /* by powers of two */

static uint64_t expects(const struct work *work, uint32_t i)
{
    const struct srv_scene *scene = work->batch->items[i].scene;
    return scene->engine == NULL ? 1 : eng_step_expects(scene->engine, &work->settings);
}

static uint32_t size_of(uint64_t work_ns)
{
    return work_ns == 0 ? 0 : SIZES - 1 - (uint32_t)__builtin_clzll(work_ns);
}

/* Step the scenes that are so large that the others would be done before them: by the
 * whole team, one after the other. Those that are left go to batch->rest: as they come
 * the first ones, whose workers the threads use, then the largest first. Returns how
 * many, and *rest_ns, the work that they are expected to be. */
static uint32_t work_large(struct work *work, uint64_t *rest_ns)
{
    struct srv_batch *batch = work->batch;
    uint32_t *rest = batch->rest;
    uint32_t threads = work->settings.threads;
    uint32_t ends[SIZES + 1] = {0};
    uint64_t all_ns = 0;
    uint32_t left = 0;
    for (uint32_t i = 0; i < batch->order_count; i++) {
        all_ns += expects(work, batch->order[i]);
    }
    for (uint32_t i = 0; i < batch->order_count; i++) {
        uint32_t item = batch->order[i];
        uint64_t own_ns = expects(work, item);
        if (threads > 1 && eng_step_is_enough(own_ns) &&
            own_ns > all_ns / (2 * threads)) {
            work_scene(work, item, &work->settings, &batch->lanes[0]);
        } else {
            batch->order[left++] = item;
            *rest_ns += own_ns;
        }
    }
    uint32_t first = left < threads ? left : threads;
    memcpy(rest, batch->order, first * sizeof *rest);
    for (uint32_t i = first; i < left; i++) {
        ends[SIZES - 1 - size_of(expects(work, batch->order[i]))]++;
    }
    for (uint32_t size = 0, end = first; size < SIZES; size++) {
        uint32_t count = ends[size];
        ends[size] = end;
        end += count;
    }
    for (uint32_t i = first; i < left; i++) {
        uint32_t size = SIZES - 1 - size_of(expects(work, batch->order[i]));
        rest[ends[size]++] = batch->order[i];
    }
    return left;
}

/* Returns how many threads had a part in it. */
static uint32_t work_scenes(struct work *work)
{
    struct srv_batch *batch = work->batch;
    uint64_t rest_ns = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        work->answers[i] = (struct pccd_scene_answer){.scene = batch->items[i].handle};
        if (batch->items[i].scene == NULL) {
            refuse(&batch->items[i], srv_batch_why(batch->items[i].status),
                   &work->answers[i], &batch->lanes[0]);
            atomic_fetch_add_explicit(&batch->done, 1, memory_order_relaxed);
        } else if (batch->items[i].shared != NULL) {
            work_shared(work, i);
        }
    }
    uint32_t left = work_large(work, &rest_ns);
    uint32_t threads = work->settings.threads < left ? work->settings.threads : left;
    threads = threads > 1 && eng_step_is_enough(rest_ns) ? threads : 1;
    eng_each(&(const struct eng_each){.count = left,
                                      .threads = threads,
                                      .affinity = work->settings.affinity,
                                      .item = work_item,
                                      .context = work});
    for (uint32_t i = 0; i < batch->count; i++) {
        threads = batch->items[i].threads > threads ? batch->items[i].threads : threads;
    }
    return threads;
}

/* ---- answers ----------------------------------------------------------------------- */

static uint64_t units_of(const struct srv_batch_item *item)
{
    const struct srv_scene *scene = item->scene;
    if (item->status != 0) {
        return 0;
    }
    return (scene->stepped.answer.total * scene->stepped.answer.record_bytes +
            UNIT_BYTES - 1) /
           UNIT_BYTES;
}

/* Copy the records of all scenes behind each other, as many as fit. */
static int write_records(struct srv_request *request, struct work *work,
                         struct proto_BATCH_SUBMIT_result *result)
{
    struct srv_batch *batch = work->batch;
    struct srv_page page;
    void *data = NULL;
    uint64_t wanted = 0;
    uint64_t used = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        wanted += units_of(&batch->items[i]);
    }
    int status = srv_ring_reserve(request->plan.ring, UNIT_BYTES, wanted, &page, &data,
                                  &request->error);
    if (status != 0) {
        return status;
    }
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct srv_batch_item *item = &batch->items[i];
        struct pccd_scene_answer *answer = &work->answers[i];
        uint64_t units = units_of(item);
        if (units == 0) {
            continue;
        }
        uint32_t record_bytes = item->scene->stepped.answer.record_bytes;
        uint64_t total = item->scene->stepped.answer.total;
        uint64_t room = (page.count - used) * UNIT_BYTES / record_bytes;
        uint64_t count = total < room ? total : room;
        answer->count = count;
        answer->offset = page.position + used * UNIT_BYTES;
        memcpy((uint8_t *)data + used * UNIT_BYTES, item->scene->stepped.records,
               count * record_bytes);
        used += units < page.count - used ? units : page.count - used;
        result->total += total;
        if (count < total && item->incomplete == PCCD_COMPLETE) {
            answer->incomplete = PCCD_INCOMPLETE_RESULT_FULL;
            result->incomplete++;
        }
    }
    if (page.count > 0) {
        result->release = page.release;
    }
    return 0;
}

/* What all threads have counted. */
static void add_up(struct srv_request *request, const struct work *work,
                   struct proto_BATCH_SUBMIT_result *result)
{
    struct srv_batch_lane *lanes = work->batch->lanes;
    for (uint32_t i = 0; i < work->settings.threads; i++) {
        request->upload_bytes += lanes[i].upload_bytes;
        result->failed += lanes[i].failed;
        result->incomplete += lanes[i].incomplete;
        result->ns_steps += lanes[i].ns_steps;
        if (i > 0) {
            srv_metrics_add_all(&lanes[0].metrics, &lanes[i].metrics);
        }
    }
}

/* ---- the request ------------------------------------------------------------------- */

/* The tables of the slot: those of the scenes have been read, those of the segments are
 * copied here. */
static int copy_segments(struct srv_request *request, struct work *work)
{
    const struct proto_BATCH_SUBMIT_request *submit = &request->params.BATCH_SUBMIT;
    struct srv_ring *ring = request->plan.ring;
    uint64_t scenes_bytes = submit->scenes * sizeof(struct proto_batch_scene);
    uint64_t bytes = submit->segments * sizeof *work->batch->segments;
    const uint8_t *payload = NULL;
    int status =
        srv_ring_open_slot(ring, submit->slot, submit->seq, &payload, &request->error);
    if (status != 0) {
        return status;
    }
    work->tables_bytes = scenes_bytes + bytes;
    memcpy(work->batch->segments, payload + scenes_bytes, bytes);
    return srv_ring_check_slot(ring, submit->slot, submit->seq, &request->error);
}

/* Place for the answers, before anything moves. */
static int reserve_answers(struct srv_request *request, struct work *work,
                           struct proto_BATCH_SUBMIT_result *result)
{
    struct srv_page page;
    void *data = NULL;
    int status = srv_ring_reserve_all(request->plan.ring, sizeof *work->answers,
                                      work->batch->count, &page, &data, &request->error);
    if (status == 0) {
        work->answers = data;
        result->count = page.count;
        result->offset = page.position;
        result->release = page.release;
    }
    return status;
}

/* What its threads did, as of one step. */
static void keep_records(struct srv_request *request, uint32_t threads)
{
    const struct srv_batch_lane *lanes = request->plan.batch->lanes;
    struct srv_laststep *last =
        srv_laststep_new(&request->session->service->spare_step, threads);
    for (uint32_t i = 0; last != NULL && i < threads; i++) {
        last->threads[i] = (struct srv_laststep_thread){lanes[i].record, lanes[i].scenes};
    }
    request->last_step = last;
}

static int work_batch(struct srv_request *request)
{
    const struct proto_BATCH_SUBMIT_request *submit = &request->params.BATCH_SUBMIT;
    struct proto_BATCH_SUBMIT_result *result = &request->result.BATCH_SUBMIT;
    struct srv_batch *batch = request->plan.batch;
    struct work work = {.request = request, .batch = batch};
    request->begin_ns = common_now_ns();
    atomic_store_explicit(&batch->has_begun, true, memory_order_relaxed);
    work.settings = srv_frame_settings(request, &SRV_WANTED_OF(submit));
    if (work.settings.threads > batch->lane_count) { /* they have become more since */
        work.settings.threads = batch->lane_count;
    }
    atomic_store_explicit(&request->job.end_ns, work.settings.deadline_ns,
                          memory_order_relaxed);
    srv_enginemem_begin(&work.memory, request->session->owner.user);
    int status = copy_segments(request, &work);
    status = status != 0 ? status : reserve_answers(request, &work, result);
    if (status == 0) {
        work.settings.trace = srv_tracing_lend();
        result->threads = work_scenes(&work);
        srv_tracing_return(work.settings.trace);
        keep_records(request, result->threads);
    }
    srv_request_return_slot(request);
    status = status != 0 ? status : write_records(request, &work, result);
    if (status == 0) {
        add_up(request, &work, result);
        result->step = submit->step;
        result->ns_queue = request->begin_ns - request->arrival_ns;
        result->ns_batch = common_now_ns() - request->begin_ns;
    }
    return status;
}

/* ---- afterwards -------------------------------------------------------------------- */

/* What was counted, where list.session looks. */
static void tell_session(const struct srv_request *request)
{
    const struct proto_STATS_result *counted =
        &request->plan.batch->lanes[0].metrics.counters;
    const struct proto_BATCH_SUBMIT_result *result = &request->result.BATCH_SUBMIT;
    struct proto_LIST_SESSION_result *session = &request->session->told;
    session->steps += counted->steps;
    session->steps_incomplete += counted->steps_incomplete;
    session->contacts += counted->contacts;
    session->upload_bytes += request->upload_bytes;
    session->result_bytes += result->count * sizeof(struct pccd_scene_answer);
    session->ns_queue += result->ns_queue;
    session->ns_ingest += counted->ns_ingest;
    session->ns_refit += counted->ns_refit;
    session->ns_traversal += counted->ns_traversal;
    session->ns_tests += counted->ns_tests;
    session->ns_merge += counted->ns_merge;
    session->ns_step += counted->ns_step;
}

/* And one scene, where list.scene does; and those who watch. */
static void tell_scene(const struct srv_request *request, uint32_t i)
{
    const struct proto_BATCH_SUBMIT_request *submit = &request->params.BATCH_SUBMIT;
    const struct srv_batch_item *item = &request->plan.batch->items[i];
    struct srv_service *service = request->session->service;
    uint64_t number = item->status == 0 ? ++service->step_last : 0;
    if (item->status == 0) {
        struct proto_LIST_SCENE_result *scene = &item->scene->told;
        scene->steps++;
        scene->number = number;
        scene->total = item->total;
        scene->hash_hi = item->hash[0];
        scene->hash_lo = item->hash[1];
        scene->ns_step = item->ns_step;
    }
    if (service->monitors != NULL) {
        const struct proto_STEP_request step = {.number = number,
                                                .session = request->session->id,
                                                .scene = item->handle,
                                                .step = submit->step + i,
                                                .code = (uint32_t)-item->status,
                                                .mode = submit->mode,
                                                .incomplete = item->incomplete,
                                                .verdict = item->verdict,
                                                .threads = item->threads,
                                                .total = item->total,
                                                .hash_hi = item->hash[0],
                                                .hash_lo = item->hash[1],
                                                .ns_queue =
                                                    request->result.BATCH_SUBMIT.ns_queue,
                                                .ns_step = item->ns_step};
        srv_watcher_step(service, &step);
    }
}

/* Others of a shared scene: those whose frames went along, and all who take part. */
static void tell_members(const struct srv_request *request,
                         const struct srv_batch_item *item)
{
    struct srv_batch_shared *shared = item->shared;
    srv_holding_answer(shared->taken, &shared->answer);
    shared->taken = NULL;
    if (shared->has_stepped) {
        srv_shared_stepped(item->scene, request->session, &shared->answer);
    }
}

/* For stats.thread. */
static void tell_threads(struct srv_request *request)
{
    struct srv_service *service = request->session->service;
    const struct proto_BATCH_SUBMIT_result *result = &request->result.BATCH_SUBMIT;
    const struct proto_STATS_result *counted =
        &request->plan.batch->lanes[0].metrics.counters;
    struct srv_laststep *last = request->last_step;
    if (last == NULL) {
        return;
    }
    last->batch = request->plan.batch->count;
    last->number = service->step_last;
    last->answer = (struct proto_answer){.ns_ingest = counted->ns_ingest,
                                         .ns_refit = counted->ns_refit,
                                         .ns_low = counted->ns_low,
                                         .ns_high = counted->ns_high,
                                         .ns_merge = counted->ns_merge,
                                         .ns_step = result->ns_batch};
    srv_laststep_set(&service->spare_step, &request->session->last_step, last);
    srv_laststep_set(&service->spare_step, &service->last_step, last);
}

static void finish_batch(struct srv_request *request)
{
    struct srv_batch *batch = request->plan.batch;
    if (request->status == 0) {
        srv_metrics_add_all(&request->session->service->metrics,
                            &batch->lanes[0].metrics);
        tell_session(request);
    }
    for (uint32_t i = 0; i < batch->count; i++) {
        if (batch->items[i].shared != NULL) { /* whatever came of the request */
            tell_members(request, &batch->items[i]);
        }
        if (request->status == 0) {
            tell_scene(request, i);
        }
    }
    tell_threads(request);
    srv_batch_end(batch);
}

/* ---- what is asked ----------------------------------------------------------------- */

static int check_tables(struct srv_call *call, const struct srv_ring *ring)
{
    const struct proto_BATCH_SUBMIT_request *submit = &call->params.BATCH_SUBMIT;
    uint64_t bytes = submit->scenes * sizeof(struct proto_batch_scene) +
                     submit->segments * sizeof(struct proto_segment);
    if (submit->scenes == 0) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "a batch of no scenes");
    }
    if (submit->scenes > PROTO_BATCH_MAX) {
        return proto_error_set(&call->error, PCCD_E_LIMIT,
                               "%u scenes, a batch has at most %u", submit->scenes,
                               PROTO_BATCH_MAX);
    }
    if (bytes > ring->slot_stride) {
        return proto_error_set(&call->error, PCCD_E_SEGMENT,
                               "tables of %u scenes and %u segments do not fit in %llu "
                               "bytes of a slot",
                               submit->scenes, submit->segments,
                               (unsigned long long)ring->slot_stride);
    }
    uint64_t room = ring->result_bytes - PROTO_SHM_PAGE;
    if (submit->scenes > room / sizeof(struct pccd_scene_answer)) {
        return proto_error_set(&call->error, PCCD_E_LIMIT,
                               "the answers of %u scenes do not fit in a result region "
                               "of %llu bytes",
                               submit->scenes, (unsigned long long)room);
    }
    return 0;
}

int srv_on_BATCH_SUBMIT(struct srv_call *call)
{
    const struct proto_BATCH_SUBMIT_request *submit = &call->params.BATCH_SUBMIT;
    const struct srv_asked asked = srv_asked_of(call->method, &call->params);
    struct srv_ring *ring = NULL;
    struct srv_batch *batch = NULL;
    int status = srv_stepping_check(call, &asked, &ring);
    if (status == 0) { /* also one in which nothing moves has its scenes there */
        status = srv_admit_slot(call, ring, submit->slot, submit->seq);
    }
    if (status == 0) {
        status = srv_frame_check(call, &SRV_WANTED_OF(submit));
    }
    if (status == 0) {
        status = check_tables(call, ring);
    }
    if (status == 0) {
        status = srv_batch_begin(call->session, ring, submit, &batch, &call->error);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_batch,
                            .finish = finish_batch,
                            .ring = ring,
                            .batch = batch,
                            .takes_slot = true,
                            .replies = batch->shared_count == 0};
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_batch_end(batch);
    }
    return status;
}
