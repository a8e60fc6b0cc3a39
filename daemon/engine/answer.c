/* answer.c - from what the workers found to the answer of a step. */
#include "answer.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "clock.h"
#include "wait.h"

/* Mode first: of what was found before the bound had shrunk to its last value, keep what
 * may attain the earliest time. */
static void keep_earliest(struct eng_found *found, double bound)
{
    found->count = 0;
    for (struct eng_block *block = found->first; block; block = block->next) {
        struct pccd_contact *contacts = (void *)block->data;
        uint32_t kept = 0;
        for (uint32_t i = 0; i < block->count; i++) {
            if (contacts[i].toi <= bound) {
                contacts[kept++] = contacts[i];
            }
        }
        block->count = kept;
        found->count += kept;
    }
}

/* Mode first-per-pair: a contact that this thread found is the first of its two objects
 * unless another one's comes before it. All have searched; what is found twice is the
 * lower thread's. */
static bool is_first(const struct eng_team *team, const struct eng_worker *worker,
                     const struct pccd_contact *contact)
{
    for (uint32_t i = 0; i < team->count; i++) {
        const struct pccd_contact *other =
            i == worker->thread ? NULL
                                : eng_per_pair_find(&team->workers[i]->firsts, contact);
        if (other && (eng_contact_is_before(other, contact) ||
                      (i < worker->thread && !eng_contact_is_before(contact, other)))) {
            return false;
        }
    }
    return true;
}

static void keep_firsts(const struct eng_team *team, struct eng_worker *worker)
{
    const struct eng_per_pair *firsts = &worker->firsts;
    for (uint32_t i = 0; i < firsts->count; i++) {
        const struct pccd_contact *contact = &firsts->contacts[i];
        const struct pccd_pair name = {contact->kind, contact->object_a,
                                       contact->feature_a, contact->object_b,
                                       contact->feature_b};
        struct pccd_contact *kept =
            is_first(team, worker, contact) ? eng_found_add(&worker->found, &name) : NULL;
        if (kept) {
            *kept = *contact;
        }
    }
}

/* Keep, in modes whose answer is not all that was found, what is. All have searched. */
static void keep_answer(const struct eng_team *team, struct eng_worker *worker)
{
    if (worker->question->mode == PCCD_MODE_FIRST) {
        keep_earliest(&worker->found, eng_stop_time_bound(worker->stop));
    } else if (worker->question->mode == PCCD_MODE_FIRST_PER_PAIR) {
        keep_firsts(team, worker);
    }
}

/* A step that was stopped is answered soon: of what a thread has found it keeps as many
 * records as are merged in a millisecond. Which ones is as arbitrary as the moment. One
 * that would be late with all of them is stopped here. Measured: 50 ns a record to merge
 * with what else follows. */
#define LATE_RECORDS  8192u
#define NS_PER_RECORD 80u

static void keep_in_time(struct eng_worker *worker, uint32_t threads)
{
    uint64_t count = worker->found.count;
    if (count > LATE_RECORDS / threads &&
        eng_worker_is_late(worker, count * NS_PER_RECORD)) {
        eng_found_keep(&worker->found, LATE_RECORDS / threads);
    }
}

static enum pccd_verdict verdict_of(const struct eng_team *team, bool complete)
{
    uint64_t proved = 0;
    uint64_t possible = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        proved += team->workers[i]->proved_seen;
        possible += team->workers[i]->possible_seen;
    }
    if (proved > 0) {
        return PCCD_VERDICT_YES;
    }
    if (!complete) {
        return PCCD_VERDICT_NONE;
    }
    return possible > 0 ? PCCD_VERDICT_POSSIBLE : PCCD_VERDICT_NO;
}

static void decide(const struct eng_team *team, struct eng_step_result *result)
{
    uint32_t verdict = verdict_of(team, result->incomplete == PCCD_COMPLETE);
    result->verdict = (enum pccd_verdict)verdict;
    if (verdict == PCCD_VERDICT_YES) {
        result->incomplete = PCCD_COMPLETE; /* decided, whatever came after */
    }
    eng_hash_verdict(verdict, result->hash);
}

