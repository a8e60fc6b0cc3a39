/* cross_faces.c - edges that pass through faces at one end of the step, a pair to each
 * lane.
 *
 * Source: BOUNDS.md, "Distances by doubles", "An edge through a face".
 */
#include "across.h"
#include "points.h"
#include "table.h"

#define NEXT(i) ((i) == 2 ? 0 : (i) + 1)

/* A sign that is sure, or neither. */
struct sign {
    eng_dm plus, minus;
};

/* Of e . (a x b), all three differences. */
ENG_INLINE struct sign side_of(struct eng_v e, struct eng_v a, struct eng_v b)
{
    struct eng_across cross = eng_across(a, eng_v_size(a), b, eng_v_size(b));
    eng_d value = eng_v_dot(e, cross.v);
    eng_d error = eng_height_error(eng_v_size(e), &cross);
    return (struct sign){eng_d_less(error, value), eng_d_less(value, -error)};
}

/* Are both sure, and do they differ; are both sure, and alike? */
ENG_INLINE eng_dm differ(struct sign a, struct sign b)
{
    return eng_dm_or(eng_dm_and(a.plus, b.minus), eng_dm_and(a.minus, b.plus));
}

ENG_INLINE eng_dm agree(struct sign a, struct sign b)
{
    return eng_dm_or(eng_dm_and(a.plus, b.plus), eng_dm_and(a.minus, b.minus));
}

/* Both ends of the edge on one side of the face's plane, or its line past a side. */
struct crossing {
    eng_dm yes, no;
};

ENG_INLINE struct crossing cross_lanes(const struct eng_v x[5])
{
    struct eng_v edge = eng_v_sub(x[1], x[0]);
    struct eng_v from[3];
    struct sign turn[3];
    eng_d size = eng_v_size(edge);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        from[i] = eng_v_sub(x[2 + i], x[0]);
        size = eng_d_max(size, eng_v_size(from[i]));
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        turn[i] = side_of(edge, from[i], from[NEXT(i)]);
    }
    struct eng_v u = eng_v_sub(x[3], x[2]);
    struct eng_v v = eng_v_sub(x[4], x[2]);
    struct sign first = side_of(eng_v_sub(x[0], x[2]), u, v);
    struct sign second = side_of(eng_v_sub(x[1], x[2]), u, v);
    eng_dm past = eng_dm_or(eng_dm_or(differ(turn[0], turn[1]), differ(turn[1], turn[2])),
                            differ(turn[2], turn[0]));
    eng_dm through = eng_dm_and(agree(turn[0], turn[1]), agree(turn[1], turn[2]));
    eng_dm fits = eng_is_in_range(size);
    return (struct crossing){eng_dm_and(fits, eng_dm_and(through, differ(first, second))),
                             eng_dm_and(fits, eng_dm_or(past, agree(first, second)))};
}

ENG_INLINE struct eng_v load(const struct eng_point *points, const uint32_t (*pairs)[5],
                             uint32_t n, int corner, uint32_t end)
{
    const double *at[ENG_D_LANES];
#pragma GCC unroll 8
    for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
        const struct eng_point *point = &points[pairs[lane < n ? lane : 0][corner]];
        at[lane] = end == 0 ? point->x0 : point->x1;
    }
    return eng_points_turn(at);
}

void ENG_KERNEL(cross_faces)(const struct eng_point *points, const uint32_t (*pairs)[5],
                             uint32_t count, uint32_t end, struct eng_crossed *out)
{
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t index[ENG_D_LANES];
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        uint32_t all = ENG_D_ALL >> (ENG_D_LANES - n);
        struct eng_v x[5];
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            index[lane] = i + lane;
        }
#pragma GCC unroll 5
        for (int corner = 0; corner < 5; corner++) {
            x[corner] = load(points, pairs + i, n, corner, end);
        }
        struct crossing crossing = cross_lanes(x);
        uint32_t yes = eng_dm_bits(crossing.yes) & all;
        uint32_t open = all & ~(yes | eng_dm_bits(crossing.no));
        out->count += eng_keep(out->index + out->count, index, n, yes);
        out->undecided_count +=
            eng_keep(out->undecided + out->undecided_count, index, n, open);
    }
}
