/* oracle_thick.c - the exact truth about two features and a distance.
 *
 * See oracle_thick.h. The square of the distance of two features is, at any time, num /
 * den of one pair of their parts: two vertices, a vertex and its foot on an edge, its
 * foot in a triangle, or the feet of the perpendicular common to two edges. It is at most
 * r^2 where some pair of parts has its feet inside, den > 0, and num - r^2 den <= 0.
 */
#include "oracle_thick.h"

#include <assert.h>

#include "oracle_root.h"

#define SIDES_MAX 4

/* Two parts. Their feet are inside where all sides are >= 0. */
struct parts {
    struct poly num;
    struct poly den;
    struct poly side[SIDES_MAX];
    int side_count;
    struct poly excess; /* num - r^2 den, times the denominator of r^2 */
};

struct problem {
    struct vec x[4];
    struct parts parts[FIRST_MAX];
    int count;
    mpz_t radius;    /* in the unit of x */
    mpz_t square[2]; /* r^2: numerator, denominator */
};

static void problem_init(struct problem *problem)
{
    problem->count = 0;
    mpz_inits(problem->radius, problem->square[0], problem->square[1], NULL);
    for (int i = 0; i < 4; i++) {
        vec_init(&problem->x[i]);
    }
    for (int i = 0; i < FIRST_MAX; i++) {
        struct parts *parts = &problem->parts[i];
        poly_init(&parts->num);
        poly_init(&parts->den);
        poly_init(&parts->excess);
        for (int k = 0; k < SIDES_MAX; k++) {
            poly_init(&parts->side[k]);
        }
        parts->side_count = 0;
    }
}

static void problem_clear(struct problem *problem)
{
    mpz_clears(problem->radius, problem->square[0], problem->square[1], NULL);
    for (int i = 0; i < 4; i++) {
        vec_clear(&problem->x[i]);
    }
    for (int i = 0; i < FIRST_MAX; i++) {
        struct parts *parts = &problem->parts[i];
        poly_clear(&parts->num);
        poly_clear(&parts->den);
        poly_clear(&parts->excess);
        for (int k = 0; k < SIDES_MAX; k++) {
            poly_clear(&parts->side[k]);
        }
    }
}

static void set_one(struct poly *p)
{
    mpz_set_ui(p->c[0], 1);
    p->degree = 0;
}

/* The side a, and what is left of `all` beside it. */
static void add_sides(struct parts *parts, const struct poly *a, const struct poly *all)
{
    poly_set(&parts->side[parts->side_count++], a);
    poly_sub(&parts->side[parts->side_count++], all, a);
}

static void add_vertices(struct problem *problem, int i, int j)
{
    struct parts *parts = &problem->parts[problem->count++];
    struct vec w;
    vec_init(&w);
    vec_sub(&w, &problem->x[i], &problem->x[j]);
    vec_dot(&parts->num, &w, &w);
    set_one(&parts->den);
    vec_clear(&w);
}

/* Vertex i, edge from j to k. */
static void add_foot(struct problem *problem, int i, int j, int k)
{
    struct parts *parts = &problem->parts[problem->count++];
    struct vec w;
    struct vec e;
    struct vec cross;
    struct poly along;
    vec_init(&w);
    vec_init(&e);
    vec_init(&cross);
    poly_init(&along);
    vec_sub(&w, &problem->x[i], &problem->x[j]);
    vec_sub(&e, &problem->x[k], &problem->x[j]);
    vec_cross(&cross, &w, &e);
    vec_dot(&parts->num, &cross, &cross);
    vec_dot(&parts->den, &e, &e);
    vec_dot(&along, &w, &e);
    add_sides(parts, &along, &parts->den);
    vec_clear(&w);
    vec_clear(&e);
    vec_clear(&cross);
    poly_clear(&along);
}

/* VF: w from corner a to the vertex, u and v to b and c, the weights of b and c are
 * (w x v) . n and (u x w) . n of n . n. EE: w from edge to edge, u and v along them, the
 * positions are (w x v) . n and (w x u) . n of n . n. */
