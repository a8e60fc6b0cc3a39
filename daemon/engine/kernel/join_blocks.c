/* join_blocks.c - the boxes of two blocks against each other.
 *
 * By rounds of pairs of blocks. How many lanes of the first the box around the second
 * meets cannot be foreseen, nor which of them have any pair: a branch on either would be
 * taken wrong for most pairs of blocks, some 20 cycles each, and hide nothing of the 40
 * that pass until a block's bits are known. So each of these goes through the whole round
 * by a loop of its own, writes a list for the next one, and moves its end on by what
 * there was. Rows are read from memory each time: as many loads as sums, two of either a
 * cycle.
 */
#include "join.h"

#include <assert.h>

#include "begin.h"
#include "lanes_pack.h"
#include "meeting.h"
#include "movers.h"
#include "overlap.h"
#include "quantised.h"
#include "reach.h"
#include "still.h"
#include "table.h"

/* Blocks as a rule compares them, from the first of the run of ENG_WIDE that a round is
 * in. */
struct sides {
    uint32_t first_a;
    uint32_t first_b;
    const uint32_t *a;
    const uint32_t *b;
    const uint32_t *around;      /* b */
    const uint32_t *a_corner[2]; /* those of features that are looked at */
    const uint32_t *b_corner[3];
};

/* Are blocks compared as they lie in the trees? */
ENG_INLINE bool is_plain(enum rule rule)
{
    return rule == RULE_STEP || rule == RULE_UNTIL;
}

/* In whole numbers, are those of a and the boxes around b compared as they lie there? */
ENG_INLINE bool is_from_trees(enum rule rule)
{
    return rule == RULE_QUANTISED_STEP || rule == RULE_QUANTISED_BEGIN;
}

/* Numbers of four bytes from one block to the next; lanes are in the lowest bits. */
ENG_INLINE uint32_t block_stride(bool plain)
{
    static_assert(sizeof(struct eng_quantised_block) == sizeof(union eng_join_ready),
                  "blocks of one size");
    return (plain ? sizeof(struct eng_wide_block) : sizeof(union eng_join_ready)) / 4;
}

ENG_INLINE uint32_t around_stride(enum rule rule)
{
    return (is_from_trees(rule) ? sizeof(struct eng_quantised_box)
                                : sizeof(union eng_join_around)) /
           4;
}

ENG_INLINE struct bounds rows_at(const uint32_t *x, enum rule rule)
{
    return (struct bounds){x, rule == RULE_NEAR ? 3 * ENG_WIDE / 2 : 3 * ENG_WIDE,
                           ENG_WIDE};
}

/* ---- blocks as they are compared --------------------------------------------------- */

/* Bit i: a pair of the round has block i of its run. */
ENG_INLINE uint32_t blocks_of(const uint32_t *blocks, uint32_t count)
{
    uint32_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        used |= 1u << blocks[i] % ENG_WIDE;
    }
    return used;
}

ENG_INLINE void make_a_ready(const struct eng_join *job, struct eng_join_round *round,
                             uint32_t count, uint32_t first, enum rule rule)
{
    const bool is_near = rule == RULE_QUANTISED_NEAR;
    const struct quantised_weights weights = quantised_weights_at(job->t_end);
    struct quantised_more more;
    if (is_near && job->boxes == ENG_JOIN_AT) {
        more = quantised_more_of(job->cells);
    }
    for (uint32_t used = blocks_of(round->a + round->count, count); used != 0;
         used &= used - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(used);
        union eng_join_ready *ready = &round->ready_a[i];
        if (rule == RULE_NEAR && job->boxes == ENG_JOIN_AT) {
            rows_at_end(&job->a[first + i], job->end, job->growth, &ready->near);
        } else if (is_near && job->boxes == ENG_JOIN_AT) {
            quantised_rows_grown(&job->a_quantised[first + i], job->end, &more,
                                 &ready->quantised);
        } else if (rule == RULE_NEAR) {
            near_rows(&job->a[first + i], job->t_end, true, &ready->near);
        } else {
            quantised_rows_until(&job->a_quantised[first + i], weights, is_near, false,
                                 &ready->quantised);
        }
    }
}

