/* bracket.h - the certified solver: the cubic, its roots, and whether the features meet
 * there. bracket.c asks it of many pairs, decide.c of one.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: every constant times u is derived in BOUNDS.md.
 */
#ifndef ENG_BRACKET_H
#define ENG_BRACKET_H

#include "lanes.h"
#include "points.h"
#include "query.h"

/* ---- the cubic ------------------------------------------------------------------- */

/* The cubic whose roots are the possible times of contact, for several pairs at
 * once, one in each vector lane.
 *
 * The blossom b(r, s, t) of a cubic is linear in each of its three times, and b(t, t, t)
 * is its value. b(l, l, l), b(l, l, r), b(l, r, r), b(r, r, r) are the coefficients over
 * [l, r]: if all of them are on one side, so is the cubic. */

struct eng_cubic {
    eng_d f[4];
    eng_d error; /* |computed - true| of each blossom with times in [0, 1] */
};

/* Return s a + t b: with s = 1 - t, what lies between a and b at t. */
ENG_INLINE eng_d eng_d_mix(eng_d s, eng_d a, eng_d t, eng_d b)
{
    return s * a + t * b;
}

/* Return the largest magnitude of the coefficients. */
ENG_INLINE eng_d eng_cubic_high(const struct eng_cubic *cubic)
{
    const eng_d *f = cubic->f;
    return eng_d_max(eng_d_max_abs(f[0], f[1]), eng_d_max_abs(f[2], f[3]));
}

/* Return the cubic det[v[0], v[1], v[2]] of vectors that go from v[0][k] to v[1][k];
 * `size`: the product of their largest coordinates. */
ENG_INLINE struct eng_cubic eng_cubic_of(struct eng_v v[2][3], eng_d size)
{
    const struct eng_v *p = v[0];
    const struct eng_v *q = v[1];
    struct eng_v n00 = eng_v_cross(p[1], p[2]);
    struct eng_v n11 = eng_v_cross(q[1], q[2]);
    struct eng_v mixed = eng_v_add(eng_v_cross(p[1], q[2]), eng_v_cross(q[1], p[2]));
    struct eng_cubic cubic;
    cubic.f[0] = eng_v_dot(p[0], n00);
    cubic.f[1] = (eng_v_dot(q[0], n00) + eng_v_dot(p[0], mixed)) * (1.0 / 3);
    cubic.f[2] = (eng_v_dot(p[0], n11) + eng_v_dot(q[0], mixed)) * (1.0 / 3);
    cubic.f[3] = eng_v_dot(q[0], n11);
    cubic.error = 64 * ENG_U * size + 12 * ENG_U * eng_cubic_high(&cubic);
    return cubic;
}

/* Return a x b with every sum one of magnitudes, of vectors that have no negative
 * coordinate. */
ENG_INLINE struct eng_v eng_v_cross_size(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z,
                          a.x * b.y + a.y * b.x};
}

/* Lower the bound on the error, if the magnitudes of the products that are summed up give
 * a smaller one: for vectors that differ in size from axis to axis. It takes as long as
 * the cubic itself. */
ENG_INLINE void eng_cubic_tighten(struct eng_cubic *cubic, struct eng_v v[2][3])
{
    struct eng_v p[3];
    struct eng_v q[3];
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        p[k] = eng_v_abs(v[0][k]);
        q[k] = eng_v_abs(v[1][k]);
    }
    struct eng_v n00 = eng_v_cross_size(p[1], p[2]);
    struct eng_v n11 = eng_v_cross_size(q[1], q[2]);
    struct eng_v mixed =
        eng_v_add(eng_v_cross_size(p[1], q[2]), eng_v_cross_size(q[1], p[2]));
    eng_d ends = eng_d_max(eng_v_dot(p[0], n00), eng_v_dot(q[0], n11));
    eng_d middle = eng_d_max(eng_v_dot(q[0], n00) + eng_v_dot(p[0], mixed),
                             eng_v_dot(p[0], n11) + eng_v_dot(q[0], mixed));
    eng_d sum = eng_d_max(ends, middle * (1.0 / 3));
    eng_d error =
        11 * ENG_U * sum + 12 * ENG_U * eng_cubic_high(cubic) + eng_d_all(ENG_TINY);
    cubic->error = eng_d_min(cubic->error, error);
}

