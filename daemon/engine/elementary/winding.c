/* winding.c - what a face adds to a winding number, and where an edge passes through. */
#include "winding.h"

#include <assert.h>
#include <math.h>

#include "query.h"
#include "vec.h"

/* Products of differences of coordinates: what each is off by (BOUNDS.md). */
#define TURN_ERROR (4.5 * ENG_U)
#define SIDE_ERROR (16 * ENG_U)
#define LOST       0x1p-900

/* (p - a) . (b - a) x (c - a) of points of magnitude at most 1e18, within *error. */
static double side_by_doubles(const double p[3], const double a[3], const double b[3],
                              const double c[3], double *error)
{
    double w[3];
    double u[3];
    double v[3];
    double n[3];
    eng_sub(w, p, a);
    eng_sub(u, b, a);
    eng_sub(v, c, a);
    eng_cross(n, u, v);
    double size = fabs(w[0]) * (fabs(u[1] * v[2]) + fabs(u[2] * v[1])) +
                  fabs(w[1]) * (fabs(u[2] * v[0]) + fabs(u[0] * v[2])) +
                  fabs(w[2]) * (fabs(u[0] * v[1]) + fabs(u[1] * v[0]));
    *error = SIDE_ERROR * size + LOST;
    return eng_dot(w, n);
}

static enum eng_sign sign_of(double x)
{
    return x > 0 ? ENG_PLUS : x < 0 ? ENG_MINUS : ENG_ZERO;
}

/* ---- windings ---------------------------------------------------------------------- */

/* The points: 0 is p, 1 to 3 the face's corners. Load them for pairs or for integers. */
struct ray {
    struct eng_numbers *numbers;
    double x[4][3];
    int loaded; /* 0: not yet, 1: as pairs, 2: as integers */
};

static void load(struct ray *ray, int stage)
{
    if (ray->loaded != stage) {
        eng_numbers_load(ray->numbers, stage == 2, (const double(*)[3])ray->x, 4);
        ray->loaded = stage;
    }
}

/* Sign of (b - a) x (c - a) in the plane of y and z, exactly. */
static enum eng_sign slow_turn(struct ray *ray, int a, int b, int c)
{
    enum eng_sign sign = ENG_UNSURE;
    for (int stage = 1; stage <= 2 && sign == ENG_UNSURE; stage++) {
        load(ray, stage);
        struct eng_numbers *numbers = ray->numbers;
        struct eng_number_mark mark = eng_numbers_mark(numbers);
        struct eng_vector u = eng_number_between(numbers, b, a);
        struct eng_vector v = eng_number_between(numbers, c, a);
        struct eng_number left = eng_number_mul(numbers, u.c[1], v.c[2]);
        struct eng_number right = eng_number_mul(numbers, u.c[2], v.c[1]);
        sign = eng_number_sign(numbers, eng_number_sub(numbers, left, right));
        eng_numbers_forget(numbers, mark);
    }
    assert(sign != ENG_UNSURE);
    return sign;
}

/* Which side of the line from a to b the ray is on, seen along it: never in doubt, but
 * for a line that the ray is parallel to, which is ENG_ZERO. */
static enum eng_sign turn_of(struct ray *ray, int a, int b)
{
    const double *p = ray->x[0];
    const double *from = ray->x[a];
    const double *to = ray->x[b];
    double y = to[1] - from[1];
    double z = to[2] - from[2];
    double left = y * (p[2] - from[2]);
    double right = z * (p[1] - from[1]);
    double turn = left - right;
    double error = TURN_ERROR * (fabs(left) + fabs(right)) + LOST;
    if (fabs(turn) > error) {
        return sign_of(turn);
    }
    enum eng_sign sign = slow_turn(ray, a, b, 0);
    if (sign == ENG_ZERO) {
        sign = sign_of(-z); /* the sign of a difference of doubles is that of its true */
    }
    return sign == ENG_ZERO ? sign_of(y) : sign;
}

