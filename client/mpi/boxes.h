/* boxes.h - boxes around leaves over a step, and around blocks of them.
 *
 * Room:     client/mpi. May include: world.h.
 * Does:     bound what a leaf can meet: both ends of the step, some more for later ones,
 *           and half of the distance at which it meets; rounded outward to floats.
 * Threads:  one.
 */
#ifndef RANKS_BOXES_H
#define RANKS_BOXES_H

#include <float.h>
#include <math.h>

#include "world.h"

/* Leaves of one object that lie one behind the other on the curve. */
struct ranks_block {
    float box[6]; /* low, high */
    uint32_t object;
    uint32_t begin, count; /* of the object's own leaves */
};

/* How much larger than a step the boxes of an object's vertices are. */
struct ranks_room {
    double steps;   /* further ones, if each vertex goes on like this */
    double more[3]; /* on both sides, by axis */
};

struct ranks_boxes {
    float (*boxes)[6]; /* of own leaves; those of object o begin at first[o] */
    uint64_t *first;
    struct ranks_block *blocks;
    uint32_t block_count;
};

/* By how much the box of a leaf of the object is larger than the leaf: at least half of
 * the distance at which any of its features meets another one's half. */
double ranks_reach(const struct ranks_object *object, double separation);
/* In this rank alone: x0[o], x1[o] of the local vertices of object o. */
int ranks_boxes_make(struct pccd_mpi *world, double separation,
                     const struct ranks_room *rooms, const double (*const *x0)[3],
                     const double (*const *x1)[3], struct ranks_boxes *boxes);
void ranks_boxes_deinit(struct ranks_boxes *boxes);

/* The next float at or below, or above, a double; infinite beyond all floats. */
static inline float ranks_float_below(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}
static inline float ranks_float_above(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}
/* The box in which a vertex is in a step from x0 to x1, and that room. */
static inline void ranks_cover(const double x0[3], const double x1[3],
                               const struct ranks_room *room, float box[6])
{
    for (int k = 0; k < 3; k++) {
        double x2 = x1[k] + room->steps * (x1[k] - x0[k]);
        double low = fmin(fmin(x0[k], x1[k]), x2), high = fmax(fmax(x0[k], x1[k]), x2);
        box[k] = ranks_float_below(low - room->more[k]);
        box[k + 3] = ranks_float_above(high + room->more[k]);
    }
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

static inline bool ranks_boxes_meet(const float a[6], const float b[6])
{
    return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] &&
           b[2] <= a[5];
}

#endif
