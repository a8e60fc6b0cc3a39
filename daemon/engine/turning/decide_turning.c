/* decide_turning.c - a pair of features of which one turns, by halves of the step.
 *
 * On a span of time the points are taken to go straight from where they are at its begin
 * to where they are at its end. They do not, but they are at most eps off. If such
 * straight features stay farther apart than r + eps, the true ones stay farther apart
 * than r; if they come within r - eps, so do the true ones within r. With r = 0 nothing
 * is within; there straight features that pass through each other so well that nothing
 * within eps of them could avoid it prove a contact. What is neither is cut: at the time
 * up to which it is free, if that is in its second half, else in the middle.
 *
 * Source: elementary/BOUNDS.md, "Features that turn".
 */
#include "decide.h"

#include <math.h>
#include <string.h>

#include "kernel.h"
#include "motion.h"
#include "rotation.h"
#include "thick_exact.h"
#include "vec.h"

/* Cells of `advance`: each look makes a bracket so much shorter at most. Finer ones would
 * be shorter than rounding where brackets are. */
#define DEPTH 8

/* Spans that turn by more than their chords show are cut without a closer look: where
 * points are off their chords by more than this part of their way. */
#define BENT_MOST 0x1p-4

/* Halves of the step, and what is cut off at the end of a bracket. */
#define SPANS_MAX 96u

/* Windows that are tried before a contact is called possible. */
#define WINDOWS 20

/* So often the time is refined up to which planes keep features apart. */
#define CUTS 2

/* So often the time is refined when they cross, where straight features are free up to
 * the last such part of the way there. */
#define REFINEMENTS  2
#define REFINED_MOST 0.25

/* Shorter spans are not cut where nobody knows. */
#define LENGTH_LEAST 0x1p-44

#define SIZE_MOST 1e18

static const uint32_t whole[1][4] = {{0, 1, 2, 3}};
static const uint32_t numbers[4] = {0, 1, 2, 3};

/* The points of both at one time. */
struct moment {
    double t;
    double x[4][3];
    double error; /* Euclidean, of each point */
    double size;  /* largest coordinate */
};

/* Features that go straight between two moments, and how far from them the true ones
 * are. */
struct span {
    const struct moment *l;
    const struct moment *r;
    double length; /* rounded up */
    double bent;   /* how far off their chords points are */
    double eps;    /* that and the errors at the ends */
    struct eng_point points[4];
};

/* The motion of thin features in a span. */
struct passage {
    struct eng_motion motion;
    struct eng_pose pose[2];
    double reach;  /* eps, and a little more, as the motion is scaled */
    double f[4];   /* Bernstein coefficients of det[p, b, c] */
    double height; /* where |det| is more, both planes are farther apart than reach */
    double edge;   /* and at either end, where points are on their chords */
    double middle; /* part of the span after which f is 0; -1: nobody knows */
    bool is_inside; /* there the planes cross within both features, it seems */
};

struct decider {
    struct eng_poses *poses;
    const struct eng_turning_pair *pair;
    const struct eng_turning_limits *limits;
    const struct eng_kernels *kernels;
    uint32_t first_turning;
    uint32_t end_turning;
    bool stands;        /* the other feature */
    double still_error; /* of its places between both ends */
    double still_size;
    double turning_size; /* largest coordinate of the turning feature in its frame */
    double bend;
    double at_most;  /* r, rounded up */
    double at_least; /* r, rounded down */
    bool is_thin;
    bool is_inside; /* it begins within r, and meets by what approach allows */
    bool is_beyond; /* a place is beyond the numbers that tests know */
    double side;  /* thin, proved: its sign is that of det[p, b, c] before the contact */
    double guess; /* thin features have met then, it seems; INFINITY: nobody knows */
    struct passage passage;        /* of the span that was looked at, if they are thin */
    struct moment spare[2];        /* of a window */
    struct moment begin;           /* the earliest span begins here */
    struct moment ends[SPANS_MAX]; /* spans that are left end here; the first one last */
    uint32_t count;
};

/* ---- moments and spans ------------------------------------------------------------- */

