/* exact_roots.c - roots in a span that satisfy conditions.
 *
 * Source: Collins and Akritas 1976; Abbott: Quadratic interval refinement for real roots,
 * 2006.
 */
#include "exact_roots.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* ---- values ------------------------------------------------------------------------ */

/* Which of span->condition are 0 at the root at hand, or have one sign throughout the
 * interval. */
struct plains {
    bool is_plain[ENG_EXACT_CONDITIONS];
};

/* A root is found at which the conditions hold. */
static void begin_values(struct eng_exact_span *span,
                         const struct eng_conditions *conditions, struct plains *plains)
{
    for (int i = 0; i < conditions->value_count; i++) {
        span->has_value[i] = false;
        plains->is_plain[i] = i < conditions->count && plains->is_plain[i];
    }
    mpz_set_ui(span->value_num, 0);
    span->value_k = 0;
}

/* span->end and what is returned name the interval at hand, as seen from the interval
 * around it that the values are of. */
static unsigned long set_local(struct eng_exact_span *span, unsigned long k)
{
    mpz_mul_2exp(span->end, span->value_num, k - span->value_k);
    mpz_sub(span->end, span->num, span->end);
    return k - span->value_k;
}

static void zoom_value(struct eng_exact_span *span, int i, mpz_t num, unsigned long k)
{
    eng_poly_zoom(&span->sign, &span->condition[i], num, k);
    eng_poly_shorten(&span->sign);
    eng_poly_copy(&span->condition[i], &span->sign);
}

static bool is_plain(struct eng_exact_span *span, const struct eng_conditions *conditions,
                     int i, unsigned long k)
{
    int sign;
    if (!span->has_value[i]) {
        conditions->set_value(span, conditions, i);
        zoom_value(span, i, span->value_num, span->value_k);
        span->has_value[i] = true;
    }
    unsigned long local_k = set_local(span, k);
    return eng_poly_is_plain(&span->sign, &span->condition[i], span->end, local_k, &sign);
}

/* Does each of the values have one sign throughout the interval at hand, or is 0 at the
 * root? Those that do are noted: they do so in all intervals within it. */
static bool are_plain(struct eng_exact_span *span,
                      const struct eng_conditions *conditions, unsigned long k,
                      struct plains *plains)
{
    for (int i = 0; i < conditions->value_count; i++) {
        plains->is_plain[i] = plains->is_plain[i] || is_plain(span, conditions, i, k);
        if (!plains->is_plain[i]) {
            return false;
        }
    }
    return true;
}

/* Numbers become longer with each zoom, so it waits until an interval's place takes this
 * many bits. */
#define ZOOM_BITS 64ul

/* From now on only intervals within the one at hand are asked about. */
static void zoom_values(struct eng_exact_span *span,
                        const struct eng_conditions *conditions, unsigned long k,
                        const struct plains *plains)
{
    unsigned long local_k = set_local(span, k);
    if (local_k < ZOOM_BITS) {
        return;
    }
    for (int i = 0; i < conditions->value_count; i++) {
        if (!plains->is_plain[i] && span->has_value[i]) {
            zoom_value(span, i, span->end, local_k);
        }
    }
    mpz_set(span->value_num, span->num);
    span->value_k = k;
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

/* The values are plain in the interval `num` / 2^k, and were not at 2^`low`: back to
 * the first interval around it in which they are, where bisection stops. */
static void step_back(struct eng_exact_span *span,
                      const struct eng_conditions *conditions, unsigned long low,
                      unsigned long *k, struct plains plains)
{
    mpz_set(span->before, span->num);
    unsigned long last = *k;
    unsigned long high = last;
    while (high - low > 1) {
        unsigned long middle = low + (high - low) / 2;
        mpz_fdiv_q_2exp(span->num, span->before, last - middle);
        struct plains then = plains;
        if (are_plain(span, conditions, middle, &then)) {
            high = middle;
        } else {
            low = middle;
            plains = then;
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
    assert(*k < ENG_EXACT_DEPTH);
    most = most < ENG_EXACT_DEPTH - *k ? most : ENG_EXACT_DEPTH - *k;
    if (most > 1 && eng_roots_leap(span, variations, most)) {
        *k += most;
        set_bottom(span, *k);
        *stride = *stride < ENG_STRIDE_MAX ? *stride * 2 : ENG_STRIDE_MAX;
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

/* Intervals from a look at the clock to the next one, up to 30 us each. */
#define INTERVALS_A_LOOK 8u

static bool should_stop(struct eng_exact_watch *watch)
{
    if (watch->should_stop != NULL && !watch->has_stopped &&
        ++watch->looked_at % INTERVALS_A_LOOK == 0) {
        watch->has_stopped = watch->should_stop(watch->owner);
    }
    return watch->has_stopped;
}

/* Each root once. */
static void set_root(struct eng_exact_span *span, const struct eng_poly *poly)
{
    if (eng_residue_is_square_free(poly)) {
        eng_poly_copy(&span->root, poly);
        eng_poly_shorten(&span->root);
    } else {
        eng_poly_square_free(&span->root, poly);
    }
}

bool eng_roots_satisfy(struct eng_exact_span *span, const struct eng_poly *poly,
                       const struct eng_conditions *conditions)
{
    struct plains plains = {{false}};
    bool is_found = false; /* the interval at hand has one root, which satisfies */
    unsigned long k = 0;
    unsigned long stride = 2;
    int roots_seen = 0;
    unsigned long undecided = 0; /* k of the last interval around it that was not plain */
    span->chain_count = 0;
    if (poly->degree < 1) {
        return false;
    }
    set_root(span, poly);
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
        if (should_stop(&span->watch)) {
            return false;
        }
        if (eng_poly_sign_at_0(&span->zoomed) == 0 &&
            eng_roots_hold_at_left(span, conditions, k)) {
            eng_roots_found_at(span, k, 0);
            return true;
        }
        int roots = eng_poly_variations(&span->zoomed, &sign);
        if (roots == 1 && !is_found) {
            is_found =
                eng_roots_hold_at(span, conditions, roots_seen++, k, plains.is_plain);
            if (is_found && !span->wants_first) {
                return true;
            }
            if (is_found) {
                begin_values(span, conditions, &plains);
            }
        }
        if (roots == 1 && is_found && k >= span->depth_min) {
            struct plains now = plains;
            if (k == ENG_EXACT_DEPTH || are_plain(span, conditions, k, &now)) {
                if (k < ENG_EXACT_DEPTH && undecided > 0 && k > undecided + 1) {
                    step_back(span, conditions, undecided, &k, plains);
                }
                eng_roots_found_at(span, k, 1);
                return true;
            }
            plains = now;
            undecided = k;
            zoom_values(span, conditions, k, &plains);
        }
        if (roots == 0 || (roots == 1 && !is_found)) {
            if (leave(span, &k) || roots > 0) {
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
