/* handlers_batch.c - batch.submit: a step of each of many scenes.
 *
 * Room:     service. See call.h.
 * Does:     check on [loop] what all scenes have in common. Then, on [compute], step the
 *           scenes: one that is a large part of the work by the whole team, as by itself;
 *           the others by one thread each, whichever is free. What each scene does is
 *           what frame.submit does (frame.h). A scene that fails says why in its own
 *           answer.
 * Does not: answer before its turn, or take shared scenes, whose steps concern others.
 * Threads:  [loop], but for functions named work_ and their helpers.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "admission.h"
#include "call.h"
#include "engine.h"
#include "enginemem.h"
#include "frame.h"
#include "invariant.h"
#include "metrics.h"
#include "now.h"
#include "request.h"
#include "service.h"
#include "session.h"
#include "srv_batch.h"
#include "staging.h"
#include "stepping.h"
#include "tracing.h"
#include "watcher.h"

/* Records are written in such units, so that those of each scene are aligned. */
#define UNIT_BYTES 64u

_Static_assert(sizeof(struct pccd_scene_answer) % UNIT_BYTES == 0, "whole units");

/* ---- computed ---------------------------------------------------------------------- */

/* What a thread of the batch has for itself. */
struct lane {
    struct srv_metrics metrics; /* of its scenes */
    struct proto_error error;   /* of the scene at hand */
    uint64_t upload_bytes;
    uint64_t ns_steps;
    uint32_t failed;
    uint32_t incomplete;
};

struct work {
    struct srv_request *request;
    struct srv_batch *batch;
    struct pccd_scene_answer *answers; /* [batch->count], in the result region */
    const struct proto_segment *segments;
    uint64_t tables_bytes;
    struct eng_step_settings settings; /* of a scene that the whole team steps */
    struct srv_enginemem memory;       /* as the batch began */
    struct lane *lanes;                /* [settings.threads] */
    const uint32_t *order;             /* items that are stepped by one thread each */
};

/* The step of one scene, as frame.submit makes it. 0, or a status with *error set. */
static int step_scene(const struct work *work, const struct srv_batch_item *item,
                      const struct eng_step_settings *settings, struct lane *lane)
{
    struct srv_scene *scene = item->scene;
    const struct proto_BATCH_SUBMIT_request *submit = &work->request->params.BATCH_SUBMIT;
    struct proto_error *error = &lane->error;
    struct eng_scene *engine = NULL;
    uint64_t bytes = 0;
    if (scene->owed.code != 0) { /* a step that was answered before has failed */
        *error = scene->owed;
        scene->owed.code = 0;
        return error->code;
    }
    int status = srv_scene_engine(scene, &engine);
    if (status != 0) {
        return proto_error_set(error, status, "no memory for the scene");
    }
    eng_stage_begin(engine);
    if (settings->threads > 1) {
        eng_stage_share(engine, settings->threads, settings->affinity);
    }
    if (item->segments > 0) {
        status = srv_stage_scene(work->request->plan.ring, submit->slot, submit->seq,
                                 work->tables_bytes, work->segments + item->first,
                                 item->segments, scene, &bytes, error);
    }
    if (status == 0) {
        const struct srv_stepper by = {.session = work->request->session->id,
                                       .step = submit->step +
                                               (uint64_t)(item - work->batch->items)};
        struct eng_step_result step;
        status = srv_frame_compute(scene, settings, &by, &step, error);
        PCCD_ASSERT(status != PCCD_E_AGAIN); /* none is brief */
    }
    if (status != 0) {
        eng_stage_abort(engine);
        return status;
    }
    lane->upload_bytes += bytes;
    return 0;
}

/* What came of it, but for where its records are. */
static void describe(const struct proto_FRAME_SUBMIT_result *from,
                     struct pccd_scene_answer *answer)
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
#define GET(unused, name, need, member, meaning) answer->member = from->name;
    COMMON_STEP_KINDS(GET, )
#undef GET
}

