/* cubic.h - the cubic whose roots are the possible times of contact, for several pairs at
 * once, one in each vector lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md for every constant times u.
 *
 * The blossom b(r, s, t) of a cubic is linear in each of its three times, and b(t, t, t)
 * is its value. b(l, l, l), b(l, l, r), b(l, r, r), b(r, r, r) are the coefficients over
 * [l, r]: if all of them are on one side, so is the cubic.
 */
#ifndef ENG_CUBIC_H
#define ENG_CUBIC_H

#include "query.h"
#include "vectors.h"

struct eng_cubic {
    eng_d f[4];
    eng_d error; /* |computed - true| of each blossom with times in [0, 1] */
};

/* (1 - t) a + t b */
ENG_INLINE eng_d eng_d_mix(eng_d s, eng_d a, eng_d t, eng_d b)
{
    return s * a + t * b;
}

/* The largest coefficient. */
ENG_INLINE eng_d eng_cubic_high(const struct eng_cubic *cubic)
{
    const eng_d *f = cubic->f;
    return eng_d_max_abs(eng_d_max_abs(f[0], f[1]), eng_d_max_abs(f[2], f[3]));
}

/* det[v[0], v[1], v[2]] of vectors that go from v[0][k] to v[1][k]; `size`: the product
 * of their largest coordinates. */
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

/* a x b with every sum one of magnitudes, of vectors that have no negative coordinate. */
ENG_INLINE struct eng_v eng_v_cross_size(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z,
                          a.x * b.y + a.y * b.x};
}

/* A smaller bound on the error, by the magnitudes of the products that are summed up: for
 * vectors that differ in size from axis to axis. It takes as long as the cubic itself. */
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

/* The same with its sign changed where `m` is set. */
ENG_INLINE void eng_cubic_turn(struct eng_cubic *cubic, eng_dm m)
{
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        cubic->f[i] = eng_d_select(m, -cubic->f[i], cubic->f[i]);
    }
}

/* What all blossoms with a time t have in common: b(t, t, t) and, linear in the other
 * times, b(t, t, .) at 0 and 1 and b(t, ., .) as a quadratic. */
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

/* b(t, t, r) and b(t, r, r). */
ENG_INLINE void eng_cubic_between(const struct eng_cubic_at *at, eng_d r, eng_d middle[2])
{
    eng_d s = 1 - r;
    eng_d q0 = eng_d_mix(s, at->quad[0], r, at->quad[1]);
    eng_d q1 = eng_d_mix(s, at->quad[1], r, at->quad[2]);
    middle[0] = eng_d_mix(s, at->line[0], r, at->line[1]);
    middle[1] = eng_d_mix(s, q0, r, q1);
}

/* Where the cubic has its minimum and its maximum, if it has them; else its inflection
 * twice. Approximate. */
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

/* What Halley's method asks for at a time. Approximate. */
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

/* A root in (0, 1) of a cubic with ends of opposite sign, to some digits: that of the
 * parabola through both ends that is nearest to it. */
ENG_INLINE eng_d eng_cubic_guess(const struct eng_cubic *cubic)
{
    const eng_d zero = {0};
    const eng_d *f = cubic->f;
    eng_d middle = 0.75 * (f[1] + f[2]) - 0.25 * (f[0] + f[3]);
    eng_d b = middle - f[0];
    eng_d a = (f[3] - middle) - b;
    return f[0] / (eng_d_sqrt(eng_d_max(b * b - a * f[0], zero)) - b);
}

#endif