static void set_moment(struct decider *decider, double t, struct moment *moment)
{
    const struct eng_turning_pair *pair = decider->pair;
    const struct eng_path_pose *pose = eng_poses_at(decider->poses, t);
    const double *m = pose->m;
    const eng_d2 column[4] = {
        {m[0], m[4]}, {m[1], m[5]}, {m[2], m[6]}, {m[3], m[7]}}; /* of two rows */
    double size = decider->still_size;
    for (uint32_t i = 0; i < 4; i++) {
        const double *x = pair->x[0][i];
        double *at = moment->x[i];
        if (i >= decider->first_turning && i < decider->end_turning) {
            const eng_d2 two =
                ((column[0] * eng_d2_both(x[0]) + column[1] * eng_d2_both(x[1])) +
                 column[2] * eng_d2_both(x[2])) +
                column[3];
            at[0] = two[0];
            at[1] = two[1];
            at[2] = ((m[8] * x[0] + m[9] * x[1]) + m[10] * x[2]) + m[11];
            size = eng_most(size, eng_size(at));
        } else if (!decider->stands) {
#pragma GCC unroll 3
            for (int k = 0; k < 3; k++) {
                at[k] = (1 - t) * x[k] + t * pair->x[1][i][k];
            }
        } else {
            memcpy(at, x, 3 * sizeof *at);
        }
    }
    decider->is_beyond |= !(size <= SIZE_MOST);
    bool is_given = decider->stands || t == 0 || t == 1;
    moment->t = t;
    moment->size = size;
    moment->error =
        (pose->error[0] + pose->error[1] * decider->turning_size) * (1 + 8 * ENG_U) +
        (is_given ? 0 : decider->still_error);
}

static void set_span(const struct decider *decider, const struct moment *l,
                     const struct moment *r, struct span *span)
{
    span->l = l;
    span->r = r;
    span->length = (r->t - l->t) * (1 + 2 * ENG_U);
    span->bent = decider->bend * span->length * span->length * (0.125 + 2 * ENG_U) +
                 (decider->bend > 0 ? ENG_TINY : 0);
    span->eps = (span->bent + eng_most(l->error, r->error)) * (1 + 4 * ENG_U);
    for (int i = 0; i < 4; i++) {
        memcpy(span->points[i].x0, l->x[i], sizeof l->x[i]);
        memcpy(span->points[i].x1, r->x[i], sizeof r->x[i]);
    }
}

/* Set the difference vectors of query.h. */
static void set_pose(enum pccd_kind kind, const struct moment *moment,
                     struct eng_pose *pose)
{
    const double(*x)[3] = moment->x;
    const bool is_ee = kind == PCCD_EE;
    eng_sub(pose->p, is_ee ? x[2] : x[0], is_ee ? x[0] : x[1]);
    eng_sub(pose->b, is_ee ? x[1] : x[2], is_ee ? x[0] : x[1]);
    eng_sub(pose->c, is_ee ? x[2] : x[3], is_ee ? x[3] : x[1]);
}

/* Return a time that is not after that part of the span, nor before its begin. */
static double time_before(const struct span *span, double part)
{
    double t = span->l->t + (span->r->t - span->l->t) * part - 4 * ENG_U;
    return part <= 0 ? span->l->t : eng_most(span->l->t, t);
}

static double time_behind(const struct span *span, double part)
{
    double t = span->l->t + (span->r->t - span->l->t) * part + 4 * ENG_U;
    return part <= 0 ? span->l->t : eng_least(span->r->t, t);
}

/* ---- free -------------------------------------------------------------------------- */

/* Return whether an axis keeps the features farther apart than that, at both ends. */
static bool are_apart(const struct span *span, uint32_t points_a, double reach)
{
    for (int k = 0; k < 3; k++) {
        double above = INFINITY;
        double below = INFINITY;
        for (int end = 0; end < 2; end++) {
            const double(*x)[3] = end == 0 ? span->l->x : span->r->x;
            double low_a = eng_least(x[0][k], x[points_a - 1][k]);
            double high_a = eng_most(x[0][k], x[points_a - 1][k]);
            double low_b = eng_least(eng_least(x[points_a][k], x[2][k]), x[3][k]);
            double high_b = eng_most(eng_most(x[points_a][k], x[2][k]), x[3][k]);
            above = eng_least(above, low_a - high_b);
            below = eng_least(below, low_b - high_a);
        }
        if (above > reach || below > reach) {
            return true;
        }
    }
    return false;
}

/* Return whether points are off their chords by much, against how far they go. What is
 * within delta is not: points on the axis go nowhere, and rounding bends their way. */