/* Change the sign of the cubic where `m` is set. */
ENG_INLINE void eng_cubic_turn(struct eng_cubic *cubic, eng_dm m)
{
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        cubic->f[i] = eng_d_select(m, -cubic->f[i], cubic->f[i]);
    }
}

/* The part that all blossoms with a time t have in common: b(t, t, t) and, linear in the
 * other times, b(t, t, .) at 0 and 1 and b(t, ., .) as a quadratic. */
struct eng_cubic_at {
    eng_d value;
    eng_d line[2];
    eng_d quad[3];
};

ENG_INLINE struct eng_cubic_at eng_cubic_at(const struct eng_cubic *cubic, eng_d t)
{
    eng_d s = 1 - t;
    struct eng_cubic_at at;
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        at.quad[i] = eng_d_mix(s, cubic->f[i], t, cubic->f[i + 1]);
    }
    at.line[0] = eng_d_mix(s, at.quad[0], t, at.quad[1]);
    at.line[1] = eng_d_mix(s, at.quad[1], t, at.quad[2]);
    at.value = eng_d_mix(s, at.line[0], t, at.line[1]);
    return at;
}

/* Set `middle` to b(t, t, r) and b(t, r, r). */
ENG_INLINE void eng_cubic_between(const struct eng_cubic_at *at, eng_d r, eng_d middle[2])
{
    eng_d s = 1 - r;
    eng_d q0 = eng_d_mix(s, at->quad[0], r, at->quad[1]);
    eng_d q1 = eng_d_mix(s, at->quad[1], r, at->quad[2]);
    middle[0] = eng_d_mix(s, at->line[0], r, at->line[1]);
    middle[1] = eng_d_mix(s, q0, r, q1);
}

/* Find where the cubic has its minimum and its maximum, if it has them; else its
 * inflection twice. Approximate. */
ENG_INLINE void eng_cubic_turns(const struct eng_cubic *cubic, eng_d *low, eng_d *high)
{
    const eng_d zero = {0};
    /* A third of the slope: c + 2 b t + a t t; it rises at the one root, falls at the
     * other. */
    eng_d c = cubic->f[1] - cubic->f[0];
    eng_d d = cubic->f[2] - cubic->f[1];
    eng_d e = cubic->f[3] - cubic->f[2];
    eng_d b = d - c;
    eng_d a = (c - d) + (e - d);
    eng_d square = d * d - c * e;
    eng_d w = eng_d_abs(b) + eng_d_sqrt(eng_d_max(square, zero));
    eng_d far = w / a;
    eng_d near = eng_d_select(eng_d_less(square, zero), far, c / w);
    eng_dm is_left = eng_d_less(zero, b);
    *low = eng_d_select(is_left, -near, far);
    *high = eng_d_select(is_left, -far, near);
}

/* The cubic by powers of t, its coefficients at that: f0 + t (c1 + t (c2 + t c3)). */
struct eng_cubic_powers {
    eng_d c[4];
};

ENG_INLINE struct eng_cubic_powers eng_cubic_powers(const struct eng_cubic *cubic)
{
    const eng_d *f = cubic->f;
    eng_d d = f[2] - f[1];
    eng_d c = f[1] - f[0];
    return (struct eng_cubic_powers){{f[0], 3 * c, 3 * (d - c), (f[3] - f[0]) - 3 * d}};
}

/* The values that Halley's method asks for at a time. Approximate. */
struct eng_cubic_step {
    eng_d value;
    eng_d slope;
    eng_d step; /* from the time to nearer the root */
};

ENG_INLINE struct eng_cubic_step eng_cubic_halley(const struct eng_cubic_powers *powers,
                                                  eng_d t)
{
    const eng_d *c = powers->c;
    struct eng_cubic_step step;
    eng_d bend = c[2] + t * (3 * c[3]); /* half the second derivative */
    step.value = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    step.slope = c[1] + t * (c[2] + bend);
    step.step = step.value * step.slope / (step.value * bend - step.slope * step.slope);
    return step;
}

/* Return a root in (0, 1) of a cubic with ends of opposite sign, to some digits: that of
 * the parabola through both ends that is nearest to it. */
ENG_INLINE eng_d eng_cubic_guess(const struct eng_cubic *cubic)
{
    const eng_d zero = {0};
    const eng_d *f = cubic->f;
    eng_d middle = 0.75 * (f[1] + f[2]) - 0.25 * (f[0] + f[3]);
    eng_d b = middle - f[0];
    eng_d a = (f[3] - middle) - b;
    return f[0] / (eng_d_sqrt(eng_d_max(b * b - a * f[0], zero)) - b);
}

