/* taskunit.h - one self-collision task unit: all pairs between the two children of one
 * node.
 *
 * Source: paper section 4.1.
 */
#ifndef ENG_TASKUNIT_H
#define ENG_TASKUNIT_H

#include "worker.h"

/* Stealing: triangles below which a task is not split, of a node, of both nodes of a
 * pair. Triangles say little about the work where things touch: with 512 and 1024 the
 * largest task of recorded steps took up to 24 ms with its tests, more than a 64th of the
 * step; with these it takes 1.7 to 3.2 ms, and half of them gains nothing
 * (bench/model). A task costs about 0.1 us to push and pop. */
#define ENG_STEAL_UNIT_GRAIN 128u
#define ENG_STEAL_PAIR_GRAIN 128u

/* May features below a node meet each other? Not where they are all of an object whose
 * self-collision is off (masks.h), or foreign (mesh.h): nothing below it is worth a task
 * unit then. */
bool eng_taskunit_is_wanted(struct eng_worker *worker, uint32_t node);

/* The setup phase pushes the children of `node` to the worker's task unit queue if
 * `push_children`; the detection phase works through all pairs that (left, right) leads
 * to. A leaf has neither, nor has what is not wanted. Stops early when worker->stop says
 * so. */
void eng_taskunit_perform(struct eng_worker *worker, uint32_t node, bool push_children);

/* The pairs that (n, m), two nodes neither of which is below the other, leads to. */
void eng_taskunit_pairs(struct eng_worker *worker, uint32_t n, uint32_t m);

/* Test the boxes of (n, m) and refine it once: the pairs that may overlap are written to
 * n_out, m_out [4] without having been tested. Returns their number: 4, in the order LL,
 * LR, RL, RR; 2 if one of both is a leaf and stands for itself; 0 if the boxes are apart
 * or their objects may not meet, and for two leaves, which are dealt with. */
uint32_t eng_taskunit_refine(struct eng_worker *worker, uint32_t n, uint32_t m,
                             uint32_t n_out[4], uint32_t m_out[4]);

/* The same, uncounted, for a pair that another thread or phase counts: 0 for two leaves,
 * which are left to it. */
uint32_t eng_taskunit_peek(struct eng_worker *worker, uint32_t n, uint32_t m,
                           uint32_t n_out[4], uint32_t m_out[4]);

/* Test what is left in the worker's chunks. */
void eng_taskunit_flush(struct eng_worker *worker);

/* All task units from the root on, depth-first, by the only worker: the paper's serial
 * method. */
void eng_taskunit_perform_all(struct eng_worker *worker);

#endif
