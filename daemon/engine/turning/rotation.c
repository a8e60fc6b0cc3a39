/* rotation.c - lengths of rotation vectors, and their rotations. */
#include "rotation.h"

#include <math.h>

#include "sine.h"
#include "two.h"
#include "vec.h"

/* Vectors so short turn by themselves, to first order. */
#define SHORT 0x1p-60

struct eng_pair_number eng_rotation_length(const struct eng_pair_number w[3])
{
    double square = 0, rest = 0;
    for (int i = 0; i < 3; i++) {
        double product_rest, sum_rest;
        double product = eng_two_product(w[i].hi, w[i].hi, &product_rest);
        square = eng_two_sum(square, product, &sum_rest);
        rest += (sum_rest + product_rest) + 2 * w[i].hi * w[i].lo;
    }
    if (!(square > 0)) {
        return (struct eng_pair_number){0, 0};
    }
    double root = sqrt(square), root_rest, lo;
    double again = eng_two_product(root, root, &root_rest);
    double hi =
        eng_two_sum(root, ((square - again) - root_rest + rest) / (2 * root), &lo);
    return (struct eng_pair_number){hi, lo};
}

void eng_rotation_of_vector(const struct eng_pair_number w[3], double m[12])
{
    double u[3] = {w[0].hi, w[1].hi, w[2].hi};
    double sine = 1, cosine = 1;
    if (eng_size(u) >= SHORT) {
        struct eng_pair_number length = eng_rotation_length(w);
        common_sine(length.hi, length.lo, &sine, &cosine);
        for (int i = 0; i < 3; i++) {
            u[i] /= length.hi;
        }
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double both = (1 - cosine) * u[i] * u[j];
        m[4 * i + i] = cosine + (1 - cosine) * u[i] * u[i];
        m[4 * i + j] = both - sine * u[k];
        m[4 * j + i] = both + sine * u[k];
        m[4 * i + 3] = 0;
    }
}
