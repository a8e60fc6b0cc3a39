/* daemon/engine/kernel/join.c - the boxes of two blocks against each other.
 *
 * Room:     engine.
 * Does:     see kernel.h.
 * Threads:  [any].
 *
 * One box against sixteen takes, a register of sixteen lanes wide: per axis four sums and
 * two ands of sign bits, 18 operations in all, 9 cycles where two are done at a time (12
 * with compares, of which one is). No box has a zero with a sign (boxes.c), so the sum of
 * two bounds that touch is 0 without one.
 *
 * Up to a time. The gap along an axis, g(t) = (1 - t) g0 + t g1, is linear: where g0 > 0,
 * it stays positive up to t_end if g(t_end) > 0. What is computed here is h = -g: h0 and
 * h1 are sums of two floats, with a relative error of u = 2^-24 each. If h1 < 0 as well
 * the boxes are apart for the whole step. Else h0 < 0 <= h1, and
 *     s h0 + t h1 < 0 with s = (1 - t_end) - 2^-20, t = t_end + 2^-20
 * says it, if h0 and h1 are exact: it is the wanted sum and 2^-20 (|h0| + |h1|) more. The
 * error of the computed sum is below 8 u (|h0| + |h1|) = 2^-21 (..): one for each of h0
 * and h1, one for each of s and t (with the rounding of t_end itself), each product and
 * the sum. 2^-120 covers products below the normal range.
 *
 * In time. What moving boxes let through may be apart along x up to some time and along y
 * from an earlier one on. With h0, h1 as above the boxes can meet along an axis, one way,
 * while (1 - t) h0 + t h1 >= 0: from -h0 / (h1 - h0) on where h0 < 0, up to h0 / (h0 -
 * h1) where h1 < 0 (both are not: such pairs are gone). Numerators have a relative error
 * of u, denominators, sums of two terms of one sign, of 2 u. Of several such times that
 * which products show to be the latest (earliest) is kept; to take another one rejects
 * less. The last comparison is of two products of a numerator and a denominator each:
 * 2 (u + 2 u + u), less than 10 u, and the factor 1 + 2^-19 leaves 32 u. 2^-120 covers
 * products below the normal range.
 */
#include "lanes_pack.h"
#include "table.h"

#define PARTS (ENG_WIDE / ENG_F_LANES)

/* A box that others are tested against: sides and axes that many floats apart. */
struct single {
    const float *x;
    size_t side;
    size_t axis;
};

/* Sixteen boxes: in registers where one holds a row, else where they are. */
struct rows {
    const struct eng_wide_block *block;
#if ENG_F_LANES == 16
    eng_f row[ENG_SIDES][3];
#endif
};

/* What pairs are tested for. */
enum rule { RULE_STEP, RULE_UNTIL };

struct until {
    eng_f s;
    eng_f t;
};

ENG_INLINE void rows_load(struct rows *rows, const struct eng_wide_block *block)
{
    rows->block = block;
#if ENG_F_LANES == 16
#pragma GCC unroll 12
    for (size_t i = 0; i < 3 * ENG_SIDES; i++) {
        rows->row[i / 3][i % 3] = eng_f_load(block->row[i / 3][i % 3]);
    }
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

ENG_INLINE eng_fi apart_one_way(eng_f h0, eng_f h1, enum rule rule,
                                const struct until *until)
{
    if (rule == RULE_UNTIL) {
        h1 = until->s * h0 + (until->t * h1 + 0x1p-120f);
    }
    return (eng_fi)h0 & (eng_fi)h1;
}

/* Signs: apart along an axis, in lanes `at` and after. */
ENG_INLINE eng_fi apart_along(struct single box, const struct rows *rows, size_t axis,
                              uint32_t at, enum rule rule, const struct until *until)
{
    const float *x = box.x + axis * box.axis;
    eng_f up0 = eng_f_all(x[ENG_LOW0 * box.side]) + row_of(rows, ENG_HIGH0, axis, at);
    eng_f up1 = eng_f_all(x[ENG_LOW1 * box.side]) + row_of(rows, ENG_HIGH1, axis, at);
    eng_f down0 = eng_f_all(x[ENG_HIGH0 * box.side]) + row_of(rows, ENG_LOW0, axis, at);
    eng_f down1 = eng_f_all(x[ENG_HIGH1 * box.side]) + row_of(rows, ENG_LOW1, axis, at);
    return apart_one_way(up0, up1, rule, until) |
           apart_one_way(down0, down1, rule, until);
}

/* Bit i: the box may meet that of lane i. */
ENG_INLINE uint32_t overlap(struct single box, const struct rows *rows, enum rule rule,
                            const struct until *until)
{
    uint32_t bits = 0;
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        eng_fi signs = apart_along(box, rows, 0, at, rule, until) |
                       apart_along(box, rows, 1, at, rule, until) |
                       apart_along(box, rows, 2, at, rule, until);
        bits |= eng_fi_no_signs(signs) << at;
    }
    return bits;
}

/* Fractions of the step between which all axes let the boxes meet. */
struct times {
    eng_f from_n, from_d;
    eng_f to_n, to_d;
};

ENG_INLINE void narrow(struct times *times, eng_f h0, eng_f h1)
{
    const eng_f zero = {0};
    eng_f rise = h1 - h0;
    eng_fm later = eng_fm_and(eng_f_less(h0, zero),
                              eng_f_less(times->from_n * rise, -h0 * times->from_d));
    eng_fm sooner = eng_fm_and(eng_f_less(h1, zero),
                               eng_f_less(h0 * times->to_d, -rise * times->to_n));
    times->from_n = eng_f_select(later, -h0, times->from_n);
    times->from_d = eng_f_select(later, rise, times->from_d);
    times->to_n = eng_f_select(sooner, h0, times->to_n);
    times->to_d = eng_f_select(sooner, -rise, times->to_d);
}

