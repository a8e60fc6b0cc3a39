/* measure.c - distances of pairs at one end of the step, a pair to each lane.
 *
 * Write the distances of pairs that are certainly within d, where every rounded number is
 * sure. What is not certain is left to distance.c.
 *
 * Source: BOUNDS.md, "Distances in lanes".
 */
#include "across.h"
#include "nearest.h"
#include "pccd_types.h"
#include "points.h"
#include "table.h"
#include <math.h>
#include <stdbool.h>

/* ---- where two features are nearest ---------------------------------------------- */

/* What is known of where two features are nearest, a pair to each lane. */

/* At most one of the masks `vertices`, `foot` and `inside` is set, and means that the
 * distance certainly is between those. What does not belong to it is any number.
 *
 * A point of the first feature and one of the second are chosen: the two vertices; the
 * vertex and the edge's nearer end; or what is nearest to the feet of the insides. */
struct eng_parts {
    eng_dm vertices;
    eng_dm foot;
    eng_dm inside;
    struct eng_v w;      /* from the second to the first of the points that are chosen */
    struct eng_v e;      /* foot: the edge, in one direction or the other */
    struct eng_across n; /* inside: across both features */
    eng_d nn;            /* n . n */
    eng_d share[2];      /* inside: params times n . n */
    eng_d share_error[2];
    /* Else param[i] is 1 where `is_one` is set and 0 elsewhere; moved, where `moves` is
     * set, by how far along e the foot is. */
    eng_dm is_one[2];
    eng_dm moves[2];
    eng_d code; /* bits: type | points << 2, as struct eng_distance has them */
};

/* The bits of a small number; not to compute with. */
ENG_INLINE eng_d eng_bits(uint32_t value)
{
    return eng_d_of((eng_di){0} + (int64_t)value);
}

ENG_INLINE eng_d eng_bits_or(eng_d a, eng_d b)
{
    return eng_d_of(eng_di_of(a) | eng_di_of(b));
}

/* `points` | type, by the masks. */
ENG_INLINE void eng_set_code(struct eng_parts *parts, eng_d points, uint32_t inside)
{
    eng_d type =
        eng_d_select(parts->foot, eng_bits(ENG_NEAREST_VE), eng_bits(ENG_NEAREST_VV));
    parts->code = eng_d_select(parts->inside, eng_bits(inside | 15u << 2),
                               eng_bits_or(points, type));
}

/* Of (a x b) . n, whatever a and b are: `sizes` is the product of theirs. */
ENG_INLINE eng_d eng_share_error(eng_d sizes, const struct eng_across *n)
{
    return sizes * (7 * n->error + 52 * ENG_U * n->size) + ENG_LOST;
}

/* ---- a vertex and a face --------------------------------------------------------- */

/* Say between which of their points a vertex and a face are nearest, a pair to
 * each lane, where doubles are sure. */

#define ENG_NEXT(i) ((i) == 2 ? 0 : (i) + 1)

/* Differences of a vertex and a face. Corner i; side i is the edge from corner i to the
 * next. */
struct eng_face {
    struct eng_v to[3];   /* from the corner to the vertex */
    struct eng_v side[3]; /* from the corner to the next */
    eng_d size_side[3];
    eng_d size_each[3]; /* of to[i] */
    eng_d size_to;      /* the largest of them */
};

/* How the vertex's feet lie: ahead of corner i on side i, back from corner i on the side
 * before. */
struct eng_feet {
    eng_d ahead[3];
    eng_d back[3];
    eng_dm is_between[3]; /* the foot is certainly inside side i */
    eng_dm is_behind[3];  /* certainly no foot inside the sides at corner i */
};

ENG_INLINE eng_dm eng_set_face(const struct eng_v x[4], struct eng_face *face)
{
    eng_d size = {0};
    face->size_to = size;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        face->to[i] = eng_v_sub(x[0], x[1 + i]);
        face->side[i] = eng_v_sub(x[1 + ENG_NEXT(i)], x[1 + i]);
        face->size_side[i] = eng_v_size(face->side[i]);
        face->size_each[i] = eng_v_size(face->to[i]);
        face->size_to = eng_d_max(face->size_to, face->size_each[i]);
        size = eng_d_max(size, face->size_side[i]);
    }
    return eng_is_in_range(eng_d_max(size, face->size_to));
}

