/* batch.c - the driver of the tests of many pairs, and its rows. */
#include "batch.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "distance.h"
#include "kinds.h"
#include "solve.h"
#include "thick.h"

/* Pairs one by one between two looks at the clock, where none takes integers: some
 * 50 us. */
#define PAIRS_PER_LOOK 16u

/* Unsure pairs that advance together. */
#define PAIRS_ADVANCED 64u

/* One way to test pairs. */
struct row {
    /* In lanes: pairs that may be what is asked for, to batch->left; returns how many. */
    uint32_t (*reject)(struct eng_batch *batch, const struct eng_pairs *pairs);
    /* In lanes: of left[survivors] what is found, and what is unsure. */
    void (*decide)(struct eng_batch *batch, const struct eng_pairs *pairs);
    /* unsure[i] by itself: how often that took integers. NULL: nothing is unsure. */
    uint64_t (*ask)(struct eng_batch *batch, const struct eng_pairs *pairs, uint32_t i);
    /* In lanes: more of what was found. NULL: all is known. */
    void (*describe)(struct eng_batch *batch, const struct eng_pairs *pairs);
};

static uint32_t all_of(uint32_t count, uint32_t *pairs)
{
    for (uint32_t i = 0; i < count; i++) {
        pairs[i] = i;
    }
    return count;
}

static void find(struct eng_batch *batch, uint32_t pair)
{
    batch->index[batch->found++] = pair;
}

static void load_query(const struct eng_pairs *pairs, uint32_t pair,
                       struct eng_query *query)
{
    const uint32_t *quad = pairs->quads[pair];
    query->kind = (enum pccd_kind)pairs->kind;
    for (int i = 0; i < 4; i++) {
        memcpy(query->x[0][i], pairs->points[quad[i]].x0, sizeof query->x[0][i]);
        memcpy(query->x[1][i], pairs->points[quad[i]].x1, sizeof query->x[1][i]);
    }
}

/* Return the points of all pairs, as a kernel for a kind takes them. */
static struct eng_quads quads_of(const struct eng_pairs *pairs, uint32_t kind)
{
    return (struct eng_quads){kind, pairs->points, pairs->quads};
}

/* ---- contacts ---------------------------------------------------------------------- */

static uint32_t reject_axes(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    return batch->kernels->reject_axes(quads_of(pairs, pairs->kind), pairs->count,
                                       batch->left);
}

static uint32_t reject_thin(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    uint32_t count = pairs->known == ENG_KNOWN_NOTHING
                         ? reject_axes(batch, pairs)
                         : all_of(pairs->count, batch->left);
    return pairs->known == ENG_KNOWN_SIEVED || !eng_solvers[kind].has_kernels
               ? count
               : batch->kernels->filter(quads_of(pairs, kind), batch->left, count,
                                        batch->left);
}

static bool share_corner(const struct eng_pairs *pairs, uint32_t pair)
{
    struct eng_query query;
    load_query(pairs, pair, &query);
    return eng_exact_share_corner(&query, 0);
}

/* Leave out those of the unsure that certainly stay apart, in lanes. Features in a plane
 * as they begin, such as those of bodies at rest, have a cubic without a certain sign,
 * but a direction between them. Pairs that share a corner meet: the search says so soon.
 */
static void advance_unsure(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    const double until = fmin(batch->t_end + batch->tolerance + 0x1p-48, 1); /* solve.c */
    const struct eng_advance_limits limits = {.t_end = until,
                                              .depth = eng_thick_depth(batch->tolerance)};
    uint32_t *apart = batch->undecided;
    uint32_t apart_count = 0;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < batch->unsure_count; i++) {
        uint32_t pair = batch->unsure[i];
        if (share_corner(pairs, pair)) {
            batch->unsure[kept++] = pair;
        } else {
            apart[apart_count++] = pair;
        }
    }
    for (uint32_t i = 0; i < apart_count; i += PAIRS_ADVANCED) {
        uint32_t n = apart_count - i < PAIRS_ADVANCED ? apart_count - i : PAIRS_ADVANCED;
        struct eng_advance advance[PAIRS_ADVANCED] = {{0}}; /* at a distance of 0 */
        batch->kernels->advance(quads_of(pairs, pairs->kind), apart + i, n, &limits,
                                advance);
        for (uint32_t k = 0; k < n; k++) {
            batch->unsure[kept] = apart[i + k];
            kept += advance[k].now != ENG_ADVANCE_MISSES;
        }
    }
    batch->unsure_count = kept;
}

