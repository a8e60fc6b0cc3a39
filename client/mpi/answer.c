/* answer.c - the answer of all ranks. */
#include "answer.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "cut.h"
#include "numbers.h"

/* ---- Answers that are too long. */

#define NAME_BITS (32 * RANKS_NAME_WORDS)

/* Return how many of this rank's records come before a name. */
static uint64_t count_before(const struct pccd_mpi *world,
                             const uint32_t name[RANKS_NAME_WORDS])
{
    size_t bytes = ranks_record_bytes(world->mode);
    uint64_t from = 0, end = world->record_count;
    while (from < end) {
        uint64_t middle = from + (end - from) / 2;
        uint32_t of_record[RANKS_NAME_WORDS];
        ranks_record_name((const char *)world->records + middle * bytes, world->mode,
                          of_record);
        if (ranks_name_is_before(of_record, name)) {
            from = middle + 1;
        } else {
            end = middle;
        }
    }
    return from;
}

/* Collective: keep the first world->record_limit of the records of all ranks, which have
 * more together, all of them sorted. */
static int keep_first(struct pccd_mpi *world)
{
    uint32_t name[RANKS_NAME_WORDS] = {0};
    int status = PCCD_OK;
    /* The greatest name with at most so many records before it, eight bits at a time, as
     * ranks wait for each other each time. */
    for (uint32_t bit = 0; bit < NAME_BITS && status == PCCD_OK; bit += 8) {
        uint32_t *word = &name[bit / 32], one = UINT32_C(1) << (24 - bit % 32);
        uint64_t before[255];
        for (uint32_t i = 0; i < 255; i++) {
            *word += one;
            before[i] = count_before(world, name);
        }
        status = ranks_sum(&world->link, before, 255);
        for (uint32_t i = 255; i > 0 && before[i - 1] > world->record_limit; i--) {
            *word -= one;
        }
    }
    if (status == PCCD_OK) {
        world->record_count = count_before(world, name);
    }
    return status;
}

/* Everything that is added up over the ranks. */
struct totals {
    struct ranks_sums sums; /* but for toi_first */
    uint64_t verdicts[PCCD_VERDICT_NONE + 1];
    uint64_t incomplete[PCCD_INCOMPLETE_CONTACT_LIMIT + 1];
    uint64_t threads, crossings, start_inside;
    uint64_t thin; /* contacts that begin where they meet, of objects without thickness */
    uint64_t said; /* struct ranks_stop */
    struct pccd_step_counters counters;
};

/* Words of struct ranks_sums that are added up over the ranks. */
#define SUMS_WORDS ((int)(offsetof(struct ranks_sums, toi_first) / sizeof(uint64_t)))

static bool has_thickness(const struct ranks_object *object)
{
    return object->settings.radius > 0 || object->mesh->radius_max > 0;
}

static bool is_thick(const struct pccd_mpi *world, uint32_t handle)
{
    return has_thickness(ranks_find_object(world, handle));
}

static bool is_any_thick(const struct pccd_mpi *world)
{
    bool is_any = false;
    for (uint32_t i = 0; i < world->object_count; i++) {
        is_any = is_any || has_thickness(world->objects[i]);
    }
    return is_any;
}

