/* across.h - products of differences of points, with bounds of their errors, a pair to
 * each lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Distances by doubles".
 */
#ifndef ENG_ACROSS_H
#define ENG_ACROSS_H

#include "query.h"
#include "vectors.h"

/* Sizes for which nothing that is added up here overflows, or loses more than LOST. */
#define ENG_SIZE_LEAST 0x1p-100
#define ENG_SIZE_MOST  0x1p62
#define ENG_LOST       0x1p-900
#define ENG_SQUARE_MIN 0x1p-850

/* The square of d, and what rounding could have lost of it and of what is compared with
 * it. */
ENG_INLINE double eng_square_most(double d)
{
    return d * d * (1 + 32 * ENG_U) + ENG_LOST;
}

/* Of the dot product of two differences of these sizes. */
ENG_INLINE eng_d eng_dot_error(eng_d size_a, eng_d size_b)
{
    return 18.5 * ENG_U * size_a * size_b + ENG_LOST;
}

/* A cross product of two differences; each coordinate is off by `error` at most. */
struct eng_across {
    struct eng_v v;
    eng_d size;
    eng_d error;
};

ENG_INLINE struct eng_across eng_across(struct eng_v a, eng_d size_a, struct eng_v b,
                                        eng_d size_b)
{
    struct eng_across out;
    out.v = eng_v_cross(a, b);
    out.size = eng_v_size(out.v);
    out.error = 8.5 * ENG_U * size_a * size_b + ENG_LOST;
    return out;
}

/* Of the dot product of two cross products. */
ENG_INLINE eng_d eng_across_error(const struct eng_across *a, const struct eng_across *b)
{
    return 3.1 * (a->size * b->error + b->size * a->error + a->error * b->error) +
           9.5 * ENG_U * a->size * b->size + ENG_LOST;
}

/* Of the dot product of a difference and a cross product. */
ENG_INLINE eng_d eng_height_error(eng_d size, const struct eng_across *n)
{
    return 3.1 * size * (n->error + 4.5 * ENG_U * n->size) + ENG_LOST;
}

/* Of differences whose largest has this size, nothing is lost that matters. */
ENG_INLINE eng_dm eng_is_in_range(eng_d size)
{
    return eng_dm_and(eng_d_at_most(eng_d_all(ENG_SIZE_LEAST), size),
                      eng_d_at_most(size, eng_d_all(ENG_SIZE_MOST)));
}

#endif