/* ---- where two features are relative to each other ------------------------------- */

/* Where two features are relative to each other at one time, several pairs at
 * once.
 *
 * Load the motion of pairs. For a short span of time, say whether the point in which a
 * feature crosses the other's plane is certainly inside or certainly outside the
 * features, and describe it. */

/* Three difference vectors. VF: vertex - corner k; EE: p, b, c. */
struct eng_motion_lanes {
    struct eng_v v[2][3];
    eng_d size[3]; /* largest coordinate at both ends */
};

/* Set the sizes to those of the vectors. */
ENG_INLINE void set_sizes(struct eng_motion_lanes *motion)
{
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        motion->size[k] = eng_v_size_of_two(motion->v[0][k], motion->v[1][k]);
    }
}

/* Return a point of a pair: vector k is the first less the second, `which` 0 and 1. */
ENG_INLINE int point_of(enum pccd_kind kind, int k, int which)
{
    static const int vf[3][2] = {{0, 1}, {0, 2}, {0, 3}};
    static const int ee[3][2] = {{2, 0}, {1, 0}, {2, 3}};
    return kind == PCCD_VF ? vf[k][which] : ee[k][which];
}

/* Set vectors and sizes of *motion from x[point][end], points as in struct eng_query. */
ENG_INLINE void eng_motion_of(enum pccd_kind kind, struct eng_v x[4][2],
                              struct eng_motion_lanes *motion)
{
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
#pragma GCC unroll 3
        for (int k = 0; k < 3; k++) {
            motion->v[end][k] =
                eng_v_sub(x[point_of(kind, k, 0)][end], x[point_of(kind, k, 1)][end]);
        }
    }
    set_sizes(motion);
}

ENG_INLINE void eng_motion_load(enum pccd_kind kind, const struct eng_group *group,
                                struct eng_motion_lanes *motion)
{
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        struct eng_difference d[ENG_D_LANES];
        struct eng_v v[2];
#pragma GCC unroll 8
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            const uint32_t *quad = group->quad[lane];
            d[lane] = eng_points_less(&group->points[quad[point_of(kind, k, 0)]],
                                      &group->points[quad[point_of(kind, k, 1)]]);
        }
        eng_differences_turn(d, v);
        motion->v[0][k] = v[0];
        motion->v[1][k] = v[1];
    }
    set_sizes(motion);
}

/* The test of the domain in a bracket: do the parameters of the contact lie within both
 * features? b, c: two of their edges, see query.h. */
struct eng_domain_test {
    eng_dm inside;  /* certainly in the domain at every time of it, b and c independent */
    eng_dm outside; /* certainly no contact at any time of it */
    struct eng_v n; /* b x c in its middle */
    eng_d nn;       /* its square, up to rounding */
    eng_d param[2]; /* as in struct pccd_contact, times nn */
};

/* `e` is the error of a product of four coordinates, `e_flat` that of one of two, by
 * their sizes. `closely`: look at n itself too, which is near zero where edges are nearly
 * parallel and faces nearly a line. */

/* Test VF by the weights of the corners, (d_j x d_k) . n; none of d_j x d_k is longer
 * than n. */
ENG_INLINE struct eng_domain_test eng_domain_test_vf(const struct eng_v v[3],
                                                     const eng_d size[3], eng_d e,
                                                     eng_d e_flat, bool closely)
{
    struct eng_domain_test domain;
    struct eng_v m0 = eng_v_cross(v[1], v[2]);
    struct eng_v m1 = eng_v_cross(v[2], v[0]);
    struct eng_v m2 = eng_v_cross(v[0], v[1]);
    domain.n = eng_v_add(eng_v_add(m0, m1), m2);
    eng_d w0 = eng_v_dot(m0, domain.n);
    eng_d w1 = eng_v_dot(m1, domain.n);
    eng_d w2 = eng_v_dot(m2, domain.n);
    eng_d s0 = size[1] * size[2];
    eng_d s1 = size[2] * size[0];
    eng_d s2 = size[0] * size[1];
    eng_d s = s0 + s1 + s2;
    e *= s;
    eng_d e0 = e * s0;
    eng_d e1 = e * s1;
    eng_d e2 = e * s2;
    domain.inside = eng_dm_and(eng_dm_and(eng_d_less(e0, w0), eng_d_less(e1, w1)),
                               eng_d_less(e2, w2));
    domain.outside = eng_dm_or(eng_dm_or(eng_d_less(w0, -e0), eng_d_less(w1, -e1)),
                               eng_d_less(w2, -e2));
    if (closely) {
        eng_d longest =
            eng_d_max_abs(eng_v_size_of_two(m0, m1), eng_v_size_of_two(m2, m2));
        eng_d n = eng_v_size_of_two(domain.n, domain.n);
        domain.outside =
            eng_dm_or(domain.outside, eng_d_less(n + 2 * e_flat * s, longest));
    }
    domain.nn = w0 + w1 + w2;
    domain.param[0] = w1;
    domain.param[1] = w2;
    return domain;
}