/* Its answer, and what the loop will tell of it. */
static void note(struct srv_batch_item *item, struct pccd_scene_answer *answer,
                 struct lane *lane)
{
    const struct proto_FRAME_SUBMIT_result *from = &item->scene->answer;
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
                   struct pccd_scene_answer *answer, struct lane *lane)
{
    answer->status = item->status;
    (void)snprintf(answer->why, sizeof answer->why, "%.*s", (int)sizeof answer->why - 1,
                   why);
    lane->failed++;
    srv_metrics_add_error(&lane->metrics, item->status);
}

static void work_scene(struct work *work, uint32_t i,
                       const struct eng_step_settings *settings, struct lane *lane)
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
}

/* One scene by one thread, which uses the worker of its first scene for all. [team] */
static void work_item(void *context, uint32_t at, uint32_t thread)
{
    struct work *work = context;
    struct eng_step_settings settings = work->settings;
    const struct srv_scene *first = work->batch->items[work->order[thread]].scene;
    if (thread != 0) {
        srv_thread_enter(SRV_THREAD_COMPUTE);
    }
    settings.threads = 1;
    settings.affinity = NULL;
    settings.lane = thread;
    settings.lender = first->engine; /* NULL: the first has none yet */
    work_scene(work, work->order[at], &settings, &work->lanes[thread]);
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
 * whole team, one after the other. Those that are left go to `rest`: as they come the
 * first ones, whose workers the threads use, then the largest first. Returns how many,
 * and *rest_ns, the work that they are expected to be. */
static uint32_t work_large(struct work *work, uint32_t *rest, uint64_t *rest_ns)
{
    struct srv_batch *batch = work->batch;
    uint32_t threads = work->settings.threads;
    uint32_t ends[SIZES + 1] = {0};
    uint64_t all_ns = 0;
    uint32_t left = 0;
    for (uint32_t i = 0; i < batch->claim_count; i++) {
        all_ns += expects(work, batch->order[i]);
    }
    for (uint32_t i = 0; i < batch->claim_count; i++) {
        uint32_t item = batch->order[i];
        uint64_t own_ns = expects(work, item);
        if (threads > 1 && eng_step_is_enough(own_ns) &&
            own_ns > all_ns / (2 * threads)) {
            work_scene(work, item, &work->settings, &work->lanes[0]);
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

/* Returns how many threads had a part in it, or PCCD_E_NOMEM. */
static int work_scenes(struct work *work)
{
    struct srv_batch *batch = work->batch;
    uint64_t rest_ns = 0;
    uint32_t *rest = malloc((batch->claim_count + 1) * sizeof *rest);
    if (rest == NULL) {
        return PCCD_E_NOMEM;
    }
    for (uint32_t i = 0; i < batch->count; i++) {
        work->answers[i] = (struct pccd_scene_answer){.scene = batch->items[i].handle};
        if (batch->items[i].scene == NULL) {
            refuse(&batch->items[i], srv_batch_why(batch->items[i].status),
                   &work->answers[i], &work->lanes[0]);
        }
    }
    uint32_t left = work_large(work, rest, &rest_ns);
    uint32_t threads = work->settings.threads < left ? work->settings.threads : left;
    threads = threads > 1 && eng_step_is_enough(rest_ns) ? threads : 1;
    work->order = rest;
    eng_each(&(const struct eng_each){.count = left,
                                      .threads = threads,
                                      .affinity = work->settings.affinity,
                                      .item = work_item,
                                      .context = work});
    free(rest);
    return (int)(left < batch->claim_count ? work->settings.threads : threads);
}

/* ---- answers ----------------------------------------------------------------------- */

static uint64_t units_of(const struct srv_batch_item *item)
{
    const struct srv_scene *scene = item->scene;
    if (item->status != 0) {
        return 0;
    }
    return (scene->answer.total * scene->answer.record_bytes + UNIT_BYTES - 1) /
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
        uint32_t record_bytes = item->scene->answer.record_bytes;
        uint64_t total = item->scene->answer.total;
        uint64_t room = (page.count - used) * UNIT_BYTES / record_bytes;
        uint64_t count = total < room ? total : room;
        answer->count = count;
        answer->offset = page.position + used * UNIT_BYTES;
        memcpy((uint8_t *)data + used * UNIT_BYTES, item->scene->records,
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
    struct srv_metrics *metrics = &work->lanes[0].metrics;
    for (uint32_t i = 0; i < work->settings.threads; i++) {
        const struct lane *lane = &work->lanes[i];
        request->upload_bytes += lane->upload_bytes;
        result->failed += lane->failed;
        result->incomplete += lane->incomplete;
        result->ns_steps += lane->ns_steps;
        if (i > 0) {
            srv_metrics_add_all(metrics, &lane->metrics);
        }
    }
    request->plan.batch->metrics = *metrics;
}

/* ---- the request ------------------------------------------------------------------- */

/* The tables of the slot: those of the scenes have been read, those of the segments are
 * copied here. */
static int copy_segments(struct srv_request *request, struct work *work)
{
    const struct proto_BATCH_SUBMIT_request *submit = &request->params.BATCH_SUBMIT;
    struct srv_ring *ring = request->plan.ring;
    struct proto_segment *segments =
        srv_workspace_of_thread(request->session->service->workspaces)->segments;
    uint64_t scenes_bytes = submit->scenes * sizeof(struct proto_batch_scene);
    const uint8_t *payload = NULL;
    int status =
        srv_ring_open_slot(ring, submit->slot, submit->seq, &payload, &request->error);
    if (status != 0) {
        return status;
    }
    work->tables_bytes = scenes_bytes + submit->segments * sizeof *segments;
    work->segments = segments;
    memcpy(segments, payload + scenes_bytes, submit->segments * sizeof *segments);
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

static int work_batch(struct srv_request *request)
{
    const struct proto_BATCH_SUBMIT_request *submit = &request->params.BATCH_SUBMIT;
    struct proto_BATCH_SUBMIT_result *result = &request->result.BATCH_SUBMIT;
    struct work work = {.request = request, .batch = request->plan.batch};
    request->begin_ns = common_now_ns();
    work.settings = srv_frame_settings(request, &SRV_WANTED_OF(submit));
    atomic_store_explicit(&request->job.end_ns, work.settings.deadline_ns,
                          memory_order_relaxed);
    srv_enginemem_begin(&work.memory, request->session->owner.user);
    work.lanes = calloc(work.settings.threads, sizeof *work.lanes);
    if (work.lanes == NULL) {
        return proto_error_set(&request->error, PCCD_E_NOMEM, "no memory for a batch");
    }
    int status = copy_segments(request, &work);
    status = status != 0 ? status : reserve_answers(request, &work, result);
    if (status == 0) {
        work.settings.trace = srv_tracing_lend();
        int threads = work_scenes(&work);
        srv_tracing_return(work.settings.trace);
        result->threads = threads > 0 ? (uint32_t)threads : 0;
        status = threads > 0
                     ? 0
                     : proto_error_set(&request->error, threads, "no memory for a batch");
    }
    srv_request_return_slot(request);
    status = status != 0 ? status : write_records(request, &work, result);
    if (status == 0) {
        add_up(request, &work, result);
        result->step = submit->step;
        result->ns_queue = request->begin_ns - request->arrival_ns;
        result->ns_batch = common_now_ns() - request->begin_ns;
    }
    free(work.lanes);
    return status;
}

/* ---- afterwards -------------------------------------------------------------------- */

/* What was counted, where list.session looks. */
static void tell_session(const struct srv_request *request)
{
    const struct proto_STATS_result *counted = &request->plan.batch->metrics.counters;
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

static void finish_batch(struct srv_request *request)
{
    struct srv_batch *batch = request->plan.batch;
    if (request->status == 0) {
        srv_metrics_add_all(&request->session->service->metrics, &batch->metrics);
        tell_session(request);
        for (uint32_t i = 0; i < batch->count; i++) {
            tell_scene(request, i);
        }
    }
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
    struct srv_plan plan = {
        .work = work_batch,
        .finish = finish_batch,
        .ring = ring,
        .batch = batch,
        .takes_slot = true,
        .replies = true};
    status = srv_request_start(call, &plan);
    if (status < 0) {
        srv_batch_end(batch);
    }
    return status;
}
