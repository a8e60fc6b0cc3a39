/* daemon/engine/kernel/join.c - the boxes of two blocks against each other.
 *
 * Room:     engine.
 * Does:     see kernel.h.
 * Threads:  [any].
 *
 * One box against sixteen takes, a register of sixteen lanes wide: per axis four sums and
 * two ands of sign bits, 18 operations in all, 9 cycles where two are done at a time (12
 * with compares, of which one is). No box has a zero with a sign (boxes.c), so the sum of
 * two bounds that touch is 0 without one. Boxes that stand still take half of that: plain
 * swept ones, and those up to a time that is near (near.h).
 *
 * Boxes in whole numbers (narrow.h) take half of either: features that move are compared
 * so where the scene allows it.
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
 * sign that it should have. 2^-120 covers products below the normal range.
 *
 * In time. What moving boxes let through may be apart along x up to some time and along y
 * from an earlier one on. With h0, h1 as above the boxes can meet along an axis, one way,
 * while (1 - t) h0 + t h1 >= 0: from -h0 / (-h0 + h1) on where h0 < 0, up to h0 / (h0 -
 * h1) where h1 < 0 (both are not: such pairs are gone). At one end of the step boxes are
 * not apart both ways, for the two h0 add up to their sizes: so the lesser is looked at.
 * Where it is not below 0 the first time is to be 0 and the last 1: 0 / (0 + |h1|), and
 * |h0| / (|h0| + 0). Another 2^-100, so that no denominator is 0, makes the first time
 * sooner and the last one later, which rejects less. Numerators have a relative error of
 * 2 u, denominators, sums of terms of one sign, of 3 u. Of several times that which
 * products show to be the latest (soonest) is kept; to take another one rejects less.
 * The last comparison is of two products of a numerator and a denominator each: 2 (2 u +
 * 3 u + u) and u for the factor, and that, 1 + 2^-19, leaves 32 u. 2^-120 covers products
 * below the normal range.
 */
#include "lanes_pack.h"
#include "narrow.h"
#include "near.h"
#include "table.h"

#define PARTS (ENG_WIDE / ENG_F_LANES)

/* Before a loop over the parts. One lane at a time, sixteen of them written out in all
 * kinds of joins would be 0.7 MB of code. */
#if ENG_F_LANES == 1
#define UNROLL_PARTS
#else
#define UNROLL_PARTS _Pragma("GCC unroll 16")
#endif

/* A box that others are tested against: sides and axes that many floats apart. */
struct single {
    const float *x;
    size_t side;
    size_t axis;
};

/* Sixteen boxes: in registers where one holds a row, else where they are. */
struct rows {
    const struct eng_wide_block *block;
    const struct eng_narrow_block *narrow;
#if ENG_F_LANES == 16
    eng_f row[ENG_SIDES][3];
    eng_fi pairs[2][3];
#endif
};

/* What pairs are tested for: moving boxes over the step, or up to a time; boxes that
 * stand still, as they are, or around the way up to a time. In whole numbers: the same
 * but for boxes as they are. */
enum rule {
    RULE_STEP,
    RULE_UNTIL,
    RULE_SWEPT,
    RULE_NEAR,
    RULE_NARROW_STEP,
    RULE_NARROW_UNTIL,
    RULE_NARROW_NEAR
};

ENG_INLINE bool is_narrow(enum rule rule)
{
    return rule >= RULE_NARROW_STEP;
}

/* s / t of the comment above. */
ENG_INLINE eng_f until_of(float t_end)
{
    return eng_f_all((1.0f - t_end - 0x1p-20f) / (t_end + 0x1p-20f));
}

ENG_INLINE void rows_load(struct rows *rows, const struct eng_wide_block *block,
                          enum rule rule)
{
    rows->block = block;
#if ENG_F_LANES == 16
    bool stands_still = rule == RULE_SWEPT || rule == RULE_NEAR;
#pragma GCC unroll 12
    for (size_t i = 0; i < 3 * ENG_SIDES; i++) {
        size_t side = i / 3;
        if (!stands_still || side == ENG_LOW0 || side == ENG_HIGH0) {
            rows->row[side][i % 3] = eng_f_load(block->row[side][i % 3]);
        }
    }
#else
    (void)rule;
#endif
}

