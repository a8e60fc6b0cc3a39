/* exact_span.c - exact answers about a span of time.
 *
 * Write the conditions of query.h as integer polynomials in time, once for all spans that
 * are asked about, then in the span's own time, and decide whether some time satisfies
 * them.
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
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "exact_roots.h"

/* Points at both ends of the step, times one power of two. */
static void load_points(struct eng_exact_span *span)
{
    int low = INT_MAX;
    for (int i = 0; i < 24; i++) {
        low = eng_lower_exponent(span->query.x[i / 12][i / 3 % 4][i % 3], low);
    }
    for (int i = 0; i < 24; i++) {
        eng_set_scaled(span->x[i / 12][i / 3 % 4][i % 3],
                       span->query.x[i / 12][i / 3 % 4][i % 3], low);
    }
}

/* out[k] = point i - point j over the step. */
static void set_difference(struct eng_exact_span *span, struct eng_poly out[3], int i,
                           int j)
{
    for (int k = 0; k < 3; k++) {
        mpz_ptr d0 = out[k].scratch[0];
        mpz_ptr d1 = out[k].scratch[1];
        mpz_sub(d0, span->x[0][i][k], span->x[0][j][k]);
        mpz_sub(d1, span->x[1][i][k], span->x[1][j][k]);
        eng_poly_set_linear(&out[k], d0, d1);
    }
}

static void cross(struct eng_exact_span *span, struct eng_poly out[3],
                  const struct eng_poly a[3], const struct eng_poly b[3])
{
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&out[k], &a[(k + 1) % 3], &b[(k + 2) % 3]);
        eng_poly_mul(&span->scratch, &a[(k + 2) % 3], &b[(k + 1) % 3]);
        eng_poly_sub(&out[k], &out[k], &span->scratch);
    }
}

static void dot(struct eng_exact_span *span, struct eng_poly *out,
                const struct eng_poly a[3], const struct eng_poly b[3])
{
    out->degree = -1;
    for (int k = 0; k < 3; k++) {
        eng_poly_mul(&span->scratch, &a[k], &b[k]);
        eng_poly_add(out, out, &span->scratch);
    }
}

/* out = a over the span. */
static void set_part(struct eng_exact_span *span, struct eng_poly *out,
                     const struct eng_poly *a)
{
    eng_poly_narrow(out, a, span->l, span->width, span->time_k);
}

/* The time at hand is the begin of the span. */
static void go_to_begin(struct eng_exact_span *span)
{
    mpz_set_ui(span->roots.num, 0);
    span->roots.k = 0;
}

static void set_event_value(struct eng_exact_span *span,
                            const struct eng_conditions *conditions, int i)
{
    (void)conditions;
    eng_poly_copy(&span->condition[i], &span->form->side[i][0]);
}

/* Point i on the line through points j and k, over the step. */
static void load_event(struct eng_exact_span *span, struct eng_exact_event *event,
                       const int points[3])
{
    struct eng_poly *m = span->line;
    int i = points[0];
    int j = points[1];
    int k = points[2];
    event->is_loaded = true;
    event->never = eng_residue_misses_line(&span->residues, span->x, m->scratch, i, j, k);
    if (event->never) {
        return;
    }
    set_difference(span, span->to_j, i, j);
    set_difference(span, span->to_k, i, k);
    cross(span, m, span->to_j, span->to_k);
    dot(span, &event->between, span->to_j, span->to_k);
    eng_poly_negate(&event->between);
    eng_poly_gcd(&span->common, &m[0], &m[1]);
    eng_poly_gcd(&event->common, &span->common, &m[2]);
    event->never = event->common.degree == 0;
}

/* Return whether the point lies on the closed segment from j to k at some time of the
 * span; `begins`: of one that is on its line all the time, whether it comes to an end of
 * the segment. */
static bool event_occurs(struct eng_exact_span *span, const struct eng_exact_event *event,
                         bool begins)
{
    struct eng_poly *between = &span->part.side[0][0];
    span->form = &span->part;
    set_part(span, between, &event->between);
    if (event->common.degree >= 0) {
        const struct eng_conditions is_between = {1, false, 1, set_event_value, NULL};
        set_part(span, &span->part.det, &event->common);
        return eng_roots_satisfy(span, &span->part.det, &is_between);
    }
    /* On one line all the time. */
    const struct eng_conditions none = {0, false, 0, NULL, NULL};
    if (!begins && eng_poly_sign_at_0(between) >= 0) {
        go_to_begin(span);
        eng_roots_found_at(span, 0);
        return true;
    }
    return eng_roots_satisfy(span, between, &none);
}

