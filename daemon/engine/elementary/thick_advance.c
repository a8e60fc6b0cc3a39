/* daemon/engine/elementary/thick_advance.c - thick features by doubles.
 *
 * Room:     engine.
 * Does:     see thick_advance.h. The direction between the nearest points at a time keeps
 *           the features apart by more than r for a while: projected onto it, points move
 *           linearly, so until when is a quotient. From there the next direction is
 *           taken. These times come near the first contact as Newton's do, from below,
 *           since the distance along the direction is at most the distance and touches
 *           it. In the cell where they stay, two points are looked for that are within r
 *           of each other at its end.
 * Threads:  [any].
 */
#include "thick_advance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "closest.h"
#include "thick_roots.h"
#include "vec.h"

/* Directions that are tried before integers take over. */
#define TURNS_MAX 48

/* BOUNDS.md derives them: of a projection, times the size of its direction; of the length
 * of a way; of a quotient and of other products. All differences are below 1. */
#define PROJECTED (8 * ENG_U)
#define WAY       (96 * ENG_U)
#define ROUNDED   (8 * ENG_U)
#define HEIGHT    (512 * ENG_U) /* of a determinant; a third of three */
#define ACROSS    (320 * ENG_U) /* of a length across, or of two in the middle */

/* Of the square of a direction: squares of shorter ones lose their last bits. */
#define DIRECTION_MIN 0x1p-600

/* A distance beyond those of all points. */
#define FAR 16.0

/* ---- the motion -------------------------------------------------------------------- */

static void subtract(const struct eng_query *query, int i, int j, double out[2][3])
{
    eng_sub(out[0], query->x[0][i], query->x[0][j]);
    eng_sub(out[1], query->x[1][i], query->x[1][j]);
}

/* Times 2^exponent, which is `factor` if that is a number; exactly, but for what falls
 * below the normal range. */
static void scale(double v[2][3], double factor, int exponent)
{
    for (int i = 0; i < 6; i++) {
        double *x = &v[i / 3][i % 3];
        *x = factor > 0 ? *x * factor : ldexp(*x, exponent);
    }
}

static double scaled_radius(double r, int exponent)
{
    return ldexp(r, exponent) < FAR ? ldexp(r, exponent) : FAR;
}

static void load_points(struct eng_thick_motion *motion, const struct eng_query *query)
{
    uint32_t kind = (uint32_t)query->kind;
    memset(motion->b, 0, sizeof motion->b);
    memset(motion->c, 0, sizeof motion->c);
    motion->form = kind == PCCD_EE ? PCCD_EE : PCCD_VF;
    motion->count = 0;
    if (kind == PCCD_EE) {
        for (int i = 0; i < 4; i++) {
            subtract(query, i / 2, 2 + i % 2, motion->w[motion->count++]);
        }
        subtract(query, 2, 0, motion->p);
        subtract(query, 1, 0, motion->b);
        subtract(query, 2, 3, motion->c);
        return;
    }
    int corners = kind == PCCD_VF ? 3 : kind == PCCD_VE ? 2 : 1;
    for (int i = 0; i < corners; i++) {
        subtract(query, 0, 1 + i, motion->w[motion->count++]);
    }
    memcpy(motion->p, motion->w[0], sizeof motion->p);
    if (corners > 1) {
        subtract(query, 2, 1, motion->b);
    }
    if (corners > 2) {
        subtract(query, 3, 1, motion->c);
    }
}

void eng_thick_motion_load(struct eng_thick_motion *motion,
                           const struct eng_thick_query *query)
{
    double size = 0;
    int exponent;
    load_points(motion, &query->query);
    for (int i = 0; i < motion->count; i++) {
        size = eng_most(size,
                        eng_most(eng_size(motion->w[i][0]), eng_size(motion->w[i][1])));
    }
    motion->is_nothing = size == 0;
    frexp(size, &exponent);
    double factor = abs(exponent) < 1000 ? ldexp(1, -exponent) : 0;
    for (int i = 0; i < motion->count; i++) {
        scale(motion->w[i], factor, -exponent);
    }
    scale(motion->p, factor, -exponent);
    scale(motion->b, factor, -exponent);
    scale(motion->c, factor, -exponent);
    double r = query->radius[0] + query->radius[1] + query->radius[2];
    r = scaled_radius(r, -exponent);
    motion->r_lo = r * (1 - ROUNDED) - ENG_TINY;
    motion->r_hi = r * (1 + ROUNDED) + ENG_TINY;
}

