/* oracle_poly.c - polynomials in t with integer coefficients, without rounding. */
#include "oracle_root.h"

#include <assert.h>

void poly_init(struct poly *p)
{
    for (int i = 0; i <= POLY_DEGREE_MAX; i++) {
        mpz_init(p->c[i]);
    }
    p->degree = -1;
}

void poly_clear(struct poly *p)
{
    for (int i = 0; i <= POLY_DEGREE_MAX; i++) {
        mpz_clear(p->c[i]);
    }
}

void poly_set(struct poly *p, const struct poly *q)
{
    for (int i = 0; i <= q->degree; i++) {
        mpz_set(p->c[i], q->c[i]);
    }
    p->degree = q->degree;
}

void poly_trim(struct poly *p, int degree)
{
    while (degree >= 0 && mpz_sgn(p->c[degree]) == 0) {
        degree--;
    }
    p->degree = degree;
}

void poly_add(struct poly *r, const struct poly *a, const struct poly *b)
{
    int low = a->degree < b->degree ? a->degree : b->degree;
    const struct poly *longer = a->degree < b->degree ? b : a;
    int high = longer->degree;
    for (int i = 0; i <= high; i++) {
        if (i <= low) {
            mpz_add(r->c[i], a->c[i], b->c[i]);
        } else {
            mpz_set(r->c[i], longer->c[i]);
        }
    }
    poly_trim(r, high);
}

void poly_sub(struct poly *r, const struct poly *a, const struct poly *b)
{
    int a_degree = a->degree;
    int b_degree = b->degree;
    int high = a_degree > b_degree ? a_degree : b_degree;
    for (int i = 0; i <= high; i++) {
        if (i > b_degree) {
            mpz_set(r->c[i], a->c[i]);
        } else if (i > a_degree) {
            mpz_neg(r->c[i], b->c[i]);
        } else {
            mpz_sub(r->c[i], a->c[i], b->c[i]);
        }
    }
    poly_trim(r, high);
}

void poly_mul(struct poly *r, const struct poly *a, const struct poly *b)
{
    if (a->degree < 0 || b->degree < 0) {
        r->degree = -1;
        return;
    }
    struct poly product;
    int degree = a->degree + b->degree;
    assert(degree <= POLY_DEGREE_MAX);
    poly_init(&product);
    for (int i = 0; i <= a->degree; i++) {
        for (int j = 0; j <= b->degree; j++) {
            mpz_addmul(product.c[i + j], a->c[i], b->c[j]);
        }
    }
    for (int i = 0; i <= degree; i++) {
        mpz_swap(r->c[i], product.c[i]);
    }
    r->degree = degree;
    poly_clear(&product);
}

/* Divide by the greatest common divisor of the coefficients. */
static void make_primitive(struct poly *p)
{
    mpz_t content;
    mpz_init(content);
    for (int i = 0; i <= p->degree; i++) {
        mpz_gcd(content, content, p->c[i]);
    }
    for (int i = 0; i <= p->degree; i++) {
        mpz_divexact(p->c[i], p->c[i], content);
    }
    mpz_clear(content);
}

/* a = the remainder of a power of b's leading coefficient times a, divided by b. */
static void pseudo_remainder(struct poly *a, const struct poly *b)
{
    mpz_t lead;
    mpz_init(lead);
    while (a->degree >= b->degree) {
        int shift = a->degree - b->degree;
        mpz_set(lead, a->c[a->degree]);
        for (int i = 0; i <= a->degree; i++) {
            mpz_mul(a->c[i], a->c[i], b->c[b->degree]);
        }
        for (int i = 0; i <= b->degree; i++) {
            mpz_submul(a->c[i + shift], lead, b->c[i]);
        }
        poly_trim(a, a->degree - 1);
    }
    mpz_clear(lead);
}

void poly_gcd(struct poly *g, const struct poly *a, const struct poly *b)
{
    struct poly w[2];
    poly_init(&w[0]);
    poly_init(&w[1]);
    poly_set(&w[0], a);
    poly_set(&w[1], b);
    int k = 1;
    make_primitive(&w[0]);
    while (w[k].degree >= 0) {
        make_primitive(&w[k]);
        pseudo_remainder(&w[1 - k], &w[k]);
        k = 1 - k;
    }
    poly_set(g, &w[1 - k]);
    poly_clear(&w[0]);
    poly_clear(&w[1]);
}

/* q = a / b where b divides a over the rationals and both have coprime coefficients: then
 * the quotient has integer coefficients (Gauss). */
