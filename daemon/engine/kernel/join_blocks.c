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

#include <assert.h>

#include "boxes.h"
#include "lanes.h"
#include "lanes_pack.h"
#include "quantised.h"
#include "table.h"

/* ---- one box against sixteen ----------------------------------------------------- */

/* One box against sixteen takes, a register of sixteen lanes wide: per axis four sums and
 * two ands of sign bits, 18 operations in all, 9 cycles where two are done at a time (12
 * with compares, of which one is). No box has a zero with a sign (make_boxes.c), so the
 * sum of two bounds that touch is 0 without one. Boxes that stand still take half of
 * that: plain swept ones, and those up to a time that is near (below).
 *
 * Boxes in whole numbers (quantised.h) take half of either: features that move are
 * compared so where the scene allows it.
 *
 * Up to a time. The gap along an axis, g(t) = (1 - t) g0 + t g1, is linear: where g0 > 0,
 * it stays positive up to t_end if g(t_end) > 0. What is computed here is h = -g: h0 and
 * h1 are sums of two floats, with a relative error of u = 2^-24 each. If h1 < 0 as well
 * the boxes are apart for the whole step. Else h0 < 0 <= h1, and
 *     s h0 + t h1 < 0 with s = (1 - t_end) - 2^-20, t = t_end + 2^-20
 * says it, if h0 and h1 are exact: it is the wanted sum and 2^-20 (|h0| + |h1|) more.
 * What is computed is (s / t) h0 + h1, that over t. s is off by 2 u at most, then t, h0,
 * the quotient and the product by u of themselves each: all in all by less than
 * 6 u |h0| / t, and h1 by u |h1|, of 2^-20 (|h0| + |h1|) / t. The sum of the two has the
 * sign that it should have. 2^-120 covers products below the normal range. */

#define PARTS (ENG_WIDE / ENG_F_LANES)

/* Before a loop over the parts. One lane at a time, sixteen of them written out in all
 * kinds of joins would be 0.7 MB of code. */
#if ENG_F_LANES == 1
#define UNROLL_PARTS
#else
#define UNROLL_PARTS _Pragma("GCC unroll 16")
#endif

/* The tests of pairs: moving boxes over the step, or up to a time; boxes that stand
 * still, as they are, or around the way up to a time. In whole numbers: the same but for
 * boxes as they are, and, up to a time, as they begin (below). */
enum rule {
    RULE_STEP,
    RULE_UNTIL,
    RULE_SWEPT,
    RULE_NEAR,
    RULE_QUANTISED_STEP,
    RULE_QUANTISED_UNTIL,
    RULE_QUANTISED_NEAR,
    RULE_QUANTISED_BEGIN
};

ENG_INLINE bool is_quantised(enum rule rule)
{
    return rule >= RULE_QUANTISED_STEP;
}

/* s / t of the comment above. */
ENG_INLINE eng_f until_of(float t_end)
{
    return eng_f_all((1.0f - t_end - 0x1p-20f) / (t_end + 0x1p-20f));
}

/* One box, or rows of sixteen: floats, or the two ends' pairs of whole numbers. Sides and
 * axes are so many numbers of four bytes apart. */
struct bounds {
    const void *x;
    uint32_t side;
    uint32_t axis;
};

/* Where a bound is, that of the box in lane `at`. */
ENG_INLINE const uint32_t *place_of(struct bounds bounds, uint32_t side, uint32_t axis,
                                    uint32_t at)
{
    return (const uint32_t *)bounds.x + (side * bounds.side + axis * bounds.axis + at);
}

ENG_INLINE uint32_t word_of(struct bounds box, uint32_t side, uint32_t axis)
{
    uint32_t word;
    memcpy(&word, place_of(box, side, axis, 0), sizeof word);
    return word;
}

ENG_INLINE eng_f bound(struct bounds box, uint32_t side, uint32_t axis)
{
    uint32_t word = word_of(box, side, axis);
    float x;
    memcpy(&x, &word, sizeof x);
    return eng_f_all(x);
}

ENG_INLINE eng_f row_of(struct bounds rows, uint32_t side, uint32_t axis, uint32_t at)
{
    eng_f row;
    memcpy(&row, place_of(rows, side, axis, at), sizeof row);
    return row;
}

