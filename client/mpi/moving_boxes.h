/* moving_boxes.h - boxes that go on as what is in them does.
 *
 * Where vertices go on as they went, boxes do, too: two that fall side by side do not
 * meet, though one box around the whole way of each would meet the other one's. Such a
 * box is larger than what is checked later (ranks_is_covered) by more than all
 * roundings of doubles in here. Positions are finite, and at most 1e18.
 */
#ifndef RANKS_MOVING_BOXES_H
#define RANKS_MOVING_BOXES_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* How much larger than a step the boxes of an object's vertices are. */
struct ranks_margin {
    double more[3];  /* on both sides, by axis */
    bool follows[3]; /* boxes go on as vertices go in that step */
    bool is_whole;   /* they hold both ends of each step, not where it is at each time */
    double steps;    /* how many, at most, if any object's do; else 1 */
};

/* A box, and how far it goes on in a step: its sides, for what is in it goes at more than
 * one pace. */
struct ranks_moving_box {
    float box[6];  /* low, high */
    float pace[6]; /* along each axis of what goes least, and most */
};

/* Return the neighbour of a float towards -INFINITY or INFINITY: nextafterf, without a
 * call. */
static inline float ranks_float_before(float f)
{
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    bits = f > 0 ? bits - 1 : f < 0 ? bits + 1 : 0x80000001u;
    memcpy(&f, &bits, sizeof f);
    return f;
}
static inline float ranks_float_after(float f)
{
    return -ranks_float_before(-f);
}

/* Return the next float at or below, or above, a double; infinite beyond all floats. */
static inline float ranks_float_below(double x)
{
    float f = (float)x;
    return (double)f > x ? ranks_float_before(f) : f;
}
static inline float ranks_float_above(double x)
{
    float f = (float)x;
    return (double)f < x ? ranks_float_after(f) : f;
}

/* Return fmin or fmax of what is a number, without a call. */
static inline double ranks_least(double a, double b)
{
    return a < b ? a : b;
}
static inline double ranks_most(double a, double b)
{
    return a > b ? a : b;
}

/* Return more than the roundings of a position and of a way to floats. */
static inline double ranks_blur(float at, float pace)
{
    return 2 * (double)FLT_EPSILON * (fabs((double)at) + fabs((double)pace)) +
           (double)FLT_MIN;
}

/* Set where a vertex that goes from x0 to x1 in a step may be then and later, by axis: if
 * the margin follows, near cover[k] + t * cover[k + 3] at the begin of the t-th later
 * step, else between these two. */
static inline void ranks_cover(const double x0[3], const double x1[3],
                               const struct ranks_margin *margin, float cover[6])
{
    for (int k = 0; k < 3; k++) {
        if (margin->follows[k]) {
            cover[k] = (float)x0[k];
            cover[k + 3] = (float)(x1[k] - x0[k]);
        } else {
            cover[k] = ranks_float_below(ranks_least(x0[k], x1[k]) - margin->more[k]);
            cover[k + 3] = ranks_float_above(ranks_most(x0[k], x1[k]) + margin->more[k]);
        }
    }
}

/* Return whether a vertex is where it may be, at the begin of the t-th later step. The
 * box was made of x0 at t = 0 and x1 at t = 1. */
static inline bool ranks_is_covered(const double x[3], double t,
                                    const struct ranks_margin *margin,
                                    const float cover[6])
{
    bool is_in = true;
    for (int k = 0; k < 3; k++) {
        double low = (double)cover[k], high = (double)cover[k + 3];
        if (margin->follows[k]) {
            double near = low + t * high;
            double most = margin->more[k] + ranks_blur(cover[k], cover[k + 3]);
            low = near - most;
            high = near + most;
        }
        is_in = is_in && low <= x[k] && x[k] <= high;
    }
    return is_in;
}

/* Set *moving to all that the cover allows, from the begin of the step from x0 to x1
 * on. */
static inline void ranks_vertex_box(const double x0[3], const double x1[3],
                                    const struct ranks_margin *margin,
                                    struct ranks_moving_box *moving)
{
    float cover[6];
    ranks_cover(x0, x1, margin, cover);
    for (int k = 0; k < 3; k++) {
        moving->box[k] = cover[k];
        moving->box[k + 3] = cover[k + 3];
        moving->pace[k] = moving->pace[k + 3] = 0;
        if (margin->follows[k]) {
            double at = (double)cover[k], pace = (double)cover[k + 3];
            double most = margin->more[k] + ranks_blur(cover[k], cover[k + 3]);
            most += (double)FLT_EPSILON * (most + margin->steps * fabs(pace));
            double ahead = margin->is_whole ? pace : 0;
            moving->box[k] = ranks_float_below(at + ranks_least(ahead, 0) - most);
            moving->box[k + 3] = ranks_float_above(at + ranks_most(ahead, 0) + most);
            moving->pace[k] = moving->pace[k + 3] = cover[k + 3];
        }
    }
}

/* Return how long such boxes go on: whole ones are those of the begin of a step. */
static inline double ranks_margin_time(const struct ranks_margin *margin)
{
    return margin->is_whole ? margin->steps - 1 : margin->steps;
}

static inline void ranks_box_begin(float box[6])
{
    for (int k = 0; k < 3; k++) {
        box[k] = INFINITY;
        box[k + 3] = -INFINITY;
    }
}

static inline void ranks_box_add(float box[6], const float other[6])
{
    for (int k = 0; k < 3; k++) {
        box[k] = other[k] < box[k] ? other[k] : box[k];
        box[k + 3] = other[k + 3] > box[k + 3] ? other[k + 3] : box[k + 3];
    }
}

static inline void ranks_moving_box_begin(struct ranks_moving_box *moving)
{
    ranks_box_begin(moving->box);
    ranks_box_begin(moving->pace);
}

static inline void ranks_moving_box_add(struct ranks_moving_box *moving,
                                        const struct ranks_moving_box *other)
{
    ranks_box_add(moving->box, other->box);
    ranks_box_add(moving->pace, other->pace);
}

/* Narrow the time from .. until to that in which a side is above one that is `gap` below
 * it, when it goes on by `pace`. */
static inline void ranks_narrow(double gap, double pace, double *from, double *until)
{
    if (gap < 0) {
        double begin = pace > 0 ? -gap / pace : INFINITY;
        *from = begin > *from ? begin : *from;
    } else if (pace < 0) {
        double end = gap / -pace;
        *until = end < *until ? end : *until;
    }
}

/* Return whether two boxes meet within `steps`. */
static inline bool ranks_moving_boxes_meet(const struct ranks_moving_box *a,
                                           const struct ranks_moving_box *b, double steps)
{
    double from = 0, until = steps;
    for (int k = 0; k < 3; k++) {
        ranks_narrow((double)a->box[k + 3] - (double)b->box[k],
                     (double)a->pace[k + 3] - (double)b->pace[k], &from, &until);
        ranks_narrow((double)b->box[k + 3] - (double)a->box[k],
                     (double)b->pace[k + 3] - (double)a->pace[k], &from, &until);
    }
    return from <= until;
}

#endif