/* Test EE by (p x c) . n and (b x p) . n against n . n; neither is longer than n. */
ENG_INLINE struct eng_domain_test eng_domain_test_ee(const struct eng_v v[3],
                                                     const eng_d size[3], eng_d e,
                                                     eng_d e_flat, bool closely)
{
    struct eng_domain_test domain;
    domain.n = eng_v_cross(v[1], v[2]);
    struct eng_v m_beta = eng_v_cross(v[0], v[2]);
    struct eng_v m_gamma = eng_v_cross(v[1], v[0]);
    eng_d nn = eng_v_dot(domain.n, domain.n);
    eng_d beta = eng_v_dot(m_beta, domain.n);
    eng_d gamma = eng_v_dot(m_gamma, domain.n);
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
    domain.inside = eng_dm_and(
        eng_dm_and(eng_d_less(e_beta, beta), eng_d_less(e_rest_beta, rest_beta)),
        eng_dm_and(eng_d_less(e_gamma, gamma), eng_d_less(e_rest_gamma, rest_gamma)));
    domain.outside = eng_dm_or(
        eng_dm_or(eng_d_less(beta, -e_beta), eng_d_less(rest_beta, -e_rest_beta)),
        eng_dm_or(eng_d_less(gamma, -e_gamma), eng_d_less(rest_gamma, -e_rest_gamma)));
    if (closely) {
        eng_d longest = eng_v_size_of_two(m_beta, m_gamma);
        eng_d n = eng_v_size_of_two(domain.n, domain.n);
        eng_d e_long = e_flat * (s + (s_beta + s_gamma));
        domain.outside = eng_dm_or(domain.outside, eng_d_less(n + e_long, longest));
    }
    domain.nn = nn;
    domain.param[0] = beta;
    domain.param[1] = gamma;
    return domain;
}

/* Test the domain in the bracket [x, y], which is short. */
ENG_INLINE struct eng_domain_test
eng_domain_test_of(enum pccd_kind kind, const struct eng_motion_lanes *motion, eng_d x,
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
    return kind == PCCD_VF ? eng_domain_test_vf(v, motion->size, e, e_flat, closely)
                           : eng_domain_test_ee(v, motion->size, e, e_flat, closely);
}

/* ---- intervals ------------------------------------------------------------------- */

/* Intervals of the step in which a cubic has at most one root, and those
 * without a root, which are dropped.
 *
 * Name what is known of the pairs in the lanes; set up their cubics; find the cubics that
 * certainly have no root, and those that only fall, which have one. */

/* Sizes below this, where products might lose bits, are left to those who scale. */
#define SIZE_MIN 0x1p-200

/* Contacts in longer brackets are left to the search, which shortens them. */
#define WIDTH_MAX 0x1p-30

enum look { LOOK_FALLING, LOOK_ALL };

/* The pairs in the lanes and what is known of them. */
struct lanes {
    struct eng_motion_lanes motion;
    struct eng_cubic cubic; /* positive at l */
    struct eng_cubic_powers powers;
    /* The interval at hand: the cubic is certainly positive at l and negative at r. Looks
     * at what falls leave all but the roots out: it is [0, 1]. */
    eng_d l, r;
    eng_d f_l, f_r;
    eng_d root;
    eng_d slope;         /* near the root */
    eng_d low_l, high_r; /* the root is between them */
    eng_dm moving;       /* on the way to their root */
    /* Where the intervals end, and the cubic there. */
    eng_d cut[2];
    eng_d at_cut[2];
    eng_dm bends[2];       /* there is a second, a third interval */
    eng_dm flat_l, flat_r; /* the interval at hand begins, ends where the cubic turns */
    eng_dm starts_below;   /* the cubic was turned */
    const uint32_t *pairs;
    uint32_t count;  /* of pairs */
    uint32_t wanted; /* bits: with a root in the interval */
    uint32_t on_way; /* bits: of them, those that move */
    uint32_t done;   /* bits: decided */
};

