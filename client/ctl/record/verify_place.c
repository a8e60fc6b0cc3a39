/* verify_place.c - where a contact is, and how it is directed.
 *
 * Source: proto/PROTOCOL.md, "Records"; oracle_distance.h.
 */
#include <math.h>

#include "kinds.h"
#include "oracle_distance.h"
#include "verify.h"

#define PLACE_SLACK  1e-4 /* of the features' size, where the points of a contact meet */
#define NORMAL_SLACK 1e-3 /* of a normal */
#define FLAT         1e-6 /* sine of an angle below which nothing is said of a normal */

struct pose {
    double x[4][3]; /* less the first point at that time */
    double size;    /* of the larger feature, and of rounding */
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double length(const double a[3])
{
    double most = fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
    const double b[3] = {a[0] / most, a[1] / most, a[2] / most};
    return most > 0 ? most * sqrt(dot(b, b)) : 0;
}

/* Differences first: their rounding is relative to them. */
static void pose_at(const double p[8][3], uint32_t points_a, double t, struct pose *pose)
{
    double motion = 0;
    pose->size = 0;
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            double from = p[i][k] - p[0][k], to = p[4 + i][k] - p[4][k];
            pose->x[i][k] = (1 - t) * from + t * to;
            motion = fmax(motion, fmax(fabs(from), fabs(to)));
        }
    }
    for (uint32_t i = 1; i < 4; i++) {
        uint32_t first = i < points_a ? 0 : points_a < 4 ? points_a : 3;
        double edge[3];
        for (int k = 0; k < 3; k++) {
            edge[k] = pose->x[i][k] - pose->x[first][k];
        }
        pose->size = fmax(pose->size, length(edge));
    }
    pose->size += 1e-3 * motion;
}

/* From the point on b to the point on a that the weights name. */
static void gap_of(const struct pose *pose, const uint32_t points[2], double w[2][3],
                   double gap[3])
{
    for (int k = 0; k < 3; k++) {
        gap[k] = 0;
        for (uint32_t i = 0; i < points[0]; i++) {
            gap[k] += w[0][i] * pose->x[i][k];
        }
        for (uint32_t i = 0; i < points[1]; i++) {
            gap[k] -= w[1][i] * pose->x[points[0] + i][k];
        }
    }
}

/* The least distance from 0 of a point between two. */
static double least_between(const double a[3], const double b[3])
{
    double along[3], at[3];
    for (int k = 0; k < 3; k++) {
        along[k] = b[k] - a[k];
    }
    double all = dot(along, along);
    double s = all > 0 ? fmin(1, fmax(0, -dot(a, along) / all)) : 0;
    for (int k = 0; k < 3; k++) {
        at[k] = a[k] + s * along[k];
    }
    return length(at);
}

/* The direction in which both features are flat: of a face its normal, of two edges what
 * is square to both. Returns the sine of the angle between what spans it. */
static double flat_direction(const struct pose *pose, const uint32_t points[2],
                             double n[3])
{
    double b[3], c[3];
    for (int k = 0; k < 3; k++) {
        b[k] = points[0] == 1 ? pose->x[2][k] - pose->x[1][k]
                              : pose->x[1][k] - pose->x[0][k];
        c[k] = points[0] == 1 ? pose->x[3][k] - pose->x[1][k]
                              : pose->x[3][k] - pose->x[2][k];
    }
    double lb = length(b), lc = length(c);
    for (int k = 0; k < 3; k++) {
        b[k] = lb > 0 ? b[k] / lb : 0;
        c[k] = lc > 0 ? c[k] / lc : 0;
    }
    n[0] = b[1] * c[2] - b[2] * c[1];
    n[1] = b[2] * c[0] - b[0] * c[2];
    n[2] = b[0] * c[1] - b[1] * c[0];
    double sine = length(n);
    for (int k = 0; k < 3; k++) {
        n[k] = sine > 0 ? n[k] / sine : 0;
    }
    return sine;
}

