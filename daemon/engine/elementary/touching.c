/* touching.c - signs just after t = 0, by integers. */
#include "touching.h"

#include <limits.h>
#include <string.h>

#include "exact.h"
#include "memory.h"
#include "pccd_types.h"

/* ---- memory ------------------------------------------------------------------------ */

#define X ((size_t)ENG_EXACT_BITS)

#define SIZE(terms, bits) (&(const struct eng_poly_size){terms, bits, 2, bits})

static void place(struct eng_touching *touching, struct eng_limbs *limbs)
{
    for (int i = 0; i < 2 * ENG_TOUCHING_POINTS * 3; i++) {
        mpz_ptr x =
            touching
                ->x[i / (3 * ENG_TOUCHING_POINTS)][i / 3 % ENG_TOUCHING_POINTS][i % 3];
        eng_limbs_give(limbs, x, X + 8);
    }
    for (int k = 0; k < 3; k++) {
        eng_poly_allocate(&touching->p[k], limbs, SIZE(2, X + 8));
        eng_poly_allocate(&touching->b[k], limbs, SIZE(2, X + 8));
        eng_poly_allocate(&touching->c[k], limbs, SIZE(2, X + 8));
        eng_poly_allocate(&touching->n[k], limbs, SIZE(3, 2 * X + 24));
        eng_poly_allocate(&touching->side[k], limbs, SIZE(3, 2 * X + 24));
    }
    eng_poly_allocate(&touching->work, limbs, SIZE(4, 3 * X + 40));
    eng_poly_allocate(&touching->det, limbs, SIZE(4, 3 * X + 40));
    for (int i = 0; i < 4; i++) {
        eng_limbs_give(limbs, touching->d[i], X + 8);
    }
    eng_limbs_give(limbs, touching->minor, 2 * X + 24);
}

static size_t limbs_of_all(void)
{
    struct eng_touching nobody;
    struct eng_limbs limbs = {NULL, 0};
    memset(&nobody, 0, sizeof nobody);
    place(&nobody, &limbs);
    return limbs.count;
}

size_t eng_touching_bytes(void)
{
    return limbs_of_all() * sizeof(mp_limb_t);
}

int eng_touching_init(struct eng_touching *touching)
{
    struct eng_limbs limbs = {eng_alloc(limbs_of_all(), sizeof(mp_limb_t)), 0};
    if (limbs.next == NULL) {
        return PCCD_E_NOMEM;
    }
    memset(touching, 0, sizeof *touching);
    touching->block = limbs.next;
    place(touching, &limbs);
    return PCCD_OK;
}

void eng_touching_deinit(struct eng_touching *touching)
{
    eng_free(touching->block);
    touching->block = NULL;
}

/* ---- points ------------------------------------------------------------------------ */

/* Load up to six, times one power of two. */
static void load(struct eng_touching *touching, const struct eng_point *const *points,
                 int count)
{
    int low = INT_MAX;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            low = eng_lower_exponent(points[i]->x0[k], low);
            low = eng_lower_exponent(points[i]->x1[k], low);
        }
    }
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            eng_set_scaled(touching->x[0][i][k], points[i]->x0[k], low);
            eng_set_scaled(touching->x[1][i][k], points[i]->x1[k], low);
        }
    }
}

/* out[k] = point i - point j over the step. */
static void subtract(struct eng_touching *touching, struct eng_poly out[3], int i, int j)
{
    for (int k = 0; k < 3; k++) {
        mpz_sub(touching->d[0], touching->x[0][i][k], touching->x[0][j][k]);
        mpz_sub(touching->d[1], touching->x[1][i][k], touching->x[1][j][k]);
        eng_poly_set_linear(&out[k], touching->d[0], touching->d[1]);
    }
}

static void cross(struct eng_touching *touching, struct eng_poly out[3],
                  const struct eng_poly a[3], const struct eng_poly b[3])
{
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&out[k], &a[(k + 1) % 3], &b[(k + 2) % 3]);
        eng_poly_mul(&touching->work, &a[(k + 2) % 3], &b[(k + 1) % 3]);
        eng_poly_sub(&out[k], &out[k], &touching->work);
    }
}

/* ---- signs ------------------------------------------------------------------------- */

