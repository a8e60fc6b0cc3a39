/* cut.h - deals leaves out to ranks: a curve through space, weights, pieces, balance. */
#ifndef RANKS_CUT_H
#define RANKS_CUT_H

#include <stdint.h>

#include "world.h"

/* ---- A curve through all of space: what is near along it is near in space. */

/* low, high: of the box that is filled; its longest side is as long as the curve's cube,
 * so that pieces of the curve are about as long as they are wide in a flat box, too.
 * Points beyond it have the place of the nearest in it. 63 bits. */
uint64_t ranks_curve_place(const double x[3], const double low[3], const double high[3]);

/* Collective: deal out the leaves by where their given vertices are (object->x), and by
 * their weights (balance.c), which are of no use then. Afterwards there are no ghosts. */
int ranks_cut(struct pccd_mpi *world);

/* ---- Which rank gets which pieces of the curve. */

/* A leaf under way. */
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

/* Collective: the same on every rank; each has leaves[count], in order of their places.
 */
int ranks_pieces_find(struct pccd_mpi *world, const struct ranks_leaf_in_transit *leaves,
                      uint64_t count, struct ranks_pieces *pieces);
void ranks_pieces_deinit(struct ranks_pieces *pieces);

/* ---- How evenly the work of steps lies on the ranks, and when it is cut anew. */

/* In this rank alone: libpccd's next steps have no records; they count the pairs that
 * begin with each own feature. PCCD_E_NOMEM. */
int balance_weigh_begin(struct pccd_mpi *world);
/* In this rank alone: they have records again. */
void balance_weigh_stop(struct pccd_mpi *world);
/* Collective, after that: object->weights are what own leaves add to the work, by such a
 * step, and *sum is all of them. */
int balance_weigh_end(struct pccd_mpi *world, const struct pccd_step_counters *counters,
                      uint64_t *sum);
/* In this rank alone: all leaves weigh the same again. */
void balance_forget_weights(struct pccd_mpi *world);

/* After a step of libpccd in this rank. */
void balance_note(struct pccd_mpi *world, const struct pccd_step_counters *counters);
/* Collective: are the weights of what the ranks have so uneven that a cut pays? */
int balance_guess(struct pccd_mpi *world, uint64_t weight, bool *is_uneven);
/* Collective, after a step that each rank did all its work for: world->share.imbalance;
 * the most work of a rank is added to world->right_work. */
int balance_tell(struct pccd_mpi *world);

/* The same on every rank: is the scene to be cut anew before the next step? step_ns,
 * cut_ns: how long the last step and the last cut took the slowest rank. */
bool balance_wants_cut(const struct pccd_mpi *world);
void balance_note_times(struct pccd_mpi *world, uint64_t step_ns, uint64_t cut_ns);

#endif
