/* crossing.c - where an edge passes through a face. */
#include "crossing.h"

#include <math.h>

#include "side.h"

/* The sum of it and at most 1 is rounded to a multiple of 2^-32. */
#define TO_FIXED 0x1.8p20

bool eng_crossing_quickly(const double x[5][3], double *position)
{
    double error[2];
    double first = eng_side(x[0], x[2], x[3], x[4], &error[0]);
    double second = eng_side(x[1], x[2], x[3], x[4], &error[1]);
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
static struct eng_number side_of(struct eng_numbers *numbers, int end, bool is_turned)
{
    struct eng_vector w = eng_number_between(numbers, end, 2);
    struct eng_vector u = eng_number_between(numbers, is_turned ? 4 : 3, 2);
    struct eng_vector v = eng_number_between(numbers, is_turned ? 3 : 4, 2);
    struct eng_vector n = eng_number_cross(numbers, &u, &v);
    return eng_number_dot(numbers, &w, &n);
}

double eng_crossing_position(struct eng_numbers *numbers)
{
    struct eng_number first = side_of(numbers, 0, false);
    enum eng_sign sign = eng_number_sign(numbers, first);
    if (sign == ENG_MINUS) {
        first = side_of(numbers, 0, true);
    }
    struct eng_number second = side_of(numbers, 1, sign == ENG_MINUS);
    struct eng_number apart = eng_number_sub(numbers, first, second);
    if (sign == ENG_UNSURE || eng_number_sign(numbers, apart) != ENG_PLUS) {
        numbers->is_unsure = true;
        return 0;
    }
    return eng_number_ratio(numbers, first, apart);
}