/* Signs: those of `signs`, and where the boxes are apart one way. */
ENG_INLINE eng_fi apart_one_way(eng_fi signs, eng_f h0, eng_f h1, enum rule rule,
                                eng_f until)
{
    if (rule == RULE_UNTIL) {
        h1 = until * h0 + (h1 + 0x1p-120f);
    }
    return eng_fi_or_and(signs, (eng_fi)h0, (eng_fi)h1);
}

/* Signs of the lanes from `at` on that the box does not meet. */
ENG_INLINE eng_fi apart_as_floats(struct bounds box, struct bounds rows, uint32_t at,
                                  enum rule rule, eng_f until)
{
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        eng_f up0 = bound(box, ENG_LOW0, axis) + row_of(rows, ENG_HIGH0, axis, at);
        eng_f down0 = bound(box, ENG_HIGH0, axis) + row_of(rows, ENG_LOW0, axis, at);
        if (rule == RULE_SWEPT || rule == RULE_NEAR) {
            signs = eng_fi_or_or(signs, (eng_fi)up0, (eng_fi)down0);
            continue;
        }
        eng_f up1 = bound(box, ENG_LOW1, axis) + row_of(rows, ENG_HIGH1, axis, at);
        eng_f down1 = bound(box, ENG_HIGH1, axis) + row_of(rows, ENG_LOW1, axis, at);
        signs = apart_one_way(signs, up0, up1, rule, until);
        signs = apart_one_way(signs, down0, down1, rule, until);
    }
    return signs;
}

/* The same in whole numbers, of either half. */
ENG_INLINE eng_fi apart_as_pairs(struct bounds box, struct bounds rows, uint32_t at,
                                 enum rule rule)
{
    eng_fi h0[3];
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        h0[axis] = eng_fi_add_halves(eng_fi_all(word_of(box, 0, axis)),
                                     eng_fi_load(place_of(rows, 0, axis, at)));
        if (rule != RULE_QUANTISED_NEAR) {
            eng_fi h1 = eng_fi_add_halves(eng_fi_all(word_of(box, 1, axis)),
                                          eng_fi_load(place_of(rows, 1, axis, at)));
            signs = eng_fi_or_and(signs, h0[axis], h1);
        }
    }
    return rule == RULE_QUANTISED_NEAR ? eng_fi_or_or(h0[0], h0[1], h0[2]) : signs;
}

/* The lanes whose box this one may meet. */
ENG_INLINE void overlap(struct bounds box, struct bounds rows, enum rule rule,
                        eng_f until, eng_left left[PARTS])
{
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        left[part] = is_quantised(rule)
                         ? eng_left_of_halves(apart_as_pairs(box, rows, at, rule))
                         : eng_left_of(apart_as_floats(box, rows, at, rule, until));
    }
}

/* ---- boxes that stand still ------------------------------------------------------ */

/* Sixteen boxes that stand still, kept in registers while many other boxes are
 * compared with them. */

/* Rows of boxes that stand still, in registers where there are as many. */
struct held_rows {
    eng_f low[3][PARTS];
    eng_f high[3][PARTS];
};

ENG_INLINE void hold_rows(struct bounds rows, struct held_rows *held)
{
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        memcpy(held->low[axis], place_of(rows, ENG_LOW0, axis, 0), sizeof held->low[0]);
        memcpy(held->high[axis], place_of(rows, ENG_HIGH0, axis, 0), sizeof held->low[0]);
    }
}

/* Lanes of a part that a box meets that stands still. */
ENG_INLINE eng_left met_by_held(struct bounds box, const struct held_rows *held,
                                uint32_t part)
{
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t i = 0; i < 3; i++) {
        signs =
            eng_fi_or_or(signs, (eng_fi)(bound(box, ENG_LOW0, i) + held->high[i][part]),
                         (eng_fi)(bound(box, ENG_HIGH0, i) + held->low[i][part]));
    }
    return eng_left_of(signs);
}

/* ---- boxes around the way up to a time, or at an end ----------------------------- */

/* Make one box that stands still of a moving one: around its way from t = 0 to
 * a time t_end, or as it is at one end of the step, grown by a distance.
 *
 * A bound's outward distance goes from x0 to x1: up to t_end it is at most x0 + p with
 * p = t_end (x1 - x0), or x0 if that is less. Difference and product are off by
 * u = 2^-24 of themselves each, which `reach`, t_end and 2^-20 of it more, makes up for;
 * for products below the normal range, and for p < 0, 2^-120 is taken instead. So with
 * exact sums of x0 and p two boxes are apart up to t_end if a + b < 0. The sum is off by
 * u of itself at most. One of the two, a, is made larger for that: by 2^-21 |a| less
 * u |a| of rounding, 7 u |a|, of which 6 u |a| are left after a's own u |a|. If
 * |b| <= 4 |a| they cover the u |b|. Else b < 0, because a + b < 0, and the true sum is
 * less than 1.01 |a| - (1 - u) |b| < 0. */

