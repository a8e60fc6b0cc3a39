/* daemon/engine/kernel/bracket.c - the certified solver, a pair to each lane.
 *
 * Room:     engine.
 * Does:     find the roots of the coplanarity cubic, enclose each between two times at
 *           which its sign is certain, and say whether the features certainly meet or
 *           certainly miss there. What is not certain is left to solve.c.
 * Threads:  [any].
 * Source:   query.h; every constant times u is derived in BOUNDS.md.
 *
 * With the cubic turned so that it is positive at t = 0, two shapes are decided here:
 *
 *   it falls to below zero at t = 1: one root, first = [0, 1];
 *   it is positive at t = 1 too, and negative at its inner minimum m: a root on
 *     either side of m. The second is looked at only if the first is no contact, in
 *     another round over such pairs.
 *
 * In both, the coefficients over what lies before and behind the brackets have to be
 * certain: so the brackets hold all the roots, whatever else the cubic might do.
 */
#include "cubic.h"
#include "points.h"
#include "table.h"

/* Sizes below this, where products might lose bits, are left to those who scale. */
#define SIZE_MIN 0x1p-200

/* Longer brackets are left to the search, which narrows them. */
#define WIDTH_MAX 0x1p-30

/* Three difference vectors. VF: vertex - corner k; EE: p, b, c. */
struct motion {
    struct eng_v v[2][3];
    eng_d size[3]; /* largest coordinate at both ends */
};

ENG_INLINE struct motion load(enum eng_kind kind, const struct eng_group *group)
{
    struct motion motion;
    struct eng_v x[4][2];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        eng_group_load(group, i, x[i]);
    }