/* Sign of (p - a) . (b - a) x (c - a). */
static enum eng_sign slow_side(struct ray *ray)
{
    enum eng_sign sign = ENG_UNSURE;
    for (int stage = 1; stage <= 2 && sign == ENG_UNSURE; stage++) {
        load(ray, stage);
        struct eng_numbers *numbers = ray->numbers;
        struct eng_number_mark mark = eng_numbers_mark(numbers);
        struct eng_vector w = eng_number_between(numbers, 0, 1);
        struct eng_vector u = eng_number_between(numbers, 2, 1);
        struct eng_vector v = eng_number_between(numbers, 3, 1);
        struct eng_vector n = eng_number_cross(numbers, &u, &v);
        sign = eng_number_sign(numbers, eng_number_dot(numbers, &w, &n));
        eng_numbers_forget(numbers, mark);
    }
    assert(sign != ENG_UNSURE);
    return sign;
}

static enum eng_sign side_of(struct ray *ray)
{
    double error;
    double side = side_by_doubles(ray->x[0], ray->x[1], ray->x[2], ray->x[3], &error);
    return fabs(side) > error ? sign_of(side) : slow_side(ray);
}

enum eng_sign eng_winding(struct eng_numbers *numbers, const double p[3],
                          const double face[3][3])
{
    struct ray ray = {.numbers = numbers};
    for (int k = 0; k < 3; k++) {
        ray.x[0][k] = p[k];
        for (int i = 0; i < 3; i++) {
            ray.x[1 + i][k] = face[i][k];
        }
    }
    enum eng_sign turn = turn_of(&ray, 1, 2);
    if (turn == ENG_ZERO || turn_of(&ray, 2, 3) != turn || turn_of(&ray, 3, 1) != turn) {
        return ENG_ZERO;
    }
    enum eng_sign side = side_of(&ray);
    if (side == ENG_ZERO) {
        return ENG_UNSURE;
    }
    return side == turn ? ENG_ZERO : turn;
}

/* ---- crossings --------------------------------------------------------------------- */

/* The sum of it and at most 1 is rounded to a multiple of 2^-32. */
#define TO_FIXED 0x1.8p20

bool eng_crossing_quickly(const double x[5][3], double *position)
{
    double error[2];
    double first = side_by_doubles(x[0], x[2], x[3], x[4], &error[0]);
    double second = side_by_doubles(x[1], x[2], x[3], x[4], &error[1]);
    double apart = fabs(first) + fabs(second);
    if (!(fabs(first) > error[0] && fabs(second) > error[1])) {
        return false;
    }
    double at = fabs(first) / apart;
    double off = 1.1 * fmax(error[0], error[1]) / apart + 4 * ENG_U;
    *position = (at + TO_FIXED) - TO_FIXED;
    return fabs(at - *position) + 2 * off < 0x1p-33;
}

/* An end's side of the plane, or its opposite. */
static struct eng_number end_side(struct eng_numbers *numbers, int end, bool is_turned)
{
    struct eng_vector w = eng_number_between(numbers, end, 2);
    struct eng_vector u = eng_number_between(numbers, is_turned ? 4 : 3, 2);
    struct eng_vector v = eng_number_between(numbers, is_turned ? 3 : 4, 2);
    struct eng_vector n = eng_number_cross(numbers, &u, &v);
    return eng_number_dot(numbers, &w, &n);
}

double eng_crossing_position(struct eng_numbers *numbers)
{
    struct eng_number first = end_side(numbers, 0, false);
    enum eng_sign sign = eng_number_sign(numbers, first);
    if (sign == ENG_MINUS) {
        first = end_side(numbers, 0, true);
    }
    struct eng_number second = end_side(numbers, 1, sign == ENG_MINUS);
    struct eng_number apart = eng_number_sub(numbers, first, second);
    if (sign == ENG_UNSURE || eng_number_sign(numbers, apart) != ENG_PLUS) {
        numbers->is_unsure = true;
        return 0;
    }
    return eng_number_ratio(numbers, first, apart);
}
