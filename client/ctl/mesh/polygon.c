/* client/ctl/mesh/polygon.c - ears of a polygon.
 *
 * Source: Shewchuk, "Adaptive Precision Floating-Point Arithmetic" (1997), for the bound
 *         of the error.
 */
#include "polygon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SUM_WORDS   37 /* of 64 bits: products up to 2^120, in units of 2^-2148 */
#define ERROR_BOUND 4e-16
#define TINY        1e-290 /* above what is lost below the least double */

__extension__ typedef unsigned __int128 wide;

/* A corner as it is seen: those that are left are a ring. */
struct cutter_corner {
    double p[2];
    uint32_t number; /* in x */
    uint32_t before, after;
    bool is_convex;
};

/* ---- signs ------------------------------------------------------------------------- */

static int sign(double value)
{
    return (value > 0) - (value < 0);
}

/* |value| as whole number times 2^(exponent - 1074). */
static uint64_t split(double value, unsigned *exponent)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    unsigned biased = (unsigned)(bits >> 52) & 0x7ff;
    uint64_t fraction = bits & (((uint64_t)1 << 52) - 1);
    *exponent = biased > 0 ? biased - 1 : 0;
    return biased > 0 ? fraction | (uint64_t)1 << 52 : fraction;
}

/* Add a * b to the sums of what is positive and of what is negative. */
static void add_product(uint64_t sums[2][SUM_WORDS], double a, double b)
{
    unsigned exponent_a, exponent_b;
    wide product = split(a, &exponent_a), carry = 0;
    product *= split(b, &exponent_b);
    unsigned shift = exponent_a + exponent_b, bit = shift % 64;
    uint64_t *sum = sums[sign(a) * sign(b) < 0] + shift / 64;
    const uint64_t words[3] = {(uint64_t)(product << bit),
                               (uint64_t)(product << bit >> 64),
                               bit > 0 ? (uint64_t)(product >> (128 - bit)) : 0};
    for (int i = 0; i < 3 || carry > 0; i++) {
        carry += (wide)sum[i] + (i < 3 ? words[i] : 0);
        sum[i] = (uint64_t)carry;
        carry >>= 64;
    }
}

static int exact_turn(const double a[2], const double b[2], const double c[2])
{
    uint64_t sums[2][SUM_WORDS] = {{0}};
    add_product(sums, a[0], b[1]);
    add_product(sums, -a[0], c[1]);
    add_product(sums, -c[0], b[1]);
    add_product(sums, -a[1], b[0]);
    add_product(sums, a[1], c[0]);
    add_product(sums, c[1], b[0]);
    for (int i = SUM_WORDS - 1; i >= 0; i--) {
        if (sums[0][i] != sums[1][i]) {
            return sums[0][i] > sums[1][i] ? 1 : -1;
        }
    }
    return 0;
}

/* 1: a, b, c turn to the left; -1: to the right; 0: they are on one line. */
static int turn(const double a[2], const double b[2], const double c[2])
{
    double left[2] = {a[0] - c[0], b[1] - c[1]}, right[2] = {a[1] - c[1], b[0] - c[0]};
    double plus = left[0] * left[1], minus = right[0] * right[1];
    double all = fabs(plus) + fabs(minus);
    if (fabs(plus - minus) > ERROR_BOUND * all + TINY) {
        return sign(plus - minus);
    }
    /* The signs of differences are exact, and so are those of their products. */
    int sign_plus = sign(left[0]) * sign(left[1]);
    int sign_minus = sign(right[0]) * sign(right[1]);
    return sign_plus != sign_minus ? sign(sign_plus - sign_minus)
           : sign_plus == 0        ? 0
                                   : exact_turn(a, b, c);
}

/* By the first coordinate, then by the second. */
static int compare(const double a[2], const double b[2])
{
    int first = (a[0] > b[0]) - (a[0] < b[0]);
    return first != 0 ? first : (a[1] > b[1]) - (a[1] < b[1]);
}

/* ---- simple polygons --------------------------------------------------------------- */

/* Return whether a point on the line through a and b is between them, or one of them. */
static bool is_between(const double a[2], const double b[2], const double point[2])
{
    return compare(a, point) * compare(point, b) >= 0;
}

static bool do_sides_meet(const double a[2], const double b[2], const double c[2],
                          const double d[2])
{
    int c_is = turn(a, b, c), d_is = turn(a, b, d);
    int a_is = turn(c, d, a), b_is = turn(c, d, b);
    return (c_is * d_is < 0 && a_is * b_is < 0) || (c_is == 0 && is_between(a, b, c)) ||
           (d_is == 0 && is_between(a, b, d)) || (a_is == 0 && is_between(c, d, a)) ||
           (b_is == 0 && is_between(c, d, b));
}