ENG_INLINE void make_b_ready(const struct eng_join *job, struct eng_join_round *round,
                             uint32_t count, uint32_t first, enum rule rule)
{
    const bool is_near = rule == RULE_QUANTISED_NEAR;
    const struct quantised_weights weights = quantised_weights_at(job->t_end);
    for (uint32_t used = blocks_of(round->b + round->count, count); used != 0;
         used &= used - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(used);
        union eng_join_ready *ready = &round->ready_b[i];
        union eng_join_around *around = &round->ready_around[i];
        if (rule == RULE_NEAR && job->boxes == ENG_JOIN_AT) {
            rows_at_end(&job->b[first + i], job->end, 0, &ready->near);
            box_at_end(&job->b_boxes[first + i], job->end, &around->box);
        } else if (is_near && job->boxes == ENG_JOIN_AT) {
            quantised_rows_turned_at(&job->b_quantised[first + i], job->end,
                                     &ready->quantised);
            quantised_box_at(&job->b_quantised_boxes[first + i], job->end,
                             &around->quantised);
        } else if (rule == RULE_NEAR) {
            near_rows(&job->b[first + i], job->t_end, false, &ready->near);
            near_box(&job->b_boxes[first + i], job->t_end, &around->box);
        } else if (rule == RULE_QUANTISED_STEP) {
            quantised_rows_turned(&job->b_quantised[first + i], &ready->quantised);
        } else {
            quantised_rows_until(&job->b_quantised[first + i], weights, is_near, true,
                                 &ready->quantised);
            quantised_box_until(&job->b_quantised_boxes[first + i], weights, is_near,
                                &around->quantised);
        }
    }
}

ENG_INLINE struct sides make_ready(const struct eng_join *job,
                                   struct eng_join_round *round, uint32_t count,
                                   enum rule rule)
{
    const uint32_t first_a = round->first_a;
    const uint32_t first_b = round->first_b;
    struct sides sides = {.first_a = first_a, .first_b = first_b};
    if (is_plain(rule)) {
        sides.a = (const void *)(job->a + first_a);
        sides.b = (const void *)(job->b + first_b);
        sides.around = (const void *)(job->b_boxes + first_b);
        return sides;
    }
    if (rule == RULE_QUANTISED_BEGIN) {
        sides.b = (const void *)(job->b_quantised + first_b);
    } else {
        make_b_ready(job, round, count, first_b, rule);
        sides.b = (const void *)round->ready_b;
    }
    if (is_from_trees(rule)) {
        sides.a = (const void *)(job->a_quantised + first_a);
        sides.around = (const void *)(job->b_quantised_boxes + first_b);
    } else {
        make_a_ready(job, round, count, first_a, rule);
        sides.a = (const void *)round->ready_a;
        sides.around = (const void *)round->ready_around;
    }
    return sides;
}

/* The last time, as rules ask for it. */
struct until {
    eng_f weight;    /* until_of() */
    uint32_t growth; /* quantised_growth() */
};

ENG_INLINE struct until until_as_rules_ask(const struct eng_join *job)
{
    return (struct until){until_of(job->t_end),
                          quantised_growth(job->farthest, job->t_end)};
}

/* ---- boxes that meet --------------------------------------------------------------- */

/* List the boxes of a that meet the box around b, for each pair of blocks of the round:
 * where either is from sides->a and sides->b on, and which they are in their runs.
 * Returns how many. Of a run with itself, `self`, those of two blocks alone, and bits of
 * the other ones to *selves. Nor those that stand, or are foreign, where all of the block
 * is so, too. */
ENG_INLINE uint32_t list_boxes(struct eng_join *job, struct eng_join_round *round,
                               const struct sides *sides, uint32_t pairs, bool self,
                               enum rule rule, struct until until, uint32_t *selves)
{
    const uint32_t stride = block_stride(is_plain(rule));
    uint32_t count = 0;
    *selves = 0;
    for (uint32_t i = pairs; i-- > 0;) {
        uint32_t n = round->a[round->count + i] % ENG_WIDE;
        uint32_t m = round->b[round->count + i] % ENG_WIDE;
        struct bounds around = {sides->around + m * around_stride(rule), 4, 1};
        struct bounds rows = rows_at(sides->a + n * stride, rule);
        uint32_t bits = rule == RULE_QUANTISED_BEGIN
                            ? overlap_from_begin(around, rows, false, until.growth)
                            : overlap(around, rows, rule, until.weight);
        if (self) {
            uint32_t is_one = n == m;
            *selves |= is_one << n;
            bits &= is_one - 1;
        }
        if (job->a_moving || job->a_own) {
            bits = keep_marked_boxes(job, bits, sides->first_a + n, sides->first_b + m);
        }
        eng_pack16(round->place + count, bits, n * stride | m * stride << 16);
        count += eng_pack16(round->box + count, bits, n * ENG_WIDE | m << 8);
    }
    return count;
}

