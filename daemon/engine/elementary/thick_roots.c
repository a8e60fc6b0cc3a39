/* thick_roots.c - roots at which other polynomials are positive.
 *
 * See thick_exact.h. Bisection and Descartes' rule of signs, first on the polynomial
 * until a root is alone, then until no side has a root beside it. A side that is 0 at the
 * root is known by a common divisor, which is looked for when bisection does not end
 * soon.
 *
 * An interval [num, num + 1] / 2^k is named by num and k.
 */
#include "thick_exact.h"

#include <assert.h>
#include <math.h>

#include "poly.h"

/* Turns beside a side's root before a common divisor is looked for. */
#define TURNS_MAX 6

/* Of leaps. */
#define STRIDE_MIN 4ul
#define STRIDE_MAX 1024ul

/* BOUNDS.md, "How long numbers become". */
#define ROOT_BITS   (ENG_THICK_POLY_BITS + 16ul) /* the polynomial, each root once */
#define DEPTH_MAX   (86310ul + STRIDE_MAX)       /* of an interval */
#define ZOOMED_BITS (ROOT_BITS + 6 * DEPTH_MAX + 32)

static void place(struct eng_poly *poly, struct eng_limbs *limbs, int terms, size_t bits)
{
    const struct eng_poly_size size = {terms, bits, terms, bits};
    eng_poly_place(poly, limbs, &size);
}

void eng_thick_roots_place(struct eng_thick_roots *roots, struct eng_limbs *limbs)
{
    place(&roots->root, limbs, 7, ROOT_BITS);
    place(&roots->slope, limbs, 6, ROOT_BITS);
    place(&roots->zoomed, limbs, 7, ZOOMED_BITS);
    place(&roots->base, limbs, 7, ZOOMED_BITS);
    place(&roots->sign, limbs, 7, ZOOMED_BITS);
    eng_divisor_place(&roots->divisor, limbs);
    eng_limbs_give(limbs, roots->num, ZOOMED_BITS);
    eng_limbs_give(limbs, roots->at, ZOOMED_BITS);
    eng_limbs_give(limbs, roots->part, ZOOMED_BITS + STRIDE_MAX);
    eng_limbs_give(limbs, roots->cell, DEPTH_MAX + 64);
    for (int i = 0; i < ENG_THICK_PENDING; i++) {
        eng_limbs_give(limbs, roots->pending[i].num, DEPTH_MAX);
    }
}

/* ---- cells ------------------------------------------------------------------------- */

/* Of a time `number` / 2^(depth + ENG_THICK_CELL_BITS). */
static int64_t cell_at(int64_t number)
{
    int64_t above = number - ENG_THICK_CELL_OFFSET;
    return above < 0 ? -1 : above >> ENG_THICK_CELL_BITS;
}

int64_t eng_thick_cell_of(double t, int depth)
{
    return cell_at((int64_t)(t * (double)(INT64_C(1) << (depth + ENG_THICK_CELL_BITS))));
}

double eng_thick_cell_begin(int64_t cell, int depth)
{
    double number = (double)(cell * (1 << ENG_THICK_CELL_BITS) + ENG_THICK_CELL_OFFSET);
    double t = number / (double)(INT64_C(1) << (depth + ENG_THICK_CELL_BITS));
    return cell < 0 ? 0 : t < 1 ? t : 1;
}

/* The cell of num / 2^k, or of what lies between that and (num + 1) / 2^k if k is at
 * least depth + ENG_THICK_CELL_BITS. */
static int64_t cell_of(struct eng_thick_roots *roots, mpz_srcptr num, unsigned long k,
                       int depth)
{
    unsigned long bits = (unsigned long)depth + ENG_THICK_CELL_BITS;
    mpz_ptr out = roots->cell;
    if (k < bits) {
        mpz_mul_2exp(out, num, bits - k);
    } else {
        mpz_fdiv_q_2exp(out, num, k - bits);
    }
    return cell_at((int64_t)mpz_get_ui(out));
}

/* root = poly, each root once. */
static void set_root(struct eng_thick_roots *roots, struct eng_poly *poly)
{
    eng_poly_shorten(poly);
    if (poly->degree < 2 || eng_residue_is_square_free(poly)) {
        eng_poly_copy(&roots->root, poly);
        return;
    }
    eng_poly_make_primitive(poly);
    for (int i = 1; i <= poly->degree; i++) {
        mpz_mul_ui(roots->slope.c[i - 1], poly->c[i], (unsigned long)i);
    }
    roots->slope.degree = poly->degree - 1;
    eng_divisor_find(&roots->divisor, poly, &roots->slope);
    eng_poly_divide(&roots->root, poly, &roots->divisor.common);
    eng_poly_shorten(&roots->root);
}

/* ---- the sides at a root ----------------------------------------------------------- */

/* Are all sides positive at num / 2^k? */
static bool are_positive_at(struct eng_thick_roots *roots, const struct eng_poly *side,
                            int side_count, mpz_srcptr num, unsigned long k)
{
    for (int i = 0; i < side_count; i++) {
        eng_poly_zoom(&roots->sign, &side[i], num, k);
        if (eng_poly_sign_at_0(&roots->sign) <= 0) {
            return false;
        }
    }
    return true;
}

