/* oracle.c - the exact truth about one elementary test.
 *
 * The coordinates are scaled to integers. Four points in a plane is a cubic in t:
 *
 *     VF  f = det[p - a, b - a, c - a]
 *     EE  f = det[c - a, b - a, d - c]
 *
 * f not identically 0: contacts are at roots of f. At each root the barycentric
 * numerators decide, or, where the normal vanishes, the segments that the features have
 * collapsed to.
 *
 * f identically 0: the first contact is at t = 0 or where a point arrives on a segment. A
 * point inside a triangle or the crossing of two edges stays one for a while before and
 * after, so it is never the first.
 */
#include "oracle.h"

#include <math.h>

#include "oracle_root.h"

/* The four points as polynomials of degree 1 with integer coefficients, and what is built
 * from them: VF e = p - a, u = b - a, v = c - a; EE e = c - a, u = b - a, v = d - c. */
struct query {
    enum oracle_kind kind;
    struct vec x[4];
    struct vec e;
    struct vec u;
    struct vec v;
    struct vec n;  /* u x v */
    struct poly f; /* e . n */
};

static void query_init(struct query *q)
{
    for (int i = 0; i < 4; i++) {
        vec_init(&q->x[i]);
    }
    vec_init(&q->e);
    vec_init(&q->u);
    vec_init(&q->v);
    vec_init(&q->n);
    poly_init(&q->f);
}

static void query_clear(struct query *q)
{
    for (int i = 0; i < 4; i++) {
        vec_clear(&q->x[i]);
    }
    vec_clear(&q->e);
    vec_clear(&q->u);
    vec_clear(&q->v);
    vec_clear(&q->n);
    poly_clear(&q->f);
}

/* After the points are set. */
static void query_derive(struct query *q, enum oracle_kind kind)
{
    q->kind = kind;
    if (kind == ORACLE_VF) {
        vec_sub(&q->e, &q->x[0], &q->x[1]);
        vec_sub(&q->u, &q->x[2], &q->x[1]);
        vec_sub(&q->v, &q->x[3], &q->x[1]);
    } else {
        vec_sub(&q->e, &q->x[2], &q->x[0]);
        vec_sub(&q->u, &q->x[1], &q->x[0]);
        vec_sub(&q->v, &q->x[3], &q->x[2]);
    }
    vec_cross(&q->n, &q->u, &q->v);
    vec_dot(&q->f, &q->e, &q->n);
}

static void query_set(struct query *q, enum oracle_kind kind, const double p[8][3])
{
    int low = vec_common_exponent((const double *)p, 24);
    for (int i = 0; i < 12; i++) {
        struct poly *x = &q->x[i / 3].c[i % 3];
        vec_set_scaled(x->c[0], p[i / 3][i % 3], low);
        vec_set_scaled(x->c[1], p[4 + i / 3][i % 3], low);
        mpz_sub(x->c[1], x->c[1], x->c[0]);
        poly_trim(x, 1);
    }
    query_derive(q, kind);
}

/* Replace t by lo + t (hi - lo), scaled by the denominators of lo and hi. */
static void query_cut(struct query *q, const mpq_t lo, const mpq_t hi)
{
    mpz_t both;
    mpz_t start;
    mpz_t width;
    mpz_inits(both, start, width, NULL);
    mpz_mul(both, mpq_denref(lo), mpq_denref(hi));
    mpz_mul(start, mpq_numref(lo), mpq_denref(hi));
    mpz_mul(width, mpq_numref(hi), mpq_denref(lo));
    mpz_sub(width, width, start);
    for (int i = 0; i < 12; i++) {
        struct poly *x = &q->x[i / 3].c[i % 3]; /* query_set wrote both coefficients */
        mpz_mul(x->c[0], x->c[0], both);
        mpz_addmul(x->c[0], x->c[1], start);
        mpz_mul(x->c[1], x->c[1], width);
        poly_trim(x, 1);
    }
    query_derive(q, q->kind);
    mpz_clears(both, start, width, NULL);
}

/* Point and segment of each way in which the collapsed features can meet. */
static const int vf_segments[3][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
static const int ee_segments[4][3] = {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}};

