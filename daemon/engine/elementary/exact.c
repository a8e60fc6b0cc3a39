/* exact.c - exact answers about one moment. */
#include "exact.h"

#include <limits.h>

/* Places in the scratch: vectors take three. */
enum {
    POINTS = 0, /* four points */
    P = 12,
    B = 15,
    C = 18,
    N = 21,  /* b x c */
    T = 24,  /* scratch vector */
    U1 = 27, /* scratch vectors of on_segment */
    U2 = 30,
    DOT = 33,
    G1 = 34, /* (p x c) . n = beta n.n */
    G2 = 35, /* (b x p) . n = gamma n.n */
    NN = 36, /* n . n */
    TMP = 37,
    DET = 38
};

/* z[POINTS + 3 i + k] = x[i][k] * 2^s with one s that makes all of them integers. */
static void load(struct eng_exact *exact, const double (*x)[3])
{
    int low = INT_MAX;
    for (int i = 0; i < 12; i++) {
        low = eng_lower_exponent(x[i / 3][i % 3], low);
    }
    for (int i = 0; i < 12; i++) {
        eng_set_scaled(exact->z[POINTS + i], x[i / 3][i % 3], low);
    }
}

/* The vector operations name places, not pointers. */
static void sub(struct eng_exact *exact, int out, int a, int b)
{
    for (int k = 0; k < 3; k++) {
        mpz_sub(exact->z[out + k], exact->z[a + k], exact->z[b + k]);
    }
}

static void cross(struct eng_exact *exact, int out, int a, int b)
{
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        mpz_mul(exact->z[out + k], exact->z[a + i], exact->z[b + j]);
        mpz_submul(exact->z[out + k], exact->z[a + j], exact->z[b + i]);
    }
}

static void dot(struct eng_exact *exact, int out, int a, int b)
{
    mpz_mul(exact->z[out], exact->z[a], exact->z[b]);
    mpz_addmul(exact->z[out], exact->z[a + 1], exact->z[b + 1]);
    mpz_addmul(exact->z[out], exact->z[a + 2], exact->z[b + 2]);
}

static bool is_zero(const struct eng_exact *exact, int a)
{
    return mpz_sgn(exact->z[a]) == 0 && mpz_sgn(exact->z[a + 1]) == 0 &&
           mpz_sgn(exact->z[a + 2]) == 0;
}

/* Return whether point i is on the closed segment between points j and k. */
static bool on_segment(struct eng_exact *exact, int i, int j, int k)
{
    sub(exact, U1, POINTS + 3 * i, POINTS + 3 * j);
    sub(exact, U2, POINTS + 3 * i, POINTS + 3 * k);
    cross(exact, T, U1, U2);
    if (!is_zero(exact, T)) {
        return false;
    }
    dot(exact, DOT, U1, U2);
    return mpz_sgn(exact->z[DOT]) <= 0;
}

/* n = 0: the triangle is a segment or a point, or the edges are parallel or points.
 * Coplanar parallel edges share a point iff an end of one lies on the other. */
static bool degenerate_touches(struct eng_exact *exact, enum pccd_kind kind)
{
    if (kind == PCCD_VF) {
        return on_segment(exact, 0, 1, 2) || on_segment(exact, 0, 2, 3) ||
               on_segment(exact, 0, 1, 3);
    }
    return on_segment(exact, 0, 2, 3) || on_segment(exact, 1, 2, 3) ||
           on_segment(exact, 2, 0, 1) || on_segment(exact, 3, 0, 1);
}

static bool is_in_domain(struct eng_exact *exact, enum pccd_kind kind)
{
    cross(exact, T, P, C);
    dot(exact, G1, T, N);
    cross(exact, T, B, P);
    dot(exact, G2, T, N);
    if (mpz_sgn(exact->z[G1]) < 0 || mpz_sgn(exact->z[G2]) < 0) {
        return false;
    }
    dot(exact, NN, N, N);
    if (kind == PCCD_VF) {
        mpz_add(exact->z[TMP], exact->z[G1], exact->z[G2]);
        return mpz_cmp(exact->z[TMP], exact->z[NN]) <= 0;
    }
    return mpz_cmp(exact->z[G1], exact->z[NN]) <= 0 &&
           mpz_cmp(exact->z[G2], exact->z[NN]) <= 0;
}

bool eng_exact_share_corner(const struct eng_query *query, int end)
{
    const double(*x)[3] = query->x[end];
    int split = query->kind == PCCD_VF ? 1 : 2;
    for (int i = 0; i < split; i++) {
        for (int j = split; j < 4; j++) {
            if (x[i][0] == x[j][0] && x[i][1] == x[j][1] && x[i][2] == x[j][2]) {
                return true;
            }
        }
    }
    return false;
}

struct eng_moment eng_exact_moment(struct eng_exact *exact, const struct eng_query *query,
                                   int end)
{
    if (eng_exact_share_corner(query, end)) {
        return (struct eng_moment){true, 0};
    }
    exact->queries++;
    load(exact, query->x[end]);
    const int point0 = POINTS;
    const int point1 = POINTS + 3;
    const int point2 = POINTS + 6;
    const int point3 = POINTS + 9;
    if (query->kind == PCCD_VF) {
        sub(exact, P, point0, point1);
        sub(exact, B, point2, point1);
        sub(exact, C, point3, point1);
    } else {
        sub(exact, P, point2, point0);
        sub(exact, B, point1, point0);
        sub(exact, C, point2, point3);
    }
    cross(exact, N, B, C);
    dot(exact, DET, P, N);
    struct eng_moment moment = {false, mpz_sgn(exact->z[DET])};
    if (moment.side == 0) {
        moment.touching = is_zero(exact, N) ? degenerate_touches(exact, query->kind)
                                            : is_in_domain(exact, query->kind);
    }
    return moment;
}