ENG_INLINE eng_f row_of(const struct rows *rows, enum eng_side side, size_t axis,
                        uint32_t at)
{
#if ENG_F_LANES == 16
    (void)at;
    return rows->row[side][axis];
#else
    return eng_f_load(rows->block->row[side][axis] + at);
#endif
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

ENG_INLINE eng_f bound(struct single box, enum eng_side side, size_t axis)
{
    return eng_f_all(box.x[axis * box.axis + side * box.side]);
}

/* Lanes of sixteen boxes. */
struct left {
    eng_left part[PARTS];
};

ENG_INLINE uint32_t bits_of(const struct left *left)
{
    uint32_t bits = 0;
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        bits |= eng_left_bits(left->part[part]) << (part * ENG_F_LANES);
    }
    return bits;
}

/* The lanes that the box may meet. */
ENG_INLINE struct left overlap(struct single box, const struct rows *rows, enum rule rule,
                               eng_f until)
{
    struct left left;
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        eng_fi signs = {0};
#pragma GCC unroll 3
        for (size_t axis = 0; axis < 3; axis++) {
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
        left.part[part] = eng_left_of(signs);
    }
    return left;
}

/* ---- in whole numbers -------------------------------------------------------------- */

/* A box whose numbers, two to each, are that many apart. */
struct single_pairs {
    const void *x;
    size_t end;
    size_t axis;
};

/* Rows with their halves turned, if what they are compared with has not: below is added
 * to above. */
ENG_INLINE void pairs_load(struct rows *rows, const struct eng_narrow_block *block,
                           enum rule rule, bool turned)
{
    rows->narrow = block;
#if ENG_F_LANES == 16
#pragma GCC unroll 6
    for (size_t i = 0; i < 6; i++) {
        if (i < 3 || rule != RULE_NARROW_NEAR) {
            eng_fi pairs = eng_fi_load(block->row[i / 3][i % 3]);
            rows->pairs[i / 3][i % 3] = turned ? eng_fi_turn_halves(pairs) : pairs;
        }
    }
#else
    (void)rule;
    (void)turned; /* the box is turned, which is one number */
#endif
}

ENG_INLINE eng_fi pairs_of(const struct rows *rows, uint32_t end, size_t axis,
                           uint32_t at)
{
#if ENG_F_LANES == 16
    (void)at;
    return rows->pairs[end][axis];
#else
    return eng_fi_load(rows->narrow->row[end][axis] + at);
#endif
}

ENG_INLINE eng_fi pair_of(struct single_pairs box, uint32_t end, size_t axis, bool turned)
{
    uint32_t pair;
    memcpy(&pair, (const uint32_t *)box.x + end * box.end + axis * box.axis, sizeof pair);
#if ENG_F_LANES == 16
    (void)turned; /* the rows are */
#else
    pair = turned ? pair << 16 | pair >> 16 : pair;
#endif
    return eng_fi_all(pair);
}

/* The lanes that the box may meet. */
ENG_INLINE struct left overlap_narrow(struct single_pairs box, const struct rows *rows,
                                      enum rule rule, bool turned)
{
    struct left left;
    UNROLL_PARTS
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        eng_fi h0[3];
        eng_fi signs = {0};
#pragma GCC unroll 3
        for (size_t axis = 0; axis < 3; axis++) {
            h0[axis] = eng_fi_add_halves(pair_of(box, 0, axis, turned),
                                         pairs_of(rows, 0, axis, at));
            if (rule != RULE_NARROW_NEAR) {
                eng_fi h1 = eng_fi_add_halves(pair_of(box, 1, axis, turned),
                                              pairs_of(rows, 1, axis, at));
                signs = eng_fi_or_and(signs, h0[axis], h1);
            }
        }
        if (rule == RULE_NARROW_NEAR) {
            signs = eng_fi_or_or(h0[0], h0[1], h0[2]);
        }
        left.part[part] = eng_left_of_halves(signs);
    }
    return left;
}

/* ---- in time ----------------------------------------------------------------------- */

/* A time, n / d. */
struct fraction {
    eng_f n, d;
};

/* Of the two ways of being apart along an axis that which is at one end of the step, if
 * any: how far apart, and the gap that way at the other end. */
struct parting {
    eng_f apart; /* 0 or more */
    eng_f other; /* |.| and 2^-100: more than 0 */
};

