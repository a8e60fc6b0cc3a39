/* pieces.h - which rank gets which pieces of the curve.
 *
 * Threads: one.
 */
#ifndef RANKS_PIECES_H
#define RANKS_PIECES_H

#include "world.h"

/* A leaf under way. */
struct ranks_traveller {
    uint64_t place; /* on the curve */
    uint32_t object, weight;
    struct ranks_leaf leaf;
};

/* Slice i has the leaves whose places are ends[i - 1] or more, and less than ends[i]. */
struct ranks_pieces {
    uint64_t count; /* of slices */
    uint64_t *ends;
    uint32_t *rank; /* [count] who gets it */
};

/* Collective: the same on every rank; each has leaves[count], in order of their places.
 */
int ranks_pieces_find(struct pccd_mpi *world, const struct ranks_traveller *leaves,
                      uint64_t count, struct ranks_pieces *pieces);
void ranks_pieces_deinit(struct ranks_pieces *pieces);

#endif
