/* nearest_points.h - where two features are nearest to each other at one moment and how
 * far apart they are, and whether an edge passes through a face: a pair to each lane.
 *
 * What is said is certain: lanes of which rounding hides the answer are in no mask.
 * measure.c asks it of many pairs, elementary/distance.c of one.
 *
 * Source: BOUNDS.md, "Distances by doubles".
 */
#ifndef ENG_NEAREST_POINTS_H
#define ENG_NEAREST_POINTS_H

#include <stdint.h>

#include "lanes.h"
#include "pccd_types.h"
#include "query.h"

/* ---- products of differences, with bounds of their errors ------------------------ */

/* Sizes for which nothing that is added up here overflows, or loses more than LOST. */
#define ENG_SIZE_LEAST 0x1p-100
#define ENG_SIZE_MOST  0x1p62
#define ENG_LOST       0x1p-900
#define ENG_SQUARE_MIN 0x1p-850

/* Return the square of d, and added to it what rounding could have lost of it and of what
 * is compared with it. */
ENG_INLINE double eng_square_most(double d)
{
    return d * d * (1 + 32 * ENG_U) + ENG_LOST;
}

/* Return the error of the dot product of two differences of these sizes. */
ENG_INLINE eng_d eng_dot_error(eng_d size_a, eng_d size_b)
{
    return 18.5 * ENG_U * size_a * size_b + ENG_LOST;
}

/* A cross product of two differences; each coordinate is off by `error` at most. */
struct eng_cross_product {
    struct eng_v v;
    eng_d size;
    eng_d error;
};

ENG_INLINE struct eng_cross_product eng_cross_product_of(struct eng_v a, eng_d size_a,
                                                         struct eng_v b, eng_d size_b)
{
    struct eng_cross_product out;
    out.v = eng_v_cross(a, b);
    out.size = eng_v_size(out.v);
    out.error = 8.5 * ENG_U * size_a * size_b + ENG_LOST;
    return out;
}

/* Return the error of the dot product of two cross products. */
ENG_INLINE eng_d eng_cross_product_error(const struct eng_cross_product *a,
                                         const struct eng_cross_product *b)
{
    return 3.1 * (a->size * b->error + b->size * a->error + a->error * b->error) +
           9.5 * ENG_U * a->size * b->size + ENG_LOST;
}

/* Return the error of the dot product of a difference and a cross product. */
ENG_INLINE eng_d eng_height_error(eng_d size, const struct eng_cross_product *n)
{
    return 3.1 * size * (n->error + 4.5 * ENG_U * n->size) + ENG_LOST;
}

/* Return whether differences whose largest has this size lose nothing that matters. */
ENG_INLINE eng_dm eng_is_in_range(eng_d size)
{
    return eng_dm_and(eng_d_at_most(eng_d_all(ENG_SIZE_LEAST), size),
                      eng_d_at_most(size, eng_d_all(ENG_SIZE_MOST)));
}

/* ---- where two features are nearest ---------------------------------------------- */

/* The places where two features are nearest, as far as they are known. At most one of the
 * masks `vertices`, `foot` and `inside` is set, and means that the distance certainly is
 * between those. What does not belong to it is any number.
 *
 * A point of the first feature and one of the second are chosen: the two vertices; the
 * vertex and the edge's nearer end; or what is nearest to the feet of the insides. */
struct eng_nearest_points {
    eng_dm vertices;
    eng_dm foot;
    eng_dm inside;
    struct eng_v w; /* from the second to the first of the points that are chosen */
    struct eng_v e; /* foot: the edge, in one direction or the other */
    struct eng_cross_product n; /* inside: across both features */
    eng_d nn;                   /* n . n */
    eng_d share[2];             /* inside: params times n . n */
    eng_d share_error[2];
    /* Else param[i] is 1 where `is_one` is set and 0 elsewhere; moved, where `moves` is
     * set, by how far along e the foot is. */
    eng_dm is_one[2];
    eng_dm moves[2];
    eng_d code; /* bits: type | points << 2, as struct eng_distance has them */
};

