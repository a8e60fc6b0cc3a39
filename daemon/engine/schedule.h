/* daemon/engine/schedule.h - who performs which task unit.
 *
 * Room:     engine. May include: worker.h.
 * Does:     run every self-CD task unit of a scene's tree.
 * Threads:  [compute] calls it.
 * Source:   paper sections 4.1 (serial) and 4.2.
 */
#ifndef ENG_SCHEDULE_H
#define ENG_SCHEDULE_H

#include "worker.h"

/* All task units from the root on, breadth-first, by one worker, until none is left or
 * worker->stop says so. */
void eng_schedule_serial(struct eng_worker *worker);

#endif
