/* srv_batch.c - a batch: a step of each of many scenes.
 *
 * First the scenes that are shared are stepped by the whole team, as by itself. What the
 * others move is staged, so that the slot is read; then those that are a large part of
 * the work are stepped by the team, and the rest by one thread each, whichever is free.
 * What each scene does is what it does alone (srv_step.h). A scene that fails says why in
 * its own answer.
 *
 * A batch that has to end answers at once: scenes whose turn has not come are incomplete,
 * and move behind the answer. What goes wrong then is said by their next step. What these
 * move and was not read is copied before the answer, so that the slot is the client's
 * again. One that waits for its turn then is answered by the loop, as soon as the client
 * has the answers before it, since pages are given in their order.
 */
#include "srv_batch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enginemem.h"
#include "invariant.h"
#include "now.h"
#include "service.h"
#include "session.h"
#include "shared.h"
#include "tracing.h"

/* Records are written in such units, so that those of each scene are aligned. */
#define UNIT_BYTES 64u

_Static_assert(sizeof(struct pccd_scene_answer) % UNIT_BYTES == 0, "whole units");

/* ---- the table --------------------------------------------------------------------- */

/* The scene of an entry, or why there is none; its member, if it is shared. */
static int find(const struct srv_session *session, uint32_t handle, uint64_t number,
                struct srv_scene **found, struct srv_member **member)
{
    struct srv_scene *scene = srv_handles_get(&session->scenes, handle);
    if (scene == NULL) {
        return PCCD_E_HANDLE;
    }
    *member = srv_shared_member(scene, session);
    if (*member != NULL && !(*member)->is_writer) {
        return PCCD_E_ACCESS;
    }
    if (scene->batch == number) {
        return PCCD_E_INVAL;
    }
    scene->batch = number;
    srv_resource_acquire(&scene->resource);
    *found = scene;
    return 0;
}

/* Every entry, at `table` in the slot. Returns how many segments they have together. */
static uint64_t read_table(struct srv_batch *batch, const struct srv_session *session,
                           const uint8_t *table)
{
    uint64_t number = ++session->service->batch_last;
    uint64_t first = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        struct srv_item *item = &batch->items[i];
        struct proto_batch_scene entry;
        memcpy(&entry, table + i * sizeof entry, sizeof entry); /* the one read of it */
        __asm__ volatile("" : : : "memory");
        *item = (struct srv_item){.first = (uint32_t)first,
                                  .segments = entry.segments,
                                  .event = {.scene = entry.scene}};
        first += entry.segments;
        item->status = find(session, entry.scene, number, &item->scene, &item->member);
        if (item->scene == NULL) {
            continue;
        }
        batch->claims[batch->claim_count++] = &item->scene->claim;
        if (item->member == NULL) {
            batch->order[batch->order_count++] = i;
        } else {
            PCCD_ASSERT(batch->shared_count < session->shared_count);
            item->answer = &batch->shared[batch->shared_count++];
        }
    }
    return first;
}

/* The next `count` items of `bytes` each behind *end. */
static void *put(void *base, size_t *end, size_t count, size_t bytes)
{
    void *at = base != NULL ? (char *)base + *end : NULL;
    *end += (count * bytes + 15) / 16 * 16;
    return at;
}

/* Lay out everything that a batch has, behind each other. Return the size of it all.
 * `batch` NULL: only that. */
static size_t lay_out(struct srv_batch *batch, const struct srv_session *session,
                      const struct srv_step_params *params)
{
    uint32_t count = params->scenes;
    uint32_t tallies = session->service->options->threads_max;
    struct srv_batch made = {.count = count, .tally_count = tallies};
    size_t end = 0;
    (void)put(batch, &end, 1, sizeof made + count * sizeof made.items[0]);
    made.tallies = put(batch, &end, tallies, sizeof *made.tallies);
    made.shared =
        put(batch, &end, count < session->shared_count ? count : session->shared_count,
            sizeof *made.shared);
    size_t cleared = end;
    made.claims = put(batch, &end, count, sizeof *made.claims);
    made.segments = put(batch, &end, params->slot.segments, sizeof *made.segments);
    made.order = put(batch, &end, count, sizeof *made.order);
    made.rest = put(batch, &end, count, sizeof *made.rest);
    if (batch != NULL) {
        memset(batch, 0, cleared);
        *batch = made;
        batch->user = session->owner.user;
        batch->bytes = end;
    }
    return end;
}