/* Return the reach that belongs to t_end, 0 .. 1. */
ENG_INLINE float reach_of(float t_end)
{
    return t_end * (1 + 0x1p-20f);
}

ENG_INLINE eng_f reached(eng_f x0, eng_f x1, eng_f reach)
{
    return x0 + eng_f_max(reach * (x1 - x0), eng_f_all(0x1p-120f));
}

/* Not NaN, nor infinite. */
ENG_INLINE eng_f larger_by_rounding(eng_f x)
{
    return eng_f_max(x * (1 + 0x1p-21f), x * (1 - 0x1p-21f));
}

/* `wider`: of the one that is made larger. */
ENG_INLINE void near_rows(const struct eng_wide_block *block, float t_end, bool wider,
                          struct eng_near_block *near)
{
    eng_f reach = eng_f_all(reach_of(t_end));
#pragma GCC unroll 6
    for (uint32_t i = 0; i < 6; i++) {
        enum eng_side side = i < 3 ? ENG_LOW0 : ENG_HIGH0;
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_f x0 = eng_f_load(block->row[side][i % 3] + at);
            eng_f x1 = eng_f_load(block->row[side + 1][i % 3] + at);
            eng_f x = reached(x0, x1, reach);
            eng_f_store(near->row[i / 3][i % 3] + at, wider ? larger_by_rounding(x) : x);
        }
    }
}

/* At one end of the step. Where x + growth is rounded, `larger_by_rounding` makes up for
 * it: so boxes are apart, in sums of two, only if they are farther apart than that. */
ENG_INLINE void rows_at_end(const struct eng_wide_block *block, uint32_t end,
                            float growth, struct eng_near_block *near)
{
    const eng_f more = eng_f_all(growth);
#pragma GCC unroll 6
    for (uint32_t i = 0; i < 6; i++) {
        enum eng_side side = i < 3 ? ENG_LOW0 : ENG_HIGH0;
        for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
            eng_f x = eng_f_load(block->row[side + end][i % 3] + at);
            eng_f_store(near->row[i / 3][i % 3] + at,
                        growth > 0 ? larger_by_rounding(x + more) : x);
        }
    }
}

/* The same of one box, which does not grow. */
ENG_INLINE void box_at_end(const struct eng_extents *box, uint32_t end,
                           struct eng_extents *near)
{
    memcpy(near->side[ENG_LOW0], box->side[ENG_LOW0 + end], sizeof near->side[0]);
    memcpy(near->side[ENG_HIGH0], box->side[ENG_HIGH0 + end], sizeof near->side[0]);
}

/* The same of one box, made no larger. */
ENG_INLINE void near_box(const struct eng_extents *box, float t_end,
                         struct eng_extents *near)
{
    float reach = reach_of(t_end);
#pragma GCC unroll 2
    for (int side = ENG_LOW0; side < ENG_SIDES; side += 2) {
        eng_float4 end[2];
        memcpy(end, box->side[side], sizeof end);
        eng_float4 way = reach * (end[1] - end[0]);
        end[0] += eng_float4_max(way, (eng_float4){0} + 0x1p-120f);
        memcpy(near->side[side], &end[0], sizeof end[0]);
    }
}

/* ---- quantised boxes as the step begins ------------------------------------------ */

/* Compare quantised boxes as they are at the beginning of the step, for a
 * search that ends shortly after t = 0.
 *
 * A number (quantised.h) grows by at most `farthest` from the one end of the step to the
 * other, so a sum of two by 2 t_end farthest until t_end. Where that and the sum are
 * negative the boxes are apart all the while. The same holds of a box around others,
 * whose numbers are the largest of theirs. */

/* The most that two boxes around the way up to a time may grow by for their rounding
 * alone (quantised.h): as long as they grow by less, boxes that are compared as they
 * begin are the smaller ones. */
#define ENG_QUANTISED_GROWTH_MAX (2 * ENG_QUANTISED_REACH_SPARE)