ENG_INLINE uint32_t begin_by(struct eng_join *job, struct eng_join_round *round,
                             uint32_t pairs, bool self, enum rule rule,
                             struct sides *sides, uint32_t *selves)
{
    const struct until until = until_as_rules_ask(job);
    *sides = make_ready(job, round, pairs, rule);
    return self ? list_boxes(job, round, sides, pairs, true, rule, until, selves)
                : list_boxes(job, round, sides, pairs, false, rule, until, selves);
}

/* One for all joins: one for each takes the compiler three times as long. */
static __attribute__((noinline)) uint32_t
begin_round(struct eng_join *job, struct eng_join_round *round, uint32_t pairs, bool self,
            enum rule rule, struct sides *sides, uint32_t *selves)
{
    switch (rule) {
#define BEGIN(rule)                                                                      \
    case rule:                                                                           \
        return begin_by(job, round, pairs, self, rule, sides, selves);
        BEGIN(RULE_STEP)
        BEGIN(RULE_UNTIL)
        BEGIN(RULE_NEAR)
        BEGIN(RULE_QUANTISED_STEP)
        BEGIN(RULE_QUANTISED_UNTIL)
        BEGIN(RULE_QUANTISED_BEGIN)
        BEGIN(RULE_QUANTISED_NEAR)
#undef BEGIN
    default: /* RULE_SWEPT */
        return 0;
    }
}

/* What a list of nodes or features asks for: their vertices, of either side, 0 if they do
 * not matter; a box with itself (`twins`), as nodes do and features do not? */
struct wants {
    uint32_t a_vertices;
    uint32_t b_vertices;
    bool twins;
};

ENG_INLINE void look_at_corners(const struct eng_join *job, struct sides *sides,
                                struct wants wants)
{
    if (wants.a_vertices == 2) {
        sides->a_corner[0] = job->a_corner[0] + sides->first_a * ENG_WIDE;
        sides->a_corner[1] = job->a_corner[1] + sides->first_a * ENG_WIDE;
    }
    for (uint32_t k = 0; k < wants.b_vertices; k++) {
        sides->b_corner[k] = job->b_corner[k] + sides->first_b * ENG_WIDE;
    }
}

/* The lanes of block m whose features have no vertex of feature `slot`. */
ENG_INLINE uint32_t without_vertices(const struct sides *sides, uint32_t slot, uint32_t m,
                                     struct wants wants)
{
    const uint32_t *own[3] = {sides->b_corner[0], sides->b_corner[1], sides->b_corner[2]};
    uint32_t vertex[2] = {sides->first_a * ENG_WIDE + slot, 0};
    uint32_t bits = 0;
    if (wants.a_vertices == 2) {
        vertex[0] = sides->a_corner[0][slot];
        vertex[1] = sides->a_corner[1][slot];
    }
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        eng_left left = eng_left_all();
#pragma GCC unroll 3
        for (uint32_t k = 0; k < wants.b_vertices; k++) {
            eng_fi lanes = eng_fi_load(own[k] + m * ENG_WIDE + part * ENG_F_LANES);
#pragma GCC unroll 2
            for (uint32_t i = 0; i < wants.a_vertices; i++) {
                left = eng_left_unequal(left, lanes, eng_fi_all(vertex[i]));
            }
        }
        bits |= eng_left_bits(left) << (part * ENG_F_LANES);
    }
    return bits;
}

/* Lanes of b that a box of a has pairs with. */
ENG_INLINE uint32_t lanes_of(const struct sides *sides, uint32_t place, uint32_t box,
                             struct wants wants, enum rule rule, struct until until)
{
    struct bounds a = rows_at(sides->a + (place & 0xffff), rule);
    struct bounds b = rows_at(sides->b + (place >> 16), rule);
    uint32_t bits = rule == RULE_QUANTISED_BEGIN
                        ? overlap_from_begin(a, b, true, until.growth)
                        : overlap(a, b, rule, until.weight);
    if (wants.a_vertices > 0) {
        bits &= without_vertices(sides, box & 0xff, box >> 8, wants);
    }
    return bits;
}

