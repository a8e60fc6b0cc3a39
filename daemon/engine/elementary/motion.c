/* motion.c - the three difference vectors of a query over time, with bounds.
 *
 * Source: every constant times u is derived in BOUNDS.md.
 */
#include "motion.h"

#include <stdbool.h>
#include <string.h>

#include "nearest_points.h"
#include "vec.h"

static void scale(double (*v)[3], double factor)
{
    for (int i = 0; i < 6; i++) {
        v[i / 3][i % 3] *= factor;
    }
}

static double size_of(double (*v)[3])
{
    return eng_most(eng_size(v[0]), eng_size(v[1]));
}

/* Largest magnitude of each coordinate. */
static void reach_at_ends(double out[3], double (*v)[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = eng_most(fabs(v[0][k]), fabs(v[1][k]));
    }
}

/* No determinant of vectors within these coordinates has larger products in sum. */
static double sum_of_terms(struct eng_motion *motion)
{
    double p[3];
    double b[3];
    double c[3];
    reach_at_ends(p, motion->p);
    reach_at_ends(b, motion->b);
    reach_at_ends(c, motion->c);
    return p[0] * (b[1] * c[2] + b[2] * c[1]) + p[1] * (b[2] * c[0] + b[0] * c[2]) +
           p[2] * (b[0] * c[1] + b[1] * c[0]);
}

void eng_motion_init(struct eng_motion *motion, const struct eng_query *query)
{
    motion->kind = query->kind;
    for (int end = 0; end < 2; end++) {
        const double(*x)[3] = query->x[end];
        if (query->kind == PCCD_VF) {
            eng_sub(motion->p[end], x[0], x[1]);
            eng_sub(motion->b[end], x[2], x[1]);
            eng_sub(motion->c[end], x[3], x[1]);
        } else {
            eng_sub(motion->p[end], x[2], x[0]);
            eng_sub(motion->b[end], x[1], x[0]);
            eng_sub(motion->c[end], x[2], x[3]);
        }
    }
    motion->size_p = size_of(motion->p);
    motion->size_b = size_of(motion->b);
    motion->size_c = size_of(motion->c);
    double size = eng_most(motion->size_p, eng_most(motion->size_b, motion->size_c));
    motion->scale = 1;
    if (size > 0 && (size > 2 || size < 0x1p-150)) {
        /* Products of up to eight factors must neither overflow nor lose bits below the
         * normal range. A power of two changes no bit of what stays normal. */
        int exponent;
        frexp(size, &exponent);
        motion->scale = ldexp(1.0, exponent > -1000 ? -exponent : 1000);
        scale(motion->p, motion->scale);
        scale(motion->b, motion->scale);
        scale(motion->c, motion->scale);
        motion->size_p *= motion->scale;
        motion->size_b *= motion->scale;
        motion->size_c *= motion->scale;
    }
    motion->e_det = 25 * ENG_U * sum_of_terms(motion) + ENG_TINY;
}

static void lerp(double out[3], const double (*v)[3], double s, double t)
{
    out[0] = s * v[0][0] + t * v[1][0];
    out[1] = s * v[0][1] + t * v[1][1];
    out[2] = s * v[0][2] + t * v[1][2];
}

void eng_motion_pose(const struct eng_motion *motion, double t, struct eng_pose *pose)
{
    double s = 1.0 - t;
    lerp(pose->p, motion->p, s, t);
    lerp(pose->b, motion->b, s, t);
    lerp(pose->c, motion->c, s, t);
}

double eng_pose_det(const struct eng_pose *pose)
{
    double n[3];
    eng_cross(n, pose->b, pose->c);
    return eng_dot(pose->p, n);
}

void eng_motion_bernstein(const struct eng_pose *l, const struct eng_pose *r, double f[4])
{
    double n_l[3], n_r[3], n_lr[3], n_rl[3], across[3];
    eng_cross(n_l, l->b, l->c);
    eng_cross(n_r, r->b, r->c);
    eng_cross(n_lr, l->b, r->c);
    eng_cross(n_rl, r->b, l->c);
    for (int k = 0; k < 3; k++) {
        across[k] = n_lr[k] + n_rl[k];
    }
    f[0] = eng_dot(l->p, n_l);
    f[1] = (eng_dot(r->p, n_l) + eng_dot(l->p, across)) / 3.0;
    f[2] = (eng_dot(l->p, n_r) + eng_dot(r->p, across)) / 3.0;
    f[3] = eng_dot(r->p, n_r);
}