/* Is a side, that is not zero throughout, 0 at the only root in the interval roots->at,
 * k? */
static bool is_common(struct eng_thick_roots *roots, const struct eng_poly *side,
                      unsigned long k)
{
    int sign;
    if (side->degree < 1 || !eng_residue_may_share_root(&roots->root, side)) {
        return false;
    }
    eng_divisor_find(&roots->divisor, &roots->root, side);
    eng_poly_zoom(&roots->sign, &roots->divisor.common, roots->at, k);
    return eng_poly_variations(&roots->sign, &sign) % 2 == 1;
}

/* What is known of the sides at a root, alone in its interval. */
struct sides {
    const struct eng_poly *side;
    int count;
    bool is_known[ENG_THICK_SIDES]; /* positive throughout the interval */
    bool is_apart[ENG_THICK_SIDES]; /* certainly not 0 at the root */
};

enum sides_are { POSITIVE, OPEN, NOT_POSITIVE };

static enum sides_are look_at_sides(struct eng_thick_roots *roots, struct sides *sides,
                                    unsigned long k, bool asks_for_common)
{
    enum sides_are are = POSITIVE;
    for (int i = 0; i < sides->count; i++) {
        const struct eng_poly *side = &sides->side[i];
        int sign;
        if (sides->is_known[i]) {
            continue;
        }
        if (eng_poly_is_plain(&roots->sign, side, roots->at, k, &sign)) {
            if (sign <= 0) {
                return NOT_POSITIVE;
            }
            sides->is_known[i] = true;
            continue;
        }
        are = OPEN;
        if (asks_for_common && !sides->is_apart[i]) {
            if (is_common(roots, side, k)) {
                return NOT_POSITIVE;
            }
            sides->is_apart[i] = true;
        }
    }
    return are;
}

/* ---- leaps ------------------------------------------------------------------------- */

/* Bisection takes a step a bit. A leap goes to one of 2^stride parts of an interval, if
 * that has as many variations as the interval: then all other parts have no roots
 * (exact_leap.c). */

/* Part number roots->part of 2^stride of the interval num, whose polynomial is
 * roots->base: roots->at names it, and roots->zoomed is of it. */
static void go_to_part(struct eng_thick_roots *roots, mpz_srcptr num,
                       unsigned long stride)
{
    mpz_mul_2exp(roots->at, num, stride);
    mpz_add(roots->at, roots->at, roots->part);
    eng_poly_zoom(&roots->zoomed, &roots->base, roots->part, stride);
}

/* Has that part all variations of the interval? */
static bool leap_to(struct eng_thick_roots *roots, mpz_srcptr num, unsigned long stride,
                    int variations)
{
    int sign;
    go_to_part(roots, num, stride);
    return eng_poly_variations(&roots->zoomed, &sign) == variations;
}

/* From the interval num, whose polynomial is roots->base. */
static bool leap(struct eng_thick_roots *roots, mpz_srcptr num, unsigned long stride,
                 int variations)
{
    if (!eng_poly_guess(roots->part, &roots->base, variations, stride)) {
        mpz_set_ui(roots->part, 0);
    }
    if (leap_to(roots, num, stride, variations)) {
        return true;
    }
    if (mpz_sgn(roots->part) == 0) {
        return false;
    }
    mpz_sub_ui(roots->part, roots->part, 1);
    return leap_to(roots, num, stride, variations);
}

/* What was gone to is the interval at hand. */
static void set_base(struct eng_thick_roots *roots)
{
    eng_poly_copy(&roots->base, &roots->zoomed);
    eng_poly_shorten(&roots->base);
}

static unsigned long longer(unsigned long stride)
{
    return stride < STRIDE_MAX ? 2 * stride : STRIDE_MAX;
}

/* ---- the root of an interval ------------------------------------------------------- */

/* One of both halves of the interval num has the one root: that becomes the part at
 * hand. True: the middle is the root itself. */
static bool halve(struct eng_thick_roots *roots, mpz_srcptr num)
{
    int sign;
    mpz_set_ui(roots->part, 0);
    go_to_part(roots, num, 1);
    if (eng_poly_variations(&roots->zoomed, &sign) % 2 == 1) {
        return false;
    }
    mpz_set_ui(roots->part, 1);
    go_to_part(roots, num, 1);
    return eng_poly_sign_at_0(&roots->zoomed) == 0;
}

/* Are all sides positive at the root that is alone in the interval roots->num, k?
 * roots->zoomed is of that. */
