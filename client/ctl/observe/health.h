/* client/ctl/observe/health.h - warnings that follow from a daemon's counters.
 *
 * Room:     client/ctl. May include: counters.h.
 * Does:     write a sentence for each thing that stands out, with what to do next.
 * Does not: look at anything but counters: doctor.h does.
 * Threads:  one.
 * Source:   used by status and doctor.
 */
#ifndef CTL_HEALTH_H
#define CTL_HEALTH_H

#include <stdint.h>

#include "counters.h"

#define HEALTH_MAX        8u
#define HEALTH_TEXT_BYTES 160u

struct health {
    uint32_t count; /* 0: nothing stands out */
    char text[HEALTH_MAX][HEALTH_TEXT_BYTES];
};

void health_judge(const struct counters *counters, struct health *health);

#endif