/* Return what two numbers that grow by `farthest` or less grow by together until t_end, 0
 * .. 1, rounded up to a whole number >= 1; 0: more than ENG_QUANTISED_GROWTH_MAX. */
ENG_INLINE uint32_t quantised_growth(uint32_t farthest, float t_end)
{
    float growth = 2 * t_end * (float)farthest; /* off by 2^-23 of itself */
    return growth < ENG_QUANTISED_GROWTH_MAX ? 1 + (uint32_t)growth : 0;
}

/* The lanes whose box this one may meet while numbers grow by `growth` together.
 * `turned`: the box, against rows that are not (quantised.h). */
ENG_INLINE void overlap_from_begin(struct bounds box, struct bounds rows, bool turned,
                                   uint32_t growth, eng_left left[PARTS])
{
    eng_fi grown[3];
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        eng_fi words = eng_fi_all(word_of(box, 0, axis));
        words = turned ? eng_fi_turn_halves(words) : words;
        grown[axis] = eng_fi_add_halves(words, eng_fi_all(growth << 16 | growth));
    }
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        eng_fi h[3];
#pragma GCC unroll 3
        for (uint32_t axis = 0; axis < 3; axis++) {
            h[axis] =
                eng_fi_add_halves(grown[axis], eng_fi_load(place_of(rows, 0, axis, at)));
        }
        left[part] = eng_left_of_halves(eng_fi_or_or(h[0], h[1], h[2]));
    }
}

/* ---- axes and time --------------------------------------------------------------- */

/* Reject pairs of moving boxes that overlap along each axis at some time,
 * but never along all axes at the same time.
 *
 * What moving boxes let through may be apart along x up to some time and along y from an
 * earlier one on. With h as above boxes are apart along an axis, one way, while
 * (1 - t) h0 + t h1 < 0. Where it is so at first, h0 = -a and h1 = o >= 0, that lasts up
 * to the time a / (a + o); where it is so at last, h1 = -a' and h0 = o', it begins at
 * o' / (a' + o'). The first time is the later one where a a' > o o'. Each axis is
 * compared with the two others: with itself it need not be, for its two h0 add up to the
 * boxes' sizes, and so do its h1. So along an axis boxes are apart one way at most at
 * either end: that way alone is looked at. Where there is none at first, h0 >= 0 stands
 * for -a, and o is the other end of either way, or 0; where there is none at last, a' is
 * 0: then nothing is rejected. The margins are in elementary/BOUNDS.md, "Boxes and
 * time". */

/* One way along an axis, that of boxes that are apart one way at first, and at last. */
struct parting {
    eng_f first[2]; /* -a or what is not below 0; o */
    eng_f last[2];  /* -a' or 0; o' */
};

ENG_INLINE struct parting parting_as_floats(struct bounds box, struct bounds rows,
                                            uint32_t axis, uint32_t at)
{
    const eng_f zero = {0};
    eng_f up[2];
    eng_f down[2];
#pragma GCC unroll 2
    for (uint32_t end = 0; end < 2; end++) {
        up[end] =
            bound(box, ENG_LOW0 + end, axis) + row_of(rows, ENG_HIGH0 + end, axis, at);
        down[end] =
            bound(box, ENG_HIGH0 + end, axis) + row_of(rows, ENG_LOW0 + end, axis, at);
    }
    eng_f o_first = eng_f_select(eng_f_less(down[0], up[0]), down[1], up[1]);
    eng_f o_last = eng_f_select(eng_f_less(down[1], up[1]), down[0], up[0]);
    return (struct parting){
        {eng_f_min(up[0], down[0]), eng_f_max(o_first, zero) * (1 + 0x1p-19f)},
        {eng_f_min(eng_f_min(up[1], down[1]), zero), eng_f_abs(o_last)}};
}

/* Signs of the lanes from `at` on that no time brings together with the box. */
ENG_INLINE eng_fi never_as_floats(struct bounds box, struct bounds rows, uint32_t at)
{
    struct parting along[3];
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        along[axis] = parting_as_floats(box, rows, axis, at);
    }
#pragma GCC unroll 3
    for (uint32_t i = 0; i < 3; i++) {
#pragma GCC unroll 2
        for (uint32_t k = 1; k < 3; k++) {
            const struct parting *other = &along[(i + k) % 3];
            eng_f o = along[i].first[1] * other->last[1] + 0x1p-120f;
            signs |= (eng_fi)(o - along[i].first[0] * other->last[0]);
        }
    }
    return signs;
}

