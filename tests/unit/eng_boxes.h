/* eng_boxes.h - makes blocks of boxes, some of which overlap, for the tests of joins. */
#ifndef TEST_ENG_BOXES_H
#define TEST_ENG_BOXES_H

#include "eng_kit.h"
#include "kernel.h"

#define BLOCKS 4u
#define BOXES  (BLOCKS * ENG_WIDE)

/* Pairs that a join finds. */
struct lists {
    uint32_t a[ENG_JOIN_MAX];
    uint32_t b[ENG_JOIN_MAX];
    uint32_t count;
};

typedef uint32_t join_fn(struct eng_join *job, struct eng_join_round *round,
                         uint32_t *out_a, uint32_t *out_b, uint32_t room);

/* The pairs of two blocks. */
static inline void join_two(join_fn *join, struct eng_join *job, uint32_t n, uint32_t m,
                            struct lists *out)
{
    static struct eng_join_round round;
    eng_join_begin(&round, &n, &m, 1);
    out->count = join(job, &round, out->a, out->b, ENG_JOIN_MAX);
    assert_true(eng_join_has_ended(&round));
}

static inline void assert_same_lists(const struct lists *a, const struct lists *b)
{
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->a, b->a, a->count * sizeof *a->a);
    assert_memory_equal(a->b, b->b, a->count * sizeof *a->b);
}

/* A box that meets none. */
static inline void set_nowhere(struct eng_extents *box)
{
    float *bound = &box->side[0][0];
    for (int k = 0; k < 16; k++) {
        bound[k] = ENG_NOWHERE;
    }
}

/* Boxes of which about a third meet: some touch exactly, some are nowhere; corners that
 * many features share. */
static inline void fill_boxes(struct eng_extents boxes[BOXES], uint32_t corner[3][BOXES],
                              struct prng *random)
{
    for (uint32_t i = 0; i < BOXES; i++) {
        for (int end = 0; end < 2; end++) {
            for (int k = 0; k < 4; k++) {
                float lo = (float)prng_integer(random, 12);
                float size = (float)prng_u32(random, 10);
                boxes[i].side[ENG_LOW0 + end][k] = 0 - lo;
                boxes[i].side[ENG_HIGH0 + end][k] = lo + size;
            }
        }
        for (int k = 0; k < 3; k++) {
            corner[k][i] = prng_u32(random, BOXES);
        }
        if (i % 11 == 5) {
            set_nowhere(&boxes[i]);
        }
    }
}

/* Return whether two boxes can meet on all axes at one time, give or take `margin`. */
static inline bool meet_in_time(const struct eng_extents *a, const struct eng_extents *b,
                                double margin)
{
    double from = 0;
    double to = 1;
    for (int k = 0; k < 3; k++) {
        for (int way = 0; way < 2; way++) {
            const struct eng_extents *low = way ? b : a;
            const struct eng_extents *high = way ? a : b;
            double h0 = (double)low->side[ENG_LOW0][k] + high->side[ENG_HIGH0][k];
            double h1 = (double)low->side[ENG_LOW1][k] + high->side[ENG_HIGH1][k];
            from = h0 < 0 ? fmax(from, h0 / (h0 - h1)) : from;
            to = h1 < 0 ? fmin(to, h0 / (h0 - h1)) : to;
        }
    }
    return from <= to + margin;
}

#endif