/* Return lanes with the bits of a small number; not to compute with. */
ENG_INLINE eng_d eng_bits(uint32_t value)
{
    return eng_d_of((eng_di){0} + (int64_t)value);
}

ENG_INLINE eng_d eng_bits_or(eng_d a, eng_d b)
{
    return eng_d_of(eng_di_of(a) | eng_di_of(b));
}

/* Set the code by the masks: `points` | type, or, inside, all points | `inside`. */
ENG_INLINE void eng_set_code(struct eng_nearest_points *at, eng_d points, uint32_t inside)
{
    eng_d type =
        eng_d_select(at->foot, eng_bits(ENG_NEAREST_VE), eng_bits(ENG_NEAREST_VV));
    at->code =
        eng_d_select(at->inside, eng_bits(inside | 15u << 2), eng_bits_or(points, type));
}

/* Return the error of (a x b) . n, whatever a and b are: `sizes` is the product of
 * theirs. */
ENG_INLINE eng_d eng_share_error(eng_d sizes, const struct eng_cross_product *n)
{
    return sizes * (7 * n->error + 52 * ENG_U * n->size) + ENG_LOST;
}

/* ---- a vertex and a face --------------------------------------------------------- */

#define ENG_NEXT(i) ((i) == 2 ? 0 : (i) + 1)

/* Differences of a vertex and a face. Corner i; side i is the edge from corner i to the
 * next. */
struct eng_face {
    struct eng_v to[3];   /* from the corner to the vertex */
    struct eng_v side[3]; /* from the corner to the next */
    eng_d size_side[3];
    eng_d size_each[3]; /* of to[i] */
    eng_d size_to;      /* the largest of them */
    /* How the vertex's feet lie: ahead of corner i on side i, back from corner i on the
     * side before. */
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

ENG_INLINE void eng_set_feet(struct eng_face *face)
{
    eng_d error[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        face->ahead[i] = eng_v_dot(face->to[i], face->side[i]);
        face->back[ENG_NEXT(i)] = -eng_v_dot(face->to[ENG_NEXT(i)], face->side[i]);
        error[i] = eng_dot_error(face->size_to, face->size_side[i]);
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        int before = ENG_NEXT(ENG_NEXT(i));
        face->is_between[i] =
            eng_d_less(error[i], eng_d_min(face->ahead[i], face->back[ENG_NEXT(i)]));
        face->is_behind[i] = eng_dm_and(eng_d_less(face->ahead[i], -error[i]),
                                        eng_d_less(face->back[i], -error[before]));
    }
}

/* Set what follows from which corner and which side it is. */
ENG_INLINE void eng_choose_corner(struct eng_nearest_points *at,
                                  const struct eng_face *face, const eng_dm corner[3],
                                  const eng_dm side[3])
{
    at->w = eng_v_select(corner[1], face->to[1], face->to[0]);
    at->w = eng_v_select(corner[2], face->to[2], at->w);
    at->e = eng_v_select(side[1], face->side[1], face->side[0]);
    at->e = eng_v_select(side[2], face->side[2], at->e);
    at->is_one[0] = corner[1];
    at->is_one[1] = corner[2];
    at->moves[0] = eng_dm_or(side[0], side[1]);
    at->moves[1] = eng_dm_or(side[1], side[2]);
    eng_d at_corner =
        eng_d_select(corner[1], eng_bits((1u | 4u) << 2), eng_bits((1u | 2u) << 2));
    at_corner = eng_d_select(corner[2], eng_bits((1u | 8u) << 2), at_corner);
    eng_d at_side =
        eng_d_select(side[1], eng_bits((1u | 12u) << 2), eng_bits((1u | 6u) << 2));
    at_side = eng_d_select(side[2], eng_bits((1u | 10u) << 2), at_side);
    eng_set_code(at, eng_d_select(at->foot, at_side, at_corner), ENG_NEAREST_VF);
}

ENG_INLINE struct eng_nearest_points eng_nearest_vf(const struct eng_v x[4])
{
    struct eng_nearest_points at;
    struct eng_face face;
    eng_dm fits = eng_set_face(x, &face);
    eng_set_feet(&face);
    at.n = eng_cross_product_of(face.side[2], face.size_side[2], face.side[0],
                                face.size_side[0]);
    at.nn = eng_v_dot(at.n.v, at.n.v);
    /* Of the corner that side i has not; together they are n . n. */
    eng_d share[3];
    eng_d error[3];
#pragma GCC unroll 2
    for (int i = 0; i < 3; i += 2) {
        share[i] = eng_v_dot(eng_v_cross(face.side[i], face.to[i]), at.n.v);
        error[i] = eng_share_error(face.size_each[i] * face.size_side[i], &at.n);
        at.share[i == 0] = share[i];
        at.share_error[i == 0] = error[i];
    }
    share[1] = at.nn - share[0] - share[2];
    error[1] = 2 * (error[0] + error[2] + eng_cross_product_error(&at.n, &at.n));
    eng_dm corner[3];
    eng_dm side[3];
    eng_dm is_next[3]; /* on side i the next corner is nearer */
    at.inside = fits;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        side[i] = eng_dm_and(eng_dm_and(fits, face.is_between[i]),
                             eng_d_less(share[i], -error[i]));
        at.inside = eng_dm_and(at.inside, eng_d_less(error[i], share[i]));
        is_next[i] =
            eng_dm_and(side[i], eng_d_less(face.back[ENG_NEXT(i)], face.ahead[i]));
    }
    at.foot = eng_dm_or(eng_dm_or(side[0], side[1]), side[2]);
    at.vertices =
        eng_dm_and(fits, eng_dm_or(eng_dm_or(face.is_behind[0], face.is_behind[1]),
                                   face.is_behind[2]));
    eng_dm most2 = eng_d_less(eng_d_max(share[1], share[2]), share[0]);
    eng_dm most1 = eng_d_less(eng_d_max(share[0], share[1]), share[2]);
#pragma GCC unroll 2
    for (int i = 1; i < 3; i++) {
        corner[i] = eng_dm_or(eng_dm_and(at.vertices, face.is_behind[i]),
                              eng_dm_and(at.inside, i == 1 ? most1 : most2));
        corner[i] = eng_dm_or(corner[i], is_next[i - 1]);
        corner[i] = eng_dm_or(corner[i], eng_dm_and(side[i], eng_dm_not(is_next[i])));
    }
    eng_choose_corner(&at, &face, corner, side);
    return at;
}

