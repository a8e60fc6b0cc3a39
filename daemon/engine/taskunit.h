/* daemon/engine/taskunit.h - the self-CD task unit.
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
 * `push_children`; the detection phase works through all pairs that (left, right) leads to.
 * A leaf has neither. Stops early when worker->stop says so. */
void eng_taskunit_perform(struct eng_worker *worker, uint32_t node, bool push_children);

/* Test what is left in the worker's chunks. */
void eng_taskunit_flush(struct eng_worker *worker);

#endif