static bool is_much_bent(const struct decider *decider, const struct span *span)
{
    double way = 0;
    if (span->bent <= decider->limits->delta) {
        return false;
    }
    for (uint32_t i = decider->first_turning; i < decider->end_turning; i++) {
        double d[3];
        eng_sub(d, span->r->x[i], span->l->x[i]);
        way = eng_most(way, eng_size(d));
    }
    return span->bent > BENT_MOST * way;
}

/* Ask the kernel whether straight features come within r, when. */
static void advance(const struct decider *decider, struct eng_quads quads, uint32_t count,
                    double r, struct eng_advance *told)
{
    static const struct eng_advance_limits limits = {0, 1, DEPTH};
    for (uint32_t i = 0; i < count; i++) {
        told[i] = (struct eng_advance){.lo = r};
    }
    /* One pair alone is quicker without lanes. */
    const struct eng_kernels *kernels = count > 1 ? eng_kernels() : decider->kernels;
    kernels->advance(quads, numbers, count, &limits, told);
}

/* Set the motion of features that are VF or EE. */
static void set_motion(enum pccd_kind kind, const struct span *span,
                       struct eng_motion *motion)
{
    struct eng_query query = {.kind = kind};
    memcpy(query.x[0], span->l->x, sizeof query.x[0]);
    memcpy(query.x[1], span->r->x, sizeof query.x[1]);
    eng_motion_init(motion, &query);
}

static void set_passage(enum pccd_kind kind, const struct span *span,
                        struct passage *passage)
{
    const double *f = passage->f;
    struct eng_motion *motion = &passage->motion;
    double slope;
    set_motion(kind, span, motion);
    for (int end = 0; end < 2; end++) {
        struct eng_pose *pose = &passage->pose[end];
        memcpy(pose->p, motion->p[end], sizeof pose->p);
        memcpy(pose->b, motion->b[end], sizeof pose->b);
        memcpy(pose->c, motion->c[end], sizeof pose->c);
    }
    double across = eng_motion_planes(&passage->pose[0], &passage->pose[1], passage->f);
    across = across * (1 + 8 * ENG_U) + 32 * ENG_U * motion->size_b * motion->size_c;
    passage->reach = (span->eps * (1 + 4 * ENG_U) + ENG_TINY) * motion->scale;
    passage->height = passage->reach * across * (1 + 8 * ENG_U) + 4 * motion->e_det;
    const double error = eng_most(span->l->error, span->r->error);
    passage->edge = (error * (1 + 8 * ENG_U) + ENG_TINY) * motion->scale * across *
                        (1 + 8 * ENG_U) +
                    4 * motion->e_det;
    const bool crosses = fabs(f[0]) > motion->e_det && fabs(f[3]) > motion->e_det &&
                         (f[0] < 0) != (f[3] < 0);
    passage->middle = crosses ? eng_bernstein_root(f, &slope) : -1;
}

/* Return the part of a span up to which a cubic is certainly positive, which is so at its
 * begin; 1: throughout. It is not below the line from the first of its coefficients to
 * that of the others to which it falls fastest, nor is what is left of it behind. */
static double positive_until(double h[4])
{
    double until = 0;
    for (int cut = 0; h[0] > 0; cut++) {
        if (eng_least(h[1], eng_least(h[2], h[3])) > 0) {
            return 1;
        }
        double part = 1;
        for (int i = 1; i < 4; i++) {
            if (h[i] < h[0]) {
                part = eng_least(part, (i / 3.0) * (h[0] / (h[0] - h[i])));
            }
        }
        until += (1 - until) * part;
        if (cut == CUTS) {
            break;
        }
        for (int level = 3; level > 0; level--) {
            for (int i = 0; i < level; i++) {
                h[i] += part * (h[i + 1] - h[i]);
            }
        }
    }
    return until * (1 - 16 * ENG_U);
}

/* Return the part of a span up to which the planes across both features are certainly
 * apart; 1: throughout. Points leave their chords by at most a parabola, which as a cubic
 * has the coefficients 0, 4/3, 4/3 and 0. */
static double apart_until(const struct passage *passage)
{
    const double *f = passage->f;
    const double most = passage->motion.e_det * (1 / (32 * ENG_U));
    double bow = 4 / 3.0 * (passage->height - passage->edge) * (1 + 8 * ENG_U);
    double edge = passage->edge;
    if (!(edge + bow <= most)) { /* more than all of det, about */
        edge = passage->height;
        bow = 0;
    }
    double h[4];
    for (int i = 0; i < 4; i++) {
        h[i] = (f[0] < 0 ? -f[i] : f[i]) - (i % 3 == 0 ? edge : edge + bow);
    }
    return positive_until(h);
}

