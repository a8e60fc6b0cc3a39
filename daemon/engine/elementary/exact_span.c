/* daemon/engine/elementary/exact_span.c - exact answers about a span of time.
 *
 * Room:     engine.
 * Does:     write the conditions of query.h as integer polynomials in the span's own time
 *           and decide whether some time satisfies them.
 * Threads:  one thread for one scratch.
 *
 * A contact with independent b, c is a root of det at which every condition polynomial is
 * >= 0 and n.n > 0. Every other contact (a collapsed triangle, parallel or collapsed
 * edges, and the first contact of a pair that is coplanar all the time) is an event "this
 * point lies on that segment": the three coordinates of a cross product vanish together,
 * and the point lies between the ends. So:
 *
 *   meets  <=>  a root of det satisfies the conditions,
 *           or  a point-on-segment event occurs,
 *           or  det vanishes throughout and the features meet at the start of the span.
 */
#include <limits.h>
#include <math.h>

#include "exact_roots.h"

static void init_all(struct eng_poly *polys, int count,
                     void (*init)(struct eng_poly *poly))
{
    for (int i = 0; i < count; i++) {
        init(&polys[i]);
    }
}

static void for_all_polys(struct eng_exact_span *span,
                          void (*init)(struct eng_poly *poly))
{
    init_all(span->p, 3, init);
    init_all(span->b, 3, init);
    init_all(span->c, 3, init);
    init_all(span->n, 3, init);
    init_all(span->m, 3, init);
    init_all(&span->det, 1, init);
    init_all(&span->beta, 1, init);
    init_all(&span->gamma, 1, init);
    init_all(&span->nn, 1, init);
    init_all(span->condition, ENG_EXACT_CONDITIONS, init);
    init_all(span->common, ENG_EXACT_CONDITIONS, init);
    init_all(&span->root, 1, init);
    init_all(&span->zoomed, 1, init);
    init_all(&span->base, 1, init);
    init_all(&span->sign, 1, init);
    init_all(span->scratch, 3, init);
}

void eng_exact_init(struct eng_exact *exact)
{
    for (int i = 0; i < ENG_EXACT_WORDS; i++) {
        mpz_init2(exact->z[i], 1024);
    }
    for (int i = 0; i < 24; i++) {
        mpz_init2(exact->span.x[i / 12][i / 3 % 4][i % 3], 1024);
    }
    mpz_init2(exact->span.l, 2048);
    mpz_init2(exact->span.r, 2048);
    mpz_init2(exact->span.num, 1024);
    mpz_init2(exact->span.end, 1024);
    mpz_init2(exact->span.before, 1024);
    mpz_init2(exact->span.base_num, 1024);
    exact->span.base_k = 0;
    for (int i = 0; i < ENG_POLY_TERMS; i++) {
        mpz_init2(exact->span.chains[i].top, 1024);
        mpz_init2(exact->span.chains[i].bottom, 1024);
    }
    for_all_polys(&exact->span, eng_poly_init);
    exact->queries = 0;
}

void eng_exact_deinit(struct eng_exact *exact)
{
    for (int i = 0; i < ENG_EXACT_WORDS; i++) {
        mpz_clear(exact->z[i]);
    }
    for (int i = 0; i < 24; i++) {
        mpz_clear(exact->span.x[i / 12][i / 3 % 4][i % 3]);
    }
    mpz_clears(exact->span.l, exact->span.r, exact->span.num, exact->span.end,
               exact->span.before, exact->span.base_num, NULL);
    for (int i = 0; i < ENG_POLY_TERMS; i++) {
        mpz_clears(exact->span.chains[i].top, exact->span.chains[i].bottom, NULL);
    }
    for_all_polys(&exact->span, eng_poly_deinit);
}

/* Exponent of the lowest bit that `value` may have. */
static int lowest_exponent(double value, int low)
{
    int exponent;
    if (value == 0) {
        return low;
    }
    frexp(value, &exponent);
    return exponent - 53 < low ? exponent - 53 : low;
}

/* out = value * 2^-low, exactly. */
static void set_scaled(mpz_t out, double value, int low)
{
    int exponent;
    double mantissa = frexp(value, &exponent);
    mpz_set_d(out, ldexp(mantissa, 53));
    if (mantissa != 0) {
        mpz_mul_2exp(out, out, (unsigned long)(exponent - 53 - low));
    }
}

