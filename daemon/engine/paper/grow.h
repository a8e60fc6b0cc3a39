/* grow.h - builds a tree from the top down, in pieces that can be interrupted.
 *
 * Split a list of items until each is alone, in place among the nodes of a scene or into
 * an array of a background rebuild; stop after any piece and go on later.
 *
 * Threads: [any]; one thread at a time for one grower; no allocation.
 * Source: paper section 6.2 (median partition); sah.h for the other build quality.
 *
 * A subtree of n triangles takes the 2n - 1 nodes that follow each other in pre-order, so
 * the place of every node is known before it is built, and a subtree can be built again
 * where it stands.
 *
 * Depth. Medians alone make a tree of ceil(log2 n) levels. The surface area heuristic is
 * followed only while both sides could still be finished by medians within ceil(log2 n) +
 * ENG_LEVELS_SPARE levels. Both hold for every subtree, and building a part anew with
 * medians keeps them.
 */
#ifndef ENG_GROW_H
#define ENG_GROW_H

#include "sah.h"
#include "trees.h"

/* Levels of a tree built with the heuristic beyond those of medians. */
#define ENG_LEVELS_SPARE 16u

/* A subtree to be built: items[first .. first+count-1] into the nodes from `node` on, in
 * at most `levels` levels below it. */
struct eng_grow_job {
    uint32_t first;
    uint32_t count;
    uint32_t node;
    uint32_t levels;
};

/* Of n <= 2^31 - 1 items there are at most 31 + ENG_LEVELS_SPARE levels; on each of them
 * one half waits while the other is built. */
#define ENG_GROW_STACK_MAX 48u

/* A node built in the background: its left child, if it has any, is the next node. */
struct eng_link {
    uint32_t right; /* node, or of a leaf: its triangle */
    uint32_t count;
};

enum eng_grow_stage { ENG_GROW_NEXT, ENG_GROW_MEDIAN, ENG_GROW_SAH };

struct eng_grower {
    struct eng_split_item *items;
    struct eng_node *nodes; /* where the subtree goes; or */
    struct eng_link *links; /* where it goes if that is NULL: node `base` and after */
    uint32_t base;
    bool over_roots;    /* items are roots of trees: only what is above them is built */
    struct eng_sah sah; /* with boxes: build quality SAH; boxes NULL: medians */

    struct eng_grow_job stack[ENG_GROW_STACK_MAX];
    uint32_t stack_count;
    enum eng_grow_stage stage; /* of `job` */
    struct eng_grow_job job;
    struct eng_median median;
};

/* An item with the centre of a node's moving box, scaled by four: only the order matters,
 * and four times 1e18 is a float. */
static inline struct eng_split_item eng_split_item_of(const struct eng_node *node,
                                                      uint32_t id)
{
    const struct eng_box *box = eng_box_of_const(node);
    eng_f4 sum =
        eng_bounds(box, 0) + eng_bounds(box, 1) + eng_bounds(box, 2) + eng_bounds(box, 3);
    return (struct eng_split_item){{sum[0], sum[1], sum[2]}, id};
}

/* Levels that medians need for `count` >= 1 items. */
uint32_t eng_grow_levels(uint32_t count);

/* Get ready to build all of items[count] at `root`; count >= 1, with over_roots >= 2.
 * `levels` >= eng_grow_levels(count) bounds the depth. The other fields are set by the
 * caller before. */
void eng_grow_begin(struct eng_grower *grower, uint32_t count, uint32_t root,
                    uint32_t levels);

/* One pass over a large list, or a small subtree; false: there is nothing left to do. */
bool eng_grow_piece(struct eng_grower *grower);

/* All of it. */
void eng_grow(struct eng_grower *grower);

#endif
