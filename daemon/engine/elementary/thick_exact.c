/* thick_exact.c - exact answers about thick features.
 *
 * See thick_exact.h. The distance of two features is that of one pair of their parts: two
 * vertices; a vertex and its foot on an edge; the feet of a vertex in a face, or of two
 * edges on each other. For each pair of parts the times at which it is r are roots of a
 * polynomial of degree 2, 4 or 6, and whether the feet are strictly inside is told by
 * polynomials of degree 2 or 4. BOUNDS.md says why the first time is the least of these
 * roots.
 */
#include "thick_exact.h"

#include <assert.h>
#include <limits.h>
#include <string.h>

#include "memory.h"

/* ---- room -------------------------------------------------------------------------- */

#define X ((size_t)1192) /* bits of a coordinate, or of r, with some room */

/* BOUNDS.md, "How long numbers become". */
static_assert(ENG_THICK_SIDE_BITS >= 4 * X + 64, "a side");
static_assert(ENG_THICK_POLY_BITS >= 10 * X + 2400 + 16, "poly, its Bernstein form");

static void allocate_polys(struct eng_poly *polys, int count, struct eng_limbs *limbs,
                           int terms, size_t bits)
{
    for (int i = 0; i < count; i++) {
        const struct eng_poly_size size = {terms, bits, terms, bits};
        eng_poly_allocate(&polys[i], limbs, &size);
    }
}

static void place(struct eng_thick_exact *exact, struct eng_limbs *limbs)
{
    mpz_ptr numbers[] = {exact->square[0], exact->square[1], exact->best[0],
                         exact->best[1], exact->product};
    for (int i = 0; i < 5; i++) {
        eng_limbs_give(limbs, numbers[i], 12 * X + 2400);
    }
    allocate_polys(exact->x[0], 12, limbs, 2, X + 8);
    allocate_polys(exact->p, 3, limbs, 2, X + 8);
    allocate_polys(exact->b, 3, limbs, 2, X + 8);
    allocate_polys(exact->c, 3, limbs, 2, X + 8);
    allocate_polys(exact->n, 3, limbs, 3, 2 * X + 32);
    allocate_polys(exact->cross, 3, limbs, 3, 2 * X + 32);
    allocate_polys(&exact->term, 1, limbs, 7, 6 * X + 64);
    allocate_polys(&exact->num, 1, limbs, 7, 6 * X + 64);
    allocate_polys(&exact->den, 1, limbs, 5, 4 * X + 64);
    allocate_polys(exact->side, ENG_THICK_SIDES, limbs, 5, ENG_THICK_SIDE_BITS);
    allocate_polys(&exact->poly, 1, limbs, 7, ENG_THICK_POLY_BITS);
    eng_thick_roots_allocate(&exact->roots, limbs);
}

static size_t limbs_of_all(void)
{
    struct eng_thick_exact nobody;
    struct eng_limbs limbs = {NULL, 0};
    memset(&nobody, 0, sizeof nobody);
    place(&nobody, &limbs);
    return limbs.count;
}

size_t eng_thick_exact_bytes(void)
{
    return limbs_of_all() * sizeof(mp_limb_t);
}

int eng_thick_exact_init(struct eng_thick_exact *exact)
{
    struct eng_limbs limbs = {eng_alloc(limbs_of_all(), sizeof(mp_limb_t)), 0};
    if (limbs.next == NULL) {
        return PCCD_E_NOMEM;
    }
    memset(exact, 0, sizeof *exact);
    exact->block = limbs.next;
    place(exact, &limbs);
    return PCCD_OK;
}

void eng_thick_exact_deinit(struct eng_thick_exact *exact)
{
    eng_free(exact->block);
    exact->block = NULL;
}

/* ---- parts ------------------------------------------------------------------------- */

/* Points of a pair of parts. j = -1: the feet inside of both; k = -1: vertices i and j;
 * else vertex i and the edge from j to k. */
struct parts {
    int8_t i, j, k;
};

struct parts_list {
    int points; /* that are looked at */
    int count;
    struct parts parts[9];
};