/* Return whether the planes across both features cross within both, as far as doubles can
 * tell. */
static bool cross_inside(enum pccd_kind kind, const struct eng_pose *pose)
{
    double n[3], m[3];
    eng_cross(n, pose->b, pose->c);
    const double nn = eng_dot(n, n);
    eng_cross(m, pose->p, pose->c);
    const double beta = eng_dot(m, n);
    eng_cross(m, pose->b, pose->p);
    const double gamma = eng_dot(m, n);
    return beta > 0 && gamma > 0 &&
           (kind == PCCD_VF ? beta + gamma < nn : beta < nn && gamma < nn);
}

enum look {
    LOOK_FREE,
    LOOK_NEAR,   /* the straight features come within r + eps */
    LOOK_UNSURE, /* nobody knows */
    LOOK_UNASKED /* nobody has asked */
};

/* Return whether they are thin, and have planes across both. */
static bool has_planes(const struct decider *decider)
{
    const enum pccd_kind kind = decider->pair->kind;
    return decider->is_thin && (kind == PCCD_VF || kind == PCCD_EE);
}

/* Tell of thin features in a span, by the planes across both. Where these cross, the
 * features meet, or are apart along one direction, soon or in shorter spans. */
static enum look look_at_planes(struct decider *decider, const struct span *span,
                                bool closely, double *until)
{
    struct passage *passage = &decider->passage;
    struct eng_pose then;
    set_passage(decider->pair->kind, span, passage);
    const double part = apart_until(passage);
    if (part == 1) {
        return LOOK_FREE;
    }
    *until = time_before(span, part);
    const bool crosses = passage->middle >= 0;
    const bool goes_on = crosses && part > 0 && !closely;
    eng_motion_pose(&passage->motion, crosses ? passage->middle : 0.5, &then);
    passage->is_inside = goes_on && cross_inside(decider->pair->kind, &then);
    if (!passage->is_inside &&
        eng_motion_separates(&passage->motion, &passage->pose[0], &passage->pose[1],
                             &then, passage->reach)) {
        return LOOK_FREE;
    }
    return goes_on ? LOOK_NEAR : LOOK_UNASKED;
}

/* Tell of a span; *until becomes the time up to which it is free. */
static enum look look(struct decider *decider, const struct span *span, bool closely,
                      double *until)
{
    const double r = (decider->at_most + span->eps) * (1 + 4 * ENG_U);
    const uint32_t kind = (uint32_t)decider->pair->kind;
    const uint32_t points_a = common_kinds[kind].points[0];
    uint32_t left[1];
    struct eng_advance told;
    *until = span->l->t;
    if (!(r <= SIZE_MOST)) {
        return LOOK_UNASKED;
    }
    if (are_apart(span, points_a, r * (1 + 4 * ENG_U))) {
        return LOOK_FREE;
    }
    if (!closely && is_much_bent(decider, span)) {
        return LOOK_UNASKED;
    }
    if (has_planes(decider)) {
        const enum look seen = look_at_planes(decider, span, closely, until);
        if (seen != LOOK_UNASKED) {
            return seen;
        }
    }
    if (decider->kernels->reject_thick((struct eng_quads){kind, span->points, whole}, 1,
                                       &r, left) == 0) {
        return LOOK_FREE;
    }
    advance(decider, (struct eng_quads){kind, span->points, whole}, 1, r, &told);
    if (told.now == ENG_ADVANCE_MISSES) {
        return LOOK_FREE;
    }
    *until = eng_most(*until, time_before(span, told.until));
    return told.now == ENG_ADVANCE_UNDECIDED ? LOOK_UNSURE : LOOK_NEAR;
}

/* ---- proved ------------------------------------------------------------------------ */

/* Return a time by which they are within r; INFINITY: it is not proved. */
static double prove_thick(const struct decider *decider, const struct span *span)
{
    double r = (decider->at_least - span->eps) * (1 - 4 * ENG_U);
    struct eng_advance told;
    if (!(r > 0)) {
        return INFINITY;
    }
    advance(decider,
            (struct eng_quads){(uint32_t)decider->pair->kind, span->points, whole}, 1, r,
            &told);
    switch ((enum eng_advanced)told.now) {
    case ENG_ADVANCE_INITIALLY:
        return span->l->t;
    case ENG_ADVANCE_MEETS:
        return time_behind(span, eng_thick_cell_begin((int64_t)told.cell + 1, DEPTH));
    case ENG_ADVANCE_MISSES:
    case ENG_ADVANCE_UNDECIDED:
        break;
    }
    return INFINITY;
}

