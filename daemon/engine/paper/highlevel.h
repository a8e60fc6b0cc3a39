/* highlevel.h - one task unit near the top of the tree, shared out among all threads.
 *
 * Threads: [team]: every thread of the region calls it.
 * Source: paper section 5.1.
 */
#ifndef ENG_HIGHLEVEL_H
#define ENG_HIGHLEVEL_H

#include "team.h"

/* The high-level nodes of team->assignment, the deepest first, as
 * settings->tuning.high_level says. Fills in record.high_ns. */
void eng_highlevel_perform(struct eng_team *team, struct eng_worker *worker);

/* What one thread does of it. Round robin, by one thread: refine the pair of the node's
 * children breadth-first until there are enough to deal out in team->assignment->pairs.
 * [team] */
void eng_highlevel_expand(struct eng_team *team, struct eng_worker *worker,
                          uint32_t node);

/* Disjoint pairs: levels that are refined for so many threads. 2^levels threads take
 * part, in as many phases. */
uint32_t eng_highlevel_levels(uint32_t threads);
/* The pair of worker->thread in this phase. Returns their number, 0 or 1. [team] */
uint32_t eng_highlevel_phase(struct eng_worker *worker, uint32_t node, uint32_t phase,
                             uint32_t levels);

#endif
