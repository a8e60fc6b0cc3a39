/* stay_beyond.c - thick features that stay farther apart than they reach, a pair to each
 * lane.
 *
 * Reject pairs of which some direction certainly keeps all points of the one more than r
 * beyond all points of the other, at both ends and so all over the step: the axes, the
 * face diagonals, across both features and between their middles as they lie half way, or
 * planes that turn with them; or of which no time is left when all axes are asked.
 *
 * Source: BOUNDS.md, "Thick features in lanes".
 */
#include "across.h"
#include "directions.h"
#include "points.h"
#include "table.h"
#include "times.h"

/* From a point of feature b to one of a. */
#define DIFFERENCES_MAX 4

struct pairs {
    int count;
    struct eng_v d[2][DIFFERENCES_MAX];
    eng_d size;  /* the largest coordinate of them */
    eng_d reach; /* r, and what comparing with it rounds */
};

/* With a vertex first, all kinds are of a vertex and a face: points are repeated. */
ENG_INLINE struct pairs load(uint32_t points_a, const struct eng_group *group,
                             const double reach[ENG_D_LANES])
{
    struct pairs pairs;
    struct eng_v x[4][2];
    pairs.count = points_a == 1 ? 3 : 4;
    pairs.size = (eng_d){0};
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        eng_group_load(group, i, x[i]);
    }
#pragma GCC unroll 4
    for (int k = 0; k < pairs.count; k++) {
        int i = points_a == 1 ? 0 : k / 2;
        int j = points_a == 1 ? 1 + k : 2 + k % 2;
        pairs.d[0][k] = eng_v_sub(x[i][0], x[j][0]);
        pairs.d[1][k] = eng_v_sub(x[i][1], x[j][1]);
        pairs.size = eng_d_max(pairs.size, eng_v_reach(pairs.d[0][k], pairs.d[1][k]));
    }
    pairs.reach = eng_d_load(reach) * (1 + 16 * ENG_U);
    return pairs;
}

/* Do x, y and z together leave no time? At an end, the gap less what it has to be. */
ENG_INLINE eng_dm never_together(const struct pairs *pairs)
{
    struct eng_times times = eng_times_all();
    eng_d reach = pairs->reach + 4 * ENG_U * pairs->size;
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
        eng_d low[2];
        eng_d high[2];
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            low[end] = high[end] = eng_along(pairs->d[end][0], axis);
#pragma GCC unroll 3
            for (int i = 1; i < pairs->count; i++) {
                eng_d s = eng_along(pairs->d[end][i], axis);
                low[end] = eng_d_min(low[end], s);
                high[end] = eng_d_max(high[end], s);
            }
        }
        eng_times_cut(&times, low[0] - reach, low[1] - reach);
        eng_times_cut(&times, -high[0] - reach, -high[1] - reach);
    }
    return eng_times_are_none(&times);
}

/* Is one feature more than `reach` beyond the other, at both ends? */
ENG_INLINE eng_dm beyond(const struct pairs *pairs, int direction, eng_d reach)
{
    eng_d low = eng_along(pairs->d[0][0], direction);
    eng_d high = low;
#pragma GCC unroll 8
    for (int i = 1; i < 2 * pairs->count; i++) {
        eng_d s = eng_along(pairs->d[i % 2][i / 2], direction);
        low = eng_d_min(low, s);
        high = eng_d_max(high, s);
    }
    return eng_dm_or(eng_d_less(reach, low), eng_d_less(high, -reach));
}

ENG_INLINE eng_dm beyond_by_axes(const struct pairs *pairs)
{
    eng_dm apart = beyond(pairs, 0, pairs->reach);
    apart = eng_dm_or(apart, beyond(pairs, 1, pairs->reach));
    return eng_dm_or(apart, beyond(pairs, 2, pairs->reach));
}

/* Diagonals are sqrt(2) long: the factor is more. */
ENG_INLINE eng_dm beyond_by_diagonals(const struct pairs *pairs)
{
    eng_d reach = 0x1.6a09e667f3bcdp0 * pairs->reach + 8 * ENG_U * pairs->size + ENG_TINY;
    eng_dm apart = beyond(pairs, 3, reach);
#pragma GCC unroll 5
    for (int direction = 4; direction < 9; direction++) {
        apart = eng_dm_or(apart, beyond(pairs, direction, reach));
    }
    return apart;
}

/* The same along any vector. */
ENG_INLINE eng_dm beyond_along(const struct pairs *pairs, struct eng_v g)
{
    struct eng_v sizes = eng_v_abs(g);
    eng_d gg = eng_v_dot(g, g);
    eng_d reach = eng_d_sqrt(gg) * (1 + 8 * ENG_U) * pairs->reach +
                  8 * ENG_U * (sizes.x + sizes.y + sizes.z) * pairs->size;
    eng_d low = eng_v_dot(g, pairs->d[0][0]);
    eng_d high = low;
#pragma GCC unroll 8
    for (int i = 1; i < 2 * pairs->count; i++) {
        eng_d s = eng_v_dot(g, pairs->d[i % 2][i / 2]);
        low = eng_d_min(low, s);
        high = eng_d_max(high, s);
    }
    eng_dm apart = eng_dm_or(eng_d_less(reach, low), eng_d_less(high, -reach));
    eng_dm fits = eng_dm_and(eng_is_in_range(pairs->size),
                             eng_d_at_most(eng_d_all(ENG_SQUARE_MIN), gg));
    return eng_dm_and(fits, apart);
}

