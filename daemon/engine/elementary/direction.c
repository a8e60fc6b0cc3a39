/* direction.c - separation along one fixed direction over a span of time.
 *
 * With d fixed, d . (p - beta b - gamma c) is linear in beta, gamma and in t, so its sign
 * over domain and span is decided at the corners of the domain at both ends.
 *
 * Source: BOUNDS.md for the margin.
 */
#include "direction.h"

#include "closest.h"
#include "vec.h"

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

bool eng_direction_separates(const struct eng_motion *motion, const struct eng_pose *l,
                             const struct eng_pose *r)
{
    struct eng_pose middle;
    for (int k = 0; k < 3; k++) {
        middle.p[k] = 0.5 * (l->p[k] + r->p[k]);
        middle.b[k] = 0.5 * (l->b[k] + r->b[k]);
        middle.c[k] = 0.5 * (l->c[k] + r->c[k]);
    }
    struct eng_closest closest;
    eng_closest_to_origin(motion->kind, &middle, &closest);
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