/* Return whether thin features certainly meet in a window of time. */
static bool proves(struct decider *decider, double from, double to)
{
    const enum pccd_kind kind = decider->pair->kind;
    struct passage passage;
    struct span window;
    set_moment(decider, from, &decider->spare[0]);
    set_moment(decider, to, &decider->spare[1]);
    set_span(decider, &decider->spare[0], &decider->spare[1], &window);
    if (!(window.eps <= SIZE_MOST)) {
        return false;
    }
    set_passage(kind, &window, &passage);
    if (!(passage.middle >= 0 && fabs(passage.f[0]) > passage.height &&
          fabs(passage.f[3]) > passage.height) ||
        eng_motion_domain(&passage.motion, &passage.pose[0], &passage.pose[1],
                          passage.reach) != ENG_INSIDE) {
        return false;
    }
    decider->side = passage.f[0];
    return true;
}

/* Try windows of those lengths before and behind a time, which shorten by four: `tries`
 * of them. Return a time by which thin features have met, or INFINITY. */
static double try_windows(struct decider *decider, const struct span *span, double middle,
                          double reach, int tries)
{
    for (; tries > 0 && reach > 2 * ENG_U; tries--, reach *= 0.25) {
        double from = eng_most(middle - reach, 0);
        double to = eng_least(middle + reach, 1);
        if (to - from < span->length && proves(decider, from, to)) {
            return to;
        }
    }
    return INFINITY;
}

/* Return where planes cross, about: better than where those of straight features do, at
 * the part `at` of the span. The true determinant differs from the cubic by a parabola,
 * nearly, which is 0 at both ends; then by a line. */
static double refine(struct decider *decider, const struct span *span, double at)
{
    const struct passage *passage = &decider->passage;
    const double *f = passage->f;
    const double c1 = 3 * (f[1] - f[0]);
    const double c2 = 3 * (f[2] - 2 * f[1] + f[0]);
    const double c3 = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    const double scale = passage->motion.scale;
    double parabola = 0;
    double slope = 0;
    for (int i = 0; i < REFINEMENTS; i++) {
        struct eng_pose pose;
        set_moment(decider, span->l->t + (span->r->t - span->l->t) * at,
                   &decider->spare[0]);
        set_pose(decider->pair->kind, &decider->spare[0], &pose);
        const double det = scale * scale * scale * eng_pose_det(&pose);
        if (i == 0) {
            parabola = det / (at * (1 - at));
            slope = c1 + at * (2 * c2 + at * (3 * c3)) + parabola * (1 - 2 * at);
        }
        const double next = at - det / slope;
        if (!(next > 0 && next < 1)) {
            break;
        }
        if (i == 0) { /* once more, on the parabola */
            const double value = f[0] + next * (c1 + next * (c2 + next * c3)) +
                                 parabola * next * (1 - next);
            slope = c1 + next * (2 * c2 + next * (3 * c3)) + parabola * (1 - 2 * next);
            at = next - value / slope;
        } else {
            at = next;
        }
        if (!(at > 0 && at < 1)) {
            break;
        }
    }
    return span->l->t + (span->r->t - span->l->t) * at;
}

/* Try a window of the tolerance around where planes cross, and whether the features are
 * free up to there; *until becomes the time up to which they are. Return a time by which
 * they have met, or INFINITY. */
static double try_crossing(struct decider *decider, const struct span *span,
                           double *until)
{
    const double tolerance = decider->limits->tolerance;
    const double at = decider->passage.middle;
    const double middle = refine(decider, span, at);
    const double met_by = try_windows(decider, span, middle, 0.25 * tolerance, 1);
    const struct moment *from = &decider->spare[0]; /* the window begins here */
    if (met_by < INFINITY && from->t > span->l->t && from->t < span->r->t) {
        struct span before;
        set_span(decider, span->l, from, &before);
        set_passage(decider->pair->kind, &before, &decider->passage);
        if (apart_until(&decider->passage) == 1) {
            *until = from->t;
        }
    }
    return met_by;
}

/* Return a time by which thin features have met; INFINITY: it is not proved. They are
 * free up to *until, which may become later, and the proof is about a window around the
 * time when the straight features meet, which is shorter than the span and may go beyond
 * it. One that is longer than the tolerance would be no more than a guess. `hard`: near a
 * border, shorter ones prove what longer ones do not. */
