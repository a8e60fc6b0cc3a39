/* passage.c - thin features of which one turns, by the planes across both; compiled once
 * for every instruction set, as kernels are (kernel/local.mk).
 *
 * Source: every constant times u is derived in elementary/BOUNDS.md.
 */
#include "passage.h"

#include <math.h>
#include <string.h>

#include "lanes.h"
#include "motion.h"
#include "nearest_points.h"
#include "points.h"
#include "rotation.h"
#include "sine.h"
#include "two.h"

/* So often the time is refined up to which planes keep features apart. */
#define CUTS 2

/* So often the time is refined when they cross. */
#define REFINEMENTS 2

/* At least the root of 27: lengths by coordinates, of n and of an edge. */
#define RIM 5.25

/* ---- lanes ------------------------------------------------------------------------- */

/* Pairs of one kind and one side that turns. A group that is short of pairs repeats its
 * first. */
struct group {
    uint32_t first_turning, end_turning;
    struct eng_poses *poses;
    struct eng_passage *one[ENG_D_LANES];
    uint32_t count;
    struct eng_v x[4][2];
    eng_dm stands;
    eng_d still_error, still_size, turning_size, bend;
};

/* Load a member of every pair. */
#define EACH(group, member)                                                              \
    __extension__({                                                                      \
        double each[ENG_D_LANES];                                                        \
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {                            \
            each[lane] = (double)(group)->one[lane]->member;                             \
        }                                                                                \
        eng_d_load(each);                                                                \
    })

#define STORE(group, member, vector)                                                     \
    do {                                                                                 \
        double each[ENG_D_LANES];                                                        \
        eng_d_store(each, vector);                                                       \
        for (uint32_t lane = 0; lane < (group)->count; lane++) {                         \
            (group)->one[lane]->member = each[lane];                                     \
        }                                                                                \
    } while (0)

static inline void begin_group(struct group *group, struct eng_poses *poses,
                               enum pccd_kind kind, uint32_t turning,
                               struct eng_passage *const *some, uint32_t count)
{
    const uint32_t points = common_kinds[kind].points[0];
    group->first_turning = turning == 0 ? 0 : points;
    group->end_turning = turning == 0 ? points : 4;
    group->poses = poses;
    group->count = count < ENG_D_LANES ? count : ENG_D_LANES;
    for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
        group->one[lane] = some[lane < group->count ? lane : 0];
    }
    for (uint32_t i = 0; i < 4; i++) {
        for (int end = 0; end < 2; end++) {
            const double *at[ENG_D_LANES];
            for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
                at[lane] = group->one[lane]->x[end][i];
            }
            group->x[i][end] = eng_points_turn(at);
        }
    }
    group->stands = eng_d_less(eng_d_all(0), EACH(group, stands));
    group->still_error = EACH(group, still_error);
    group->still_size = EACH(group, still_size);
    group->turning_size = EACH(group, turning_size);
    group->bend = EACH(group, bend);
}

/* ---- poses ------------------------------------------------------------------------- */