#pragma GCC unroll 2
    for (int end = 0; end < 2; end++) {
        struct eng_v *v = motion.v[end];
        if (kind == ENG_VF) {
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

/* Where the features are in a bracket. */
struct place {
    eng_dm inside;  /* certainly in the domain at every time of it, b and c independent */
    eng_dm outside; /* certainly no contact at any time of it */
    struct eng_v n; /* b x c in its middle */
    eng_d param[2]; /* as in struct eng_contact, before rounding to float */
};

/* VF: the weights of the corners, (d_j x d_k) . n. */
ENG_INLINE struct place place_vf(const struct eng_v v[3], const eng_d size[3], eng_d e)
{
    struct place place;
    struct eng_v m0 = eng_v_cross(v[1], v[2]);
    struct eng_v m1 = eng_v_cross(v[2], v[0]);
    struct eng_v m2 = eng_v_cross(v[0], v[1]);
    place.n = eng_v_add(eng_v_add(m0, m1), m2);
    eng_d w0 = eng_v_dot(m0, place.n);
    eng_d w1 = eng_v_dot(m1, place.n);
    eng_d w2 = eng_v_dot(m2, place.n);
    eng_d s0 = size[1] * size[2];
    eng_d s1 = size[2] * size[0];
    eng_d s2 = size[0] * size[1];
    e *= s0 + s1 + s2;
    eng_d e0 = e * s0;
    eng_d e1 = e * s1;
    eng_d e2 = e * s2;
    place.inside = eng_dm_and(eng_dm_and(eng_d_less(e0, w0), eng_d_less(e1, w1)),
                              eng_d_less(e2, w2));
    place.outside = eng_dm_or(eng_dm_or(eng_d_less(w0, -e0), eng_d_less(w1, -e1)),
                              eng_d_less(w2, -e2));
    eng_d scale = 1 / (w0 + w1 + w2);
    place.param[0] = w1 * scale;
    place.param[1] = w2 * scale;
    return place;
}

/* EE: (p x c) . n and (b x p) . n against n . n. */
ENG_INLINE struct place place_ee(const struct eng_v v[3], const eng_d size[3], eng_d e)
{
    struct place place;
    const eng_d one = (eng_d){0} + 1;
    place.n = eng_v_cross(v[1], v[2]);
    eng_d nn = eng_v_dot(place.n, place.n);
    eng_d beta = eng_v_dot(eng_v_cross(v[0], v[2]), place.n);
    eng_d gamma = eng_v_dot(eng_v_cross(v[1], v[0]), place.n);
    eng_d s = size[1] * size[2];
    e *= s;
    eng_d e_nn = e * s;
    eng_d e_beta = e * (size[0] * size[2]);
    eng_d e_gamma = e * (size[0] * size[1]);
    eng_d rest_beta = nn - beta;
    eng_d rest_gamma = nn - gamma;
    eng_d e_rest_beta = e_nn + e_beta;
    eng_d e_rest_gamma = e_nn + e_gamma;
    place.inside = eng_dm_and(
        eng_dm_and(eng_d_less(e_beta, beta), eng_d_less(e_rest_beta, rest_beta)),
        eng_dm_and(eng_d_less(e_gamma, gamma), eng_d_less(e_rest_gamma, rest_gamma)));
    place.outside = eng_dm_or(
        eng_dm_or(eng_d_less(beta, -e_beta), eng_d_less(rest_beta, -e_rest_beta)),
        eng_dm_or(eng_d_less(gamma, -e_gamma), eng_d_less(rest_gamma, -e_rest_gamma)));
    eng_d scale = 1 / nn;
    place.param[0] = eng_d_min(beta * scale, one);
    place.param[1] = eng_d_min(gamma * scale, one);
    return place;
}

ENG_INLINE struct place place_of(enum eng_kind kind, const struct motion *motion, eng_d x,
                                 eng_d y)
{
    struct eng_v v[3];
    eng_d t = 0.5 * (x + y);
    eng_d s = 1 - t;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        v[k] = eng_v_mix(s, motion->v[0][k], t, motion->v[1][k]);
    }
    eng_d e = 52 * (y - x) + 424 * ENG_U;
    return kind == ENG_VF ? place_vf(v, motion->size, e) : place_ee(v, motion->size, e);
}

/* What is known of the pairs of a group. */
struct answer {
    eng_dm hit;
    eng_dm miss;
    eng_dm again; /* the second root is to be looked at */
    eng_d toi, toi_hi;
    eng_d param[2];
    struct eng_v normal;
};

ENG_INLINE eng_dm all_above(eng_d a, eng_d b, eng_d c, eng_d d, eng_d e)
{
    return eng_d_less(e, eng_d_min(eng_d_min(a, b), eng_d_min(c, d)));
}

/* The interval at hand: [l, r], the cubic certainly positive at l and negative at r. */
struct interval {
    eng_d l, r;
    eng_d f_l, f_r;
};

/* Is the cubic certainly positive before the bracket, from `l` on, and negative behind
 * it, up to `r`, which of course holds at x and y too? */
ENG_INLINE eng_dm encloses(const struct eng_cubic *cubic, const struct interval *interval,
                           eng_d x, eng_d y)
{
    struct eng_cubic_at at_x = eng_cubic_at(cubic, x);
    struct eng_cubic_at at_y = eng_cubic_at(cubic, y);
    eng_d before[2];
    eng_d behind[2];
    eng_cubic_between(&at_x, interval->l, before);
    eng_cubic_between(&at_y, interval->r, behind);
    eng_d e = cubic->error;
    return eng_dm_and(all_above(interval->f_l, before[0], before[1], at_x.value, e),
                      all_above(-interval->f_r, -behind[0], -behind[1], -at_y.value, e));
}

ENG_INLINE struct answer solve(enum eng_kind kind, bool second,
                               const struct eng_group *group, eng_d tolerance)
{
    const eng_d zero = {0};
    struct motion motion = load(kind, group);
    const eng_d *size = motion.size;
    struct eng_cubic cubic = eng_cubic_of(motion.v, size[0] * size[1] * size[2]);
    eng_dm starts_below = eng_d_less(cubic.f[0], zero);
    eng_cubic_turn(&cubic, starts_below);
    const eng_d *f = cubic.f;
    eng_d e = cubic.error;
    eng_dm sure = eng_dm_and(
        eng_d_less(e, f[0]),
        eng_d_at_most(zero + SIZE_MIN, eng_d_min(eng_d_min(size[0], size[1]), size[2])));
    eng_dm falls = eng_dm_and(sure, eng_d_less(f[3], -e));
    eng_dm returns = eng_dm_and(sure, eng_d_less(e, f[3]));
    struct answer answer = {
        .miss = eng_dm_and(returns, eng_d_less(e, eng_d_min(f[1], f[2])))};
    answer.hit = answer.again = eng_dm_and(sure, eng_dm_not(sure));

    struct interval interval = {zero, zero + 1, f[0], f[3]};
    eng_dm dips = answer.again;
    if (second || eng_dm_bits(eng_dm_and(returns, eng_dm_not(answer.miss)))) {
        eng_d m = eng_cubic_minimum(&cubic);
        struct eng_cubic_at at = eng_cubic_at(&cubic, m);
        eng_dm clear = eng_dm_and(all_above(f[0], at.quad[0], at.line[0], at.value, e),
                                  all_above(f[3], at.quad[2], at.line[1], at.value, e));
        answer.miss = eng_dm_or(answer.miss, eng_dm_and(returns, clear));
        dips = eng_dm_and(returns, eng_d_less(at.value, -e));
        if (second) {
            /* Turned round, so that it is positive at m and negative at 1. */
            eng_cubic_turn(&cubic, dips);
            interval = (struct interval){m, zero + 1, -at.value, cubic.f[3]};
        } else {
            interval.r = eng_d_select(dips, m, interval.r);
            interval.f_r = eng_d_select(dips, at.value, interval.f_r);
        }
    }
    eng_dm wanted = second ? dips : eng_dm_or(falls, dips);
    if (eng_dm_bits(wanted) == 0) {
        return answer;
    }
    eng_d slope;
    eng_d root = eng_cubic_root(&cubic, interval.l, interval.r, interval.f_l,
                                interval.f_r, eng_dm_bits(wanted), &slope);
    /* The cubic is beyond its error at a distance of error / slope, and a half more for
     * what rounding does to root, slope and the cubic there. */
    eng_d reach = 1.5 * e / eng_d_abs(slope) + 0x1p-51;
    eng_d x = eng_d_max(interval.l, root - reach);
    eng_d y = eng_d_min(interval.r, root + reach);
    eng_d width = eng_d_min(tolerance, zero + WIDTH_MAX);
    eng_dm enclosed = eng_dm_and(eng_dm_and(wanted, eng_d_at_most(y - x, width)),
                                 encloses(&cubic, &interval, x, y));
    struct place place = place_of(kind, &motion, x, y);
    answer.hit = eng_dm_and(enclosed, place.inside);
    eng_dm passed = eng_dm_and(enclosed, place.outside);
    answer.again = second ? answer.again : eng_dm_and(passed, dips);
    eng_dm last = second ? dips : falls;
    answer.miss = eng_dm_or(answer.miss, eng_dm_and(passed, last));
    answer.toi = x;
    answer.toi_hi = y;
    answer.param[0] = place.param[0];
    answer.param[1] = place.param[1];
    /* VF: from the face to the side of the vertex; EE: from b to a. */
    eng_d length = eng_d_sqrt(eng_v_dot(place.n, place.n));
    eng_d scale = (kind == ENG_VF ? 1 : -1) / length;
    scale = eng_d_select(starts_below, -scale, scale);
    answer.normal =
        (struct eng_v){place.n.x * scale, place.n.y * scale, place.n.z * scale};
    return answer;
}

/* Append the hits of the lanes `bits` that begin in time. */
ENG_INLINE uint32_t write_hits(const struct answer *answer, uint32_t bits,
                               const uint32_t *pairs, double t_end, uint32_t *index,
                               struct eng_hit *hits)
{
    double at[7][ENG_D_LANES];
    uint32_t count = 0;
    eng_d_store(at[0], answer->toi);
    eng_d_store(at[1], answer->toi_hi);
    eng_d_store(at[2], answer->param[0]);
    eng_d_store(at[3], answer->param[1]);
    eng_d_store(at[4], answer->normal.x);
    eng_d_store(at[5], answer->normal.y);
    eng_d_store(at[6], answer->normal.z);
    for (; bits != 0; bits &= bits - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(bits);
        struct eng_hit *hit = &hits[count];
        hit->flags = ENG_PROVED;
        hit->toi = at[0][lane];
        hit->toi_hi = at[1][lane];
        hit->param[0] = (float)at[2][lane];
        hit->param[1] = (float)at[3][lane];
        hit->normal[0] = (float)at[4][lane];
        hit->normal[1] = (float)at[5][lane];
        hit->normal[2] = (float)at[6][lane];
        index[count] = pairs[lane];
        count += hit->toi <= t_end;
    }
    return count;
}

/* One round over pairs[count]: the first root or the second. Pairs for another round go
 * to pairs[] itself, returned in *again. */
ENG_INLINE void solve_all(enum eng_kind kind, bool second, const struct eng_point *points,
                          const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                          double tolerance, double t_end, struct eng_bracketed *out,
                          uint32_t *again)
{
    *again = 0;
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        uint32_t n = count - i < ENG_D_LANES ? count - i : ENG_D_LANES;
        uint32_t lanes = (1u << n) - 1;
        struct eng_group group = eng_group_of(points, quads, pairs + i, n);
        struct answer answer = solve(kind, second, &group, eng_d_all(tolerance));
        uint32_t hit = eng_dm_bits(answer.hit) & lanes;
        uint32_t next = eng_dm_bits(answer.again) & lanes;
        uint32_t done = eng_dm_bits(answer.miss) | hit | next;
        if (hit != 0) {
            out->hit_count +=
                write_hits(&answer, hit, pairs + i, t_end, out->index + out->hit_count,
                           out->hits + out->hit_count);
        }
        out->unsure_count +=
            eng_keep(out->unsure + out->unsure_count, pairs + i, n, lanes & ~done);
        *again += eng_keep(pairs + *again, pairs + i, n, next);
    }
}

ENG_INLINE void bracket(enum eng_kind kind, const struct eng_point *points,
                        const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                        double tolerance, double t_end, struct eng_bracketed *out)
{
    uint32_t again;
    solve_all(kind, false, points, quads, pairs, count, tolerance, t_end, out, &again);
    count = again;
    solve_all(kind, true, points, quads, pairs, count, tolerance, t_end, out, &again);
}

void ENG_KERNEL(bracket)(enum eng_kind kind, const struct eng_point *points,
                         const uint32_t (*quads)[4], uint32_t *pairs, uint32_t count,
                         double tolerance, double t_end, struct eng_bracketed *out)
{
    if (kind == ENG_VF) {
        bracket(ENG_VF, points, quads, pairs, count, tolerance, t_end, out);
    } else {
        bracket(ENG_EE, points, quads, pairs, count, tolerance, t_end, out);
    }
}