int srv_batch_begin(struct srv_call *call, struct srv_ring *ring,
                    const struct srv_step_params *params, struct srv_batch **batch)
{
    srv_assert_loop();
    const struct srv_session *session = call->session;
    const struct srv_slot_ref *slot = &params->slot;
    struct proto_error *error = &call->error;
    struct srv_quota_user *user = session->owner.user;
    const uint8_t *payload = NULL;
    int status = srv_ring_open_slot(ring, slot->slot, slot->seq, &payload, error);
    if (status != 0) {
        return status;
    }
    size_t bytes = lay_out(NULL, session, params);
    status = srv_quota_charge(user, SRV_QUOTA_SHM_BYTES, bytes, error);
    if (status != 0) {
        return status;
    }
    struct srv_batch *made = malloc(bytes);
    if (made == NULL) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, bytes);
        return proto_error_set(error, PCCD_E_NOMEM, "no memory for a batch");
    }
    (void)lay_out(made, session, params);
    uint64_t segments = read_table(made, session, payload);
    status = srv_ring_check_slot(ring, slot->slot, slot->seq, error);
    if (status == 0 && segments != slot->segments) {
        status = proto_error_set(
            error, PCCD_E_SEGMENT,
            "the scenes of the table have %llu segments, the request says %u",
            (unsigned long long)segments, slot->segments);
    }
    if (status != 0) {
        srv_batch_end(made);
        return status;
    }
    *batch = made;
    return 0;
}

void srv_batch_end(struct srv_batch *batch)
{
    srv_assert_loop();
    for (uint32_t i = 0; i < batch->count; i++) {
        if (batch->items[i].scene != NULL) {
            srv_resource_drop(&batch->items[i].scene->resource);
        }
    }
    srv_quota_refund(batch->user, SRV_QUOTA_SHM_BYTES, batch->bytes);
    free(batch);
}

/* ---- computed ---------------------------------------------------------------------- */

/* The part of the work that is done with a scene: MOVE is what is left of it behind the
 * answer. */
enum part { STAGE, COMPUTE, MOVE };

struct work {
    struct srv_request *request;
    const struct srv_step_params *params;
    struct srv_batch *batch;
    struct proto_answer nothing; /* of a scene that has not had its turn */
    bool reads_all; /* what is not staged in time cannot be kept: go on staging */
    struct pccd_scene_answer *answers; /* [batch->count], in the result region */
    uint64_t tables_bytes;
    struct eng_question question; /* of a scene that the whole team steps */
    struct srv_enginemem memory;  /* as the batch began */
    enum part part;               /* of the scenes that are worked on */
    uint32_t rest_count;          /* of batch->rest */
    uint32_t threads;             /* that work on these */
};

/* Add what the threads of a step did; that of one alone is the tally's. */
static void add_records(const struct work *work, const struct eng_step_result *step,
                        struct srv_batch_tally *tally)
{
    for (uint32_t i = 0; i < step->threads && i < work->batch->tally_count; i++) {
        struct srv_batch_tally *to =
            step->threads == 1 ? tally : &work->batch->tallies[i];
#define ADD(type, name, need, text) to->record.name += step->thread_records[i].name;
        PROTO_THREAD_RECORD(ADD)
#undef ADD
        to->scenes++;
    }
}

/* Describe what came of it, but for where its records are. */
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

/* Its answer, and what the loop will tell of it. `answer` NULL: the client has it. */
static void note(struct srv_item *item, struct pccd_scene_answer *answer,
                 struct srv_batch_tally *tally)
{
    const struct proto_answer *from = &item->scene->stepped.answer;
    if (answer != NULL) {
        describe(from, answer);
    }
    srv_step_note(item, from);
    srv_metrics_add_step(&tally->metrics, from);
    srv_stats_add_step(&tally->stats, from);
    if (item->answer != NULL) {
        *item->answer = *from;
    }
}