static double prove_thin(struct decider *decider, const struct span *span, double *until,
                         bool hard)
{
    const double tolerance = decider->limits->tolerance;
    struct passage *passage = &decider->passage;
    double middle = span->r->t; /* where neither this span nor the next one would tell */
    if (!decider->is_thin) {
        set_passage(decider->pair->kind, span, passage);
    }
    if (passage->middle >= 0) {
        middle = span->l->t + (span->r->t - span->l->t) * passage->middle;
    }
    if (hard) {
        return try_windows(decider, span, middle, 0.25 * span->length, WINDOWS);
    }
    double reach = 3 * (middle - *until) + 8 * ENG_U;
    if (2 * reach > tolerance) {
        decider->guess = middle + reach;
        return decider->is_thin && passage->is_inside &&
                       middle - *until <= REFINED_MOST * (middle - span->l->t)
                   ? try_crossing(decider, span, until)
                   : INFINITY;
    }
    double met_by = try_windows(decider, span, middle, reach, 1);
    return met_by < INFINITY || 8 * reach > tolerance
               ? met_by
               : try_windows(decider, span, middle, 0.25 * tolerance, 1);
}

/* ---- possible ---------------------------------------------------------------------- */

/* Return the delta that rounding leaves a meaning. */
static double precision_of(const struct decider *decider, const struct span *span)
{
    double error = eng_most(span->l->error, span->r->error);
    double size = eng_most(span->l->size, span->r->size);
    return eng_most(decider->limits->delta, eng_turning_delta_least(size, error));
}

double eng_turning_delta_least(double size, double error)
{
    return eng_most(4 * error, 0x1p-44 * size);
}

/* Return how far apart the features are, as far as doubles can tell. */
static double distance_at(enum pccd_kind kind, const struct moment *moment)
{
    struct eng_pose pose;
    struct eng_closest closest;
    set_pose(kind, moment, &pose);
    eng_closest_to_origin(kind == PCCD_EE ? PCCD_EE : PCCD_VF, &pose, &closest);
    return sqrt(eng_dot(closest.gap, closest.gap));
}

/* Return whether there is nothing more to be known of a leaf, and its features come
 * within precision of r. */
static bool comes_near(struct decider *decider, const struct span *span, enum look seen,
                       double until, double precision)
{
    if (seen != LOOK_UNSURE || until == span->l->t) {
        return true;
    }
    if (span->length > LENGTH_LEAST) {
        return false;
    }
    set_moment(decider, until, &decider->spare[0]);
    return !(distance_at(decider->pair->kind, &decider->spare[0]) >
             decider->at_most + precision);
}

/* ---- the search -------------------------------------------------------------------- */

/* The facts that are known by now. */
struct found {
    double free_until;
    double met_by; /* INFINITY: nothing is proved */
    bool is_possible;
    double possible_until;
    uint32_t ahead; /* looks since then */
    bool has_begun; /* the first instant has been looked at */
};

static void push(struct decider *decider, double t)
{
    set_moment(decider, t, &decider->ends[decider->count++]);
}

/* Leave the span, which is the first, behind. */
static void pass(struct decider *decider)
{
    decider->begin = decider->ends[--decider->count];
}

/* Go on with the part of the span, which is the first, that is not known to be free: up
 * to where it is guessed to meet, or, in its second half, to its end; else with its first
 * half. */
static void cut(struct decider *decider, const struct span *span, double until)
{
    const double l = span->l->t;
    const double r = span->r->t;
    const double end = decider->guess < r ? decider->guess : r;
    if (end - until > 0.5 * (r - l)) {
        push(decider, l + 0.5 * (r - l));
        return;
    }
    if (until > l) {
        set_moment(decider, until, &decider->begin);
    }
    if (end < r) {
        push(decider, end);
    }
}

/* Prove what can be proved of a span whose straight features come near. */
static void prove(struct decider *decider, const struct span *span, double *until,
                  bool hard, struct found *found)
{
    const enum pccd_kind kind = decider->pair->kind;
    if (!decider->is_thin && !found->has_begun && *until == 0) {
        struct span instant;
        set_span(decider, span->l, span->l, &instant);
        found->met_by = eng_least(found->met_by, prove_thick(decider, &instant));
    }
    found->has_begun = true;
    double met_by = decider->is_thin ? INFINITY : prove_thick(decider, span);
    if (met_by == INFINITY && (kind == PCCD_VF || kind == PCCD_EE)) {
        met_by = prove_thin(decider, span, until, hard);
    }
    found->met_by = eng_least(found->met_by, met_by);
}

