/* side.h - how far a point is on one side of a face, times twice the face's area.
 *
 * Source: elementary/BOUNDS.md, "Inside".
 */
#ifndef ENG_SIDE_H
#define ENG_SIDE_H

#include <math.h>

#include "query.h"
#include "vec.h"

#define ENG_SIDE_ERROR (16 * ENG_U)
#define ENG_SIDE_LOST  0x1p-900

/* (p - a) . (b - a) x (c - a) of points of magnitude at most 1e18, within *error. */
static inline double eng_side(const double p[3], const double a[3], const double b[3],
                              const double c[3], double *error)
{
    double w[3];
    double u[3];
    double v[3];
    double n[3];
    eng_sub(w, p, a);
    eng_sub(u, b, a);
    eng_sub(v, c, a);
    eng_cross(n, u, v);
    double size = fabs(w[0]) * (fabs(u[1] * v[2]) + fabs(u[2] * v[1])) +
                  fabs(w[1]) * (fabs(u[2] * v[0]) + fabs(u[0] * v[2])) +
                  fabs(w[2]) * (fabs(u[0] * v[1]) + fabs(u[1] * v[0]));
    *error = ENG_SIDE_ERROR * size + ENG_SIDE_LOST;
    return eng_dot(w, n);
}

#endif