static void add_insides(struct problem *problem, bool is_face)
{
    struct parts *parts = &problem->parts[problem->count++];
    const struct vec *x = problem->x;
    struct vec w, u, v, n, cross;
    struct poly share;
    vec_init(&w);
    vec_init(&u);
    vec_init(&v);
    vec_init(&n);
    vec_init(&cross);
    poly_init(&share);
    vec_sub(&w, &x[is_face ? 0 : 2], &x[is_face ? 1 : 0]);
    vec_sub(&u, &x[is_face ? 2 : 1], &x[is_face ? 1 : 0]);
    vec_sub(&v, &x[3], &x[is_face ? 1 : 2]);
    vec_cross(&n, &u, &v);
    vec_dot(&parts->den, &n, &n);
    vec_dot(&share, &w, &n);
    poly_mul(&parts->num, &share, &share);
    vec_cross(&cross, &w, &v);
    vec_dot(&share, &cross, &n);
    add_sides(parts, &share, &parts->den);
    if (is_face) {
        vec_cross(&cross, &u, &w);
        vec_dot(&share, &cross, &n);
        poly_set(&parts->side[parts->side_count++], &share);
        poly_sub(&parts->side[1], &parts->side[1], &share);
    } else {
        vec_cross(&cross, &w, &u);
        vec_dot(&share, &cross, &n);
        add_sides(parts, &share, &parts->den);
    }
    vec_clear(&w);
    vec_clear(&u);
    vec_clear(&v);
    vec_clear(&n);
    vec_clear(&cross);
    poly_clear(&share);
}

/* Return the ends of side number i of a feature with `count` points from point `begin`
 * on. */
static void side_of(int begin, int count, int i, int *from, int *to)
{
    *from = begin + i;
    *to = begin + (i + 1) % count;
}

static int side_count(int points)
{
    return points == 1 ? 0 : points == 2 ? 1 : 3;
}

static void add_all(struct problem *problem, const struct oracle_thick *thick)
{
    int a = thick->points_a;
    int b = thick->points_b;
    for (int i = 0; i < a; i++) {
        for (int j = a; j < a + b; j++) {
            add_vertices(problem, i, j);
        }
    }
    int from;
    int to;
    for (int i = 0; i < a; i++) {
        for (int n = 0; n < side_count(b); n++) {
            side_of(a, b, n, &from, &to);
            add_foot(problem, i, from, to);
        }
    }
    for (int j = a; j < a + b; j++) {
        for (int n = 0; n < side_count(a); n++) {
            side_of(0, a, n, &from, &to);
            add_foot(problem, j, from, to);
        }
    }
    if (a + b == 4) {
        add_insides(problem, a == 1);
    }
}

static void load(struct problem *problem, const struct oracle_thick *thick)
{
    assert(thick->points_a + thick->points_b <= 4 && thick->points_a <= 2);
    int used = thick->points_a + thick->points_b;
    double all[27] = {0};
    for (int i = 0; i < 24; i++) {
        all[i] = i / 3 % 4 < used ? thick->p[i / 3][i % 3] : 0;
    }
    for (int i = 0; i < 3; i++) {
        all[24 + i] = thick->radius[i];
    }
    int low = vec_common_exponent(all, 27);
    for (int i = 0; i < 12; i++) {
        struct poly *x = &problem->x[i / 3].c[i % 3];
        vec_set_scaled(x->c[0], all[i], low);
        vec_set_scaled(x->c[1], all[12 + i], low);
        mpz_sub(x->c[1], x->c[1], x->c[0]);
        poly_trim(x, 1);
    }
    for (int i = 0; i < 3; i++) {
        vec_set_scaled(problem->square[0], thick->radius[i], low);
        mpz_add(problem->radius, problem->radius, problem->square[0]);
    }
    mpz_mul(problem->square[0], problem->radius, problem->radius);
    mpz_set_ui(problem->square[1], 1);
    add_all(problem, thick);
}

static void set_excess(struct problem *problem)
{
    struct poly factor;
    struct poly product;
    poly_init(&factor);
    poly_init(&product);
    for (int i = 0; i < problem->count; i++) {
        struct parts *parts = &problem->parts[i];
        mpz_set(factor.c[0], problem->square[1]);
        poly_trim(&factor, 0);
        poly_mul(&parts->excess, &parts->num, &factor);
        mpz_set(factor.c[0], problem->square[0]);
        poly_trim(&factor, 0);
        poly_mul(&product, &parts->den, &factor);
        poly_sub(&parts->excess, &parts->excess, &product);
    }
    poly_clear(&factor);
    poly_clear(&product);
}