/* As two.h says, of lanes. */
ENG_INLINE eng_d two_sum(eng_d a, eng_d b, eng_d *rest)
{
    eng_d sum = a + b;
    eng_d part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

/* The value of a joint, as path.c says. */
struct value {
    eng_d hi, lo;
};

ENG_INLINE struct value value_at(const struct eng_path_joint *joint, eng_d t)
{
    double by_low;
    const double by_high = eng_two_split(joint->by[0], &by_low);
    eng_d scaled = 0x1.0000002p27 * t;
    eng_d t_high = scaled - (scaled - t);
    eng_d t_low = t - t_high;
    eng_d product = t * joint->by[0];
    eng_d product_rest =
        ((t_high * by_high - product) + t_high * by_low + t_low * by_high) +
        t_low * by_low;
    eng_d sum_rest;
    eng_d sum = two_sum(eng_d_all(joint->from[0]), product, &sum_rest);
    eng_d rest =
        ((sum_rest + product_rest) + t * joint->by_rest[0]) + joint->from_rest[0];
    struct value value;
    value.hi = two_sum(sum, rest, &value.lo);
    return value;
}

/* As sine.h says. */
ENG_INLINE void sine_of(const struct value *angle, eng_d *sine, eng_d *cosine)
{
    const double whole = 0x1.8p52;
    eng_d rounded = angle->hi * 0x1.45f306dc9c883p-1 + whole;
    eng_d quarters = rounded - whole;
    eng_d rough = angle->hi - quarters * COMMON_QUARTER_HIGH;
    eng_d part = quarters * COMMON_QUARTER_LOW, near = rough - part;
    eng_d low = ((rough - near) - part) + (angle->lo - quarters * COMMON_QUARTER_REST);
    eng_d r = near + low, rest = low - (r - near);
    eng_d square = r * r, half = 0.5 * square, most = 1 - half;
    eng_d sum[2] = {eng_d_all(common_sine_terms[0][0]),
                    eng_d_all(common_sine_terms[0][1])};
#pragma GCC unroll 8
    for (int i = 1; i < COMMON_SINE_TERMS; i++) {
        sum[0] = sum[0] * square + common_sine_terms[i][0];
        sum[1] = sum[1] * square + common_sine_terms[i][1];
    }
    sum[0] = sum[0] * (r * square) + rest * most;
    sum[1] = sum[1] * (square * square) + rest * -r;
    eng_di s = eng_di_of(r + sum[0]);
    eng_di c = eng_di_of(most + (((1 - most) - half) + sum[1]));
    eng_di turn = eng_di_of(rounded); /* its last bits */
    eng_di swaps = -(turn & 1);
    *sine = eng_d_of(((swaps & c) | (~swaps & s)) ^ ((turn & 2) << 62));
    *cosine = eng_d_of(((swaps & s) | (~swaps & c)) ^ (((turn + 1) & 2) << 62));
}

/* Return whether a pose turns nothing: all nine numbers have to say so, as the cosine of
 * a small angle is 1. */
static bool is_shift(const double g[12])
{
    for (int i = 0; i < 12; i++) {
        if (i % 4 != 3 && g[i] != (i % 5 == 0 ? 1 : 0)) {
            return false;
        }
    }
    return true;
}

/* As rotation.h says; a shift alone, as most bodies have between their joints, is no work
 * for nine numbers. */
static inline void multiply(eng_d m[12], const double g[12])
{
    if (is_shift(g)) {
#pragma GCC unroll 3
        for (eng_d *row = m; row < m + 12; row += 4) {
            row[3] = ((row[0] * g[3] + row[1] * g[7]) + row[2] * g[11]) + row[3];
        }
        return;
    }
#pragma GCC unroll 3
    for (eng_d *row = m; row < m + 12; row += 4) {
        eng_d x = row[0], y = row[1], z = row[2];
        row[0] = (x * g[0] + y * g[4]) + z * g[8];
        row[1] = (x * g[1] + y * g[5]) + z * g[9];
        row[2] = ((x * g[2] + y * g[6]) + z * g[10]) + 0.0;
        row[3] = ((x * g[3] + y * g[7]) + z * g[11]) + row[3];
    }
}

/* Set m to the poses at several times, as eng_poses_at has them. */
static void set_poses(struct eng_poses *poses, const double t[ENG_D_LANES], eng_d m[12])
{
    const struct eng_path *path = poses->path;
    bool is_one = true;
    bool has_vectors = false;
    for (uint32_t lane = 1; lane < ENG_D_LANES; lane++) {
        is_one &= t[lane] == t[0];
    }
    for (uint32_t i = 0; i < path->count; i++) {
        has_vectors |= path->joints[i].kind == PCCD_JOINT_VECTOR;
    }
    if (is_one) {
        const double *one = eng_poses_at(poses, t[0])->m;
        for (int i = 0; i < 12; i++) {
            m[i] = eng_d_all(one[i]);
        }
        return;
    }
    if (has_vectors) {
        double at[12][ENG_D_LANES];
        for (uint32_t lane = 0; lane < ENG_D_LANES; lane++) {
            const double *one = eng_poses_at(poses, t[lane])->m;
            for (int i = 0; i < 12; i++) {
                at[i][lane] = one[i];
            }
        }
        for (int i = 0; i < 12; i++) {
            m[i] = eng_d_load(at[i]);
        }
        return;
    }
    const double *first = path->count > 0 ? path->joints[0].before : path->last;
    const eng_d time = eng_d_load(t);
    for (int i = 0; i < 12; i++) {
        m[i] = eng_d_all(first[i]);
    }
    for (uint32_t i = 0; i < path->count; i++) {
        const struct eng_path_joint *joint = &path->joints[i];
        if (i > 0) {
            multiply(m, joint->before);
        }
        if (joint->kind == PCCD_JOINT_TURN) {
            struct value angle = value_at(joint, time);
            eng_d sine, cosine;
            sine_of(&angle, &sine, &cosine);
            for (eng_d *row = m; row < m + 12; row += 4) {
                eng_d x = row[0], y = row[1];
                row[0] = cosine * x + sine * y;
                row[1] = cosine * y + sine * -x;
            }
        } else {
            eng_d dx = time * joint->by[0], dy = time * joint->by[1],
                  dz = time * joint->by[2];
            for (eng_d *row = m; row < m + 12; row += 4) {
                row[3] = ((row[0] * dx + row[1] * dy) + row[2] * dz) + row[3];
            }
        }
    }
    if (path->count > 0) {
        multiply(m, path->last);
    }
}

/* ---- moments and spans ------------------------------------------------------------- */

/* The points of both at one time. */
struct moment {
    eng_d t;
    struct eng_v x[4];
    eng_d error; /* Euclidean, of each point */
    eng_d size;  /* largest coordinate */
};

static void set_moment(const struct group *group, eng_d time, struct moment *moment)
{
    const double *error = group->poses->path->error;
    const eng_d zero = eng_d_all(0);
    double t[ENG_D_LANES];
    eng_d m[12];
    eng_d_store(t, time);
    set_poses(group->poses, t, m);
    moment->t = time;
    moment->size = group->still_size;
    for (uint32_t i = 0; i < 4; i++) {
        const struct eng_v x = group->x[i][0];
        if (i >= group->first_turning && i < group->end_turning) {
            moment->x[i] =
                (struct eng_v){((m[0] * x.x + m[1] * x.y) + m[2] * x.z) + m[3],
                               ((m[4] * x.x + m[5] * x.y) + m[6] * x.z) + m[7],
                               ((m[8] * x.x + m[9] * x.y) + m[10] * x.z) + m[11]};
            moment->size = eng_d_max(moment->size, eng_v_size(moment->x[i]));
        } else {
            moment->x[i] = eng_v_select(group->stands, x,
                                        eng_v_mix(1 - time, x, time, group->x[i][1]));
        }
    }
    eng_dm is_given = eng_dm_or(group->stands, eng_dm_or(eng_d_at_most(time, zero),
                                                         eng_d_at_most(zero + 1, time)));
    moment->error = (error[0] + error[1] * group->turning_size) * (1 + 8 * ENG_U) +
                    eng_d_select(is_given, zero, group->still_error);
}

/* The motion of features that go straight between two moments, and how far from them the
 * true ones are. */
struct passage {
    eng_d length; /* rounded up */
    eng_d bent;   /* how far off their chords points are */
    eng_d eps;    /* that and the errors at the ends */
    struct eng_pose_lanes pose[2];
    eng_d size_p, size_b, size_c; /* scaled by a power of two, as poses are */
    eng_d e_det;                  /* |computed - true| of det and of each coefficient */
    eng_d scale;
    eng_d reach;    /* eps, and a little more, as the motion is scaled */
    eng_d f[4];     /* Bernstein coefficients of det[p, b, c] */
    eng_d height;   /* where |det| is more, both planes are farther apart than reach */
    eng_d edge;     /* and at either end, where points are on their chords */
    eng_dm crosses; /* f certainly changes its sign */
};

ENG_INLINE struct eng_pose_lanes differences_of(enum pccd_kind kind,
                                                const struct eng_v x[4])
{
    return kind == PCCD_VF
               ? (struct eng_pose_lanes){eng_v_sub(x[0], x[1]), eng_v_sub(x[2], x[1]),
                                         eng_v_sub(x[3], x[1])}
               : (struct eng_pose_lanes){eng_v_sub(x[2], x[0]), eng_v_sub(x[1], x[0]),
                                         eng_v_sub(x[2], x[3])};
}

ENG_INLINE void set_span(const struct group *group, const struct moment *l,
                         const struct moment *r, struct passage *passage)
{
    const eng_d zero = eng_d_all(0);
    passage->length = (r->t - l->t) * (1 + 2 * ENG_U);
    passage->bent =
        group->bend * passage->length * passage->length * (0.125 + 2 * ENG_U) +
        eng_d_select(eng_d_less(zero, group->bend), zero + ENG_TINY, zero);
    passage->eps = (passage->bent + eng_d_max(l->error, r->error)) * (1 + 4 * ENG_U);
}

/* Return the power of two by which vectors are scaled whose largest coordinate is `size`
 * (motion.c). */
ENG_INLINE eng_d scale_of(eng_d size)
{
    const eng_d zero = eng_d_all(0);
    const eng_di exponent = eng_di_of(size) >> 52;
    eng_d scale = eng_d_of((2045 - exponent) << 52); /* 2^-e, if size is below 2^e */
    scale = eng_d_min(scale, zero + 0x1p1000);
    eng_dm is_far =
        eng_dm_or(eng_d_less(zero + 2, size), eng_d_less(size, zero + 0x1p-150));
    return eng_d_select(eng_dm_and(is_far, eng_d_less(zero, size)), scale, zero + 1);
}

ENG_INLINE void scale_pose(struct eng_pose_lanes *pose, eng_d scale)
{
    pose->p = eng_v_scale(scale, pose->p);
    pose->b = eng_v_scale(scale, pose->b);
    pose->c = eng_v_scale(scale, pose->c);
}

/* Largest magnitude of each coordinate. */
ENG_INLINE struct eng_v reach_at_ends(struct eng_v a, struct eng_v b)
{
    return (struct eng_v){eng_d_max_abs(a.x, b.x), eng_d_max_abs(a.y, b.y),
                          eng_d_max_abs(a.z, b.z)};
}

/* Set the motion, its cubic, and the most that |b x c| is (motion.c). */
ENG_INLINE eng_d set_cubic(struct passage *passage)
{
    const struct eng_pose_lanes *l = &passage->pose[0], *r = &passage->pose[1];
    struct eng_v n00 = eng_v_cross(l->b, l->c);
    struct eng_v n11 = eng_v_cross(r->b, r->c);
    struct eng_v n01 = eng_v_add(eng_v_cross(l->b, r->c), eng_v_cross(r->b, l->c));
    eng_d *f = passage->f;
    f[0] = eng_v_dot(l->p, n00);
    f[1] = (eng_v_dot(r->p, n00) + eng_v_dot(l->p, n01)) / 3.0;
    f[2] = (eng_v_dot(l->p, n11) + eng_v_dot(r->p, n01)) / 3.0;
    f[3] = eng_v_dot(r->p, n11);
    return eng_d_sqrt(eng_d_max(
        eng_v_dot(n00, n00), eng_d_max(0.25 * eng_v_dot(n01, n01), eng_v_dot(n11, n11))));
}

/* Set all of a passage between two moments. */
ENG_INLINE void set_passage(enum pccd_kind kind, const struct group *group,
                            const struct moment *l, const struct moment *r,
                            struct passage *passage)
{
    struct eng_pose_lanes *pose = passage->pose;
    set_span(group, l, r, passage);
    pose[0] = differences_of(kind, l->x);
    pose[1] = differences_of(kind, r->x);
    struct eng_v p = reach_at_ends(pose[0].p, pose[1].p);
    struct eng_v b = reach_at_ends(pose[0].b, pose[1].b);
    struct eng_v c = reach_at_ends(pose[0].c, pose[1].c);
    const eng_d size = eng_d_max(eng_v_size(p), eng_d_max(eng_v_size(b), eng_v_size(c)));
    const eng_d scale = scale_of(size);
    scale_pose(&pose[0], scale);
    scale_pose(&pose[1], scale);
    p = eng_v_scale(scale, p);
    b = eng_v_scale(scale, b);
    c = eng_v_scale(scale, c);
    passage->scale = scale;
    passage->size_p = eng_v_size(p);
    passage->size_b = eng_v_size(b);
    passage->size_c = eng_v_size(c);
    passage->e_det = 25 * ENG_U *
                         (p.x * (b.y * c.z + b.z * c.y) + p.y * (b.z * c.x + b.x * c.z) +
                          p.z * (b.x * c.y + b.y * c.x)) +
                     ENG_TINY;
    eng_d across = set_cubic(passage);
    across = across * (1 + 8 * ENG_U) + 32 * ENG_U * passage->size_b * passage->size_c;
    passage->reach = (passage->eps * (1 + 4 * ENG_U) + ENG_TINY) * scale;
    passage->height = passage->reach * across * (1 + 8 * ENG_U) + 4 * passage->e_det;
    const eng_d error = eng_d_max(l->error, r->error);
    passage->edge =
        (error * (1 + 8 * ENG_U) + ENG_TINY) * scale * across * (1 + 8 * ENG_U) +
        4 * passage->e_det;
    const eng_d zero = eng_d_all(0);
    const eng_d *f = passage->f;
    const eng_dm is_below[2] = {eng_d_less(f[0], zero), eng_d_less(f[3], zero)};
    passage->crosses =
        eng_dm_and(eng_dm_and(eng_d_less(passage->e_det, eng_d_abs(f[0])),
                              eng_d_less(passage->e_det, eng_d_abs(f[3]))),
                   eng_dm_or(eng_dm_and(is_below[0], eng_dm_not(is_below[1])),
                             eng_dm_and(is_below[1], eng_dm_not(is_below[0]))));
}

/* ---- the planes across both -------------------------------------------------------- */

/* Return the part of a span up to which a cubic is certainly positive, which is so at its
 * begin; 1: throughout. It is not below the line from the first of its coefficients to
 * that of the others to which it falls fastest, nor is what is left of it behind. */
ENG_INLINE eng_d positive_until(eng_d h[4])
{
    const eng_d zero = eng_d_all(0), one = zero + 1;
    eng_d until = zero;
    eng_dm goes_on = eng_d_less(zero, h[0]);
    eng_dm is_all = eng_dm_and(goes_on, eng_dm_not(goes_on)); /* none */
    for (int cut = 0; eng_dm_bits(goes_on) != 0; cut++) {
        eng_dm now =
            eng_dm_and(goes_on, eng_d_less(zero, eng_d_min(h[1], eng_d_min(h[2], h[3]))));
        is_all = eng_dm_or(is_all, now);
        goes_on = eng_dm_and(goes_on, eng_dm_not(now));
        eng_d part = one;
#pragma GCC unroll 3
        for (int i = 1; i < 4; i++) {
            eng_d there = (i / 3.0) * (h[0] / (h[0] - h[i]));
            part = eng_d_select(eng_d_less(h[i], h[0]), eng_d_min(part, there), part);
        }
        until = eng_d_select(goes_on, until + (1 - until) * part, until);
        if (cut == CUTS) {
            break;
        }
#pragma GCC unroll 3
        for (int level = 3; level > 0; level--) {
#pragma GCC unroll 3
            for (int i = 0; i < level; i++) {
                h[i] += part * (h[i + 1] - h[i]);
            }
        }
        goes_on = eng_dm_and(goes_on, eng_d_less(zero, h[0]));
    }
    return eng_d_select(is_all, one, until * (1 - 16 * ENG_U));
}

/* Return the part of a span up to which the planes across both features are certainly
 * apart, from its begin, or backwards from its end; 1: throughout. Points leave their
 * chords by at most a parabola: as a cubic it has the coefficients 0, 4/3, 4/3 and 0. */
ENG_INLINE eng_d apart_until(const struct passage *passage, bool backwards)
{
    eng_d f[4];
    const eng_d zero = eng_d_all(0);
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        f[i] = passage->f[backwards ? 3 - i : i];
    }
    const eng_d most = passage->e_det * (1 / (32 * ENG_U));
    eng_d bow = 4 / 3.0 * (passage->height - passage->edge) * (1 + 8 * ENG_U);
    /* More than all of det, about: */
    eng_dm is_low = eng_d_at_most(passage->edge + bow, most);
    eng_d edge = eng_d_select(is_low, passage->edge, passage->height);
    bow = eng_d_select(is_low, bow, zero);
    eng_dm is_below = eng_d_less(f[0], zero);
    eng_d h[4];
#pragma GCC unroll 4
    for (int i = 0; i < 4; i++) {
        h[i] = eng_d_select(is_below, -f[i], f[i]) - (edge + (i % 3 == 0 ? zero : bow));
    }
    return positive_until(h);
}