static void decide_thin(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    if (!eng_solvers[kind].has_kernels) {
        memcpy(batch->unsure, batch->left, batch->survivors * sizeof *batch->left);
        batch->unsure_count = batch->survivors;
        return;
    }
    struct eng_bracketed out = {
        .index = batch->index, .hits = batch->hits, .unsure = batch->unsure};
    batch->kernels->bracket(quads_of(pairs, kind), batch->left, batch->survivors,
                            batch->tolerance, batch->t_end, &out);
    batch->found = out.hit_count;
    batch->unsure_count = out.unsure_count;
    advance_unsure(batch, pairs);
}

/* A decision that was given up is left out. */
static uint64_t search(struct eng_batch *batch, const struct eng_pairs *pairs, uint32_t i)
{
    struct eng_exact_interrupt *interrupt = &batch->contacts->span.interrupt;
    uint64_t before = batch->contacts->queries;
    struct eng_query query;
    load_query(pairs, batch->unsure[i], &query);
    *interrupt = (struct eng_exact_interrupt){.should_stop = batch->should_stop,
                                              .owner = batch->owner};
    bool hits =
        eng_solvers[pairs->kind].search(&query, batch->tolerance, batch->t_end,
                                        batch->contacts, &batch->hits[batch->found]);
    batch->has_stopped = interrupt->has_stopped;
    *interrupt = (struct eng_exact_interrupt){0};
    if (hits && !batch->has_stopped) {
        find(batch, batch->unsure[i]);
    }
    return batch->contacts->queries - before;
}

/* ---- contacts at a distance -------------------------------------------------------- */

static uint32_t reject_thick(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    if (pairs->known == ENG_KNOWN_SIEVED) {
        return all_of(pairs->count, batch->left);
    }
    for (uint32_t i = 0; i < pairs->count; i++) {
        batch->lanes->reach[i] = eng_thick_reach(pairs->radius[i]);
    }
    return batch->kernels->reject_thick(quads_of(pairs, pairs->kind), pairs->count,
                                        batch->lanes->reach, batch->left);
}

/* Finish the pair left[slot] from what is known of it, as far as it has advanced; `query`
 * of an open one. */
static void finish(struct eng_batch *batch, uint32_t slot,
                   const struct eng_thick_query *query)
{
    if (eng_thick_decide(batch->thick, query, &batch->lanes->advance[slot],
                         batch->tolerance, batch->t_end, &batch->hits[batch->found])) {
        find(batch, batch->left[slot]);
    }
}

static void decide_thick(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    const struct eng_advance_limits limits = {pairs->question->approach, batch->t_end,
                                              eng_thick_depth(batch->tolerance)};
    uint32_t left = batch->survivors;
    for (uint32_t i = 0; i < left; i++) {
        batch->lanes->advance[i] =
            (struct eng_advance){.lo = eng_thick_sum(pairs->radius[batch->left[i]])};
    }
    batch->kernels->advance(quads_of(pairs, pairs->kind), batch->left, left, &limits,
                            batch->lanes->advance);
    for (uint32_t i = 0; i < left; i++) {
        batch->survivors -= batch->lanes->advance[i].now == ENG_ADVANCE_MISSES;
        if (batch->lanes->advance[i].now == ENG_ADVANCE_UNDECIDED) {
            batch->unsure[batch->unsure_count++] = i;
        } else {
            finish(batch, i, NULL);
        }
    }
}

static uint64_t ask_thick(struct eng_batch *batch, const struct eng_pairs *pairs,
                          uint32_t i)
{
    uint32_t slot = batch->unsure[i];
    struct eng_thick_query query = {.approach = pairs->question->approach};
    load_query(pairs, batch->left[slot], &query.query);
    memcpy(query.radius, pairs->radius[batch->left[slot]], sizeof query.radius);
    finish(batch, slot, &query);
    return 1;
}

static void describe_thick(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    batch->kernels->describe(quads_of(pairs, pairs->kind), batch->index, batch->found,
                             batch->hits);
}

/* ---- mode pairs -------------------------------------------------------------------- */

static uint32_t reject_none(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    return all_of(pairs->count, batch->left);
}

static void take_all(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    (void)pairs;
    memcpy(batch->index, batch->left, batch->survivors * sizeof *batch->left);
    batch->found = batch->survivors;
}

/* Return whether the exact sum of x[count], at most 8, is above 0. By sums without rests
 * that do not overlap, the largest last (Shewchuk: Adaptive precision floating-point
 * arithmetic, 1997). */
static bool is_sum_above_0(const double *x, int count)
{
    double part[8];
    int parts = 0;
    for (int i = 0; i < count; i++) {
        double sum = x[i];
        for (int k = 0; k < parts; k++) {
            double rest = eng_rest_of_difference(sum, -part[k]);
            sum += part[k];
            part[k] = rest;
        }
        part[parts++] = sum;
    }
    while (parts > 0 && part[parts - 1] == 0) {
        parts--;
    }
    return parts > 0 && part[parts - 1] > 0;
}

