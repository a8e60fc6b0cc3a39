/* stuck.h - a watchdog that detects a computing thread which is stuck.
 *
 * Look at each thread from time to time. A thread is stuck if its job goes on, but it has
 * had no processor time since the look before last: it waits for something that does not
 * come. It is stuck, too, if its step should have ended two looks ago, by its deadline or
 * because it was cancelled.
 */
#ifndef SRV_STUCK_H
#define SRV_STUCK_H

#include <stdbool.h>

#include "compute.h"

/* To be called at equal intervals, long enough that a thread which can run has run. */
bool srv_stuck_look(struct srv_compute *compute);

#endif