static void refuse(const struct srv_item *item, const char *why,
                   struct pccd_scene_answer *answer, struct srv_batch_tally *tally)
{
    answer->status = item->status;
    (void)snprintf(answer->why, sizeof answer->why, "%.*s", (int)sizeof answer->why - 1,
                   why);
    tally->failed++;
    srv_metrics_add_error(&tally->metrics, item->status);
}

static const char *why_not(int status)
{
    switch (status) {
    case PCCD_E_HANDLE:
        return "there is no such scene";
    case PCCD_E_ACCESS:
        return "the session may only read the scene";
    default:
        return "the batch names the scene more than once";
    }
}

/* Return whether the batch has to end: the scenes that are left do not begin. */
static bool is_over(const struct eng_question *question)
{
    return atomic_load_explicit(question->cancel, memory_order_relaxed) ||
           (question->deadline_ns != 0 && common_now_ns() >= question->deadline_ns);
}

/* Answer for a scene that has to move and does not begin. */
static void answer_late(struct work *work, uint32_t i)
{
    bool is_cancelled = atomic_load_explicit(work->question.cancel, memory_order_relaxed);
    describe(&work->nothing, &work->answers[i]);
    work->answers[i].incomplete =
        is_cancelled ? PCCD_INCOMPLETE_CANCELLED : PCCD_INCOMPLETE_DEADLINE;
    work->answers[i].number = work->batch->items[i].scene->number + 1;
}

/* Return how to do a part of a scene's work; its result and *staging.error are the
 * caller's. What is not staged before the answer is in a copy of the slot. */
static struct srv_step_run run_of(const struct work *work, uint32_t i, enum part part,
                                  const struct eng_question *question)
{
    const struct srv_request *request = work->request;
    struct srv_batch *batch = work->batch;
    struct srv_item *item = &batch->items[i];
    struct srv_ring *ring = request->copy == NULL ? request->plan.ring : NULL;
    return (struct srv_step_run){.request = work->request,
                                 .item = item,
                                 .params = work->params,
                                 .question = question,
                                 .step = work->params->step + i,
                                 .is_answered = part == MOVE,
                                 .staging = {.ring = ring,
                                             .payload = request->copy,
                                             .payload_bytes = request->copy_bytes,
                                             .slot = {.slot = work->params->slot.slot,
                                                      .segments = item->segments,
                                                      .seq = work->params->slot.seq},
                                             .table = batch->segments + item->first,
                                             .tables_bytes = work->tables_bytes,
                                             .joints_end = item->joints_end}};
}

static void work_scene(struct work *work, uint32_t i, enum part part,
                       const struct eng_question *question, struct srv_batch_tally *tally)
{
    struct srv_batch *batch = work->batch;
    struct srv_item *item = &batch->items[i];
    struct eng_step_result result;
    if (item->status != 0 || item->has_stepped || (part == STAGE && item->is_staged)) {
        return;
    }
    bool may_wait = item->member == NULL && part != MOVE && !work->reads_all;
    if (may_wait && is_over(question)) {
        if (part == COMPUTE) {
            answer_late(work, i);
        }
        return;
    }
    struct srv_step_run run = run_of(work, i, part, question);
    run.staging.error = &tally->error;
    run.result = &result;
    int status = item->is_staged ? 0 : srv_step_stage(&run);
    item->is_staged = true;
    if (status == 0 && part != STAGE) {
        status = srv_step_compute(&run);
    }
    PCCD_ASSERT(status != PCCD_E_AGAIN); /* none is brief */
    item->status =
        status == 0 ? 0 : srv_enginemem_tell(&work->memory, status, &tally->error);
    tally->upload_bytes += run.staging.copied;
    if (item->status != 0 && part == MOVE) {
        item->scene->owed = tally->error;
    } else if (item->status != 0) {
        refuse(item, tally->error.text, &work->answers[i], tally);
    } else if (part != STAGE) {
        add_records(work, &result, tally);
        note(item, part == MOVE ? NULL : &work->answers[i], tally);
    }
    if (item->status != 0 || part != STAGE) {
        atomic_fetch_add_explicit(&batch->done, 1, memory_order_relaxed);
    }
}

