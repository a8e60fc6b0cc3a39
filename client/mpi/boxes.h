/* boxes.h - boxes around leaves over some steps, and around blocks of them. */
#ifndef RANKS_BOXES_H
#define RANKS_BOXES_H

#include "moving_boxes.h"
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
/* On all sides, or by a little more. */
void ranks_box_grow(float box[6], double growth);
/* In this rank alone: x0[o], x1[o] of the local vertices of object o, whose margin is
 * object->margin. block_count: at most so many blocks, and as many again where the curve
 * jumps, and one more for each object. */
int ranks_boxes_make(struct pccd_mpi *world, double separation, uint64_t block_count,
                     const double (*const *x0)[3], const double (*const *x1)[3],
                     struct ranks_boxes *boxes);
/* Likewise, where objects stand at x. */
int ranks_boxes_make_still(struct pccd_mpi *world, uint64_t block_count,
                           const double (*const *x)[3], struct ranks_boxes *boxes);
/* How many blocks a rank may have if each rank gets those of all, as for ghosts. */
uint64_t ranks_block_count(const struct pccd_mpi *world);
void ranks_boxes_deinit(struct ranks_boxes *boxes);

/* Which leaves a rank needs, and what it has for others. */
struct ranks_need {
    const struct ranks_boxes *leaves; /* own ones */
    const struct ranks_block *boxes;  /* all leaves that meet any of them are needed .. */
    uint64_t box_count;
    double steps; /* .. while they go on so long */
    /* .. if the object of a box wants those of the leaf's. */
    bool (*wants)(const struct pccd_mpi *world, uint32_t box_object, uint32_t object);
    bool is_of_self; /* own leaves, too */
    /* An own leaf, as it goes to others. */
    void (*put)(const void *context, uint32_t object, uint32_t leaf, void *item);
    const void *context;
    size_t item_bytes;
};
/* Collective: the leaves that this rank needs, each once, to *in, which is allocated. */
int ranks_need_leaves(struct pccd_mpi *world, const struct ranks_need *need, void **in,
                      uint64_t *in_count);

/* Of an own leaf of object o. */
static inline void ranks_leaf_box(const struct ranks_boxes *boxes, uint32_t o,
                                  uint32_t leaf, struct ranks_moving_box *moving)
{
    *moving = boxes->vertices[o][boxes->corners[o][leaf][0]];
    ranks_moving_box_add(moving, &boxes->vertices[o][boxes->corners[o][leaf][1]]);
    ranks_moving_box_add(moving, &boxes->vertices[o][boxes->corners[o][leaf][2]]);
}

#endif