/* Return whether `high` is above `low` by more than r. */
static bool is_beyond(double high, double low, const double radius[3])
{
    const double terms[5] = {high, -low, -radius[0], -radius[1], -radius[2]};
    double r = eng_thick_sum(radius);
    double more = (high - low) - r;
    double margin = 8 * ENG_U * (fabs(high) + fabs(low) + r);
    return fabs(more) > margin ? more > 0 : is_sum_above_0(terms, 5);
}

/* Return whether along an axis all points of one feature lie more than r above all points
 * of the other, at both ends of the step. Decided exactly. */
static bool is_apart(const struct eng_pairs *pairs, uint32_t pair)
{
    const uint32_t *quad = pairs->quads[pair];
    const uint32_t points_a = common_kinds[pairs->kind].points[0];
    const uint32_t points_b = common_kinds[pairs->kind].points[1];
    for (int k = 0; k < 3; k++) {
        double low[2][2] = {{INFINITY, INFINITY}, {INFINITY, INFINITY}}; /* side, end */
        double high[2][2] = {{-INFINITY, -INFINITY}, {-INFINITY, -INFINITY}};
        for (uint32_t i = 0; i < points_a + points_b; i++) {
            const struct eng_point *point = &pairs->points[quad[i]];
            uint32_t side = i >= points_a;
            low[side][0] = fmin(low[side][0], point->x0[k]);
            low[side][1] = fmin(low[side][1], point->x1[k]);
            high[side][0] = fmax(high[side][0], point->x0[k]);
            high[side][1] = fmax(high[side][1], point->x1[k]);
        }
        for (int a = 0; a < 2; a++) {
            if (is_beyond(low[a][0], high[1 - a][0], pairs->radius[pair]) &&
                is_beyond(low[a][1], high[1 - a][1], pairs->radius[pair])) {
                return true;
            }
        }
    }
    return false;
}

static void take_together(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    for (uint32_t i = 0; i < pairs->count; i++) {
        if (!is_apart(pairs, i)) {
            find(batch, i);
        }
    }
}

/* ---- what is near ------------------------------------------------------------------ */

static void load_end(const struct eng_pairs *pairs, const uint32_t *indices, int count,
                     double (*x)[3])
{
    for (int i = 0; i < count; i++) {
        const struct eng_point *point = &pairs->points[indices[i]];
        memcpy(x[i], pairs->question->end == 0 ? point->x0 : point->x1, sizeof x[i]);
    }
}

/* Return how much is wanted of a pair that is near enough. */
static enum eng_distance_wanted wanted_for(const struct eng_pairs *pairs)
{
    switch (pairs->question->verb) {
    case PCCD_NEAR_CROSSINGS:
        return ENG_DISTANCE_WITHIN;
    case PCCD_NEAR_VERTICES:
        return ENG_DISTANCE_LENGTH;
    default:
        return ENG_DISTANCE_WHOLE;
    }
}

static uint32_t reject_far(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    return pairs->known == ENG_KNOWN_SIEVED
               ? all_of(pairs->count, batch->left)
               : batch->kernels->reject_at_end(
                     quads_of(pairs, eng_distance_form((enum pccd_kind)pairs->kind)),
                     pairs->count, pairs->question->end, pairs->reach, batch->left);
}

static void measure(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    struct eng_measured out = {.wanted = wanted_for(pairs),
                               .index = batch->index,
                               .found = batch->near,
                               .imprecise = batch->unsure,
                               .undecided = batch->undecided};
    batch->kernels->measure(quads_of(pairs, eng_distance_form(kind)), batch->left,
                            batch->survivors, pairs->question->end, pairs->reach, &out);
    batch->found = out.near_count;
    batch->near_count = out.imprecise_count;
    batch->unsure_count = out.imprecise_count + out.undecided_count;
    memcpy(batch->unsure + out.imprecise_count, batch->undecided,
           out.undecided_count * sizeof *batch->undecided);
    for (uint32_t i = 0; i < batch->found && out.wanted == ENG_DISTANCE_WHOLE; i++) {
        eng_distance_convert_params(kind, &batch->near[i]);
    }
}

/* A point that a face or an edge names twice comes after itself. */
static void rank(const struct eng_point *points, const uint32_t quad[4], uint8_t rank[4])
{
    for (int i = 0; i < 4; i++) {
        rank[i] = 0;
        for (int k = 0; k < 4; k++) {
            uint64_t mine = points[quad[i]].word1;
            uint64_t other = points[quad[k]].word1;
            rank[i] = (uint8_t)(rank[i] + (other < mine || (other == mine && k < i)));
        }
    }
}