int eng_answer_begin(struct eng_step_memory *memory, const struct eng_team *team,
                     struct eng_records *out)
{
    assert(team->count >= 1 && team->workers[0]);
    struct eng_found *lists[ENG_THREADS_MAX];
    for (uint32_t i = 0; i < team->count; i++) {
        lists[i] = &team->workers[i]->found;
    }
    int status = eng_merge_begin(memory->merge, lists, team->count, out);
    eng_merge_set_cancel(memory->merge, team->workers[0]->question->cancel);
    memory->merge->no_hash = team->workers[0]->question->no_hash;
    return status;
}

void eng_answer_keep(struct eng_step_memory *memory, const struct eng_team *team)
{
    struct eng_worker *worker = team->workers[0];
    struct eng_answer_cache *kept = &memory->cache;
    assert(team->prunes && memory->merge->out == &memory->sorted);
    if (worker->question->mode == PCCD_MODE_ANY) {
        if (eng_answer_cache_decides(kept, team->scene)) {
            worker->proved_seen = 1;
            worker->proof = kept->proof;
            atomic_store_explicit(&worker->stop->stopped, true, memory_order_relaxed);
        }
        return;
    }
    double bound =
        eng_answer_cache_select(kept, team->scene, &memory->sorted, &memory->kept_counts);
    if (memory->sorted.count > 0) {
        memory->merge->out = &memory->found;
    } /* else what is found is the answer */
    if (worker->question->mode == PCCD_MODE_FIRST) {
        eng_worker_tighten(worker, bound);
    }
}

/* A part of the merge that began at `begin_ns` is done. */
static void end_part(struct eng_worker *worker, uint64_t begin_ns)
{
    worker->record.merge_ns += common_now_ns() - begin_ns;
    eng_worker_trace(worker, PCCD_TRACE_MERGE, begin_ns, 0, 0);
}

void eng_answer_by_team(struct eng_step_memory *memory, const struct eng_team *team,
                        struct eng_worker *worker)
{
    struct eng_merge *merge = memory->merge;
    if (worker->question->mode == PCCD_MODE_ANY) {
        return;
    }
    if (worker->question->mode == PCCD_MODE_FIRST ||
        worker->question->mode == PCCD_MODE_FIRST_PER_PAIR) {
        eng_wait_for_all(worker); /* what is the answer is known when all have searched */
        keep_answer(team, worker);
    }
    uint64_t begin_ns = common_now_ns();
    keep_in_time(worker, team->count);
    eng_merge_survey(merge, team->count, worker->thread);
    end_part(worker, begin_ns);
    eng_wait_for_all(worker);
    if (eng_merge_is_by_all(merge)) {
        begin_ns = common_now_ns();
        eng_merge_fill_buckets(merge, worker->thread);
        end_part(worker, begin_ns);
        eng_wait_for_all(worker);
        begin_ns = common_now_ns();
        eng_merge_finish(merge, worker->thread);
        end_part(worker, begin_ns);
    }
}

int eng_answer_collect(struct eng_step_memory *memory, const struct eng_team *team,
                       enum pccd_incomplete *incomplete, struct eng_counts *counts)
{
    struct eng_merge *merge = memory->merge;
    bool overflowed = false;
    if (team->count == 1) {
        keep_answer(team, team->workers[0]);
        keep_in_time(team->workers[0], 1);
        *incomplete = (enum pccd_incomplete)atomic_load_explicit(
            &team->workers[0]->stop->reason, memory_order_relaxed);
    }
    int status = eng_merge_end(merge, counts);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < team->count; i++) {
        overflowed |= team->workers[i]->found.overflowed;
    }
    overflowed |= merge->is_cut;
    if (eng_merge_is_given_up(merge)) {
        *incomplete = PCCD_INCOMPLETE_CANCELLED;
    }
    if (overflowed && *incomplete == PCCD_COMPLETE) {
        *incomplete = PCCD_INCOMPLETE_CONTACT_LIMIT;
    }
    return PCCD_OK;
}

/* The records of what stands come to those that were found. An answer that ended early
 * without them stays so: who asked for it in time gets it at once. One that is too long
 * begins with whichever come first. */
