/* rims.h - bounds of the distance of two features without knowing what it is between, a
 * pair to each lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Distances in lanes".
 *
 * Edges that are parallel, feet that are at a corner: of such pairs lanes do not know
 * where they are nearest, and meshes at rest have many. Most are farther apart than d.
 */
#ifndef ENG_RIMS_H
#define ENG_RIMS_H

#include <math.h>
#include <stdbool.h>

#include "across.h"
#include "pccd_types.h"

/* A way from the second feature to the first. */
struct eng_rim_way {
    struct eng_v v;
    eng_d square;
};

/* From the point that is `from` the begin of edge e to its nearest point of the edge; or
 * what was shorter before. */
ENG_INLINE void eng_shorten(struct eng_rim_way *way, struct eng_v from, struct eng_v e,
                            eng_d per_square, bool is_second)
{
    const eng_d zero = {0};
    eng_d at = eng_d_min(eng_d_max(eng_v_dot(from, e) * per_square, zero), zero + 1);
    struct eng_v v = is_second ? eng_v_sub(eng_v_times(at, e), from)
                               : eng_v_sub(from, eng_v_times(at, e));
    eng_d square = eng_v_dot(v, v);
    eng_dm is_shorter = eng_d_less(square, way->square);
    way->v = eng_v_select(is_shorter, v, way->v);
    way->square = eng_d_select(is_shorter, square, way->square);
}

/* Bounds of the distance, compared with d. */
struct eng_rims {
    eng_dm near;   /* certainly within d */
    eng_dm beyond; /* certainly not */
};

/* between[count]: all differences of a corner of the first and one of the second. */
ENG_INLINE struct eng_rims eng_compare_rims(const struct eng_rim_way *way,
                                            const struct eng_v *between, int count,
                                            eng_d d, eng_d square)
{
    const eng_d zero = {0};
    eng_d size = zero;
    eng_d least = eng_v_dot(way->v, between[0]);
#pragma GCC unroll 4
    for (int i = 0; i < count; i++) {
        size = eng_d_max(size, eng_v_size(between[i]));
        least = eng_d_min(least, eng_v_dot(way->v, between[i]));
    }
    eng_d error = 32 * ENG_U * size;
    eng_d apart = least - (error * eng_v_size(way->v) + ENG_LOST);
    eng_dm fits = eng_is_in_range(size);
    return (struct eng_rims){
        eng_dm_and(fits, eng_d_less(eng_d_sqrt(way->square) + error, d)),
        eng_dm_and(eng_dm_and(fits, eng_d_less(zero, apart)),
                   eng_d_less(square * way->square + ENG_LOST, apart * apart))};
}

ENG_INLINE struct eng_rims eng_rims_of_vf(const struct eng_v x[4], eng_d d, eng_d square)
{
    struct eng_v to[3];
    struct eng_rim_way way = {.square = eng_d_all(INFINITY)};
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        to[i] = eng_v_sub(x[0], x[1 + i]);
    }
    way.v = to[0];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        struct eng_v side = eng_v_sub(x[1 + (i + 1) % 3], x[1 + i]);
        eng_shorten(&way, to[i], side, 1 / eng_v_dot(side, side), false);
    }
    return eng_compare_rims(&way, to, 3, d, square);
}

ENG_INLINE struct eng_rims eng_rims_of_ee(const struct eng_v x[4], eng_d d, eng_d square)
{
    struct eng_v between[4];
    struct eng_rim_way way = {.square = eng_d_all(INFINITY)};
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        between[i] = eng_v_sub(x[i / 2], x[2 + i % 2]);
    }
    way.v = between[0];
    struct eng_v first = eng_v_sub(x[1], x[0]);
    struct eng_v second = eng_v_sub(x[3], x[2]);
    eng_d per_first = 1 / eng_v_dot(first, first);
    eng_d per_second = 1 / eng_v_dot(second, second);
    eng_shorten(&way, between[0], second, per_second, false);
    eng_shorten(&way, between[2], second, per_second, false);
    eng_shorten(&way, eng_v_sub(x[2], x[0]), first, per_first, true);
    eng_shorten(&way, eng_v_sub(x[3], x[0]), first, per_first, true);
    return eng_compare_rims(&way, between, 4, d, square);
}

ENG_INLINE struct eng_rims eng_rims_of(enum pccd_kind kind, const struct eng_v x[4],
                                       eng_d d, eng_d square)
{
    return kind == PCCD_VF ? eng_rims_of_vf(x, d, square) : eng_rims_of_ee(x, d, square);
}

#endif
