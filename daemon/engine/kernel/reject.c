/* reject.c - rejects pairs by doubles, a pair to each lane.
 *
 * `filter`: pairs that do not meet. `reject_thick`: pairs that stay farther apart than a
 * reach all over the step. `reject_at_end`: pairs that are farther apart than a distance
 * at one end of it.
 *
 * Source: BOUNDS.md, the chapters "Filter", "Thick features in lanes", "Distances in
 * lanes".
 */
#include "reject.h"
#include "nearest_points.h"
#include "points.h"
#include "table.h"

struct pairs {
    struct eng_v d[2][DIFFERENCES];
    struct eng_v along_a[2]; /* EE: a1 - a0 */
};

ENG_INLINE struct pairs load(enum pccd_kind kind, const struct eng_group *group)
{
    struct pairs pairs;
    struct eng_v x[4][2];
    eng_group_load(group, x);
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const struct eng_v at[4] = {x[0][end], x[1][end], x[2][end], x[3][end]};
        subtract(kind, at, pairs.d[end]);
        pairs.along_a[end] = eng_v_sub(at[1], at[0]);
    }
    return pairs;
}

/* ---- filter ------------------------------------------------------------------------ */

ENG_INLINE uint32_t time_rejects(enum pccd_kind kind, const struct pairs *pairs)
{
    return leave_no_time(kind, pairs->d, eng_d_all(1), eng_d_all(0));
}

ENG_INLINE uint32_t diagonals_reject(enum pccd_kind kind, const struct pairs *pairs)
{
    return are_beyond(kind, pairs->d, AXES, DIRECTIONS, diagonal_margin(kind, pairs->d));
}

/* By three differences that lie in a plane where the features do. */
ENG_INLINE uint32_t planes_reject(enum pccd_kind kind, const struct pairs *pairs)
{
    struct sides sides;
    struct eng_v n[3];
    eng_d f[4];
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const struct eng_v *d = pairs->d[end];
        sides.w[end] = d[0];
        sides.u[end] = kind == PCCD_VF ? d[1] : pairs->along_a[end];
        sides.v[end] = kind == PCCD_VF ? d[2] : d[1];
    }
    eng_d size = eng_v_size_of_two(sides.w[0], sides.w[1]) *
                 eng_v_size_of_two(sides.u[0], sides.u[1]) *
                 eng_v_size_of_two(sides.v[0], sides.v[1]);
    heights_of(&sides, n, f);
    return heights_miss(f, 80 * ENG_U * size + ENG_TINY);
}

/* Bits of the lanes that certainly have no contact. The better one of two tests goes
 * first, as in sift.c, and often makes the second superfluous. */
ENG_INLINE uint32_t rejected(enum pccd_kind kind, const struct pairs *pairs,
                             bool *cubic_first)
{
    uint32_t first =
        *cubic_first ? planes_reject(kind, pairs) : time_rejects(kind, pairs);
    if (first == ENG_D_ALL) {
        return first;
    }
    uint32_t second =
        *cubic_first ? time_rejects(kind, pairs) : planes_reject(kind, pairs);
    if (__builtin_popcount(second) > __builtin_popcount(first)) {
        *cubic_first = !*cubic_first;
    }
    return first | second;
}

ENG_INLINE uint32_t filter(enum pccd_kind kind, bool by_diagonals,
                           const struct eng_point *points, const uint32_t (*quads)[4],
                           const uint32_t *pairs, uint32_t count, uint32_t *kept)
{
    uint32_t kept_count = 0;
    bool cubic_first = false;
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        struct eng_group group = eng_group_of(points, quads, pairs + i, n);
        struct pairs loaded = load(kind, &group);
        uint32_t gone = by_diagonals ? diagonals_reject(kind, &loaded)
                                     : rejected(kind, &loaded, &cubic_first);
        kept_count += eng_compress(kept + kept_count, pairs + i, n, ENG_D_ALL & ~gone);
    }
    return kept_count;
}

/* The diagonals take a third of the time and come last: on recorded cloth the others
 * leave 7 to 34 % of the pairs, which are worth loading again. */
ENG_INLINE uint32_t filter_both(enum pccd_kind kind, const struct eng_point *points,
                                const uint32_t (*quads)[4], const uint32_t *pairs,
                                uint32_t count, uint32_t *kept)
{
    count = filter(kind, false, points, quads, pairs, count, kept);
    return filter(kind, true, points, quads, kept, count, kept);
}

