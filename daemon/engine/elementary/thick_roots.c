/* thick_roots.c - roots at which other polynomials are positive.
 *
 * See thick_exact.h. Where a root is alone, its interval is made shorter until no side
 * has a root beside it. A side that is 0 at the root is known by a common divisor, which
 * is looked for when that does not end soon.
 */
#include "thick_exact.h"

#include <assert.h>

#include "poly.h"

/* Turns beside a side's root before a common divisor is looked for. */
#define TURNS_MAX 6

/* BOUNDS.md, "How long numbers become". */
#define ROOT_BITS   (ENG_THICK_POLY_BITS + 16ul) /* the polynomial, each root once */
#define DEPTH_MAX   (86310ul + ENG_ISOLATE_STRIDE_MAX) /* of an interval */
#define ZOOMED_BITS (ROOT_BITS + 6 * DEPTH_MAX + 32)

static void place(struct eng_poly *poly, struct eng_limbs *limbs, int terms, size_t bits)
{
    const struct eng_poly_size size = {terms, bits, terms, bits};
    eng_poly_allocate(poly, limbs, &size);
}

void eng_thick_roots_allocate(struct eng_thick_roots *roots, struct eng_limbs *limbs)
{
    const struct eng_poly_size size = {7, ROOT_BITS, 7, ROOT_BITS};
    eng_isolate_allocate(&roots->isolator, limbs, &size, ZOOMED_BITS, DEPTH_MAX);
    place(&roots->slope, limbs, 6, ROOT_BITS);
    place(&roots->sign, limbs, 7, ZOOMED_BITS);
    eng_divisor_allocate(&roots->divisor, limbs);
    eng_limbs_give(limbs, roots->cell, DEPTH_MAX + 64);
}

/* ---- cells ------------------------------------------------------------------------- */

/* Return the cell of a time `number` / 2^(depth + ENG_THICK_CELL_BITS). */
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

/* The cell of the left end of the interval at hand; or of what lies in it, if k is at
 * least depth + ENG_THICK_CELL_BITS. */
static int64_t cell_at_hand(struct eng_thick_roots *roots, int depth)
{
    const struct eng_isolator *isolator = &roots->isolator;
    unsigned long bits = (unsigned long)depth + ENG_THICK_CELL_BITS;
    mpz_ptr out = roots->cell;
    if (isolator->k < bits) {
        mpz_mul_2exp(out, isolator->num, bits - isolator->k);
    } else {
        mpz_fdiv_q_2exp(out, isolator->num, isolator->k - bits);
    }
    return cell_at((int64_t)mpz_get_ui(out));
}

/* root = poly, each root once. */
static void set_root(struct eng_thick_roots *roots, struct eng_poly *poly)
{
    struct eng_poly *root = &roots->isolator.root;
    eng_poly_shorten(poly);
    if (poly->degree < 2 || eng_residue_is_square_free(poly)) {
        eng_poly_copy(root, poly);
        return;
    }
    eng_poly_make_primitive(poly);
    for (int i = 1; i <= poly->degree; i++) {
        mpz_mul_ui(roots->slope.c[i - 1], poly->c[i], (unsigned long)i);
    }
    roots->slope.degree = poly->degree - 1;
    eng_divisor_find(&roots->divisor, poly, &roots->slope);
    eng_poly_divide(root, poly, &roots->divisor.common);
    eng_poly_shorten(root);
}

/* ---- the sides at a root ----------------------------------------------------------- */

/* Return whether all sides are positive at the left end of the interval at hand. */
static bool are_positive_at_left(struct eng_thick_roots *roots,
                                 const struct eng_poly *side, int side_count)
{
    const struct eng_isolator *isolator = &roots->isolator;
    for (int i = 0; i < side_count; i++) {
        eng_poly_zoom(&roots->sign, &side[i], isolator->num, isolator->k);
        if (eng_poly_sign_at_0(&roots->sign) <= 0) {
            return false;
        }
    }
    return true;
}

