/* daemon/engine/kernel/cubic.h - cubics in Bernstein form over the step, a lane each.
 *
 * Room:     engine. May include: vectors.h.
 * Does:     coefficients with their error, sides of intervals of time, approximate roots.
 * Threads:  [any]; inline only. Included by files of this folder alone.
 * Source:   BOUNDS.md for every constant times u.
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
    eng_d high = eng_d_max_abs(eng_d_max_abs(cubic.f[0], cubic.f[1]),
                               eng_d_max_abs(cubic.f[2], cubic.f[3]));
    cubic.error = 64 * ENG_U * size + 12 * ENG_U * high;
    return cubic;
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

/* Where the cubic has its inner minimum, if there is one in (0, 1); else the middle.
 * Approximate. */
ENG_INLINE eng_d eng_cubic_minimum(const struct eng_cubic *cubic)
{
    const eng_d zero = {0};
    /* A third of the slope: c + 2 b t + a t t; it rises at the root that is wanted. */
    eng_d c = cubic->f[1] - cubic->f[0];
    eng_d d = cubic->f[2] - cubic->f[1];
    eng_d e = cubic->f[3] - cubic->f[2];
    eng_d b = d - c;
    eng_d a = (c - d) + (e - d);
    eng_d root = eng_d_sqrt(eng_d_max(d * d - c * e, zero));
    eng_dm from_left = eng_d_less(zero, b);
    eng_d up = eng_d_select(from_left, -c, root - b);
    eng_d down = eng_d_select(from_left, b + root, a);
    eng_d t = up / down;
    eng_dm inner = eng_dm_and(eng_d_less(zero, t), eng_d_less(t, zero + 1));
    return eng_d_select(inner, t, zero + 0.5);
}

/* Rounds of Newton's method; those in general position take three or four. */
#define ENG_CUBIC_ROUNDS 10

/* A root between l and r, where the cubic is f_l > 0 and f_r < 0, and the slope near it.
 * Approximate; whoever uses it verifies. Lanes whose bit is not set in `wanted` are not
 * waited for. */
ENG_INLINE eng_d eng_cubic_root(const struct eng_cubic *cubic, eng_d l, eng_d r,
                                eng_d f_l, eng_d f_r, uint32_t wanted, eng_d *slope)
{
    const eng_d zero = {0};
    const eng_d *f = cubic->f;
    eng_d c1 = 3 * (f[1] - f[0]);
    eng_d c2 = 3 * ((f[2] - f[1]) - (f[1] - f[0]));
    eng_d c3 = (f[3] - f[0]) - 3 * (f[2] - f[1]);
    eng_d s = l + (r - l) * (f_l / (f_l - f_r));
    eng_dm moving = eng_d_less(l, r);
    *slope = zero - 1;
    for (int i = 0; i < ENG_CUBIC_ROUNDS; i++) {
        eng_d value = f[0] + s * (c1 + s * (c2 + s * c3));
        eng_d rise = c1 + s * (2 * c2 + s * (3 * c3));
        eng_dm before = eng_d_less(zero, value);
        *slope = eng_d_select(moving, rise, *slope);
        l = eng_d_select(before, s, l);
        r = eng_d_select(before, r, s);
        eng_d step = value / rise;
        eng_d next = s - step;
        eng_dm small = eng_d_at_most(eng_d_abs(step), zero + 0x1p-40);
        eng_dm good = eng_dm_and(eng_d_less(l, next), eng_d_less(next, r));
        next = eng_d_select(eng_dm_or(small, good), next, 0.5 * (l + r));
        s = eng_d_select(moving, next, s);
        moving = eng_dm_and(moving, eng_dm_not(small));
        if ((eng_dm_bits(moving) & wanted) == 0) {
            break;
        }
    }
    return s;
}

#endif