/* The same in whole numbers, half as large, so that sums fit: `turned`, the box with its
 * halves turned (quantised.h) and 1 more. Ends are halves: h0 and h1 one way. */
ENG_INLINE eng_fi never_as_pairs(const eng_fi turned[2][3], struct bounds rows,
                                 uint32_t at)
{
    const eng_fi least_o = eng_fi_all(0x00008000u); /* and of -a all */
    const eng_fi most_a = eng_fi_all(0x7fff0000u);  /* and of o' all */
    eng_fi first[3];
    eng_fi last[3];
    eng_fi signs = {0};
#pragma GCC unroll 3
    for (uint32_t axis = 0; axis < 3; axis++) {
        eng_fi rows0 = eng_fi_half_of_halves(eng_fi_load(place_of(rows, 0, axis, at)));
        eng_fi rows1 = eng_fi_half_of_halves(eng_fi_load(place_of(rows, 1, axis, at)));
        eng_fi h0 = eng_fi_add_halves(turned[0][axis], rows0);
        eng_fi h1 = eng_fi_add_halves(turned[1][axis], rows1);
        eng_fi one_way = eng_fi_low_and_high(h0, h1 << 16);
        eng_fi other_way = eng_fi_low_and_high(h0 >> 16, h1);
        first[axis] =
            eng_fi_max_halves(eng_fi_select_negative(h0, other_way, one_way), least_o);
        last[axis] = eng_fi_turn_halves(eng_fi_select_negative(h1, other_way, one_way));
        last[axis] = eng_fi_abs_halves(eng_fi_min_halves(last[axis], most_a));
    }
#pragma GCC unroll 3
    for (uint32_t i = 0; i < 3; i++) {
        signs = eng_fi_or_or(signs, eng_fi_dot_halves(first[i], last[(i + 1) % 3]),
                             eng_fi_dot_halves(first[i], last[(i + 2) % 3]));
    }
    return signs;
}

/* Return those of the lanes, whose boxes overlap with this one, that some time may bring
 * together with it; `quantised`: all are in whole numbers. Parts without any are not
 * looked at; of two parts, a wrong guess takes as long as that saves. */
ENG_INLINE uint32_t together(struct bounds box, struct bounds rows, uint32_t lanes,
                             bool quantised)
{
    eng_fi turned[2][3];
    uint32_t bits = 0;
    if (quantised) {
#pragma GCC unroll 6
        for (uint32_t i = 0; i < 6; i++) {
            eng_fi words = eng_fi_turn_halves(eng_fi_all(word_of(box, i / 3, i % 3)));
            turned[i / 3][i % 3] =
                eng_fi_add_halves(eng_fi_half_of_halves(words), eng_fi_all(0x00010001u));
        }
    }
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        if (PARTS > 2 && (lanes >> at & ENG_F_ALL) == 0) {
            continue;
        }
        bits |= eng_fi_no_signs(quantised ? never_as_pairs(turned, rows, at)
                                          : never_as_floats(box, rows, at))
                << at;
    }
    return bits & lanes;
}

/* ---- what moves, and what is foreign --------------------------------------------- */

/* Leave out boxes and pairs of which nothing moves, or all is foreign.
 *
 * Boxes are left out where they are bits: one by one they would take a tenth of what
 * it is to compare them. Lanes are by a pass over the list, which is in the first
 * cache. */

/* Lanes of a block of b which with a box of a, `slot`, are pairs of which either is
 * marked. */