/* Return how many of this rank's records are thin, whatever the step's separation. */
static uint64_t count_thin(const struct pccd_mpi *world, enum pccd_mode mode)
{
    const struct pccd_contact *contacts = world->records;
    uint64_t thin = 0;
    for (uint64_t i = 0; mode <= PCCD_MODE_FIRST && i < world->record_count; i++) {
        if ((contacts[i].flags & (PCCD_INITIAL | PCCD_INSIDE)) != 0) {
            thin += !is_thick(world, contacts[i].object_a) &&
                    !is_thick(world, contacts[i].object_b);
        }
    }
    return thin;
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

static enum pccd_incomplete why_incomplete(const struct totals *totals,
                                           enum pccd_mode mode)
{
    if (verdict_of(totals, mode) == PCCD_VERDICT_YES) {
        return PCCD_COMPLETE; /* decided, whatever was left to do */
    }
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
    if (answer->incomplete != PCCD_COMPLETE || answer->crossings > 0) {
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
    answer->crossings = totals->crossings;
    answer->start_inside = totals->start_inside;
    answer->toi_first = answer->mode == PCCD_MODE_PAIRS ? 2 : sums->toi_first;
    answer->verdict = verdict_of(totals, answer->mode);
    answer->incomplete =
        why_incomplete(totals, settings->tells_start ? PCCD_MODE_ALL : answer->mode);
    answer->coincident =
        settings->separation > 0 || is_any_thick(world) ? 0 : sums->coincident;
    answer->crowded =
        answer->coincident > sums->total / 2 ||
        (answer->mode != PCCD_MODE_ANY &&
         sums->initial + sums->inside - (settings->separation > 0 ? 0 : totals->thin) >
             sums->total / 2);
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
#define PUT(unused, type, name, of_step, of_near, member, meaning)                       \
    times[count++] = -(double)answer->member;
    COMMON_TIMES(PUT, )
#undef PUT
    int status = ranks_min_doubles(&world->link, times, count);
    count = 2;
#define GET(unused, type, name, of_step, of_near, member, meaning)                       \
    answer->member = (uint64_t)-times[count++];
    COMMON_TIMES(GET, )
#undef GET
    *toi_first = times[0];
    *cut_ns = (uint64_t)-times[1];
    return status;
}

/* Keep the first records of an answer that is too long, and count them anew. */
static int shorten(struct pccd_mpi *world, enum pccd_mode mode, struct totals *totals)
{
    int status = keep_first(world);
    if (status == PCCD_OK) {
        totals->thin = count_thin(world, mode);
        status = ranks_sum(&world->link, &totals->thin, 1);
    }
    if (status == PCCD_OK) {
        ranks_records_sum(world, &totals->sums);
        status = ranks_min_doubles(&world->link, &totals->sums.toi_first, 1);
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, (uint64_t *)(void *)&totals->sums, SUMS_WORDS);
    }
    totals->incomplete[PCCD_INCOMPLETE_CONTACT_LIMIT]++;
    return status;
}

/* Return whether each rank has done all its work; else that says nothing of how the work
 * lies. */
static bool is_whole(const struct totals *totals)
{
    return totals->verdicts[PCCD_VERDICT_YES] == 0 &&
           totals->incomplete[PCCD_INCOMPLETE_DEADLINE] == 0 &&
           totals->incomplete[PCCD_INCOMPLETE_CANCELLED] == 0;
}

int ranks_answer_make(struct pccd_mpi *world, const struct pccd_step_settings *settings,
                      uint64_t cut_ns, struct pccd_answer *answer)
{
    struct totals totals = {.threads = answer->threads,
                            .said = world->stop.said,
                            .crossings = answer->crossings,
                            .start_inside = answer->start_inside,
                            .counters = answer->counters};
    int status = PCCD_OK;
    ranks_records_told(world, answer, &totals.sums);
    if (answer->mode == PCCD_MODE_FIRST) {
        double limit = ranks_records_limit(world);
        status = ranks_min_doubles(&world->link, &limit, 1);
        ranks_records_drop_later(world, limit);
        ranks_records_sum(world, &totals.sums);
    }
    totals.thin = count_thin(world, answer->mode);
    totals.verdicts[answer->verdict] = 1;
    totals.incomplete[answer->incomplete] = 1;
    double toi_first = totals.sums.toi_first;
    totals.sums.toi_first = 0;
    ranks_work_note(world, &answer->counters);
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
        status = ranks_stop_settle(&world->stop, totals.said);
    }
    if (status == PCCD_OK && is_whole(&totals)) {
        status = ranks_work_compare(world);
    }
    if (status == PCCD_OK && (is_whole(&totals) || cut_ns > 0)) {
        ranks_times_note(world, answer->times.step, cut_ns);
    }
    totals.sums.toi_first = toi_first;
    world->found = totals.sums.total;
    if (status == PCCD_OK && totals.sums.total > world->record_limit) {
        status = shorten(world, answer->mode, &totals);
    }
    write_answer(world, settings, &totals, answer);
    return status;
}

/* ---- what is near ----------------------------------------------------------------- */