/* A scene that others share, whose memory may be another user's. */
static void work_shared(struct work *work, uint32_t i)
{
    const struct srv_scene *scene = work->batch->items[i].scene;
    struct srv_enginemem memory = work->memory;
    srv_enginemem_begin(&work->memory, scene->resource.owner->user);
    work_scene(work, i, STAGE, &work->question, &work->batch->tallies[0]);
    work_scene(work, i, COMPUTE, &work->question, &work->batch->tallies[0]);
    work->memory = memory;
    eng_payer()->account = &work->request->session->owner.user->engine;
}

/* Have one thread do a part of a scene's work. [team] */
static void work_alone(struct work *work, uint32_t i, enum part part,
                       struct eng_scene *scratch_from, uint32_t thread)
{
    struct eng_question question = work->question;
    if (thread != 0) {
        srv_thread_enter(SRV_THREAD_COMPUTE);
    }
    question.threads = 1;
    question.affinity = NULL;
    question.is_stopped = thread == 0 ? question.is_stopped : NULL; /* its own thread */
    question.track = thread;
    question.scratch_from = scratch_from;
    work_scene(work, i, part, &question, &work->batch->tallies[thread]);
    if (thread != 0) {
        srv_thread_enter(SRV_THREAD_OTHER);
    }
}

static void stage_item(void *context, uint32_t at, uint32_t thread)
{
    struct work *work = context;
    work_alone(work, work->batch->order[at], STAGE, NULL, thread);
}

/* One scene by one thread, which uses the worker of its first scene for all. [team] */
static void work_item(void *context, uint32_t at, uint32_t thread)
{
    struct work *work = context;
    const uint32_t *rest = work->batch->rest;
    const struct srv_scene *first = work->batch->items[rest[thread]].scene;
    work_alone(work, rest[at], work->part, first->engine, thread);
}

/* ---- who computes what ------------------------------------------------------------- */

#define SIZES 64u /* by powers of two */