static struct eng_signs sign_of(const struct eng_poly *poly)
{
    return (struct eng_signs){eng_poly_sign_at_0(poly), eng_poly_sign_after_0(poly)};
}

/* The sign of a . (b x c), of vectors between pairs of the points: [0] to [1]. */
static struct eng_signs volume(struct eng_touching *touching, const int a[2],
                               const int b[2], const int c[2])
{
    subtract(touching, touching->p, a[1], a[0]);
    subtract(touching, touching->b, b[1], b[0]);
    subtract(touching, touching->c, c[1], c[0]);
    cross(touching, touching->n, touching->b, touching->c);
    touching->det.degree = -1;
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&touching->work, &touching->p[k], &touching->n[k]);
        eng_poly_add(&touching->det, &touching->det, &touching->work);
    }
    return sign_of(&touching->det);
}

struct eng_signs eng_touching_side(struct eng_touching *touching,
                                   const struct eng_point *const f[3],
                                   const struct eng_point *point)
{
    const struct eng_point *const points[4] = {f[0], f[1], f[2], point};
    load(touching, points, 4);
    return volume(touching, (const int[2]){0, 3}, (const int[2]){0, 1},
                  (const int[2]){0, 2});
}

struct eng_signs eng_touching_along(struct eng_touching *touching,
                                    const struct eng_point *const e0[2],
                                    const struct eng_point *const e1[2],
                                    const struct eng_point *from,
                                    const struct eng_point *to)
{
    const struct eng_point *const points[6] = {e0[0], e0[1], e1[0], e1[1], from, to};
    load(touching, points, 6);
    return volume(touching, (const int[2]){4, 5}, (const int[2]){0, 1},
                  (const int[2]){2, 3});
}

bool eng_touching_passes(struct eng_touching *touching,
                         const struct eng_point *const e[2],
                         const struct eng_point *const f[3], const int ends[2])
{
    int all = 0;
    if (ends[0] * ends[1] >= 0) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        const struct eng_point *const plane[3] = {e[0], e[1], f[k]};
        int side = eng_touching_side(touching, plane, f[(k + 1) % 3]).next;
        if (side == 0 || side == -all) {
            return false;
        }
        all = side;
    }
    return true;
}

/* ---- at t = 0 ---------------------------------------------------------------------- */

/* The sign of coordinate `axis` of (points a0 to a1) x (points b0 to b1). */
static int minor_sign(struct eng_touching *touching, int axis, const int a[2],
                      const int b[2])
{
    int i = (axis + 1) % 3;
    int j = (axis + 2) % 3;
    mpz_t(*x)[3] = touching->x[0];
    mpz_sub(touching->d[0], x[a[1]][i], x[a[0]][i]);
    mpz_sub(touching->d[1], x[a[1]][j], x[a[0]][j]);
    mpz_sub(touching->d[2], x[b[1]][i], x[b[0]][i]);
    mpz_sub(touching->d[3], x[b[1]][j], x[b[0]][j]);
    mpz_mul(touching->minor, touching->d[0], touching->d[3]);
    mpz_submul(touching->minor, touching->d[1], touching->d[2]);
    return mpz_sgn(touching->minor);
}

bool eng_touching_normal(struct eng_touching *touching,
                         const struct eng_point *const e0[2],
                         const struct eng_point *const e1[2], struct eng_axis *normal)
{
    const struct eng_point *const points[4] = {e0[0], e0[1], e1[0], e1[1]};
    load(touching, points, 4);
    for (int axis = 0; axis < 3; axis++) {
        int sign = minor_sign(touching, axis, (const int[2]){0, 1}, (const int[2]){2, 3});
        if (sign != 0) {
            *normal = (struct eng_axis){axis, sign};
            return true;
        }
    }
    return false;
}

/* Return whether a side of the triangle at `from`, points 0 to 2 or 3 to 5, has all of
 * the other beyond it or on it. */
static bool side_separates(struct eng_touching *touching, int from,
                           const struct eng_axis *normal)
{
    for (int k = 0; k < 3; k++) {
        const int side[2] = {from + k, from + (k + 1) % 3};
        bool separates = true;
        for (int i = 0; i < 3 && separates; i++) {
            const int to[2] = {side[0], 3 - from + i};
            separates = minor_sign(touching, normal->axis, side, to) * normal->sign <= 0;
        }
        if (separates) {
            return true;
        }
    }
    return false;
}