ENG_INLINE struct parting parting_of(eng_f up, eng_f down, eng_f other_up,
                                     eng_f other_down)
{
    const eng_f zero = {0};
    eng_f other = eng_f_select(eng_f_less(up, down), other_up, other_down);
    return (struct parting){zero - eng_f_min(eng_f_min(up, down), zero),
                            eng_f_abs(other) + 0x1p-100f};
}

/* The later, or the sooner, of two times. */
ENG_INLINE struct fraction later(struct fraction a, struct fraction b)
{
    eng_fm is_b = eng_f_less(a.n * b.d, b.n * a.d);
    return (struct fraction){eng_f_select(is_b, b.n, a.n), eng_f_select(is_b, b.d, a.d)};
}

ENG_INLINE struct fraction sooner(struct fraction a, struct fraction b)
{
    eng_fm is_b = eng_f_less(b.n * a.d, a.n * b.d);
    return (struct fraction){eng_f_select(is_b, b.n, a.n), eng_f_select(is_b, b.d, a.d)};
}

/* Between which times an axis lets the boxes meet. */
ENG_INLINE void meeting_along(struct single box, const struct eng_wide_block *rows,
                              size_t axis, uint32_t at, struct fraction *from,
                              struct fraction *to)
{
    eng_f up0 = bound(box, ENG_LOW0, axis) + eng_f_load(rows->row[ENG_HIGH0][axis] + at);
    eng_f up1 = bound(box, ENG_LOW1, axis) + eng_f_load(rows->row[ENG_HIGH1][axis] + at);
    eng_f down0 =
        bound(box, ENG_HIGH0, axis) + eng_f_load(rows->row[ENG_LOW0][axis] + at);
    eng_f down1 =
        bound(box, ENG_HIGH1, axis) + eng_f_load(rows->row[ENG_LOW1][axis] + at);
    struct parting first = parting_of(up0, down0, up1, down1);
    struct parting last = parting_of(up1, down1, up0, down0);
    *from = (struct fraction){first.apart, first.apart + first.other};
    *to = (struct fraction){last.other, last.apart + last.other};
}

/* Bit i: no time brings the box and that of lane i together. Only for pairs that
 * overlap. */
ENG_INLINE uint32_t never_together(struct single box, const struct eng_wide_block *rows)
{
    uint32_t bits = 0;
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        struct fraction from[3];
        struct fraction to[3];
#pragma GCC unroll 3
        for (size_t axis = 0; axis < 3; axis++) {
            meeting_along(box, rows, axis, at, &from[axis], &to[axis]);
        }
        struct fraction begin = later(later(from[0], from[1]), from[2]);
        struct fraction end = sooner(sooner(to[0], to[1]), to[2]);
        eng_f ends = end.n * begin.d * (1 + 0x1p-19f) + 0x1p-120f;
        bits |= eng_fm_bits(eng_f_less(ends, begin.n * end.d)) << at;
    }
    return bits;
}

/* The `count` vertices of each of sixteen features. */
struct corners {
    eng_fi vertex[3][PARTS];
};

ENG_INLINE void corners_load(struct corners *corners, const uint32_t *const corner[3],
                             uint32_t count, uint32_t first)
{
#pragma GCC unroll 3
    for (uint32_t k = 0; k < count; k++) {
        for (uint32_t part = 0; part < PARTS; part++) {
            corners->vertex[k][part] =
                eng_fi_load(corner[k] + first + part * ENG_F_LANES);
        }
    }
}

/* Those lanes go whose feature has this vertex. */
ENG_INLINE void without_vertex(struct left *left, const struct corners *corners,
                               uint32_t count, uint32_t vertex)
{
#pragma GCC unroll 3
    for (uint32_t k = 0; k < count; k++) {
        UNROLL_PARTS
        for (uint32_t part = 0; part < PARTS; part++) {
            left->part[part] = eng_left_unequal(
                left->part[part], corners->vertex[k][part], eng_fi_all(vertex));
        }
    }
}

/* Boxes that meet a lane or more, until their times are looked at. */
struct found {
    uint32_t count;
    uint32_t lane[ENG_WIDE + 1]; /* behind the last one is written, not read */
    uint32_t bits[ENG_WIDE + 1];
};

/* What becomes of found pairs: those that no time brings together go. By itself, because
 * whether a box has found any cannot be foreseen. */
