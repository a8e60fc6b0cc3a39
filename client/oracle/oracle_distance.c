/* oracle_distance.c - the exact distance of two features at one moment.
 *
 * A way has a vector g and a denominator: g / den is the difference of its ends. With w
 * between the vertices and u, v along the edges, each minimum solves a linear system of
 * their products (Gram): one unknown on an edge, two in a triangle or on two edges.
 */
#include "oracle_distance.h"

#include <limits.h>
#include <math.h>

#define FIXED_BITS  32 /* weights and directions: multiples of 2^-32 */
#define LENGTH_BITS 33 /* of a distance */
#define WAYS        9  /* VF: 3 VV, 3 VE, 1 VF; EE: 4 VV, 4 VE, 1 EE */

struct way {
    bool exists;
    enum oracle_nearest type;
    int points[4]; /* of VE: the vertex, the ends of the edge */
    mpz_t g[3];    /* from the second feature to the first, times den */
    mpz_t den;     /* > 0 */
    mpz_t gg;      /* g . g: the squared length is gg / den^2 */
    mpz_t num[2];  /* param, times den */
};

struct problem {
    enum oracle_kind kind;
    int low; /* points are x 2^low */
    mpz_t x[5][3];
    struct way ways[WAYS];
    int count;
};

static void problem_init(struct problem *problem, enum oracle_kind kind,
                         const double (*p)[3], int point_count)
{
    problem->kind = kind;
    problem->count = 0;
    problem->low = INT_MAX;
    for (int i = 0; i < 3 * point_count; i++) {
        int exponent;
        if (frexp(p[i / 3][i % 3], &exponent) != 0 && exponent - 53 < problem->low) {
            problem->low = exponent - 53;
        }
    }
    problem->low = problem->low == INT_MAX ? 0 : problem->low;
    for (int i = 0; i < 15; i++) {
        mpz_t *x = &problem->x[i / 3][i % 3];
        mpz_init(*x);
        if (i < 3 * point_count) {
            int exponent;
            double mantissa = frexp(p[i / 3][i % 3], &exponent);
            mpz_set_d(*x, ldexp(mantissa, 53));
            if (mantissa != 0) {
                mpz_mul_2exp(*x, *x, (mp_bitcnt_t)(exponent - 53 - problem->low));
            }
        }
    }
    for (int i = 0; i < WAYS; i++) {
        struct way *way = &problem->ways[i];
        mpz_inits(way->g[0], way->g[1], way->g[2], way->den, way->gg, way->num[0],
                  way->num[1], NULL);
    }
}

static void problem_clear(struct problem *problem)
{
    for (int i = 0; i < 15; i++) {
        mpz_clear(problem->x[i / 3][i % 3]);
    }
    for (int i = 0; i < WAYS; i++) {
        struct way *way = &problem->ways[i];
        mpz_clears(way->g[0], way->g[1], way->g[2], way->den, way->gg, way->num[0],
                   way->num[1], NULL);
    }
}

/* r = x[i] - x[j] */
static void between(struct problem *problem, mpz_t r[3], int i, int j)
{
    for (int k = 0; k < 3; k++) {
        mpz_sub(r[k], problem->x[i][k], problem->x[j][k]);
    }
}

static void dot(mpz_t r, mpz_t a[3], mpz_t b[3])
{
    mpz_mul(r, a[0], b[0]);
    mpz_addmul(r, a[1], b[1]);
    mpz_addmul(r, a[2], b[2]);
}

static void vec_init(mpz_t v[3])
{
    mpz_inits(v[0], v[1], v[2], NULL);
}

static void vec_clear(mpz_t v[3])
{
    mpz_clears(v[0], v[1], v[2], NULL);
}

static struct way *add_way(struct problem *problem, enum oracle_nearest type)
{
    struct way *way = &problem->ways[problem->count++];
    way->type = type;
    way->exists = true;
    return way;
}