ENG_INLINE struct eng_feet eng_feet_of(const struct eng_face *face)
{
    struct eng_feet feet;
    eng_d error[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        feet.ahead[i] = eng_v_dot(face->to[i], face->side[i]);
        feet.back[ENG_NEXT(i)] = -eng_v_dot(face->to[ENG_NEXT(i)], face->side[i]);
        error[i] = eng_dot_error(face->size_to, face->size_side[i]);
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        int before = ENG_NEXT(ENG_NEXT(i));
        feet.is_between[i] =
            eng_d_less(error[i], eng_d_min(feet.ahead[i], feet.back[ENG_NEXT(i)]));
        feet.is_behind[i] = eng_dm_and(eng_d_less(feet.ahead[i], -error[i]),
                                       eng_d_less(feet.back[i], -error[before]));
    }
    return feet;
}

/* Which corner and which side it is, and what follows from that. */
ENG_INLINE void eng_choose_corner(struct eng_parts *parts, const struct eng_face *face,
                                  const eng_dm corner[3], const eng_dm side[3])
{
    parts->w = eng_v_select(corner[1], face->to[1], face->to[0]);
    parts->w = eng_v_select(corner[2], face->to[2], parts->w);
    parts->e = eng_v_select(side[1], face->side[1], face->side[0]);
    parts->e = eng_v_select(side[2], face->side[2], parts->e);
    parts->is_one[0] = corner[1];
    parts->is_one[1] = corner[2];
    parts->moves[0] = eng_dm_or(side[0], side[1]);
    parts->moves[1] = eng_dm_or(side[1], side[2]);
    eng_d at_corner =
        eng_d_select(corner[1], eng_bits((1u | 4u) << 2), eng_bits((1u | 2u) << 2));
    at_corner = eng_d_select(corner[2], eng_bits((1u | 8u) << 2), at_corner);
    eng_d at_side =
        eng_d_select(side[1], eng_bits((1u | 12u) << 2), eng_bits((1u | 6u) << 2));
    at_side = eng_d_select(side[2], eng_bits((1u | 10u) << 2), at_side);
    eng_set_code(parts, eng_d_select(parts->foot, at_side, at_corner), ENG_NEAREST_VF);
}

ENG_INLINE struct eng_parts eng_place_vf(const struct eng_v x[4])
{
    struct eng_parts parts;
    struct eng_face face;
    eng_dm fits = eng_set_face(x, &face);
    struct eng_feet feet = eng_feet_of(&face);
    parts.n =
        eng_across(face.side[2], face.size_side[2], face.side[0], face.size_side[0]);
    parts.nn = eng_v_dot(parts.n.v, parts.n.v);
    /* Of the corner that side i has not; together they are n . n. */
    eng_d share[3];
    eng_d error[3];
#pragma GCC unroll 2
    for (int i = 0; i < 3; i += 2) {
        share[i] = eng_v_dot(eng_v_cross(face.side[i], face.to[i]), parts.n.v);
        error[i] = eng_share_error(face.size_each[i] * face.size_side[i], &parts.n);
        parts.share[i == 0] = share[i];
        parts.share_error[i == 0] = error[i];
    }
    share[1] = parts.nn - share[0] - share[2];
    error[1] = 2 * (error[0] + error[2] + eng_across_error(&parts.n, &parts.n));
    eng_dm corner[3];
    eng_dm side[3];
    eng_dm is_next[3]; /* on side i the next corner is nearer */
    parts.inside = fits;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        side[i] = eng_dm_and(eng_dm_and(fits, feet.is_between[i]),
                             eng_d_less(share[i], -error[i]));
        parts.inside = eng_dm_and(parts.inside, eng_d_less(error[i], share[i]));
        is_next[i] =
            eng_dm_and(side[i], eng_d_less(feet.back[ENG_NEXT(i)], feet.ahead[i]));
    }
    parts.foot = eng_dm_or(eng_dm_or(side[0], side[1]), side[2]);
    parts.vertices =
        eng_dm_and(fits, eng_dm_or(eng_dm_or(feet.is_behind[0], feet.is_behind[1]),
                                   feet.is_behind[2]));
    eng_dm most2 = eng_d_less(eng_d_max(share[1], share[2]), share[0]);
    eng_dm most1 = eng_d_less(eng_d_max(share[0], share[1]), share[2]);