/* The limits that all pairs have in common. */
struct limits {
    eng_d width; /* of a bracket, at most */
    eng_d until; /* what begins later is not asked for */
    double t_end;
    bool is_early; /* until < 1 */
};

ENG_INLINE struct limits limits_of(double tolerance, double t_end)
{
    const double until = t_end + tolerance + 0x1p-48;
    return (struct limits){eng_d_all(tolerance < WIDTH_MAX ? tolerance : WIDTH_MAX),
                           eng_d_all(until), t_end, until < 1};
}

ENG_INLINE eng_dm all_above(eng_d a, eng_d b, eng_d c, eng_d d, eng_d e)
{
    return eng_d_less(e, eng_d_min(eng_d_min(a, b), eng_d_min(c, d)));
}

/* Return the lanes whose sign at t = 0 is certain. */
ENG_INLINE eng_dm is_certain(const struct lanes *lanes)
{
    const eng_d zero = {0};
    const eng_d *size = lanes->motion.size;
    eng_dm is_large =
        eng_d_at_most(zero + SIZE_MIN, eng_d_min(eng_d_min(size[0], size[1]), size[2]));
    return eng_dm_and(is_large, eng_d_less(lanes->cubic.error, lanes->cubic.f[0]));
}

/* Make the cubics of lanes->motion, turned so that they are positive at t = 0. Return the
 * lanes whose sign there is certain. */
ENG_INLINE eng_dm open(enum look look, struct lanes *lanes)
{
    const eng_d zero = {0};
    const eng_d *size = lanes->motion.size;
    lanes->cubic = eng_cubic_of(lanes->motion.v, size[0] * size[1] * size[2]);
    if (look == LOOK_ALL) {
        eng_cubic_tighten(&lanes->cubic, lanes->motion.v);
    }
    lanes->starts_below = eng_d_less(lanes->cubic.f[0], zero);
    eng_cubic_turn(&lanes->cubic, lanes->starts_below);
    return is_certain(lanes);
}

/* Return the lanes that certainly have no root in the first half of the step, nor in the
 * second. */
ENG_INLINE eng_dm is_clear_by_halves(const struct eng_cubic *cubic)
{
    const eng_d *f = cubic->f;
    eng_d quad[3];
    eng_d line[2];
#pragma GCC unroll 3
    for (int i = 0; i < 3; i++) {
        quad[i] = 0.5 * (f[i] + f[i + 1]);
    }
    line[0] = 0.5 * (quad[0] + quad[1]);
    line[1] = 0.5 * (quad[1] + quad[2]);
    eng_d low = eng_d_min(eng_d_min(f[0], f[3]), eng_d_min(quad[0], quad[2]));
    low = eng_d_min(low, eng_d_min(line[0], line[1]));
    return eng_d_less(cubic->error, low);
}

/* Make the whole step the interval, and ask for its root where the cubic falls. Lanes
 * that certainly have no root, or none that begins by limits->until, are done. */
ENG_INLINE void set_falling(struct lanes *lanes, eng_dm sure, const struct limits *limits)
{
    const eng_d *f = lanes->cubic.f;
    eng_d e = lanes->cubic.error;
    uint32_t all = (1u << lanes->count) - 1;
    eng_dm falls = eng_dm_and(sure, eng_d_less(f[3], -e));
    eng_dm misses = eng_dm_and(sure, is_clear_by_halves(&lanes->cubic));
    if (limits->is_early) {
        struct eng_cubic_at at = eng_cubic_at(&lanes->cubic, limits->until);
        eng_dm later = all_above(f[0], at.quad[0], at.line[0], at.value, e);
        misses = eng_dm_or(misses, eng_dm_and(sure, later));
    }
    lanes->done = eng_dm_bits(misses) & all;
    lanes->wanted = eng_dm_bits(falls) & all & ~lanes->done;
}

/* ---- pieces ---------------------------------------------------------------------- */

/* Cut the step where a cubic turns, so that each piece has at most one root. */