static bool look_at_root(struct eng_thick_roots *roots, const struct eng_poly *side,
                         int side_count, unsigned long k, int depth, int64_t *cell)
{
    struct sides sides = {.side = side, .count = side_count};
    unsigned long stride = STRIDE_MIN;
    mpz_set(roots->at, roots->num);
    for (int turn = 0;; turn++) {
        set_base(roots);
        enum sides_are are = look_at_sides(roots, &sides, k, turn >= TURNS_MAX);
        if (are == NOT_POSITIVE) {
            return false;
        }
        if (are == POSITIVE && k >= (unsigned long)depth + ENG_THICK_CELL_BITS) {
            *cell = cell_of(roots, roots->at, k, depth);
            return true;
        }
        mpz_swap(roots->num, roots->at);
        if (leap(roots, roots->num, stride, 1)) {
            k += stride;
            stride = longer(stride);
            continue;
        }
        stride = STRIDE_MIN;
        k++;
        if (halve(roots, roots->num)) {
            *cell = cell_of(roots, roots->at, k, depth);
            return are_positive_at(roots, side, side_count, roots->at, k);
        }
    }
}

/* ---- roots in order ---------------------------------------------------------------- */

/* The interval roots->at, k, or that root itself, comes before all others. */
static void push(struct eng_thick_roots *roots, unsigned long k, int variations,
                 unsigned alone, unsigned long stride)
{
    assert(roots->pending_count < ENG_THICK_PENDING);
    struct eng_thick_pending *top = &roots->pending[roots->pending_count++];
    mpz_set(top->num, roots->at);
    top->k = k;
    top->variations = variations;
    top->alone = alone;
    top->stride = stride;
}

/* Halvings that leave all roots in one half before a leap is tried. */
#define ALONE_MIN 5u

/* The parts with roots of the interval roots->num, with roots->zoomed its polynomial, are
 * pushed. True: roots->zoomed is of the one on top. */
static bool split(struct eng_thick_roots *roots, const struct eng_thick_pending *whole)
{
    int sign;
    unsigned long k = whole->k;
    set_base(roots);
    if (whole->alone >= ALONE_MIN &&
        leap(roots, roots->num, whole->stride, whole->variations)) {
        push(roots, k + whole->stride, whole->variations, whole->alone,
             longer(whole->stride));
        return true;
    }
    mpz_set_ui(roots->part, 1);
    go_to_part(roots, roots->num, 1);
    int behind = eng_poly_variations(&roots->zoomed, &sign);
    unsigned alone = behind == 0 || behind == whole->variations ? whole->alone + 1 : 0;
    if (behind > 0) {
        push(roots, k + 1, behind, alone, STRIDE_MIN);
    }
    if (eng_poly_sign_at_0(&roots->zoomed) == 0) {
        push(roots, k + 1, 0, 0, STRIDE_MIN);
    }
    mpz_set_ui(roots->part, 0);
    go_to_part(roots, roots->num, 1);
    int before = eng_poly_variations(&roots->zoomed, &sign);
    if (before > 0) {
        push(roots, k + 1, before, alone, STRIDE_MIN);
    }
    return before > 0;
}

/* The ends and the inside of [0, 1]. 0 itself is no time that is looked for. */
static void push_all(struct eng_thick_roots *roots)
{
    int sign;
    roots->pending_count = 0;
    mpz_set_ui(roots->at, 1);
    if (eng_poly_sign_at_1(&roots->root) == 0) {
        push(roots, 0, 0, 0, STRIDE_MIN);
    }
    int variations = eng_poly_variations(&roots->root, &sign);
    mpz_set_ui(roots->at, 0);
    if (variations > 0) {
        push(roots, 0, variations, 0, STRIDE_MIN);
    }
}

/* Is there a root in (0, 1] with positive sides, whose cell is not after `last`? *cell:
 * that of the first. */
static bool first_root(struct eng_thick_roots *roots, const struct eng_poly *side,
                       int side_count, int depth, int64_t last, int64_t *cell)
{
    bool is_zoomed = false;
    push_all(roots);
    while (roots->pending_count > 0) {
        struct eng_thick_pending *top = &roots->pending[--roots->pending_count];
        const struct eng_thick_pending whole = {.k = top->k,
                                                .variations = top->variations,
                                                .alone = top->alone,
                                                .stride = top->stride};
        mpz_swap(roots->num, top->num);
        *cell = cell_of(roots, roots->num, whole.k, depth);
        if (*cell > last) {
            return false;
        }
        if (!is_zoomed) {
            eng_poly_zoom(&roots->zoomed, &roots->root, roots->num, whole.k);
        }
        is_zoomed = false;
        if (whole.variations > 1) {
            is_zoomed = split(roots, &whole);
        } else if (whole.variations == 1
                       ? look_at_root(roots, side, side_count, whole.k, depth, cell)
                       : are_positive_at(roots, side, side_count, roots->num, whole.k)) {
            return *cell <= last;
        }
    }
    return false;
}

bool eng_thick_first_root(struct eng_thick_roots *roots, struct eng_poly *poly,
                          const struct eng_poly *side, int side_count, int depth,
                          int64_t *cell)
{
    int64_t own = 0;
    assert(side_count <= ENG_THICK_SIDES && poly->degree >= 0);
    set_root(roots, poly);
    if (!first_root(roots, side, side_count, depth, *cell, &own)) {
        return false;
    }
    *cell = own;
    return true;
}