/* Return the roots of the cubics that `crosses` has (eng_bernstein_root). */
ENG_INLINE eng_d root_of(const eng_d f[4], eng_dm crosses)
{
    const eng_d zero = eng_d_all(0), one = zero + 1;
    eng_d c1 = 3 * (f[1] - f[0]);
    eng_d c2 = 3 * (f[2] - 2 * f[1] + f[0]);
    eng_d c3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    eng_d low = zero;
    eng_d high = one;
    eng_dm rises = eng_d_less(f[0], f[3]);
    eng_dm goes_on = crosses;
    eng_d s = f[0] / (f[0] - f[3]);
    for (int i = 0; i < 60 && eng_dm_bits(goes_on) != 0; i++) {
        eng_d value = f[0] + s * (c1 + s * (c2 + s * c3));
        eng_d slope = c1 + s * (2 * c2 + s * (3 * c3));
        eng_dm is_below = eng_d_less(value, zero);
        eng_dm is_early = eng_dm_or(eng_dm_and(is_below, rises),
                                    eng_dm_and(eng_dm_not(is_below), eng_dm_not(rises)));
        goes_on = eng_dm_and(goes_on, eng_d_less(zero, eng_d_abs(value)));
        low = eng_d_select(is_early, s, low);
        high = eng_d_select(is_early, high, s);
        eng_d next = s - value / slope;
        next = eng_d_select(eng_dm_and(eng_d_less(low, next), eng_d_less(next, high)),
                            next, 0.5 * (low + high));
        goes_on = eng_dm_and(goes_on, eng_d_less(zero + 0x1p-52, eng_d_abs(next - s)));
        s = eng_d_select(goes_on, next, s);
    }
    return s;
}

