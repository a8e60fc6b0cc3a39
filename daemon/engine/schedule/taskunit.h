/* daemon/engine/schedule/taskunit.h - the self-CD task unit.
 *
 * Room:     engine. May include: worker.h.
 * Does:     all collision test pairs below one node, between its two children.
 * Threads:  [team].
 * Source:   paper section 4.1.
 */
#ifndef ENG_TASKUNIT_H
#define ENG_TASKUNIT_H

#include "worker.h"

/* The setup phase pushes the children of `node` to the worker's task unit queue if
 * `push_children`; the detection phase works through all pairs that (left, right) leads
 * to. A leaf has neither. Stops early when worker->stop says so. */
void eng_taskunit_perform(struct eng_worker *worker, uint32_t node, bool push_children);

/* The pairs that (n, m), two nodes neither of which is below the other, leads to. */
void eng_taskunit_pairs(struct eng_worker *worker, uint32_t n, uint32_t m);

/* Test the boxes of (n, m) and refine it once: the pairs that may overlap are written to
 * n_out, m_out [4] without having been tested. Returns their number, 0 also for two
 * leaves, which are dealt with. */
uint32_t eng_taskunit_refine(struct eng_worker *worker, uint32_t n, uint32_t m,
                             uint32_t n_out[4], uint32_t m_out[4]);

/* Test what is left in the worker's chunks. */
void eng_taskunit_flush(struct eng_worker *worker);

#endif