/* Return whether a side, that is not zero throughout, is 0 at the only root in the
 * interval at hand. */
static bool is_common(struct eng_thick_roots *roots, const struct eng_poly *side)
{
    const struct eng_isolator *isolator = &roots->isolator;
    int sign;
    if (side->degree < 1 || !eng_residue_may_share_root(&isolator->root, side)) {
        return false;
    }
    eng_divisor_find(&roots->divisor, &isolator->root, side);
    eng_poly_zoom(&roots->sign, &roots->divisor.common, isolator->num, isolator->k);
    return eng_poly_variations(&roots->sign, &sign) % 2 == 1;
}

/* The signs of the sides at a root, alone in its interval. */
struct sides {
    const struct eng_poly *side;
    int count;
    bool is_known[ENG_THICK_SIDES]; /* positive throughout the interval */
    bool is_apart[ENG_THICK_SIDES]; /* certainly not 0 at the root */
};

enum sides_are { POSITIVE, OPEN, NOT_POSITIVE };

static enum sides_are look_at_sides(struct eng_thick_roots *roots, struct sides *sides,
                                    bool asks_for_common)
{
    struct eng_isolator *isolator = &roots->isolator;
    enum sides_are are = POSITIVE;
    for (int i = 0; i < sides->count; i++) {
        const struct eng_poly *side = &sides->side[i];
        int sign;
        if (sides->is_known[i]) {
            continue;
        }
        if (eng_poly_is_plain(&roots->sign, side, isolator->num, isolator->k, &sign)) {
            if (sign <= 0) {
                return NOT_POSITIVE;
            }
            sides->is_known[i] = true;
            continue;
        }
        are = OPEN;
        if (asks_for_common && !sides->is_apart[i]) {
            if (is_common(roots, side)) {
                return NOT_POSITIVE;
            }
            sides->is_apart[i] = true;
        }
    }
    return are;
}

/* ---- roots ------------------------------------------------------------------------- */

/* Return whether all sides are positive at the root that is alone in the interval at
 * hand. */
static bool look_at_root(struct eng_thick_roots *roots, const struct eng_poly *side,
                         int side_count, int depth, int64_t *cell)
{
    struct eng_isolator *isolator = &roots->isolator;
    struct sides sides = {.side = side, .count = side_count};
    for (int turn = 0;; turn++) {
        enum sides_are are = look_at_sides(roots, &sides, turn >= TURNS_MAX);
        if (are == NOT_POSITIVE) {
            return false;
        }
        if (are == POSITIVE &&
            isolator->k >= (unsigned long)depth + ENG_THICK_CELL_BITS) {
            *cell = cell_at_hand(roots, depth);
            return true;
        }
        if (!eng_isolate_narrow(isolator, ENG_ISOLATE_STRIDE_MAX)) {
            *cell = cell_at_hand(roots, depth);
            return are_positive_at_left(roots, side, side_count);
        }
    }
}

bool eng_thick_first_root(struct eng_thick_roots *roots, struct eng_poly *poly,
                          const struct eng_poly *side, int side_count, int depth,
                          int64_t *cell)
{
    struct eng_isolator *isolator = &roots->isolator;
    assert(side_count <= ENG_THICK_SIDES && poly->degree >= 0);
    set_root(roots, poly);
    eng_isolate_begin(isolator);
    while (eng_isolate_next(isolator)) {
        int64_t own = cell_at_hand(roots, depth);
        bool is_0 = isolator->variations == 0 && mpz_sgn(isolator->num) == 0;
        if (own > *cell) {
            return false;
        }
        if (isolator->variations > 1) {
            eng_isolate_split(isolator);
        } else if (!is_0 && (isolator->variations == 1
                                 ? look_at_root(roots, side, side_count, depth, &own)
                                 : are_positive_at_left(roots, side, side_count))) {
            if (own > *cell) {
                return false;
            }
            *cell = own;
            return true;
        }
    }
    return false;
}
