/* filter.c - cheap certain rejections, a pair to each lane.
 *
 * Reject pairs that x, y and z together never let meet, those whose coplanarity cubic
 * certainly has one sign, and those that a face diagonal separates all the time. The
 * cubic is computed from differences to one vertex: VF the vertex, EE the first end of
 * edge a.
 *
 * Source: the margins are derived in BOUNDS.md.
 */
#include "directions.h"
#include "points.h"
#include "query.h"
#include "table.h"
#include "times.h"

/* Differences between points of one feature and points of the other: 3 or 4. */
#define DIFFERENCES_MAX 4

struct pairs {
    int count;
    struct eng_v d[2][DIFFERENCES_MAX];
    struct eng_v edge[2]; /* EE: a1 - a0 */
};

ENG_INLINE struct pairs load(enum pccd_kind kind, const struct eng_group *group)
{
    struct pairs pairs;
    struct eng_v x[4][2];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        eng_group_load(group, i, x[i]);
    }
    pairs.count = kind == PCCD_VF ? 3 : 4;
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
#pragma GCC unroll 4
        for (int k = 0; k < pairs.count; k++) {
            pairs.d[end][k] = kind == PCCD_VF
                                  ? eng_v_sub(x[0][end], x[1 + k][end])
                                  : eng_v_sub(x[2 + k / 2][end], x[k % 2][end]);
        }
        pairs.edge[end] = eng_v_sub(x[1][end], x[0][end]);
    }
    return pairs;
}

/* Smallest and largest difference along a direction at one end. */
ENG_INLINE void project(const struct pairs *pairs, int end, int direction, eng_d *low,
                        eng_d *high)
{
    *low = *high = eng_along(pairs->d[end][0], direction);
#pragma GCC unroll 3
    for (int i = 1; i < pairs->count; i++) {
        eng_d s = eng_along(pairs->d[end][i], direction);
        *low = eng_d_min(*low, s);
        *high = eng_d_max(*high, s);
    }
}

/* Do x, y and z together leave no time? */
ENG_INLINE eng_dm never_together(const struct pairs *pairs)
{
    struct eng_times times = eng_times_all();
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
        eng_d low[2];
        eng_d high[2];
        project(pairs, 0, axis, &low[0], &high[0]);
        project(pairs, 1, axis, &low[1], &high[1]);
        eng_times_cut(&times, low[0], low[1]);
        eng_times_cut(&times, -high[0], -high[1]);
    }
    return eng_times_are_none(&times);
}

/* Separated along x+-y, y+-z or z+-x? Each sum of two rounded differences is within
 * 4 u size of the true one; the margin is 8 u size. */
ENG_INLINE eng_dm separated(const struct pairs *pairs)
{
    eng_d size = eng_v_reach(pairs->d[0][0], pairs->d[1][0]);
#pragma GCC unroll 3
    for (int i = 1; i < pairs->count; i++) {
        size = eng_d_max(size, eng_v_reach(pairs->d[0][i], pairs->d[1][i]));
    }
    eng_d margin = 8 * ENG_U * size;
    eng_dm apart = eng_d_less(margin, -margin); /* none */
#pragma GCC unroll 6
    for (int direction = 3; direction < 9; direction++) {
        eng_d low[2];
        eng_d high[2];
        project(pairs, 0, direction, &low[0], &high[0]);
        project(pairs, 1, direction, &low[1], &high[1]);
        apart = eng_dm_or(apart, eng_d_less(margin, eng_d_min(low[0], low[1])));
        apart = eng_dm_or(apart, eng_d_less(eng_d_max(high[0], high[1]), -margin));
    }
    return apart;
}

/* Bernstein coefficients of the cubic over the step, the middle ones times three, all
 * beyond their error on one side? */
ENG_INLINE eng_dm one_sided(enum pccd_kind kind, const struct pairs *pairs)
{
    const bool is_vf = kind == PCCD_VF;
    const struct eng_v p[3] = {pairs->d[0][0], is_vf ? pairs->d[0][1] : pairs->edge[0],
                               pairs->d[0][2]};
    const struct eng_v q[3] = {pairs->d[1][0], is_vf ? pairs->d[1][1] : pairs->edge[1],
                               pairs->d[1][2]};
    eng_d size =
        eng_v_reach(p[0], q[0]) * eng_v_reach(p[1], q[1]) * eng_v_reach(p[2], q[2]);
    eng_d e = eng_d_all(64 * ENG_U) * size + ENG_TINY;
    struct eng_v n00 = eng_v_cross(p[1], p[2]);
    struct eng_v n11 = eng_v_cross(q[1], q[2]);
    struct eng_v mixed = eng_v_add(eng_v_cross(p[1], q[2]), eng_v_cross(q[1], p[2]));
    eng_d f0 = eng_v_dot(p[0], n00);
    eng_d f1 = eng_v_dot(q[0], n00) + eng_v_dot(p[0], mixed);
    eng_d f2 = eng_v_dot(p[0], n11) + eng_v_dot(q[0], mixed);
    eng_d f3 = eng_v_dot(q[0], n11);
    eng_d e3 = eng_d_all(3) * e;
    eng_dm above =
        eng_dm_and(eng_d_less(e, eng_d_min(f0, f3)), eng_d_less(e3, eng_d_min(f1, f2)));
    eng_dm below =
        eng_dm_and(eng_d_less(eng_d_max(f0, f3), -e), eng_d_less(eng_d_max(f1, f2), -e3));
    return eng_dm_or(above, below);
}

/* Bits of the lanes that certainly have no contact. Which of two tests rejects more
 * depends on the scene, nine of ten pairs with balls in flight by the one, with draped
 * cloth by the other: the better one goes first, and often makes the second superfluous.
 * What is rejected does not depend on the order. */
ENG_INLINE uint32_t rejected(enum pccd_kind kind, const struct pairs *pairs,
                             bool *cubic_first)
{
    uint32_t first = *cubic_first ? eng_dm_bits(one_sided(kind, pairs))
                                  : eng_dm_bits(never_together(pairs));
    if (first == ENG_D_ALL) {
        return first;
    }
    uint32_t second = *cubic_first ? eng_dm_bits(never_together(pairs))
                                   : eng_dm_bits(one_sided(kind, pairs));
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
        uint32_t gone = by_diagonals ? eng_dm_bits(separated(&loaded))
                                     : rejected(kind, &loaded, &cubic_first);
        kept_count += eng_keep(kept + kept_count, pairs + i, n, ENG_D_ALL & ~gone);
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

uint32_t ENG_KERNEL(filter)(enum pccd_kind kind, const struct eng_point *points,
                            const uint32_t (*quads)[4], const uint32_t *pairs,
                            uint32_t count, uint32_t *kept)
{
    return kind == PCCD_VF ? filter_both(PCCD_VF, points, quads, pairs, count, kept)
                           : filter_both(PCCD_EE, points, quads, pairs, count, kept);
}