/* Where a cubic turns, and what it is there. */
struct turn {
    eng_d t;
    struct eng_cubic_at at;
};

/* Return the lanes whose cubic is certainly positive over all of [0, t], or [t, 1]. */
ENG_INLINE eng_dm is_clear_before(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(cubic->f[0], at->quad[0], at->line[0], at->value, cubic->error);
}

ENG_INLINE eng_dm is_clear_behind(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(cubic->f[3], at->quad[2], at->line[1], at->value, cubic->error);
}

/* Return the lanes whose cubic is certainly negative over all of [t, 1]. */
ENG_INLINE eng_dm is_below_behind(const struct eng_cubic *cubic, const struct turn *turn)
{
    const struct eng_cubic_at *at = &turn->at;
    return all_above(-cubic->f[3], -at->quad[2], -at->line[1], -at->value, cubic->error);
}

/* Cut the step where the cubic turns; the first interval begins at 0 or, if there is no
 * root before, at the maximum; it ends at the minimum if there are more roots than one,
 * or none behind. */
ENG_INLINE void set_pieces(struct lanes *lanes, eng_dm sure)
{
    const eng_d zero = {0};
    const eng_d one = zero + 1;
    const struct eng_cubic *cubic = &lanes->cubic;
    const eng_d *f = cubic->f;
    eng_d e = cubic->error;
    uint32_t all = (1u << lanes->count) - 1;
    struct turn low;
    struct turn high;
    eng_cubic_turns(cubic, &low.t, &high.t);
    eng_dm has_low = eng_dm_and(eng_d_less(zero, low.t), eng_d_less(low.t, one));
    eng_dm has_both = eng_dm_and(
        has_low, eng_dm_and(eng_d_at_most(low.t, high.t), eng_d_less(high.t, one)));
    low.t = eng_d_select(has_low, low.t, zero + 0.5);
    high.t = eng_d_select(has_both, high.t, one);
    low.at = eng_cubic_at(cubic, low.t);
    high.at = eng_cubic_at(cubic, high.t);
    eng_d between[2];
    eng_cubic_between(&low.at, high.t, between);
    eng_dm falls = eng_dm_and(sure, eng_d_less(f[3], -e));
    eng_dm returns = eng_dm_and(sure, eng_d_less(e, f[3]));
    eng_dm before = is_clear_before(cubic, &low);
    eng_dm misses = eng_dm_and(returns, eng_dm_and(before, is_clear_behind(cubic, &low)));
    eng_dm dips = eng_d_less(low.at.value, -e);
    eng_dm rises = eng_dm_and(has_both, eng_d_less(e, high.at.value));
    eng_dm falls_late = eng_dm_and(eng_dm_and(falls, rises), before);
    falls_late = eng_dm_and(falls_late, eng_d_less(e, eng_d_min(between[0], between[1])));
    eng_dm falls_early = eng_dm_and(eng_dm_and(falls, dips), has_both);
    falls_early = eng_dm_and(falls_early, is_below_behind(cubic, &high));
    falls_early =
        eng_dm_and(falls_early, eng_d_less(eng_d_max(between[0], between[1]), -e));
    eng_dm twice = eng_dm_and(returns, dips);
    eng_dm thrice = eng_dm_and(eng_dm_and(falls, rises), dips);
    eng_dm ends_low = eng_dm_or(eng_dm_or(twice, thrice), falls_early);
    lanes->bends[0] = eng_dm_or(twice, thrice);
    lanes->bends[1] = thrice;
    lanes->l = eng_d_select(falls_late, high.t, zero);
    lanes->f_l = eng_d_select(falls_late, high.at.value, f[0]);
    lanes->r = eng_d_select(ends_low, low.t, one);
    lanes->f_r = eng_d_select(ends_low, low.at.value, f[3]);
    lanes->cut[0] = low.t;
    lanes->at_cut[0] = low.at.value;
    lanes->cut[1] = eng_d_select(thrice, high.t, one);
    lanes->at_cut[1] = eng_d_select(thrice, high.at.value, f[3]);
    lanes->flat_l = falls_late;
    lanes->flat_r = ends_low;
    lanes->done = eng_dm_bits(misses) & all;
    lanes->wanted = eng_dm_bits(eng_dm_or(twice, falls)) & all;
}