/* Point i of the first feature, point j of the second. */
static void add_vv(struct problem *problem, int i, int j)
{
    struct way *way = add_way(problem, ORACLE_NEAREST_VV);
    way->points[0] = i;
    way->points[1] = j;
    between(problem, way->g, i, j);
    mpz_set_ui(way->den, 1);
    dot(way->gg, way->g, way->g);
    if (problem->kind == ORACLE_VF) {
        mpz_set_ui(way->num[0], j == 2);
        mpz_set_ui(way->num[1], j == 3);
    } else {
        mpz_set_ui(way->num[0], i == 1);
        mpz_set_ui(way->num[1], j == 3);
    }
}

/* Set where the position along edge j k goes, by the kind and the edge. */
static void set_edge_param(struct problem *problem, struct way *way, int j, int k,
                           mpz_t along)
{
    mpz_t rest;
    mpz_init(rest);
    mpz_sub(rest, way->den, along);
    if (problem->kind == ORACLE_EE) {
        int vertex = way->points[0];
        mpz_set(way->num[j == 2], along);
        mpz_set_ui(way->num[j != 2], 0);
        if (vertex % 2 == 1) {
            mpz_set(way->num[j != 2], way->den);
        }
    } else {
        for (int corner = 2; corner <= 3; corner++) {
            mpz_ptr num = way->num[corner - 2];
            mpz_set_ui(num, 0);
            if (corner == k) {
                mpz_set(num, along);
            } else if (corner == j) {
                mpz_set(num, rest);
            }
        }
    }
    mpz_clear(rest);
}

/* Vertex i and its foot strictly between j and k, if it is there. */
static void add_ve(struct problem *problem, int i, int j, int k)
{
    mpz_t w[3];
    mpz_t e[3];
    mpz_t along;
    vec_init(w);
    vec_init(e);
    mpz_init(along);
    struct way *way = add_way(problem, ORACLE_NEAREST_VE);
    way->points[0] = i;
    way->points[1] = j;
    way->points[2] = k;
    between(problem, w, i, j);
    between(problem, e, k, j);
    dot(along, w, e);
    dot(way->den, e, e);
    way->exists = mpz_sgn(along) > 0 && mpz_cmp(along, way->den) < 0;
    for (int axis = 0; axis < 3; axis++) {
        mpz_mul(way->g[axis], w[axis], way->den);
        mpz_submul(way->g[axis], e[axis], along);
        if (problem->kind == ORACLE_EE && i >= 2) {
            mpz_neg(way->g[axis], way->g[axis]); /* the vertex is of the second edge */
        }
    }
    dot(way->gg, way->g, way->g);
    set_edge_param(problem, way, j, k, along);
    vec_clear(w);
    vec_clear(e);
    mpz_clear(along);
}

/* The one place where the way is perpendicular to both u and v: inside the triangle or on
 * both edges, else it is no way.
 *   VF  w = p - a:   w - beta u - gamma v;   EE  w = c - a, v = c - d:  w - s u - r v */
static void add_inner(struct problem *problem)
{
    bool is_vf = problem->kind == ORACLE_VF;
    mpz_t w[3];
    mpz_t u[3];
    mpz_t v[3];
    mpz_t uu;
    mpz_t uv;
    mpz_t vv;
    mpz_t wu;
    mpz_t wv;
    mpz_t rest;
    vec_init(w);
    vec_init(u);
    vec_init(v);
    mpz_inits(uu, uv, vv, wu, wv, rest, NULL);
    struct way *way = add_way(problem, is_vf ? ORACLE_NEAREST_VF : ORACLE_NEAREST_EE);
    for (int i = 0; i < 4; i++) {
        way->points[i] = i;
    }
    between(problem, w, is_vf ? 0 : 2, is_vf ? 1 : 0);
    between(problem, u, is_vf ? 2 : 1, is_vf ? 1 : 0);
    between(problem, v, is_vf ? 3 : 2, is_vf ? 1 : 3);
    dot(uu, u, u);
    dot(uv, u, v);
    dot(vv, v, v);
    dot(wu, w, u);
    dot(wv, w, v);
    mpz_mul(way->den, uu, vv);
    mpz_submul(way->den, uv, uv);
    mpz_mul(way->num[0], wu, vv);
    mpz_submul(way->num[0], wv, uv);
    mpz_mul(way->num[1], wv, uu);
    mpz_submul(way->num[1], wu, uv);
    mpz_sub(rest, way->den, way->num[0]);
    if (is_vf) {
        mpz_sub(rest, rest, way->num[1]);
    }
    way->exists = mpz_sgn(way->den) > 0 && mpz_sgn(way->num[0]) >= 0 &&
                  mpz_sgn(way->num[1]) >= 0 && mpz_sgn(rest) >= 0 &&
                  mpz_cmp(way->num[1], way->den) <= 0;
    for (int axis = 0; axis < 3; axis++) {
        mpz_mul(way->g[axis], w[axis], way->den);
        mpz_submul(way->g[axis], u[axis], way->num[0]);
        mpz_submul(way->g[axis], v[axis], way->num[1]);
        if (!is_vf) {
            mpz_neg(way->g[axis], way->g[axis]);
        }
    }
    dot(way->gg, way->g, way->g);
    vec_clear(w);
    vec_clear(u);
    vec_clear(v);
    mpz_clears(uu, uv, vv, wu, wv, rest, NULL);
}