/* Bit i: no time brings the box and that of lane i together. Only for pairs that
 * overlap. */
ENG_INLINE uint32_t never_together(struct single box, const struct rows *rows)
{
    uint32_t bits = 0;
    for (uint32_t at = 0; at < ENG_WIDE; at += ENG_F_LANES) {
        struct times times = {eng_f_all(0), eng_f_all(1), eng_f_all(1), eng_f_all(1)};
        for (size_t axis = 0; axis < 3; axis++) {
            const float *x = box.x + axis * box.axis;
            narrow(&times,
                   eng_f_all(x[ENG_LOW0 * box.side]) + row_of(rows, ENG_HIGH0, axis, at),
                   eng_f_all(x[ENG_LOW1 * box.side]) + row_of(rows, ENG_HIGH1, axis, at));
            narrow(&times,
                   eng_f_all(x[ENG_HIGH0 * box.side]) + row_of(rows, ENG_LOW0, axis, at),
                   eng_f_all(x[ENG_HIGH1 * box.side]) + row_of(rows, ENG_LOW1, axis, at));
        }
        eng_f to = times.to_n * times.from_d * (1 + 0x1p-19f) + 0x1p-120f;
        bits |= eng_fm_bits(eng_f_less(to, times.from_n * times.to_d)) << at;
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

/* Of `bits`, those whose feature has not this vertex. */
ENG_INLINE uint32_t without_vertex(uint32_t bits, const struct corners *corners,
                                   uint32_t count, uint32_t vertex)
{
#pragma GCC unroll 3
    for (uint32_t k = 0; k < count; k++) {
        for (uint32_t part = 0; part < PARTS; part++) {
            eng_fi same = eng_fi_all(vertex);
            bits =
                eng_fi_unequal(bits, corners->vertex[k][part], same, part * ENG_F_LANES);
        }
    }
    return bits;
}

/* All pairs of blocks n of a and m of b that the rule lets through; of a block with
 * itself (`self`), those whose second lane is after the first, or the same one too
 * (`twins`). Vertices of a feature of either side: 0 if they do not matter.
 *
 * Whether a lane has any pair at all cannot be foreseen, so what it has is always
 * written, and the count goes on by none. */
ENG_INLINE uint32_t join(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                         uint32_t a_vertices, uint32_t b_vertices, bool twins,
                         enum rule rule, uint32_t *out_a, uint32_t *out_b)
{
    const struct eng_wide_block *a = &job->a[n];
    struct until until = {eng_f_all(1.0f - job->t_end - 0x1p-20f),
                          eng_f_all(job->t_end + 0x1p-20f)};
    struct single around = {&job->b_boxes[m].side[0][0], 4, 1};
    struct rows rows;
    rows_load(&rows, a);
    uint32_t lanes = overlap(around, &rows, rule, &until);
    if (lanes == 0) {
        job->tests++;
        return 0;
    }
    uint32_t count = 0;
    uint32_t wanted = twins ? 0xffffu : 0xfffeu; /* of a block with itself, by lane */
    const uint32_t *corner[2] = {job->a_corner[0], job->a_corner[1]};
    struct corners corners;
    corners_load(&corners, job->b_corner, b_vertices, m * ENG_WIDE);
    rows_load(&rows, &job->b[m]);
    job->tests += 1 + (uint32_t)__builtin_popcount(lanes);
    for (; lanes != 0; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        uint32_t slot = n * ENG_WIDE + i;
        struct single box = {&a->row[0][0][i], 3 * ENG_WIDE, ENG_WIDE};
        uint32_t bits = overlap(box, &rows, rule, &until);
        if (self) {
            bits &= wanted << i;
        }
        if (a_vertices > 0) {
            bits = without_vertex(bits, &corners, b_vertices,
                                  a_vertices == 1 ? slot : corner[0][slot]);
        }
        if (a_vertices > 1) {
            bits = without_vertex(bits, &corners, b_vertices, corner[1][slot]);
        }
        if (a_vertices > 0 && job->in_time && bits != 0) {
            uint32_t never = bits & never_together(box, &rows);
            job->apart_in_time += (uint32_t)__builtin_popcount(never);
            bits ^= never;
        }
        eng_fill16(out_a + count, slot);
        count += eng_pack16(out_b + count, bits, m * ENG_WIDE);
    }
    return count;
}

/* The rule, and whether it is a block with itself, as constants of the code. */
#define JOIN_BY(a_vertices, b_vertices, twins, self, rule)                               \
    join(job, n, m, self, a_vertices, b_vertices, twins, rule, out_a, out_b)
#define JOIN(a_vertices, b_vertices, twins, self)                                        \
    (job->t_end < 1 ? JOIN_BY(a_vertices, b_vertices, twins, self, RULE_UNTIL)           \
                    : JOIN_BY(a_vertices, b_vertices, twins, self, RULE_STEP))

uint32_t ENG_KERNEL(join_nodes)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    return self ? JOIN(0, 0, true, true) : JOIN(0, 0, true, false);
}

uint32_t ENG_KERNEL(join_edges)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    return self ? JOIN(2, 2, false, true) : JOIN(2, 2, false, false);
}

uint32_t ENG_KERNEL(join_faces)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    (void)self; /* two trees */
    return JOIN(1, 3, false, false);
}
