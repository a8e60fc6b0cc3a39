/* rotation.h - poses as twelve doubles, rows of [R | t], and what is multiplied to them
 * from the right.
 *
 * Threads: [any].
 * Source: elementary/BOUNDS.md, "Bodies that turn".
 */
#ifndef ENG_ROTATION_H
#define ENG_ROTATION_H

/* A number hi + lo, where hi is the double nearest to it. */
struct eng_pair_number {
    double hi;
    double lo;
};

/* Set m to m g. */
static inline void eng_rotation_multiply(double m[12], const double g[12])
{
    for (double *row = m; row < m + 12; row += 4) {
        double x = row[0], y = row[1], z = row[2];
        row[0] = (x * g[0] + y * g[4]) + z * g[8];
        row[1] = (x * g[1] + y * g[5]) + z * g[9];
        row[2] = (x * g[2] + y * g[6]) + z * g[10];
        row[3] = ((x * g[3] + y * g[7]) + z * g[11]) + row[3];
    }
}

/* Set m to m times a turn about z. */
static inline void eng_rotation_turn(double m[12], double sine, double cosine)
{
    for (double *row = m; row < m + 12; row += 4) {
        double x = row[0], y = row[1];
        row[0] = cosine * x + sine * y;
        row[1] = cosine * y - sine * x;
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

/* Set m to the rotation of a rotation vector of length at most ENG_ANGLE_MAX + 1. */
void eng_rotation_of_vector(const struct eng_pair_number w[3], double m[12]);

#endif