/* The difference vectors at a time. */
static void set_pose(const struct eng_thick_motion *motion, double t,
                     struct eng_pose *pose)
{
    double s = 1 - t;
    for (int k = 0; k < 3; k++) {
        pose->p[k] = s * motion->p[0][k] + t * motion->p[1][k];
        pose->b[k] = s * motion->b[0][k] + t * motion->b[1][k];
        pose->c[k] = s * motion->c[0][k] + t * motion->c[1][k];
    }
}

/* About the nearest points at a time; closest->gap leads from feature b to a. */
static void find_closest(const struct eng_thick_motion *motion, double t,
                         struct eng_closest *closest)
{
    struct eng_pose pose;
    set_pose(motion, t, &pose);
    eng_closest_to_origin(motion->form, &pose, closest);
    for (int k = 0; k < 3 && motion->form == PCCD_EE; k++) {
        closest->gap[k] = -closest->gap[k];
    }
}

/* ---- certain answers --------------------------------------------------------------- */

/* How far feature a is certainly beyond `reach` from b along g, at t = 0 and t = 1, by a
 * pair of their points. Positive and linear in between: the points are apart. */
static void project(const struct eng_thick_motion *motion, int i, const double g[3],
                    double reach, double apart[2])
{
    double margin = PROJECTED * (fabs(g[0]) + fabs(g[1]) + fabs(g[2])) + ENG_TINY;
    apart[0] = eng_dot(g, motion->w[i][0]) - margin - reach;
    apart[1] = eng_dot(g, motion->w[i][1]) - margin - reach;
}

/* Until when the features are certainly farther apart than r along g, from t on; 2: to
 * the end; t: not at all. */
static double keeps_apart(const struct eng_thick_motion *motion, const double g[3],
                          double t)
{
    double reach = motion->r_hi * (sqrt(eng_dot(g, g)) * (1 + ROUNDED) + ENG_TINY);
    reach *= 1 + ROUNDED;
    double until = 2;
    if (!(eng_dot(g, g) >= DIRECTION_MIN)) {
        return t;
    }
    for (int i = 0; i < motion->count; i++) {
        double apart[2];
        project(motion, i, g, reach, apart);
        if (apart[0] > 0 && apart[1] > 0) {
            continue;
        }
        if (apart[0] <= 0 && apart[1] <= 0) {
            return t;
        }
        double at = apart[0] / (apart[0] - apart[1]); /* where it is 0 */
        if (apart[0] > 0) {
            until = eng_least(until, at * (1 - ROUNDED));
        } else if (!(at * (1 + ROUNDED) < t)) {
            return t;
        }
    }
    return until > t ? until : t;
}

/* ---- planes that turn with the features -------------------------------------------- */

/* Between t and `end` of the time: what p . n less r |n| is not below, as a cubic, by its
 * Bernstein coefficients; those in the middle three times. n = b x c is across both
 * features, so where it is positive they are farther apart than r. */