/* The event that is side number `event` being 0. */
static struct eng_exact_event *event_of(struct eng_exact_span *span, int number)
{
    static const int vf[][3] = {{0, 1, 3}, {0, 1, 2}, {0, 2, 3}};
    static const int ee[][3] = {{0, 2, 3}, {2, 0, 1}, {1, 2, 3}, {3, 0, 1}};
    struct eng_exact_event *event = &span->events[number];
    if (!event->is_loaded) {
        load_event(span, event, span->query.kind == PCCD_VF ? vf[number] : ee[number]);
    }
    return event;
}

static bool any_event_occurs(struct eng_exact_span *span, bool begins)
{
    int count = span->query.kind == PCCD_VF ? 3 : 4;
    bool any = false;
    for (int i = 0; i < count && !(any && !span->wants_first); i++) {
        const struct eng_exact_event *event = event_of(span, i);
        any |= !event->never && event_occurs(span, event, begins);
    }
    return any;
}

static void set_det(struct eng_exact_span *span, enum pccd_kind kind)
{
    struct eng_exact_form *whole = &span->whole;
    if (kind == PCCD_VF) {
        set_difference(span, span->p, 0, 1);
        set_difference(span, span->b, 2, 1);
        set_difference(span, span->c, 3, 1);
    } else {
        set_difference(span, span->p, 2, 0);
        set_difference(span, span->b, 1, 0);
        set_difference(span, span->c, 2, 3);
    }
    cross(span, whole->n, span->b, span->c);
    dot(span, &whole->det, span->p, whole->n);
    eng_poly_shorten(&whole->det);
}

/* Return whether det, not zero throughout, certainly does not vanish in [0, 1]. */
static bool keeps_its_sign(struct eng_poly *det)
{
    int sign;
    return eng_poly_sign_at_0(det) != 0 && eng_poly_sign_at_1(det) != 0 &&
           eng_poly_variations(det, &sign) == 0;
}

enum product { PB, PC, BB, BC, CC };

enum value { BETA, GAMMA, WHOLE };

/* Values over the step: beta n.n = (p x c) . (b x c), gamma n.n = (b x p) . (b x c) and
 * n.n. As (a x b) . (c x d) = (a . c) (b . d) - (a . d) (b . c), two products of
 * quadratics do for each. */
static const struct eng_poly *whole_value(struct eng_exact_span *span, enum value value)
{
    static const enum product factors[ENG_EXACT_VALUES][4] = {[BETA] = {PB, CC, PC, BC},
                                                              [GAMMA] = {BB, PC, BC, PB},
                                                              [WHOLE] = {BB, CC, BC, BC}};
    struct eng_poly *out = &span->values[value];
    const struct eng_poly *products = span->products;
    if (!span->has_products) {
        dot(span, &span->products[PB], span->p, span->b);
        dot(span, &span->products[PC], span->p, span->c);
        dot(span, &span->products[BB], span->b, span->b);
        dot(span, &span->products[BC], span->b, span->c);
        dot(span, &span->products[CC], span->c, span->c);
        span->has_products = true;
    }
    if (!span->has_values[value]) {
        const enum product *factor = factors[value];
        eng_poly_mul(out, &products[factor[0]], &products[factor[1]]);
        eng_poly_mul(&span->scratch, &products[factor[2]], &products[factor[3]]);
        eng_poly_sub(out, out, &span->scratch);
        span->has_values[value] = true;
    }
    return out;
}

/* The same for each condition: 1 - beta and so on. */
static void set_whole_value(struct eng_exact_span *span,
                            const struct eng_conditions *conditions, int i)
{
    struct eng_poly *out = &span->condition[i];
    if (i < 2) {
        eng_poly_copy(out, whole_value(span, i == 0 ? BETA : GAMMA));
        return;
    }
    eng_poly_copy(out, whole_value(span, WHOLE));
    if (i < conditions->count && i == 2) {
        eng_poly_sub(out, out, whole_value(span, BETA));
    }
    if (i < conditions->count && (i == 3 || span->query.kind == PCCD_VF)) {
        eng_poly_sub(out, out, whole_value(span, GAMMA));
    }
}

/* beta n.n, gamma n.n and so on, and n.n. */
static void set_domain_value(struct eng_exact_span *span,
                             const struct eng_conditions *conditions, int i)
{
    const struct eng_exact_form *form = span->form;
    if (form == &span->whole) {
        set_whole_value(span, conditions, i);
    } else { /* each coordinate over the span has a factor of its own */
        dot(span, &span->condition[i], i < conditions->count ? form->side[i] : form->n,
            form->n);
    }
    eng_poly_shorten(&span->condition[i]);
}

