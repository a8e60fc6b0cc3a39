/* daemon/engine/kernel/join.c - the boxes of two blocks against each other.
 *
 * Room:     engine.
 * Does:     see kernel.h.
 * Threads:  [any].
 *
 * One box against sixteen takes, a register of sixteen lanes wide: per axis four sums and
 * two ands of sign bits, 18 operations in all, 9 cycles where two are done at a time (12
 * with compares, of which one is).
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

/* What pairs are tested for. */
enum rule { RULE_STEP, RULE_UNTIL };

struct until {
    eng_f s;
    eng_f t;
};

ENG_INLINE eng_fi apart_one_way(eng_f low0, eng_f low1, eng_f high0, eng_f high1,
                                enum rule rule, const struct until *until)
{
    eng_f h0 = low0 + high0;
    eng_f h1 = low1 + high1;
    if (rule == RULE_UNTIL) {
        h1 = until->s * h0 + (until->t * h1 + 0x1p-120f);
    }
    return (eng_fi)h0 & (eng_fi)h1;
}

/* Bit i: the box may meet that of lane i of the block. */
ENG_INLINE uint32_t overlap(struct single box, const struct eng_wide_block *block,
                            enum rule rule, const struct until *until)
{
    uint32_t apart = 0;
    for (uint32_t part = 0; part < PARTS; part++) {
        eng_fi signs = {0};
        uint32_t at = part * ENG_F_LANES;
        for (size_t k = 0; k < 3; k++) {
            const float *x = box.x + k * box.axis;
            signs |= apart_one_way(
                eng_f_all(x[ENG_LOW0 * box.side]), eng_f_all(x[ENG_LOW1 * box.side]),
                eng_f_load(block->row[ENG_HIGH0][k] + at),
                eng_f_load(block->row[ENG_HIGH1][k] + at), rule, until);
            signs |= apart_one_way(eng_f_load(block->row[ENG_LOW0][k] + at),
                                   eng_f_load(block->row[ENG_LOW1][k] + at),
                                   eng_f_all(x[ENG_HIGH0 * box.side]),
                                   eng_f_all(x[ENG_HIGH1 * box.side]), rule, until);
        }
        apart |= eng_fi_signs(signs) << at;
    }
    return ~apart & 0xffffu;
}

/* Bit i: the feature has a vertex in common with that of slot `first` + i. */
ENG_INLINE uint32_t adjacent(const uint32_t *const a_corner[3], uint32_t a_count,
                             uint32_t slot, const uint32_t *const b_corner[3],
                             uint32_t b_count, uint32_t first)
{
    uint32_t bits = 0;
    for (uint32_t part = 0; part < PARTS; part++) {
        uint32_t at = part * ENG_F_LANES;
        for (uint32_t m = 0; m < b_count; m++) {
            eng_fi vertices = eng_fi_load(b_corner[m] + first + at);
            for (uint32_t n = 0; n < a_count; n++) {
                uint32_t vertex = a_corner[n] ? a_corner[n][slot] : slot;
                bits |= eng_fi_equal(vertices, eng_fi_all(vertex)) << at;
            }
        }
    }
    return bits;
}

/* All pairs of blocks n of a and m of b that the rule lets through; of a block with
 * itself (`self`), those whose second lane is after the first, or the same one too
 * (`twins`). Vertices a feature of either side: 0 if they do not matter. */
ENG_INLINE uint32_t join(struct eng_join *join, uint32_t n, uint32_t m, bool self,
                         uint32_t a_vertices, uint32_t b_vertices, bool twins,
                         enum rule rule, uint32_t *out_a, uint32_t *out_b)
{
    const struct eng_wide_block *a = &join->a[n];
    const struct eng_wide_block *b = &join->b[m];
    struct until until = {eng_f_all(1.0f - join->t_end - 0x1p-20f),
                          eng_f_all(join->t_end + 0x1p-20f)};
    struct single around = {&join->b_boxes[m].side[0][0], 4, 1};
    uint32_t lanes = overlap(around, a, rule, &until);
    uint32_t count = 0;
    uint32_t tests = 1 + (uint32_t)__builtin_popcount(lanes);
    for (; lanes != 0; lanes &= lanes - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(lanes);
        struct single box = {&a->row[0][0][i], 3 * ENG_WIDE, ENG_WIDE};
        uint32_t bits = overlap(box, b, rule, &until);
        if (self) {
            bits &= (twins ? 0xffffu : 0xfffeu) << i;
        }
        if (bits == 0) {
            continue;
        }
        if (a_vertices > 0) {
            bits &= ~adjacent(join->a_corner, a_vertices, n * ENG_WIDE + i,
                              join->b_corner, b_vertices, m * ENG_WIDE);
        }
        eng_fill16(out_a + count, n * ENG_WIDE + i);
        count += eng_pack16(out_b + count, bits, m * ENG_WIDE);
    }
    join->tests += tests;
    return count;
}

/* The rule as a constant of the code. */
#define JOIN(a_vertices, b_vertices, twins, self)                                        \
    return job->t_end < 1 ? join(job, n, m, self, a_vertices, b_vertices, twins,         \
                                 RULE_UNTIL, out_a, out_b)                               \
                          : join(job, n, m, self, a_vertices, b_vertices, twins,         \
                                 RULE_STEP, out_a, out_b)

uint32_t ENG_KERNEL(join_nodes)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    JOIN(0, 0, true, self);
}

uint32_t ENG_KERNEL(join_edges)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    JOIN(2, 2, false, self);
}

uint32_t ENG_KERNEL(join_faces)(struct eng_join *job, uint32_t n, uint32_t m, bool self,
                                uint32_t *out_a, uint32_t *out_b)
{
    (void)self; /* two trees */
    JOIN(1, 3, false, false);
}