ENG_INLINE uint32_t keep_in_time(struct eng_join *job, uint32_t n, uint32_t m,
                                 const struct found *found, uint32_t *out_a,
                                 uint32_t *out_b)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < found->count; k++) {
        uint32_t i = found->lane[k];
        struct single box = {&job->a[n].row[0][0][i], 3 * ENG_WIDE, ENG_WIDE};
        uint32_t never = found->bits[k] & never_together(box, &job->b[m]);
        job->apart_in_time += (uint32_t)__builtin_popcount(never);
        eng_fill16(out_a + count, n * ENG_WIDE + i);
        count += eng_pack16(out_b + count, found->bits[k] ^ never, m * ENG_WIDE);
    }
    return count;
}

/* Block a of a join as its rule compares it, and room for block b. */
struct sides {
    const struct eng_wide_block *a;
    const struct eng_narrow_block *a_narrow;
    union {
        struct eng_wide_block block;
        struct eng_narrow_block narrow;
    } b;
};

ENG_INLINE struct left begin_with_pairs(struct eng_join *job, uint32_t n, uint32_t m,
                                        enum rule rule, struct sides *sides,
                                        struct rows *rows)
{
    const struct eng_narrow_box *around = &job->b_narrow_boxes[m];
    struct eng_narrow_box reached;
    sides->a_narrow = &job->a_narrow[n];
    if (rule != RULE_NARROW_STEP) {
        bool is_near = rule == RULE_NARROW_NEAR;
        if (job->near_block != n) {
            narrow_rows_until(sides->a_narrow, job->t_end, is_near, &job->near.narrow);
            job->near_block = n;
        }
        sides->a_narrow = &job->near.narrow;
        narrow_box_until(around, job->t_end, is_near, &reached);
        around = &reached;
    }
    struct single_pairs box = {around->half, 4, 1};
    pairs_load(rows, sides->a_narrow, rule, false);
    return overlap_narrow(box, rows, rule, false);
}

/* The lanes of a that the box around b may meet. */
ENG_INLINE struct left begin_with_a(struct eng_join *job, uint32_t n, uint32_t m,
                                    enum rule rule, eng_f until, struct sides *sides,
                                    struct rows *rows)
{
    if (is_narrow(rule)) {
        return begin_with_pairs(job, n, m, rule, sides, rows);
    }
    const struct eng_extents *around = &job->b_boxes[m];
    struct eng_extents reached;
    sides->a = &job->a[n];
    if (rule == RULE_NEAR) {
        if (job->near_block != n) {
            near_rows(sides->a, job->t_end, true, &job->near.block);
            job->near_block = n;
        }
        sides->a = &job->near.block;
        near_box(around, job->t_end, &reached);
        around = &reached;
    }
    struct single box = {&around->side[0][0], 4, 1};
    rows_load(rows, sides->a, rule);
    return overlap(box, rows, rule, until);
}

ENG_INLINE void go_on_with_b(const struct eng_join *job, uint32_t m, enum rule rule,
                             struct sides *sides, struct rows *rows)
{
    if (is_narrow(rule)) {
        const struct eng_narrow_block *narrow = &job->b_narrow[m];
        if (rule != RULE_NARROW_STEP) {
            narrow_rows_until(narrow, job->t_end, rule == RULE_NARROW_NEAR,
                              &sides->b.narrow);
            narrow = &sides->b.narrow;
        }
        pairs_load(rows, narrow, rule, true);
        return;
    }
    const struct eng_wide_block *block = &job->b[m];
    if (rule == RULE_NEAR) {
        near_rows(block, job->t_end, false, &sides->b.block);
        block = &sides->b.block;
    }
    rows_load(rows, block, rule);
}

/* The lanes of b that lane i of a may meet. */
ENG_INLINE struct left overlap_of_lane(const struct sides *sides, uint32_t i,
                                       const struct rows *rows, enum rule rule,
                                       eng_f until)
{
    if (is_narrow(rule)) {
        struct single_pairs box = {&sides->a_narrow->row[0][0][i], 3 * ENG_WIDE,
                                   ENG_WIDE};
        return overlap_narrow(box, rows, rule, true);
    }
    struct single box = {&sides->a->row[0][0][i], 3 * ENG_WIDE, ENG_WIDE};
    return overlap(box, rows, rule, until);
}

/* All pairs of blocks n of a and m of b that the rule lets through; of a block with
 * itself (`self`), those whose second lane is after the first, or the same one too
 * (`twins`). Vertices of a feature of either side: 0 if they do not matter.
 *
 * Whether a lane has any pair at all cannot be foreseen, so what it has is always
 * written, and the count goes on by none. */
