/* box_frame.h - the local coordinates in which the boxes of an object are stored, so that
 * single precision suffices far from the origin.
 *
 * Threads: [any]; inline only.
 *
 * Example: a car of 5 m stands at x = 10^7 m. Floats are 1 m apart there, so all boxes of
 * the car would be the same box. Measured from an origin near the car, floats are 10^-7 m
 * apart.
 */
#ifndef ENG_BOX_FRAME_H
#define ENG_BOX_FRAME_H

#include <math.h>

/* The exact bounds of points along each axis. Of no points: low > high. */
struct eng_bounds {
    double low[3];
    double high[3];
};

#define ENG_NO_BOUNDS                                                                    \
    {                                                                                    \
        {INFINITY, INFINITY, INFINITY},                                                  \
        {                                                                                \
            -INFINITY, -INFINITY, -INFINITY                                              \
        }                                                                                \
    }

/* Return the length of the longest side. */
static inline double eng_bounds_size(const struct eng_bounds *bounds)
{
    return fmax(fmax(bounds->high[0] - bounds->low[0], bounds->high[1] - bounds->low[1]),
                bounds->high[2] - bounds->low[2]);
}

static inline void eng_bounds_unite(struct eng_bounds *bounds,
                                    const struct eng_bounds *other)
{
    for (int k = 0; k < 3; k++) {
        bounds->low[k] = fmin(bounds->low[k], other->low[k]);
        bounds->high[k] = fmax(bounds->high[k], other->high[k]);
    }
}

/* A coordinate x along axis k at end e (0: t = 0, 1: t = 1) is measured as
 * (x - origin[4 e + k]) scale; the fourth of each end is 0. The scale is a power of two,
 * 1 or more. */
struct eng_box_frame {
    double origin[8];
    double scale;
};

/* Return a coordinate x at t = 1 in the frame, for what needs no certainty, like the
 * order of features. */
static inline double eng_box_frame_at(const struct eng_box_frame *frame, double x,
                                      int axis)
{
    return (x - frame->origin[4 + axis]) * frame->scale;
}

/* Return what the rounded difference a - b leaves out: both together are a - b exactly
 * (Knuth's two-sum). */
static inline double eng_rest_of_difference(double a, double b)
{
    double difference = a - b;
    double subtracted = difference - a; /* about -b */
    return (a - (difference - subtracted)) + (-b - subtracted);
}

/* Return a - b rounded down. */
static inline double eng_difference_down(double a, double b)
{
    double difference = a - b;
    return eng_rest_of_difference(a, b) < 0 ? nextafter(difference, -INFINITY)
                                            : difference;
}
/* Return a + b rounded up. */
static inline double eng_sum_up(double a, double b)
{
    return -eng_difference_down(-a, b);
}

#endif