/* Return whether the bracket is short enough, or nobody wants it. */
static bool is_known(const struct decider *decider, const struct found *found)
{
    return found->met_by - found->free_until <= decider->limits->tolerance ||
           (found->is_possible && found->met_by < INFINITY) ||
           found->free_until > decider->limits->t_end;
}

/* Return whether the caller knows that nothing that is wanted is left. What is possible
 * or proved needs more, also later. */
static bool is_behind(const struct decider *decider, const struct found *found)
{
    return decider->limits->to > 0 && decider->begin.t >= decider->limits->to &&
           !found->is_possible && found->met_by == INFINITY;
}

/* Look at the first span that is left. Return whether the answer is known. */
static bool look_at_first(struct decider *decider, struct found *found)
{
    struct span span;
    double until;
    if (decider->ends[decider->count - 1].t > found->met_by) {
        decider->count = 0;
        push(decider, found->met_by);
    }
    if (is_behind(decider, found)) {
        found->free_until = 1;
        return true;
    }
    if (decider->ends[decider->count - 1].t <= decider->limits->from) {
        pass(decider);
        found->free_until = found->is_possible ? found->free_until : decider->begin.t;
        return is_known(decider, found);
    }
    set_span(decider, &decider->begin, &decider->ends[decider->count - 1], &span);
    const double precision = precision_of(decider, &span);
    /* The errors at its ends would be most of a shorter one's eps, too. */
    const bool is_leaf =
        span.eps <= precision &&
        (found->is_possible || (span.length <= decider->limits->tolerance &&
                                span.bent <= span.eps - span.bent));
    enum look seen = look(decider, &span, is_leaf, &until);
    decider->guess = INFINITY;
    if (!found->is_possible) {
        found->free_until = seen == LOOK_FREE ? span.r->t : until;
    }
    if (seen == LOOK_FREE) {
        pass(decider);
        return is_known(decider, found);
    }
    if (found->free_until > decider->limits->t_end) {
        return true;
    }
    if (seen != LOOK_UNASKED) {
        prove(decider, &span, &until, is_leaf && !found->is_possible, found);
        if (!found->is_possible) {
            found->free_until = until;
        }
        if (is_known(decider, found)) {
            return true;
        }
    }
    if (!is_leaf || !comes_near(decider, &span, seen, until, precision)) {
        cut(decider, &span, until);
        return false;
    }
    if (!found->is_possible) {
        found->is_possible = true;
        found->possible_until = span.r->t;
    }
    pass(decider);
    return found->met_by < INFINITY || ++found->ahead > ENG_TURNING_LOOKS_AHEAD;
}

/* Let features that begin within r meet where their distance is the part of the first
 * one that approach allows. Of those that begin at r, as far as bounds tell, nobody knows
 * which it is: they may meet at r, and do where both ways to read it say so. */
static void take_approach(struct decider *decider)
{
    const double s = decider->limits->approach, most = decider->at_most;
    struct span first;
    double until;
    set_span(decider, &decider->begin, &decider->begin, &first);
    if (look(decider, &first, true, &until) == LOOK_FREE) {
        return;
    }
    decider->is_inside = prove_thick(decider, &first) < INFINITY;
    double d = distance_at(decider->pair->kind, &decider->begin);
    double pad = 4 * first.eps + 0x1p-40 * decider->begin.size;
    decider->at_most = d - pad; /* the first distance is above that and .. */
    bool is_above = d > pad && look(decider, &first, true, &until) == LOOK_FREE;
    decider->at_least = d + pad; /* .. at most that, if both can be proved */
    bool is_below = prove_thick(decider, &first) < INFINITY;
    decider->at_least = is_above ? s * (d - pad) * (1 - 4 * ENG_U) : 0;
    decider->at_most =
        decider->is_inside && is_below ? s * (d + pad) * (1 + 4 * ENG_U) : most;
}

