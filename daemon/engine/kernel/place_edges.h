/* place_edges.h - between which of their points two edges are nearest, a pair to each
 * lane, where doubles are sure.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Distances in lanes".
 */
#ifndef ENG_PLACE_EDGES_H
#define ENG_PLACE_EDGES_H

#include "place.h"

/* Differences of two edges: ends 0 and 1 of the first, 2 and 3 of the second. */
struct eng_edges {
    struct eng_v edge[2];
    eng_d size_edge[2];
    struct eng_v way[2][2]; /* way[i][j]: from end 2 + j to end i */
    eng_d size_first;       /* of way[0][0] */
    eng_d size_way;         /* the largest */
    /* The foot of an end on the other edge: how far it is from each of its ends, times
     * the edge's length. */
    eng_d foot[4][2];
};

ENG_INLINE eng_dm eng_set_edges(const struct eng_v x[4], struct eng_edges *edges)
{
    eng_d size = {0};
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        edges->edge[i] = eng_v_sub(x[2 * i + 1], x[2 * i]);
        edges->size_edge[i] = eng_v_size(edges->edge[i]);
    }
#pragma GCC unroll 4
    for (int n = 0; n < 4; n++) {
        int i = n / 2;
        int j = n % 2;
        edges->way[i][j] = eng_v_sub(x[i], x[2 + j]);
        size = eng_d_max(size, eng_v_size(edges->way[i][j]));
        eng_d on_first = eng_v_dot(edges->way[i][j], edges->edge[0]);
        eng_d on_second = eng_v_dot(edges->way[i][j], edges->edge[1]);
        edges->foot[i][j] = j == 0 ? on_second : -on_second;
        edges->foot[2 + j][i] = i == 0 ? -on_first : on_first;
    }
    edges->size_first = eng_v_size(edges->way[0][0]);
    edges->size_way = size;
    size = eng_d_max(size, edges->size_edge[0]);
    return eng_is_in_range(eng_d_max(size, edges->size_edge[1]));
}

/* How far each end is from the common perpendicular, times n . n. Those of two ends of an
 * edge together are n . n. */
struct eng_inward {
    eng_d value[4];
    eng_d error[4];
};

ENG_INLINE struct eng_inward eng_inward_of(const struct eng_edges *edges,
                                           struct eng_parts *parts)
{
    struct eng_inward inward;
    eng_d nn_error = eng_across_error(&parts->n, &parts->n);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        struct eng_v m = eng_v_cross(edges->edge[i == 0], edges->way[0][0]);
        inward.value[2 * i] = eng_v_dot(m, parts->n.v);
        inward.error[2 * i] =
            eng_share_error(edges->size_first * edges->size_edge[i == 0], &parts->n);
        inward.value[2 * i + 1] = parts->nn - inward.value[2 * i];
        inward.error[2 * i + 1] = 2 * (inward.error[2 * i] + nn_error);
        parts->share[i] = inward.value[2 * i];
        parts->share_error[i] = inward.error[2 * i];
    }
    return inward;
}

/* Vertices: the ends i and 2 + j, at [i][j]. */
ENG_INLINE void eng_set_ends(struct eng_parts *parts, const struct eng_edges *edges,
                             eng_dm fits, const eng_d error[2], eng_dm ends[2][2])
{
#pragma GCC unroll 4
    for (int n = 0; n < 4; n++) {
        int i = n / 2;
        int j = n % 2;
        ends[i][j] =
            eng_dm_and(fits, eng_dm_and(eng_d_less(edges->foot[i][j], -error[1]),
                                        eng_d_less(edges->foot[2 + j][i], -error[0])));
    }
    parts->vertices =
        eng_dm_or(eng_dm_or(ends[0][0], ends[0][1]), eng_dm_or(ends[1][0], ends[1][1]));
}

/* Which ends and which edge it is, and what follows from that. */
ENG_INLINE void eng_choose_ends(struct eng_parts *parts, const struct eng_edges *edges)
{
    eng_dm first = parts->is_one[0];
    eng_dm second = parts->is_one[1];
    parts->w =
        eng_v_select(first, eng_v_select(second, edges->way[1][1], edges->way[1][0]),
                     eng_v_select(second, edges->way[0][1], edges->way[0][0]));
    parts->e = eng_v_select(parts->moves[1], edges->edge[1], edges->edge[0]);
    parts->foot = eng_dm_or(parts->moves[0], parts->moves[1]);
    eng_d on_first = eng_d_select(first, eng_bits(2u << 2), eng_bits(1u << 2));
    on_first = eng_d_select(parts->moves[0], eng_bits(3u << 2), on_first);
    eng_d on_second = eng_d_select(second, eng_bits(8u << 2), eng_bits(4u << 2));
    on_second = eng_d_select(parts->moves[1], eng_bits(12u << 2), on_second);
    eng_set_code(parts, eng_bits_or(on_first, on_second), ENG_NEAREST_EE);
}

ENG_INLINE struct eng_parts eng_place_ee(const struct eng_v x[4])
{
    struct eng_parts parts;
    struct eng_edges edges;
    eng_dm fits = eng_set_edges(x, &edges);
    parts.n =
        eng_across(edges.edge[0], edges.size_edge[0], edges.edge[1], edges.size_edge[1]);
    parts.nn = eng_v_dot(parts.n.v, parts.n.v);
    struct eng_inward inward = eng_inward_of(&edges, &parts);
    eng_d error[2] = {eng_dot_error(edges.size_way, edges.size_edge[0]),
                      eng_dot_error(edges.size_way, edges.size_edge[1])};
    eng_dm ends[2][2];
    eng_dm foot[4];    /* of that end */
    eng_dm is_next[4]; /* the other edge's second end is nearer to it */
    eng_set_ends(&parts, &edges, fits, error, ends);
    parts.inside = fits;
#pragma GCC unroll 4
    for (int end = 0; end < 4; end++) {
        const eng_d *at = edges.foot[end];
        foot[end] = eng_dm_and(
            eng_dm_and(fits, eng_d_less(error[end < 2], eng_d_min(at[0], at[1]))),
            eng_d_less(inward.value[end], -inward.error[end]));
        is_next[end] = eng_dm_and(foot[end], eng_d_less(at[1], at[0]));
        parts.inside =
            eng_dm_and(parts.inside, eng_d_less(inward.error[end], inward.value[end]));
    }
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        int other = 2 - 2 * i; /* the other edge's first end */
        parts.moves[i] = eng_dm_or(foot[other], foot[other + 1]);
        eng_dm one = eng_dm_or(ends[1][1], i == 0 ? ends[1][0] : ends[0][1]);
        one = eng_dm_or(one, foot[2 * i + 1]);
        one = eng_dm_or(one, eng_dm_or(is_next[other], is_next[other + 1]));
        eng_dm is_farther = eng_d_less(inward.value[2 * i + 1], inward.value[2 * i]);
        parts.is_one[i] = eng_dm_or(one, eng_dm_and(parts.inside, is_farther));
    }
    eng_choose_ends(&parts, &edges);
    return parts;
}

#endif
