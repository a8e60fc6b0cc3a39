/* place_face.h - between which of their points a vertex and a face are nearest, a pair to
 * each lane, where doubles are sure.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Distances in lanes".
 */
#ifndef ENG_PLACE_FACE_H
#define ENG_PLACE_FACE_H

#include "place.h"

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

#endif
