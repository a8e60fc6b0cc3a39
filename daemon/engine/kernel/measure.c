/* measure.c - distances of pairs at one end of the step, and edges that pass through
 * faces there, a pair to each lane.
 *
 * Write the distances of pairs that are certainly within d, where every rounded number is
 * sure. What is not certain is left to distance.c.
 *
 * Source: BOUNDS.md, "Distances in lanes".
 */
#include <math.h>
#include <stdbool.h>

#include "nearest_points.h"
#include "points.h"
#include "table.h"

/* ---- bounds of a distance -------------------------------------------------------- */

/* Bounds of the distance of two features without knowing what it is between, a
 * pair to each lane.
 *
 * Edges that are parallel, feet that are at a corner: of such pairs lanes do not know
 * where they are nearest, and meshes at rest have many. Most are farther apart than d. */

/* A vector from the second feature to the first. */
struct eng_edge_gap {
    struct eng_v v;
    eng_d square;
};

/* From the point that is `from` the begin of edge e to its nearest point of the edge; or
 * what was shorter before. */
ENG_INLINE void eng_shorten(struct eng_edge_gap *gap, struct eng_v from, struct eng_v e,
                            eng_d per_square, bool is_second)
{
    const eng_d zero = {0};
    eng_d at = eng_d_min(eng_d_max(eng_v_dot(from, e) * per_square, zero), zero + 1);
    struct eng_v v = is_second ? eng_v_sub(eng_v_scale(at, e), from)
                               : eng_v_sub(from, eng_v_scale(at, e));
    eng_d square = eng_v_dot(v, v);
    eng_dm is_shorter = eng_d_less(square, gap->square);
    gap->v = eng_v_select(is_shorter, v, gap->v);
    gap->square = eng_d_select(is_shorter, square, gap->square);
}

/* Bounds of the distance, compared with d. */
struct eng_edge_distance {
    eng_dm near;   /* certainly within d */
    eng_dm beyond; /* certainly not */
};

/* between[count]: all differences of a corner of the first and one of the second. */
ENG_INLINE struct eng_edge_distance
eng_edge_distance_compare(const struct eng_edge_gap *gap, const struct eng_v *between,
                          int count, eng_d d, eng_d square)
{
    const eng_d zero = {0};
    eng_d size = zero;
    eng_d least = eng_v_dot(gap->v, between[0]);
#pragma GCC unroll 4
    for (int i = 0; i < count; i++) {
        size = eng_d_max(size, eng_v_size(between[i]));
        least = eng_d_min(least, eng_v_dot(gap->v, between[i]));
    }
    eng_d error = 32 * ENG_U * size;
    eng_d apart = least - (error * eng_v_size(gap->v) + ENG_LOST);
    eng_dm fits = eng_is_in_range(size);
    return (struct eng_edge_distance){
        eng_dm_and(fits, eng_d_less(eng_d_sqrt(gap->square) + error, d)),
        eng_dm_and(eng_dm_and(fits, eng_d_less(zero, apart)),
                   eng_d_less(square * gap->square + ENG_LOST, apart * apart))};
}

ENG_INLINE struct eng_edge_distance eng_edge_distance_vf(const struct eng_v x[4], eng_d d,
                                                         eng_d square)
{
    struct eng_v to[3];
    struct eng_edge_gap gap = {.square = eng_d_all(INFINITY)};
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        to[i] = eng_v_sub(x[0], x[1 + i]);
    }
    gap.v = to[0];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        struct eng_v side = eng_v_sub(x[1 + (i + 1) % 3], x[1 + i]);
        eng_shorten(&gap, to[i], side, 1 / eng_v_dot(side, side), false);
    }
    return eng_edge_distance_compare(&gap, to, 3, d, square);
}

ENG_INLINE struct eng_edge_distance eng_edge_distance_ee(const struct eng_v x[4], eng_d d,
                                                         eng_d square)
{
    struct eng_v between[4];
    struct eng_edge_gap gap = {.square = eng_d_all(INFINITY)};
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        between[i] = eng_v_sub(x[i / 2], x[2 + i % 2]);
    }
    gap.v = between[0];
    struct eng_v first = eng_v_sub(x[1], x[0]);
    struct eng_v second = eng_v_sub(x[3], x[2]);
    eng_d per_first = 1 / eng_v_dot(first, first);
    eng_d per_second = 1 / eng_v_dot(second, second);
    eng_shorten(&gap, between[0], second, per_second, false);
    eng_shorten(&gap, between[2], second, per_second, false);
    eng_shorten(&gap, eng_v_sub(x[2], x[0]), first, per_first, true);
    eng_shorten(&gap, eng_v_sub(x[3], x[0]), first, per_first, true);
    return eng_edge_distance_compare(&gap, between, 4, d, square);
}

