/* residue.c - polynomials modulo a prime. */
#include "poly.h"

#define PRIME ((UINT64_C(1) << 61) - 1)

__extension__ typedef unsigned __int128 wide;

/* Coefficients below PRIME; degree -1: zero. */
struct residue {
    int degree;
    uint64_t c[ENG_POLY_TERMS];
};

static uint64_t add(uint64_t a, uint64_t b)
{
    uint64_t sum = a + b;
    return sum >= PRIME ? sum - PRIME : sum;
}

static uint64_t sub(uint64_t a, uint64_t b)
{
    return a >= b ? a - b : a + (PRIME - b);
}

/* 2^61 is 1. */
static uint64_t mul(uint64_t a, uint64_t b)
{
    wide product = (wide)a * b;
    return add((uint64_t)product & PRIME, (uint64_t)(product >> 61));
}

static void trim(struct residue *poly)
{
    while (poly->degree >= 0 && poly->c[poly->degree] == 0) {
        poly->degree--;
    }
}

static struct residue residue_of(const struct eng_poly *poly)
{
    struct residue out = {.degree = poly->degree};
    for (int i = 0; i <= poly->degree; i++) {
        out.c[i] = mpz_fdiv_ui(poly->c[i], PRIME);
    }
    trim(&out);
    return out;
}

/* The greatest common divisor, up to a factor; zero if both are. */
static struct residue divisor_of(struct residue a, struct residue b)
{
    while (a.degree >= 0 && b.degree >= 0) {
        struct residue *high = a.degree >= b.degree ? &a : &b;
        const struct residue *low = a.degree >= b.degree ? &b : &a;
        int shift = high->degree - low->degree;
        uint64_t lead = high->c[high->degree];
        for (int i = 0; i <= high->degree; i++) {
            high->c[i] = mul(high->c[i], low->c[low->degree]);
        }
        for (int i = 0; i <= low->degree; i++) {
            high->c[i + shift] = sub(high->c[i + shift], mul(lead, low->c[i]));
        }
        trim(high);
    }
    return a.degree >= 0 ? a : b;
}

bool eng_residue_is_square_free(const struct eng_poly *poly)
{
    struct residue a = residue_of(poly);
    struct residue slope = {.degree = a.degree - 1};
    for (int i = 1; i <= a.degree; i++) {
        slope.c[i - 1] = mul(a.c[i], (uint64_t)i);
    }
    trim(&slope);
    return a.degree == poly->degree && divisor_of(a, slope).degree == 0;
}

bool eng_residue_may_share_root(const struct eng_poly *a, const struct eng_poly *b)
{
    struct residue one = residue_of(a);
    struct residue other = residue_of(b);
    bool keeps_degree = one.degree == a->degree || other.degree == b->degree;
    return !keeps_degree || divisor_of(one, other).degree != 0;
}

/* ---- a point and a line ------------------------------------------------------------ */

void eng_residue_load(struct eng_residue_points *points, mpz_t x[2][4][3])
{
    for (int i = 0; i < 24; i++) {
        points->x[i / 12][i / 3 % 4][i % 3] =
            mpz_fdiv_ui(x[i / 12][i / 3 % 4][i % 3], PRIME);
    }
}

/* Point i - point j along an axis: c[0] + c[1] t. */
static void difference(const struct eng_residue_points *points, int i, int j, int axis,
                       uint64_t c[2])
{
    c[0] = sub(points->x[0][i][axis], points->x[0][j][axis]);
    c[1] = sub(sub(points->x[1][i][axis], points->x[1][j][axis]), c[0]);
}

/* A coordinate of the cross product of two differences, as a quadratic. */
static struct residue coordinate(uint64_t a[3][2], uint64_t b[3][2], int axis)
{
    const uint64_t *a1 = a[(axis + 1) % 3];
    const uint64_t *a2 = a[(axis + 2) % 3];
    const uint64_t *b1 = b[(axis + 1) % 3];
    const uint64_t *b2 = b[(axis + 2) % 3];
    struct residue out = {.degree = 2};
    out.c[0] = sub(mul(a1[0], b2[0]), mul(a2[0], b1[0]));
    out.c[1] = sub(add(mul(a1[0], b2[1]), mul(a1[1], b2[0])),
                   add(mul(a2[0], b1[1]), mul(a2[1], b1[0])));
    out.c[2] = sub(mul(a1[1], b2[1]), mul(a2[1], b1[1]));
    return out;
}

/* Return whether points i and j move by the same, exactly. */
static bool move_alike(mpz_t x[2][4][3], mpz_t *scratch, int i, int j)
{
    for (int axis = 0; axis < 3; axis++) {
        mpz_add(scratch[0], x[1][i][axis], x[0][j][axis]);
        mpz_add(scratch[1], x[1][j][axis], x[0][i][axis]);
        if (mpz_cmp(scratch[0], scratch[1]) != 0) {
            return false;
        }
    }
    return true;
}

/* The three coordinates of (i - j) x (i - k) are quadratics in time: linear if j and k
 * move alike, and numbers if i does, too. That decides which of their coefficients is the
 * leading one, that the prime may not divide. */
bool eng_residue_misses_line(const struct eng_residue_points *points, mpz_t x[2][4][3],
                             mpz_t *scratch, int i, int j, int k)
{
    uint64_t a[3][2];
    uint64_t b[3][2];
    struct residue common = {.degree = -1};
    int degree = 0; /* that one of the coordinates keeps */
    for (int axis = 0; axis < 3; axis++) {
        difference(points, i, j, axis, a[axis]);
        difference(points, i, k, axis, b[axis]);
    }
    for (int axis = 0; axis < 3; axis++) {
        struct residue m = coordinate(a, b, axis);
        trim(&m);
        degree = m.degree > degree ? m.degree : degree;
        common = divisor_of(common, m);
    }
    if (common.degree != 0) {
        return false;
    }
    return degree == 2 || (move_alike(x, scratch, j, k) &&
                           (degree == 1 || move_alike(x, scratch, i, j)));
}