uint32_t ENG_KERNEL(filter)(struct eng_quads chunk, const uint32_t *pairs, uint32_t count,
                            uint32_t *kept)
{
    return chunk.kind == PCCD_VF
               ? filter_both(PCCD_VF, chunk.points, chunk.quads, pairs, count, kept)
               : filter_both(PCCD_EE, chunk.points, chunk.quads, pairs, count, kept);
}

/* ---- thick features ---------------------------------------------------------------- */

/* Return the lanes in which this vector, of which any would do, keeps the features more
 * than the reach apart at both ends. */
ENG_INLINE uint32_t beyond_along(enum pccd_kind kind, const struct pairs *pairs,
                                 eng_d size, eng_d reach, struct eng_v g)
{
    struct eng_v sizes = eng_v_abs(g);
    eng_d gg = eng_v_dot(g, g);
    eng_d least =
        eng_d_sqrt(gg) * reach + 8 * ENG_U * (sizes.x + sizes.y + sizes.z) * size;
    eng_d low = eng_v_dot(g, pairs->d[0][0]);
    eng_d high = low;
#pragma GCC unroll 8
    for (int i = 1; i < 2 * differences_of(kind); i++) {
        eng_d s = eng_v_dot(g, pairs->d[i % 2][i / 2]);
        low = eng_d_min(low, s);
        high = eng_d_max(high, s);
    }
    return are_on_one_side(1, &low, &high, &least) &
           eng_dm_bits(eng_dm_and(eng_is_in_range(size),
                                  eng_d_at_most(eng_d_all(ENG_SQUARE_MIN), gg)));
}

/* Half way, across both features and between their middles: that often keeps them
 * apart. */
ENG_INLINE uint32_t beyond_half_way(enum pccd_kind kind, const struct pairs *pairs,
                                    eng_d size, eng_d reach)
{
    struct eng_v m[DIFFERENCES];
#pragma GCC unroll 4
    for (int k = 0; k < differences_of(kind); k++) {
        m[k] = eng_v_add(pairs->d[0][k], pairs->d[1][k]);
    }
    struct eng_v middle = eng_v_add(eng_v_add(m[0], m[1]), m[2]);
    if (kind == PCCD_EE) {
        middle = eng_v_add(middle, m[3]);
    }
    struct eng_v across = eng_v_cross(eng_v_sub(m[1], m[0]), eng_v_sub(m[2], m[0]));
    return beyond_along(kind, pairs, size, reach, across) |
           beyond_along(kind, pairs, size, reach, middle);
}

/* EE: along b, and along a, as differences of differences. */
ENG_INLINE struct sides sides_of(const struct pairs *pairs)
{
    struct sides sides;
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const struct eng_v *d = pairs->d[end];
        sides.w[end] = d[0];
        sides.u[end] = eng_v_sub(d[1], d[0]);
        sides.v[end] = eng_v_sub(d[2], d[0]);
    }
    return sides;
}

ENG_INLINE uint32_t beyond_by_planes(const struct pairs *pairs, eng_d size, eng_d reach)
{
    const struct sides sides = sides_of(pairs);
    eng_d square = size * size;
    return planes_are_beyond(&sides, reach, 640 * ENG_U * square * size,
                             384 * ENG_U * square) &
           eng_dm_bits(eng_is_in_range(size));
}

/* Return the part of the step up to which a cubic in Bernstein form is certainly
 * positive: it is not below the line from the first of its coefficients to that of the
 * others to which it falls fastest; once more with what is left of it. */
ENG_INLINE eng_d positive_until(const eng_d f[4])
{
    const eng_d zero = {0};
    const eng_d one = eng_d_all(1);
    eng_d h[4] = {f[0], f[1], f[2], f[3]};
    eng_d part[2];
#pragma GCC unroll 2
    for (int cut = 0; cut < 2; cut++) {
        eng_d fall = eng_d_max(eng_d_max(3 * (h[0] - h[1]), 1.5 * (h[0] - h[2])),
                               h[0] - h[3]);
        part[cut] = eng_d_select(eng_d_less(h[0], fall), h[0] / fall, one);
        part[cut] = eng_d_select(eng_d_less(zero, h[0]), part[cut], zero);
#pragma GCC unroll 3
        for (int level = 3; level > 0 && cut == 0; level--) {
#pragma GCC unroll 3
            for (int i = 0; i < level; i++) {
                h[i] += part[0] * (h[i + 1] - h[i]);
            }
        }
    }
    return (part[0] + (1 - part[0]) * part[1]) * (1 - 16 * ENG_U);
}