#pragma GCC unroll 2
    for (int i = 1; i < 3; i++) {
        corner[i] = eng_dm_or(eng_dm_and(parts.vertices, feet.is_behind[i]),
                              eng_dm_and(parts.inside, i == 1 ? most1 : most2));
        corner[i] = eng_dm_or(corner[i], is_next[i - 1]);
        corner[i] = eng_dm_or(corner[i], eng_dm_and(side[i], eng_dm_not(is_next[i])));
    }
    eng_choose_corner(&parts, &face, corner, side);
    return parts;
}

/* ---- two edges ------------------------------------------------------------------- */

/* Say between which of their points two edges are nearest, a pair to each
 * lane, where doubles are sure. */

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

/* ---- bounds of a distance -------------------------------------------------------- */

/* Bounds of the distance of two features without knowing what it is between, a
 * pair to each lane.
 *
 * Edges that are parallel, feet that are at a corner: of such pairs lanes do not know
 * where they are nearest, and meshes at rest have many. Most are farther apart than d. */

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

/* ---- numbers --------------------------------------------------------------------- */

/* Doubles of 33 bits: the last 20 of 53 are cut off. */
#define BITS_CUT ((INT64_C(1) << 20) - 1)

/* What struct eng_distance has, in lanes. */
struct numbers {
    eng_d lo, hi;
    eng_d param[2];
    struct eng_v direction;
    eng_d code;
};

/* What is known of the lanes. */
struct known {
    eng_dm near;   /* certainly within d */
    eng_dm beyond; /* certainly not */
    eng_dm sure;   /* near, and each number is certainly rounded as it should be */
};

/* A length, and what params and directions are computed with. */
struct length {
    eng_d value, error;
    eng_d size_w, size_e;
    eng_d inverse;    /* 1 / e.e, 1 / n.n */
    eng_d per;        /* 1 / |e|, 1 / |n| */
    eng_d signed_per; /* by the side on which the first feature is */
    eng_d nn_error;
};

/* A positive normal double without its last bits, `add` times the last one that is left
 * more. */
ENG_INLINE eng_d cut(eng_d x, int64_t add)
{
    return eng_d_of((eng_di_of(x) & ~BITS_CUT) + add * (BITS_CUT + 1));
}

/* The nearest multiple of 2^-32 to x; sure: it is for all that is within twice an error.
 * `room` is half of 2^-32 less that. What is 0 has no sign, as it is a difference of
 * equal numbers. */
ENG_INLINE eng_d fixed(eng_d x, eng_d room, eng_dm *sure)
{
    eng_d nearest = (x + 0x1.8p20) - 0x1.8p20;
    *sure = eng_dm_and(*sure, eng_d_less(eng_d_abs(x - nearest), room));
    return nearest;
}

ENG_INLINE eng_d room_of(eng_d error)
{
    return 0x1p-33 - 2 * error;
}