static void height_of(const struct eng_thick_motion *motion, double t, double end,
                      double sign, double height[4])
{
    struct eng_pose pose[2];
    double n[3][3]; /* the one in the middle twice */
    double other[3];
    double reach[3];
    set_pose(motion, t, &pose[0]);
    set_pose(motion, end, &pose[1]);
    eng_cross(n[0], pose[0].b, pose[0].c);
    eng_cross(n[1], pose[0].b, pose[1].c);
    eng_cross(other, pose[1].b, pose[0].c);
    eng_cross(n[2], pose[1].b, pose[1].c);
    for (int k = 0; k < 3; k++) {
        n[1][k] += other[k];
    }
    for (int i = 0; i < 3; i++) {
        double length = sqrt(eng_dot(n[i], n[i])) * (1 + ROUNDED) + ACROSS;
        reach[i] = motion->r_hi * length * (1 + ROUNDED);
    }
    height[0] = sign * eng_dot(pose[0].p, n[0]) - reach[0] - HEIGHT;
    height[1] = sign * (eng_dot(pose[0].p, n[1]) + eng_dot(pose[1].p, n[0])) -
                (reach[0] + reach[1]) * (1 + ROUNDED) - 3 * HEIGHT;
    height[2] = sign * (eng_dot(pose[1].p, n[1]) + eng_dot(pose[0].p, n[2])) -
                (reach[1] + reach[2]) * (1 + ROUNDED) - 3 * HEIGHT;
    height[3] = sign * eng_dot(pose[1].p, n[2]) - reach[2] - HEIGHT;
}

/* Up to which part of the interval the cubic is certainly positive: it is not below the
 * line from its first coefficient to that of the others to which it falls fastest. 2: all
 * of it. */
static double positive_part(const double height[4])
{
    const double h[4] = {height[0], height[1] / 3, height[2] / 3, height[3]};
    double part = 2;
    if (h[1] > 0 && h[2] > 0 && h[3] > 0) {
        return 2;
    }
    for (int i = 1; i < 4; i++) {
        if (h[i] < h[0]) {
            part = eng_least(part, i / 3.0 * (h[0] / (h[0] - h[i])));
        }
    }
    return part;
}

/* As keeps_apart, by the plane across both features, which turns with them. */
static double plane_keeps_apart(const struct eng_thick_motion *motion, double t)
{
    double height[4];
    double sign = 1;
    double end = 1;
    height_of(motion, t, 1, sign, height);
    if (!(height[0] > 0)) {
        sign = -1;
        height_of(motion, t, 1, sign, height);
    }
    if (!(height[0] > 0)) {
        return t;
    }
    double part = positive_part(height);
    double fall = height[0] - height[1] / 3;
    if (part > 1) {
        return 2;
    }
    /* Twice as far as it takes if it goes on like this, no farther: nearby it is almost
     * linear. */
    double ahead = fall > 0 ? 2 * (1 - t) * (height[0] / (3 * fall)) : 1;
    if (t + ahead < 1) {
        end = t + ahead;
        height_of(motion, t, end, sign, height);
        part = height[0] > 0 ? positive_part(height) : 0;
    }
    double until = (t + eng_least(part, 1) * (end - t)) * (1 - 2 * ROUNDED);
    return until > t ? until : t;
}

/* Are nearest points certainly on no corner and no edge? Rounding does not matter. */
static bool is_inside(const struct eng_thick_motion *motion,
                      const struct eng_closest *closest)
{
    double beta = closest->beta;
    double gamma = closest->gamma;
    bool is_square = beta > 0 && gamma > 0 && beta < 1 && gamma < 1;
    return is_square && (motion->form == PCCD_EE || beta + gamma < 1);
}

/* The later of the two. */
static double stays_apart(const struct eng_thick_motion *motion,
                          const struct eng_closest *closest, double t)
{
    double until = keeps_apart(motion, closest->gap, t);
    if (until <= 1 && is_inside(motion, closest)) {
        until = eng_most(until, plane_keeps_apart(motion, t));
    }
    return until;
}

/* The distance at time t is certainly at most this. */
static double way_at_most(const struct eng_closest *closest)
{
    return sqrt(eng_dot(closest->gap, closest->gap)) * (1 + ROUNDED) + WAY + ENG_TINY;
}

/* The distance at t = 0 is certainly at least this, by the direction of the gap. */
static double start_at_least(const struct eng_thick_motion *motion, const double g[3])
{
    double least = INFINITY;
    for (int i = 0; i < motion->count; i++) {
        double apart[2];
        project(motion, i, g, 0, apart);
        least = eng_least(least, apart[0]);
    }
    double length = sqrt(eng_dot(g, g)) * (1 + ROUNDED) + ENG_TINY;
    return least > 0 && eng_dot(g, g) >= DIRECTION_MIN ? least / length * (1 - ROUNDED)
                                                       : 0;
}