/* Points at both ends of the span: x(t) = (1 - t) x0 + t x1, times one power of two. */
static void load_points(struct eng_exact *exact, const struct eng_query *query, double l,
                        double r)
{
    struct eng_exact_span *span = &exact->span;
    int low = INT_MAX;
    int low_time = 0;
    low_time = lowest_exponent(l, lowest_exponent(r, low_time));
    set_scaled(span->l, l, low_time);
    set_scaled(span->r, r, low_time);
    for (int i = 0; i < 24; i++) {
        low = lowest_exponent(query->x[i / 12][i / 3 % 4][i % 3], low);
    }
    mpz_t *x0 = &exact->z[0];
    mpz_t *x1 = &exact->z[1];
    for (int i = 0; i < 12; i++) {
        set_scaled(*x0, query->x[0][i / 3][i % 3], low);
        set_scaled(*x1, query->x[1][i / 3][i % 3], low);
        mpz_sub(*x1, *x1, *x0);
        mpz_mul_2exp(*x0, *x0, (unsigned long)-low_time);
        mpz_t *at_l = &span->x[0][i / 3][i % 3];
        mpz_t *at_r = &span->x[1][i / 3][i % 3];
        mpz_set(*at_l, *x0);
        mpz_addmul(*at_l, span->l, *x1);
        mpz_set(*at_r, *x0);
        mpz_addmul(*at_r, span->r, *x1);
    }
}

/* out[k] = point i - point j over the span. */
static void set_difference(struct eng_exact *exact, struct eng_poly out[3], int i, int j)
{
    struct eng_exact_span *span = &exact->span;
    mpz_t *d0 = &exact->z[0];
    mpz_t *d1 = &exact->z[1];
    for (int k = 0; k < 3; k++) {
        mpz_sub(*d0, span->x[0][i][k], span->x[0][j][k]);
        mpz_sub(*d1, span->x[1][i][k], span->x[1][j][k]);
        eng_poly_set_linear(&out[k], *d0, *d1);
    }
}

static void cross(struct eng_exact_span *span, struct eng_poly out[3],
                  const struct eng_poly a[3], const struct eng_poly b[3])
{
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&out[k], &a[(k + 1) % 3], &b[(k + 2) % 3]);
        eng_poly_mul(&span->scratch[0], &a[(k + 2) % 3], &b[(k + 1) % 3]);
        eng_poly_sub(&out[k], &out[k], &span->scratch[0]);
    }
}

static void dot(struct eng_exact_span *span, struct eng_poly *out,
                const struct eng_poly a[3], const struct eng_poly b[3])
{
    out->degree = -1;
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&span->scratch[0], &a[k], &b[k]);
        eng_poly_add(out, out, &span->scratch[0]);
    }
}

/* Does point i lie on the closed segment from j to k at some time? */
static bool event_occurs(struct eng_exact *exact, int i, int j, int k)
{
    struct eng_exact_span *span = &exact->span;
    if (eng_residue_misses_line(&span->residues, span->x, exact->z, i, j, k)) {
        return false;
    }
    set_difference(exact, span->p, i, j);
    set_difference(exact, span->b, i, k);
    cross(span, span->m, span->p, span->b);
    dot(span, &span->beta, span->p, span->b); /* <= 0 between the ends */
    eng_poly_gcd(&span->gamma, &span->m[0], &span->m[1]);
    eng_poly_gcd(&span->det, &span->gamma, &span->m[2]);
    if (span->det.degree < 0) {
        /* On one line all the time: is the product ever <= 0? */
        const struct eng_conditions none = {0, false};
        if (eng_poly_sign_at_0(&span->beta) <= 0) {
            mpz_set_ui(span->num, 0);
            eng_roots_found_at(span, 0, 0);
            return true;
        }
        return eng_roots_satisfy(span, &span->beta, &none);
    }
    const struct eng_conditions between = {1, false};
    eng_poly_negate(&span->beta);
    eng_poly_copy(&span->condition[0], &span->beta);
    return eng_roots_satisfy(span, &span->det, &between);
}

static bool any_event_occurs(struct eng_exact *exact, enum eng_kind kind)
{
    static const int vf[][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}};
    static const int ee[][3] = {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}};
    const int(*events)[3] = kind == ENG_VF ? vf : ee;
    int count = kind == ENG_VF ? 3 : 4;
    bool any = false;
    for (int i = 0; i < count && !(any && !exact->span.wants_first); i++) {
        any |= event_occurs(exact, events[i][0], events[i][1], events[i][2]);
    }
    return any;
}