ENG_INLINE uint32_t marked_lanes(const uint16_t *a_marks, uint32_t b_marks, uint32_t slot)
{
    uint32_t is_marked = a_marks[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
    return (b_marks | (0u - is_marked)) & 0xffff;
}

ENG_INLINE uint32_t own_of(const struct eng_join *job, uint32_t block)
{
    return job->b_own ? job->b_own[block] : 0;
}

/* Keep those of these boxes of block n of a that have pairs with block m of b of which
 * either moves, and either is not foreign. */
ENG_INLINE uint32_t keep_marked_boxes(struct eng_join *job, uint32_t boxes, uint32_t n,
                                      uint32_t m)
{
    uint32_t kept = boxes;
    if (job->a_own && own_of(job, m) == 0) {
        kept &= job->a_own[n];
    }
    if (job->a_moving && job->b_moving[m] == 0) {
        boxes = kept;
        kept &= job->a_moving[n];
        job->still += (uint32_t)__builtin_popcount(boxes ^ kept);
    }
    return kept;
}

/* Keep, in the `count` boxes with lanes of b, those lanes that are such pairs. */
ENG_INLINE uint32_t keep_moving_lanes(struct eng_join *job, struct eng_join_round *round,
                                      uint32_t count)
{
    uint32_t kept = 0;
    uint32_t still = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t box = round->box[i];
        uint32_t lanes = round->lanes[i];
        uint32_t moving = lanes & marked_lanes(job->a_moving,
                                               job->b_moving[round->first_b + (box >> 8)],
                                               round->first_a * ENG_WIDE + (box & 0xff));
        still += (uint32_t)__builtin_popcount(lanes ^ moving);
        round->box[kept] = box;
        round->lanes[kept] = moving;
        kept += moving != 0;
    }
    job->still += still;
    return kept;
}

/* Return whether anything is foreign in the next `pairs` blocks of the round, whichever
 * side may be first. */
ENG_INLINE bool has_foreign(const struct eng_join *job,
                            const struct eng_join_round *round, uint32_t pairs)
{
    uint32_t own = 0xffff;
    for (uint32_t i = round->count; i < round->count + pairs; i++) {
        own &= job->a_own[round->a[i]] & job->b_own[round->b[i]];
    }
    return own != 0xffff;
}

ENG_INLINE uint64_t key_of(const struct eng_join *job, uint32_t slot)
{
    return job->keys[(size_t)slot * job->key_stride];
}

/* Lanes that are pairs of an own and a foreign feature, `slot` and those from `first` on:
 * those of which the own one comes first. They are few. */
ENG_INLINE uint32_t own_before(const struct eng_join *job, uint32_t slot, bool is_own,
                               uint32_t first, uint32_t lanes)
{
    const uint64_t key = key_of(job, slot);
    for (uint32_t left = lanes; left != 0; left &= left - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(left);
        bool is_first = key < key_of(job, first + lane);
        lanes ^= (uint32_t)(is_first != is_own) << lane;
    }
    return lanes;
}

/* Keep, in the `count` boxes with lanes of b, either of which may come first, those lanes
 * that are pairs which are not left out. */
ENG_INLINE uint32_t keep_own_lanes(const struct eng_join *job,
                                   struct eng_join_round *round, uint32_t count)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t box = round->box[i];
        uint32_t slot = round->first_a * ENG_WIDE + (box & 0xff);
        uint32_t block = round->first_b + (box >> 8);
        uint32_t is_own = job->a_own[slot / ENG_WIDE] >> slot % ENG_WIDE & 1;
        uint32_t b_own = job->b_own[block];
        uint32_t both = round->lanes[i] & b_own & (0u - is_own);
        uint32_t one = round->lanes[i] & (b_own ^ (0u - is_own));
        if (one != 0 && job->keys) {
            one = own_before(job, slot, is_own != 0, block * ENG_WIDE, one);
        }
        round->box[kept] = box;
        round->lanes[kept] = both | one;
        kept += (both | one) != 0;
    }
    return kept;
}

/* ---- rounds ---------------------------------------------------------------------- */

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
    uint32_t selves; /* a bit for each block to be compared with itself */
};

/* Return whether blocks are compared as they lie in the trees. */
ENG_INLINE bool is_plain(enum rule rule)
{
    return rule == RULE_STEP || rule == RULE_UNTIL;
}

/* Return whether, in whole numbers, those of a and the boxes around b are compared as
 * they lie there. */
ENG_INLINE bool is_from_trees(enum rule rule)
{
    return rule == RULE_QUANTISED_STEP || rule == RULE_QUANTISED_BEGIN;
}

/* Numbers of four bytes from one block to the next; lanes are in the lowest bits. */
ENG_INLINE uint32_t block_stride(bool plain)
{
    static_assert(sizeof(struct eng_quantised_block) == sizeof(union eng_join_ready),
                  "blocks of one size");
    const size_t bytes =
        plain ? sizeof(struct eng_wide_block) : sizeof(union eng_join_ready);
    return (uint32_t)(bytes / 4);
}