static void begin(struct decider *decider)
{
    const struct eng_turning_pair *pair = decider->pair;
    const uint32_t *points = common_kinds[pair->kind].points;
    decider->first_turning = pair->turning == 0 ? 0 : points[0];
    decider->end_turning = pair->turning == 0 ? points[0] : 4;
    decider->stands = true;
    for (uint32_t i = 0; i < 4; i++) {
        const double *x = pair->x[0][i];
        const double *y = pair->x[1][i];
        if (i < decider->first_turning || i >= decider->end_turning) {
            decider->stands &= x[0] == y[0] && x[1] == y[1] && x[2] == y[2];
            decider->still_size =
                eng_most(decider->still_size, eng_most(eng_size(x), eng_size(y)));
            continue;
        }
        decider->turning_size = eng_most(decider->turning_size, eng_size(x));
    }
    decider->still_error = 8 * ENG_U * decider->still_size + ENG_TINY;
    decider->bend =
        eng_path_bend_of(decider->poses->path, pair->x[0] + decider->first_turning,
                         decider->end_turning - decider->first_turning, 0);
    decider->at_most = eng_thick_reach(pair->radius);
    decider->at_least = eng_thick_sum(pair->radius) * (1 - 4 * ENG_U);
    decider->is_thin = decider->at_most == 0;
    set_moment(decider, 0, &decider->begin);
    if (decider->limits->approach > 0 && !decider->is_thin) {
        take_approach(decider);
    }
    push(decider, 1);
}

/* Set param and normal, by the places at toi. */
static void describe(struct decider *decider, struct eng_hit *hit)
{
    const enum pccd_kind kind = decider->pair->kind;
    const double toi = hit->toi;
    struct span span;
    if (decider->side == 0 || decider->spare[0].t != toi) { /* a proof begins there */
        set_moment(decider, toi, &decider->spare[0]);
    }
    set_span(decider, &decider->spare[0], &decider->spare[0], &span);
    hit->toi = 0;
    decider->kernels->describe((struct eng_quads){(uint32_t)kind, span.points, whole},
                               numbers, 1, hit);
    hit->toi = toi;
    if (decider->side != 0) {
        struct eng_motion motion;
        double place[2];
        set_motion(kind, &span, &motion);
        eng_motion_describe(&motion, 0, decider->side, &place[0], &place[1],
                            hit->normal);
    }
}

enum eng_turning_verdict eng_turning_decide(struct eng_poses *poses,
                                            const struct eng_turning_pair *pair,
                                            const struct eng_turning_limits *limits,
                                            struct eng_turning_answer *answer)
{
    struct decider decider;
    struct found found = {.met_by = INFINITY};
    enum eng_turning_verdict verdict = ENG_TURNING_FREE;
    decider.poses = poses;
    decider.pair = pair;
    decider.limits = limits;
    decider.kernels = eng_kernels_of(ENG_ISA_SCALAR);
    decider.is_beyond = false;
    decider.is_inside = false;
    decider.still_size = 0;
    decider.turning_size = 0;
    decider.side = 0;
    decider.count = 0;
    begin(&decider);
    answer->looks = 0;
    while (decider.count > 0) {
        bool is_asked = (answer->looks + 1) % ENG_TURNING_LOOKS_BETWEEN == 0;
        if (is_asked && limits->should_stop != NULL &&
            limits->should_stop(limits->owner)) {
            verdict = ENG_TURNING_STOPPED;
            break;
        }
        if (answer->looks == limits->looks_max || decider.count > SPANS_MAX - 2 ||
            decider.is_beyond) {
            verdict = ENG_TURNING_LIMIT;
            break;
        }
        answer->looks++;
        if (look_at_first(&decider, &found)) {
            break;
        }
    }
    if (verdict == ENG_TURNING_LIMIT && !found.is_possible) {
        /* However far the looks came, so much was known. */
        found.free_until =
            eng_most(found.free_until, eng_least(limits->from, found.met_by));
    }
    if (verdict == ENG_TURNING_LIMIT && found.free_until > limits->t_end) {
        verdict = ENG_TURNING_FREE;
    }
    answer->free_until = found.free_until;
    bool is_proved = found.met_by < INFINITY;
    if (verdict == ENG_TURNING_STOPPED || !(is_proved || found.is_possible) ||
        found.free_until > limits->t_end) {
        return verdict;
    }
    answer->hit =
        (struct eng_hit){.flags = is_proved ? PCCD_PROVED : 0,
                         .toi = found.free_until,
                         .toi_hi = is_proved ? found.met_by : found.possible_until};
    answer->hit.flags |= found.met_by == 0 ? PCCD_INITIAL : 0;
    answer->hit.flags |= decider.is_inside ? PCCD_INSIDE : 0;
    describe(&decider, &answer->hit);
    return ENG_TURNING_MEETS;
}
