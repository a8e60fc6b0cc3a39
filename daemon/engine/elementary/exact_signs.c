/* exact_signs.c - whether the conditions hold at a root.
 *
 * Find the signs of the sides at the only root in an interval: those that have one sign
 * throughout, then with few bits, then in a shorter interval, then with all bits.
 *
 * The sides are parallel to n at the root, so one coordinate tells their signs, where n
 * has one that is not 0.
 */
#include "exact_roots.h"

#include <assert.h>
#include <string.h>

/* Intervals are made shorter for the sake of a sign until this many bits. Deeper, numbers
 * are so long that all bits are no dearer. */
#define DEEP 4096ul

static int sign_at_left(struct eng_exact_span *span, const struct eng_poly *poly)
{
    eng_poly_zoom(&span->sign, poly, span->roots.num, span->roots.k);
    return eng_poly_sign_at_0(&span->sign);
}

bool eng_roots_hold_at_left(struct eng_exact_span *span,
                            const struct eng_conditions *conditions)
{
    int axis = 0;
    int n = 1;
    if (conditions->has_plane) {
        n = sign_at_left(span, &span->form->n[0]);
        while (n == 0 && axis < 2) {
            n = sign_at_left(span, &span->form->n[++axis]);
        }
    }
    for (int i = 0; n != 0 && i < conditions->count; i++) {
        if (sign_at_left(span, &span->form->side[i][axis]) * n < 0) {
            return false;
        }
    }
    return n != 0;
}

/* The signs that are known at a root. */
struct signs {
    int n[3]; /* of the coordinates of n; 0: 0, or not known */
    int axis; /* one that is not 0; -1: not known */
    bool is_known[ENG_EXACT_CONDITIONS];
    int side[ENG_EXACT_CONDITIONS]; /* of each, seen along n */
};

enum answer { HOLDS, FAILS, UNKNOWN };

static enum answer answer_of(const struct eng_conditions *conditions,
                             const struct signs *signs)
{
    enum answer answer = signs->axis < 0 ? UNKNOWN : HOLDS;
    for (int i = 0; i < conditions->count; i++) {
        if (signs->is_known[i] && signs->side[i] < 0) {
            return FAILS;
        }
        answer = signs->is_known[i] ? answer : UNKNOWN;
    }
    return answer;
}

/* The signs that some coordinates have throughout the interval at hand. */
static enum answer look(struct eng_exact_span *span,
                        const struct eng_conditions *conditions, struct signs *signs)
{
    struct eng_poly *scratch = &span->sign;
    struct eng_isolator *roots = &span->roots;
    int sign;
    for (int axis = 0; axis < 3 && conditions->has_plane; axis++) {
        if (signs->n[axis] == 0 && eng_poly_is_plain(scratch, &span->form->n[axis],
                                                     roots->num, roots->k, &sign)) {
            signs->n[axis] = sign;
            signs->axis = sign != 0 ? axis : signs->axis;
        }
    }
    for (int i = 0; i < conditions->count; i++) {
        const struct eng_poly *side = span->form->side[i];
        for (int axis = 0; axis < 3 && !signs->is_known[i]; axis++) {
            if (signs->n[axis] != 0 &&
                eng_poly_is_plain(scratch, &side[axis], roots->num, roots->k, &sign)) {
                signs->is_known[i] = true;
                signs->side[i] = sign * signs->n[axis];
            }
        }
        if (signs->is_known[i] && signs->side[i] < 0) {
            return FAILS;
        }
    }
    return answer_of(conditions, signs);
}

/* An axis along which n is not 0. False: n is 0. */
static bool find_axis(struct eng_exact_span *span, const struct eng_root *root,
                      bool by_all_bits, struct signs *signs)
{
    int zero_count = 0;
    for (int axis = 0; axis < 3 && signs->axis < 0; axis++) {
        int sign;
        bool is_sure = eng_root_sign_of(&span->root_sign, &span->form->n[axis], root,
                                        by_all_bits, &sign);
        if (is_sure && sign != 0) {
            signs->n[axis] = sign;
            signs->axis = axis;
        }
        zero_count += is_sure && sign == 0;
    }
    return zero_count < 3;
}

