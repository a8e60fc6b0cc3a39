/* wide_order.h - chooses the order in which the features of an object are stored, so that
 * neighbours share a small box.
 *
 * Threads: [any]; one caller for one order.
 *
 * Separate pieces of a mesh (those that share no vertex) may fly apart, and a group with
 * features of two of them would soon be as large as the scene. So a mesh of many pieces
 * is ordered piece by piece: by where the pieces are, and then within each; no group of
 * 16 belongs to two pieces. This is not done for a mesh of a few pieces, or of one and
 * its splinters: few of its groups belong to two pieces. It is not done for small pieces
 * either, such as a thousand single triangles: most slots would stay empty.
 */
#ifndef ENG_WIDE_ORDER_H
#define ENG_WIDE_ORDER_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "box_frame.h"
#include "boxes.h"
#include "mesh.h"
#include "pccd_trace.h"
#include "wide_sort.h"

/* The three trees of the method `wide`. */
#define ENG_WIDE_TREES (PCCD_TREE_FACES + 1) /* PCCD_TREE_VERTICES, EDGES, FACES */

/* In the place of a feature, behind those of a piece. */
#define ENG_WIDE_NO_FEATURE UINT32_MAX

/* Local indices, first to last; vertices in no triangle are left out. One allocation. */
struct eng_wide_order {
    uint32_t count[ENG_WIDE_TREES];       /* slots: features, and those behind pieces */
    uint32_t *feature[ENG_WIDE_TREES];    /* [count] */
    uint32_t piece_count;                 /* 1: pieces are not told apart */
    uint32_t *piece_of;                   /* [vertex_count] of 1: NULL */
    uint32_t *piece_size[ENG_WIDE_TREES]; /* [piece_count] features */
    uint64_t bytes;                       /* of all this */
};

/* The part of an object that the method keeps. */
struct eng_wide_object {
    const struct eng_wide_order *order; /* of its features: `own`, or the mesh's */
    struct eng_wide_order *own; /* NULL: it is as all objects of the mesh were at first */
    uint32_t first[ENG_WIDE_TREES]; /* slot in the trees, once they are put together */
};

/* Make the order of a committed mesh, at the positions `x` of its vertices, by that many
 * threads, whose number (0: one) does not change the order. Freed with eng_free.
 * PCCD_E_NOMEM. O(n log n). */
int eng_wide_order_new(const struct eng_mesh *mesh, const double (*x)[3],
                       uint32_t threads, struct eng_wide_order **order);
/* Copy an order. Freed with eng_free; NULL: no memory. */
struct eng_wide_order *eng_wide_order_copy(const struct eng_wide_order *order);

/* Return how many there are in a mesh of what the features of a tree are listed from
 * (below): edges, triangles for faces, all leaves for vertices. */
uint32_t eng_wide_order_sources(const struct eng_mesh *mesh, enum pccd_tree kind);

/* Where the vertices of a mesh are, and the frame in which they are compared. */
struct eng_wide_positions {
    const double (*x)[3];
    const struct eng_box_frame *frame;
};

/* Put the features of a mesh in order, some at a time:
 *
 *   Add vertices first .. first + count - 1 of the mesh's to the sums of their
 *   pieces, pieces[piece_count], which were 0. */
void eng_wide_order_sum(const struct eng_wide_order *order,
                        struct eng_wide_positions positions, uint32_t first,
                        uint32_t count, struct eng_split_item *pieces);

/*   Order, after all of them, the pieces, by id, so that neighbours are near. */
void eng_wide_order_sequence(const struct eng_wide_order *order,
                             struct eng_split_item *pieces);

/*   Return the slots of a piece, a multiple of 16 if pieces are told apart. */
uint32_t eng_wide_order_slots(const struct eng_wide_order *order, enum pccd_tree kind,
                              uint32_t piece);

/*   Assign slots in this sequence: next[piece] is that of the first feature of a piece;
 *   of items[count], which are in slots, those behind a piece are no features. */
void eng_wide_order_assign_slots(const struct eng_wide_order *order, enum pccd_tree kind,
                                 const struct eng_split_item *pieces,
                                 struct eng_split_item *items, uint32_t *next);

/* Edges of a mesh, or leaves for the two other trees, that own features of a tree. */
struct eng_wide_sources {
    enum pccd_tree kind;
    uint32_t first;
    uint32_t count;
};

/*   Put the features that sources own into the next slots of their pieces, which go on:
 *   item ids are local indices. After all of them each piece's are to be sorted. */
void eng_wide_order_list(const struct eng_wide_order *order, const struct eng_mesh *mesh,
                         struct eng_wide_positions positions,
                         struct eng_wide_sources sources, struct eng_split_item *items,
                         uint32_t *next);

#endif
