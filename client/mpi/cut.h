/* cut.h - deals leaves out to ranks: a curve through space, weights, pieces, balance. */
#ifndef RANKS_CUT_H
#define RANKS_CUT_H

#include <stdint.h>

#include "world.h"

/* Collective. Deal out the leaves by where their given vertices are (object->x), and by
 * their weights (balance.c), which are of no use then. Afterwards there are no ghosts. */
int ranks_cut(struct pccd_mpi *world);

/* ---- Which rank gets which pieces of the curve. */

/* A leaf on its way to the rank that will own it. */
struct ranks_leaf_in_transit {
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

/* Collective. Find the pieces, the same on every rank; each has leaves[count], in order
 * of their places. */
int ranks_pieces_find(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                      uint64_t count, struct ranks_pieces *pieces);
void ranks_pieces_deinit(struct ranks_pieces *pieces);

/* ---- How evenly the work of steps lies on the ranks, and when it is cut anew. */

/* A new scene is cut by leaves, and then so often at most by work, while that is uneven:
 * pieces have other ghosts after each. */
#define RANKS_CUTS_BY_WORK 2u

/* Have libpccd's next steps, in this rank alone, count the pairs that begin with each own
 * feature, and make no records. PCCD_E_NOMEM. */
int ranks_pairs_count_begin(struct pccd_mpi *world);
/* Have them make records again, in this rank alone. */
void ranks_pairs_count_end(struct pccd_mpi *world);
/* Collective. Set object->weights, after such a step, to what each own leaf adds to the
 * work, by the pairs that were counted, and *is_uneven if some rank has so much more work
 * than the mean that a cut pays. */
int ranks_leaves_weigh(struct pccd_mpi *world, const struct pccd_step_counters *counters,
                       bool *is_uneven);
/* Let all leaves weigh the same again, in this rank alone. */
void ranks_weights_forget(struct pccd_mpi *world);

/* Set world->share.work after a step of libpccd, in this rank alone. */
void ranks_work_note(struct pccd_mpi *world, const struct pccd_step_counters *counters);
/* Collective. Set world->share.imbalance, after a step that each rank did all its work
 * for, and add the most work of a rank to world->right_work. */
int ranks_work_compare(struct pccd_mpi *world);

/* Return whether the scene is to be cut anew before the next step; the same on every
 * rank. */
bool ranks_cut_is_due(const struct pccd_mpi *world);
/* Add what the step lost because ranks waited; cut_ns > 0: there was a cut, and that sum
 * begins anew. Both times are those of the slowest rank. */
void ranks_times_note(struct pccd_mpi *world, uint64_t step_ns, uint64_t cut_ns);

#endif