/* Of `count` boxes those with pairs that are wanted, and the lanes of these. */
ENG_INLINE uint32_t test_boxes(struct eng_join_round *round, const struct sides *sides,
                               uint32_t count, struct wants wants, enum rule rule,
                               struct until until)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t box = round->box[i];
        uint32_t bits = lanes_of(sides, round->place[i], box, wants, rule, until);
        round->box[found] = box;
        round->lanes[found] = bits;
        found += bits != 0;
    }
    return found;
}

/* The same of the boxes of blocks with themselves: behind the `found` ones. */
ENG_INLINE uint32_t test_selves(struct eng_join_round *round, const struct sides *sides,
                                uint32_t selves, uint32_t found, struct wants wants,
                                enum rule rule, struct until until)
{
    const uint32_t stride = block_stride(is_plain(rule));
    for (; selves != 0; selves &= selves - 1) {
        uint32_t n = (uint32_t)__builtin_ctz(selves);
        uint32_t after = wants.twins ? 0xffff : 0xfffe; /* those, of the box in lane i */
        for (uint32_t i = 0; i < ENG_WIDE; i++) {
            uint32_t box = n * ENG_WIDE | i | n << 8;
            uint32_t bits = lanes_of(sides, (n * stride + i) | n * stride << 16, box,
                                     wants, rule, until) &
                            after << i;
            round->box[found] = box;
            round->lanes[found] = bits;
            found += bits != 0;
        }
    }
    return found;
}

/* The next pairs of the round, by a rule. */
ENG_INLINE uint32_t find_by(struct eng_join *job, struct eng_join_round *round,
                            uint32_t pairs, bool self, struct wants wants, enum rule rule)
{
    const struct until until = until_as_rules_ask(job);
    struct sides sides;
    uint32_t selves;
    uint32_t count = begin_round(job, round, pairs, self, rule, &sides, &selves);
    look_at_corners(job, &sides, wants);
    uint32_t found = test_boxes(round, &sides, count, wants, rule, until);
    job->tests += pairs + count;
    if (self) {
        job->tests += ENG_WIDE * (uint32_t)__builtin_popcount(selves);
        found = test_selves(round, &sides, selves, found, wants, rule, until);
    }
    return found;
}

/* ---- pairs, into lists ------------------------------------------------------------- */

/* Those of the lanes that no time brings together with the box. */
ENG_INLINE uint32_t never_of(const struct eng_join *job, uint32_t slot, uint32_t block,
                             uint32_t lanes, bool quantised)
{
    uint32_t n = slot / ENG_WIDE;
    uint32_t lane = slot % ENG_WIDE;
    enum rule rule = quantised ? RULE_QUANTISED_STEP : RULE_STEP;
    const void *box = quantised ? (const void *)&job->a_quantised[n].row[0][0][lane]
                                : (const void *)&job->a[n].row[0][0][lane];
    const void *rows =
        quantised ? (const void *)&job->b_quantised[block] : (const void *)&job->b[block];
    return lanes & never_together(rows_at(box, rule), rows_at(rows, rule), quantised);
}

/* As many as there is room for. Times are looked at here, not before: what a list has
 * without them is compared with what went for them. */
ENG_INLINE uint32_t write_by(struct eng_join *job, struct eng_join_round *round,
                             bool in_time, bool quantised, uint32_t *out_a,
                             uint32_t *out_b, uint32_t room)
{
    uint32_t count = 0;
    uint32_t i = round->next;
    for (; i < round->end && count + ENG_WIDE <= room; i++) {
        uint32_t box = round->box[i];
        uint32_t slot = round->first_a * ENG_WIDE + (box & 0xff);
        uint32_t block = round->first_b + (box >> 8);
        uint32_t lanes = round->lanes[i];
        if (in_time) {
            uint32_t never = never_of(job, slot, block, lanes, quantised);
            job->apart_in_time += (uint32_t)__builtin_popcount(never);
            lanes ^= never;
        }
        eng_fill16(out_a + count, slot);
        count += eng_pack16(out_b + count, lanes, block * ENG_WIDE);
    }
    round->next = i;
    return count;
}