static uint64_t ask_distance(struct eng_batch *batch, const struct eng_pairs *pairs,
                             uint32_t i)
{
    const uint64_t *integers = &batch->distances->decided[ENG_DISTANCE_BY_INTEGERS];
    const uint64_t before = *integers;
    enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    uint32_t pair = batch->unsure[i];
    double x[4][3];
    load_end(pairs, pairs->quads[pair], 4, x);
    if (i >= batch->near_count &&
        !eng_distance_within(batch->distances, kind, (const double(*)[3])x,
                             pairs->reach)) {
        return *integers - before;
    }
    if (wanted_for(pairs) != ENG_DISTANCE_WITHIN) {
        uint8_t ranks[4];
        rank(pairs->points, pairs->quads[pair], ranks);
        eng_distance_find(batch->distances, kind, (const double(*)[3])x, ranks,
                          &batch->near[batch->found]);
    }
    find(batch, pair);
    return *integers - before;
}

/* ---- what crosses ------------------------------------------------------------------ */

static void cross(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    struct eng_crossed out = {.index = batch->index, .undecided = batch->unsure};
    batch->kernels->cross_faces(pairs->points, pairs->fives, pairs->count,
                                pairs->question->end, &out);
    batch->found = out.count;
    batch->unsure_count = out.undecided_count;
}

static uint64_t ask_crossing(struct eng_batch *batch, const struct eng_pairs *pairs,
                             uint32_t i)
{
    const uint64_t *integers = &batch->distances->decided[ENG_DISTANCE_BY_INTEGERS];
    const uint64_t before = *integers;
    double x[5][3];
    load_end(pairs, pairs->fives[batch->unsure[i]], 5, x);
    if (eng_distance_crosses(batch->distances, (const double(*)[3])x)) {
        find(batch, batch->unsure[i]);
    }
    return *integers - before;
}

/* ---- the table --------------------------------------------------------------------- */

enum { CONTACTS, CONTACTS_THICK, PAIRS, PAIRS_THICK, DISTANCES, CROSSINGS, ROWS };

static const struct row rows[ROWS] = {
    [CONTACTS] = {reject_thin, decide_thin, search, NULL},
    [CONTACTS_THICK] = {reject_thick, decide_thick, ask_thick, describe_thick},
    [PAIRS] = {reject_axes, take_all, NULL, NULL},
    [PAIRS_THICK] = {reject_none, take_together, NULL, NULL},
    [DISTANCES] = {reject_far, measure, ask_distance, NULL},
    [CROSSINGS] = {reject_none, cross, ask_crossing, NULL},
};

static const struct row *row_of(const struct eng_pairs *pairs)
{
    const struct eng_question *question = pairs->question;
    if (eng_asks_near(question)) {
        return &rows[pairs->kind == PCCD_EF ? CROSSINGS : DISTANCES];
    }
    if (question->mode == PCCD_MODE_PAIRS) {
        return &rows[pairs->radius ? PAIRS_THICK : PAIRS];
    }
    return &rows[pairs->radius ? CONTACTS_THICK : CONTACTS];
}

/* Ask whether it is time to stop, if it is time to ask. */
static void look(struct eng_batch *batch, bool asks)
{
    if (asks && !batch->has_stopped && batch->should_stop) {
        batch->has_stopped = batch->should_stop(batch->owner);
    }
}

uint32_t eng_batch_test(struct eng_batch *batch, const struct eng_pairs *pairs)
{
    const struct row *row = row_of(pairs);
    assert(pairs->count <= ENG_CHUNK_MAX);
    batch->has_stopped = false;
    bool is_part = eng_asks_part(pairs->question) && !eng_asks_near(pairs->question);
    batch->tolerance =
        is_part ? eng_part_tolerance(pairs->question) : pairs->question->tolerance;
    batch->t_end = is_part ? eng_part_time(pairs->question, pairs->t_end) : pairs->t_end;
    batch->found = batch->unsure_count = 0;
    batch->survivors = row->reject(batch, pairs);
    row->decide(batch, pairs);
    for (uint32_t i = 0;
         i < batch->unsure_count && !batch->has_stopped && !pairs->question->brief; i++) {
        uint64_t integers = row->ask(batch, pairs, i);
        batch->integers += row == &rows[CONTACTS] ? 0 : integers;
        look(batch, integers > 0 || i % PAIRS_PER_LOOK == PAIRS_PER_LOOK - 1);
    }
    if (row->describe) {
        row->describe(batch, pairs);
    }
    for (uint32_t i = 0; i < batch->found && is_part; i++) {
        struct eng_hit *hit = &batch->hits[i];
        hit->toi = eng_part_toi(pairs->question, hit->toi);
        hit->toi_hi = eng_part_toi_hi(pairs->question, hit->toi_hi);
    }
    return batch->found;
}