/* Return on which side of b lies a at t = 0: -1 or 1; 0: it cannot be told. */
static int side_at_begin(const double p[8][3], const uint32_t points[2])
{
    struct pose pose;
    double n[3], from[3];
    pose_at(p, points[0], 0, &pose);
    double sine = flat_direction(&pose, points, n);
    for (int k = 0; k < 3; k++) {
        from[k] = pose.x[0][k] - pose.x[points[0]][k];
    }
    double high = dot(from, n);
    bool is_told = sine > FLAT && fabs(high) > 1e-9 * (length(from) + pose.size) / sine;
    return !is_told ? 0 : high > 0 ? 1 : -1;
}

static const char *judge_thin_normal(const struct pccd_contact *contact,
                                     const double p[8][3], const uint32_t points[2])
{
    const double normal[3] = {(double)contact->normal[0], (double)contact->normal[1],
                              (double)contact->normal[2]};
    struct pose from, to;
    double n[2][3];
    pose_at(p, points[0], contact->toi, &from);
    pose_at(p, points[0], contact->toi_hi, &to);
    double sine =
        fmin(flat_direction(&from, points, n[0]), flat_direction(&to, points, n[1]));
    if (sine < FLAT) {
        return NULL;
    }
    double turned = 1 - fabs(dot(n[0], n[1]));
    double along = fmax(fabs(dot(normal, n[0])), fabs(dot(normal, n[1])));
    if (1 - along > NORMAL_SLACK * NORMAL_SLACK + 2 * turned + 1e-11 / sine) {
        return "the record's normal is not that of its features";
    }
    /* Where a feature shrinks to a point, and opens again, its direction turns round. */
    int side = dot(n[0], n[1]) > 0.5 ? side_at_begin(p, points) : 0;
    return dot(normal, n[0]) * side < 0
               ? "the record's normal points to the wrong side"
               : NULL;
}

/* Points of fewer are repeated: a vertex and a face then, which has shrunk. */
static void nearest_at(const struct pose *pose, const uint32_t points[2],
                       struct oracle_distance *nearest)
{
    const uint8_t rank[4] = {0, 1, 2, 3};
    oracle_distance_find(points[0] == 2 ? ORACLE_EE : ORACLE_VF,
                         (const double(*)[3])pose->x, rank, nearest);
}

static const char *judge_thick(const struct pccd_contact *contact, const double p[8][3],
                               const uint32_t points[2], double w[2][3])
{
    struct pose pose;
    struct oracle_distance nearest;
    double gap[3];
    pose_at(p, points[0], contact->toi, &pose);
    gap_of(&pose, points, w, gap);
    nearest_at(&pose, points, &nearest);
    double slack = PLACE_SLACK * pose.size, distance = length(gap);
    if (!(distance <= nearest.hi + slack)) {
        return "the record's parameters are not those of the nearest points";
    }
    if (!(distance > 1e3 * slack)) {
        return NULL; /* it has no direction that could be told */
    }
    double along = 0;
    for (int k = 0; k < 3; k++) {
        along += (double)contact->normal[k] * gap[k] / distance;
    }
    return along < 1 - NORMAL_SLACK * NORMAL_SLACK - 2 * slack / distance
               ? "the record's normal is not that of the nearest points"
               : NULL;
}

const char *verify_place(const struct pccd_contact *contact, const double p[8][3],
                         double r)
{
    const uint32_t *points = common_kinds[contact->kind].points;
    struct pose from, to;
    double w[2][3], gap[2][3];
    bool has_first = contact->kind == PCCD_VF || contact->kind == PCCD_EE;
    if ((!has_first && contact->param[0] != 0) ||
        (contact->kind == PCCD_VV && contact->param[1] != 0)) {
        return "the record has a parameter that its kind has not";
    }
    common_contact_weights((enum pccd_kind)contact->kind, contact->param, w);
    if (r > 0) {
        return judge_thick(contact, p, points, w);
    }
    pose_at(p, points[0], contact->toi, &from);
    pose_at(p, points[0], contact->toi_hi, &to);
    gap_of(&from, points, w, gap[0]);
    gap_of(&to, points, w, gap[1]);
    if (!(least_between(gap[0], gap[1]) <= PLACE_SLACK * fmax(from.size, to.size))) {
        return "the points that the record's parameters name do not meet";
    }
    return judge_thin_normal(contact, p, points);
}