double eng_bernstein_root(const double f[4], double *slope)
{
    /* Monomial form: f(s) = f0 + s (c1 + s (c2 + s c3)). */
    double c1 = 3 * (f[1] - f[0]);
    double c2 = 3 * (f[2] - 2 * f[1] + f[0]);
    double c3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    double low = 0;
    double high = 1;
    bool rises = f[0] < f[3];
    double s = f[0] / (f[0] - f[3]);
    for (int i = 0; i < 60; i++) {
        double value = f[0] + s * (c1 + s * (c2 + s * c3));
        *slope = c1 + s * (2 * c2 + s * (3 * c3));
        if (value == 0) {
            break;
        }
        if ((value < 0) == rises) {
            low = s;
        } else {
            high = s;
        }
        double next = s - value / *slope;
        if (!(next > low && next < high)) {
            next = 0.5 * (low + high);
        }
        if (fabs(next - s) <= 0x1p-52) {
            break;
        }
        s = next;
    }
    return s;
}

/* Largest coordinate of a vector over a span, and how far it strays from its middle: a
 * linear function is within half its change of the mean of its ends. */
struct reach {
    double middle[3];
    double size; /* of the middle */
    double high; /* size + radius */
};

static struct reach reach_of(const double l[3], const double r[3], double size)
{
    struct reach reach;
    double change[3];
    for (int k = 0; k < 3; k++) {
        reach.middle[k] = 0.5 * (l[k] + r[k]);
        change[k] = r[k] - l[k];
    }
    reach.size = eng_size(reach.middle);
    reach.high = reach.size + (0.5 * eng_size(change) + 16 * ENG_U * size);
    return reach;
}

enum eng_domain eng_motion_domain(const struct eng_motion *motion,
                                  const struct eng_pose *l, const struct eng_pose *r)
{
    struct reach p = reach_of(l->p, r->p, motion->size_p);
    struct reach b = reach_of(l->b, r->b, motion->size_b);
    struct reach c = reach_of(l->c, r->c, motion->size_c);
    double n[3];
    double m[3];
    eng_cross(n, b.middle, c.middle);
    double nn = eng_dot(n, n);
    eng_cross(m, p.middle, c.middle);
    double beta = eng_dot(m, n); /* times nn */
    eng_cross(m, b.middle, p.middle);
    double gamma = eng_dot(m, n);

    /* A product of four vectors, twelve terms each: what the radii add, then rounding. */
    double bc = b.size * c.size;
    double high_bc = b.high * c.high;
    double grown = high_bc * p.high;
    double base = bc * p.size;
    double e_beta =
        12 * (grown * c.high - base * c.size) + 256 * ENG_U * grown * c.high + ENG_TINY;
    double e_gamma =
        12 * (grown * b.high - base * b.size) + 256 * ENG_U * grown * b.high + ENG_TINY;
    double e_nn =
        12 * (high_bc * high_bc - bc * bc) + 256 * ENG_U * high_bc * high_bc + ENG_TINY;
    if (beta < -e_beta || gamma < -e_gamma) {
        return ENG_OUTSIDE;
    }
    bool inside = beta > e_beta && gamma > e_gamma;
    if (motion->kind == PCCD_VF) {
        double rest = nn - beta - gamma;
        double e_rest =
            e_nn + e_beta + e_gamma + 4 * ENG_U * (nn + fabs(beta) + fabs(gamma));
        if (rest < -e_rest) {
            return ENG_OUTSIDE;
        }
        return inside && rest > e_rest ? ENG_INSIDE : ENG_UNSURE;
    }
    double rest_beta = nn - beta;
    double rest_gamma = nn - gamma;
    double e_rest_beta = e_nn + e_beta + 4 * ENG_U * (nn + fabs(beta));
    double e_rest_gamma = e_nn + e_gamma + 4 * ENG_U * (nn + fabs(gamma));
    if (rest_beta < -e_rest_beta || rest_gamma < -e_rest_gamma) {
        return ENG_OUTSIDE;
    }
    inside = inside && rest_beta > e_rest_beta && rest_gamma > e_rest_gamma;
    return inside ? ENG_INSIDE : ENG_UNSURE;
}