static const struct parts_list parts_of[] = {
    [PCCD_VF] = {4,
                 7,
                 {{0, 1, -1},
                  {0, 2, -1},
                  {0, 3, -1},
                  {0, 1, 2},
                  {0, 2, 3},
                  {0, 3, 1},
                  {-1, -1, -1}}},
    [PCCD_EE] = {4,
                 9,
                 {{0, 2, -1},
                  {0, 3, -1},
                  {1, 2, -1},
                  {1, 3, -1},
                  {0, 2, 3},
                  {1, 2, 3},
                  {2, 0, 1},
                  {3, 0, 1},
                  {-1, -1, -1}}},
    [PCCD_VE] = {3, 3, {{0, 1, -1}, {0, 2, -1}, {0, 1, 2}}},
    [PCCD_VV] = {2, 1, {{0, 1, -1}}},
};

static void set_difference(struct eng_thick_exact *exact, struct eng_poly out[3], int i,
                           int j)
{
    for (int k = 0; k < 3; k++) {
        eng_poly_sub(&out[k], &exact->x[i][k], &exact->x[j][k]);
    }
}

static void set_cross(struct eng_thick_exact *exact, struct eng_poly out[3],
                      const struct eng_poly a[3], const struct eng_poly b[3])
{
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&out[k], &a[(k + 1) % 3], &b[(k + 2) % 3]);
        eng_poly_mul(&exact->term, &a[(k + 2) % 3], &b[(k + 1) % 3]);
        eng_poly_sub(&out[k], &out[k], &exact->term);
    }
}

static void set_dot(struct eng_thick_exact *exact, struct eng_poly *out,
                    const struct eng_poly a[3], const struct eng_poly b[3])
{
    out->degree = -1;
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&exact->term, &a[k], &b[k]);
        eng_poly_add(out, out, &exact->term);
    }
}

/* One more side, and what den is more than that. */
static void add_sides(struct eng_thick_exact *exact, const struct eng_poly a[3],
                      const struct eng_poly b[3], bool with_rest)
{
    struct eng_poly *side = &exact->side[exact->side_count];
    set_dot(exact, &side[0], a, b);
    exact->side_count++;
    if (with_rest) {
        eng_poly_sub(&side[1], &exact->den, &side[0]);
        exact->side_count++;
    }
}

/* As query.h has it: the feet are at beta b, gamma c, with (p x c) . n = beta n.n and
 * (b x p) . n = gamma n.n. */
static void set_insides(struct eng_thick_exact *exact, bool is_face)
{
    set_difference(exact, exact->p, is_face ? 0 : 2, is_face ? 1 : 0);
    set_difference(exact, exact->b, is_face ? 2 : 1, is_face ? 1 : 0);
    set_difference(exact, exact->c, is_face ? 3 : 2, is_face ? 1 : 3);
    set_cross(exact, exact->n, exact->b, exact->c);
    set_dot(exact, &exact->den, exact->n, exact->n);
    set_dot(exact, &exact->side[0], exact->p, exact->n);
    eng_poly_mul(&exact->num, &exact->side[0], &exact->side[0]);
    set_cross(exact, exact->cross, exact->p, exact->c);
    add_sides(exact, exact->cross, exact->n, true);
    set_cross(exact, exact->cross, exact->b, exact->p);
    add_sides(exact, exact->cross, exact->n, !is_face);
    if (is_face) { /* n.n less both */
        eng_poly_sub(&exact->side[1], &exact->side[1], &exact->side[2]);
    }
}

static void set_parts(struct eng_thick_exact *exact, uint32_t kind,
                      const struct parts *parts)
{
    exact->side_count = 0;
    if (parts->j < 0) {
        set_insides(exact, kind == PCCD_VF);
        return;
    }
    set_difference(exact, exact->p, parts->i, parts->j);
    if (parts->k < 0) {
        set_dot(exact, &exact->num, exact->p, exact->p);
        mpz_set_ui(exact->den.c[0], 1);
        exact->den.degree = 0;
        return;
    }
    set_difference(exact, exact->b, parts->k, parts->j);
    set_cross(exact, exact->cross, exact->p, exact->b);
    set_dot(exact, &exact->num, exact->cross, exact->cross);
    set_dot(exact, &exact->den, exact->b, exact->b);
    add_sides(exact, exact->p, exact->b, true);
}