ENG_INLINE uint32_t around_stride(enum rule rule)
{
    const size_t bytes = is_from_trees(rule) ? sizeof(struct eng_quantised_box)
                                             : sizeof(union eng_join_around);
    return (uint32_t)(bytes / 4);
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

/* By either. */
ENG_INLINE void overlap_by(struct bounds box, struct bounds rows, enum rule rule,
                           bool turned, struct until until, eng_left left[PARTS])
{
    if (rule == RULE_QUANTISED_BEGIN) {
        overlap_from_begin(box, rows, turned, until.growth, left);
    } else {
        overlap(box, rows, rule, until.weight, left);
    }
}

/* List the boxes of a that meet the box around b, for each pair of blocks of the round:
 * where either is from sides->a and sides->b on, and which they are in their runs.
 * Returns how many. Of a run with itself, `self`, those of two blocks alone, and the
 * other ones to sides->selves. Nor those that stand, or are foreign, where all of the
 * block is so, too. */
ENG_INLINE uint32_t list_boxes(struct eng_join *job, struct eng_join_round *round,
                               struct sides *sides, uint32_t pairs, bool self,
                               enum rule rule, struct until until)
{
    const uint32_t stride = block_stride(is_plain(rule));
    uint32_t count = 0;
    uint32_t selves = 0;
    for (uint32_t i = pairs; i-- > 0;) {
        uint32_t n = round->a[round->count + i] % ENG_WIDE;
        uint32_t m = round->b[round->count + i] % ENG_WIDE;
        struct bounds around = {sides->around + m * around_stride(rule), 4, 1};
        struct bounds rows = rows_at(sides->a + n * stride, rule);
        eng_left left[PARTS];
        overlap_by(around, rows, rule, false, until, left);
        uint32_t bits = eng_left_bits16(left);
        if (self) {
            uint32_t is_one = n == m;
            selves |= is_one << n;
            bits &= is_one - 1;
        }
        if (job->a_moving || job->a_own) {
            bits = keep_marked_boxes(job, bits, sides->first_a + n, sides->first_b + m);
        }
        eng_pack16(round->place + count, bits, n * stride | m * stride << 16);
        count += eng_pack16(round->box + count, bits, n * ENG_WIDE | m << 8);
    }
    sides->selves = selves;
    return count;
}

ENG_INLINE uint32_t begin_by(struct eng_join *job, struct eng_join_round *round,
                             uint32_t pairs, bool self, enum rule rule,
                             struct sides *sides)
{
    const struct until until = until_as_rules_ask(job);
    *sides = make_ready(job, round, pairs, rule);
    return self ? list_boxes(job, round, sides, pairs, true, rule, until)
                : list_boxes(job, round, sides, pairs, false, rule, until);
}

/* One for all joins: one for each takes the compiler three times as long. */
static __attribute__((noinline)) uint32_t begin_round(struct eng_join *job,
                                                      struct eng_join_round *round,
                                                      uint32_t pairs, bool self,
                                                      enum rule rule, struct sides *sides)
{
    switch (rule) {
#define BEGIN(rule)                                                                      \
    case rule:                                                                           \
        return begin_by(job, round, pairs, self, rule, sides);
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

/* The wishes of a list of nodes or features: their vertices, of either side, 0 if they do
 * not matter; `twins`: a box with itself, as nodes do and features do not. */
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

/* Find the lanes of block m whose features have no vertex of feature `slot`. */
ENG_INLINE void find_without_vertices(const struct sides *sides, uint32_t slot,
                                      uint32_t m, struct wants wants,
                                      eng_left without[PARTS])
{
    const uint32_t *own[3] = {sides->b_corner[0], sides->b_corner[1], sides->b_corner[2]};
    uint32_t vertex[2] = {sides->first_a * ENG_WIDE + slot, 0};
    if (wants.a_vertices == 2) {
        vertex[0] = sides->a_corner[0][slot];
        vertex[1] = sides->a_corner[1][slot];
    }
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        without[part] = eng_left_all();
#pragma GCC unroll 3
        for (uint32_t k = 0; k < wants.b_vertices; k++) {
            eng_fi lanes = eng_fi_load(own[k] + m * ENG_WIDE + part * ENG_F_LANES);
#pragma GCC unroll 2
            for (uint32_t i = 0; i < wants.a_vertices; i++) {
                without[part] =
                    eng_left_unequal(without[part], lanes, eng_fi_all(vertex[i]));
            }
        }
    }
}

/* Return the lanes that are left in both as bits: vectors become bits once. */
ENG_INLINE uint32_t bits_in_both(const eng_left a[PARTS], const eng_left b[PARTS])
{
#if ENG_VECTOR_BYTES == 64
    return eng_left_bits16(a) & eng_left_bits16(b);
#else
    eng_left both[PARTS];
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        both[part] = a[part] | b[part];
    }
    return eng_left_bits16(both);
#endif
}

/* Lanes of b that a box of a has pairs with. */
ENG_INLINE uint32_t lanes_of(const struct sides *sides, uint32_t place, uint32_t box,
                             struct wants wants, enum rule rule, struct until until)
{
    struct bounds a = rows_at(sides->a + (place & 0xffff), rule);
    struct bounds b = rows_at(sides->b + (place >> 16), rule);
    eng_left left[PARTS];
    eng_left without[PARTS];
    overlap_by(a, b, rule, true, until, left);
    if (wants.a_vertices == 0) {
        return eng_left_bits16(left);
    }
    find_without_vertices(sides, box & 0xff, box >> 8, wants, without);
    return bits_in_both(left, without);
}

/* Keep those of `count` boxes with pairs that are wanted, and the lanes of these. */
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
                                uint32_t found, struct wants wants, enum rule rule,
                                struct until until)
{
    const uint32_t stride = block_stride(is_plain(rule));
    for (uint32_t selves = sides->selves; selves != 0; selves &= selves - 1) {
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
    uint32_t count = begin_round(job, round, pairs, self, rule, &sides);
    look_at_corners(job, &sides, wants);
    uint32_t found = test_boxes(round, &sides, count, wants, rule, until);
    job->tests += pairs + count;
    if (self) {
        job->tests += ENG_WIDE * (uint32_t)__builtin_popcount(sides.selves);
        found = test_selves(round, &sides, found, wants, rule, until);
    }
    return found;
}

/* ---- pairs, into lists ------------------------------------------------------------- */

/* Those of the lanes that some time may bring together with the box. */
ENG_INLINE uint32_t together_of(const struct eng_join *job, uint32_t slot, uint32_t block,
                                uint32_t lanes, bool quantised)
{
    uint32_t n = slot / ENG_WIDE;
    uint32_t lane = slot % ENG_WIDE;
    enum rule rule = quantised ? RULE_QUANTISED_STEP : RULE_STEP;
    const void *box = quantised ? (const void *)&job->a_quantised[n].row[0][0][lane]
                                : (const void *)&job->a[n].row[0][0][lane];
    const void *rows =
        quantised ? (const void *)&job->b_quantised[block] : (const void *)&job->b[block];
    return together(rows_at(box, rule), rows_at(rows, rule), lanes, quantised);
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
            uint32_t kept = together_of(job, slot, block, lanes, quantised);
            job->apart_in_time += (uint32_t)__builtin_popcount(lanes ^ kept);
            lanes = kept;
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
    eng_left left[PARTS];
    if (wants.a_vertices == 2) {
        vertex[0] = job->a_corner[0][slot];
        vertex[1] = job->a_corner[1][slot];
    }
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        left[part] = met_by_held(rows_at(lows, RULE_SWEPT), &held->rows, part);
#pragma GCC unroll 3
        for (uint32_t k = 0; k < wants.b_vertices; k++) {
#pragma GCC unroll 2
            for (uint32_t i = 0; i < wants.a_vertices; i++) {
                left[part] = eng_left_unequal(left[part], held->vertex[k][part],
                                              eng_fi_all(vertex[i]));
            }
        }
    }
    return eng_left_bits16(left);
}

/* The boxes of block n of a that meet the box around block m of b: one bit each. */
ENG_INLINE uint32_t boxes_met(const struct eng_join *job, uint32_t n, uint32_t m)
{
    eng_left left[PARTS];
    overlap((struct bounds){&job->b_boxes[m], 4, 1},
            rows_at((const void *)&job->a[n], RULE_SWEPT), RULE_SWEPT, (eng_f){0}, left);
    return eng_left_bits16(left);
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
    if (job->a_quantised) {
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
        bool self = may_be_self && job->a == job->b &&
                    job->a_quantised == job->b_quantised &&
                    round->first_a == round->first_b;
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
    static_assert((points_a) <= 2 && (points_b) <= 3, "find_without_vertices");          \
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