/* Return the lanes in which planes across both features keep them more than the reach
 * apart, but for a part of the step in which the direction between them half way does. */
ENG_INLINE uint32_t beyond_between(enum pccd_kind kind, const struct pairs *pairs,
                                   eng_d size, eng_d reach)
{
    const struct sides sides = sides_of(pairs);
    const eng_d square = size * size;
    const eng_d error = 4096 * ENG_U * square * size;
    const eng_d zero = {0};
    struct eng_v n[3];
    eng_d f[4];
    eng_d most[3];
    heights_of(&sides, n, f);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        most[i] = reach * (eng_d_sqrt(eng_v_dot(n[i], n[i])) + 384 * ENG_U * square);
    }
    f[1] = f[1] * (1 / 3.0);
    f[2] = f[2] * (1 / 3.0);
    const eng_d least[4] = {most[0] + error, (most[0] + most[1]) * (1 / 3.0) + error,
                            (most[1] + most[2]) * (1 / 3.0) + error, most[2] + error};
    eng_d from[2]; /* of the parts in which planes keep them apart, from either end */
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        const eng_dm above = eng_d_less(zero, f[3 * end]);
        eng_d h[4];
#pragma GCC unroll 4
        for (int i = 0; i < 4; i++) {
            const int k = end == 0 ? i : 3 - i;
            h[i] = eng_d_select(above, f[k], -f[k]) - least[k];
        }
        from[end] = positive_until(h);
    }
    const eng_d to = 1 - from[1];
    const eng_d t = 0.5 * (from[0] + to);
    struct eng_v m[DIFFERENCES];
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        m[k] = eng_v_mix(1 - t, pairs->d[0][k], t, pairs->d[1][k]);
    }
    const struct eng_pose_lanes pose = {
        m[0], kind == PCCD_VF ? eng_v_sub(m[0], m[1]) : eng_v_sub(m[0], m[2]),
        kind == PCCD_VF ? eng_v_sub(m[0], m[2]) : eng_v_sub(m[0], m[1])};
    const struct eng_v g = eng_nearest_gap_of(kind, &pose).gap;
    const struct eng_v sizes = eng_v_abs(g);
    const eng_d gg = eng_v_dot(g, g);
    const eng_d apart =
        eng_d_sqrt(gg) * reach + 32 * ENG_U * (sizes.x + sizes.y + sizes.z) * size;
    eng_d low = zero + __builtin_inf();
    eng_d high = -low;
#pragma GCC unroll 4
    for (int k = 0; k < differences_of(kind); k++) {
        const eng_d s0 = eng_v_dot(g, pairs->d[0][k]);
        const eng_d way = eng_v_dot(g, pairs->d[1][k]) - s0;
        const eng_d s[2] = {s0 + from[0] * way, s0 + to * way};
        low = eng_d_min(low, eng_d_min(s[0], s[1]));
        high = eng_d_max(high, eng_d_max(s[0], s[1]));
    }
    return are_on_one_side(1, &low, &high, &apart) &
           eng_dm_bits(eng_dm_and(eng_is_in_range(size),
                                  eng_d_at_most(eng_d_all(ENG_SQUARE_MIN), gg)));
}

ENG_INLINE uint32_t thick_rejected(enum pccd_kind kind, const struct pairs *pairs,
                                   eng_d reach)
{
    eng_d size = size_of_all(kind, pairs->d);
    uint32_t gone = are_beyond(kind, pairs->d, 0, AXES, reach);
    if (gone != ENG_D_ALL) {
        gone |= leave_no_time(kind, pairs->d, eng_d_all(1), reach);
    }
    if (gone != ENG_D_ALL) {
        gone |= beyond_half_way(kind, pairs, size, reach);
    }
    if (gone != ENG_D_ALL) {
        gone |= beyond_by_planes(pairs, size, reach);
    }
    if (gone != ENG_D_ALL) {
        gone |= are_beyond(kind, pairs->d, AXES, DIRECTIONS,
                           DIAGONAL * reach + diagonal_margin(kind, pairs->d) + ENG_TINY);
    }
    return gone;
}