/* The length; of the masks those go that squares or margins forbid. */
ENG_INLINE struct length length_of(struct eng_parts *parts)
{
    const eng_d least = eng_d_all(ENG_SQUARE_MIN);
    const struct eng_across *n = &parts->n;
    struct length length;
    length.size_w = eng_v_size(parts->w);
    length.size_e = eng_v_size(parts->e);
    struct eng_across m = eng_across(parts->e, length.size_e, parts->w, length.size_w);
    eng_d square =
        eng_d_select(parts->foot, eng_v_dot(m.v, m.v), eng_v_dot(parts->w, parts->w));
    eng_d below = eng_d_select(parts->foot, eng_v_dot(parts->e, parts->e), parts->nn);
    eng_d height = eng_v_dot(parts->w, n->v);
    eng_d height_error = eng_height_error(length.size_w, n);
    eng_dm is_large = eng_d_less(least, square);
    eng_dm is_long = eng_d_less(least, below);
    parts->vertices = eng_dm_and(parts->vertices, is_large);
    parts->foot = eng_dm_and(parts->foot, eng_dm_and(is_large, is_long));
    parts->inside = eng_dm_and(eng_dm_and(parts->inside, is_long),
                               eng_dm_and(eng_d_at_most(n->error, 0x1p-30 * n->size),
                                          eng_d_less(height_error, eng_d_abs(height))));
    length.nn_error = eng_across_error(n, n);
    length.inverse = 1 / below;
    length.per = eng_d_sqrt(below) * length.inverse;
    length.signed_per =
        eng_d_select(eng_d_less(height, eng_d_all(0)), -length.per, length.per);
    eng_d root = eng_d_sqrt(square);
    length.value = eng_d_select(parts->inside, eng_d_abs(height), root);
    length.value = eng_d_select(parts->vertices, root, length.value * length.per);
    eng_d off = eng_d_select(parts->foot, 1.8 * m.error,
                             1.1 * (height_error + 1.8 * length.value * n->error));
    length.error = 12 * ENG_U * length.value;
    length.error =
        eng_d_select(parts->vertices, length.error, length.error + off * length.per);
    return length;
}

/* Params; returns what is subtracted from w, in units of e, to have the direction. */
ENG_INLINE eng_d set_params(const struct eng_parts *parts, const struct length *length,
                            eng_d at_error, struct numbers *numbers, eng_dm *sure)
{
    const eng_d zero = {0};
    eng_d along = eng_v_dot(parts->w, parts->e) * length->inverse;
    eng_d at = eng_d_abs(along);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        eng_d share = parts->share[i] * length->inverse;
        eng_d error =
            1.1 * (parts->share_error[i] + share * length->nn_error) * length->inverse +
            4 * ENG_U * share;
        eng_d value =
            eng_d_select(parts->is_one[i], 1 - eng_d_select(parts->moves[i], at, zero),
                         eng_d_select(parts->moves[i], at, zero));
        error = eng_d_select(parts->inside, error,
                             eng_d_select(parts->moves[i], at_error, zero));
        numbers->param[i] =
            fixed(eng_d_select(parts->inside, share, value), room_of(error), sure);
    }
    return along;
}

ENG_INLINE void set_rest(const struct eng_parts *parts, const struct length *length,
                         struct numbers *numbers, eng_dm *sure)
{
    const eng_d zero = {0};
    /* Of how far along e the foot is, at most 1; the last part is for 1 less that. */
    eng_d at_error =
        eng_dot_error(length->size_w, length->size_e) * length->inverse + 14 * ENG_U;
    eng_d along = set_params(parts, length, at_error, numbers, sure);
    eng_d per_length = 1 / length->value;
    eng_d scale = eng_d_select(parts->inside, length->signed_per, per_length);
    struct eng_v back = eng_v_times(eng_d_select(parts->foot, along, zero), parts->e);
    struct eng_v g = eng_v_select(parts->inside, parts->n.v, eng_v_sub(parts->w, back));
    eng_d foot_error = 1.1 *
                       (4 * ENG_U * length->size_w +
                        (at_error + 6 * ENG_U) * length->size_e + length->error) *
                       per_length;
    eng_d error = eng_d_select(parts->foot, foot_error, zero);
    error = eng_d_select(parts->inside, 3 * parts->n.error * length->per, error);
    eng_d room = room_of(error + 8 * ENG_U);
    numbers->direction =
        (struct eng_v){fixed(g.x * scale, room, sure), fixed(g.y * scale, room, sure),
                       fixed(g.z * scale, room, sure)};
    numbers->code = parts->code;
}