static void add_ways(struct problem *problem)
{
    if (problem->kind == ORACLE_VF) {
        for (int i = 0; i < 3; i++) {
            add_vv(problem, 0, 1 + i);
            add_ve(problem, 0, 1 + i, 1 + (i + 1) % 3);
        }
    } else {
        for (int i = 0; i < 4; i++) {
            add_vv(problem, i / 2, 2 + i % 2);
            add_ve(problem, i, i < 2 ? 2 : 0, i < 2 ? 3 : 1);
        }
    }
    add_inner(problem);
}

/* gg / den^2 of one less that of the other. */
static int compare_lengths(const struct way *a, const struct way *b)
{
    mpz_t left;
    mpz_t right;
    mpz_inits(left, right, NULL);
    mpz_mul(left, a->gg, b->den);
    mpz_mul(left, left, b->den);
    mpz_mul(right, b->gg, a->den);
    mpz_mul(right, right, a->den);
    int sign = mpz_cmp(left, right);
    mpz_clears(left, right, NULL);
    return sign;
}

static int point_count(enum oracle_nearest type)
{
    return type == ORACLE_NEAREST_VV ? 2 : type == ORACLE_NEAREST_VE ? 3 : 4;
}

/* Return what ways of one type are sorted by. */
static unsigned key(const struct way *way, const uint8_t rank[4])
{
    unsigned first = rank[way->points[0]];
    unsigned second = rank[way->points[1]];
    unsigned third = way->type == ORACLE_NEAREST_VE ? rank[way->points[2]] : 0;
    if (way->type == ORACLE_NEAREST_VV) {
        return first < second ? first << 8 | second : second << 8 | first;
    }
    return first << 16 | (second > third ? second << 8 | third : third << 8 | second);
}

static const struct way *shortest(const struct problem *problem, const uint8_t rank[4])
{
    const struct way *best = NULL;
    for (int i = 0; i < problem->count; i++) {
        const struct way *way = &problem->ways[i];
        if (!way->exists) {
            continue;
        }
        int sign = best ? compare_lengths(way, best) : -1;
        if (sign == 0) {
            sign = point_count(way->type) - point_count(best->type);
        }
        if (sign < 0 ||
            (sign == 0 && way->type != ORACLE_NEAREST_VF &&
             way->type != ORACLE_NEAREST_EE && key(way, rank) < key(best, rank))) {
            best = way;
        }
    }
    return best;
}

/* The nearest multiple of 2^-FIXED_BITS to num / den, halves to even. */
static double round_ratio(const mpz_t num, const mpz_t den)
{
    mpz_t twice; /* floor of 2 y, where y is to become a whole number */
    mpz_t rest;
    mpz_inits(twice, rest, NULL);
    mpz_mul_2exp(twice, num, FIXED_BITS + 1);
    mpz_fdiv_qr(twice, rest, twice, den);
    bool is_half = mpz_odd_p(twice) && mpz_sgn(rest) == 0;
    mpz_add_ui(twice, twice, 1);
    mpz_fdiv_q_2exp(twice, twice, 1);
    if (is_half && mpz_odd_p(twice)) {
        mpz_sub_ui(twice, twice, 1);
    }
    double value = ldexp(mpz_get_d(twice), -FIXED_BITS);
    mpz_clears(twice, rest, NULL);
    return value;
}