ENG_INLINE struct eng_pose_lanes pose_between(const struct passage *passage, eng_d t)
{
    const struct eng_pose_lanes *l = &passage->pose[0], *r = &passage->pose[1];
    const eng_d s = 1.0 - t;
    return (struct eng_pose_lanes){eng_v_mix(s, l->p, t, r->p),
                                   eng_v_mix(s, l->b, t, r->b),
                                   eng_v_mix(s, l->c, t, r->c)};
}

/* Return whether the planes across both features cross within both, as far as doubles can
 * tell. */
ENG_INLINE eng_dm cross_inside(enum pccd_kind kind, const struct eng_pose_lanes *pose)
{
    const eng_d zero = eng_d_all(0);
    struct eng_v n = eng_v_cross(pose->b, pose->c);
    eng_d nn = eng_v_dot(n, n);
    eng_d beta = eng_v_dot(eng_v_cross(pose->p, pose->c), n);
    eng_d gamma = eng_v_dot(eng_v_cross(pose->b, pose->p), n);
    eng_d most = eng_d_max(beta, gamma);
    if (kind == PCCD_VF) {
        most = beta + gamma;
    }
    return eng_dm_and(eng_dm_and(eng_d_less(zero, beta), eng_d_less(zero, gamma)),
                      eng_d_less(most, nn));
}