static void set_det(struct eng_exact *exact, enum eng_kind kind)
{
    struct eng_exact_span *span = &exact->span;
    if (kind == ENG_VF) {
        set_difference(exact, span->p, 0, 1);
        set_difference(exact, span->b, 2, 1);
        set_difference(exact, span->c, 3, 1);
    } else {
        set_difference(exact, span->p, 2, 0);
        set_difference(exact, span->b, 1, 0);
        set_difference(exact, span->c, 2, 3);
    }
    cross(span, span->n, span->b, span->c);
    dot(span, &span->det, span->p, span->n);
    eng_poly_shorten(&span->det);
}

/* Does det, which is not zero throughout, certainly not vanish in [0, 1]? */
static bool det_keeps_its_sign(struct eng_exact_span *span)
{
    int sign;
    return eng_poly_sign_at_0(&span->det) != 0 && eng_poly_sign_at_1(&span->det) != 0 &&
           eng_poly_variations(&span->det, &sign) == 0;
}

/* The conditions of the domain; after set_det. */
static struct eng_conditions set_conditions(struct eng_exact *exact, enum eng_kind kind)
{
    struct eng_exact_span *span = &exact->span;
    dot(span, &span->nn, span->n, span->n);
    cross(span, span->m, span->p, span->c);
    dot(span, &span->beta, span->m, span->n);
    cross(span, span->m, span->b, span->p);
    dot(span, &span->gamma, span->m, span->n);
    int count = 0;
    eng_poly_copy(&span->condition[count++], &span->beta);
    eng_poly_copy(&span->condition[count++], &span->gamma);
    eng_poly_sub(&span->condition[count++], &span->nn, &span->beta);
    if (kind == ENG_VF) {
        eng_poly_sub(&span->condition[2], &span->condition[2], &span->gamma);
    } else {
        eng_poly_sub(&span->condition[count++], &span->nn, &span->gamma);
    }
    eng_poly_copy(&span->condition[count++], &span->nn);
    for (int i = 0; i < count; i++) {
        eng_poly_shorten(&span->condition[i]);
    }
    return (struct eng_conditions){count, true};
}

static bool meets(struct eng_exact *exact, const struct eng_query *query, double l,
                  double r)
{
    struct eng_exact_span *span = &exact->span;
    exact->queries++;
    span->found[0] = INFINITY;
    span->found[1] = INFINITY;
    load_points(exact, query, l, r);
    set_det(exact, query->kind);
    eng_residue_load(&span->residues, span->x);
    bool any = false;
    if (span->det.degree < 0) {
        struct eng_conditions conditions = set_conditions(exact, query->kind);
        mpz_set_ui(span->num, 0);
        any = eng_roots_hold_at_left(span, &conditions, 0);
        if (any) {
            eng_roots_found_at(span, 0, 0);
            return true;
        }
    } else if (!det_keeps_its_sign(span)) {
        struct eng_conditions conditions = set_conditions(exact, query->kind);
        any = eng_roots_satisfy(span, &span->det, &conditions);
    }
    if (any && !span->wants_first) {
        return true;
    }
    return any_event_occurs(exact, query->kind) || any;
}

bool eng_exact_meets(struct eng_exact *exact, const struct eng_query *query, double l,
                     double r)
{
    exact->span.wants_first = false;
    return meets(exact, query, l, r);
}

bool eng_exact_first(struct eng_exact *exact, const struct eng_query *query,
                     double tolerance, double *l, double *r)
{
    struct eng_exact_span *span = &exact->span;
    double width = *r - *l;
    int exponent;
    frexp(width / tolerance, &exponent); /* width / tolerance < 2^exponent */
    span->wants_first = true;
    span->depth_min = exponent > 0 ? (unsigned long)exponent + 1 : 1;
    if (!meets(exact, query, *l, *r)) {
        return false;
    }
    /* Three roundings of numbers that are not negative: less than 4 u of the sum. */
    double first = (*l + width * span->found[0]) * (1 - 0x1p-50);
    double last = (*l + width * span->found[1]) * (1 + 0x1p-50);
    *l = fmax(*l, first);
    *r = fmin(*r, last);
    return true;
}