ENG_INLINE struct eng_edge_distance
eng_edge_distance_of(enum pccd_kind kind, const struct eng_v x[4], eng_d d, eng_d square)
{
    return kind == PCCD_VF ? eng_edge_distance_vf(x, d, square)
                           : eng_edge_distance_ee(x, d, square);
}

/* ---- distances ------------------------------------------------------------------- */

/* The state of the lanes. */
struct known {
    eng_dm near;   /* certainly within d */
    eng_dm beyond; /* certainly not */
    eng_dm sure;   /* near, and each number is certainly rounded as it should be */
};

ENG_INLINE struct known measure_lanes(enum pccd_kind kind, const struct eng_v x[4],
                                      double d, enum eng_distance_wanted wanted,
                                      struct eng_distance_lanes *numbers)
{
    struct eng_nearest_points at =
        kind == PCCD_VF ? eng_nearest_vf(x) : eng_nearest_ee(x);
    struct eng_length length = eng_length_of(&at);
    eng_dm known = eng_is_known(&at);
    eng_dm near = eng_dm_and(known, eng_d_less(length.high, eng_d_all(d)));
    eng_dm beyond = eng_dm_and(known, eng_d_less(eng_d_all(d), length.low));
    eng_dm sure = near;
    if (wanted != ENG_DISTANCE_WITHIN) {
        eng_round_length(&length, numbers, &sure);
    }
    if (wanted == ENG_DISTANCE_WHOLE) {
        eng_round_rest(&at, &length, numbers, &sure);
    }
    return (struct known){near, beyond, sure};
}

#if ENG_VECTOR_BYTES == 64

static_assert(sizeof(struct eng_distance) == 64 &&
                  offsetof(struct eng_distance, param) == 16 &&
                  offsetof(struct eng_distance, direction) == 32 &&
                  offsetof(struct eng_distance, type) == 56 &&
                  offsetof(struct eng_distance, points) == 60,
              "a vector");

/* The whole of eight lanes, those `bits` one after the other; the place behind them is
 * written to as well. */
ENG_INLINE void write_eight(const struct eng_distance_lanes *numbers,
                            const uint32_t *pairs, uint32_t bits,
                            struct eng_measured *out)
{
    uint32_t count = out->near_count;
    eng_di code = eng_di_of(numbers->code);
    const eng_d in[8] = {numbers->lo,          numbers->hi,
                         numbers->param[0],    numbers->param[1],
                         numbers->direction.x, numbers->direction.y,
                         numbers->direction.z, eng_d_of((code & 3) | (code >> 2 << 32))};
    eng_d row[8];
    eng_points_turn_back(in, row);
#pragma GCC unroll 8
    for (uint32_t lane = 0; lane < 8; lane++) {
        memcpy(&out->found[count], &row[lane], sizeof row[lane]);
        count += bits >> lane & 1;
    }
    out->near_count += eng_compress(out->index + out->near_count, pairs, 8, bits);
}

#endif

