/* daemon/engine/result/answer.c - from what the workers found to the answer of a step.
 *
 * Room:     engine.
 * Does:     keep what the mode wants, sort, hash, count.
 * Threads:  [compute].
 */
#include "answer.h"

#include <math.h>

/* Mode first: of what was found before the bound had shrunk to its last value, keep what
 * may attain the earliest time. */
static void keep_earliest(struct eng_found *found, double bound)
{
    found->count = 0;
    for (struct eng_block *block = found->first; block; block = block->next) {
        struct eng_contact *contacts = (void *)block->data;
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

/* Counts over the sorted records. */
static void summarise(struct eng_step_result *result)
{
    if (result->mode == ENG_MODE_PAIRS) {
        const struct eng_pair *pairs = result->records;
        for (uint64_t i = 0; i < result->count; i++) {
            result->vf += pairs[i].kind == ENG_VF;
        }
    } else {
        const struct eng_contact *contacts = result->records;
        for (uint64_t i = 0; i < result->count; i++) {
            result->vf += contacts[i].kind == ENG_VF;
            result->possible += !(contacts[i].flags & ENG_PROVED);
            result->initial += (contacts[i].flags & ENG_INITIAL) != 0;
            result->toi_first = fmin(result->toi_first, contacts[i].toi);
        }
    }
    result->ee = result->count - result->vf;
}

static enum eng_verdict verdict_of(const struct eng_team *team, bool complete)
{
    uint64_t proved = 0;
    uint64_t possible = 0;
    for (uint32_t i = 0; i < team->count; i++) {
        proved += team->workers[i]->proved_seen;
        possible += team->workers[i]->possible_seen;
    }
    if (proved > 0) {
        return ENG_VERDICT_YES;
    }
    if (!complete) {
        return ENG_VERDICT_NONE;
    }
    return possible > 0 ? ENG_VERDICT_POSSIBLE : ENG_VERDICT_NO;
}

static void decide(const struct eng_team *team, struct eng_step_result *result,
                   uint64_t hash[2])
{
    uint32_t verdict = verdict_of(team, result->incomplete == ENG_COMPLETE);
    result->verdict = (enum eng_verdict)verdict;
    if (verdict == ENG_VERDICT_YES) {
        result->incomplete = ENG_COMPLETE; /* decided, whatever came after */
    }
    eng_hash(&verdict, sizeof verdict, hash);
}

static int collect(struct eng_step_memory *memory, const struct eng_team *team,
                   struct eng_step_result *result, uint64_t hash[2])
{
    struct eng_found *lists[ENG_THREADS_MAX];
    bool overflowed;
    double bound = eng_stop_time_bound(team->workers[0]->stop);
    for (uint32_t i = 0; i < team->count; i++) {
        lists[i] = &team->workers[i]->found;
        if (result->mode == ENG_MODE_FIRST) {
            keep_earliest(lists[i], bound);
        }
    }
    int status = eng_records_sort(&memory->sorter, lists, team->count, &memory->sorted,
                                  &overflowed);
    if (status != ENG_OK) {
        return status;
    }
    if (overflowed && result->incomplete == ENG_COMPLETE) {
        result->incomplete = ENG_INCOMPLETE_CONTACT_LIMIT;
    }
    result->records = memory->sorted.data;
    result->count = memory->sorted.count;
    eng_hash(memory->sorted.data, result->count * result->record_bytes, hash);
    summarise(result);
    return ENG_OK;
}

void eng_answer(struct eng_step_memory *memory, const struct eng_team *team,
                struct eng_step_result *result)
{
    uint64_t hash[2] = {0, 0};
    memory->sorted.count = 0;
    if (result->mode == ENG_MODE_ANY) {
        decide(team, result, hash);
    } else if (collect(memory, team, result, hash) != ENG_OK) {
        /* No memory to sort: an empty page that says it is not the whole answer. */
        memory->sorted.count = 0;
        result->incomplete = ENG_INCOMPLETE_CONTACT_LIMIT;
    }
    result->hash_hi = hash[0];
    result->hash_lo = hash[1];
}