/* Widen [low, high] by d . (p - beta b - gamma c) at the corners of the domain. */
ENG_INLINE void project(enum pccd_kind kind, const struct eng_pose_lanes *pose,
                        struct eng_v d, eng_d *low, eng_d *high)
{
    eng_d p = eng_v_dot(d, pose->p);
    eng_d b = eng_v_dot(d, pose->b);
    eng_d c = eng_v_dot(d, pose->c);
    eng_d corner[4] = {p, p - b, p - c, p - b - c};
    const int corners = kind == PCCD_VF ? 3 : 4;
#pragma GCC unroll 4
    for (int i = 0; i < corners; i++) {
        *low = eng_d_min(corner[i], *low);
        *high = eng_d_max(corner[i], *high);
    }
}

/* Return whether the features certainly stay apart while their planes are not, which are
 * up to `part`: along the direction that is between them at a pose, as
 * eng_motion_separates does. */
ENG_INLINE eng_dm separates(enum pccd_kind kind, const struct passage *passage,
                            eng_d part, const struct eng_pose_lanes *when)
{
    const eng_d zero = eng_d_all(0);
    struct eng_pose_lanes begin = pose_between(passage, part);
    struct eng_pose_lanes end = pose_between(passage, 1 - apart_until(passage, true));
    struct eng_nearest_gap nearest = eng_nearest_gap_of(kind, when);
    const struct eng_v d = nearest.gap;
    eng_d low = zero + INFINITY;
    eng_d high = zero - INFINITY;
    project(kind, &begin, d, &low, &high);
    project(kind, &end, d, &low, &high);
    eng_d margin =
        32 * ENG_U * (eng_d_abs(d.x) + eng_d_abs(d.y) + eng_d_abs(d.z)) *
            (passage->size_p + passage->size_b + passage->size_c) +
        passage->reach * (eng_d_sqrt(eng_v_dot(d, d)) * (1 + 8 * ENG_U) + 0x1p-500) +
        ENG_TINY;
    return eng_dm_or(eng_d_less(margin, low), eng_d_less(high, -margin));
}

/* ---- a span ------------------------------------------------------------------------ */

/* Return whether an axis keeps the features farther apart than that, at both ends. */
ENG_INLINE eng_dm are_apart(enum pccd_kind kind, const struct moment *l,
                            const struct moment *r, eng_d reach)
{
    const eng_d far = eng_d_all(INFINITY);
    eng_d most = -far;
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        eng_d above = far;
        eng_d below = far;
#pragma GCC unroll 2
        for (int end = 0; end < 2; end++) {
            const struct eng_v *v = end == 0 ? l->x : r->x;
            eng_d x[4];
#pragma GCC unroll 4
            for (int i = 0; i < 4; i++) {
                x[i] = k == 0 ? v[i].x : k == 1 ? v[i].y : v[i].z;
            }
            const bool is_ee = kind == PCCD_EE;
            eng_d low_a = is_ee ? eng_d_min(x[0], x[1]) : x[0];
            eng_d high_a = is_ee ? eng_d_max(x[0], x[1]) : x[0];
            eng_d low_b = eng_d_min(x[2], x[3]);
            eng_d high_b = eng_d_max(x[2], x[3]);
            low_b = is_ee ? low_b : eng_d_min(low_b, x[1]);
            high_b = is_ee ? high_b : eng_d_max(high_b, x[1]);
            above = eng_d_min(above, low_a - high_b);
            below = eng_d_min(below, low_b - high_a);
        }
        most = eng_d_max(most, eng_d_max(above, below));
    }
    return eng_d_less(reach, most);
}

/* Return the most that a coordinate of a turning point changes between two moments. */
ENG_INLINE eng_d way_of(const struct group *group, const struct moment *l,
                        const struct moment *r)
{
    eng_d way = eng_d_all(0);
    for (uint32_t i = group->first_turning; i < group->end_turning; i++) {
        way = eng_d_max(way, eng_v_size(eng_v_sub(r->x[i], l->x[i])));
    }
    return way;
}

