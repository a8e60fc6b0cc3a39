/* daemon/engine/elementary/exact_roots.c - roots in a span that satisfy conditions.
 *
 * Room:     engine.
 * Does:     isolate roots by bisection and Descartes' rule of signs, in leaps where they
 *           are far down, until the signs of all conditions at a root are known.
 * Threads:  one thread for one scratch.
 * Source:   Collins and Akritas 1976; Abbott: Quadratic interval refinement for real
 *           roots, 2006.
 */
#include "exact_roots.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static bool accepts(const struct eng_conditions *conditions, int i, int sign)
{
    return conditions->last_is_strict && i == conditions->count - 1 ? sign > 0
                                                                    : sign >= 0;
}

bool eng_roots_hold_at_left(struct eng_exact_span *span,
                            const struct eng_conditions *conditions, unsigned long k)
{
    for (int i = 0; i < conditions->count; i++) {
        eng_poly_zoom(&span->sign, &span->condition[i], span->num, k);
        if (!accepts(conditions, i, eng_poly_sign_at_0(&span->sign))) {
            return false;
        }
    }
    return true;
}

enum verdict { NO, YES, REFINE };

/* The roots that condition i shares with the root's polynomial. */
static void set_common(struct eng_exact_span *span, int i)
{
    if (eng_residue_are_coprime(&span->root, &span->condition[i])) {
        span->common[i].degree = 0; /* none */
        mpz_set_ui(span->common[i].c[0], 1);
        return;
    }
    eng_poly_copy(&span->scratch[1], &span->root);
    eng_poly_copy(&span->scratch[2], &span->condition[i]);
    eng_poly_gcd(&span->common[i], &span->scratch[1], &span->scratch[2]);
}

/* What is known of the conditions at one root. */
struct known {
    bool has_common[ENG_EXACT_CONDITIONS]; /* span->common is set; for any root */
    bool holds[ENG_EXACT_CONDITIONS];      /* in all of the interval at hand */
};

/* The interval holds exactly one root. A condition has a known sign there if it has no
 * root in the interval, or if it shares the root. What holds in the interval is noted: it
 * does so in all that are within it. */
static enum verdict judge(struct eng_exact_span *span,
                          const struct eng_conditions *conditions, unsigned long k,
                          struct known *known)
{
    enum verdict verdict = YES;
    for (int i = 0; i < conditions->count; i++) {
        int sign;
        if (known->holds[i]) {
            continue;
        }
        eng_poly_zoom(&span->sign, &span->condition[i], span->num, k);
        if (eng_poly_variations(&span->sign, &sign) > 0) {
            if (!known->has_common[i]) {
                set_common(span, i);
                known->has_common[i] = true;
            }
            eng_poly_zoom(&span->sign, &span->common[i], span->num, k);
            if (eng_poly_variations(&span->sign, &sign) % 2 == 0) {
                verdict = REFINE;
                continue;
            }
            sign = 0;
        }
        if (!accepts(conditions, i, sign)) {
            return NO;
        }
        known->holds[i] = true;
    }
    return verdict;
}

/* The interval after `num` / 2^k in order of time, merged upwards where both halves are
 * done: finished right halves finish their parents. */
static void advance(struct eng_exact_span *span, unsigned long *k)
{
    mpz_add_ui(span->num, span->num, 1);
    while (*k > 0 && mpz_even_p(span->num)) {
        mpz_tdiv_q_2exp(span->num, span->num, 1);
        (*k)--;
    }
}

void eng_roots_found_at(struct eng_exact_span *span, unsigned long k, unsigned wide)
{
    long exponent;
    double number = mpz_get_d_2exp(&exponent, span->num); /* cut off, not rounded */
    double from = ldexp(number, (int)(exponent - (long)k));
    mpz_add_ui(span->end, span->num, wide);
    number = mpz_get_d_2exp(&exponent, span->end);
    double to = ldexp(number, (int)(exponent - (long)k)) * (1 + 0x1p-51);
    to += number > 0 ? 0x1p-1022 : 0;
    span->found[0] = fmin(span->found[0], from);
    span->found[1] = fmin(span->found[1], to);
}

/* ---- leaps ------------------------------------------------------------------------- */

/* Bisection takes a step a bit, and roots that are 2^-1000 from each other or from 0 take
 * a thousand. A leap goes down `stride` bits at a time: to the interval below the present
 * one in which the roots seem to be. It is right if that has as many sign variations as
 * the present one: variations of the parts of an interval, and roots where they meet, add
 * up to no more than its own, so all other parts have none. Bisection would come to the
 * same interval. (Abbott: Quadratic interval refinement for real roots, 2006.) */

/* Bits at a time, at most: numbers grow by some times as many with each. */
#define STRIDE_MAX 256ul

/* num = floor(2^stride a / (a - b)), at most 2^stride - 1; false if a and b are not of
 * opposite signs. */
