/* closest.c - the nearest points of two features at one moment. */
#include "closest.h"

#include <stdbool.h>

#include "vec.h"

/* Sides of the domain in (beta, gamma): start and direction. */
static const double triangle_sides[3][4] = {{0, 0, 1, 0}, {0, 0, 0, 1}, {1, 0, -1, 1}};
static const double square_sides[4][4] = {
    {0, 0, 1, 0}, {0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 1, 0}};

static void gap_at(const struct eng_pose *pose, double beta, double gamma, double gap[3])
{
    eng_madd(gap, pose->p, -beta, pose->b);
    eng_madd(gap, gap, -gamma, pose->c);
}

/* Of the square of the sine between b and c: below, what rounding leaves of their cross
 * product may point anywhere. */
#define SURE_SINE2 0x1p-60

/* Projection of p to the plane of b and c, if it falls into the domain. `is_sure`: b and
 * c span a plane beyond doubt; else another place may be nearer. */
static bool inside(enum pccd_kind kind, const struct eng_pose *pose, double *beta,
                   double *gamma, bool *is_sure)
{
    double n[3];
    double m[3];
    eng_cross(n, pose->b, pose->c);
    double nn = eng_dot(n, n);
    double size = eng_dot(pose->b, pose->b) * eng_dot(pose->c, pose->c);
    if (!(nn > 0x1p-100 * size)) {
        return false;
    }
    *is_sure = nn > SURE_SINE2 * size;
    eng_cross(m, pose->p, pose->c);
    *beta = eng_dot(m, n) / nn;
    eng_cross(m, pose->b, pose->p);
    *gamma = eng_dot(m, n) / nn;
    if (!(*beta >= 0 && *gamma >= 0)) {
        return false;
    }
    return kind == PCCD_VF ? *beta + *gamma <= 1 : *beta <= 1 && *gamma <= 1;
}

void eng_closest_to_origin(enum pccd_kind kind, const struct eng_pose *pose,
                           struct eng_closest *closest)
{
    double best = INFINITY;
    bool is_sure = false;
    if (inside(kind, pose, &closest->beta, &closest->gamma, &is_sure)) {
        gap_at(pose, closest->beta, closest->gamma, closest->gap);
        if (is_sure) {
            return;
        }
        best = eng_dot(closest->gap, closest->gap);
    }
    const double(*sides)[4] = kind == PCCD_VF ? triangle_sides : square_sides;
    int side_count = kind == PCCD_VF ? 3 : 4;
    for (int i = 0; i < side_count; i++) {
        double start[3];
        double along[3] = {0, 0, 0};
        gap_at(pose, sides[i][0], sides[i][1], start); /* gap at s = 0 */
        eng_madd(along, along, sides[i][2], pose->b);
        eng_madd(along, along, sides[i][3], pose->c);
        double aa = eng_dot(along, along);
        double s = aa > 0 ? eng_dot(start, along) / aa : 0;
        s = s > 0 ? (s < 1 ? s : 1) : 0;
        double gap[3];
        eng_madd(gap, start, -s, along);
        double distance2 = eng_dot(gap, gap);
        if (distance2 < best || (i == 0 && best == INFINITY)) {
            best = distance2;
            closest->beta = sides[i][0] + s * sides[i][2];
            closest->gamma = sides[i][1] + s * sides[i][3];
            for (int k = 0; k < 3; k++) {
                closest->gap[k] = gap[k];
            }
        }
    }
}