static void divide_exactly(struct poly *q, const struct poly *a, const struct poly *b)
{
    struct poly rest;
    poly_init(&rest);
    poly_set(&rest, a);
    int degree = a->degree - b->degree;
    for (int k = degree; k >= 0; k--) {
        mpz_divexact(q->c[k], rest.c[k + b->degree], b->c[b->degree]);
        for (int i = 0; i <= b->degree; i++) {
            mpz_submul(rest.c[k + i], q->c[k], b->c[i]);
        }
    }
    poly_trim(&rest, a->degree);
    assert(rest.degree == -1);
    poly_trim(q, degree);
    poly_clear(&rest);
}

void poly_square_free(struct poly *g, const struct poly *f)
{
    struct poly whole;
    struct poly slope;
    poly_init(&whole);
    poly_init(&slope);
    poly_set(&whole, f);
    make_primitive(&whole);
    for (int i = 1; i <= f->degree; i++) {
        mpz_mul_ui(slope.c[i - 1], f->c[i], (unsigned long)i);
    }
    poly_trim(&slope, f->degree - 1);
    poly_gcd(&slope, &slope, &whole);
    divide_exactly(g, &whole, &slope);
    poly_clear(&whole);
    poly_clear(&slope);
}

int poly_sign_at(const struct poly *p, const mpz_t a, unsigned n)
{
    if (p->degree < 0) {
        return 0;
    }
    mpz_t sum;
    mpz_t term;
    mpz_init_set(sum, p->c[p->degree]);
    mpz_init(term);
    for (int i = p->degree - 1; i >= 0; i--) {
        mpz_mul(sum, sum, a);
        mpz_mul_2exp(term, p->c[i], (mp_bitcnt_t)n * (mp_bitcnt_t)(p->degree - i));
        mpz_add(sum, sum, term);
    }
    int sign = mpz_sgn(sum);
    mpz_clear(sum);
    mpz_clear(term);
    return sign;
}

/* q(u) = 2^(n degree) p((a + u) / 2^n). */
static void shift(struct poly *q, const struct poly *p, const mpz_t a, unsigned n)
{
    int degree = p->degree;
    for (int i = 0; i <= degree; i++) {
        mpz_mul_2exp(q->c[i], p->c[i], (mp_bitcnt_t)n * (mp_bitcnt_t)(degree - i));
    }
    for (int i = 0; i < degree; i++) {
        for (int j = degree - 1; j >= i; j--) {
            mpz_addmul(q->c[j], a, q->c[j + 1]);
        }
    }
    q->degree = degree;
}

/* Bernstein coefficient j of degree d from power coefficient i: a common multiple of the
 * binomials C(d, i) times C(j, i) / C(d, i). */
static const unsigned long
    weights[POLY_DEGREE_MAX + 1][POLY_DEGREE_MAX + 1][POLY_DEGREE_MAX + 1] = {
        {{1}},
        {{1}, {1, 1}},
        {{2}, {2, 1}, {2, 2, 2}},
        {{3}, {3, 1}, {3, 2, 1}, {3, 3, 3, 3}},
        {{12}, {12, 3}, {12, 6, 2}, {12, 9, 6, 3}, {12, 12, 12, 12, 12}},
        {{10},
         {10, 2},
         {10, 4, 1},
         {10, 6, 3, 1},
         {10, 8, 6, 4, 2},
         {10, 10, 10, 10, 10, 10}},
        {{60},
         {60, 10},
         {60, 20, 4},
         {60, 30, 12, 3},
         {60, 40, 24, 12, 4},
         {60, 50, 40, 30, 20, 10},
         {60, 60, 60, 60, 60, 60, 60}},
};

int poly_variations(const struct poly *p, const mpz_t a, unsigned n, int *sign)
{
    struct poly q;
    mpz_t sum;
    int changes = 0;
    int last = 0;
    poly_init(&q);
    mpz_init(sum);
    shift(&q, p, a, n);
    for (int j = 0; j <= q.degree; j++) {
        mpz_set_ui(sum, 0);
        for (int i = 0; i <= j; i++) {
            mpz_addmul_ui(sum, q.c[i], weights[q.degree][j][i]);
        }
        int now = mpz_sgn(sum);
        if (now != 0) {
            changes += last * now < 0;
            last = now;
        }
    }
    mpz_clear(sum);
    poly_clear(&q);
    *sign = last;
    return changes;
}
