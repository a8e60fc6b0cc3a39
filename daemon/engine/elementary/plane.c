/* plane.c - contacts within the plane of two axes.
 *
 * Source: BOUNDS.md for the margins.
 *
 * Let three points have one coordinate in common all the time: a point X of one feature
 * and the ends of an edge of the other (VF: the vertex and two corners; EE: an end and
 * the other edge). With g the fourth point's distance from that plane, the cubic is
 * +-g (X - E0) x (X - E1), the product in the plane. Where g is not zero, a root of the
 * cubic is a time at which X is on the line E0 E1, and the plane cuts the features in
 * just X and the edge: they meet iff X is between E0 and E1,
 * (X - E0) . (X - E1) <= 0. Where g has one sign all the time, that is all there is.
 *
 * If all four have it in common, everything happens in the plane. Features that do not
 * touch at t = 0 then touch first where such a point X comes to lie on such an edge: at
 * the first moment, insides that overlap would have overlapped before.
 */
#include "solve.h"

#include <math.h>
#include <stddef.h>

#include "vec.h"

/* Longer spans would need more terms in the bounds. */
#define WIDTH_MAX 0x1p-10

/* The fourth point, X, and the edge; VF has the first three. */
static const int roles[2][4][4] = {
    {{1, 0, 2, 3}, {2, 0, 1, 3}, {3, 0, 1, 2}},
    {{0, 1, 2, 3}, {1, 0, 2, 3}, {2, 3, 0, 1}, {3, 2, 0, 1}}};

static bool share_plane(const struct eng_query *query, const int role[4], int axis)
{
    for (int end = 0; end < 2; end++) {
        const double(*x)[3] = query->x[end];
        if (x[role[1]][axis] != x[role[2]][axis] ||
            x[role[1]][axis] != x[role[3]][axis]) {
            return false;
        }
    }
    return true;
}

/* A coordinate of a difference of two points in the middle of a span. */
static double middle_of(const struct eng_query *query, int a, int b, int axis, double t,
                        double *size)
{
    double d0 = query->x[0][a][axis] - query->x[0][b][axis];
    double d1 = query->x[1][a][axis] - query->x[1][b][axis];
    *size = eng_most(*size, eng_most(fabs(d0), fabs(d1)));
    return (1 - t) * d0 + t * d1;
}

/* Decide whether X is between E0 and E1 all the time from l to r. */
static enum eng_plane between(const struct eng_query *query, const int role[4], int axis,
                              double l, double r)
{
    double t = 0.5 * (l + r);
    double size[2] = {0, 0};
    double dot = 0;
    for (int k = 1; k < 3; k++) {
        int other = (axis + k) % 3;
        dot += middle_of(query, role[1], role[2], other, t, &size[0]) *
               middle_of(query, role[1], role[3], other, t, &size[1]);
    }
    double margin = (5 * (r - l) + 64 * ENG_U) * size[0] * size[1] + ENG_TINY;
    return dot < -margin  ? ENG_PLANE_MEET
           : dot > margin ? ENG_PLANE_MISS
                          : ENG_PLANE_UNSURE;
}

static enum eng_plane look(const struct eng_query *query, const int role[4], int axis,
                           double l, double r)
{
    double size = 0;
    double gap = middle_of(query, role[0], role[1], axis, 0.5 * (l + r), &size);
    if (!(fabs(gap) > (2 * (r - l) + 16 * ENG_U) * size + ENG_TINY)) {
        return ENG_PLANE_UNSURE;
    }
    return between(query, role, axis, l, r);
}

enum eng_plane eng_plane_look(const struct eng_query *query, double l, double r)
{
    int role_count = query->kind == PCCD_VF ? 3 : 4;
    if (r - l > WIDTH_MAX) {
        return ENG_PLANE_UNSURE;
    }
    for (int i = 0; i < role_count; i++) {
        const int *role = roles[query->kind][i];
        for (int axis = 0; axis < 3; axis++) {
            enum eng_plane plane = share_plane(query, role, axis)
                                       ? look(query, role, axis, l, r)
                                       : ENG_PLANE_UNSURE;
            if (plane != ENG_PLANE_UNSURE) {
                return plane;
            }
        }
    }
    return ENG_PLANE_UNSURE;
}

/* (X - E0) x (X - E1) in the plane: a quadratic in Bernstein form, turned so that it is
 * not negative at t = 0. */
struct side {
    double q[3];
    double error; /* of q and of its blossoms */
};

static struct side side_of(const struct eng_query *query, const int role[4], int axis)
{
    int i = (axis + 1) % 3;
    int j = (axis + 2) % 3;
    double u[2][2];
    double v[2][2];
    double size_u = 0;
    double size_v = 0;
    for (int end = 0; end < 2; end++) {
        const double(*x)[3] = query->x[end];
        u[end][0] = x[role[1]][i] - x[role[2]][i];
        u[end][1] = x[role[1]][j] - x[role[2]][j];
        v[end][0] = x[role[1]][i] - x[role[3]][i];
        v[end][1] = x[role[1]][j] - x[role[3]][j];
        size_u = eng_most(size_u, eng_most(fabs(u[end][0]), fabs(u[end][1])));
        size_v = eng_most(size_v, eng_most(fabs(v[end][0]), fabs(v[end][1])));
    }
    struct side side;
    side.q[0] = u[0][0] * v[0][1] - u[0][1] * v[0][0];
    side.q[1] = 0.5 * ((u[0][0] * v[1][1] - u[0][1] * v[1][0]) +
                       (u[1][0] * v[0][1] - u[1][1] * v[0][0]));
    side.q[2] = u[1][0] * v[1][1] - u[1][1] * v[1][0];
    side.error = 32 * ENG_U * size_u * size_v + ENG_TINY;
    if (side.q[0] < 0) {
        for (int k = 0; k < 3; k++) {
            side.q[k] = -side.q[k];
        }
    }
    return side;
}