/* ---- the threshold ----------------------------------------------------------------- */

/* The smallest exponent of all that is looked at. */
static int lowest(const struct eng_thick_query *query, int points)
{
    int low = INT_MAX;
    for (int i = 0; i < 6 * points; i++) {
        int point = i / 3 % points;
        low = eng_lower_exponent(query->query.x[i / 3 / points][point][i % 3], low);
    }
    for (int i = 0; i < 3; i++) {
        low = eng_lower_exponent(query->radius[i], low);
    }
    return low == INT_MAX ? 0 : low;
}

/* The points at t = 0 alone, or over the step. */
static void load_points(struct eng_thick_exact *exact,
                        const struct eng_thick_query *query, int points, int low,
                        bool whole)
{
    for (int i = 0; i < 3 * points; i++) {
        struct eng_poly *x = &exact->x[i / 3][i % 3];
        eng_set_scaled(x->scratch[0], query->query.x[0][i / 3][i % 3], low);
        if (whole) {
            eng_set_scaled(x->scratch[1], query->query.x[1][i / 3][i % 3], low);
        } else {
            mpz_set(x->scratch[1], x->scratch[0]);
        }
        eng_poly_set_linear(x, x->scratch[0], x->scratch[1]);
    }
}

static void load_radius(struct eng_thick_exact *exact,
                        const struct eng_thick_query *query, int low)
{
    mpz_set_ui(exact->best[0], 0);
    for (int i = 0; i < 3; i++) {
        eng_set_scaled(exact->product, query->radius[i], low);
        mpz_add(exact->best[0], exact->best[0], exact->product);
    }
    mpz_mul(exact->square[0], exact->best[0], exact->best[0]);
    mpz_set_ui(exact->square[1], 1);
}

/* With the points at t = 0: polynomials are numbers. */
static int sign_of(const struct eng_poly *number)
{
    return eng_poly_sign_at_0(number);
}

static void set_number(mpz_t out, const struct eng_poly *number)
{
    if (number->degree < 0) {
        mpz_set_ui(out, 0);
    } else {
        mpz_set(out, number->c[0]);
    }
}

static bool has_feet(const struct eng_thick_exact *exact)
{
    for (int i = 0; i < exact->side_count; i++) {
        if (sign_of(&exact->side[i]) < 0) {
            return false;
        }
    }
    return sign_of(&exact->den) > 0;
}

/* best = the square of the distance at t = 0: the least of its parts, one of which, two
 * vertices, always has feet. */
static void set_start(struct eng_thick_exact *exact, uint32_t kind)
{
    mpz_ptr left = exact->poly.c[0];
    mpz_ptr right = exact->poly.c[1];
    for (int i = 0; i < parts_of[kind].count; i++) {
        set_parts(exact, kind, &parts_of[kind].parts[i]);
        if (!has_feet(exact)) {
            continue;
        }
        set_number(exact->product, &exact->num);
        if (i > 0) {
            mpz_mul(left, exact->product, exact->best[1]);
            mpz_mul(right, exact->best[0], exact->den.c[0]);
        }
        if (i == 0 || mpz_cmp(left, right) < 0) {
            mpz_set(exact->best[0], exact->product);
            mpz_set(exact->best[1], exact->den.c[0]);
        }
    }
}

/* r^2 = s^2 best. */
static void set_approach(struct eng_thick_exact *exact, double s)
{
    int low = eng_lower_exponent(s, 0);
    mpz_ptr mantissa = exact->poly.c[0];
    eng_set_scaled(mantissa, s, low);
    mpz_mul(exact->product, mantissa, mantissa);
    mpz_mul(exact->square[0], exact->best[0], exact->product);
    mpz_mul_2exp(exact->square[1], exact->best[1], 2 * (unsigned long)-low);
}