/* ---- the search -------------------------------------------------------------------- */

/* Is the distance certainly at most r at the end of a cell? Then the first time is not
 * after it. */
static bool is_within_at_end(const struct eng_thick_motion *motion, int64_t cell,
                             int depth)
{
    struct eng_closest closest;
    double begin = eng_thick_cell_begin(cell + 1, depth);
    double end = begin < 1 ? nextafter(begin, 0) : 1;
    find_closest(motion, end, &closest);
    return way_at_most(&closest) <= motion->r_lo;
}

/* What the pair is at t = 0. UNSURE: nobody knows; MEETS: it goes on. */
static enum eng_thick_advanced look_at_start(struct eng_thick_motion *motion,
                                             double approach, double *until,
                                             struct eng_thick_advance *advance)
{
    struct eng_closest closest;
    find_closest(motion, 0, &closest);
    *until = stays_apart(motion, &closest, 0);
    if (*until > 0) {
        return ENG_THICK_MEETS;
    }
    double most = way_at_most(&closest);
    if (!(most <= motion->r_lo)) {
        return ENG_THICK_UNSURE;
    }
    advance->is_inside = true;
    if (approach == 0) {
        return ENG_THICK_INITIALLY;
    }
    double least = start_at_least(motion, closest.gap);
    motion->r_lo = approach * least * (1 - ROUNDED) - ENG_TINY;
    motion->r_hi = approach * most * (1 + ROUNDED) + ENG_TINY;
    *until = stays_apart(motion, &closest, 0);
    return *until > 0 ? ENG_THICK_MEETS : ENG_THICK_UNSURE;
}

enum eng_thick_advanced eng_thick_advance(struct eng_thick_motion *motion,
                                          double approach, int depth, double since,
                                          double t_end, struct eng_thick_advance *advance)
{
    double until = since;
    *advance = (struct eng_thick_advance){0};
    if (motion->is_nothing) {
        return ENG_THICK_UNSURE;
    }
    enum eng_thick_advanced start =
        since > 0 ? ENG_THICK_MEETS : look_at_start(motion, approach, &until, advance);
    if (start != ENG_THICK_MEETS) {
        return start;
    }
    int64_t last = eng_thick_cell_of(t_end, depth);
    int64_t tried = -2;
    for (int turn = 0; turn < TURNS_MAX && until < 1; turn++) {
        struct eng_closest closest;
        int64_t cell = eng_thick_cell_of(until, depth);
        advance->reached = until;
        if (cell > last) {
            return ENG_THICK_MISSES;
        }
        find_closest(motion, until, &closest);
        double next = stays_apart(motion, &closest, until);
        /* Where it hardly moves, it is there. */
        if ((next >= 1 ? cell + 1 : eng_thick_cell_of(next, depth)) == cell &&
            cell != tried) {
            if (is_within_at_end(motion, cell, depth)) {
                advance->cell = cell;
                return ENG_THICK_MEETS;
            }
            tried = cell;
        }
        if (next == until) {
            return ENG_THICK_UNSURE;
        }
        until = next;
    }
    return until >= 1 ? ENG_THICK_MISSES : ENG_THICK_UNSURE;
}

void eng_thick_describe(const struct eng_thick_motion *motion, uint32_t kind, double t,
                        struct eng_hit *hit)
{
    struct eng_closest closest;
    find_closest(motion, t, &closest);
    double length = sqrt(eng_dot(closest.gap, closest.gap));
    for (int k = 0; k < 3; k++) {
        hit->normal[k] = length > WAY ? (float)(closest.gap[k] / length) : 0;
    }
    hit->param[0] = kind == PCCD_VE ? 0 : (float)closest.beta;
    hit->param[1] = (float)(kind == PCCD_VE ? closest.beta : closest.gamma);
}