ENG_INLINE uint32_t join(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                         uint32_t a_vertices, uint32_t b_vertices, bool twins,
                         bool in_time, enum rule rule, uint32_t *out_a, uint32_t *out_b)
{
    eng_f until = until_of(job->t_end);
    struct rows rows;
    struct sides sides;
    struct left left = begin_with_a(job, n, m, rule, until, &sides, &rows);
    uint32_t lanes = bits_of(&left);
    if (lanes == 0) {
        job->tests++;
        return 0;
    }
    uint32_t count = 0;
    uint32_t wanted = twins ? 0xffffu : 0xfffeu; /* of a block with itself, by lane */
    const uint32_t *corner[2] = {job->a_corner[0], job->a_corner[1]};
    struct corners corners;
    struct found found = {.count = 0};
    corners_load(&corners, job->b_corner, b_vertices, m * ENG_WIDE);
    go_on_with_b(job, m, rule, &sides, &rows);
    job->tests += 1 + (uint32_t)__builtin_popcount(lanes);
    for (; lanes != 0; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        uint32_t slot = n * ENG_WIDE + i;
        left = overlap_of_lane(&sides, i, &rows, rule, until);
        if (a_vertices > 0) {
            without_vertex(&left, &corners, b_vertices,
                           a_vertices == 1 ? slot : corner[0][slot]);
        }
        if (a_vertices > 1) {
            without_vertex(&left, &corners, b_vertices, corner[1][slot]);
        }
        uint32_t bits = bits_of(&left);
        if (self) {
            bits &= wanted << i;
        }
        if (in_time) {
            found.lane[found.count] = i;
            found.bits[found.count] = bits;
            found.count += bits != 0;
        } else {
            eng_fill16(out_a + count, slot);
            count += eng_pack16(out_b + count, bits, m * ENG_WIDE);
        }
    }
    return in_time ? keep_in_time(job, n, m, &found, out_a, out_b) : count;
}

/* The rule, whether it is a block with itself, and whether times are looked at, as
 * constants of the code. */
#define JOIN_BY(a_vertices, b_vertices, twins, self, in_time, rule)                      \
    join(job, n, m, self, a_vertices, b_vertices, twins, in_time, rule, out_a, out_b)
#define JOIN(a_vertices, b_vertices, twins, self, in_time, step, until)                  \
    (job->t_end < 1 ? JOIN_BY(a_vertices, b_vertices, twins, self, in_time, until)       \
                    : JOIN_BY(a_vertices, b_vertices, twins, self, in_time, step))
#define JOIN_OF(a_vertices, b_vertices, twins, self, step, until, near)                  \
    (job->boxes == ENG_JOIN_NEAR                                                         \
         ? JOIN_BY(a_vertices, b_vertices, twins, self, false, near)                     \
     : job->in_time ? JOIN(a_vertices, b_vertices, twins, self, true, step, until)       \
                    : JOIN(a_vertices, b_vertices, twins, self, false, step, until))
#define JOIN_FLOATS(a_vertices, b_vertices, twins, self)                                 \
    (job->boxes == ENG_JOIN_SWEPT                                                        \
         ? JOIN_BY(a_vertices, b_vertices, twins, self, false, RULE_SWEPT)               \
         : JOIN_OF(a_vertices, b_vertices, twins, self, RULE_STEP, RULE_UNTIL,           \
                   RULE_NEAR))
#define JOIN_FEATURES(a_vertices, b_vertices, self)                                      \
    (job->a_narrow ? JOIN_OF(a_vertices, b_vertices, false, self, RULE_NARROW_STEP,      \
                             RULE_NARROW_UNTIL, RULE_NARROW_NEAR)                        \
                   : JOIN_FLOATS(a_vertices, b_vertices, false, self))

uint32_t ENG_KERNEL(join_nodes)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    return self ? JOIN_FLOATS(0, 0, true, true) : JOIN_FLOATS(0, 0, true, false);
}

uint32_t ENG_KERNEL(join_edges)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    return self ? JOIN_FEATURES(2, 2, true) : JOIN_FEATURES(2, 2, false);
}

uint32_t ENG_KERNEL(join_faces)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    (void)self; /* two trees */
    return JOIN_FEATURES(1, 3, false);
}
