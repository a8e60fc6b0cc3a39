/* spot.h - where two features are relative to each other at one time, several pairs at
 * once.
 *
 * Load the motion of pairs. For a short span of time, say whether the point in which a
 * feature crosses the other's plane is certainly inside or certainly outside the
 * features, and describe it.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: every constant times u is derived in BOUNDS.md.
 */
#ifndef ENG_SPOT_H
#define ENG_SPOT_H

#include "points.h"

/* Three difference vectors. VF: vertex - corner k; EE: p, b, c. */
struct eng_motion_lanes {
    struct eng_v v[2][3];
    eng_d size[3]; /* largest coordinate at both ends */
};

/* x[point][end], points as in struct eng_query. */
ENG_INLINE struct eng_motion_lanes eng_motion_of(enum pccd_kind kind,
                                                 struct eng_v x[4][2])
{
    struct eng_motion_lanes motion;
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_v *v = motion.v[end];
        if (kind == PCCD_VF) {
            v[0] = eng_v_sub(x[0][end], x[1][end]);
            v[1] = eng_v_sub(x[0][end], x[2][end]);
            v[2] = eng_v_sub(x[0][end], x[3][end]);
        } else {
            v[0] = eng_v_sub(x[2][end], x[0][end]);
            v[1] = eng_v_sub(x[1][end], x[0][end]);
            v[2] = eng_v_sub(x[2][end], x[3][end]);
        }
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        motion.size[k] = eng_v_reach(motion.v[0][k], motion.v[1][k]);
    }
    return motion;
}

ENG_INLINE struct eng_motion_lanes eng_motion_load(enum pccd_kind kind,
                                                   const struct eng_group *group)
{
    struct eng_v x[4][2];
    eng_group_load(group, x);
    return eng_motion_of(kind, x);
}

/* Where the features are in a bracket. */
struct eng_spot {
    eng_dm inside;  /* certainly in the domain at every time of it, b and c independent */
    eng_dm outside; /* certainly no contact at any time of it */
    struct eng_v n; /* b x c in its middle */
    eng_d nn;       /* its square, up to rounding */
    eng_d param[2]; /* as in struct pccd_contact, times nn */
};

/* `e` is the error of a product of four coordinates, `e_flat` that of one of two, by
 * their sizes. `closely`: look at n itself too, which is near zero where edges are nearly
 * parallel and faces nearly a line. */

/* VF: the weights of the corners, (d_j x d_k) . n; none of d_j x d_k is longer than n. */
ENG_INLINE struct eng_spot eng_spot_vf(const struct eng_v v[3], const eng_d size[3],
                                       eng_d e, eng_d e_flat, bool closely)
{
    struct eng_spot spot;
    struct eng_v m0 = eng_v_cross(v[1], v[2]);
    struct eng_v m1 = eng_v_cross(v[2], v[0]);
    struct eng_v m2 = eng_v_cross(v[0], v[1]);
    spot.n = eng_v_add(eng_v_add(m0, m1), m2);
    eng_d w0 = eng_v_dot(m0, spot.n);
    eng_d w1 = eng_v_dot(m1, spot.n);
    eng_d w2 = eng_v_dot(m2, spot.n);
    eng_d s0 = size[1] * size[2];
    eng_d s1 = size[2] * size[0];
    eng_d s2 = size[0] * size[1];
    eng_d s = s0 + s1 + s2;
    e *= s;
    eng_d e0 = e * s0;
    eng_d e1 = e * s1;
    eng_d e2 = e * s2;
    spot.inside = eng_dm_and(eng_dm_and(eng_d_less(e0, w0), eng_d_less(e1, w1)),
                             eng_d_less(e2, w2));
    spot.outside = eng_dm_or(eng_dm_or(eng_d_less(w0, -e0), eng_d_less(w1, -e1)),
                             eng_d_less(w2, -e2));
    if (closely) {
        eng_d longest = eng_d_max_abs(eng_v_reach(m0, m1), eng_v_reach(m2, m2));
        eng_d n = eng_v_reach(spot.n, spot.n);
        spot.outside = eng_dm_or(spot.outside, eng_d_less(n + 2 * e_flat * s, longest));
    }
    spot.nn = w0 + w1 + w2;
    spot.param[0] = w1;
    spot.param[1] = w2;
    return spot;
}

/* EE: (p x c) . n and (b x p) . n against n . n, and neither longer than n. */
ENG_INLINE struct eng_spot eng_spot_ee(const struct eng_v v[3], const eng_d size[3],
                                       eng_d e, eng_d e_flat, bool closely)
{
    struct eng_spot spot;
    spot.n = eng_v_cross(v[1], v[2]);
    struct eng_v m_beta = eng_v_cross(v[0], v[2]);
    struct eng_v m_gamma = eng_v_cross(v[1], v[0]);
    eng_d nn = eng_v_dot(spot.n, spot.n);
    eng_d beta = eng_v_dot(m_beta, spot.n);
    eng_d gamma = eng_v_dot(m_gamma, spot.n);
    eng_d s = size[1] * size[2];
    eng_d s_beta = size[0] * size[2];
    eng_d s_gamma = size[0] * size[1];
    e *= s;
    eng_d e_nn = e * s;
    eng_d e_beta = e * s_beta;
    eng_d e_gamma = e * s_gamma;
    eng_d rest_beta = nn - beta;
    eng_d rest_gamma = nn - gamma;
    eng_d e_rest_beta = e_nn + e_beta;
    eng_d e_rest_gamma = e_nn + e_gamma;
    spot.inside = eng_dm_and(
        eng_dm_and(eng_d_less(e_beta, beta), eng_d_less(e_rest_beta, rest_beta)),
        eng_dm_and(eng_d_less(e_gamma, gamma), eng_d_less(e_rest_gamma, rest_gamma)));
    spot.outside = eng_dm_or(
        eng_dm_or(eng_d_less(beta, -e_beta), eng_d_less(rest_beta, -e_rest_beta)),
        eng_dm_or(eng_d_less(gamma, -e_gamma), eng_d_less(rest_gamma, -e_rest_gamma)));
    if (closely) {
        eng_d longest = eng_v_reach(m_beta, m_gamma);
        eng_d n = eng_v_reach(spot.n, spot.n);
        eng_d e_long = e_flat * (s + (s_beta + s_gamma));
        spot.outside = eng_dm_or(spot.outside, eng_d_less(n + e_long, longest));
    }
    spot.nn = nn;
    spot.param[0] = beta;
    spot.param[1] = gamma;
    return spot;
}

/* In the bracket [x, y], which is short. */
ENG_INLINE struct eng_spot eng_spot_of(enum pccd_kind kind,
                                       const struct eng_motion_lanes *motion, eng_d x,
                                       eng_d y, bool closely)
{
    struct eng_v v[3];
    eng_d t = 0.5 * (x + y);
    eng_d s = 1 - t;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        v[k] = eng_v_mix(s, motion->v[0][k], t, motion->v[1][k]);
    }
    eng_d e = 52 * (y - x) + 424 * ENG_U;
    eng_d e_flat = 5 * (y - x) + 40 * ENG_U;
    return kind == PCCD_VF ? eng_spot_vf(v, motion->size, e, e_flat, closely)
                           : eng_spot_ee(v, motion->size, e, e_flat, closely);
}

#endif