/* ---- two edges ------------------------------------------------------------------- */

/* Differences of two edges: ends 0 and 1 of the first, 2 and 3 of the second. */
struct eng_edges {
    struct eng_v edge[2];
    eng_d size_edge[2];
    struct eng_v between[2][2]; /* between[i][j]: from end 2 + j to end i */
    eng_d size_first;           /* of between[0][0] */
    eng_d size_most;            /* the largest */
    /* The foot of an end on the other edge: how far it is from each of its ends, times
     * the edge's length. */
    eng_d foot[4][2];
    /* How far each end is from the common perpendicular, times n . n. Those of two ends
     * of an edge together are n . n. */
    eng_d inward[4];
    eng_d inward_error[4];
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
        edges->between[i][j] = eng_v_sub(x[i], x[2 + j]);
        size = eng_d_max(size, eng_v_size(edges->between[i][j]));
        eng_d on_first = eng_v_dot(edges->between[i][j], edges->edge[0]);
        eng_d on_second = eng_v_dot(edges->between[i][j], edges->edge[1]);
        edges->foot[i][j] = j == 0 ? on_second : -on_second;
        edges->foot[2 + j][i] = i == 0 ? -on_first : on_first;
    }
    edges->size_first = eng_v_size(edges->between[0][0]);
    edges->size_most = size;
    size = eng_d_max(size, edges->size_edge[0]);
    return eng_is_in_range(eng_d_max(size, edges->size_edge[1]));
}