ENG_INLINE void look_at(enum pccd_kind kind, struct group *group)
{
    const eng_d zero = eng_d_all(0);
    const eng_d size_most = zero + ENG_PASSAGE_SIZE;
    const eng_d delta = EACH(group, delta);
    struct moment l, r;
    struct passage passage;
    set_moment(group, EACH(group, l), &l);
    set_moment(group, EACH(group, r), &r);
    set_passage(kind, group, &l, &r, &passage);
    const eng_d size = eng_d_max(l.size, r.size);
    const eng_d precision =
        eng_d_max(delta, eng_d_max(4 * eng_d_max(l.error, r.error),
                                   0x1p-44 * size)); /* eng_turning_delta_least */
    /* The errors at its ends would be most of a shorter one's eps, too. */
    const eng_dm is_short =
        eng_dm_and(eng_d_at_most(passage.length, EACH(group, tolerance)),
                   eng_d_at_most(passage.bent, passage.eps - passage.bent));
    const eng_dm is_leaf =
        eng_dm_and(eng_d_at_most(passage.eps, precision),
                   eng_dm_or(is_short, eng_d_less(zero, EACH(group, is_possible))));
    const eng_d reach = passage.eps * (1 + 4 * ENG_U);
    eng_dm is_known = eng_d_at_most(reach, size_most);
    const eng_dm is_apart =
        eng_dm_and(is_known, are_apart(kind, &l, &r, reach * (1 + 4 * ENG_U)));
    const eng_dm is_bent =
        eng_dm_and(eng_d_less(delta, passage.bent),
                   eng_d_less(ENG_PASSAGE_BENT * way_of(group, &l, &r), passage.bent));
    is_known = eng_dm_and(is_known, eng_dm_or(is_leaf, eng_dm_not(is_bent)));
    const eng_d part = apart_until(&passage, false);
    const eng_dm is_free = eng_dm_and(is_known, eng_d_at_most(zero + 1, part));
    const eng_d until =
        eng_d_select(eng_d_at_most(part, zero), l.t,
                     eng_d_max(l.t, l.t + (r.t - l.t) * part - 4 * ENG_U));
    const eng_dm goes_on = eng_dm_and(eng_dm_and(passage.crosses, eng_d_less(zero, part)),
                                      eng_dm_not(is_leaf));
    const eng_d root = root_of(passage.f, passage.crosses);
    struct eng_pose_lanes then =
        pose_between(&passage, eng_d_select(passage.crosses, root, zero + 0.5));
    const eng_dm is_inside = eng_dm_and(goes_on, cross_inside(kind, &then));
    const uint32_t asked =
        eng_dm_bits(eng_dm_and(eng_dm_and(is_known, eng_dm_not(is_free)),
                               eng_dm_not(eng_dm_or(is_inside, is_apart))));
    const uint32_t separated =
        asked != 0 ? asked & eng_dm_bits(separates(kind, &passage, part, &then)) : 0;

    const uint32_t free = separated | eng_dm_bits(eng_dm_or(is_apart, is_free));
    const uint32_t known = eng_dm_bits(is_known);
    const uint32_t near = eng_dm_bits(goes_on);
    const uint32_t leaf = eng_dm_bits(is_leaf);
    const uint32_t inside = eng_dm_bits(is_inside);
    const uint32_t beyond = ~eng_dm_bits(eng_d_at_most(size, size_most));
    STORE(group, until, eng_d_select(is_known, until, l.t));
    STORE(group, precision, precision);
    STORE(group, middle, eng_d_select(passage.crosses, root, zero - 1));
    STORE(group, scale, passage.scale);
    for (int i = 0; i < 4; i++) {
        STORE(group, f[i], passage.f[i]);
    }
    for (uint32_t lane = 0; lane < group->count; lane++) {
        struct eng_passage *one = group->one[lane];
        one->seen = free >> lane & 1       ? ENG_SEEN_FREE
                    : !(known >> lane & 1) ? ENG_SEEN_CUT
                    : near >> lane & 1     ? ENG_SEEN_NEAR
                                           : ENG_SEEN_OPEN;
        one->is_leaf = leaf >> lane & 1;
        one->is_inside = inside >> lane & 1;
        one->is_beyond |= beyond >> lane & 1;
    }
}

static void look(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                 struct eng_passage *const *some, uint32_t count)
{
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        struct group group;
        begin_group(&group, poses, kind, turning, some + i, count - i);
        if (kind == PCCD_VF) {
            look_at(PCCD_VF, &group);
        } else {
            look_at(PCCD_EE, &group);
        }
    }
}

/* ---- a window ---------------------------------------------------------------------- */

/* Vectors over a span: their middle, its largest coordinate, and that of all of them. A
 * linear function is within half its change of the mean of its ends. */
struct reach {
    struct eng_v middle;
    eng_d size;
    eng_d high;
};

ENG_INLINE struct reach reach_of(struct eng_v l, struct eng_v r, eng_d size)
{
    struct reach reach;
    reach.middle = eng_v_scale(eng_d_all(0.5), eng_v_add(l, r));
    reach.size = eng_v_size(reach.middle);
    reach.high = reach.size + (0.5 * eng_v_size(eng_v_sub(r, l)) + 16 * ENG_U * size);
    return reach;
}

/* Return where the domain holds strictly, with independent b and c, at all times, and no
 * vertex comes within reach of an edge of the other feature (eng_motion_domain). */