/* The same of g / sqrt(gg). */
static double round_cosine(const mpz_t g, const mpz_t gg)
{
    mpz_t square;
    mpz_t twice;
    mpz_t rest;
    mpz_inits(square, twice, rest, NULL);
    mpz_mul(square, g, g);
    mpz_mul_2exp(square, square, 2 * (FIXED_BITS + 1));
    mpz_fdiv_qr(square, rest, square, gg);
    bool is_exact = mpz_sgn(rest) == 0;
    mpz_sqrtrem(twice, rest, square);
    is_exact = is_exact && mpz_sgn(rest) == 0;
    bool is_half = mpz_odd_p(twice) && is_exact;
    mpz_add_ui(twice, twice, 1);
    mpz_fdiv_q_2exp(twice, twice, 1);
    if (is_half && mpz_odd_p(twice)) {
        mpz_sub_ui(twice, twice, 1);
    }
    double value = ldexp(mpz_get_d(twice), -FIXED_BITS);
    mpz_clears(square, twice, rest, NULL);
    return mpz_sgn(g) < 0 ? -value : value;
}

/* sqrt(gg) / den 2^low, down and up to doubles of at most LENGTH_BITS bits. */
static void round_length(const struct way *way, int low, double *lo, double *hi)
{
    mpz_t square;
    mpz_t root;
    mpz_t rest;
    if (mpz_sgn(way->gg) == 0) {
        *lo = *hi = 0;
        return;
    }
    mpz_inits(square, root, rest, NULL);
    /* The exponent of the length, or one more or less. */
    long exponent =
        (long)mpz_sizeinbase(way->gg, 2) / 2 - (long)mpz_sizeinbase(way->den, 2) + low;
    long cut = exponent - LENGTH_BITS - 3;
    cut = cut < -1074 ? -1074 : cut;
    /* square = gg 4^(low - cut) / den^2, as a fraction. */
    mpz_mul(rest, way->den, way->den);
    mpz_set(square, way->gg);
    if (cut <= low) {
        mpz_mul_2exp(square, square, (mp_bitcnt_t)(2 * (low - cut)));
    } else {
        mpz_mul_2exp(rest, rest, (mp_bitcnt_t)(2 * (cut - low)));
    }
    mpz_fdiv_qr(square, rest, square, rest);
    bool is_exact = mpz_sgn(rest) == 0;
    mpz_sqrtrem(root, rest, square);
    is_exact = is_exact && mpz_sgn(rest) == 0;
    size_t bits = mpz_sizeinbase(root, 2);
    size_t drop = bits > LENGTH_BITS ? bits - LENGTH_BITS : 0;
    is_exact = is_exact && (mpz_sgn(root) == 0 || mpz_scan1(root, 0) >= drop);
    mpz_fdiv_q_2exp(root, root, drop);
    *lo = ldexp(mpz_get_d(root), (int)(cut + (long)drop));
    mpz_add_ui(root, root, !is_exact);
    *hi = ldexp(mpz_get_d(root), (int)(cut + (long)drop));
    mpz_clears(square, root, rest, NULL);
}

void oracle_distance_find(enum oracle_kind kind, const double p[4][3],
                          const uint8_t rank[4], struct oracle_distance *distance)
{
    struct problem problem;
    problem_init(&problem, kind, p, 4);
    add_ways(&problem);
    const struct way *way = shortest(&problem, rank);
    distance->type = way->type;
    distance->points = 0;
    for (int i = 0; i < point_count(way->type); i++) {
        distance->points |= 1u << way->points[i];
    }
    round_length(way, problem.low, &distance->lo, &distance->hi);
    for (int i = 0; i < 2; i++) {
        distance->param[i] = round_ratio(way->num[i], way->den);
    }
    for (int i = 0; i < 3; i++) {
        distance->direction[i] =
            mpz_sgn(way->g[i]) == 0 ? 0 : round_cosine(way->g[i], way->gg);
        distance->direction[i] += 0.0; /* no zero has a sign */
    }
    problem_clear(&problem);
}