/* Side of a polygon: its number, and where it begins and ends. */
struct cutter_side {
    double from[2], to[2];
    uint32_t number;
};

static int compare_sides(const void *a, const void *b)
{
    return compare(((const struct cutter_side *)a)->from,
                   ((const struct cutter_side *)b)->from);
}

static bool is_simple(struct ctl_cutter *cutter, uint32_t count)
{
    const struct cutter_corner *corners = cutter->corners;
    struct cutter_side *sides = cutter->sides;
    bool turns_back = false;
    for (uint32_t i = 0; i < count; i++) {
        const struct cutter_corner *corner = &corners[i];
        const double *before = corners[corner->before].p, *p = corner->p;
        const double *after = corners[corner->after].p;
        bool turns = turn(before, p, after) != 0;
        cutter->turns = cutter->turns || turns;
        turns_back =
            turns_back || (!turns && compare(before, p) * compare(p, after) <= 0);
        for (int axis = 0; axis < 2; axis++) {
            sides[i].from[axis] = fmin(p[axis], after[axis]);
            sides[i].to[axis] = fmax(p[axis], after[axis]);
        }
        sides[i].number = i;
    }
    if (turns_back) {
        return false;
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    for (const struct cutter_side *a = sides; a < sides + count; a++) {
        const struct cutter_corner *p = &corners[a->number];
        for (const struct cutter_side *b = a + 1;
             b < sides + count && b->from[0] <= a->to[0]; b++) {
            const struct cutter_corner *q = &corners[b->number];
            if (p->after != b->number && q->after != a->number &&
                b->from[1] <= a->to[1] && a->from[1] <= b->to[1] &&
                do_sides_meet(p->p, corners[p->after].p, q->p, corners[q->after].p)) {
                return false;
            }
        }
    }
    return true;
}

/* ---- ears -------------------------------------------------------------------------- */

static int turn_at(const struct cutter_corner *corners, uint32_t i)
{
    return turn(corners[corners[i].before].p, corners[i].p, corners[corners[i].after].p);
}

/* Return whether nothing of the polygon is in the way of cutting corner i off; `side` is
 * the turn of a convex corner. */
static bool is_ear(const struct cutter_corner *corners, uint32_t i, int side)
{
    uint32_t from = corners[i].before, to = corners[i].after;
    const double *a = corners[from].p, *b = corners[i].p, *c = corners[to].p;
    if (!corners[i].is_convex) {
        return false;
    }
    for (uint32_t v = corners[to].after; v != from; v = corners[v].after) {
        const double *p = corners[v].p;
        if (!corners[v].is_convex && side * turn(c, a, p) >= 0 &&
            side * turn(a, b, p) >= 0 && side * turn(b, c, p) >= 0) {
            return false;
        }
    }
    return true;
}

/* One more triangle, by the numbers of its corners. */
static void put(struct ctl_cutter *cutter, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *triangle = cutter->cut[cutter->made++];
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

/* Cut the corners off a simple polygon: begin where it is leftmost, and leave out the
 * corner after each that was cut off, so that not all triangles share one. */
static bool cut_ears(struct ctl_cutter *cutter, uint32_t count)
{
    struct cutter_corner *corners = cutter->corners;
    uint32_t i = 0, left = count, missed = 0;
    for (uint32_t k = 1; k < count; k++) {
        i = compare(corners[k].p, corners[i].p) < 0 ? k : i;
    }
    int side = turn_at(corners, i);
    for (uint32_t k = 0; k < count; k++) {
        corners[k].is_convex = turn_at(corners, k) == side;
    }
    while (left >= 3 && missed < left) {
        struct cutter_corner *corner = &corners[i];
        uint32_t before = corner->before, after = corner->after;
        if (left > 3 && !is_ear(corners, i, side)) {
            i = after;
            missed++;
            continue;
        }
        put(cutter, corners[before].number, corner->number, corners[after].number);
        corners[before].after = after;
        corners[after].before = before;
        corners[before].is_convex = turn_at(corners, before) == side;
        corners[after].is_convex = turn_at(corners, after) == side;
        i = corners[after].after;
        left--;
        missed = 0;
    }
    return left < 3 && side != 0;
}

/* ---- planes ------------------------------------------------------------------------ */

static bool is_same(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void see(const double x[3], int axis, double p[2])
{
    p[0] = x[(axis + 1) % 3];
    p[1] = x[(axis + 2) % 3];
}

/* Find how much the polygon faces each axis. */
static void find_facing(double (*x)[3], uint32_t count, double facing[3])
{
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        double sum = 0;
        for (uint32_t i = 1; i + 1 < count; i++) {
            sum += (x[i][u] - x[0][u]) * (x[i + 1][v] - x[0][v]) -
                   (x[i][v] - x[0][v]) * (x[i + 1][u] - x[0][u]);
        }
        facing[k] = fabs(sum);
    }
}

/* The corners as they are seen along an axis, but for those that are where the one before
 * them is, or at the end the first: each of these makes a triangle without area. */
static bool cut_along(struct ctl_cutter *cutter, uint32_t count, int axis)
{
    struct cutter_corner *corners = cutter->corners;
    uint32_t left = 0, last = 0, end = count;
    cutter->made = 0;
    while (end > 1 && is_same(cutter->x[end - 1], cutter->x[0])) {
        end--;
    }
    for (uint32_t i = 0; i < count; i++) {
        const double *x = cutter->x[i];
        if (i == 0 || (i < end && !is_same(x, cutter->x[last]))) {
            last = i;
            corners[left] = (struct cutter_corner){
                .number = i, .before = left - 1, .after = left + 1};
            see(x, axis, corners[left++].p);
        } else if (cutter->made < count - 2) {
            put(cutter, last, i, (i + 1) % count);
        }
    }
    corners[0].before = left - 1;
    corners[left - 1].after = 0;
    return left >= 3 && is_simple(cutter, left) && cut_ears(cutter, left);
}

/* Two triangles on both sides of a line between two corners are all of a polygon of four;
 * where both lines do, it is convex. */
static bool cut_four(struct ctl_cutter *cutter, int axis)
{
    double p[4][2];
    for (int i = 0; i < 4; i++) {
        see(cutter->x[i], axis, p[i]);
    }
    cutter->made = 0;
    for (uint32_t k = 0; k < 2 && cutter->made == 0; k++) {
        uint32_t last = (k + 3) % 4;
        if (turn(p[k], p[k + 1], p[k + 2]) * turn(p[k + 2], p[last], p[k]) > 0) {
            put(cutter, k, k + 1, k + 2);
            put(cutter, k, k + 2, last);
        }
    }
    return cutter->made > 0;
}

/* Return whether four corners are surely not in one plane. Two triangles that share an
 * edge meet nowhere else then. */
static bool is_bent(double (*x)[3])
{
    double d[3][3], sum = 0, most_of_it = 0;
    for (int i = 0; i < 9; i++) {
        d[i / 3][i % 3] = x[i / 3 + 1][i % 3] - x[0][i % 3];
    }
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        double plus = d[0][k] * d[1][u] * d[2][v], minus = d[0][k] * d[1][v] * d[2][u];
        sum += plus - minus;
        most_of_it += fabs(plus) + fabs(minus);
    }
    return fabs(sum) > 1e-14 * most_of_it;
}

bool ctl_cutter_cut(struct ctl_cutter *cutter, uint32_t count)
{
    double facing[3];
    bool is_cut = false;
    cutter->turns = false;
    find_facing(cutter->x, count, facing);
    for (int tries = 0; tries < 3 && !is_cut; tries++) {
        int axis = facing[1] > facing[0] ? 1 : 0;
        axis = facing[2] > facing[axis] ? 2 : axis;
        facing[axis] = -1;
        is_cut = (count == 4 && cut_four(cutter, axis)) || cut_along(cutter, count, axis);
    }
    /* What turns along no axis is on a line. */
    if (!is_cut && (!cutter->turns || (count == 4 && is_bent(cutter->x)))) {
        cutter->made = 0;
        for (uint32_t i = 0; i + 2 < count; i++) {
            put(cutter, 0, i + 1, i + 2);
        }
        is_cut = true;
    }
    return is_cut;
}

/* ---- memory ------------------------------------------------------------------------ */

bool ctl_cutter_reserve(struct ctl_cutter *cutter, uint32_t count)
{
    if (count > cutter->capacity) {
        size_t wanted = (size_t)count * 2 + 16;
        ctl_cutter_deinit(cutter);
        cutter->x = malloc(wanted * (sizeof *cutter->x + sizeof *cutter->corners +
                                     sizeof *cutter->sides + sizeof *cutter->cut));
        if (cutter->x != NULL) { /* one block for all */
            cutter->corners = (struct cutter_corner *)(cutter->x + wanted);
            cutter->sides = (struct cutter_side *)(cutter->corners + wanted);
            cutter->cut = (uint32_t(*)[3])(cutter->sides + wanted);
            cutter->capacity = (uint32_t)wanted;
        }
    }
    return count <= cutter->capacity;
}

void ctl_cutter_deinit(struct ctl_cutter *cutter)
{
    free(cutter->x);
    *cutter = (struct ctl_cutter){0};
}