/* Go on to the next interval; the cubic is turned so that it is positive at its begin. */
ENG_INLINE void set_next(struct lanes *lanes, int piece)
{
    const eng_d zero = {0};
    eng_d sign = piece == 1 ? zero - 1 : zero + 1;
    lanes->l = lanes->cut[piece - 1];
    lanes->f_l = sign * lanes->at_cut[piece - 1];
    lanes->r = piece == 1 ? lanes->cut[1] : (eng_d)(zero + 1);
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        lanes->cubic.f[i] = -lanes->cubic.f[i];
    }
    lanes->flat_l = piece == 1 ? eng_dm_not(lanes->bends[1]) : lanes->bends[1];
    lanes->flat_r = eng_dm_and(lanes->flat_l, eng_dm_not(lanes->flat_l)); /* none */
    lanes->f_r = piece == 1 ? (eng_d)(sign * lanes->at_cut[1]) : lanes->cubic.f[3];
}

/* ---- enclosing a root ------------------------------------------------------------ */

/* Find the time of a contact: encloses a root of a cubic between two times,
 * and describes the contact there. */

/* Longer brackets say nothing about misses. */
#define WIDTH_MISS_MAX 0x1p-10

/* Rounds of Halley's method. From the guess two or three are enough for nearly all that
 * fall; the others are not in general position, or many roots are near. */
#define ROUNDS_FALLING 3
#define ROUNDS_ALL     12

/* A step of Halley's method that is this short has led to the root up to rounding. */
#define STEP_FALLING 0x1p-17
#define STEP_ALL     0x1p-24

/* Make first guesses of all roots. */
ENG_INLINE void guess(enum look look, struct lanes *lanes)
{
    const eng_d zero = {0};
    lanes->powers = eng_cubic_powers(&lanes->cubic);
    if (look == LOOK_FALLING) {
        lanes->root = eng_cubic_guess(&lanes->cubic);
    } else {
        /* A parabola from its vertex where the cubic turns at an end, else a line. */
        eng_d width = lanes->r - lanes->l;
        eng_d share = lanes->f_l / (lanes->f_l - lanes->f_r);
        eng_d root = eng_d_sqrt(eng_d_select(lanes->flat_r, 1 - share, share));
        share = eng_d_select(lanes->flat_l, root, share);
        share = eng_d_select(lanes->flat_r, 1 - root, share);
        lanes->root = lanes->l + width * share;
        lanes->low_l = lanes->l;
        lanes->high_r = lanes->r;
    }
    lanes->moving = eng_d_less(zero, zero + 1);
    lanes->slope = zero - 1;
}

/* Return whether `m` is set in the only lane; false where there are several lanes. One
 * lane waits for nobody else: a branch that goes the usual way takes no time, where what
 * it leaves out would stand in the chain from root to root. */
ENG_INLINE bool is_all(eng_dm m)
{
    return ENG_D_LANES == 1 && __builtin_expect(eng_dm_bits(m) != 0, 1);
}

ENG_INLINE eng_d clamped(eng_d x, eng_d low, eng_d high)
{
    if (is_all(eng_dm_and(eng_d_less(low, x), eng_d_less(x, high)))) {
        return x;
    }
    return eng_d_min(eng_d_max(x, low), high);
}

/* Step nearer to all roots. Which lanes still move decides nothing about others. */
ENG_INLINE void move(enum look look, struct lanes *lanes)
{
    const eng_d zero = {0};
    const eng_d one = zero + 1;
    eng_d s = lanes->root;
    struct eng_cubic_step step = eng_cubic_halley(&lanes->powers, s);
    eng_d next = s + step.step;
    eng_d limit = zero + (look == LOOK_FALLING ? STEP_FALLING : STEP_ALL);
    eng_dm is_small = eng_d_at_most(eng_d_abs(step.step), limit);
    if (look == LOOK_FALLING) {
        next = clamped(next, zero, one);
    } else {
        eng_dm before = eng_d_less(zero, step.value);
        eng_d low = eng_d_select(before, s, lanes->low_l);
        eng_d high = eng_d_select(before, lanes->high_r, s);
        eng_dm good = eng_dm_and(eng_d_less(low, next), eng_d_less(next, high));
        if (!is_all(good)) {
            next = eng_d_select(eng_dm_or(is_small, good), next, 0.5 * (low + high));
        }
        lanes->low_l = low;
        lanes->high_r = high;
    }
    if (ENG_D_LANES == 1) {
        lanes->slope = step.slope; /* who stands still is not asked to move */
        lanes->root = next;
        lanes->moving = eng_dm_not(is_small);
    } else {
        lanes->slope = eng_d_select(lanes->moving, step.slope, lanes->slope);
        lanes->root = eng_d_select(lanes->moving, next, s);
        lanes->moving = eng_dm_and(lanes->moving, eng_dm_not(is_small));
    }
    lanes->on_way = eng_dm_bits(lanes->moving) & lanes->wanted;
}