ENG_INLINE void eng_set_inward(struct eng_edges *edges, struct eng_nearest_points *at)
{
    eng_d nn_error = eng_cross_product_error(&at->n, &at->n);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        struct eng_v m = eng_v_cross(edges->edge[i == 0], edges->between[0][0]);
        at->share[i] = eng_v_dot(m, at->n.v);
        at->share_error[i] =
            eng_share_error(edges->size_first * edges->size_edge[i == 0], &at->n);
        edges->inward[2 * i] = at->share[i];
        edges->inward_error[2 * i] = at->share_error[i];
        edges->inward[2 * i + 1] = at->nn - at->share[i];
        edges->inward_error[2 * i + 1] = 2 * (at->share_error[i] + nn_error);
    }
}

/* Set the masks of vertices: of the ends i and 2 + j, at [i][j], and of any. */
ENG_INLINE void eng_set_ends(struct eng_nearest_points *at, const struct eng_edges *edges,
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
    at->vertices =
        eng_dm_or(eng_dm_or(ends[0][0], ends[0][1]), eng_dm_or(ends[1][0], ends[1][1]));
}

/* Set what follows from which ends and which edge it is. */
ENG_INLINE void eng_choose_ends(struct eng_nearest_points *at,
                                const struct eng_edges *edges)
{
    eng_dm first = at->is_one[0];
    eng_dm second = at->is_one[1];
    at->w = eng_v_select(
        first, eng_v_select(second, edges->between[1][1], edges->between[1][0]),
        eng_v_select(second, edges->between[0][1], edges->between[0][0]));
    at->e = eng_v_select(at->moves[1], edges->edge[1], edges->edge[0]);
    at->foot = eng_dm_or(at->moves[0], at->moves[1]);
    eng_d on_first = eng_d_select(first, eng_bits(2u << 2), eng_bits(1u << 2));
    on_first = eng_d_select(at->moves[0], eng_bits(3u << 2), on_first);
    eng_d on_second = eng_d_select(second, eng_bits(8u << 2), eng_bits(4u << 2));
    on_second = eng_d_select(at->moves[1], eng_bits(12u << 2), on_second);
    eng_set_code(at, eng_bits_or(on_first, on_second), ENG_NEAREST_EE);
}

ENG_INLINE struct eng_nearest_points eng_nearest_ee(const struct eng_v x[4])
{
    struct eng_nearest_points at;
    struct eng_edges edges;
    eng_dm fits = eng_set_edges(x, &edges);
    at.n = eng_cross_product_of(edges.edge[0], edges.size_edge[0], edges.edge[1],
                                edges.size_edge[1]);
    at.nn = eng_v_dot(at.n.v, at.n.v);
    eng_set_inward(&edges, &at);
    eng_d error[2] = {eng_dot_error(edges.size_most, edges.size_edge[0]),
                      eng_dot_error(edges.size_most, edges.size_edge[1])};
    eng_dm ends[2][2];
    eng_dm foot[4];    /* of that end */
    eng_dm is_next[4]; /* the other edge's second end is nearer to it */
    eng_set_ends(&at, &edges, fits, error, ends);
    at.inside = fits;
#pragma GCC unroll 4
    for (int end = 0; end < 4; end++) {
        const eng_d *feet = edges.foot[end];
        foot[end] = eng_dm_and(
            eng_dm_and(fits, eng_d_less(error[end < 2], eng_d_min(feet[0], feet[1]))),
            eng_d_less(edges.inward[end], -edges.inward_error[end]));
        is_next[end] = eng_dm_and(foot[end], eng_d_less(feet[1], feet[0]));
        at.inside =
            eng_dm_and(at.inside, eng_d_less(edges.inward_error[end], edges.inward[end]));
    }
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        int other = 2 - 2 * i; /* the other edge's first end */
        at.moves[i] = eng_dm_or(foot[other], foot[other + 1]);
        eng_dm one = eng_dm_or(ends[1][1], i == 0 ? ends[1][0] : ends[0][1]);
        one = eng_dm_or(one, foot[2 * i + 1]);
        one = eng_dm_or(one, eng_dm_or(is_next[other], is_next[other + 1]));
        eng_dm is_farther = eng_d_less(edges.inward[2 * i + 1], edges.inward[2 * i]);
        at.is_one[i] = eng_dm_or(one, eng_dm_and(at.inside, is_farther));
    }
    eng_choose_ends(&at, &edges);
    return at;
}