/* Return whether the feet are inside at `root`, and den is not 0. */
static bool has_feet_at(const struct parts *parts, struct root *root)
{
    for (int i = 0; i < parts->side_count; i++) {
        if (root_sign(root, &parts->side[i]) < 0) {
            return false;
        }
    }
    return root_sign(root, &parts->den) > 0;
}

/* Return whether the distance is at most r at `root`. Parts number `first` are asked
 * first. */
static bool is_within_at(const struct problem *problem, struct root *root, int first)
{
    for (int n = 0; n < problem->count; n++) {
        const struct parts *parts = &problem->parts[(first + n) % problem->count];
        if (root_sign(root, &parts->excess) <= 0 && has_feet_at(parts, root)) {
            return true;
        }
    }
    return false;
}

/* r^2 = s^2 times the square of the distance at `root`, t = 0. */
static void approach(struct problem *problem, double s, struct root *root)
{
    mpz_t best[2];
    mpz_t left;
    mpz_t right;
    bool is_set = false;
    mpz_inits(best[0], best[1], left, right, NULL);
    for (int i = 0; i < problem->count; i++) {
        const struct parts *parts = &problem->parts[i];
        if (!has_feet_at(parts, root)) {
            continue;
        }
        /* The coefficients at t = 0; those of zero polynomials are left as they were. */
        mpz_set_ui(left, 0);
        mpz_srcptr num = parts->num.degree < 0 ? left : parts->num.c[0];
        mpz_mul(right, best[0], parts->den.c[0]);
        mpz_mul(left, num, best[1]);
        bool is_less = mpz_cmp(left, right) < 0;
        if (!is_set || is_less) {
            mpz_set_ui(left, 0);
            mpz_set(best[0], parts->num.degree < 0 ? left : parts->num.c[0]);
            mpz_set(best[1], parts->den.c[0]);
            is_set = true;
        }
    }
    int low = vec_common_exponent(&s, 1); /* negative: s < 1 */
    vec_set_scaled(left, s, low);
    mpz_mul(left, left, left);
    mpz_mul(problem->square[0], best[0], left);
    mpz_mul_2exp(problem->square[1], best[1], (mp_bitcnt_t)(-2 * low));
    mpz_clears(best[0], best[1], left, right, NULL);
}

bool oracle_thick_is_inside(const struct oracle_thick *thick)
{
    struct problem problem;
    struct root start;
    problem_init(&problem);
    root_init(&start);
    load(&problem, thick);
    set_excess(&problem);
    bool is_inside = is_within_at(&problem, &start, 0);
    root_clear(&start);
    problem_clear(&problem);
    return is_inside;
}

/* The first root of an excess at which the distance is at most r. */
static void add_first_root(const struct problem *problem, int i,
                           struct oracle_first *first)
{
    struct root roots[POLY_DEGREE_MAX];
    if (problem->parts[i].excess.degree < 1) {
        return;
    }
    for (int k = 0; k < POLY_DEGREE_MAX; k++) {
        root_init(&roots[k]);
    }
    int count = root_isolate(&problem->parts[i].excess, roots);
    for (int k = 0; k < count; k++) {
        if (is_within_at(problem, &roots[k], i)) {
            root_set(&first->roots[first->count++], &roots[k]);
            break;
        }
    }
    for (int k = 0; k < POLY_DEGREE_MAX; k++) {
        root_clear(&roots[k]);
    }
}

struct oracle_first *oracle_thick_first_new(const struct oracle_thick *thick)
{
    struct oracle_first *first = first_new();
    struct problem problem;
    problem_init(&problem);
    load(&problem, thick);
    set_excess(&problem);
    struct root *start = &first->roots[0]; /* 0 */
    bool is_first = is_within_at(&problem, start, 0);
    if (is_first && thick->approach > 0) {
        approach(&problem, thick->approach, start);
        set_excess(&problem);
        is_first = is_within_at(&problem, start, 0); /* at distance 0 */
    }
    if (is_first) {
        first->count = 1;
    }
    for (int i = 0; i < problem.count && !is_first; i++) {
        add_first_root(&problem, i, first);
    }
    problem_clear(&problem);
    return first_or_null(first);
}