static uint32_t write_pairs(struct eng_join *job, struct eng_join_round *round,
                            uint32_t *out_a, uint32_t *out_b, uint32_t room)
{
    if (!job->in_time || job->boxes != ENG_JOIN_MOVING) {
        return write_by(job, round, false, false, out_a, out_b, room);
    }
    return job->a_quantised ? write_by(job, round, true, true, out_a, out_b, room)
                            : write_by(job, round, true, false, out_a, out_b, room);
}

/* ---- plain swept boxes ------------------------------------------------------------- */

/* A block whose boxes stand still, and the vertices of its features. */
struct held {
    struct held_rows rows;
    eng_fi vertex[3][PARTS];
};

ENG_INLINE void hold(const struct eng_join *job, uint32_t m, struct wants wants,
                     struct held *held)
{
    hold_rows(rows_at((const void *)&job->b[m], RULE_SWEPT), &held->rows);
#pragma GCC unroll 3
    for (uint32_t k = 0; k < wants.b_vertices; k++) {
        UNROLL_PARTS
        for (uint32_t part = 0; part < PARTS; part++) {
            held->vertex[k][part] =
                eng_fi_load(job->b_corner[k] + m * ENG_WIDE + part * ENG_F_LANES);
        }
    }
}

/* Lanes of the block that box `slot` of a meets and has no vertex in common with. */
ENG_INLINE uint32_t lanes_of_held(const struct eng_join *job, uint32_t slot,
                                  const struct held *held, struct wants wants)
{
    const void *lows = &job->a[slot / ENG_WIDE].row[0][0][slot % ENG_WIDE];
    uint32_t vertex[2] = {slot, 0};
    uint32_t bits = 0;
    if (wants.a_vertices == 2) {
        vertex[0] = job->a_corner[0][slot];
        vertex[1] = job->a_corner[1][slot];
    }
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        eng_left left = met_by_held(rows_at(lows, RULE_SWEPT), &held->rows, part);
#pragma GCC unroll 3
        for (uint32_t k = 0; k < wants.b_vertices; k++) {
#pragma GCC unroll 2
            for (uint32_t i = 0; i < wants.a_vertices; i++) {
                left =
                    eng_left_unequal(left, held->vertex[k][part], eng_fi_all(vertex[i]));
            }
        }
        bits |= eng_left_bits(left) << (part * ENG_F_LANES);
    }
    return bits;
}

/* The boxes of block n of a that meet the box around block m of b: one bit each. */
ENG_INLINE uint32_t boxes_met(const struct eng_join *job, uint32_t n, uint32_t m)
{
    return overlap((struct bounds){&job->b_boxes[m], 4, 1},
                   rows_at((const void *)&job->a[n], RULE_SWEPT), RULE_SWEPT, (eng_f){0});
}

/* One pair of blocks after the other, without a list: where boxes have seven pairs or so
 * each, a wrong guess of how many boxes have any is less than what it is to read rows for
 * each of them. They are looked up a pair of blocks ahead, so that a wrong guess is known
 * while there is still work to do. round->next: the boxes of the last pair of blocks that
 * are still to be tested, one bit each; 0: they have not been looked up. */
ENG_INLINE uint32_t join_swept(struct eng_join *job, struct eng_join_round *round,
                               bool may_be_self, struct wants wants, uint32_t *out_a,
                               uint32_t *out_b, uint32_t room)
{
    const uint32_t after = wants.twins ? 0xffff : 0xfffe; /* those, of the first box */
    uint32_t left = round->count;
    uint32_t count = 0;
    uint32_t boxes = round->next;
    if (boxes == 0 && left > 0) {
        boxes = boxes_met(job, round->a[left - 1], round->b[left - 1]);
    }
    while (left > 0 && count + ENG_WIDE <= room) {
        uint32_t n = round->a[left - 1];
        uint32_t m = round->b[left - 1];
        bool self = may_be_self && job->a == job->b && n == m;
        uint32_t ahead = 0;
        struct held held;
        if (left > 1) {
            ahead = boxes_met(job, round->a[left - 2], round->b[left - 2]);
        }
        job->tests += (uint32_t)__builtin_popcount(boxes);
        hold(job, m, wants, &held);
        for (; boxes != 0 && count + ENG_WIDE <= room; boxes &= boxes - 1) {
            uint32_t i = (uint32_t)__builtin_ctz(boxes);
            uint32_t slot = n * ENG_WIDE + i;
            uint32_t lanes = lanes_of_held(job, slot, &held, wants);
            lanes = self ? lanes & after << i : lanes;
            eng_fill16(out_a + count, slot);
            count += eng_pack16(out_b + count, lanes, m * ENG_WIDE);
        }
        if (boxes != 0) {
            job->tests -= (uint32_t)__builtin_popcount(boxes);
            break;
        }
        job->tests++;
        boxes = ahead;
        left--;
    }
    round->count = left;
    round->next = boxes;
    round->end = boxes;
    return count;
}