ENG_INLINE eng_dm stays_inside(enum pccd_kind kind, const struct passage *passage)
{
    const struct eng_pose_lanes *lp = &passage->pose[0], *rp = &passage->pose[1];
    struct reach p = reach_of(lp->p, rp->p, passage->size_p);
    struct reach b = reach_of(lp->b, rp->b, passage->size_b);
    struct reach c = reach_of(lp->c, rp->c, passage->size_c);
    struct eng_v n = eng_v_cross(b.middle, c.middle);
    eng_d nn = eng_v_dot(n, n);
    eng_d beta = eng_v_dot(eng_v_cross(p.middle, c.middle), n); /* times nn */
    eng_d gamma = eng_v_dot(eng_v_cross(b.middle, p.middle), n);

    /* A product of four vectors, twelve terms each: what the radii add, then rounding. */
    eng_d bc = b.size * c.size;
    eng_d high_bc = b.high * c.high;
    eng_d grown = high_bc * p.high;
    eng_d base = bc * p.size;
    eng_d e_beta =
        12 * (grown * c.high - base * c.size) + 256 * ENG_U * grown * c.high + ENG_TINY;
    eng_d e_gamma =
        12 * (grown * b.high - base * b.size) + 256 * ENG_U * grown * b.high + ENG_TINY;
    eng_d e_nn =
        12 * (high_bc * high_bc - bc * bc) + 256 * ENG_U * high_bc * high_bc + ENG_TINY;
    e_beta += RIM * passage->reach * high_bc * c.high;
    e_gamma += RIM * passage->reach * high_bc * b.high;
    eng_dm inside = eng_dm_and(eng_d_less(e_beta, beta), eng_d_less(e_gamma, gamma));
    if (kind == PCCD_VF) {
        eng_d e_rest = e_nn + e_beta + e_gamma +
                       4 * ENG_U * (nn + eng_d_abs(beta) + eng_d_abs(gamma));
        return eng_dm_and(inside, eng_d_less(e_rest, nn - beta - gamma));
    }
    eng_d e_rest_beta = e_nn + e_beta + 4 * ENG_U * (nn + eng_d_abs(beta));
    eng_d e_rest_gamma = e_nn + e_gamma + 4 * ENG_U * (nn + eng_d_abs(gamma));
    return eng_dm_and(inside, eng_dm_and(eng_d_less(e_rest_beta, nn - beta),
                                         eng_d_less(e_rest_gamma, nn - gamma)));
}

/* Return whether features certainly meet in a window, from which *side. */
ENG_INLINE eng_dm proves(enum pccd_kind kind, struct group *group, const struct moment *l,
                         const struct moment *r, eng_d *side)
{
    struct passage window;
    set_passage(kind, group, l, r, &window);
    *side = window.f[0];
    eng_dm is_high = eng_dm_and(eng_d_less(window.height, eng_d_abs(window.f[0])),
                                eng_d_less(window.height, eng_d_abs(window.f[3])));
    eng_dm is_small = eng_d_at_most(window.eps, eng_d_all(ENG_PASSAGE_SIZE));
    return eng_dm_and(eng_dm_and(is_small, window.crosses),
                      eng_dm_and(is_high, stays_inside(kind, &window)));
}

static void set_met(struct group *group, eng_dm is_met, eng_d side, eng_d size)
{
    const uint32_t met = eng_dm_bits(is_met);
    const uint32_t beyond =
        ~eng_dm_bits(eng_d_at_most(size, eng_d_all(ENG_PASSAGE_SIZE)));
    double sides[ENG_D_LANES];
    eng_d_store(sides, side);
    for (uint32_t lane = 0; lane < group->count; lane++) {
        struct eng_passage *one = group->one[lane];
        one->is_met = met >> lane & 1;
        one->side = one->is_met ? sides[lane] : one->side;
        one->is_beyond |= beyond >> lane & 1;
    }
}

/* Return where planes cross, about: better than where those of straight features do, at
 * the part `at` of the span. The true determinant differs from the cubic by a parabola,
 * nearly, which is 0 at both ends; then by a line. *size: the largest coordinate that was
 * seen. */
ENG_INLINE eng_d refine(enum pccd_kind kind, struct group *group, eng_d l, eng_d r,
                        eng_d *size)
{
    const eng_d zero = eng_d_all(0), one = zero + 1;
    const eng_d scale = EACH(group, scale);
    eng_d at = EACH(group, middle);
    eng_d f[4];
    for (int i = 0; i < 4; i++) {
        f[i] = EACH(group, f[i]);
    }
    const eng_d c1 = 3 * (f[1] - f[0]);
    const eng_d c2 = 3 * (f[2] - 2 * f[1] + f[0]);
    const eng_d c3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    eng_d parabola = zero;
    eng_d slope = zero;
    eng_dm goes_on = eng_d_less(zero, one);
    for (int i = 0; i < REFINEMENTS; i++) {
        struct moment moment;
        set_moment(group, eng_d_select(goes_on, l + (r - l) * at, l), &moment);
        *size = eng_d_max(*size, moment.size);
        struct eng_pose_lanes pose = differences_of(kind, moment.x);
        const eng_d det =
            scale * scale * scale * eng_v_dot(pose.p, eng_v_cross(pose.b, pose.c));
        if (i == 0) {
            parabola = det / (at * (1 - at));
            slope = c1 + at * (2 * c2 + at * (3 * c3)) + parabola * (1 - 2 * at);
        }
        eng_d next = at - det / slope;
        goes_on = eng_dm_and(goes_on,
                             eng_dm_and(eng_d_less(zero, next), eng_d_less(next, one)));
        if (i == 0) { /* once more, on the parabola */
            const eng_d value = f[0] + next * (c1 + next * (c2 + next * c3)) +
                                parabola * next * (1 - next);
            slope = c1 + next * (2 * c2 + next * (3 * c3)) + parabola * (1 - 2 * next);
            next = next - value / slope;
        }
        at = eng_d_select(goes_on, next, at);
        goes_on =
            eng_dm_and(goes_on, eng_dm_and(eng_d_less(zero, at), eng_d_less(at, one)));
    }
    return l + (r - l) * at;
}

