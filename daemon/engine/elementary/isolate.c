/* isolate.c - roots by bisection, sign variations and leaps. */
#include "isolate.h"

#include <assert.h>

/* Halvings that leave all roots in one half before a leap is tried. */
#define ALONE_MIN  3u
#define STRIDE_MIN 4ul

void eng_isolate_allocate(struct eng_isolator *isolator, struct eng_limbs *limbs,
                          const struct eng_poly_size *root_size, size_t zoomed_bits,
                          unsigned long depth_max)
{
    const struct eng_poly_size zoomed = {root_size->terms, zoomed_bits, root_size->terms,
                                         zoomed_bits};
    const size_t num_bits = depth_max + 8;
    isolator->depth_max = depth_max;
    eng_poly_allocate(&isolator->root, limbs, root_size);
    eng_poly_allocate(&isolator->zoomed, limbs, &zoomed);
    eng_poly_allocate(&isolator->base, limbs, &zoomed);
    eng_limbs_give(limbs, isolator->num, num_bits);
    eng_limbs_give(limbs, isolator->at, num_bits);
    eng_limbs_give(limbs, isolator->part, zoomed_bits + ENG_ISOLATE_STRIDE_MAX);
    for (int i = 0; i < ENG_ISOLATE_PENDING; i++) {
        eng_limbs_give(limbs, isolator->pending[i].num, num_bits);
    }
}

/* ---- parts ------------------------------------------------------------------------- */

/* The interval at hand is to be cut. */
static void set_base(struct eng_isolator *isolator)
{
    eng_poly_copy(&isolator->base, &isolator->zoomed);
    eng_poly_shorten(&isolator->base);
}

/* Return the variations in part number isolator->part of 2^stride: isolator->at names it,
 * and isolator->zoomed is of it. */
static int look_at_part(struct eng_isolator *isolator, unsigned long stride)
{
    int sign;
    mpz_mul_2exp(isolator->at, isolator->num, stride);
    mpz_add(isolator->at, isolator->at, isolator->part);
    eng_poly_zoom(&isolator->zoomed, &isolator->base, isolator->part, stride);
    return eng_poly_variations(&isolator->zoomed, &sign);
}

/* One of both halves. */
static int look_at_half(struct eng_isolator *isolator, unsigned long half)
{
    mpz_set_ui(isolator->part, half);
    return look_at_part(isolator, 1);
}

/* Find a part that has all variations, where the roots seem to be. isolator->at and
 * isolator->zoomed are of it, then. */
static bool leap(struct eng_isolator *isolator, unsigned long stride)
{
    mpz_ptr part = isolator->part;
    int all = isolator->variations;
    if (!eng_poly_guess(part, &isolator->base, all, stride)) {
        mpz_set_ui(part, 0);
    }
    if (look_at_part(isolator, stride) == all) {
        return true;
    }
    if (mpz_sgn(part) == 0) {
        return false;
    }
    mpz_sub_ui(part, part, 1);
    return look_at_part(isolator, stride) == all;
}

static unsigned long least(unsigned long a, unsigned long b)
{
    return a < b ? a : b;
}

static unsigned long longer(unsigned long stride)
{
    return least(2 * stride, ENG_ISOLATE_STRIDE_MAX);
}

static unsigned long shorter(unsigned long stride)
{
    return stride / 8 > STRIDE_MIN ? stride / 8 : STRIDE_MIN;
}

/* ---- intervals --------------------------------------------------------------------- */

/* Push what isolator->at names before all that waits. */
static void push(struct eng_isolator *isolator, unsigned long k, int variations,
                 unsigned alone, unsigned long stride)
{
    assert(isolator->pending_count < ENG_ISOLATE_PENDING);
    struct eng_isolate_pending *top = &isolator->pending[isolator->pending_count++];
    mpz_set(top->num, isolator->at);
    top->k = k;
    top->variations = variations;
    top->alone = alone;
    top->stride = stride;
}

void eng_isolate_begin(struct eng_isolator *isolator)
{
    int sign;
    int variations = eng_poly_variations(&isolator->root, &sign);
    isolator->pending_count = 0;
    isolator->is_zoomed = false;
    mpz_set_ui(isolator->at, 1);
    if (eng_poly_sign_at_1(&isolator->root) == 0) {
        push(isolator, 0, 0, 0, STRIDE_MIN);
    }
    mpz_set_ui(isolator->at, 0);
    if (variations > 0) {
        push(isolator, 0, variations, 0, STRIDE_MIN);
    }
    if (eng_poly_sign_at_0(&isolator->root) == 0) {
        push(isolator, 0, 0, 0, STRIDE_MIN);
    }
}

bool eng_isolate_next(struct eng_isolator *isolator)
{
    if (isolator->pending_count == 0) {
        return false;
    }
    struct eng_isolate_pending *top = &isolator->pending[--isolator->pending_count];
    mpz_swap(isolator->num, top->num);
    isolator->k = top->k;
    isolator->variations = top->variations;
    isolator->alone = top->alone;
    isolator->stride = top->stride;
    if (!isolator->is_zoomed && top->variations > 0) {
        eng_poly_zoom(&isolator->zoomed, &isolator->root, isolator->num, isolator->k);
    }
    isolator->is_zoomed = false;
    return true;
}

void eng_isolate_split(struct eng_isolator *isolator)
{
    const int all = isolator->variations;
    const unsigned long k = isolator->k;
    unsigned long stride = least(isolator->stride, isolator->depth_max - k);
    set_base(isolator);
    if (isolator->alone >= ALONE_MIN && leap(isolator, stride)) {
        push(isolator, k + stride, all, isolator->alone, longer(stride));
        isolator->is_zoomed = true;
        return;
    }
    assert(k < isolator->depth_max);
    int behind = look_at_half(isolator, 1);
    unsigned alone = behind == 0 || behind == all ? isolator->alone + 1 : 0;
    if (behind > 0) {
        push(isolator, k + 1, behind, alone, shorter(stride));
    }
    if (eng_poly_sign_at_0(&isolator->zoomed) == 0) {
        push(isolator, k + 1, 0, 0, STRIDE_MIN);
    }
    int before = look_at_half(isolator, 0);
    if (before > 0) {
        push(isolator, k + 1, before, alone, shorter(stride));
    }
    isolator->is_zoomed = before > 0;
}

bool eng_isolate_narrow(struct eng_isolator *isolator, unsigned long most)
{
    unsigned long stride =
        least(least(isolator->stride, most), isolator->depth_max - isolator->k);
    bool is_within = true;
    assert(stride > 0);
    set_base(isolator);
    if (stride > 1 && leap(isolator, stride)) {
        isolator->k += stride;
        isolator->stride = longer(isolator->stride);
    } else {
        is_within = look_at_half(isolator, 0) == 1 || look_at_half(isolator, 1) == 1;
        isolator->k++;
        isolator->stride = shorter(isolator->stride);
    }
    mpz_swap(isolator->num, isolator->at);
    return is_within;
}

void eng_isolate_return(struct eng_isolator *isolator, mpz_srcptr num, unsigned long k)
{
    mpz_set(isolator->num, num);
    isolator->k = k;
    isolator->variations = 1;
    isolator->stride = STRIDE_MIN;
    eng_poly_zoom(&isolator->zoomed, &isolator->root, num, k);
}