/* Return the lanes whose cubic is certainly positive before the bracket, from l on, and
 * negative behind it, up to r, which of course holds at x and y too. */
ENG_INLINE eng_dm encloses(enum look look, const struct lanes *lanes, eng_d x, eng_d y)
{
    const eng_d *f = lanes->cubic.f;
    eng_d e = lanes->cubic.error;
    struct eng_cubic_at at_x = eng_cubic_at(&lanes->cubic, x);
    struct eng_cubic_at at_y = eng_cubic_at(&lanes->cubic, y);
    if (look == LOOK_FALLING) {
        eng_dm before = all_above(f[0], at_x.quad[0], at_x.line[0], at_x.value, e);
        eng_dm behind = all_above(-f[3], -at_y.quad[2], -at_y.line[1], -at_y.value, e);
        return eng_dm_and(before, behind);
    }
    eng_d before[2];
    eng_d behind[2];
    eng_cubic_between(&at_x, lanes->l, before);
    eng_cubic_between(&at_y, lanes->r, behind);
    return eng_dm_and(all_above(lanes->f_l, before[0], before[1], at_x.value, e),
                      all_above(-lanes->f_r, -behind[0], -behind[1], -at_y.value, e));
}

/* Brackets around the roots, and what is there. */
struct bracket {
    eng_d x, y;
    struct eng_domain_test domain;
    eng_dm meets;  /* certainly, and it is as short as asked */
    eng_dm passed; /* certainly nothing meets there */
};

/* Return brackets around the roots, and what is there. */
ENG_INLINE struct bracket enclose(enum pccd_kind kind, enum look look,
                                  const struct lanes *lanes, const struct limits *limits)
{
    const eng_d zero = {0};
    struct bracket at;
    eng_d l = look == LOOK_FALLING ? zero : lanes->l;
    eng_d r = look == LOOK_FALLING ? (eng_d)(zero + 1) : lanes->r;
    /* The cubic is beyond its error at a distance of error / slope, and a half more for
     * what rounding does to root, slope and the cubic there. */
    eng_d reach = 1.5 * lanes->cubic.error / eng_d_abs(lanes->slope) + 0x1p-51;
    at.x = eng_d_max(l, lanes->root - reach);
    at.y = eng_d_min(r, lanes->root + reach);
    eng_d width = at.y - at.x;
    eng_dm enclosed = encloses(look, lanes, at.x, at.y);
    eng_dm is_quantised = eng_d_at_most(width, limits->width);
    eng_dm is_short = eng_d_at_most(width, zero + WIDTH_MISS_MAX);
    at.domain = eng_domain_test_of(kind, &lanes->motion, at.x, at.y, look == LOOK_ALL);
    at.meets = eng_dm_and(eng_dm_and(enclosed, is_quantised), at.domain.inside);
    at.passed = eng_dm_and(eng_dm_and(enclosed, is_short), at.domain.outside);
    return at;
}

/* Compute what a hit says of a contact: params and normal. */
ENG_INLINE void describe(enum pccd_kind kind, const struct lanes *lanes,
                         const struct eng_domain_test *domain, eng_d numbers[5])
{
    const eng_d one = (eng_d){0} + 1;
    eng_d scale = 1 / domain->nn;
    eng_d beta = domain->param[0] * scale;
    eng_d gamma = domain->param[1] * scale;
    numbers[0] = kind == PCCD_EE ? eng_d_min(beta, one) : beta;
    numbers[1] = kind == PCCD_EE ? eng_d_min(gamma, one) : gamma;
    /* VF: from the face to the side of the vertex; EE: from b to a. */
    eng_d unit = eng_d_sqrt(scale);
    unit = kind == PCCD_VF ? eng_d_select(lanes->starts_below, -unit, unit)
                           : eng_d_select(lanes->starts_below, unit, -unit);
    numbers[2] = domain->n.x * unit;
    numbers[3] = domain->n.y * unit;
    numbers[4] = domain->n.z * unit;
}

#endif
