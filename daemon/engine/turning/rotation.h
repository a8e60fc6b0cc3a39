/* rotation.h - poses as twelve doubles, rows of [R | t], and what is multiplied to them
 * from the right.
 *
 * Threads: [any].
 * Source: elementary/BOUNDS.md, "Bodies that turn".
 */
#ifndef ENG_ROTATION_H
#define ENG_ROTATION_H

#include <string.h>

/* A number hi + lo, where hi is the double nearest to it. */
struct eng_pair_number {
    double hi;
    double lo;
};

/* Two neighbours. Written so, the compiler makes one operation of none of their sums and
 * products (findings/gcc-fmaddsub.sh). */
typedef double eng_d2 __attribute__((vector_size(16)));

static inline eng_d2 eng_d2_load(const double x[2])
{
    eng_d2 out;
    memcpy(&out, x, sizeof out);
    return out;
}

static inline void eng_d2_store(double x[2], eng_d2 y)
{
    memcpy(x, &y, sizeof y);
}

static inline eng_d2 eng_d2_both(double x)
{
    return (eng_d2){x, x};
}

/* Set m to m g. */
static inline void eng_rotation_multiply(double m[12], const double g[12])
{
    const eng_d2 left[3] = {eng_d2_load(g), eng_d2_load(g + 4), eng_d2_load(g + 8)};
    const eng_d2 right[3] = {eng_d2_load(g + 2), eng_d2_load(g + 6), eng_d2_load(g + 10)};
    for (double *row = m; row < m + 12; row += 4) {
        eng_d2 x = eng_d2_both(row[0]), y = eng_d2_both(row[1]), z = eng_d2_both(row[2]);
        eng_d2 place = {0, row[3]};
        eng_d2_store(row, (x * left[0] + y * left[1]) + z * left[2]);
        eng_d2_store(row + 2, ((x * right[0] + y * right[1]) + z * right[2]) + place);
    }
}

/* Set m to m times a turn about z. */
static inline void eng_rotation_turn(double m[12], double sine, double cosine)
{
    for (double *row = m; row < m + 12; row += 4) {
        eng_d2 across = {row[1], -row[0]};
        eng_d2_store(row,
                     eng_d2_both(cosine) * eng_d2_load(row) + eng_d2_both(sine) * across);
    }
}

/* Set m to m times a shift by d. */
static inline void eng_rotation_shift(double m[12], const double d[3])
{
    for (double *row = m; row < m + 12; row += 4) {
        row[3] = ((row[0] * d[0] + row[1] * d[1]) + row[2] * d[2]) + row[3];
    }
}

/* Return the length of a vector of magnitude at most 2^64, with an error of 2^-100 of
 * it, and of at most 2^-500 where coordinates are so small. */
struct eng_pair_number eng_rotation_length(const struct eng_pair_number w[3]);

/* Set m to the rotation of a rotation vector of length at most COMMON_ANGLE_MAX + 1. */
void eng_rotation_of_vector(const struct eng_pair_number w[3], double m[12]);

#endif