/* ---- nearest points ---------------------------------------------------------------- */

ENG_INLINE struct eng_v vector_of(const double x[3])
{
    return (struct eng_v){x[0], x[1], x[2]};
}

ENG_INLINE void find_closest(enum pccd_kind kind, const struct eng_pose *pose,
                             struct eng_closest *closest)
{
    const struct eng_pose_lanes at = {vector_of(pose->p), vector_of(pose->b),
                                      vector_of(pose->c)};
    struct eng_nearest_gap nearest = eng_nearest_gap_of(kind, &at);
    *closest = (struct eng_closest){
        nearest.beta, nearest.gamma, {nearest.gap.x, nearest.gap.y, nearest.gap.z}};
}

void eng_closest_to_origin(enum pccd_kind kind, const struct eng_pose *pose,
                           struct eng_closest *closest)
{
    if (kind == PCCD_VF) {
        find_closest(PCCD_VF, pose, closest);
    } else {
        find_closest(PCCD_EE, pose, closest);
    }
}

/* ---- a fixed direction ----------------------------------------------------------- */

/* With d fixed, d . (p - beta b - gamma c) is linear in beta, gamma and in t, so its sign
 * over domain and span is decided at the corners of the domain at both ends. */

/* Smallest and largest d . (p - beta b - gamma c) over the corners of the domain. */
static void project(enum pccd_kind kind, const struct eng_pose *pose, const double d[3],
                    double *low, double *high)
{
    double p = eng_dot(d, pose->p);
    double b = eng_dot(d, pose->b);
    double c = eng_dot(d, pose->c);
    double corner[4] = {p, p - b, p - c, p - b - c};
    int corner_count = kind == PCCD_VF ? 3 : 4;
    for (int i = 0; i < corner_count; i++) {
        *low = corner[i] < *low ? corner[i] : *low;
        *high = corner[i] > *high ? corner[i] : *high;
    }
}

bool eng_motion_separates(const struct eng_motion *motion, const struct eng_pose *l,
                          const struct eng_pose *r, const struct eng_pose *when)
{
    struct eng_closest closest;
    eng_closest_to_origin(motion->kind, when, &closest);
    const double *d = closest.gap;
    double low = INFINITY;
    double high = -INFINITY;
    project(motion->kind, l, d, &low, &high);
    project(motion->kind, r, d, &low, &high);
    double margin = 32 * ENG_U * (fabs(d[0]) + fabs(d[1]) + fabs(d[2])) *
                        (motion->size_p + motion->size_b + motion->size_c) +
                    ENG_TINY;
    return low > margin || high < -margin;
}

/* ---- contacts -------------------------------------------------------------------- */

/* v / |v| times sign as float; zeros for a zero vector. */
static void set_unit(float out[3], const double v[3], double sign)
{
    double size = eng_size(v);
    double w[3] = {0, 0, 0};
    if (size > 0) {
        for (int k = 0; k < 3; k++) {
            w[k] = v[k] / size;
        }
        double scale_to_unit = sign / sqrt(eng_dot(w, w));
        for (int k = 0; k < 3; k++) {
            w[k] *= scale_to_unit;
        }
    }
    for (int k = 0; k < 3; k++) {
        out[k] = (float)w[k];
    }
}

void eng_motion_describe(const struct eng_motion *motion, double t, double f_start,
                         double *beta, double *gamma, float normal[3])
{
    struct eng_pose pose;
    struct eng_closest closest;
    eng_motion_pose(motion, t, &pose);
    eng_closest_to_origin(motion->kind, &pose, &closest);
    *beta = closest.beta;
    *gamma = closest.gamma;

    /* p - beta b - gamma c points from face to vertex, but from edge a to edge b. */
    double from_b_to_a = motion->kind == PCCD_VF ? 1 : -1;
    double n[3];
    eng_cross(n, pose.b, pose.c);
    if (eng_dot(n, n) > 0x1p-80 * eng_dot(pose.b, pose.b) * eng_dot(pose.c, pose.c)) {
        set_unit(normal, n, f_start < 0 ? -from_b_to_a : from_b_to_a);
        return;
    }
    eng_motion_pose(motion, 0, &pose);
    eng_closest_to_origin(motion->kind, &pose, &closest);
    set_unit(normal, closest.gap, from_b_to_a);
}
