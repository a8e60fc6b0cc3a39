/* answer.c - the answer of all ranks.
 *
 * Room:     client/mpi.
 * Does:     reductions over the ranks; the rest is computed alike by all of them.
 * Threads:  one.
 * Source:   answer.h.
 */
#include "answer.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "balance.h"
#include "records.h"
#include "step_numbers.h"

/* Everything that is added up over the ranks. */
struct totals {
    struct ranks_sums sums; /* but for toi_first */
    uint64_t verdicts[PCCD_VERDICT_NONE + 1];
    uint64_t incomplete[PCCD_INCOMPLETE_CONTACT_LIMIT + 1];
    uint64_t threads;
    struct pccd_step_counters counters;
};

static bool is_thick(const struct pccd_mpi *world,
                     const struct pccd_step_settings *settings)
{
    bool is_on = settings->separation > 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        const struct ranks_object *object = world->objects[o];
        is_on = is_on || object->settings.radius > 0 || object->mesh->radius_max > 0;
    }
    return is_on;
}

static enum pccd_verdict verdict_of(const struct totals *totals, enum pccd_mode mode)
{
    const uint64_t *verdicts = totals->verdicts;
    return mode != PCCD_MODE_ANY                 ? PCCD_VERDICT_NONE
           : verdicts[PCCD_VERDICT_YES] > 0      ? PCCD_VERDICT_YES
           : verdicts[PCCD_VERDICT_NONE] > 0     ? PCCD_VERDICT_NONE
           : verdicts[PCCD_VERDICT_POSSIBLE] > 0 ? PCCD_VERDICT_POSSIBLE
                                                 : PCCD_VERDICT_NO;
}

static enum pccd_incomplete why_incomplete(const struct totals *totals)
{
    for (uint32_t i = PCCD_INCOMPLETE_CONTACT_LIMIT; i > 0; i--) {
        if (totals->incomplete[i] > 0) {
            return (enum pccd_incomplete)i;
        }
    }
    return PCCD_COMPLETE;
}

/* As in one process: pccd.h, safe_step. */
static double safe_step(const struct pccd_answer *answer)
{
    bool is_empty = answer->mode == PCCD_MODE_ANY ? answer->verdict == PCCD_VERDICT_NO
                                                  : answer->total == 0;
    if (answer->incomplete != PCCD_COMPLETE) {
        return 0;
    }
    if (is_empty) {
        return 1;
    }
    return answer->toi_first > 0 && answer->toi_first <= 1
               ? nextafter(answer->toi_first, 0)
               : 0;
}

static void write_answer(const struct pccd_mpi *world,
                         const struct pccd_step_settings *settings,
                         const struct totals *totals, struct pccd_answer *answer)
{
    const struct ranks_sums *sums = &totals->sums;
    memcpy(answer->counts, sums->counts, sizeof answer->counts);
    answer->total = sums->total;
    answer->possible = sums->possible;
    answer->initial = sums->initial;
    answer->inside = sums->inside;
    answer->toi_first = answer->mode == PCCD_MODE_PAIRS ? 2 : sums->toi_first;
    answer->verdict = verdict_of(totals, answer->mode);
    answer->incomplete = why_incomplete(totals);
    answer->crowded = is_thick(world, settings) && answer->mode != PCCD_MODE_ANY &&
                      sums->initial + sums->inside > sums->total / 2;
    answer->counters = totals->counters;
    answer->threads = (uint32_t)totals->threads;
    answer->safe_step = safe_step(answer);
    if (answer->mode == PCCD_MODE_ANY) {
        ranks_verdict_hash((uint32_t)answer->verdict, answer->hash);
    } else {
        ranks_records_hash(sums, answer->hash);
    }
    answer->first = 0;
    answer->count = world->record_count;
    answer->cursor = answer->total;
    answer->contacts = NULL;
    answer->pairs = NULL;
    if (world->record_count > 0 && answer->mode == PCCD_MODE_PAIRS) {
        answer->pairs = world->records;
    } else if (world->record_count > 0) {
        answer->contacts = world->records;
    }
}