static uint64_t expects(const struct work *work, uint32_t i)
{
    const struct srv_scene *scene = work->batch->items[i].scene;
    return scene->engine == NULL ? 1 : eng_step_expects(scene->engine, &work->question);
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
    uint32_t threads = work->question.threads;
    uint32_t ends[SIZES + 1] = {0};
    uint64_t all_ns = 0;
    uint32_t left = 0;
    for (uint32_t i = 0; i < batch->order_count; i++) {
        all_ns += expects(work, batch->order[i]);
    }
    for (uint32_t i = 0; i < batch->order_count; i++) {
        uint32_t item = batch->order[i];
        uint64_t own_ns = expects(work, item);
        if (threads > 1 && eng_team_pays(own_ns) && own_ns > all_ns / (2 * threads)) {
            work_scene(work, item, COMPUTE, &work->question, &batch->tallies[0]);
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

/* Leave all scenes that nobody shares to batch->rest, as they come. */
static void take_all(struct work *work)
{
    work->rest_count = work->batch->order_count;
    memcpy(work->batch->rest, work->batch->order,
           work->rest_count * sizeof *work->batch->rest);
}

static void work_together(struct work *work, uint32_t count, uint32_t threads,
                          void (*item)(void *context, uint32_t at, uint32_t thread))
{
    eng_parallel_for(&(const struct eng_parallel_for){.count = count,
                                                      .threads = threads,
                                                      .affinity = work->question.affinity,
                                                      .item = item,
                                                      .context = work});
}

/* Copy what the scenes move that are not staged, as the batch has to end; or stage them,
 * if it is too much. */
static void keep_rest(struct work *work)
{
    struct srv_request *request = work->request;
    const struct srv_batch *batch = work->batch;
    struct proto_error error = {0};
    bool is_left = false;
    for (uint32_t i = 0; i < batch->order_count && !is_left; i++) {
        const struct srv_item *item = &batch->items[batch->order[i]];
        is_left = item->status == 0 && !item->is_staged;
    }
    if (!is_left ||
        srv_step_keep(request, &request->copy, &request->copy_bytes, &error) == 0) {
        return;
    }
    work->reads_all = true;
    for (uint32_t i = 0; i < batch->order_count; i++) {
        stage_item(work, i, 0);
    }
    work->reads_all = false;
}

/* Stage what all scenes move that nobody shares: the slot is the client's again then. */
static void stage_scenes(struct work *work)
{
    const struct srv_batch *batch = work->batch;
    uint32_t threads = work->question.threads;
    uint64_t all_ns = 0;
    for (uint32_t i = 0; i < batch->order_count; i++) {
        all_ns += expects(work, batch->order[i]);
    }
    threads = threads < batch->order_count ? threads : batch->order_count;
    work->threads = threads > 1 && eng_team_pays(all_ns) ? threads : 1;
    work_together(work, batch->order_count, work->threads, stage_item);
    keep_rest(work);
    srv_request_return_slot(work->request);
}

/* Returns how many threads had a part in it. */
static uint32_t work_scenes(struct work *work)
{
    struct srv_batch *batch = work->batch;
    uint64_t rest_ns = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct srv_item *item = &batch->items[i];
        work->answers[i] = (struct pccd_scene_answer){.scene = item->event.scene};
        if (item->scene == NULL) {
            refuse(item, why_not(item->status), &work->answers[i], &batch->tallies[0]);
            atomic_fetch_add_explicit(&batch->done, 1, memory_order_relaxed);
        } else if (item->member != NULL) {
            work_shared(work, i);
        }
    }
    stage_scenes(work);
    if (is_over(&work->question)) { /* who computes what matters no more */
        take_all(work);
        for (uint32_t i = 0; i < work->rest_count; i++) {
            if (batch->items[batch->rest[i]].status == 0) {
                answer_late(work, batch->rest[i]);
            }
        }
        return work->threads;
    }
    work->part = COMPUTE;
    work->rest_count = work_large(work, &rest_ns);
    uint32_t threads = work->question.threads < work->rest_count ? work->question.threads
                                                                 : work->rest_count;
    work->threads = threads > 1 && eng_team_pays(rest_ns) ? threads : 1;
    work_together(work, work->rest_count, work->threads, work_item);
    threads = work->threads;
    for (uint32_t i = 0; i < batch->count; i++) {
        uint32_t own = batch->items[i].event.threads;
        threads = own > threads ? own : threads;
    }
    return threads;
}

/* Return how many scenes have not had their turn when the batch had to end. */
static uint32_t count_late(const struct srv_batch *batch)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < batch->count; i++) {
        count += batch->items[i].status == 0 && !batch->items[i].has_stepped;
    }
    return count;
}

/* Move these: first those that threads would have taken one by one. */
static void move_late(struct work *work)
{
    work->part = MOVE;
    work_together(work, work->rest_count, work->threads, work_item);
    for (uint32_t i = 0; i < work->batch->count; i++) {
        work_alone(work, i, MOVE, NULL, 0);
    }
}

/* ---- answers ----------------------------------------------------------------------- */

static uint64_t units_of(const struct srv_item *item)
{
    const struct srv_scene *scene = item->scene;
    if (item->status != 0 || !item->has_stepped) {
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
        const struct srv_item *item = &batch->items[i];
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
        if (count < total && item->event.incomplete == PCCD_COMPLETE) {
            answer->incomplete = PCCD_INCOMPLETE_RESULT_FULL;
            result->incomplete++;
        }
    }
    if (page.count > 0) {
        result->release = page.release;
    }
    return 0;
}