/* Any vectors would do; these often keep features apart. */
ENG_INLINE eng_dm beyond_half_way(const struct pairs *pairs)
{
    struct eng_v m[DIFFERENCES_MAX];
#pragma GCC unroll 4
    for (int k = 0; k < pairs->count; k++) {
        m[k] = eng_v_add(pairs->d[0][k], pairs->d[1][k]);
    }
    struct eng_v middle = eng_v_add(eng_v_add(m[0], m[1]), m[2]);
    if (pairs->count == 4) {
        middle = eng_v_add(middle, m[3]);
    }
    struct eng_v u = eng_v_sub(m[1], m[0]);
    struct eng_v v = eng_v_sub(m[2], m[0]);
    struct eng_v across = eng_v_cross(u, v); /* EE: along b, along a */
    return eng_dm_or(beyond_along(pairs, across), beyond_along(pairs, middle));
}

/* ---- planes that turn with the features -------------------------------------------- */

/* Sides of both features: u x v is across them. w leads from the one to the other. */
struct sides {
    struct eng_v w, u, v;
};

ENG_INLINE struct sides sides_at_end(const struct pairs *pairs, int end)
{
    const struct eng_v *d = pairs->d[end];
    return (struct sides){d[0], eng_v_sub(d[pairs->count == 3 ? 1 : 2], d[0]),
                          eng_v_sub(d[pairs->count == 3 ? 2 : 1], d[0])};
}

/* A cubic by its Bernstein coefficients between two times, those in the middle three
 * times: w . n, n = u x v, and what of it is certainly at most r |n| in magnitude. */
struct heights {
    eng_d value[4];
    eng_d least[4];
};

ENG_INLINE struct heights heights_between(const struct pairs *pairs,
                                          const struct sides *from,
                                          const struct sides *to)
{
    struct eng_v n[3] = {eng_v_cross(from->u, from->v),
                         eng_v_add(eng_v_cross(from->u, to->v), /* twice */
                                   eng_v_cross(to->u, from->v)),
                         eng_v_cross(to->u, to->v)};
    eng_d square = pairs->size * pairs->size;
    eng_d margin = 640 * ENG_U * square * pairs->size;
    eng_d reach[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        eng_d length = eng_d_sqrt(eng_v_dot(n[i], n[i])) * (1 + 8 * ENG_U);
        reach[i] = (length + 384 * ENG_U * square) * pairs->reach;
    }
    return (struct heights){
        {eng_v_dot(from->w, n[0]), eng_v_dot(from->w, n[1]) + eng_v_dot(to->w, n[0]),
         eng_v_dot(to->w, n[1]) + eng_v_dot(from->w, n[2]), eng_v_dot(to->w, n[2])},
        {reach[0] + margin, reach[0] + reach[1] + 3 * margin,
         reach[1] + reach[2] + 3 * margin, reach[2] + margin}};
}

/* Do the planes stay farther apart than r, on one side? */
ENG_INLINE eng_dm beyond_by_planes(const struct pairs *pairs)
{
    struct sides from = sides_at_end(pairs, 0);
    struct sides to = sides_at_end(pairs, 1);
    struct heights heights = heights_between(pairs, &from, &to);
    eng_dm above = eng_d_less(heights.least[0], heights.value[0]);
    eng_dm below = eng_d_less(heights.value[0], -heights.least[0]);
#pragma GCC unroll 3
    for (int i = 1; i < 4; i++) {
        above = eng_dm_and(above, eng_d_less(heights.least[i], heights.value[i]));
        below = eng_dm_and(below, eng_d_less(heights.value[i], -heights.least[i]));
    }
    return eng_dm_and(eng_is_in_range(pairs->size), eng_dm_or(above, below));
}

/* ---- all over the step ------------------------------------------------------------- */

ENG_INLINE uint32_t stay_beyond(uint32_t points_a, const struct eng_point *points,
                                const uint32_t (*quads)[4], uint32_t count,
                                const double *reach, uint32_t *kept)
{
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        uint32_t pairs[ENG_D_LANES];
        double own[ENG_D_LANES];
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            pairs[lane] = i + (lane < n ? lane : 0);
            own[lane] = reach[pairs[lane]];
        }
        struct eng_group group = eng_group_of(points, quads, pairs, n);
        struct pairs loaded = load(points_a, &group, own);
        uint32_t gone = eng_dm_bits(beyond_by_axes(&loaded));
        if (gone != ENG_D_ALL) { /* pairs that an axis separates are not for it */
            gone |= eng_dm_bits(never_together(&loaded));
        }
        if (gone != ENG_D_ALL) {
            gone |= eng_dm_bits(beyond_half_way(&loaded));
        }
        if (gone != ENG_D_ALL) {
            gone |= eng_dm_bits(beyond_by_planes(&loaded));
        }
        if (gone != ENG_D_ALL) {
            gone |= eng_dm_bits(beyond_by_diagonals(&loaded));
        }
        kept_count += eng_keep(kept + kept_count, pairs, n, ENG_D_ALL & ~gone);
    }
    return kept_count;
}

uint32_t ENG_KERNEL(stay_beyond)(uint32_t points_a, const struct eng_point *points,
                                 const uint32_t (*quads)[4], uint32_t count,
                                 const double *reach, uint32_t *kept)
{
    return points_a == 1 ? stay_beyond(1, points, quads, count, reach, kept)
                         : stay_beyond(2, points, quads, count, reach, kept);
}