static bool divide_between(mpz_t num, mpz_srcptr a, mpz_srcptr b, mpz_t scratch,
                           unsigned long stride)
{
    if (mpz_sgn(a) * mpz_sgn(b) >= 0) {
        return false;
    }
    mpz_sub(scratch, a, b);
    mpz_mul_2exp(num, a, stride);
    mpz_fdiv_q(num, num, scratch);
    mpz_set_ui(scratch, 1);
    mpz_mul_2exp(scratch, scratch, stride);
    mpz_sub_ui(scratch, scratch, 1);
    if (mpz_cmp(num, scratch) > 0) {
        mpz_set(num, scratch);
    }
    return true;
}

/* Where one root, or the middle of more, would be if the polynomial or its slope were
 * linear over the interval at hand. */
static bool guess(struct eng_exact_span *span, int variations, unsigned long stride)
{
    struct eng_poly *f = &span->zoomed;
    mpz_ptr at_0 = f->scratch[0];
    mpz_ptr at_1 = f->scratch[1];
    mpz_set_ui(at_1, 0);
    if (variations == 1) {
        mpz_set(at_0, f->c[0]);
        for (int i = 0; i <= f->degree; i++) {
            mpz_add(at_1, at_1, f->c[i]);
        }
    } else {
        mpz_set(at_0, f->c[1]);
        for (int i = 1; i <= f->degree; i++) {
            mpz_addmul_ui(at_1, f->c[i], (unsigned long)i);
        }
    }
    return divide_between(span->end, at_0, at_1, f->scratch[2], stride);
}

/* Is part number span->end of 2^stride that which has all the variations? Then it becomes
 * the interval at hand, and span->zoomed is of it. */
static bool leap_to(struct eng_exact_span *span, int variations, unsigned long stride)
{
    int sign;
    eng_poly_zoom(&span->zoomed, &span->base, span->end, stride);
    /* A root at its left end has been looked at if the interval at hand begins there. */
    if ((mpz_sgn(span->end) != 0 && eng_poly_sign_at_0(&span->zoomed) == 0) ||
        eng_poly_variations(&span->zoomed, &sign) != variations) {
        return false;
    }
    mpz_mul_2exp(span->num, span->num, stride);
    mpz_add(span->num, span->num, span->end);
    return true;
}

/* Where it is guessed to be, next to that, first, or last. */
static bool leap(struct eng_exact_span *span, int variations, unsigned long stride)
{
    if (guess(span, variations, stride)) {
        if (leap_to(span, variations, stride)) {
            return true;
        }
        mpz_sub_ui(span->end, span->end, 1);
        if (mpz_sgn(span->end) >= 0 && leap_to(span, variations, stride)) {
            return true;
        }
    }
    mpz_set_ui(span->end, 0);
    if (leap_to(span, variations, stride)) {
        return true;
    }
    mpz_set_ui(span->end, 1);
    mpz_mul_2exp(span->end, span->end, stride);
    mpz_sub_ui(span->end, span->end, 1);
    return leap_to(span, variations, stride);
}

/* ---- roots ------------------------------------------------------------------------- */

/* A chain is of intervals, each within the one before, that have as many variations: from
 * the first, `top`, to the last, `bottom`. Nothing is in the top but what is in the
 * bottom. Chains lie within each other, each with fewer variations than the one around
 * it, so there are no more than the degree. */

/* The interval at hand has all that is in the innermost chain. */
static void set_bottom(struct eng_exact_span *span, unsigned long k)
{
    struct eng_exact_chain *chain = &span->chains[span->chain_count - 1];
    chain->bottom_k = k;
    mpz_set(chain->bottom, span->num);
}

/* The interval at hand is to be refined: it begins a chain, or goes on with one. */
static void enter(struct eng_exact_span *span, int variations, unsigned long k)
{
    int last = span->chain_count - 1;
    if (last < 0 || span->chains[last].variations != variations) {
        assert(span->chain_count < ENG_POLY_TERMS);
        last = span->chain_count++;
        struct eng_exact_chain *chain = &span->chains[last];
        chain->variations = variations;
        chain->top_k = k;
        mpz_set(chain->top, span->num);
    }
    set_bottom(span, k);
}

static bool is_within_bottom(struct eng_exact_span *span,
                             const struct eng_exact_chain *chain, unsigned long k)
{
    if (k < chain->bottom_k) {
        return false;
    }
    mpz_fdiv_q_2exp(span->end, span->num, k - chain->bottom_k);
    return mpz_cmp(span->end, chain->bottom) == 0;
}

/* Nothing more is in the interval at hand: on to the next one, and behind the chains
 * whose bottoms have been left. True: there were such chains. */
static bool leave(struct eng_exact_span *span, unsigned long *k)
{
    int before = span->chain_count;
    advance(span, k);
    while (span->chain_count > 0 &&
           !is_within_bottom(span, &span->chains[span->chain_count - 1], *k)) {
        const struct eng_exact_chain *chain = &span->chains[--span->chain_count];
        mpz_set(span->num, chain->top);
        *k = chain->top_k;
        advance(span, k);
    }
    return span->chain_count < before;
}

/* One root is in the interval `num` / 2^k, at which a verdict is known, and was not at
 * 2^`low`: back to the first interval around it at which it is, where bisection stops. */
