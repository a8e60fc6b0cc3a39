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

/* Grow the box on all sides by `growth`, or by a little more (rounding). */
void ranks_box_grow(float box[6], double growth);
/* Make boxes of all objects, in this rank alone. x0[o], x1[o]: where the local vertices
 * of object o begin and end; its margin is object->margin. block_count: at most so many
 * blocks, and as many again where the curve jumps, and one more for each object. */
int ranks_boxes_make(struct pccd_mpi *world, double separation, uint64_t block_count,
                     const double (*const *x0)[3], const double (*const *x1)[3],
                     struct ranks_boxes *boxes);
/* Make boxes of objects that stand at x. */
int ranks_boxes_make_still(struct pccd_mpi *world, uint64_t block_count,
                           const double (*const *x)[3], struct ranks_boxes *boxes);
/* Return how many blocks a rank may have, so that each rank can get those of all. */
uint64_t ranks_block_count(const struct pccd_mpi *world);
void ranks_boxes_deinit(struct ranks_boxes *boxes);

/* Leaves that a rank needs of others, and its own ones, which others may need. */
struct ranks_fetch {
    const struct ranks_boxes *leaves; /* own ones */
    const struct ranks_block *boxes;  /* leaves that meet one of them are fetched .. */
    uint64_t box_count;
    double steps; /* .. if they meet within so many steps */
    /* .. and if the object of the box wants those of the leaf's object. */
    bool (*wants)(const struct pccd_mpi *world, uint32_t box_object, uint32_t object);
    bool is_of_self; /* own leaves are among them, too */
    /* Write an own leaf as it goes to others, to `item`. */
    void (*put)(const void *context, uint32_t object, uint32_t leaf, void *item);
    const void *context;
    size_t item_bytes;
};
/* Collective. Fetch the leaves that this rank needs, each once, to *in, which is
 * allocated. */
int ranks_fetch_leaves(struct pccd_mpi *world, const struct ranks_fetch *fetch, void **in,
                       uint64_t *in_count);

/* Set *moving to the box of an own leaf of object o. */
static inline void ranks_leaf_box(const struct ranks_boxes *boxes, uint32_t o,
                                  uint32_t leaf, struct ranks_moving_box *moving)
{
    *moving = boxes->vertices[o][boxes->corners[o][leaf][0]];
    ranks_moving_box_add(moving, &boxes->vertices[o][boxes->corners[o][leaf][1]]);
    ranks_moving_box_add(moving, &boxes->vertices[o][boxes->corners[o][leaf][2]]);
}

#endif
