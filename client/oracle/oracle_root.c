/* oracle_root.c - real algebraic numbers in [0, 1]. */
#include "oracle_root.h"

#include <assert.h>
#include <math.h>

/* Bisections before it is asked whether the sign is zero: narrowing is the cheaper way to
 * settle a sign that is not. */
#define NARROW_FIRST 20

void root_init(struct root *root)
{
    poly_init(&root->g);
    mpz_init(root->a);
    root->n = 0;
    root->is_exact = true;
}

void root_clear(struct root *root)
{
    poly_clear(&root->g);
    mpz_clear(root->a);
}

void root_set(struct root *root, const struct root *other)
{
    poly_set(&root->g, &other->g);
    mpz_set(root->a, other->a);
    root->n = other->n;
    root->is_exact = other->is_exact;
}

void root_set_end(struct root *root, int t)
{
    mpz_set_si(root->a, t);
    root->n = 0;
    root->is_exact = true;
}

/* A stack of what is left to look at, the leftmost on top. Pending intervals have at
 * least one variation each, together at most the degree, and pending points are roots. */
struct pending {
    struct root at[2 * POLY_DEGREE_MAX + 2];
    int count;
};

static void push(struct pending *pending, const mpz_t a, unsigned n, bool is_exact)
{
    struct root *top = &pending->at[pending->count++];
    assert(pending->count <= 2 * POLY_DEGREE_MAX + 2);
    mpz_set(top->a, a);
    top->n = n;
    top->is_exact = is_exact;
}

/* Push the right half, the middle and the left half of an interval, where roots may
 * be. */
static void push_halves(struct pending *pending, const struct poly *g, const mpz_t a,
                        unsigned n)
{
    int sign;
    mpz_t half;
    mpz_init(half);
    mpz_mul_2exp(half, a, 1);
    mpz_add_ui(half, half, 1);
    if (poly_variations(g, half, n + 1, &sign) > 0) {
        push(pending, half, n + 1, false);
    }
    if (poly_sign_at(g, half, n + 1) == 0) {
        push(pending, half, n + 1, true);
    }
    mpz_sub_ui(half, half, 1);
    if (poly_variations(g, half, n + 1, &sign) > 0) {
        push(pending, half, n + 1, false);
    }
    mpz_clear(half);
}

int root_isolate(const struct poly *f, struct root roots[POLY_DEGREE_MAX])
{
    struct pending pending = {.count = 0};
    struct poly g;
    mpz_t a;
    int count = 0;
    int sign;
    poly_init(&g);
    mpz_init(a);
    for (int i = 0; i < 2 * POLY_DEGREE_MAX + 2; i++) {
        root_init(&pending.at[i]);
    }
    poly_square_free(&g, f);
    mpz_set_ui(a, 1);
    if (poly_sign_at(&g, a, 0) == 0) {
        push(&pending, a, 0, true);
    }
    mpz_set_ui(a, 0);
    if (poly_variations(&g, a, 0, &sign) > 0) {
        push(&pending, a, 0, false);
    }
    if (poly_sign_at(&g, a, 0) == 0) {
        push(&pending, a, 0, true);
    }
    while (pending.count > 0) {
        const struct root *top = &pending.at[--pending.count];
        unsigned n = top->n;
        if (top->is_exact || poly_variations(&g, top->a, n, &sign) == 1) {
            assert(count < POLY_DEGREE_MAX);
            root_set(&roots[count], top);
            poly_set(&roots[count++].g, &g);
        } else {
            mpz_set(a, top->a);
            push_halves(&pending, &g, a, n);
        }
    }
    for (int i = 0; i < 2 * POLY_DEGREE_MAX + 2; i++) {
        root_clear(&pending.at[i]);
    }
    poly_clear(&g);
    mpz_clear(a);
    return count;
}

void root_narrow(struct root *root)
{
    if (root->is_exact) {
        return;
    }
    int sign;
    mpz_mul_2exp(root->a, root->a, 1);
    root->n++;
    /* One simple root in the interval: an odd number of variations on its half only. */
    if (poly_variations(&root->g, root->a, root->n, &sign) % 2 == 1) {
        return;
    }
    mpz_add_ui(root->a, root->a, 1);
    root->is_exact = poly_sign_at(&root->g, root->a, root->n) == 0;
}

/* Return whether s and g share the root. Their common divisor has at most one root in the
 * interval. */
static bool is_shared(const struct root *root, const struct poly *s)
{
    struct poly common;
    int sign;
    bool shared = false;
    poly_init(&common);
    poly_gcd(&common, &root->g, s);
    if (common.degree > 0) {
        shared = poly_variations(&common, root->a, root->n, &sign) % 2 == 1;
    }
    poly_clear(&common);
    return shared;
}

int root_sign(struct root *root, const struct poly *s)
{
    for (int turn = 0; !root->is_exact; turn++) {
        int sign;
        if (poly_variations(s, root->a, root->n, &sign) == 0) {
            return sign;
        }
        if (turn == NARROW_FIRST && is_shared(root, s)) {
            return 0;
        }
        root_narrow(root);
    }
    return poly_sign_at(s, root->a, root->n);
}

int root_compare(struct root *root, double t)
{
    int exponent;
    int sign;
    double mantissa = frexp(t, &exponent);
    struct poly s;
    poly_init(&s);
    exponent -= 53;
    /* 2^-exponent x - mantissa, or x - mantissa 2^exponent: increasing in x. */
    mpz_set_d(s.c[0], -ldexp(mantissa, 53));
    mpz_set_ui(s.c[1], 1);
    mpz_mul_2exp(s.c[exponent < 0], s.c[exponent < 0],
                 (mp_bitcnt_t)(exponent < 0 ? -exponent : exponent));
    poly_trim(&s, 1);
    sign = root_sign(root, &s);
    poly_clear(&s);
    return sign;
}