static int segment_count(const struct query *q)
{
    return q->kind == ORACLE_VF ? 3 : 4;
}

/* Point p is on segment x y iff (x - p) x (y - p) = 0 and (x - p) . (y - p) <= 0. */
struct incidence {
    struct vec cross;
    struct poly dot;
};

static void incidence_init(struct incidence *incidence, const struct query *q, int i)
{
    const int *way = q->kind == ORACLE_VF ? vf_segments[i] : ee_segments[i];
    struct vec to_x;
    struct vec to_y;
    vec_init(&to_x);
    vec_init(&to_y);
    vec_init(&incidence->cross);
    poly_init(&incidence->dot);
    vec_sub(&to_x, &q->x[way[1]], &q->x[way[0]]);
    vec_sub(&to_y, &q->x[way[2]], &q->x[way[0]]);
    vec_cross(&incidence->cross, &to_x, &to_y);
    vec_dot(&incidence->dot, &to_x, &to_y);
    vec_clear(&to_x);
    vec_clear(&to_y);
}

static void incidence_clear(struct incidence *incidence)
{
    vec_clear(&incidence->cross);
    poly_clear(&incidence->dot);
}

static bool vanishes_at(const struct vec *v, struct root *root)
{
    for (int k = 0; k < 3; k++) {
        if (root_sign(root, &v->c[k]) != 0) {
            return false;
        }
    }
    return true;
}

static bool point_on_segment_at(const struct query *q, struct root *root)
{
    bool found = false;
    for (int i = 0; i < segment_count(q) && !found; i++) {
        struct incidence incidence;
        incidence_init(&incidence, q, i);
        found =
            root_sign(root, &incidence.dot) <= 0 && vanishes_at(&incidence.cross, root);
        incidence_clear(&incidence);
    }
    return found;
}

/* Where f and not n vanishes. With N = n . n:
 *   VF  p = a + B/N u + C/N v, B = (e x v) . n, C = (u x e) . n:  B, C, N - B - C >= 0
 *   EE  a + S/N u = c + R/N v, S = (e x v) . n, R = (e x u) . n:  0 <= S, R <= N */
static bool inside_at(const struct query *q, struct root *root)
{
    struct vec cross;
    struct poly nn;
    struct poly w;
    vec_init(&cross);
    poly_init(&nn);
    poly_init(&w);
    vec_dot(&nn, &q->n, &q->n);
    vec_cross(&cross, &q->e, &q->v);
    vec_dot(&w, &cross, &q->n);
    bool inside = root_sign(root, &w) >= 0;
    if (inside && q->kind == ORACLE_EE) {
        poly_sub(&w, &nn, &w);
        inside = root_sign(root, &w) >= 0;
        poly_set(&w, &nn);
        vec_cross(&cross, &q->e, &q->u);
    } else {
        poly_sub(&w, &nn, &w);
        vec_cross(&cross, &q->u, &q->e);
    }
    /* The second numerator, and what is left for it. */
    vec_dot(&nn, &cross, &q->n);
    inside = inside && root_sign(root, &nn) >= 0;
    poly_sub(&w, &w, &nn);
    inside = inside && root_sign(root, &w) >= 0;
    poly_clear(&nn);
    poly_clear(&w);
    vec_clear(&cross);
    return inside;
}

/* Contact at a root of f. */
static bool touches_at(const struct query *q, struct root *root)
{
    if (vanishes_at(&q->n, root)) {
        return point_on_segment_at(q, root);
    }
    return inside_at(q, root);
}

/* A point moving along the line of its segment: contact while the dot product is not
 * positive. It starts positive, for nothing touches at t = 0. */
static void add_arrival(struct oracle_first *first, const struct poly *dot)
{
    struct root roots[POLY_DEGREE_MAX];
    for (int i = 0; i < POLY_DEGREE_MAX; i++) {
        root_init(&roots[i]);
    }
    if (root_isolate(dot, roots) > 0) {
        root_set(&first->roots[first->count++], &roots[0]);
    }
    for (int i = 0; i < POLY_DEGREE_MAX; i++) {
        root_clear(&roots[i]);
    }
}

/* Earliest t at which the point of `incidence` is on its segment, f being identically 0
 * and nothing touching at t = 0. */