/* ---- how far apart they are ------------------------------------------------------ */

/* A length, and what params and directions are computed with. */
struct eng_length {
    eng_d low, high; /* it is certainly between these */
    eng_d value, error;
    eng_d size_w, size_e;
    eng_d inverse;    /* 1 / e.e, 1 / n.n */
    eng_d per;        /* 1 / |e|, 1 / |n| */
    eng_d signed_per; /* by the side on which the first feature is */
    eng_d nn_error;
};

/* Return the length; clear the masks in the lanes that squares or margins forbid. */
ENG_INLINE struct eng_length eng_length_of(struct eng_nearest_points *at)
{
    const eng_d least = eng_d_all(ENG_SQUARE_MIN);
    const struct eng_cross_product *n = &at->n;
    struct eng_length length;
    length.size_w = eng_v_size(at->w);
    length.size_e = eng_v_size(at->e);
    struct eng_cross_product m =
        eng_cross_product_of(at->e, length.size_e, at->w, length.size_w);
    eng_d square = eng_d_select(at->foot, eng_v_dot(m.v, m.v), eng_v_dot(at->w, at->w));
    eng_d below = eng_d_select(at->foot, eng_v_dot(at->e, at->e), at->nn);
    eng_d height = eng_v_dot(at->w, n->v);
    eng_d height_error = eng_height_error(length.size_w, n);
    eng_dm is_large = eng_d_less(least, square);
    eng_dm is_long = eng_d_less(least, below);
    at->vertices = eng_dm_and(at->vertices, is_large);
    at->foot = eng_dm_and(at->foot, eng_dm_and(is_large, is_long));
    at->inside = eng_dm_and(eng_dm_and(at->inside, is_long),
                            eng_dm_and(eng_d_at_most(n->error, 0x1p-30 * n->size),
                                       eng_d_less(height_error, eng_d_abs(height))));
    length.nn_error = eng_cross_product_error(n, n);
    length.inverse = 1 / below;
    length.per = eng_d_sqrt(below) * length.inverse;
    length.signed_per =
        eng_d_select(eng_d_less(height, eng_d_all(0)), -length.per, length.per);
    eng_d root = eng_d_sqrt(square);
    length.value = eng_d_select(at->inside, eng_d_abs(height), root);
    length.value = eng_d_select(at->vertices, root, length.value * length.per);
    eng_d off = eng_d_select(at->foot, 1.8 * m.error,
                             1.1 * (height_error + 1.8 * length.value * n->error));
    length.error = 12 * ENG_U * length.value;
    length.error =
        eng_d_select(at->vertices, length.error, length.error + off * length.per);
    /* Twice the error: what is subtracted and added is rounded, too. */
    length.low = length.value - 2 * length.error;
    length.high = length.value + 2 * length.error;
    return length;
}

/* Return the lanes of which the length is known. */
ENG_INLINE eng_dm eng_is_known(const struct eng_nearest_points *at)
{
    return eng_dm_or(eng_dm_or(at->vertices, at->foot), at->inside);
}

/* ---- rounded numbers ------------------------------------------------------------- */

/* Doubles of 33 bits: the last 20 of 53 are cut off. */
#define ENG_BITS_CUT ((INT64_C(1) << 20) - 1)

/* struct eng_distance, in lanes. */
struct eng_distance_lanes {
    eng_d lo, hi;
    eng_d param[2];
    struct eng_v direction;
    eng_d code;
};

/* Return a positive normal double without its last bits, more by `add` times the last one
 * that is left. */
ENG_INLINE eng_d eng_cut(eng_d x, int64_t add)
{
    return eng_d_of((eng_di_of(x) & ~ENG_BITS_CUT) + add * (ENG_BITS_CUT + 1));
}

