/* stuck.h - a watchdog that detects a computing thread which is stuck.
 *
 * Room:     service. May include: compute.h.
 * Does:     look at each thread from time to time. A thread is stuck if its job goes on,
 *           but it has had no processor time since the look before last: it waits for
 *           something that does not come. It is stuck, too, if its step should have ended
 *           two looks ago, by its deadline or because it was cancelled.
 * Does not: report a job that merely computes for long. It does not notice a job that
 *           computes for ever and was never told to end: commits and adds are not.
 * Threads:  [loop]
 */
#ifndef SRV_STUCK_H
#define SRV_STUCK_H

#include <stdbool.h>
#include <stdint.h>

#include "compute.h"

/* Zeroed: nothing has been seen. */
struct srv_stuck {
    struct {
        uint64_t begin_ns; /* of the job that ran at the last look; 0: none did */
        uint64_t cpu_ns;   /* that the thread had had */
        uint32_t idle;     /* looks since it had any */
        uint32_t late;     /* looks since the job was to end */
    } seen[SRV_RUNNERS_MAX];
};

/* To be called at equal intervals, long enough that a thread which can run has run. */
bool srv_stuck_look(struct srv_stuck *stuck, struct srv_compute *compute);

#endif