ENG_INLINE struct known measure_lanes(enum pccd_kind kind, const struct eng_v x[4],
                                      double d, enum eng_distance_wanted wanted,
                                      struct numbers *numbers)
{
    struct eng_parts parts = kind == PCCD_VF ? eng_place_vf(x) : eng_place_ee(x);
    struct length length = length_of(&parts);
    eng_dm placed = eng_dm_or(eng_dm_or(parts.vertices, parts.foot), parts.inside);
    /* Twice the error: what is subtracted and added is rounded, too. */
    eng_d low = length.value - 2 * length.error;
    eng_d high = length.value + 2 * length.error;
    struct known known;
    known.near = eng_dm_and(placed, eng_d_less(high, eng_d_all(d)));
    known.beyond = eng_dm_and(placed, eng_d_less(eng_d_all(d), low));
    known.sure = known.near;
    if (wanted != ENG_DISTANCE_WITHIN) {
        numbers->lo = cut(low, 0);
        numbers->hi = cut(low, 1);
        known.sure = eng_dm_and(known.sure, eng_d_less(eng_d_all(ENG_LOST), low));
        known.sure = eng_dm_and(known.sure, eng_dm_and(eng_d_less(numbers->lo, low),
                                                       eng_d_less(high, numbers->hi)));
    }
    if (wanted == ENG_DISTANCE_WHOLE) {
        set_rest(&parts, &length, numbers, &known.sure);
    }
    return known;
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
ENG_INLINE void write_eight(const struct numbers *numbers, const uint32_t *pairs,
                            uint32_t bits, struct eng_measured *out)
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
    out->near_count += eng_keep(out->index + out->near_count, pairs, 8, bits);
}

#endif

/* Append the lanes `bits`, of n. */
ENG_INLINE void write_near(const struct numbers *numbers, const uint32_t *pairs,
                           uint32_t n, uint32_t bits, enum eng_distance_wanted wanted,
                           struct eng_measured *out)
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
        struct numbers numbers;
        eng_group_load_end(&group, end, x);
        struct known known = measure_lanes(kind, x, d, wanted, &numbers);
        uint32_t near = eng_dm_bits(known.near) & all;
        uint32_t sure = eng_dm_bits(known.sure) & all;
        uint32_t undecided = all & ~(near | eng_dm_bits(known.beyond));
        if (undecided != 0) {
            struct eng_rims rims = eng_rims_of(kind, x, eng_d_all(d), square);
            near |= undecided & eng_dm_bits(rims.near);
            undecided &= ~(eng_dm_bits(rims.near) | eng_dm_bits(rims.beyond));
        }
        sure = wanted == ENG_DISTANCE_WITHIN ? near : sure;
        write_near(&numbers, pairs + i, n, sure, wanted, out);
        if ((undecided | (near & ~sure)) != 0) {
            out->imprecise_count += eng_keep(out->imprecise + out->imprecise_count,
                                             pairs + i, n, near & ~sure);
            out->undecided_count +=
                eng_keep(out->undecided + out->undecided_count, pairs + i, n, undecided);
        }
    }
}

#define MEASURE(KIND, WANTED)                                                            \
    case WANTED:                                                                         \
        measure(KIND, WANTED, points, quads, pairs, count, end, d, out);                 \
        break

#define MEASURE_ANY(KIND)                                                                \
    switch (out->wanted) {                                                               \
        MEASURE(KIND, ENG_DISTANCE_WITHIN);                                              \
        MEASURE(KIND, ENG_DISTANCE_LENGTH);                                              \
        MEASURE(KIND, ENG_DISTANCE_WHOLE);                                               \
    }

void ENG_KERNEL(measure)(enum pccd_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], const uint32_t *pairs,
                         uint32_t count, uint32_t end, double d, struct eng_measured *out)
{
    if (kind == PCCD_VF) {
        MEASURE_ANY(PCCD_VF)
    } else {
        MEASURE_ANY(PCCD_EE)
    }
}
