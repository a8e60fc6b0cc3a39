/* stuck.h - whether a thread that computes is stuck.
 *
 * Room:     service. May include: compute.h.
 * Does:     look at each from time to time: one whose job goes on, and which has had no
 *           time of a processor since the look before last, waits for something that does
 *           not come; one that works on a step which was to end, by its deadline or
 *           cancelled, two looks ago, does not look up any more.
 * Does not: take a job for stuck that computes for long, nor notice one that computes for
 *           ever and was never told to end: commits and adds are not.
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
