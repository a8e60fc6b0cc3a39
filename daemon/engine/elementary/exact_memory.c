/* exact_memory.c - the room that exact arithmetic computes in. */
#include <string.h>

#include "exact.h"
#include "memory.h"
#include "pccd_types.h"

#define X ((size_t)ENG_EXACT_BITS)
#define T (X - 60)        /* times are at most 1 */
#define P (X + T)         /* what takes a coordinate at an end of a span */
#define K ENG_EXACT_DEPTH /* of an interval in it */
#define M (2u * X + 5u)   /* coefficients of a quadratic over the step */

#define SIZE(terms, bits, scratch_count, scratch_bits)                                   \
    (&(const struct eng_poly_size){terms, bits, scratch_count, scratch_bits})

static void place_all(struct eng_poly *polys, int count, struct eng_limbs *limbs,
                      const struct eng_poly_size *size)
{
    for (int i = 0; i < count; i++) {
        eng_poly_allocate(&polys[i], limbs, size);
    }
}

static void place_form(struct eng_exact_form *form, struct eng_limbs *limbs, size_t bits,
                       int scratch_count)
{
    const struct eng_poly_size *quadratic =
        SIZE(3, 2 * bits + 24, scratch_count, 2 * bits + 24);
    eng_poly_allocate(&form->det, limbs, SIZE(4, 3 * bits + 40, 4, 3 * bits + 40));
    place_all(form->n, 3, limbs, quadratic);
    place_all(form->side[0], 3 * ENG_EXACT_CONDITIONS, limbs, quadratic);
}

static void place_events(struct eng_exact_span *span, struct eng_limbs *limbs)
{
    const struct eng_poly_size *difference = SIZE(2, X + 8, 2, X + 8);
    place_all(span->to_j, 3, limbs, difference);
    place_all(span->to_k, 3, limbs, difference);
    place_all(span->line, 3, limbs, SIZE(3, 5 * M + 16, 2, 5 * M + 16));
    eng_poly_allocate(&span->common, limbs, SIZE(3, 5 * M + 16, 3, 5 * M + 16));
    for (int i = 0; i < ENG_EXACT_EVENTS; i++) {
        eng_poly_allocate(&span->events[i].common, limbs,
                          SIZE(3, 5 * M + 16, 3, 5 * M + 16));
        eng_poly_allocate(&span->events[i].between, limbs, SIZE(3, M + 8, 0, 0));
    }
}

static void allocate_polys(struct eng_exact_span *span, struct eng_limbs *limbs)
{
    const struct eng_poly_size *difference = SIZE(2, X + 8, 2, X + 8);
    const size_t zoomed_bits = 3 * P + 3 * K + 128;
    const size_t sign_bits = 4 * P + 6 * K + 128;
    place_all(span->p, 3, limbs, difference);
    place_all(span->b, 3, limbs, difference);
    place_all(span->c, 3, limbs, difference);
    place_form(&span->whole, limbs, X, 0);
    place_form(&span->part, limbs, P, 2);
    place_all(span->products, ENG_EXACT_PRODUCTS, limbs, SIZE(3, M + 8, 0, 0));
    place_all(span->values, ENG_EXACT_VALUES, limbs, SIZE(5, 4 * X + 32, 0, 0));
    place_events(span, limbs);
    eng_poly_allocate(&span->scratch, limbs, SIZE(5, 4 * P + 64, 2, 4 * P + 64));
    eng_isolate_allocate(&span->roots, limbs, SIZE(4, 6 * P + 96, 4, 12 * P + 192),
                         zoomed_bits, K);
    eng_poly_allocate(&span->sign, limbs, SIZE(5, sign_bits, 5, sign_bits));
    place_all(span->condition, ENG_EXACT_CONDITIONS, limbs,
              SIZE(5, 4 * P + 4 * K + 64, 0, 0));
}

static void place(struct eng_exact *exact, struct eng_limbs *limbs)
{
    struct eng_exact_span *span = &exact->span;
    for (int i = 0; i < ENG_EXACT_WORDS; i++) {
        eng_limbs_give(limbs, exact->z[i], 4 * X + 32);
    }
    for (int i = 0; i < 24; i++) {
        eng_limbs_give(limbs, span->x[i / 12][i / 3 % 4][i % 3], X + 8);
    }
    eng_limbs_give(limbs, span->l, T + 8);
    eng_limbs_give(limbs, span->width, T + 8);
    eng_limbs_give(limbs, span->before, K + 8);
    eng_limbs_give(limbs, span->value_num, K + 8);
    eng_limbs_give(limbs, span->end, 3 * P + 4 * K + 128);
    allocate_polys(span, limbs);
    eng_root_sign_allocate(&span->root_sign, limbs, P, K);
}

static size_t limbs_of_all(void)
{
    struct eng_exact nobody;
    struct eng_limbs limbs = {NULL, 0};
    memset(&nobody, 0, sizeof nobody);
    place(&nobody, &limbs);
    return limbs.count;
}

size_t eng_exact_bytes(void)
{
    return limbs_of_all() * sizeof(mp_limb_t);
}

int eng_exact_init(struct eng_exact *exact)
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

void eng_exact_deinit(struct eng_exact *exact)
{
    eng_free(exact->block);
    exact->block = NULL;
}
