/* daemon/engine/elementary/thick_roots.c - roots at which other polynomials are positive.
 *
 * Room:     engine.
 * Does:     see thick_roots.h. Bisection and Descartes' rule of signs, first on the
 *           polynomial until a root is alone, then until no side has a root beside it. A
 *           side that is 0 at the root is known by a common divisor, which is looked for
 *           when bisection does not end soon.
 * Threads:  one thread for one struct eng_thick_roots.
 *
 * An interval [num, num + 1] / 2^k is named by num and k.
 */
#include "thick_roots.h"

#include <assert.h>
#include <math.h>

#include "residue.h"

/* Turns beside a side's root before a common divisor is looked for. */
#define TURNS_MAX 6

void eng_thick_roots_place(struct eng_thick_roots *roots, struct eng_limbs *limbs)
{
    const struct eng_poly_size size = {7, ENG_THICK_BITS, 7, ENG_THICK_BITS};
    eng_poly_place(&roots->root, limbs, &size);
    eng_poly_place(&roots->zoomed, limbs, &size);
    eng_poly_place(&roots->base, limbs, &size);
    eng_poly_place(&roots->sign, limbs, &size);
    eng_poly_place(&roots->divisor, limbs, &size);
    eng_poly_place(&roots->scratch, limbs, &size);
    eng_limbs_give(limbs, roots->num, ENG_THICK_BITS);
    eng_limbs_give(limbs, roots->at, ENG_THICK_BITS);
    eng_limbs_give(limbs, roots->part, ENG_THICK_BITS);
    for (int i = 0; i < ENG_THICK_PENDING; i++) {
        eng_limbs_give(limbs, roots->pending[i].num, ENG_THICK_BITS);
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
    mpz_ptr out = roots->scratch.scratch[0];
    if (k < bits) {
        mpz_mul_2exp(out, num, bits - k);
    } else {
        mpz_fdiv_q_2exp(out, num, k - bits);
    }
    return cell_at((int64_t)mpz_get_ui(out));
}

/* ---- bounded arithmetic ------------------------------------------------------------ */

static size_t bits_of(const struct eng_poly *poly)
{
    size_t most = 0;
    for (int i = 0; i <= poly->degree; i++) {
        size_t own = mpz_sizeinbase(poly->c[i], 2);
        most = own > most ? own : most;
    }
    return most;
}

/* Is there room for numbers of this many bits? */
static bool has_room(const struct eng_thick_roots *roots, size_t bits)
{
    return bits < ENG_THICK_BITS && roots->work < ENG_THICK_WORK;
}

/* out = a over the interval. False: too long. */
static bool zoom(struct eng_thick_roots *roots, struct eng_poly *out,
                 const struct eng_poly *a, mpz_srcptr num, unsigned long k)
{
    unsigned long degree = a->degree < 0 ? 0 : (unsigned long)a->degree;
    size_t bits = bits_of(a) + degree * (k + 2) + 8;
    roots->work += (degree + 1) * (degree + 1) * (bits / GMP_NUMB_BITS + 8) *
                   (k / GMP_NUMB_BITS + 1);
    if (!has_room(roots, bits)) {
        return false;
    }
    eng_poly_zoom(out, a, num, k);
    return true;
}

/* divisor = the primitive greatest common divisor of a and b, which are used up. The
 * numbers on the way are subresultants, of at most 11 coefficients each, and before they
 * are divided some products of these. */
static bool set_divisor(struct eng_thick_roots *roots, struct eng_poly *a,
                        struct eng_poly *b)
{
    size_t bits_a = bits_of(a);
    size_t bits_b = bits_of(b);
    size_t bits = 40 * ((bits_a > bits_b ? bits_a : bits_b) + 8);
    uint64_t limbs = bits / (4 * GMP_NUMB_BITS) + 1;
    roots->work += 40 * limbs * limbs;
    if (!has_room(roots, bits)) {
        return false;
    }
    eng_poly_gcd(&roots->divisor, a, b);
    eng_poly_make_primitive(&roots->divisor);
    return true;
}

/* root = poly, each root once. */
static bool set_root(struct eng_thick_roots *roots, struct eng_poly *poly)
{
    eng_poly_shorten(poly);
    if (poly->degree < 2 || eng_residue_is_square_free(poly)) {
        eng_poly_copy(&roots->root, poly);
        return true;
    }
    if (bits_of(poly) + 8 >= ENG_THICK_BITS) {
        return false;
    }
    eng_poly_make_primitive(poly);
    eng_poly_copy(&roots->scratch, poly);
    for (int i = 1; i <= poly->degree; i++) {
        mpz_mul_ui(roots->sign.c[i - 1], poly->c[i], (unsigned long)i);
    }
    roots->sign.degree = poly->degree - 1;
    if (!set_divisor(roots, &roots->scratch, &roots->sign)) {
        return false;
    }
    eng_poly_divide(&roots->root, poly, &roots->divisor);
    eng_poly_shorten(&roots->root);
    return true;
}

/* ---- the sides at a root ----------------------------------------------------------- */

/* Are all sides positive at num / 2^k? */
static enum eng_thick_found look_at_point(struct eng_thick_roots *roots,
                                          const struct eng_poly *side, int side_count,
                                          mpz_srcptr num, unsigned long k)
{
    for (int i = 0; i < side_count; i++) {
        if (!zoom(roots, &roots->sign, &side[i], num, k)) {
            return ENG_THICK_GIVEN_UP;
        }
        if (eng_poly_sign_at_0(&roots->sign) <= 0) {
            return ENG_THICK_NONE;
        }
    }
    return ENG_THICK_FOUND;
}

/* Is a side 0 at the only root in the interval roots->at, k? */
static enum eng_thick_found is_common(struct eng_thick_roots *roots,
                                      const struct eng_poly *side, unsigned long k)
{
    int sign;
    if (side->degree >= 1 && !eng_residue_may_share_root(&roots->root, side)) {
        return ENG_THICK_NONE;
    }
    if (side->degree < 1) {
        return side->degree < 0 ? ENG_THICK_FOUND : ENG_THICK_NONE;
    }
    if (bits_of(&roots->root) >= ENG_THICK_BITS || bits_of(side) >= ENG_THICK_BITS) {
        return ENG_THICK_GIVEN_UP;
    }
    eng_poly_copy(&roots->scratch, &roots->root);
    eng_poly_copy(&roots->sign, side);
    if (!set_divisor(roots, &roots->scratch, &roots->sign) ||
        !zoom(roots, &roots->sign, &roots->divisor, roots->at, k)) {
        return ENG_THICK_GIVEN_UP;
    }
    return eng_poly_variations(&roots->sign, &sign) % 2 == 1 ? ENG_THICK_FOUND
                                                             : ENG_THICK_NONE;
}

/* What is known of the sides at a root, alone in its interval. */
struct sides {
    const struct eng_poly *side;
    int count;
    bool is_known[ENG_THICK_SIDES]; /* positive throughout the interval */
    bool is_apart[ENG_THICK_SIDES]; /* certainly not 0 at the root */
};

/* NONE: some side is not positive. FOUND: nothing speaks against it. *is_open: but some
 * sides are not known yet. */
static enum eng_thick_found look_at_sides(struct eng_thick_roots *roots,
                                          struct sides *sides, unsigned long k,
                                          bool asks_for_common, bool *is_open)
{
    *is_open = false;
    for (int i = 0; i < sides->count; i++) {
        int sign;
        if (sides->is_known[i]) {
            continue;
        }
        if (!zoom(roots, &roots->sign, &sides->side[i], roots->at, k)) {
            return ENG_THICK_GIVEN_UP;
        }
        if (eng_poly_variations(&roots->sign, &sign) == 0) {
            if (sign <= 0) {
                return ENG_THICK_NONE;
            }
            sides->is_known[i] = true;
            continue;
        }
        *is_open = true;
        if (asks_for_common && !sides->is_apart[i]) {
            enum eng_thick_found common = is_common(roots, &sides->side[i], k);
            if (common != ENG_THICK_NONE) {
                return common == ENG_THICK_FOUND ? ENG_THICK_NONE : common;
            }
            sides->is_apart[i] = true;
        }
    }
    return ENG_THICK_FOUND;
}

/* ---- leaps ------------------------------------------------------------------------- */

/* Bisection takes a step a bit. A leap goes to one of 2^stride parts of an interval, if
 * that has as many variations as the interval: then all other parts have no roots
 * (exact_roots.c). */

#define STRIDE_MIN 4ul
#define STRIDE_MAX 512ul

/* Part number roots->part of 2^stride of the interval num, whose polynomial is
 * roots->base: roots->at names it, and roots->zoomed is of it. False: too long. */
static bool go_to_part(struct eng_thick_roots *roots, mpz_srcptr num,
                       unsigned long stride)
{
    mpz_mul_2exp(roots->at, num, stride);
    mpz_add(roots->at, roots->at, roots->part);
    return zoom(roots, &roots->zoomed, &roots->base, roots->part, stride);
}

/* Has that part all variations of the interval? */
static enum eng_thick_found leap_to(struct eng_thick_roots *roots, mpz_srcptr num,
                                    unsigned long stride, int variations)
{
    int sign;
    if (!go_to_part(roots, num, stride)) {
        return ENG_THICK_GIVEN_UP;
    }
    return eng_poly_variations(&roots->zoomed, &sign) != variations ? ENG_THICK_NONE
                                                                    : ENG_THICK_FOUND;
}

/* From the interval num, k, whose polynomial is roots->base. */
static enum eng_thick_found leap(struct eng_thick_roots *roots, mpz_srcptr num,
                                 unsigned long k, unsigned long stride, int variations)
{
    if (!has_room(roots, k + stride + 8) ||
        !has_room(roots, bits_of(&roots->base) + stride + 16)) {
        return ENG_THICK_GIVEN_UP;
    }
    if (variations > 3 ||
        !eng_poly_guess(roots->part, &roots->base, variations, stride)) {
        mpz_set_ui(roots->part, 0);
    }
    enum eng_thick_found found = leap_to(roots, num, stride, variations);
    if (found == ENG_THICK_NONE && mpz_sgn(roots->part) != 0) {
        mpz_sub_ui(roots->part, roots->part, 1);
        found = leap_to(roots, num, stride, variations);
    }
    return found;
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
 * hand, or the root itself, if it is the middle: *is_point. */
static bool halve(struct eng_thick_roots *roots, mpz_srcptr num, bool *is_point)
{
    int sign;
    *is_point = false;
    mpz_set_ui(roots->part, 0);
    if (!go_to_part(roots, num, 1)) {
        return false;
    }
    if (eng_poly_variations(&roots->zoomed, &sign) % 2 == 1) {
        return true;
    }
    mpz_set_ui(roots->part, 1);
    if (!go_to_part(roots, num, 1)) {
        return false;
    }
    *is_point = eng_poly_sign_at_0(&roots->zoomed) == 0;
    return true;
}

/* The root, which is alone in the interval roots->num, k; roots->zoomed is of that. */
static enum eng_thick_found look_at_root(struct eng_thick_roots *roots,
                                         const struct eng_poly *side, int side_count,
                                         unsigned long k, int depth, int64_t *cell)
{
    struct sides sides = {.side = side, .count = side_count};
    unsigned long stride = STRIDE_MIN;
    mpz_set(roots->at, roots->num);
    for (int turn = 0;; turn++) {
        bool is_open;
        bool is_point = false;
        set_base(roots);
        enum eng_thick_found found =
            look_at_sides(roots, &sides, k, turn >= TURNS_MAX, &is_open);
        if (found != ENG_THICK_FOUND) {
            return found;
        }
        if (!is_open && k >= (unsigned long)depth + ENG_THICK_CELL_BITS) {
            *cell = cell_of(roots, roots->at, k, depth);
            return ENG_THICK_FOUND;
        }
        mpz_swap(roots->num, roots->at);
        found = leap(roots, roots->num, k, stride, 1);
        if (found == ENG_THICK_FOUND) {
            k += stride;
            stride = longer(stride);
            continue;
        }
        stride = STRIDE_MIN;
        if (found == ENG_THICK_GIVEN_UP || !halve(roots, roots->num, &is_point)) {
            return ENG_THICK_GIVEN_UP;
        }
        k++;
        if (is_point) {
            *cell = cell_of(roots, roots->at, k, depth);
            return look_at_point(roots, side, side_count, roots->at, k);
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
 * pushed. *is_zoomed: roots->zoomed is of the one on top. */
static bool split(struct eng_thick_roots *roots, const struct eng_thick_pending *whole,
                  bool *is_zoomed)
{
    int sign;
    unsigned long k = whole->k;
    unsigned long stride = STRIDE_MIN;
    *is_zoomed = true;
    set_base(roots);
    if (whole->alone >= ALONE_MIN) {
        enum eng_thick_found found =
            leap(roots, roots->num, k, whole->stride, whole->variations);
        if (found == ENG_THICK_FOUND) {
            push(roots, k + whole->stride, whole->variations, whole->alone,
                 longer(whole->stride));
            return true;
        }
        if (found == ENG_THICK_GIVEN_UP) {
            return false;
        }
    }
    mpz_set_ui(roots->part, 1);
    if (!go_to_part(roots, roots->num, 1)) {
        return false;
    }
    int behind = eng_poly_variations(&roots->zoomed, &sign);
    unsigned alone = behind == 0 || behind == whole->variations ? whole->alone + 1 : 0;
    if (behind > 0) {
        push(roots, k + 1, behind, alone, stride);
    }
    if (eng_poly_sign_at_0(&roots->zoomed) == 0) {
        push(roots, k + 1, 0, 0, stride);
    }
    mpz_set_ui(roots->part, 0);
    if (!go_to_part(roots, roots->num, 1)) {
        return false;
    }
    int before = eng_poly_variations(&roots->zoomed, &sign);
    if (before > 0) {
        push(roots, k + 1, before, alone, stride);
    }
    *is_zoomed = before > 0;
    return true;
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

/* The first root in (0, 1] with positive sides, if its cell is not after `last`. */
static enum eng_thick_found first_root(struct eng_thick_roots *roots,
                                       const struct eng_poly *side, int side_count,
                                       int depth, int64_t last, int64_t *cell)
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
            return ENG_THICK_NONE;
        }
        if (!is_zoomed &&
            !zoom(roots, &roots->zoomed, &roots->root, roots->num, whole.k)) {
            return ENG_THICK_GIVEN_UP;
        }
        is_zoomed = false;
        enum eng_thick_found found = ENG_THICK_NONE;
        if (whole.variations == 0) {
            found = look_at_point(roots, side, side_count, roots->num, whole.k);
        } else if (whole.variations == 1) {
            found = look_at_root(roots, side, side_count, whole.k, depth, cell);
        } else if (!split(roots, &whole, &is_zoomed)) {
            found = ENG_THICK_GIVEN_UP;
        }
        if (found != ENG_THICK_NONE) {
            return found;
        }
    }
    return ENG_THICK_NONE;
}

enum eng_thick_found eng_thick_first_root(struct eng_thick_roots *roots,
                                          struct eng_poly *poly,
                                          const struct eng_poly *side, int side_count,
                                          int depth, int64_t *cell)
{
    assert(side_count <= ENG_THICK_SIDES && poly->degree >= 0);
    int64_t own = 0;
    if (!set_root(roots, poly)) {
        return ENG_THICK_GIVEN_UP;
    }
    enum eng_thick_found found = first_root(roots, side, side_count, depth, *cell, &own);
    if (found == ENG_THICK_FOUND && own > *cell) {
        return ENG_THICK_NONE;
    }
    *cell = found == ENG_THICK_FOUND ? own : *cell;
    return found;
}