/* *square: of the distance. */
static void set_square(mpq_t square, enum oracle_kind kind, const double p[4][3])
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    struct problem problem;
    mpq_t den;
    mpq_init(den);
    problem_init(&problem, kind, p, 4);
    add_ways(&problem);
    const struct way *way = shortest(&problem, rank);
    mpq_set_z(square, way->gg);
    mpq_set_z(den, way->den);
    mpq_div(square, square, den);
    mpq_div(square, square, den);
    if (problem.low >= 0) {
        mpq_mul_2exp(square, square, (mp_bitcnt_t)(2 * problem.low));
    } else {
        mpq_div_2exp(square, square, (mp_bitcnt_t)(-2 * problem.low));
    }
    problem_clear(&problem);
    mpq_clear(den);
}

/* Bits of the time at which a trend is looked at. Of a way, gg / den^2, its conditions
 * and its difference from the first distance are polynomials in time whose coefficients
 * are whole numbers: of degree 10 at most in coordinates below 2^b, times 8 more of the
 * first distance's. One that is not 0 has no root sooner than 2^-(18 b + 64). */
static unsigned long bits_until(const struct problem *now)
{
    size_t b = 1;
    for (int i = 0; i < 15; i++) {
        size_t bits = mpz_sizeinbase(now->x[i / 3][i % 3], 2);
        b = bits > b ? bits : b;
    }
    return 18 * (b + 3) + 64;
}

int oracle_distance_trend(enum oracle_kind kind, const double p[8][3])
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    struct problem now, soon;
    problem_init(&now, kind, p, 4);
    problem_init(&soon, kind, p + 4, 4);
    int low = now.low < soon.low ? now.low : soon.low;
    for (int i = 0; i < 12; i++) { /* both in one unit */
        mpz_ptr x0 = now.x[i / 3][i % 3], x1 = soon.x[i / 3][i % 3];
        mpz_mul_2exp(x0, x0, (mp_bitcnt_t)(now.low - low));
        mpz_mul_2exp(x1, x1, (mp_bitcnt_t)(soon.low - low));
    }
    unsigned long bits = bits_until(&now), more = bits_until(&soon);
    bits = more > bits ? more : bits;
    for (int i = 0; i < 12; i++) { /* x0 2^bits + x1 - x0 */
        mpz_ptr x0 = now.x[i / 3][i % 3], x1 = soon.x[i / 3][i % 3];
        mpz_sub(x1, x1, x0);
        mpz_mul_2exp(x0, x0, bits);
        mpz_add(x1, x1, x0);
    }
    add_ways(&now);
    add_ways(&soon);
    int trend = compare_lengths(shortest(&soon, rank), shortest(&now, rank));
    problem_clear(&now);
    problem_clear(&soon);
    return (trend > 0) - (trend < 0);
}

/* sum += sign (radius[0] + radius[1]) */
static void add_radii(mpq_t sum, const double radius[2], int sign)
{
    mpq_t term;
    mpq_init(term);
    for (int i = 0; i < 2; i++) {
        mpq_set_d(term, sign * radius[i]);
        mpq_add(sum, sum, term);
    }
    mpq_clear(term);
}

/* Sign of sqrt(a) - sqrt(b) - r, r >= 0: of (a - b - r^2) - 2 r sqrt(b), and where the
 * first is not below 0, of their squares. All are overwritten. */
static int compare_roots(mpq_t a, mpq_t b, mpq_t r)
{
    mpq_sub(a, a, b);
    mpq_mul(r, r, r);
    mpq_sub(a, a, r);
    if (mpq_sgn(a) < 0) {
        return -1;
    }
    mpq_mul(a, a, a);
    mpq_mul(b, b, r);
    mpq_mul_2exp(b, b, 2);
    return mpq_cmp(a, b);
}

