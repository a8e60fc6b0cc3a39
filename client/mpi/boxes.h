/* boxes.h - boxes around leaves over some steps, and around blocks of them.
 *
 * Threads: one.
 */
#ifndef RANKS_BOXES_H
#define RANKS_BOXES_H

#include "moving.h"
#include "world.h"

/* Leaves of one object that lie one behind the other on the curve. */
struct ranks_block {
    struct ranks_moving_box box;
    uint32_t object;
    uint32_t begin, count; /* of the object's own leaves */
};

struct ranks_boxes {
    /* Of each object: of its local vertices, and these of the corners of its own
     * leaves. */
    struct ranks_moving_box **vertices;
    uint32_t (**corners)[3];
    uint32_t object_count;
    struct ranks_block *blocks;
    uint32_t block_count;
};

/* By how much the box of a leaf of the object is larger than the leaf: at least half of
 * the distance at which any of its features meets another one's half. */
double ranks_reach(const struct ranks_object *object, double separation);
/* In this rank alone: x0[o], x1[o] of the local vertices of object o, whose room is
 * object->room. */
int ranks_boxes_make(struct pccd_mpi *world, double separation,
                     const double (*const *x0)[3], const double (*const *x1)[3],
                     struct ranks_boxes *boxes);
void ranks_boxes_deinit(struct ranks_boxes *boxes);

/* Of an own leaf of object o. */
static inline void ranks_leaf_box(const struct ranks_boxes *boxes, uint32_t o,
                                  uint32_t leaf, struct ranks_moving_box *moving)
{
    *moving = boxes->vertices[o][boxes->corners[o][leaf][0]];
    ranks_moving_box_add(moving, &boxes->vertices[o][boxes->corners[o][leaf][1]]);
    ranks_moving_box_add(moving, &boxes->vertices[o][boxes->corners[o][leaf][2]]);
}

#endif