/* poly = num - r^2 den, times the denominator of r^2. */
static void set_poly(struct eng_thick_exact *exact)
{
    struct eng_poly *poly = &exact->poly;
    for (int i = 0; i < 7; i++) {
        mpz_set_ui(poly->c[i], 0);
    }
    for (int i = 0; i <= exact->num.degree; i++) {
        mpz_mul(poly->c[i], exact->num.c[i], exact->square[1]);
    }
    for (int i = 0; i <= exact->den.degree; i++) {
        mpz_submul(poly->c[i], exact->den.c[i], exact->square[0]);
    }
    poly->degree = 6;
    while (poly->degree >= 0 && mpz_sgn(poly->c[poly->degree]) == 0) {
        poly->degree--;
    }
}

/* ---- the decision ------------------------------------------------------------------ */

/* Return whether it is plain that these parts bring no first time: no root in (0, 1], or
 * one side never positive. */
static bool is_nothing(struct eng_thick_exact *exact)
{
    int sign;
    if (exact->poly.degree < 1 || (eng_poly_variations(&exact->poly, &sign) == 0 &&
                                   eng_poly_sign_at_1(&exact->poly) != 0)) {
        return true;
    }
    for (int i = 0; i < exact->side_count; i++) {
        if (eng_poly_variations(&exact->side[i], &sign) == 0 && sign <= 0 &&
            eng_poly_sign_at_1(&exact->side[i]) <= 0) {
            return true;
        }
    }
    return false;
}

void eng_thick_exact_decide(struct eng_thick_exact *exact,
                            const struct eng_thick_query *query, int depth,
                            struct eng_thick_verdict *verdict)
{
    uint32_t kind = (uint32_t)query->query.kind;
    const struct parts_list *list = &parts_of[kind];
    int low = lowest(query, list->points);
    exact->queries++;
    load_points(exact, query, list->points, low, false);
    load_radius(exact, query, low);
    set_start(exact, kind);
    mpz_mul(exact->product, exact->square[0], exact->best[1]);
    *verdict = (struct eng_thick_verdict){.cell = INT64_MAX};
    verdict->is_inside = mpz_cmp(exact->best[0], exact->product) <= 0;
    if (verdict->is_inside) {
        verdict->is_initial = query->approach == 0 || mpz_sgn(exact->best[0]) == 0;
        if (verdict->is_initial) {
            verdict->is_found = true;
            return;
        }
        set_approach(exact, query->approach);
    }
    load_points(exact, query, list->points, low, true);
    for (int i = 0; i < list->count; i++) {
        set_parts(exact, kind, &list->parts[i]);
        set_poly(exact);
        if (is_nothing(exact)) {
            continue;
        }
        verdict->is_found |=
            eng_thick_first_root(&exact->roots, &exact->poly, exact->side,
                                 exact->side_count, depth, &verdict->cell);
    }
}

int eng_thick_exact_trend(struct eng_thick_exact *exact,
                          const struct eng_thick_query *query, bool *touches)
{
    uint32_t kind = (uint32_t)query->query.kind;
    const struct parts_list *list = &parts_of[kind];
    int low = lowest(query, list->points);
    int trend = 1;
    exact->queries++;
    load_points(exact, query, list->points, low, false);
    set_start(exact, kind);
    *touches = mpz_sgn(exact->best[0]) == 0;
    mpz_set(exact->square[0], exact->best[0]);
    mpz_set(exact->square[1], exact->best[1]);
    load_points(exact, query, list->points, low, true);
    for (int i = 0; i < list->count && trend >= 0; i++) {
        set_parts(exact, kind, &list->parts[i]);
        set_poly(exact);
        bool has_feet = true;
        for (int k = 0; k < exact->side_count; k++) {
            has_feet = has_feet && eng_poly_sign_after_0(&exact->side[k]) > 0;
        }
        int sign = eng_poly_sign_after_0(&exact->poly);
        trend = has_feet && sign < trend ? sign : trend;
    }
    return trend;
}
