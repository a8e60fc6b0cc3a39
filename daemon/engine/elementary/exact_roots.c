/* exact_roots.c - roots in a span that satisfy conditions. */
#include "exact_roots.h"

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
static unsigned long set_local(struct eng_exact_span *span)
{
    const struct eng_isolator *roots = &span->roots;
    mpz_mul_2exp(span->end, span->value_num, roots->k - span->value_k);
    mpz_sub(span->end, roots->num, span->end);
    return roots->k - span->value_k;
}

static void zoom_value(struct eng_exact_span *span, int i, mpz_t num, unsigned long k)
{
    eng_poly_zoom(&span->sign, &span->condition[i], num, k);
    eng_poly_shorten(&span->sign);
    eng_poly_copy(&span->condition[i], &span->sign);
}

static bool is_plain(struct eng_exact_span *span, const struct eng_conditions *conditions,
                     int i)
{
    int sign;
    if (!span->has_value[i]) {
        conditions->set_value(span, conditions, i);
        zoom_value(span, i, span->value_num, span->value_k);
        span->has_value[i] = true;
    }
    unsigned long local_k = set_local(span);
    return eng_poly_is_plain(&span->sign, &span->condition[i], span->end, local_k, &sign);
}

/* Return whether each of the values has one sign throughout the interval at hand, or is 0
 * at the root. Those that do are noted: they do so in all intervals within it. */
static bool are_plain(struct eng_exact_span *span,
                      const struct eng_conditions *conditions, struct plains *plains)
{
    for (int i = 0; i < conditions->value_count; i++) {
        plains->is_plain[i] = plains->is_plain[i] || is_plain(span, conditions, i);
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
                        const struct eng_conditions *conditions,
                        const struct plains *plains)
{
    unsigned long local_k = set_local(span);
    if (local_k < ZOOM_BITS) {
        return;
    }
    for (int i = 0; i < conditions->value_count; i++) {
        if (!plains->is_plain[i] && span->has_value[i]) {
            zoom_value(span, i, span->end, local_k);
        }
    }
    mpz_set(span->value_num, span->roots.num);
    span->value_k = span->roots.k;
}

void eng_roots_found_at(struct eng_exact_span *span, unsigned wide)
{
    mpz_srcptr num = span->roots.num;
    const long k = (long)span->roots.k;
    long exponent;
    double number = mpz_get_d_2exp(&exponent, num); /* cut off, not rounded */
    double from = ldexp(number, (int)(exponent - k));
    mpz_add_ui(span->end, num, wide);
    number = mpz_get_d_2exp(&exponent, span->end);
    double to = ldexp(number, (int)(exponent - k)) * (1 + 0x1p-51);
    to += number > 0 ? 0x1p-1022 : 0;
    span->found[0] = fmin(span->found[0], from);
    span->found[1] = fmin(span->found[1], to);
}

/* ---- roots ------------------------------------------------------------------------- */

/* The values are plain in the interval at hand, and were not at 2^`low`: back to the
 * first interval around it in which they are, where bisection stops. */
static void step_back(struct eng_exact_span *span,
                      const struct eng_conditions *conditions, unsigned long low,
                      struct plains plains)
{
    struct eng_isolator *roots = &span->roots;
    mpz_set(span->before, roots->num);
    const unsigned long last = roots->k;
    unsigned long high = last;
    while (high - low > 1) {
        unsigned long middle = low + (high - low) / 2;
        mpz_fdiv_q_2exp(roots->num, span->before, last - middle);
        roots->k = middle;
        struct plains then = plains;
        if (are_plain(span, conditions, &then)) {
            high = middle;
        } else {
            low = middle;
            plains = then;
        }
    }
    mpz_fdiv_q_2exp(roots->num, span->before, last - high);
    roots->k = high;
}

/* Intervals from a look at the clock to the next one, up to 30 us each. */
#define INTERVALS_A_LOOK 8u

static bool should_stop(struct eng_exact_interrupt *interrupt)
{
    if (interrupt->should_stop != NULL && !interrupt->has_stopped &&
        ++interrupt->looked_at % INTERVALS_A_LOOK == 0) {
        interrupt->has_stopped = interrupt->should_stop(interrupt->owner);
    }
    return interrupt->has_stopped;
}

/* Each root once. */
static void set_root(struct eng_exact_span *span, const struct eng_poly *poly)
{
    if (eng_residue_is_square_free(poly)) {
        eng_poly_copy(&span->roots.root, poly);
        eng_poly_shorten(&span->roots.root);
    } else {
        eng_poly_square_free(&span->roots.root, poly);
    }
}

/* Find where the root is that is alone in the interval at hand, at which the conditions
 * hold: in the first interval of bisection that is short enough. False: nobody waits. */
static bool find_place(struct eng_exact_span *span,
                       const struct eng_conditions *conditions, struct plains *plains)
{
    struct eng_isolator *roots = &span->roots;
    unsigned long undecided = 0; /* k of the last interval around it that was not plain */
    begin_values(span, conditions, plains);
    while (!should_stop(&span->interrupt)) {
        /* No farther at once than where bisection may stop. */
        unsigned long most = span->depth_min - roots->k;
        if (roots->k >= span->depth_min) {
            struct plains now = *plains;
            bool is_last = roots->k == ENG_EXACT_DEPTH;
            if (is_last || are_plain(span, conditions, &now)) {
                if (!is_last && undecided > 0) {
                    step_back(span, conditions, undecided, *plains);
                }
                eng_roots_found_at(span, 1);
                return true;
            }
            *plains = now;
            undecided = roots->k;
            zoom_values(span, conditions, plains);
            most = ENG_EXACT_DEPTH - roots->k;
        }
        if (!eng_isolate_narrow(roots, most)) {
            eng_roots_found_at(span, 0);
            return true;
        }
    }
    return false;
}

bool eng_roots_satisfy(struct eng_exact_span *span, const struct eng_poly *poly,
                       const struct eng_conditions *conditions)
{
    struct eng_isolator *roots = &span->roots;
    struct plains plains = {{false}};
    int roots_seen = 0;
    if (poly->degree < 1) {
        return false;
    }
    set_root(span, poly);
    eng_isolate_begin(roots);
    while (eng_isolate_next(roots)) {
        if (should_stop(&span->interrupt)) {
            return false;
        }
        if (roots->variations > 1) {
            eng_isolate_split(roots);
        } else if (roots->variations == 0) {
            if (eng_roots_hold_at_left(span, conditions)) {
                eng_roots_found_at(span, 0);
                return true;
            }
        } else if (eng_roots_hold_at(span, conditions, roots_seen++, plains.is_plain)) {
            return !span->wants_first || find_place(span, conditions, &plains);
        }
    }
    return false;
}