/* The signs that are not known yet, as far as the bits tell. */
static enum answer compute(struct eng_exact_span *span,
                           const struct eng_conditions *conditions,
                           const struct eng_root *root, bool by_all_bits,
                           struct signs *signs)
{
    if (!find_axis(span, root, by_all_bits, signs)) {
        return FAILS;
    }
    for (int i = 0; i < conditions->count && signs->axis >= 0; i++) {
        if (signs->is_known[i]) {
            continue;
        }
        int sign = 0;
        signs->is_known[i] =
            (conditions->is_zero != NULL && conditions->is_zero(span, i, root)) ||
            eng_root_sign_of(&span->root_sign, &span->form->side[i][signs->axis], root,
                             by_all_bits, &sign);
        signs->side[i] = sign * signs->n[signs->axis];
        if (signs->is_known[i] && signs->side[i] < 0) {
            return FAILS;
        }
    }
    return answer_of(conditions, signs);
}

/* Signs that show in shorter intervals around the root; the one at hand stays. Roots that
 * are 2^-1000 from each other take a few leaps, which all signs have in common. */
static enum answer look_deeper(struct eng_exact_span *span,
                               const struct eng_conditions *conditions,
                               struct signs *signs)
{
    struct eng_isolator *roots = &span->roots;
    enum answer answer = UNKNOWN;
    const unsigned long k = roots->k;
    unsigned long next_k = k < 128 ? 256 : 2 * k;
    mpz_set(span->before, roots->num);
    while (answer == UNKNOWN && roots->k < DEEP &&
           eng_isolate_narrow(roots, DEEP - roots->k)) {
        if (roots->k >= next_k) {
            answer = look(span, conditions, signs);
            next_k = 2 * roots->k;
        }
    }
    eng_isolate_return(roots, span->before, k);
    return answer;
}

/* Return whether the conditions hold at the only root in the interval at hand. */
static bool hold(struct eng_exact_span *span, const struct eng_conditions *conditions,
                 bool is_zero[ENG_EXACT_CONDITIONS])
{
    struct eng_isolator *roots = &span->roots;
    struct signs signs = {.axis = -1};
    int before = 0;
    for (int i = 0; before == 0; i++) {
        before = mpz_sgn(roots->zoomed.c[i]);
    }
    if (!conditions->has_plane) {
        signs.axis = 0;
        signs.n[0] = 1;
    }
    const struct eng_root root = {&roots->root, &roots->num, roots->k, before};
    enum answer answer = look(span, conditions, &signs);
    if (answer == UNKNOWN) {
        /* For one sign alone, a shorter interval does not pay. */
        answer = compute(span, conditions, &root, conditions->count == 1, &signs);
    }
    if (answer == UNKNOWN) {
        answer = look_deeper(span, conditions, &signs);
    }
    if (answer == UNKNOWN) {
        answer = compute(span, conditions, &root, true, &signs);
    }
    assert(answer != UNKNOWN);
    for (int i = 0; i < conditions->count; i++) {
        is_zero[i] = answer == HOLDS && signs.side[i] == 0;
    }
    return answer == HOLDS;
}

bool eng_roots_hold_at(struct eng_exact_span *span,
                       const struct eng_conditions *conditions, int number,
                       bool is_zero[ENG_EXACT_CONDITIONS])
{
    struct eng_exact_known *known = &span->known;
    if (!conditions->has_plane) {
        return hold(span, conditions, is_zero);
    }
    assert(number <= known->count && number < ENG_POLY_TERMS);
    if (number == known->count) {
        known->holds[number] = hold(span, conditions, known->is_zero[number]);
        known->count++;
    }
    memcpy(is_zero, known->is_zero[number], sizeof known->is_zero[number]);
    return known->holds[number];
}