ENG_INLINE void cross_at(enum pccd_kind kind, struct group *group)
{
    const eng_d zero = eng_d_all(0);
    const eng_d l = EACH(group, l), r = EACH(group, r);
    const eng_d reach = 0.25 * EACH(group, tolerance);
    struct moment from, to, begin;
    struct passage before;
    eng_d size = zero;
    eng_d side;
    const eng_d middle = refine(kind, group, l, r, &size);
    set_moment(group, eng_d_max(middle - reach, zero), &from);
    set_moment(group, eng_d_min(middle + reach, zero + 1), &to);
    size = eng_d_max(size, eng_d_max(from.size, to.size));
    eng_dm is_met =
        eng_dm_and(eng_dm_and(eng_d_less(zero + 2 * ENG_U, reach),
                              eng_d_less(to.t - from.t, (r - l) * (1 + 2 * ENG_U))),
                   proves(kind, group, &from, &to, &side));
    const eng_dm is_within = eng_dm_and(eng_d_less(l, from.t), eng_d_less(from.t, r));
    set_moment(group, l, &begin);
    set_passage(kind, group, &begin, &from, &before);
    const eng_dm is_free =
        eng_dm_and(eng_dm_and(is_met, is_within),
                   eng_d_at_most(zero + 1, apart_until(&before, false)));
    STORE(group, from, from.t);
    STORE(group, to, to.t);
    const eng_d until = EACH(group, until);
    STORE(group, until, eng_d_select(is_free, from.t, until));
    set_met(group, is_met, side, size);
}

static void cross(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                  struct eng_passage *const *some, uint32_t count)
{
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        struct group group;
        begin_group(&group, poses, kind, turning, some + i, count - i);
        if (kind == PCCD_VF) {
            cross_at(PCCD_VF, &group);
        } else {
            cross_at(PCCD_EE, &group);
        }
    }
}

static void prove(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                  struct eng_passage *const *some, uint32_t count)
{
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        struct group group;
        struct moment from, to;
        eng_d side;
        begin_group(&group, poses, kind, turning, some + i, count - i);
        set_moment(&group, EACH(&group, from), &from);
        set_moment(&group, EACH(&group, to), &to);
        const eng_dm is_met = kind == PCCD_VF
                                  ? proves(PCCD_VF, &group, &from, &to, &side)
                                  : proves(PCCD_EE, &group, &from, &to, &side);
        set_met(&group, is_met, side, eng_d_max(from.size, to.size));
    }
}

/* ---- a moment ---------------------------------------------------------------------- */

/* Return the direction in which the planes lie from each other before a contact: as
 * eng_motion_describe does at its begin. */
ENG_INLINE struct eng_v normal_of(enum pccd_kind kind, const struct eng_v x[4],
                                  eng_d side)
{
    const eng_d zero = eng_d_all(0), one = zero + 1;
    struct eng_pose_lanes pose = differences_of(kind, x);
    scale_pose(&pose,
               scale_of(eng_d_max(eng_v_size(pose.p),
                                  eng_d_max(eng_v_size(pose.b), eng_v_size(pose.c)))));
    const eng_d from_b_to_a = kind == PCCD_VF ? one : -one;
    struct eng_v n = eng_v_cross(pose.b, pose.c);
    eng_d sign = eng_d_select(eng_d_less(side, zero), -from_b_to_a, from_b_to_a);
    const eng_dm is_sure = eng_d_less(
        0x1p-80 * eng_v_dot(pose.b, pose.b) * eng_v_dot(pose.c, pose.c), eng_v_dot(n, n));
    if (eng_dm_bits(is_sure) != ENG_D_ALL) {
        n = eng_v_select(is_sure, n, eng_nearest_gap_of(kind, &pose).gap);
        sign = eng_d_select(is_sure, sign, from_b_to_a);
    }
    const eng_d size = eng_v_size(n);
    const eng_dm is_none = eng_d_at_most(size, zero);
    n = (struct eng_v){n.x / size, n.y / size, n.z / size};
    n = eng_v_scale(sign / eng_d_sqrt(eng_v_dot(n, n)), n);
    return eng_v_select(is_none, (struct eng_v){zero, zero, zero}, n);
}

static void place(struct eng_poses *poses, enum pccd_kind kind, uint32_t turning,
                  struct eng_passage *const *some, uint32_t count,
                  struct eng_point (*points)[4])
{
    for (uint32_t i = 0; i < count; i += ENG_D_LANES) {
        struct group group;
        struct moment moment;
        struct eng_v normal;
        double x[4][3][ENG_D_LANES];
        float along[3][ENG_D_LANES];
        begin_group(&group, poses, kind, turning, some + i, count - i);
        set_moment(&group, EACH(&group, at), &moment);
        if (kind == PCCD_VF) {
            normal = normal_of(PCCD_VF, moment.x, EACH(&group, side));
        } else {
            normal = normal_of(PCCD_EE, moment.x, EACH(&group, side));
        }
        for (int corner = 0; corner < 4; corner++) {
            eng_d_store(x[corner][0], moment.x[corner].x);
            eng_d_store(x[corner][1], moment.x[corner].y);
            eng_d_store(x[corner][2], moment.x[corner].z);
        }
        eng_d_quantised(along[0], normal.x);
        eng_d_quantised(along[1], normal.y);
        eng_d_quantised(along[2], normal.z);
        for (uint32_t lane = 0; lane < group.count; lane++) {
            for (int k = 0; k < 3; k++) {
                for (int corner = 0; corner < 4; corner++) {
                    struct eng_point *point = &points[i + lane][corner];
                    point->x0[k] = point->x1[k] = x[corner][k][lane];
                }
                some[i + lane]->normal[k] = along[k][lane];
            }
        }
    }
}

const struct eng_passage_calls ENG_PASSAGE(ENG_ISA) = {
    .look = look, .cross = cross, .prove = prove, .place = place};
