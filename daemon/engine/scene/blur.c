/* daemon/engine/scene/blur.c - what rounding may bring together while an object moves by
 * two poses.
 *
 * Room:     engine.
 * Does:     bound from below how much the object shrinks, and from above by how much its
 *           vertices are off. Every margin is derived in elementary/BOUNDS.md, "Objects
 *           that move by poses".
 * Threads:  [any].
 */
#include "blur.h"

#include <assert.h>

#include "query.h"

/* All that rounding adds to a bound of an eigenvalue, as a part of the sum of the squares
 * of both matrices. */
#define SHRINK_MARGIN (256 * ENG_U)

/* A matrix is that of a pose: three rows of three factors, and a shift each. */
static double product(const double *m, const double *n, int i, int j)
{
    return m[i] * n[j] + m[4 + i] * n[4 + j] + m[8 + i] * n[8 + j];
}

/* Not above the least eigenvalue of transposed(m) n + transposed(n) m, by Gershgorin, but
 * for rounding. */
static double least_eigenvalue(const double *m, const double *n)
{
    double least = INFINITY;
    double sums[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) {
            sums[i][j] = product(m, n, i, j) + product(n, m, i, j);
            sums[j][i] = sums[i][j];
        }
    }
    for (int i = 0; i < 3; i++) {
        double others = fabs(sums[i][(i + 1) % 3]) + fabs(sums[i][(i + 2) % 3]);
        least = fmin(least, sums[i][i] - others);
    }
    return least;
}

double eng_blur_shrink(const double m0[12], const double m1[12])
{
    double squares = 0;
    for (int i = 0; i < 3; i++) {
        squares += product(m0, m0, i, i) + product(m1, m1, i, i);
    }
    double ends = fmin(least_eigenvalue(m0, m0), least_eigenvalue(m1, m1)) / 2;
    double both = least_eigenvalue(m0, m1);
    double least = both >= 2 * ends ? ends : (2 * ends + both) / 4;
    least -= SHRINK_MARGIN * squares + ENG_TINY;
    return least > 0 ? sqrt(least) * (1 - 4 * ENG_U) : 0;
}

double eng_blur_error(const double m[12], const struct eng_bounds *bounds)
{
    assert(bounds->low[0] <= bounds->high[0]);
    double error = 0;
    for (int row = 0; row < 3; row++) {
        const double *r = m + 4 * row;
        double sum = 0;
        for (int k = 0; k < 3; k++) {
            sum += fabs(r[k]) * fmax(fabs(bounds->low[k]), fabs(bounds->high[k]));
        }
        error += 5 * ENG_U * sum + 2 * ENG_U * fabs(r[3]);
    }
    return error + ENG_TINY;
}

double eng_blur(const double m0[12], const double m1[12], const struct eng_bounds *bounds)
{
    double error = fmax(eng_blur_error(m0, bounds), eng_blur_error(m1, bounds));
    double shrink = eng_blur_shrink(m0, m1);
    return shrink > 0 ? 2 * error / shrink * (1 + 0x1p-20) : INFINITY;
}