int oracle_distance_compare(enum oracle_kind kind_a, const double a[4][3],
                            const double radius_a[2], enum oracle_kind kind_b,
                            const double b[4][3], const double radius_b[2])
{
    mpq_t left;
    mpq_t right;
    mpq_t radii;
    mpq_inits(left, right, radii, NULL);
    set_square(left, kind_a, a);
    set_square(right, kind_b, b);
    add_radii(radii, radius_a, 1);
    add_radii(radii, radius_b, -1);
    bool is_turned = mpq_sgn(radii) < 0;
    mpq_abs(radii, radii);
    int sign = is_turned ? -compare_roots(right, left, radii)
                         : compare_roots(left, right, radii);
    mpq_clears(left, right, radii, NULL);
    return sign;
}

bool oracle_distance_within(enum oracle_kind kind, const double p[4][3], double d)
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    struct problem problem;
    mpz_t right;
    int exponent;
    double mantissa = frexp(d, &exponent);
    problem_init(&problem, kind, p, 4);
    add_ways(&problem);
    struct way way = *shortest(&problem, rank);
    /* gg 4^low / den^2 and (mantissa 2^exponent)^2, both times den^2. */
    mpz_init_set_d(right, ldexp(mantissa, 53));
    mpz_mul(right, right, way.den);
    mpz_mul(right, right, right);
    int more = exponent - 53 - problem.low;
    if (more >= 0) {
        mpz_mul_2exp(right, right, (mp_bitcnt_t)(2 * more));
    } else {
        mpz_mul_2exp(problem.x[0][0], way.gg, (mp_bitcnt_t)(-2 * more));
    }
    bool is_within = mpz_cmp(more >= 0 ? way.gg : problem.x[0][0], right) <= 0;
    mpz_clear(right);
    problem_clear(&problem);
    return is_within;
}

/* det[x[j] - x[i], x[k] - x[i], x[l] - x[i]] */
static void set_side(struct problem *problem, mpz_t det, int i, int j, int k, int l)
{
    mpz_t m[3][3];
    mpz_t product;
    mpz_init(product);
    for (int row = 0; row < 3; row++) {
        vec_init(m[row]);
    }
    between(problem, m[0], j, i);
    between(problem, m[1], k, i);
    between(problem, m[2], l, i);
    mpz_set_ui(det, 0);
    for (int axis = 0; axis < 3; axis++) {
        mpz_mul(product, m[1][(axis + 1) % 3], m[2][(axis + 2) % 3]);
        mpz_submul(product, m[1][(axis + 2) % 3], m[2][(axis + 1) % 3]);
        mpz_addmul(det, product, m[0][axis]);
    }
    for (int row = 0; row < 3; row++) {
        vec_clear(m[row]);
    }
    mpz_clear(product);
}

static int side(struct problem *problem, int i, int j, int k, int l)
{
    mpz_t det;
    mpz_init(det);
    set_side(problem, det, i, j, k, l);
    int sign = mpz_sgn(det);
    mpz_clear(det);
    return sign;
}

bool oracle_crosses(const double p[5][3])
{
    struct problem problem;
    problem_init(&problem, ORACLE_EE, p, 5);
    int first = side(&problem, 2, 3, 4, 0);
    bool crosses = first != 0 && side(&problem, 2, 3, 4, 1) == -first;
    if (crosses) {
        int turn = side(&problem, 0, 1, 2, 3);
        crosses = turn != 0 && side(&problem, 0, 1, 3, 4) == turn &&
                  side(&problem, 0, 1, 4, 2) == turn;
    }
    problem_clear(&problem);
    return crosses;
}

double oracle_crossing(const double p[5][3])
{
    struct problem problem;
    mpz_t first;
    mpz_t second;
    problem_init(&problem, ORACLE_EE, p, 5);
    mpz_inits(first, second, NULL);
    set_side(&problem, first, 2, 3, 4, 0);
    set_side(&problem, second, 2, 3, 4, 1);
    mpz_abs(first, first);
    mpz_abs(second, second);
    mpz_add(second, second, first);
    double position = round_ratio(first, second);
    mpz_clears(first, second, NULL);
    problem_clear(&problem);
    return position;
}