/* Return the nearest multiple of 2^-32 to x. Take from *sure the lanes where it is not
 * that of all that is within twice an error of x. `room` is half of 2^-32 less that. What
 * is 0 has no sign, as it is a difference of equal numbers. */
ENG_INLINE eng_d eng_fixed(eng_d x, eng_d room, eng_dm *sure)
{
    eng_d nearest = (x + 0x1.8p20) - 0x1.8p20;
    *sure = eng_dm_and(*sure, eng_d_less(eng_d_abs(x - nearest), room));
    return nearest;
}

ENG_INLINE eng_d eng_fixed_room(eng_d error)
{
    return 0x1p-33 - 2 * error;
}

/* Set lo and hi. Here and below, the lanes of which a number might be rounded either way
 * go from *sure. */
ENG_INLINE void eng_round_length(const struct eng_length *length,
                                 struct eng_distance_lanes *out, eng_dm *sure)
{
    out->lo = eng_cut(length->low, 0);
    out->hi = eng_cut(length->low, 1);
    *sure = eng_dm_and(*sure, eng_d_less(eng_d_all(ENG_LOST), length->low));
    *sure = eng_dm_and(*sure, eng_dm_and(eng_d_less(out->lo, length->low),
                                         eng_d_less(length->high, out->hi)));
}

/* Set params. Return what is subtracted from w, in units of e, to have the direction. */
ENG_INLINE eng_d eng_round_params(const struct eng_nearest_points *at,
                                  const struct eng_length *length, eng_d foot_error,
                                  struct eng_distance_lanes *out, eng_dm *sure)
{
    const eng_d zero = {0};
    eng_d along = eng_v_dot(at->w, at->e) * length->inverse;
    eng_d foot = eng_d_abs(along);
#pragma GCC unroll 2
    for (int i = 0; i < 2; i++) {
        eng_d share = at->share[i] * length->inverse;
        eng_d error =
            1.1 * (at->share_error[i] + share * length->nn_error) * length->inverse +
            4 * ENG_U * share;
        eng_d moved = eng_d_select(at->moves[i], foot, zero);
        eng_d value = eng_d_select(at->is_one[i], 1 - moved, moved);
        error =
            eng_d_select(at->inside, error, eng_d_select(at->moves[i], foot_error, zero));
        out->param[i] = eng_fixed(eng_d_select(at->inside, share, value),
                                  eng_fixed_room(error), sure);
    }
    return along;
}

/* Set params, direction and what it is between. */
ENG_INLINE void eng_round_rest(const struct eng_nearest_points *at,
                               const struct eng_length *length,
                               struct eng_distance_lanes *out, eng_dm *sure)
{
    const eng_d zero = {0};
    /* Of how far along e the foot is, at most 1; the last part is for 1 less that. */
    eng_d foot_error =
        eng_dot_error(length->size_w, length->size_e) * length->inverse + 14 * ENG_U;
    eng_d along = eng_round_params(at, length, foot_error, out, sure);
    eng_d per_length = 1 / length->value;
    eng_d scale = eng_d_select(at->inside, length->signed_per, per_length);
    struct eng_v back = eng_v_scale(eng_d_select(at->foot, along, zero), at->e);
    struct eng_v g = eng_v_select(at->inside, at->n.v, eng_v_sub(at->w, back));
    eng_d turned = 1.1 *
                   (4 * ENG_U * length->size_w +
                    (foot_error + 6 * ENG_U) * length->size_e + length->error) *
                   per_length;
    eng_d error = eng_d_select(at->foot, turned, zero);
    error = eng_d_select(at->inside, 3 * at->n.error * length->per, error);
    eng_d room = eng_fixed_room(error + 8 * ENG_U);
    out->direction = (struct eng_v){eng_fixed(g.x * scale, room, sure),
                                    eng_fixed(g.y * scale, room, sure),
                                    eng_fixed(g.z * scale, room, sure)};
    out->code = at->code;
}

/* ---- about where they are nearest ------------------------------------------------ */

/* The gap between the nearest points, with no bound of its error: it proposes directions
 * and describes contacts. advance.c asks it of many pairs, elementary/motion.c of one. */

