/* straight.h - the contacts of two objects that go straight, each between two poses of
 * its whole mesh, or stand: found by trees that stay in the frames of the meshes.
 *
 * Go down both trees. What the two poses make of a box, along an axis, is an interval at
 * either end of the step, and whatever is within it goes straight; so an axis that keeps
 * two boxes apart at both ends keeps them apart all the time. Features of leaves that no
 * axis keeps apart go to the narrow phase with the positions that they have in the world,
 * as those do that a method has found: the records are the same.
 *
 *     straight.c     pairs of leaves that may meet, and their features
 *     -> narrow/narrow.c     each of them
 *
 * Threads: [team]; what a thread has for it belongs to it alone. Two threads may be at
 * different tasks of the same two objects.
 * Source: elementary/BOUNDS.md, "Candidates of bodies that go straight".
 */
#ifndef ENG_STRAIGHT_H
#define ENG_STRAIGHT_H

#include "turning.h"

/* The state of a thread. */
struct eng_straight;

/* Make one. PCCD_E_NOMEM. */
int eng_straight_make(struct eng_straight **straight);
void eng_straight_free(struct eng_straight *straight); /* NULL is allowed */
uint64_t eng_straight_bytes(const struct eng_straight *straight);

/* Get ready for two objects, which must stay until the end of the step. Each either has
 * poses and the boxes of its mesh, or stands and has boxes where it does, the same at
 * both ends (body_tree.h). Nothing is thick. Costs about as much as a few tests. */
void eng_straight_begin(struct eng_straight *straight, struct eng_worker *worker,
                        const struct eng_turning_side side[2]);

/* Divide the work into at most `most` tasks, each a child of a node of either side;
 * returns how many. */
uint32_t eng_straight_split(struct eng_straight *straight, uint32_t most,
                            uint64_t *tasks);

#define ENG_STRAIGHT_ALL 0u /* a task: both trees */

/* Perform a task of the two: each pair of features is found by one task alone. Those that
 * are found wait, with others, until there are enough. Ends when the worker is to stop,
 * and looks whether it is every 0.1 ms or so. */
void eng_straight_perform(struct eng_straight *straight, uint64_t task);

/* Test what waits, when the thread has performed its last task of the step. */
void eng_straight_end(struct eng_straight *straight, struct eng_worker *worker);

#endif