bool eng_touching_overlaps(struct eng_touching *touching,
                           const struct eng_point *const f[3],
                           const struct eng_point *const g[3], const struct eng_axis *nf,
                           const struct eng_axis *ng)
{
    const struct eng_point *const points[6] = {f[0], f[1], f[2], g[0], g[1], g[2]};
    load(touching, points, 6);
    return !side_separates(touching, 0, nf) && !side_separates(touching, 3, ng);
}

/* ---- touching, in a plane ---------------------------------------------------------- */

/* The signs, seen along n, of beta, gamma and what is left of 1, just after; p, b and c
 * are set and in a plane. False: n is 0 all the time. */
static bool find_domain(struct eng_touching *touching, bool is_vf, int sign[4])
{
    int axis = 0;
    cross(touching, touching->n, touching->b, touching->c);
    while (axis < 3 && sign_of(&touching->n[axis]).next == 0) {
        axis++;
    }
    if (axis == 3) {
        return false;
    }
    int n = sign_of(&touching->n[axis]).next;
    struct eng_poly *left = &touching->work;
    cross(touching, touching->side, touching->p, touching->c);
    sign[0] = n * sign_of(&touching->side[axis]).next;
    eng_poly_sub(left, &touching->n[axis], &touching->side[axis]);
    sign[2] = n * sign_of(left).next;
    eng_poly_copy(&touching->det, left);
    cross(touching, touching->side, touching->b, touching->p);
    sign[1] = n * sign_of(&touching->side[axis]).next;
    eng_poly_sub(left, is_vf ? &touching->det : &touching->n[axis],
                 &touching->side[axis]);
    sign[3] = n * sign_of(left).next;
    return true;
}

bool eng_touching_vf(struct eng_touching *touching,
                     const struct eng_point *const points[4], bool on_side[3])
{
    int sign[4];
    load(touching, points, 4);
    subtract(touching, touching->p, 0, 1);
    subtract(touching, touching->b, 2, 1);
    subtract(touching, touching->c, 3, 1);
    if (!find_domain(touching, true, sign)) {
        return false;
    }
    on_side[0] = sign[1] == 0;
    on_side[1] = sign[3] == 0; /* of 1 - beta - gamma */
    on_side[2] = sign[0] == 0;
    return sign[0] >= 0 && sign[1] >= 0 && sign[3] >= 0;
}

/* Return whether point i is on the closed segment from j to k just after. */
static bool is_on_segment(struct eng_touching *touching, int i, int j, int k)
{
    subtract(touching, touching->b, i, j);
    subtract(touching, touching->c, i, k);
    cross(touching, touching->n, touching->b, touching->c);
    touching->det.degree = -1;
    for (int axis = 0; axis < 3; axis++) {
        if (touching->n[axis].degree >= 0) {
            return false;
        }
        eng_poly_mul(&touching->work, &touching->b[axis], &touching->c[axis]);
        eng_poly_add(&touching->det, &touching->det, &touching->work);
    }
    return sign_of(&touching->det).next <= 0;
}

enum eng_touch eng_touching_ee(struct eng_touching *touching,
                               const struct eng_point *const points[4])
{
    int sign[4];
    load(touching, points, 4);
    subtract(touching, touching->p, 2, 0);
    subtract(touching, touching->b, 1, 0);
    subtract(touching, touching->c, 2, 3);
    if (!find_domain(touching, false, sign)) {
        return is_on_segment(touching, 0, 2, 3) || is_on_segment(touching, 1, 2, 3) ||
                       is_on_segment(touching, 2, 0, 1) ||
                       is_on_segment(touching, 3, 0, 1)
                   ? ENG_TOUCH_ENDS
                   : ENG_TOUCH_NOT;
    }
    bool is_inside = true;
    for (int i = 0; i < 4; i++) {
        if (sign[i] < 0) {
            return ENG_TOUCH_NOT;
        }
        is_inside = is_inside && sign[i] > 0;
    }
    return is_inside ? ENG_TOUCH_INSIDE : ENG_TOUCH_ENDS;
}