/* The difference vectors of query.h at one moment. */
struct eng_pose_lanes {
    struct eng_v p, b, c;
};

struct eng_nearest_gap {
    eng_d beta, gamma; /* in the domain of the kind */
    struct eng_v gap;  /* p - beta b - gamma c */
};

/* Limits of the square of the sine between b and c: below the one, what rounding leaves
 * of their cross product may point anywhere; below the other, nobody asks. */
#define ENG_SURE_SINE2 0x1p-60
#define ENG_SINE2      0x1p-100

/* Find the foot of p on the plane of b and c. Return the lanes in which it falls into the
 * domain; *is_sure: those of them in which there is no nearer place. */
ENG_INLINE eng_dm eng_nearest_gap_inside(enum pccd_kind form,
                                         const struct eng_pose_lanes *pose,
                                         struct eng_nearest_gap *nearest, eng_dm *is_sure)
{
    const eng_d zero = {0};
    struct eng_v n = eng_v_cross(pose->b, pose->c);
    eng_d nn = eng_v_dot(n, n);
    eng_d size = eng_v_dot(pose->b, pose->b) * eng_v_dot(pose->c, pose->c);
    nearest->beta = eng_v_dot(eng_v_cross(pose->p, pose->c), n) / nn;
    nearest->gamma = eng_v_dot(eng_v_cross(pose->b, pose->p), n) / nn;
    eng_d most = eng_d_max(nearest->beta, nearest->gamma);
    if (form == PCCD_VF) {
        most = nearest->beta + nearest->gamma;
    }
    eng_dm inside = eng_dm_and(eng_d_less(ENG_SINE2 * size, nn),
                               eng_dm_and(eng_d_at_most(zero, nearest->beta),
                                          eng_d_at_most(zero, nearest->gamma)));
    inside = eng_dm_and(inside, eng_d_at_most(most, zero + 1));
    *is_sure = eng_dm_and(inside, eng_d_less(ENG_SURE_SINE2 * size, nn));
    nearest->gap = eng_v_sub(eng_v_sub(pose->p, eng_v_scale(nearest->beta, pose->b)),
                             eng_v_scale(nearest->gamma, pose->c));
    return inside;
}

/* A side of the domain: start + s along, 0 <= s <= 1; from where, and which params move,
 * by s or by -s. */
struct eng_domain_side {
    struct eng_v start, along;
    double from[2];
    double moves[2];
};

ENG_INLINE void eng_try_side(const struct eng_domain_side *side, eng_d *best,
                             struct eng_nearest_gap *nearest)
{
    const eng_d zero = {0};
    eng_d aa = eng_v_dot(side->along, side->along);
    eng_d s = eng_v_dot(side->start, side->along) / aa;
    s = eng_d_select(eng_dm_and(eng_d_less(zero, aa), eng_d_less(zero, s)), s, zero);
    s = eng_d_min(s, zero + 1);
    struct eng_v gap = eng_v_sub(side->start, eng_v_scale(s, side->along));
    eng_d square = eng_v_dot(gap, gap);
    eng_dm is_better = eng_d_less(square, *best);
    *best = eng_d_select(is_better, square, *best);
    nearest->beta =
        eng_d_select(is_better, side->from[0] + s * side->moves[0], nearest->beta);
    nearest->gamma =
        eng_d_select(is_better, side->from[1] + s * side->moves[1], nearest->gamma);
    nearest->gap = eng_v_select(is_better, gap, nearest->gap);
}

/* Estimate where the features are nearest. The result of a lane does not depend on the
 * others. */
