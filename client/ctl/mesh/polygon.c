/* client/ctl/mesh/polygon.c - ears of a polygon.
 *
 * Room:     client/ctl.
 * Does:     decide on which side of a line a point is, exactly; find out whether a
 *           polygon is simple; cut off ears.
 * Threads:  [any]; nothing is shared.
 * Source:   polygon.h; Shewchuk, "Adaptive Precision Floating-Point Arithmetic" (1997),
 *           for the bound of the error.
 */
#include "polygon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SUM_WORDS   72 /* products of doubles up to 2^60, in units of 2^-2148 */
#define ERROR_BOUND 4e-16
#define TINY        1e-290 /* above what is lost below the least double */

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

/* Add value * 2^shift. */
static void add_word(uint32_t sum[SUM_WORDS], uint64_t value, unsigned shift)
{
    unsigned word = shift / 32, bit = shift % 32;
    uint64_t low = value << bit, high = bit > 0 ? value >> (64 - bit) : 0;
    const uint64_t words[3] = {low & UINT32_MAX, low >> 32, high};
    uint64_t carry = 0;
    for (unsigned i = 0; word < SUM_WORDS && (i < 3 || carry > 0); i++, word++) {
        carry += (uint64_t)sum[word] + (i < 3 ? words[i] : 0);
        sum[word] = (uint32_t)carry;
        carry >>= 32;
    }
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
static void add_product(uint32_t sums[2][SUM_WORDS], double a, double b)
{
    unsigned exponent_a, exponent_b;
    uint64_t m = split(a, &exponent_a), n = split(b, &exponent_b);
    uint32_t *sum = sums[sign(a) * sign(b) < 0];
    unsigned shift = exponent_a + exponent_b;
    add_word(sum, (m & UINT32_MAX) * (n & UINT32_MAX), shift);
    add_word(sum, (m >> 32) * (n & UINT32_MAX), shift + 32);
    add_word(sum, (m & UINT32_MAX) * (n >> 32), shift + 32);
    add_word(sum, (m >> 32) * (n >> 32), shift + 64);
}

static int exact_turn(const double a[2], const double b[2], const double c[2])
{
    uint32_t sums[2][SUM_WORDS] = {{0}};
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

/* Of a point on the line through a and b: whether it is between them, or one of them. */
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

static double least(const struct cutter_corner *corners, uint32_t side, int axis)
{
    double a = corners[side].p[axis], b = corners[corners[side].after].p[axis];
    return a < b ? a : b;
}

static double most(const struct cutter_corner *corners, uint32_t side, int axis)
{
    double a = corners[side].p[axis], b = corners[corners[side].after].p[axis];
    return a > b ? a : b;
}

/* Order sides by where they begin: by merging runs, as qsort() takes no context. */
static void sort_sides(const struct cutter_corner *corners, uint32_t *order,
                       uint32_t *room, uint32_t count)
{
    for (uint32_t run = 1; run < count; run *= 2) {
        for (uint32_t from = 0; from < count; from += 2 * run) {
            uint32_t middle = count - from < run ? count : from + run;
            uint32_t end = count - from < 2 * run ? count : from + 2 * run;
            uint32_t i = from, j = middle;
            for (uint32_t k = from; k < end; k++) {
                bool is_left =
                    j == end || (i < middle && least(corners, order[i], 0) <=
                                                   least(corners, order[j], 0));
                room[k] = order[is_left ? i++ : j++];
            }
        }
        memcpy(order, room, count * sizeof *order);
    }
}

static bool is_simple(const struct cutter_corner *corners, uint32_t *order,
                      uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const struct cutter_corner *corner = &corners[i];
        const double *before = corners[corner->before].p,
                     *after = corners[corner->after].p;
        order[i] = i;
        if (turn(before, corner->p, after) == 0 &&
            compare(before, corner->p) * compare(corner->p, after) <= 0) {
            return false; /* it turns back */
        }
    }
    sort_sides(corners, order, order + count, count);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t a = order[i];
        for (uint32_t j = i + 1;
             j < count && least(corners, order[j], 0) <= most(corners, a, 0); j++) {
            uint32_t b = order[j];
            if (corners[a].after != b && corners[b].after != a &&
                least(corners, b, 1) <= most(corners, a, 1) &&
                least(corners, a, 1) <= most(corners, b, 1) &&
                do_sides_meet(corners[a].p, corners[corners[a].after].p, corners[b].p,
                              corners[corners[b].after].p)) {
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

/* Whether nothing of the polygon is in the way of cutting corner i off; `side` is the
 * turn of a convex corner. */
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

static void put(struct ctl_cutter *cutter, uint32_t *made, uint32_t a, uint32_t b,
                uint32_t c)
{
    uint32_t *triangle = cutter->cut[(*made)++];
    triangle[0] = cutter->corners[a].number;
    triangle[1] = cutter->corners[b].number;
    triangle[2] = cutter->corners[c].number;
}

/* Of a simple polygon: begin where it is leftmost, and leave out the corner after each
 * that was cut off, so that not all triangles share one. */
static bool cut_ears(struct ctl_cutter *cutter, uint32_t count, uint32_t *made)
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
    while (left > 3 && missed < left) {
        uint32_t before = corners[i].before, after = corners[i].after;
        if (!is_ear(corners, i, side)) {
            i = after;
            missed++;
            continue;
        }
        put(cutter, made, before, i, after);
        corners[before].after = after;
        corners[after].before = before;
        corners[before].is_convex = turn_at(corners, before) == side;
        corners[after].is_convex = turn_at(corners, after) == side;
        i = corners[after].after;
        left--;
        missed = 0;
    }
    put(cutter, made, corners[i].before, i, corners[i].after);
    return left == 3 && side != 0;
}

/* ---- planes ------------------------------------------------------------------------ */

static bool is_same(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The axes, from the one that the polygon faces most. */
static void order_axes(double (*x)[3], uint32_t count, int axes[3])
{
    double normal[3] = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < count; i++) {
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += (x[i][u] - x[0][u]) * (x[i + 1][v] - x[0][v]) -
                         (x[i][v] - x[0][v]) * (x[i + 1][u] - x[0][u]);
        }
    }
    for (int k = 0; k < 3; k++) {
        axes[k] = k;
        for (int j = k; j > 0 && fabs(normal[axes[j]]) > fabs(normal[axes[j - 1]]); j--) {
            int other = axes[j];
            axes[j] = axes[j - 1];
            axes[j - 1] = other;
        }
    }
}

/* The corners as they are seen along an axis, but for those that are where the one before
 * them is, or at the end the first, each of which makes a triangle without area. Returns
 * how many are left. */
static uint32_t look(struct ctl_cutter *cutter, uint32_t count, int axis, uint32_t *made)
{
    struct cutter_corner *corners = cutter->corners;
    uint32_t left = 0, last = 0, end = count;
    while (end > 1 && is_same(cutter->x[end - 1], cutter->x[0])) {
        end--;
    }
    for (uint32_t i = 0; i < count; i++) {
        const double *x = cutter->x[i];
        if (i < end && (left == 0 || !is_same(x, cutter->x[last]))) {
            last = i;
            corners[left] = (struct cutter_corner){
                {x[(axis + 1) % 3], x[(axis + 2) % 3]}, i, left - 1, left + 1, false};
            left++;
            continue;
        }
        uint32_t next = i;
        while (next < end && is_same(cutter->x[next], x)) {
            next++;
        }
        if (*made < count - 2) {
            uint32_t *triangle = cutter->cut[(*made)++];
            triangle[0] = i - 1;
            triangle[1] = i;
            triangle[2] = next < end ? next : 0;
        }
    }
    corners[0].before = left - 1;
    corners[left - 1].after = 0;
    return left;
}

static bool cut_along(struct ctl_cutter *cutter, uint32_t count, int axis)
{
    uint32_t made = 0, left = look(cutter, count, axis, &made);
    return left >= 3 && is_simple(cutter->corners, cutter->order, left) &&
           cut_ears(cutter, left, &made);
}

/* Two triangles on both sides of a line between two corners are all of a polygon of four;
 * where both lines do, it is convex. */
static bool cut_four(struct ctl_cutter *cutter, int axis)
{
    static const uint32_t cuts[2][2][3] = {{{0, 1, 2}, {0, 2, 3}},
                                           {{1, 2, 3}, {1, 3, 0}}};
    double p[4][2];
    for (int i = 0; i < 4; i++) {
        p[i][0] = cutter->x[i][(axis + 1) % 3];
        p[i][1] = cutter->x[i][(axis + 2) % 3];
    }
    for (int k = 0; k < 2; k++) {
        if (turn(p[k], p[k + 1], p[k + 2]) * turn(p[k + 2], p[(k + 3) % 4], p[k]) > 0) {
            memcpy(cutter->cut, cuts[k], sizeof cuts[k]);
            return true;
        }
    }
    return false;
}

/* ---- what has no plane ------------------------------------------------------------- */

static void cut_fan(struct ctl_cutter *cutter, uint32_t count)
{
    for (uint32_t i = 0; i + 2 < count; i++) {
        cutter->cut[i][0] = 0;
        cutter->cut[i][1] = i + 1;
        cutter->cut[i][2] = i + 2;
    }
}

static bool is_on_a_line(double (*x)[3], uint32_t count)
{
    bool is_so = true;
    uint32_t other = 0; /* elsewhere than the first */
    for (uint32_t i = 1; i < count && other == 0; i++) {
        other = is_same(x[i], x[0]) ? 0 : i;
    }
    for (uint32_t i = 0; i < count && is_so; i++) {
        for (int k = 0; k < 3 && is_so; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            const double a[2] = {x[0][u], x[0][v]}, b[2] = {x[other][u], x[other][v]};
            const double c[2] = {x[i][u], x[i][v]};
            is_so = turn(a, b, c) == 0;
        }
    }
    return is_so;
}

/* Whether four corners are surely not in one plane. Two triangles that share an edge meet
 * nowhere else then. */
static bool is_bent(double (*x)[3])
{
    double d[3][3], sum = 0, most_of_it = 0;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            d[i][k] = x[i + 1][k] - x[0][k];
        }
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
    int axes[3];
    bool is_cut = false;
    if (count == 3) {
        cut_fan(cutter, count);
        return true;
    }
    order_axes(cutter->x, count, axes);
    for (int k = 0; k < 3 && !is_cut; k++) {
        is_cut = (count == 4 && cut_four(cutter, axes[k])) ||
                 cut_along(cutter, count, axes[k]);
    }
    if (!is_cut &&
        ((count == 4 && is_bent(cutter->x)) || is_on_a_line(cutter->x, count))) {
        cut_fan(cutter, count);
        is_cut = true;
    }
    return is_cut;
}

/* ---- memory ------------------------------------------------------------------------ */

bool ctl_cutter_reserve(struct ctl_cutter *cutter, uint32_t count)
{
    if (count <= cutter->capacity) {
        return true;
    }
    size_t wanted = (size_t)count * 2 + 16;
    ctl_cutter_deinit(cutter);
    cutter->x = malloc(wanted * sizeof *cutter->x);
    cutter->cut = malloc(wanted * sizeof *cutter->cut);
    cutter->corners = malloc(wanted * sizeof *cutter->corners);
    cutter->order = malloc(2 * wanted * sizeof *cutter->order);
    bool is_there = cutter->x != NULL && cutter->cut != NULL && cutter->corners != NULL &&
                    cutter->order != NULL;
    cutter->capacity = is_there ? (uint32_t)wanted : 0;
    return is_there;
}

void ctl_cutter_deinit(struct ctl_cutter *cutter)
{
    free(cutter->x);
    free(cutter->cut);
    free(cutter->corners);
    free(cutter->order);
    *cutter = (struct ctl_cutter){0};
}