static void add_incidence(struct oracle_first *first, const struct incidence *incidence)
{
    struct root roots[POLY_DEGREE_MAX];
    struct poly line;
    poly_init(&line);
    for (int k = 0; k < 3; k++) {
        poly_gcd(&line, &line, &incidence->cross.c[k]);
    }
    if (line.degree < 0) {
        add_arrival(first, &incidence->dot);
    } else if (line.degree > 0) {
        for (int i = 0; i < POLY_DEGREE_MAX; i++) {
            root_init(&roots[i]);
        }
        int count = root_isolate(&line, roots);
        for (int i = 0; i < count; i++) {
            if (root_sign(&roots[i], &incidence->dot) <= 0) {
                root_set(&first->roots[first->count++], &roots[i]);
                break;
            }
        }
        for (int i = 0; i < POLY_DEGREE_MAX; i++) {
            root_clear(&roots[i]);
        }
    }
    poly_clear(&line);
}

static void find_coplanar(const struct query *q, struct oracle_first *first)
{
    if (touches_at(q, &first->roots[0])) { /* which is 0 still */
        first->count = 1;
        return;
    }
    for (int i = 0; i < segment_count(q); i++) {
        struct incidence incidence;
        incidence_init(&incidence, q, i);
        add_incidence(first, &incidence);
        incidence_clear(&incidence);
    }
}

static void find_crossing(const struct query *q, struct oracle_first *first)
{
    struct root roots[POLY_DEGREE_MAX];
    for (int i = 0; i < POLY_DEGREE_MAX; i++) {
        root_init(&roots[i]);
    }
    int count = root_isolate(&q->f, roots);
    for (int i = 0; i < count && first->count == 0; i++) {
        if (touches_at(q, &roots[i])) {
            root_set(&first->roots[0], &roots[i]);
            first->count = 1;
        }
    }
    for (int i = 0; i < POLY_DEGREE_MAX; i++) {
        root_clear(&roots[i]);
    }
}

static void find_first(const struct query *q, struct oracle_first *first)
{
    if (q->f.degree < 0) {
        find_coplanar(q, first);
    } else {
        find_crossing(q, first);
    }
}

struct oracle_first *oracle_first_new(enum oracle_kind kind, const double p[8][3])
{
    struct oracle_first *first = first_new();
    struct query q;
    query_init(&q);
    query_set(&q, kind, p);
    find_first(&q, first);
    query_clear(&q);
    return first_or_null(first);
}

bool oracle_first_contact(enum oracle_kind kind, const double p[8][3], double width,
                          mpq_t lo, mpq_t hi)
{
    struct oracle_first *first = oracle_first_new(kind, p);
    int exponent;
    frexp(width, &exponent); /* width >= 2^(exponent - 1) */
    if (!first) {
        return false;
    }
    oracle_first_bracket(first, exponent < 1 ? (unsigned)(1 - exponent) : 0, lo, hi);
    oracle_first_free(first);
    return true;
}

bool oracle_hits(enum oracle_kind kind, const double p[8][3])
{
    struct oracle_first *first = oracle_first_new(kind, p);
    bool hits = first != NULL;
    oracle_first_free(first);
    return hits;
}

bool oracle_vf(const double p[8][3])
{
    return oracle_hits(ORACLE_VF, p);
}

bool oracle_ee(const double p[8][3])
{
    return oracle_hits(ORACLE_EE, p);
}

bool oracle_touching_at(enum oracle_kind kind, const double p[8][3], int t)
{
    struct query q;
    struct root root;
    query_init(&q);
    root_init(&root);
    query_set(&q, kind, p);
    root_set_end(&root, t);
    bool touching = root_sign(&root, &q.f) == 0 && touches_at(&q, &root);
    root_clear(&root);
    query_clear(&q);
    return touching;
}

bool oracle_contact_in(enum oracle_kind kind, const double p[8][3], const mpq_t lo,
                       const mpq_t hi)
{
    struct oracle_first first;
    struct query q;
    first_init(&first);
    query_init(&q);
    query_set(&q, kind, p);
    query_cut(&q, lo, hi);
    find_first(&q, &first);
    query_clear(&q);
    first_clear(&first);
    return first.count > 0;
}