/* Add up this rank's records. reach: the least distance, and the greatest, negative. */
static void sum_near(const struct pccd_mpi *world, struct ranks_sums *sums,
                     double reach[2])
{
    ranks_records_count_near(world, sums, &reach[0], &reach[1]);
    sums->toi_first = 0;
    reach[1] = -reach[1];
}

static int shorten_near(struct pccd_mpi *world, struct totals *totals, double reach[2])
{
    int status = keep_first(world);
    if (status == PCCD_OK) {
        sum_near(world, &totals->sums, reach);
        status = ranks_min_doubles(&world->link, reach, 2);
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, (uint64_t *)(void *)&totals->sums, SUMS_WORDS);
    }
    totals->incomplete[PCCD_INCOMPLETE_CONTACT_LIMIT]++;
    return status;
}

static void write_near(const struct pccd_near_settings *near, const struct totals *totals,
                       const double reach[2], struct pccd_answer *answer)
{
    const struct ranks_sums *sums = &totals->sums;
    memcpy(answer->counts, sums->counts, sizeof answer->counts);
    answer->total = sums->total;
    answer->distance_min = reach[0];
    answer->distance_max = reach[1] < 0 ? -reach[1] : 0;
    answer->incomplete = why_incomplete(totals, PCCD_MODE_ALL);
    answer->verdict =
        near->what == PCCD_NEAR_CROSSINGS && answer->incomplete == PCCD_COMPLETE
            ? verdict_of(totals, PCCD_MODE_ANY)
            : PCCD_VERDICT_NONE;
    answer->counters = totals->counters;
    answer->threads = (uint32_t)totals->threads;
    answer->crossings =
        near->what == PCCD_NEAR_CROSSINGS ? sums->counts[PCCD_EF] : totals->crossings;
    ranks_records_hash(sums, answer->hash);
    if (near->what == PCCD_NEAR_NEAREST && near->gap > 0) {
        answer->hash[0] = answer->hash[1] = 0;
    }
}

int ranks_answer_make_near(struct pccd_mpi *world, const struct pccd_near_settings *near,
                           struct pccd_answer *answer)
{
    struct totals totals = {.threads = answer->threads,
                            .said = world->stop.said,
                            .counters = answer->counters,
                            .crossings = answer->crossings};
    double reach[2], toi_first = 2;
    uint64_t cut_ns = 0;
    const double least = answer->distance_min;
    if (near->what == PCCD_NEAR_VERTICES) { /* they are no records yet */
        totals.sums = (struct ranks_sums){.total = 0};
        reach[0] = least;
        reach[1] = -answer->distance_max;
    } else {
        sum_near(world, &totals.sums, reach);
    }
    totals.verdicts[answer->verdict] = 1;
    totals.incomplete[answer->incomplete] = 1;
    int status = ranks_min_doubles(&world->link, reach, 2);
    if (status == PCCD_OK) {
        status = slowest(world, &cut_ns, answer, &toi_first);
    }
    if (status == PCCD_OK) {
        status = ranks_sum(&world->link, (uint64_t *)(void *)&totals,
                           (int)(sizeof totals / sizeof(uint64_t)));
    }
    if (status == PCCD_OK) {
        status = ranks_stop_settle(&world->stop, totals.said);
    }
    if (status == PCCD_OK && totals.sums.total > world->record_limit) {
        status = shorten_near(world, &totals, reach);
    }
    write_near(near, &totals, reach, answer);
    if (near->what == PCCD_NEAR_VERTICES && status == PCCD_OK) {
        if (answer->incomplete == PCCD_COMPLETE) {
            status = ranks_bounds_make(world, near, answer);
        } else {
            world->record_count = 0;
            answer->distance_min = 2e18;
            answer->distance_max = 0;
        }
    }
    answer->first = 0;
    answer->count = world->has_bounds ? world->bound_count : world->record_count;
    answer->cursor = answer->total;
    answer->near = !world->has_bounds && answer->count > 0 ? world->records : NULL;
    answer->vertex_bounds =
        world->has_bounds && answer->count > 0 ? world->bound_values : NULL;
    return status;
}
