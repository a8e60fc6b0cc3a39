/* daemon/engine/wide/wide_order.h - the order in which an object's features are stored.
 *
 * Room:     engine. May include: median.h, mesh.h.
 * Does:     put features that are near each other next to each other, so that every
 *           aligned group of 16, 256, .. of them has a tight box.
 * Threads:  [any]; one caller for one order.
 */
#ifndef ENG_WIDE_ORDER_H
#define ENG_WIDE_ORDER_H

#include <stddef.h>

#include "median.h"
#include "mesh.h"

/* The three trees of the method `wide`. */
enum eng_wide_kind { ENG_WIDE_VERTICES, ENG_WIDE_EDGES, ENG_WIDE_FACES, ENG_WIDE_KINDS };

/* Local indices, first to last; vertices in no triangle are left out. One allocation. */
struct eng_wide_order {
    uint32_t count[ENG_WIDE_KINDS];
    uint32_t *feature[ENG_WIDE_KINDS]; /* [count] */
};

/* Of a committed mesh, at the positions `x` of its vertices, by that many threads, whose
 * number (0: one) does not change the order. Freed with eng_free. ENG_E_NOMEM.
 * O(n log n). */
int eng_wide_order_new(const struct eng_mesh *mesh, const double (*x)[3],
                       uint32_t threads, struct eng_wide_order **order);

uint64_t eng_wide_order_bytes(const struct eng_wide_order *order);

/* Edges or, for the two other trees, triangles of a mesh. */
uint32_t eng_wide_order_sources(const struct eng_mesh *mesh, enum eng_wide_kind kind);

/* The features of one tree that edges or triangles first .. first + count - 1 of a mesh
 * own, with the mesh's vertices at `x`, in no order: item ids are local indices. Returns
 * how many. */
uint32_t eng_wide_order_list(const struct eng_mesh *mesh, const double (*x)[3],
                             enum eng_wide_kind kind, uint32_t first, uint32_t count,
                             struct eng_split_item *items);

/* Sort items[count] by splits at the median of the longest axis, each at a multiple of
 * the largest power of 16 below its range; down to ranges of `least`, 1 or 16. */
void eng_wide_sort(struct eng_split_item *items, uint32_t count, uint32_t least);

/* The same in pieces, for who has to stop between. */
struct eng_wide_sorter {
    uint32_t least;
    uint32_t waiting; /* ranges of the stack */
    struct eng_wide_range {
        size_t first;
        uint32_t count;
    } stack[64];
    bool is_splitting; /* the one at hand */
    struct eng_wide_range range;
    struct eng_median median;
};

void eng_wide_sorter_begin(struct eng_wide_sorter *sorter, uint32_t count,
                           uint32_t least);

/* One pass over a range of the items, or everything that is below a range of at most
 * `whole` items. False: they are sorted. */
bool eng_wide_sorter_advance(struct eng_wide_sorter *sorter, struct eng_split_item *items,
                             uint32_t whole);

#endif