static void step_back(struct eng_exact_span *span,
                      const struct eng_conditions *conditions, unsigned long low,
                      unsigned long *k, struct known known)
{
    mpz_set(span->before, span->num);
    unsigned long last = *k;
    unsigned long high = last;
    while (high - low > 1) {
        unsigned long middle = low + (high - low) / 2;
        struct known then = known;
        mpz_fdiv_q_2exp(span->num, span->before, last - middle);
        if (judge(span, conditions, middle, &then) == REFINE) {
            low = middle;
            known = then;
        } else {
            high = middle;
        }
    }
    mpz_fdiv_q_2exp(span->num, span->before, last - high);
    *k = high;
}

/* From an interval that has to be refined to one below it: as far as a leap goes, or to
 * its first half. span->zoomed is of that then, and span->base of the other one. *stride:
 * what the last leap suggests for the next one. */
static void refine(struct eng_exact_span *span, int variations, unsigned long *k,
                   unsigned long *stride)
{
    unsigned long most = *stride;
    eng_poly_copy(&span->base, &span->zoomed);
    eng_poly_shorten(&span->base);
    mpz_set(span->base_num, span->num);
    span->base_k = *k;
    if (variations == 1 && span->wants_first && *k < span->depth_min) {
        /* No farther than where bisection may stop. */
        most = most < span->depth_min - *k ? most : span->depth_min - *k;
    }
    if (most > 1 && leap(span, variations, most)) {
        *k += most;
        set_bottom(span, *k);
        *stride = *stride < STRIDE_MAX ? *stride * 2 : STRIDE_MAX;
        return;
    }
    mpz_set_ui(span->end, 0);
    eng_poly_zoom(&span->zoomed, &span->base, span->end, 1);
    mpz_mul_2exp(span->num, span->num, 1);
    ++*k;
    *stride = *stride / 8 > 2 ? *stride / 8 : 2;
}

/* The polynomial of the interval at hand: as a rule the second half of the last one that
 * was refined. */
static void zoom(struct eng_exact_span *span, unsigned long k)
{
    mpz_fdiv_q_2exp(span->end, span->num, 1);
    if (k == span->base_k + 1 && mpz_odd_p(span->num) &&
        mpz_cmp(span->end, span->base_num) == 0) {
        mpz_set_ui(span->end, 1);
        eng_poly_zoom(&span->zoomed, &span->base, span->end, 1);
    } else {
        eng_poly_zoom(&span->zoomed, &span->root, span->num, k);
    }
}

bool eng_roots_satisfy(struct eng_exact_span *span, const struct eng_poly *poly,
                       const struct eng_conditions *conditions)
{
    struct known known = {{false}, {false}};
    struct known before; /* the interval at hand was judged */
    unsigned long k = 0;
    unsigned long stride = 2;
    unsigned long undecided = 0; /* k of the last interval around one root without one */
    span->chain_count = 0;
    if (poly->degree < 1) {
        return false;
    }
    if (eng_residue_is_square_free(poly)) {
        eng_poly_copy(&span->root, poly);
        eng_poly_shorten(&span->root);
    } else {
        eng_poly_square_free(&span->root, poly, &span->scratch[0], &span->scratch[1],
                             &span->scratch[2]);
    }
    mpz_set_ui(span->num, 1);
    bool at_1 = eng_poly_sign_at_1(&span->root) == 0 &&
                eng_roots_hold_at_left(span, conditions, 0);
    if (at_1 && !span->wants_first) {
        return true;
    }
    mpz_set_ui(span->num, 0);
    eng_poly_copy(&span->zoomed, &span->root);
    mpz_set_si(span->base_num, -1); /* there is none */
    while (k > 0 || mpz_sgn(span->num) == 0) {
        int sign;
        if (eng_poly_sign_at_0(&span->zoomed) == 0 &&
            eng_roots_hold_at_left(span, conditions, k)) {
            eng_roots_found_at(span, k, 0);
            return true;
        }
        int roots = eng_poly_variations(&span->zoomed, &sign);
        before = known;
        enum verdict verdict = roots == 0   ? NO
                               : roots == 1 ? judge(span, conditions, k, &known)
                                            : REFINE;
        if (verdict == YES && (!span->wants_first || k >= span->depth_min)) {
            if (span->wants_first && undecided >= span->depth_min && k > undecided + 1) {
                step_back(span, conditions, undecided, &k, before);
            }
            eng_roots_found_at(span, k, 1);
            return true;
        }
        undecided = verdict == REFINE ? k : 0;
        if (verdict == NO) {
            /* What holds around one root does so no further than the chain's bottom. */
            if (leave(span, &k) || roots > 0) {
                memset(known.holds, 0, sizeof known.holds);
                stride = 2;
            }
            zoom(span, k);
        } else {
            enter(span, roots, k);
            refine(span, roots, &k, &stride);
        }
    }
    if (at_1) {
        eng_roots_found_at(span, 0, 0); /* num is 1 */
    }
    return at_1;
}
