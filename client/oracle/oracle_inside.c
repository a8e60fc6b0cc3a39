/* oracle_inside.c - is a point inside a surface of triangles?
 *
 * Scale everything to integers. A ray from p along d passes through a triangle a b c if d
 * . (a - p) x (b - p), and the same of b c and of c a, have one sign; that is the side it
 * comes from. Whether this is ahead, the sign of (a - p) . (b - a) x (c - a) says beside
 * that of d . (b - a) x (c - a).
 */
#include "oracle_near.h"

#include <gmp.h>
#include <limits.h>
#include <math.h>

#include "oracle_distance.h"

#define DIRECTION_BITS 20

struct integers {
    mpz_t way[3][3]; /* from p to the corners */
    mpz_t edge[2][3];
    mpz_t d[3];
    mpz_t det, part;
};

static void integers_init(struct integers *n)
{
    for (int i = 0; i < 9; i++) {
        mpz_init(n->way[i / 3][i % 3]);
    }
    for (int i = 0; i < 6; i++) {
        mpz_init(n->edge[i / 3][i % 3]);
    }
    mpz_inits(n->d[0], n->d[1], n->d[2], n->det, n->part, NULL);
}

static void integers_clear(struct integers *n)
{
    for (int i = 0; i < 9; i++) {
        mpz_clear(n->way[i / 3][i % 3]);
    }
    for (int i = 0; i < 6; i++) {
        mpz_clear(n->edge[i / 3][i % 3]);
    }
    mpz_clears(n->d[0], n->d[1], n->d[2], n->det, n->part, NULL);
}

/* Sign of a . b x c. */
static int sign_of(struct integers *n, mpz_t a[3], mpz_t b[3], mpz_t c[3])
{
    mpz_set_ui(n->det, 0);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        mpz_mul(n->part, b[i], c[j]);
        mpz_submul(n->part, b[j], c[i]);
        mpz_addmul(n->det, a[k], n->part);
    }
    return mpz_sgn(n->det);
}

/* Return whether the edges are parallel, or one of them is nothing. */
static bool is_flat(struct integers *n)
{
    bool is_zero = true;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        mpz_mul(n->part, n->edge[0][i], n->edge[1][j]);
        mpz_submul(n->part, n->edge[0][j], n->edge[1][i]);
        is_zero = is_zero && mpz_sgn(n->part) == 0;
    }
    return is_zero;
}

static int lowest(const double *x, int low)
{
    for (int k = 0; k < 3; k++) {
        int exponent;
        if (frexp(x[k], &exponent) != 0 && exponent - 53 < low) {
            low = exponent - 53;
        }
    }
    return low;
}

/* r = (x - y) 2^-low */
static void set_difference(mpz_t r[3], mpz_t part, const double x[3], const double y[3],
                           int low)
{
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 2; i++) {
            int exponent;
            double mantissa = frexp(i == 0 ? x[k] : y[k], &exponent);
            mpz_set_d(part, ldexp(mantissa, 53));
            if (mantissa != 0) {
                mpz_mul_2exp(part, part, (mp_bitcnt_t)(exponent - 53 - low));
            }
            if (i == 0) {
                mpz_set(r[k], part);
            } else {
                mpz_sub(r[k], r[k], part);
            }
        }
    }
}

static uint64_t next(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *state >> 33;
}

static void draw_direction(struct integers *n, uint64_t *state)
{
    for (int k = 0; k < 3; k++) {
        mpz_set_si(n->d[k], (long)(next(state) & ((1u << DIRECTION_BITS) - 1)) -
                                (1l << (DIRECTION_BITS - 1)));
    }
}

/* Add what a triangle adds to the winding number. False: the ray meets its edge, or the
 * point is in its plane. */
static bool add(struct integers *n, const double p[3], const double *const corner[3],
                int64_t *winding)
{
    int low = lowest(p, INT_MAX);
    for (int i = 0; i < 3; i++) {
        low = lowest(corner[i], low);
    }
    low = low == INT_MAX ? 0 : low;
    for (int i = 0; i < 3; i++) {
        set_difference(n->way[i], n->part, corner[i], p, low);
    }
    int side[3];
    for (int i = 0; i < 3; i++) {
        side[i] = sign_of(n, n->d, n->way[i], n->way[(i + 1) % 3]);
    }
    for (int k = 0; k < 3; k++) {
        mpz_sub(n->edge[0][k], n->way[1][k], n->way[0][k]);
        mpz_sub(n->edge[1][k], n->way[2][k], n->way[0][k]);
    }
    if (is_flat(n)) {
        return true; /* no ray that is moved a little passes through it */
    }
    int along = sign_of(n, n->d, n->edge[0], n->edge[1]);
    int ahead = sign_of(n, n->way[0], n->edge[0], n->edge[1]);
    if (along == 0) {
        return ahead != 0;
    }
    if ((side[0] > 0 || side[1] > 0 || side[2] > 0) &&
        (side[0] < 0 || side[1] < 0 || side[2] < 0)) {
        return true;
    }
    if (side[0] == 0 || side[1] == 0 || side[2] == 0 || ahead == 0) {
        return false;
    }
    *winding += ahead == along ? along : 0;
    return true;
}

/* Return whether p[0] is in the box of the others. Else it is not on their triangle. */
static bool is_in_box(const double p[4][3])
{
    for (int k = 0; k < 3; k++) {
        if ((p[0][k] < p[1][k] && p[0][k] < p[2][k] && p[0][k] < p[3][k]) ||
            (p[0][k] > p[1][k] && p[0][k] > p[2][k] && p[0][k] > p[3][k])) {
            return false;
        }
    }
    return true;
}

bool oracle_winding(const double point[3], const double (*x)[3],
                    const uint32_t (*triangles)[3], uint32_t triangle_count,
                    int64_t *winding)
{
    uint64_t state = 1;
    bool is_done = false;
    *winding = 0;
    for (uint32_t i = 0; i < triangle_count; i++) {
        double p[4][3];
        for (int k = 0; k < 3; k++) {
            p[0][k] = point[k];
            p[1][k] = x[triangles[i][0]][k];
            p[2][k] = x[triangles[i][1]][k];
            p[3][k] = x[triangles[i][2]][k];
        }
        if (is_in_box((const double(*)[3])p) &&
            oracle_distance_within(ORACLE_VF, (const double(*)[3])p, 0)) {
            return false;
        }
    }
    struct integers n;
    integers_init(&n);
    while (!is_done) {
        is_done = true;
        *winding = 0;
        draw_direction(&n, &state);
        for (uint32_t i = 0; i < triangle_count && is_done; i++) {
            const double *const corner[3] = {x[triangles[i][0]], x[triangles[i][1]],
                                             x[triangles[i][2]]};
            is_done = add(&n, point, corner, winding);
        }
    }
    integers_clear(&n);
    return true;
}