/* Decide whether X meets the edge, and when at first. Queries in which it might twice are
 * unsure. */
static enum eng_plane meet(const struct eng_query *query, const int role[4], int axis,
                           double tolerance, double *l, double *r)
{
    struct side side = side_of(query, role, axis);
    const double *q = side.q;
    double e = side.error;
    if (q[0] > e && q[1] > e && q[2] > e) {
        return ENG_PLANE_MISS;
    }
    if (!(q[0] > e && q[2] < -e)) {
        return ENG_PLANE_UNSURE;
    }
    double b = q[1] - q[0];
    double root = sqrt(eng_most(b * b - (b - (q[2] - q[1])) * -q[0], 0));
    double t = q[0] / (root - b);
    double reach = e / root + 0x1p-50;
    double x = eng_most(0, t - reach);
    double y = eng_least(1, t + reach);
    /* Before x all on one side, behind y all on the other; y - x may be anything else. */
    double x0 = (1 - x) * q[0] + x * q[1];
    double xx = (1 - x) * x0 + x * ((1 - x) * q[1] + x * q[2]);
    double y1 = (1 - y) * q[1] + y * q[2];
    double yy = (1 - y) * ((1 - y) * q[0] + y * q[1]) + y * y1;
    if (!(x0 > e && xx > e && y1 < -e && yy < -e && y - x <= WIDTH_MAX &&
          y - x <= tolerance)) {
        return ENG_PLANE_UNSURE;
    }
    *l = x;
    *r = y;
    return between(query, role, axis, x, y);
}

static enum eng_plane first_along(const struct eng_query *query, int axis,
                                  double tolerance, double *l, double *r)
{
    enum eng_plane plane = ENG_PLANE_MISS;
    int role_count = query->kind == PCCD_VF ? 3 : 4;
    for (int i = 0; i < role_count; i++) {
        double x;
        double y;
        switch (meet(query, roles[query->kind][i], axis, tolerance, &x, &y)) {
        case ENG_PLANE_UNSURE:
            return ENG_PLANE_UNSURE;
        case ENG_PLANE_MEET:
            /* Nothing before the first of the beginnings, something by the first end. */
            *l = plane == ENG_PLANE_MISS ? x : eng_least(*l, x);
            *r = plane == ENG_PLANE_MISS ? y : eng_least(*r, y);
            plane = ENG_PLANE_MEET;
            break;
        case ENG_PLANE_MISS:
            break;
        }
    }
    return plane;
}

static bool is_same(const struct eng_query *query, int i, int j, int axis)
{
    return query->x[0][i][axis] == query->x[0][j][axis] &&
           query->x[1][i][axis] == query->x[1][j][axis];
}

/* Return the roles of a point X and an edge with one coordinate in common, whose fourth
 * point is on one side of them all the time; NULL: there are none. Nothing is rounded. */
static const int *roles_aside(const struct eng_query *query, int axis)
{
    bool is_same01 = is_same(query, 0, 1, axis);
    bool is_same23 = is_same(query, 2, 3, axis);
    int fourth;
    if (is_same23 && is_same(query, 1, 2, axis)) {
        fourth = 0;
    } else if (is_same23 && is_same(query, 0, 2, axis)) {
        fourth = 1;
    } else if (is_same01 && is_same(query, 1, 3, axis)) {
        fourth = 2;
    } else if (is_same01 && is_same(query, 1, 2, axis)) {
        fourth = 3;
    } else {
        return NULL;
    }
    if (query->kind == PCCD_VF && fourth == 0) {
        return NULL; /* a face in the plane */
    }
    const int *role = roles[query->kind][query->kind == PCCD_VF ? fourth - 1 : fourth];
    double x0 = query->x[0][role[1]][axis];
    double x1 = query->x[1][role[1]][axis];
    bool is_above = query->x[0][fourth][axis] > x0 && query->x[1][fourth][axis] > x1;
    bool is_below = query->x[0][fourth][axis] < x0 && query->x[1][fourth][axis] < x1;
    return is_above || is_below ? role : NULL;
}

enum eng_plane eng_plane_first(const struct eng_query *query, double tolerance, double *l,
                               double *r)
{
    for (int axis = 0; axis < 3; axis++) {
        const int *role = roles_aside(query, axis);
        enum eng_plane plane =
            role ? meet(query, role, axis, tolerance, l, r) : ENG_PLANE_UNSURE;
        if (plane != ENG_PLANE_UNSURE) {
            return plane;
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        const int all_but_last[4] = {3, 0, 1, 2};
        const int all_but_first[4] = {0, 1, 2, 3};
        if (share_plane(query, all_but_last, axis) &&
            share_plane(query, all_but_first, axis)) {
            return first_along(query, axis, tolerance, l, r);
        }
    }
    return ENG_PLANE_UNSURE;
}
