/* daemon/engine/schedule/highlevel.h - the task units of high-level nodes.
 *
 * Room:     engine. May include: team.h.
 * Does:     perform one task unit by all threads.
 * Threads:  [team]: every thread of the region calls it.
 * Source:   paper section 5.1.
 */
#ifndef ENG_HIGHLEVEL_H
#define ENG_HIGHLEVEL_H

#include "team.h"

/* The high-level nodes of team->assignment, the deepest first, as settings->high_level
 * says. Fills in record.high_ns. */
void eng_highlevel_perform(struct eng_team *team, struct eng_worker *worker);

#endif