/* ---- by any rule ------------------------------------------------------------------- */

#define FIND(rule) find_by(job, round, pairs, self, wants, rule)

ENG_INLINE uint32_t find(struct eng_join *job, struct eng_join_round *round,
                         uint32_t pairs, bool self, struct wants wants)
{
    if (!wants.twins && job->a_quantised) {
        if (job->boxes == ENG_JOIN_AT) {
            return FIND(RULE_QUANTISED_NEAR);
        }
        if (job->boxes == ENG_JOIN_NEAR) {
            return quantised_growth(job->farthest, job->t_end) > 0
                       ? FIND(RULE_QUANTISED_BEGIN)
                       : FIND(RULE_QUANTISED_NEAR);
        }
        return job->t_end < 1 ? FIND(RULE_QUANTISED_UNTIL) : FIND(RULE_QUANTISED_STEP);
    }
    bool stands = job->boxes == ENG_JOIN_NEAR || job->boxes == ENG_JOIN_AT;
    return stands ? FIND(RULE_NEAR) : job->t_end < 1 ? FIND(RULE_UNTIL) : FIND(RULE_STEP);
}

ENG_INLINE uint32_t join(struct eng_join *job, struct eng_join_round *round,
                         bool may_be_self, struct wants wants, uint32_t *out_a,
                         uint32_t *out_b, uint32_t room)
{
    if (job->boxes == ENG_JOIN_SWEPT) {
        assert(!job->a_moving && !job->a_own);
        return join_swept(job, round, may_be_self, wants, out_a, out_b, room);
    }
    uint32_t count = write_pairs(job, round, out_a, out_b, room);
    while (round->count > 0 && round->next == round->end) {
        uint32_t pairs = round->count < ENG_JOIN_ROUND ? round->count : ENG_JOIN_ROUND;
        round->count -= pairs;
        round->first_a = round->a[0] / ENG_WIDE * ENG_WIDE;
        round->first_b = round->b[0] / ENG_WIDE * ENG_WIDE;
        bool self = may_be_self && job->a == job->b && round->first_a == round->first_b;
        round->end = find(job, round, pairs, self, wants);
        if (job->a_moving) {
            round->end = keep_moving_lanes(job, round, round->end);
        }
        /* Without b_own list_boxes has left out what is foreign. */
        if (job->b_own && has_foreign(job, round, pairs)) {
            round->end = keep_own_lanes(job, round, round->end);
        }
        round->next = 0;
        count += write_pairs(job, round, out_a + count, out_b + count, room - count);
    }
    return count;
}

uint32_t ENG_KERNEL(join_nodes)(struct eng_join *job, struct eng_join_round *round,
                                uint32_t *out_a, uint32_t *out_b, uint32_t room)
{
    return join(job, round, true, (struct wants){0, 0, true}, out_a, out_b, room);
}

/* Two different features of one vertex each have none in common. Features of both sides
 * are in one list if they have as many points. */
#define JOIN_FEATURES(NAME, value, name, points_a, points_b, text)                       \
    static_assert((points_a) <= 2 && (points_b) <= 3, "without_vertices");               \
    uint32_t ENG_KERNEL(join_##name)(struct eng_join * job,                              \
                                     struct eng_join_round * round, uint32_t * out_a,    \
                                     uint32_t * out_b, uint32_t room)                    \
    {                                                                                    \
        const bool have_common = (points_a) + (points_b) > 2;                            \
        const struct wants wants = {have_common ? (points_a) : 0,                        \
                                    have_common ? (points_b) : 0, false};                \
        return join(job, round, (points_a) == (points_b), wants, out_a, out_b, room);    \
    }
PCCD_KIND_LIST(JOIN_FEATURES)
JOIN_FEATURES(EF, 4, ef, 2, 3, "")