ENG_INLINE struct eng_nearest_gap eng_nearest_gap_of(enum pccd_kind form,
                                                     const struct eng_pose_lanes *pose)
{
    const eng_d zero = {0};
    struct eng_nearest_gap nearest;
    eng_dm is_sure;
    eng_dm inside = eng_nearest_gap_inside(form, pose, &nearest, &is_sure);
    if (eng_dm_bits(is_sure) == ENG_D_ALL) {
        return nearest;
    }
    struct eng_v next = eng_v_sub(pose->p, pose->b);
    struct eng_domain_side last =
        form == PCCD_VF
            ? (struct eng_domain_side){next, eng_v_sub(pose->c, pose->b), {1, 0}, {-1, 1}}
            : (struct eng_domain_side){next, pose->c, {1, 0}, {0, 1}};
    eng_d best =
        eng_d_select(inside, eng_v_dot(nearest.gap, nearest.gap), zero + __builtin_inf());
    best = eng_d_select(is_sure, zero - 1, best);
    eng_try_side(&(struct eng_domain_side){pose->p, pose->b, {0, 0}, {1, 0}}, &best,
                 &nearest);
    eng_try_side(&(struct eng_domain_side){pose->p, pose->c, {0, 0}, {0, 1}}, &best,
                 &nearest);
    eng_try_side(&last, &best, &nearest);
    if (form == PCCD_EE) {
        eng_try_side(
            &(struct eng_domain_side){
                eng_v_sub(pose->p, pose->c), pose->b, {0, 1}, {1, 0}},
            &best, &nearest);
    }
    return nearest;
}

/* ---- an edge and a face ------------------------------------------------------------ */

/* The certain part of a sign, or of a decision: one of the two, or neither. */
struct eng_sure {
    eng_dm yes, no; /* plus, minus */
};

/* Return the sign of e . (a x b), all three differences. */
ENG_INLINE struct eng_sure eng_side_of(struct eng_v e, struct eng_v a, struct eng_v b)
{
    struct eng_cross_product cross =
        eng_cross_product_of(a, eng_v_size(a), b, eng_v_size(b));
    eng_d value = eng_v_dot(e, cross.v);
    eng_d error = eng_height_error(eng_v_size(e), &cross);
    return (struct eng_sure){eng_d_less(error, value), eng_d_less(value, -error)};
}

/* Return whether both are sure, and differ; or both are sure, and alike. */
ENG_INLINE eng_dm eng_signs_differ(struct eng_sure a, struct eng_sure b)
{
    return eng_dm_or(eng_dm_and(a.yes, b.no), eng_dm_and(a.no, b.yes));
}

ENG_INLINE eng_dm eng_signs_agree(struct eng_sure a, struct eng_sure b)
{
    return eng_dm_or(eng_dm_and(a.yes, b.yes), eng_dm_and(a.no, b.no));
}

/* Decide whether the edge x[0], x[1] passes through the face. It does not where both its
 * ends are on one side of the plane, or its line passes a side. */
ENG_INLINE struct eng_sure eng_crossing_of(const struct eng_v x[5])
{
    struct eng_v edge = eng_v_sub(x[1], x[0]);
    struct eng_v from[3];
    struct eng_sure turn[3];
    eng_d size = eng_v_size(edge);
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        from[i] = eng_v_sub(x[2 + i], x[0]);
        size = eng_d_max(size, eng_v_size(from[i]));
    }
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        turn[i] = eng_side_of(edge, from[i], from[ENG_NEXT(i)]);
    }
    struct eng_v u = eng_v_sub(x[3], x[2]);
    struct eng_v v = eng_v_sub(x[4], x[2]);
    struct eng_sure first = eng_side_of(eng_v_sub(x[0], x[2]), u, v);
    struct eng_sure second = eng_side_of(eng_v_sub(x[1], x[2]), u, v);
    eng_dm past = eng_dm_or(
        eng_dm_or(eng_signs_differ(turn[0], turn[1]), eng_signs_differ(turn[1], turn[2])),
        eng_signs_differ(turn[2], turn[0]));
    eng_dm through =
        eng_dm_and(eng_signs_agree(turn[0], turn[1]), eng_signs_agree(turn[1], turn[2]));
    eng_dm fits = eng_is_in_range(size);
    return (struct eng_sure){
        eng_dm_and(fits, eng_dm_and(through, eng_signs_differ(first, second))),
        eng_dm_and(fits, eng_dm_or(past, eng_signs_agree(first, second)))};
}

#endif