/* The conditions of the domain over the step; p, b and c are those of set_det. Where
 * p = beta b + gamma c, p x c is beta n and b x p is gamma n; n less one of these, or
 * less both, says how far beta and gamma, or their sum, are below 1. */
static void set_sides(struct eng_exact_span *span, enum pccd_kind kind)
{
    const struct eng_poly *n = span->whole.n;
    struct eng_poly(*side)[3] = span->whole.side;
    if (span->has_sides) {
        return;
    }
    span->has_sides = true;
    cross(span, side[0], span->p, span->c);
    cross(span, side[1], span->b, span->p);
    for (int k = 0; k < 3; k++) {
        eng_poly_sub(&side[2][k], &n[k], &side[0][k]);
        if (kind == PCCD_VF) {
            eng_poly_sub(&side[2][k], &side[2][k], &side[1][k]);
        } else {
            eng_poly_sub(&side[3][k], &n[k], &side[1][k]);
        }
    }
}

/* Return whether a side is 0 at a root of det. Then the event is there: events are roots
 * of det. */
static bool is_side_zero(struct eng_exact_span *span, int i, const struct eng_root *root)
{
    const struct eng_exact_event *event = event_of(span, i);
    int sign;
    if (event->never || event->common.degree < 0) {
        return !event->never;
    }
    set_part(span, &span->scratch, &event->common);
    eng_poly_zoom(&span->sign, &span->scratch, *root->num, root->k);
    /* With 2 it is alone, if at all, and twice: whoever computes the sign will know. */
    return eng_poly_variations(&span->sign, &sign) == 1;
}

/* The conditions of the domain over the span. */
static struct eng_conditions set_domain(struct eng_exact_span *span, enum pccd_kind kind)
{
    int count = kind == PCCD_VF ? 3 : 4;
    set_sides(span, kind);
    for (int k = 0; k < 3 && span->form == &span->part; k++) {
        set_part(span, &span->part.n[k], &span->whole.n[k]);
        for (int i = 0; i < count; i++) {
            set_part(span, &span->part.side[i][k], &span->whole.side[i][k]);
        }
    }
    return (struct eng_conditions){count, true, count + 1, set_domain_value,
                                   is_side_zero};
}

/* Load what does not depend on the span: one query is asked about several. */
static void load(struct eng_exact_span *span, const struct eng_query *query)
{
    if (span->is_loaded && span->query.kind == query->kind &&
        memcmp(span->query.x, query->x, sizeof query->x) == 0) {
        return;
    }
    span->query = *query;
    span->is_loaded = true;
    load_points(span);
    set_det(span, query->kind);
    span->has_sides = false;
    span->has_products = false;
    memset(span->has_values, 0, sizeof span->has_values);
    span->known.count = 0;
    eng_residue_load(&span->residues, span->x);
    for (int i = 0; i < ENG_EXACT_EVENTS; i++) {
        span->events[i].is_loaded = false;
    }
}

static void set_span(struct eng_exact_span *span, double l, double r)
{
    int low = eng_lower_exponent(l, eng_lower_exponent(r, 0));
    eng_set_scaled(span->l, l, low);
    eng_set_scaled(span->width, r, low);
    mpz_sub(span->width, span->width, span->l);
    span->time_k = (unsigned long)-low;
    span->form = l == 0 && r == 1 ? &span->whole : &span->part;
    if (span->form == &span->part) {
        set_part(span, &span->part.det, &span->whole.det);
    }
    if (span->known.l != l || span->known.r != r) {
        span->known.l = l;
        span->known.r = r;
        span->known.count = 0;
    }
}

static bool meets(struct eng_exact *exact, const struct eng_query *query, double l,
                  double r)
{
    struct eng_exact_span *span = &exact->span;
    if (span->interrupt.has_stopped) {
        return false;
    }
    exact->queries++;
    span->found[0] = INFINITY;
    span->found[1] = INFINITY;
    load(span, query);
    set_span(span, l, r);
    bool any = false;
    if (span->whole.det.degree < 0) {
        struct eng_conditions conditions = set_domain(span, query->kind);
        go_to_begin(span);
        any = eng_roots_hold_at_left(span, &conditions);
        if (any) {
            eng_roots_found_at(span, 0);
            return true;
        }
    } else if (!keeps_its_sign(&span->form->det)) {
        struct eng_conditions conditions = set_domain(span, query->kind);
        any = eng_roots_satisfy(span, &span->form->det, &conditions);
    }
    if (any && !span->wants_first) {
        return true;
    }
    return any_event_occurs(span, false) || any;
}