/* Tell what all threads have counted, and how many scenes are late. */
static void tell(const struct work *work, uint32_t late,
                 struct proto_BATCH_SUBMIT_result *result)
{
    const struct srv_request *request = work->request;
    const struct srv_batch_tally *tallies = work->batch->tallies;
    result->incomplete += late;
    for (uint32_t i = 0; i < work->question.threads; i++) {
        result->failed += tallies[i].failed;
        result->incomplete += (uint32_t)tallies[i].stats.steps_incomplete;
        result->ns_steps += tallies[i].stats.ns_step;
    }
    result->step = work->params->step;
    result->ns_queue = request->begin_ns - request->arrival_ns;
    result->ns_batch = common_now_ns() - request->begin_ns;
}

/* Add up what all threads have counted, which the first tally has then. */
static void add_up(struct srv_request *request, const struct work *work)
{
    struct srv_batch_tally *tallies = work->batch->tallies;
    for (uint32_t i = 0; i < work->question.threads; i++) {
        request->upload_bytes += tallies[i].upload_bytes;
        if (i > 0) {
            srv_metrics_add_all(&tallies[0].metrics, &tallies[i].metrics);
            srv_stats_add_all(&tallies[0].stats, &tallies[i].stats);
        }
    }
}

/* Have the tables of joints of each scene end where those of the next scenes begin: so
 * what is copied of them is at most the slot, however many scenes the batch has. */
static void part_joints(const struct work *work, uint64_t end)
{
    struct srv_batch *batch = work->batch;
    for (uint32_t i = batch->count; i-- > 0;) {
        struct srv_item *item = &batch->items[i];
        const struct proto_segment *segments = batch->segments + item->first;
        item->joints_end = end;
        for (uint32_t k = 0; k < item->segments; k++) {
            uint64_t at = segments[k].offset0;
            if (segments[k].kind == PROTO_SEGMENT_TURNING && at >= work->tables_bytes) {
                end = at < end ? at : end;
            }
        }
    }
}

/* Read the table of segments, which lies behind that of the scenes, in the slot or its
 * copy. */
static int copy_segments(struct work *work)
{
    const struct srv_request *request = work->request;
    const struct srv_slot_ref *slot = &work->params->slot;
    struct srv_ring *ring = request->plan.ring;
    uint64_t scenes_bytes = work->batch->count * sizeof(struct proto_batch_scene);
    uint64_t bytes = slot->segments * sizeof *work->batch->segments;
    const uint8_t *payload = request->copy;
    bool is_kept = payload != NULL;
    int status = is_kept ? 0
                         : srv_ring_open_slot(ring, slot->slot, slot->seq, &payload,
                                              &work->request->error);
    if (status != 0) {
        return status;
    }
    work->tables_bytes = scenes_bytes + bytes;
    memcpy(work->batch->segments, payload + scenes_bytes, bytes);
    part_joints(work, is_kept ? request->copy_bytes : ring->slot_stride);
    return is_kept
               ? 0
               : srv_ring_check_slot(ring, slot->slot, slot->seq, &work->request->error);
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

/* Keep what its threads did, as of one step. */
static void keep_records(struct srv_request *request, uint32_t threads)
{
    const struct srv_batch_tally *tallies = request->plan.batch->tallies;
    struct srv_laststep *last =
        srv_laststep_new(&request->session->service->spare_step, threads);
    for (uint32_t i = 0; last != NULL && i < threads; i++) {
        last->threads[i] =
            (struct srv_laststep_thread){tallies[i].record, tallies[i].scenes};
    }
    request->last_step = last;
}

/* All of a batch that has no answer: 0, or why none of it was done. */
static int work_open(struct work *work)
{
    struct srv_request *request = work->request;
    struct proto_BATCH_SUBMIT_result *result = &request->result.BATCH_SUBMIT;
    int status = reserve_answers(request, work, result);
    if (status != 0) {
        return status;
    }
    result->threads = work_scenes(work);
    status = write_records(request, work, result);
    uint32_t late = count_late(work->batch);
    if (status == 0) {
        tell(work, late, result);
    }
    if (status == 0 && late > 0) {
        srv_request_answer_now(request);
    }
    if (late > 0) {
        move_late(work);
    }
    add_up(request, work);
    keep_records(request, result->threads);
    return status;
}

int srv_batch_work(struct srv_request *request)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct srv_batch *batch = request->plan.batch;
    struct work work = {
        .request = request, .params = &params, .batch = batch, .threads = 1};
    struct eng_question *question = &work.question;
    bool is_early = srv_request_state(request) == SRV_REQUEST_EARLY;
    (void)srv_step_begin(request, &work.question);
    if (question->threads > batch->tally_count) { /* they have become more since */
        question->threads = batch->tally_count;
    }
    srv_step_nothing(request, PCCD_INCOMPLETE_DEADLINE, &work.nothing);
    atomic_store_explicit(&batch->has_begun, true, memory_order_relaxed);
    srv_enginemem_begin(&work.memory, request->session->owner.user);
    int status = copy_segments(&work);
    if (status == 0 && is_early) {
        take_all(&work);
        move_late(&work);
        add_up(request, &work);
    } else if (status == 0) {
        status = work_open(&work);
    }
    srv_tracing_return(question->trace);
    (void)srv_request_claim(request);
    return status;
}