/* Append the lanes `bits`, of n. */
ENG_INLINE void write_near(const struct eng_distance_lanes *numbers,
                           const uint32_t *pairs, uint32_t n, uint32_t bits,
                           enum eng_distance_wanted wanted, struct eng_measured *out)
{
#if ENG_VECTOR_BYTES == 64
    if (wanted == ENG_DISTANCE_WHOLE && n == ENG_D_LANES) {
        write_eight(numbers, pairs, bits, out);
        return;
    }
#else
    (void)n;
#endif
    double at[7][ENG_D_LANES];
    int64_t code[ENG_D_LANES];
    uint32_t count = out->near_count;
    if (wanted != ENG_DISTANCE_WITHIN) {
        eng_d_store(at[0], numbers->lo);
        eng_d_store(at[1], numbers->hi);
    }
    if (wanted == ENG_DISTANCE_WHOLE) {
        eng_d_store(at[2], numbers->param[0]);
        eng_d_store(at[3], numbers->param[1]);
        eng_d_store(at[4], numbers->direction.x);
        eng_d_store(at[5], numbers->direction.y);
        eng_d_store(at[6], numbers->direction.z);
        memcpy(code, &numbers->code, sizeof code);
    }
    for (; bits != 0; bits &= bits - 1, count++) {
        uint32_t lane = (uint32_t)__builtin_ctz(bits);
        out->index[count] = pairs[lane];
        if (wanted == ENG_DISTANCE_WITHIN) {
            continue;
        }
        struct eng_distance *distance = &out->found[count];
        distance->lo = at[0][lane];
        distance->hi = at[1][lane];
        if (wanted == ENG_DISTANCE_WHOLE) {
            distance->param[0] = at[2][lane];
            distance->param[1] = at[3][lane];
            distance->direction[0] = at[4][lane];
            distance->direction[1] = at[5][lane];
            distance->direction[2] = at[6][lane];
            distance->type = (enum eng_nearest)(code[lane] & 3);
            distance->points = (uint32_t)(code[lane] >> 2);
        }
    }
    out->near_count = count;
}

ENG_INLINE void measure(enum pccd_kind kind, enum eng_distance_wanted wanted,
                        const struct eng_point *points, const uint32_t (*quads)[4],
                        const uint32_t *pairs, uint32_t count, uint32_t end, double d,
                        struct eng_measured *out)
{
    eng_d square = eng_d_all(eng_square_most(d));
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        uint32_t all = ENG_D_ALL >> (ENG_D_LANES - n);
        struct eng_group group = eng_group_of(points, quads, pairs + i, n);
        struct eng_v x[4];
        struct eng_distance_lanes numbers;
        eng_group_load_end(&group, end, x);
        struct known known = measure_lanes(kind, x, d, wanted, &numbers);
        uint32_t near = eng_dm_bits(known.near) & all;
        uint32_t sure = eng_dm_bits(known.sure) & all;
        uint32_t undecided = all & ~(near | eng_dm_bits(known.beyond));
        if (undecided != 0) {
            struct eng_edge_distance edges =
                eng_edge_distance_of(kind, x, eng_d_all(d), square);
            near |= undecided & eng_dm_bits(edges.near);
            undecided &= ~(eng_dm_bits(edges.near) | eng_dm_bits(edges.beyond));
        }
        sure = wanted == ENG_DISTANCE_WITHIN ? near : sure;
        write_near(&numbers, pairs + i, n, sure, wanted, out);
        if ((undecided | (near & ~sure)) != 0) {
            out->imprecise_count += eng_compress(out->imprecise + out->imprecise_count,
                                                 pairs + i, n, near & ~sure);
            out->undecided_count += eng_compress(out->undecided + out->undecided_count,
                                                 pairs + i, n, undecided);
        }
    }
}

#define MEASURE(KIND, WANTED)                                                            \
    case WANTED:                                                                         \
        measure(KIND, WANTED, chunk.points, chunk.quads, pairs, count, end, d, out);     \
        break

#define MEASURE_ANY(KIND)                                                                \
    switch (out->wanted) {                                                               \
        MEASURE(KIND, ENG_DISTANCE_WITHIN);                                              \
        MEASURE(KIND, ENG_DISTANCE_LENGTH);                                              \
        MEASURE(KIND, ENG_DISTANCE_WHOLE);                                               \
    }

void ENG_KERNEL(measure)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                         uint32_t end, double d, struct eng_measured *out)
{
    if (chunk.kind == PCCD_VF) {
        MEASURE_ANY(PCCD_VF)
    } else {
        MEASURE_ANY(PCCD_EE)
    }
}

/* ---- edges through faces --------------------------------------------------------- */

ENG_INLINE struct eng_v load_corner(const struct eng_point *points,
                                    const uint32_t (*pairs)[5], uint32_t n, int corner,
                                    uint32_t end)
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
            x[corner] = load_corner(points, pairs + i, n, corner, end);
        }
        struct eng_sure crossing = eng_crossing_of(x);
        uint32_t yes = eng_dm_bits(crossing.yes) & all;
        uint32_t open = all & ~(yes | eng_dm_bits(crossing.no));
        out->count += eng_compress(out->index + out->count, index, n, yes);
        out->undecided_count +=
            eng_compress(out->undecided + out->undecided_count, index, n, open);
    }
}