/* `pairs`: what the quick tests have left, if this is the last one. */
ENG_INLINE uint32_t reject_thick_by(enum pccd_kind kind, bool is_last,
                                    const struct eng_point *points,
                                    const uint32_t (*quads)[4], const uint32_t *pairs,
                                    uint32_t count, const double *reach, uint32_t *kept)
{
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        uint32_t these[ENG_D_LANES];
        double own[ENG_D_LANES];
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            const uint32_t at = i + (lane < n ? lane : 0);
            these[lane] = is_last ? pairs[at] : at;
            own[lane] = reach[these[lane]];
        }
        struct eng_group group = eng_group_of(points, quads, these, n);
        struct pairs loaded = load(kind, &group);
        const eng_d most = eng_d_load(own) * ENG_SLACK;
        uint32_t gone =
            is_last ? beyond_between(kind, &loaded, size_of_all(kind, loaded.d), most)
                    : thick_rejected(kind, &loaded, most);
        kept_count += eng_compress(kept + kept_count, these, n, ENG_D_ALL & ~gone);
    }
    return kept_count;
}

ENG_INLINE uint32_t reject_thick(enum pccd_kind kind, const struct eng_point *points,
                                 const uint32_t (*quads)[4], uint32_t count,
                                 const double *reach, uint32_t *kept)
{
    count = reject_thick_by(kind, false, points, quads, NULL, count, reach, kept);
    return reject_thick_by(kind, true, points, quads, kept, count, reach, kept);
}

uint32_t ENG_KERNEL(reject_thick)(struct eng_quads chunk, uint32_t count,
                                  const double *reach, uint32_t *kept)
{
    return chunk.kind != PCCD_EE
               ? reject_thick(PCCD_VF, chunk.points, chunk.quads, count, reach, kept)
               : reject_thick(PCCD_EE, chunk.points, chunk.quads, count, reach, kept);
}

/* ---- at one end -------------------------------------------------------------------- */

ENG_INLINE eng_dm planes_at_end(enum pccd_kind kind, const struct eng_v x[4],
                                eng_d square)
{
    bool is_vf = kind == PCCD_VF;
    struct eng_v w = eng_v_sub(x[0], is_vf ? x[1] : x[2]);
    struct eng_v u = eng_v_sub(is_vf ? x[2] : x[1], is_vf ? x[1] : x[0]);
    struct eng_v v = eng_v_sub(x[3], is_vf ? x[1] : x[2]);
    struct eng_cross_product n = eng_cross_product_of(u, eng_v_size(u), v, eng_v_size(v));
    return plane_is_beyond(w, n.v, eng_height_error(eng_v_size(w), &n),
                           eng_cross_product_error(&n, &n), square);
}

ENG_INLINE uint32_t reject_at_end(enum pccd_kind kind, const struct eng_point *points,
                                  const uint32_t (*quads)[4], uint32_t count,
                                  uint32_t end, double d, uint32_t *kept)
{
    uint32_t kept_count = 0;
    eng_d square = eng_d_all(eng_square_most(d));
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t pairs[ENG_D_LANES];
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            pairs[lane] = i + lane;
        }
        struct eng_group group = eng_group_of(points, quads, pairs, n);
        struct eng_v x[4];
        struct eng_v differences[DIFFERENCES];
        eng_group_load_end(&group, end, x);
        subtract(kind, x, differences);
        eng_dm gone = eng_dm_or(boxes_are_beyond(kind, differences, eng_d_all(1), square),
                                planes_at_end(kind, x, square));
        kept_count +=
            eng_compress(kept + kept_count, pairs, n, ENG_D_ALL & ~eng_dm_bits(gone));
    }
    return kept_count;
}

uint32_t ENG_KERNEL(reject_at_end)(struct eng_quads chunk, uint32_t count, uint32_t end,
                                   double d, uint32_t *kept)
{
    return chunk.kind == PCCD_VF
               ? reject_at_end(PCCD_VF, chunk.points, chunk.quads, count, end, d, kept)
               : reject_at_end(PCCD_EE, chunk.points, chunk.quads, count, end, d, kept);
}