/* The longest of each time, over all ranks; cut_ns: 0 if nothing was cut. */
static int slowest(struct pccd_mpi *world, uint64_t *cut_ns, struct pccd_answer *answer,
                   double *toi_first)
{
    double times[16] = {*toi_first, -(double)*cut_ns};
    int count = 2;
#define PUT(unused, name, need, member, meaning) times[count++] = -(double)answer->member;
    COMMON_STEP_TIMES(PUT, )
#undef PUT
    int status = ranks_min_doubles(&world->link, times, count);
    count = 2;
#define GET(unused, name, need, member, meaning)                                         \
    answer->member = (uint64_t)-times[count++];
    COMMON_STEP_TIMES(GET, )
#undef GET
    *toi_first = times[0];
    *cut_ns = (uint64_t)-times[1];
    return status;
}

int ranks_answer_make(struct pccd_mpi *world, const struct pccd_step_settings *settings,
                      uint64_t cut_ns, struct pccd_answer *answer)
{
    struct totals totals = {.threads = answer->threads, .counters = answer->counters};
    int status = PCCD_OK;
    if (answer->mode == PCCD_MODE_FIRST) {
        double limit = ranks_records_limit(world);
        status = ranks_min_doubles(&world->link, &limit, 1);
        ranks_records_drop_later(world, limit);
    }
    ranks_records_sum(world, &totals.sums);
    totals.verdicts[answer->verdict] = 1;
    totals.incomplete[answer->incomplete] = 1;
    double toi_first = totals.sums.toi_first;
    totals.sums.toi_first = 0;
    balance_note(world, &answer->counters);
    world->share.sent_bytes = world->link.sent_bytes;
    if (status == PCCD_OK) {
        status = slowest(world, &cut_ns, answer, &toi_first);
    }
    if (status == PCCD_OK) {
        static_assert(sizeof totals % sizeof(uint64_t) == 0, "only words");
        status = ranks_sum(&world->link, (uint64_t *)(void *)&totals,
                           (int)(sizeof totals / sizeof(uint64_t)));
    }
    if (status == PCCD_OK) {
        status = balance_tell(world);
    }
    if (status == PCCD_OK) {
        balance_note_times(world, answer->times.step, cut_ns);
    }
    totals.sums.toi_first = toi_first;
    write_answer(world, settings, &totals, answer);
    return status;
}

int ranks_answer_make_near(struct pccd_mpi *world, struct pccd_answer *answer)
{
    struct totals totals = {.threads = answer->threads, .counters = answer->counters};
    double reach[2], toi_first = 2;
    uint64_t cut_ns = 0;
    ranks_records_sum_near(world, &totals.sums, &reach[0], &reach[1]);
    totals.sums.toi_first = 0;
    totals.verdicts[answer->verdict] = 1;
    totals.incomplete[answer->incomplete] = 1;
    reach[1] = -reach[1];
    int status = ranks_min_doubles(&world->link, reach, 2);
    if (status == PCCD_OK) {
        status = slowest(world, &cut_ns, answer, &toi_first);
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, (uint64_t *)(void *)&totals,
                           (int)(sizeof totals / sizeof(uint64_t)));
    }
    memcpy(answer->counts, totals.sums.counts, sizeof answer->counts);
    answer->total = totals.sums.total;
    answer->distance_min = reach[0];
    answer->distance_max = reach[1] < 0 ? -reach[1] : 0;
    answer->crossings = totals.sums.counts[PCCD_EF];
    answer->incomplete = why_incomplete(&totals);
    answer->verdict = answer->what == PCCD_NEAR_CROSSINGS
                          ? verdict_of(&totals, PCCD_MODE_ANY)
                          : PCCD_VERDICT_NONE;
    answer->counters = totals.counters;
    answer->threads = (uint32_t)totals.threads;
    ranks_records_hash(&totals.sums, answer->hash);
    answer->first = 0;
    answer->count = world->record_count;
    answer->cursor = answer->total;
    answer->near = world->record_count > 0 ? world->records : NULL;
    return status;
}
