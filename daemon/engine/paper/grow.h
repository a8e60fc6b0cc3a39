/* grow.h - builds a tree from the top down, in pieces that can be interrupted.
 *
 * Split a list of items at medians until each is alone: then the items are in the order
 * of the tree's leaves. Stop after any piece and go on later.
 *
 * Threads: [any]; one thread at a time for one grower; no allocation.
 * Source: paper section 6.2 (median partition).
 *
 * Where the nodes of a subtree are, and how they are linked, follows from its number of
 * triangles: n of them take 2 n - 1 nodes in pre-order and ceil(log2 n) levels. So a
 * subtree that is built anew keeps its nodes; other triangles in its leaves are all that
 * changes, and the boxes.
 */
#ifndef ENG_GROW_H
#define ENG_GROW_H

#include "trees.h"

/* A subtree to be built: items[first .. first+count-1] into the nodes from `node` on. */
struct eng_grow_job {
    uint32_t first;
    uint32_t count;
    uint32_t node;
};

/* The depth of the stack: n <= 2^31 - 1 items have at most 31 levels; on each of them one
 * half waits while the other is built. */
#define ENG_GROW_STACK_MAX 32u

struct eng_grower {
    struct eng_split_item *items;
    struct eng_node *nodes; /* where the subtree goes; NULL: items are put in order */
    bool over_roots; /* items are roots of trees: only what is above them is built */

    struct eng_grow_job stack[ENG_GROW_STACK_MAX];
    uint32_t stack_count;
    struct eng_grow_job job;
    bool is_splitting; /* the job: its median is being looked for */
    struct eng_median median;
};

/* Return an item with the centre of a node's moving box, scaled by four: only the order
 * matters, and four times 1e18 is a float. */
static inline struct eng_split_item eng_split_item_of(const struct eng_node *node,
                                                      uint32_t id)
{
    const struct eng_box *box = eng_box_of_const(node);
    eng_f4 sum =
        eng_bounds(box, 0) + eng_bounds(box, 1) + eng_bounds(box, 2) + eng_bounds(box, 3);
    return (struct eng_split_item){{sum[0], sum[1], sum[2]}, id};
}

/* Get ready to build all of items[count] at `root`; count >= 1, with over_roots >= 2. The
 * fields before `stack` are set by the caller. */
void eng_grow_begin(struct eng_grower *grower, uint32_t count, uint32_t root);

/* Do one pass over a large list, or build a small subtree; false: there is nothing left
 * to do. */
bool eng_grow_piece(struct eng_grower *grower);

/* Build all of it: every piece that is left. */
void eng_grow(struct eng_grower *grower);

/* Give the leaves of a subtree of an object the triangles of items that were put in
 * order. Its boxes are those of the old leaves until they are made again. */
void eng_grow_leaves(struct eng_trees *trees, struct eng_range nodes,
                     const struct eng_split_item *items);

#endif