/* ---- before its turn --------------------------------------------------------------- */

/* Write the answers of all scenes, none of which has begun; their numbers are not known.
 * The queue is locked. */
static bool write_nothing(struct srv_request *request)
{
    const struct srv_step_params params =
        srv_step_params_of(request->method, &request->params);
    struct srv_batch *batch = request->plan.batch;
    struct proto_BATCH_SUBMIT_result *result = &request->result.BATCH_SUBMIT;
    struct work work = {.request = request, .batch = batch};
    bool is_cancelled = atomic_load_explicit(&request->job.cancel, memory_order_relaxed);
    *result = (struct proto_BATCH_SUBMIT_result){
        .step = params.step, .ns_queue = common_now_ns() - request->arrival_ns};
    srv_thread_enter(SRV_THREAD_COMPUTE); /* whoever else uses the ring is held up */
    int status = reserve_answers(request, &work, result);
    srv_thread_enter(SRV_THREAD_LOOP);
    if (status != 0) {
        return false;
    }
    srv_step_nothing(request,
                     is_cancelled ? PCCD_INCOMPLETE_CANCELLED : PCCD_INCOMPLETE_DEADLINE,
                     &work.nothing);
    for (uint32_t i = 0; i < batch->count; i++) {
        const struct srv_item *item = &batch->items[i];
        work.answers[i] = (struct pccd_scene_answer){.scene = item->event.scene};
        if (item->scene == NULL) {
            refuse(item, why_not(item->status), &work.answers[i], &batch->tallies[0]);
        } else {
            describe(&work.nothing, &work.answers[i]);
        }
    }
    result->failed = batch->tallies[0].failed;
    result->incomplete = batch->count - result->failed;
    return true;
}

/* Return whether the loop may write its answers. */
static bool is_small(const struct srv_batch *batch)
{
    return batch->count <= SRV_KEPT_BYTES / 2 / sizeof(struct pccd_scene_answer);
}

bool srv_batch_answer_early(struct srv_request *request, enum pccd_incomplete why)
{
    srv_assert_loop();
    const struct srv_batch *batch = request->plan.batch;
    struct srv_quota_user *user = request->session->owner.user;
    struct proto_error error = {0};
    uint8_t *copy = NULL;
    uint64_t bytes = 0;
    (void)why; /* its flag says it, too */
    if (atomic_load_explicit(&request->state, memory_order_acquire) == SRV_REQUEST_OPEN) {
        return srv_request_answer_early(request, &request->result, NULL, 0, NULL);
    }
    if (batch->shared_count > 0 || !is_small(batch)) {
        return true; /* in its turn */
    }
    if (!srv_request_may_write(request)) {
        return false;
    }
    if (srv_step_keep(request, &copy, &bytes, &error) != 0) {
        return true; /* whoever stages it in its turn says why */
    }
    if (!srv_request_answer_early(request, &request->result, copy, bytes,
                                  write_nothing)) {
        srv_quota_refund(user, SRV_QUOTA_SHM_BYTES, bytes);
        free(copy);
        return false;
    }
    return true;
}