static int add_kept(struct eng_step_memory *memory, const struct eng_team *team,
                    struct eng_step_result *result, struct eng_counts *counts)
{
    if (result->incomplete == PCCD_INCOMPLETE_DEADLINE ||
        result->incomplete == PCCD_INCOMPLETE_CANCELLED) {
        struct eng_records sorted = memory->sorted;
        memory->sorted = memory->found;
        memory->found = sorted;
        return PCCD_OK;
    }
    result->counters.kept_records = memory->sorted.count;
    int status = eng_answer_cache_merge(&memory->sorted, &memory->found);
    if (status != PCCD_OK) {
        return status;
    }
    eng_counts_add(counts, &memory->kept_counts);
    uint64_t limit = team->workers[0]->found.limit;
    if (memory->sorted.count > limit) {
        memory->sorted.count = limit;
        eng_answer_cache_count(&memory->sorted, counts);
        if (result->incomplete == PCCD_COMPLETE) {
            result->incomplete = PCCD_INCOMPLETE_CONTACT_LIMIT;
        }
    }
    return PCCD_OK;
}

/* Return whether what was found is merged apart from what stands. */
static bool merge_is_beside(const struct eng_step_memory *memory)
{
    return memory->merge->out == &memory->found;
}

static int put_together(struct eng_step_memory *memory, const struct eng_team *team,
                        struct eng_step_result *result, struct eng_counts *counts)
{
    int status = eng_answer_collect(memory, team, &result->incomplete, counts);
    if (status == PCCD_OK && merge_is_beside(memory)) {
        status = add_kept(memory, team, result, counts);
    }
    if (status != PCCD_OK) {
        return status;
    }
    result->records = memory->sorted.data;
    result->count = memory->sorted.count;
    memcpy(result->counts, counts->kind, sizeof counts->kind);
    result->possible = counts->possible;
    result->initial = counts->initial;
    result->inside = counts->inside;
    result->coincident = team->scene->thickness.is_on ? 0 : counts->coincident;
    result->crowded = result->coincident > result->count / 2 ||
                      eng_answer_cache_is_crowded(team->scene, &memory->sorted, counts);
    result->toi_first = counts->toi_first;
    if (!memory->merge->no_hash) {
        eng_hash_end(counts->hash, result->count, result->hash);
    }
    return PCCD_OK;
}

/* See struct eng_step_result. */
static double safe_step(const double span[2], const struct eng_step_result *result)
{
    bool is_empty = result->mode == PCCD_MODE_ANY ? result->verdict == PCCD_VERDICT_NO
                                                  : result->count == 0;
    if (result->incomplete != PCCD_COMPLETE) {
        return span[0];
    }
    if (is_empty) {
        return span[1];
    }
    return result->toi_first > span[0] && result->toi_first <= span[1]
               ? nextafter(result->toi_first, 0)
               : span[0];
}

/* A pair that decided mode any. NULL: none has. */
static const struct pccd_pair *proof_of(const struct eng_team *team)
{
    for (uint32_t i = 0; i < team->count; i++) {
        if (team->workers[i]->proved_seen > 0) {
            return &team->workers[i]->proof;
        }
    }
    return NULL;
}

void eng_answer_end(struct eng_step_memory *memory, const struct eng_team *team,
                    struct eng_step_result *result)
{
    struct eng_counts counts = ENG_COUNTS_NONE;
    if (!team->prunes || result->mode == PCCD_MODE_ANY) {
        memory->sorted.count = 0;
    }
    if (result->mode == PCCD_MODE_ANY) {
        decide(team, result);
    } else if (put_together(memory, team, result, &counts) != PCCD_OK) {
        /* No memory to sort: an empty page that says it is not the whole answer. */
        memory->sorted.count = 0;
        eng_answer_nothing(result);
        result->incomplete = PCCD_INCOMPLETE_CONTACT_LIMIT;
    }
    result->safe_step = safe_step(team->workers[0]->question->span, result);
    eng_answer_cache_finish(&memory->cache, team->scene, team->workers[0]->question,
                            result, &counts, proof_of(team));
}

void eng_answer_nothing(struct eng_step_result *result)
{
    if (result->mode == PCCD_MODE_ANY) {
        eng_hash_verdict(PCCD_VERDICT_NONE, result->hash);
    } else {
        eng_hash_end(0, 0, result->hash);
    }
}