bool eng_exact_meets(struct eng_exact *exact, const struct eng_query *query, double l,
                     double r)
{
    exact->span.wants_first = false;
    return meets(exact, query, l, r);
}

/* Get ready to find the first of what happens, and where. */
static void begin_first(struct eng_exact_span *span, double tolerance, double l, double r)
{
    int exponent;
    frexp((r - l) / tolerance, &exponent); /* width / tolerance < 2^exponent */
    span->wants_first = true;
    span->depth_min = exponent > 0 ? (unsigned long)exponent + 1 : 1;
    span->found[0] = INFINITY;
    span->found[1] = INFINITY;
    assert(span->depth_min < ENG_EXACT_DEPTH);
}

/* The span l to r becomes the shorter one in which it is. */
static void set_found(const struct eng_exact_span *span, double *l, double *r)
{
    double width = *r - *l;
    /* Three roundings of numbers that are not negative: less than 4 u of the sum. */
    double first = (*l + width * span->found[0]) * (1 - 0x1p-50);
    double last = (*l + width * span->found[1]) * (1 + 0x1p-50);
    *l = fmax(*l, first);
    *r = fmin(*r, last);
}

bool eng_exact_first(struct eng_exact *exact, const struct eng_query *query,
                     double tolerance, double *l, double *r)
{
    struct eng_exact_span *span = &exact->span;
    begin_first(span, tolerance, *l, *r);
    if (!meets(exact, query, *l, *r)) {
        return false;
    }
    set_found(span, l, r);
    return true;
}

/* ---- after a touch at t = 0 -------------------------------------------------------- */

/* The polynomial without its roots at 0: to span->sign. Returns whether it may have
 * others in (0, 1]; then none of them is at 2^-*depth or before. */
static bool may_return(struct eng_exact_span *span, const struct eng_poly *poly,
                       size_t *depth)
{
    struct eng_poly *rest = &span->sign;
    int zeros = 0;
    if (poly->degree < 0) {
        return false;
    }
    while (mpz_sgn(poly->c[zeros]) == 0) {
        zeros++;
    }
    rest->degree = poly->degree - zeros;
    for (int i = 0; i <= rest->degree; i++) {
        mpz_set(rest->c[i], poly->c[i + zeros]);
    }
    if (rest->degree == 0 || keeps_its_sign(rest)) {
        return false;
    }
    /* |c[0]| >= 2^(bits of it - 1); the others add up to less than 4 times the
     * longest. */
    size_t most = eng_poly_bits(rest);
    size_t own = mpz_sizeinbase(rest->c[0], 2);
    size_t needed = most - own + 4;
    *depth = needed > *depth ? needed : *depth;
    return true;
}

/* Times before 2^-AGAIN_DEPTH are not told apart from 0. */
#define AGAIN_DEPTH 1000u

enum eng_again eng_exact_again(struct eng_exact *exact, const struct eng_query *query,
                               double tolerance, double *l, double *r, int *side)
{
    struct eng_exact_span *span = &exact->span;
    size_t depth = 1;
    bool may = false;
    exact->queries++;
    load(span, query);
    *side = 0;
    if (span->whole.det.degree >= 0) {
        for (int i = 0; *side == 0; i++) {
            *side = mpz_sgn(span->whole.det.c[i]);
        }
        may = may_return(span, &span->whole.det, &depth);
    } else {
        for (int i = 0; i < (query->kind == PCCD_VF ? 3 : 4); i++) {
            const struct eng_exact_event *event = event_of(span, i);
            const struct eng_poly *poly =
                event->common.degree < 0 ? &event->between : &event->common;
            may |= !event->never && may_return(span, poly, &depth);
        }
    }
    if (!may) {
        return ENG_AGAIN_NEVER;
    }
    if (depth > AGAIN_DEPTH) {
        return ENG_AGAIN_UNKNOWN;
    }
    *l = ldexp(1, -(int)depth);
    *r = 1;
    if (span->whole.det.degree >= 0) {
        return eng_exact_first(exact, query, tolerance, l, r) ? ENG_AGAIN_MEETS
                                                              : ENG_AGAIN_NEVER;
    }
    begin_first(span, tolerance, *l, *r);
    set_span(span, *l, *r);
    if (!any_event_occurs(span, true)) {
        return ENG_AGAIN_NEVER;
    }
    set_found(span, l, r);
    return ENG_AGAIN_MEETS;
}
