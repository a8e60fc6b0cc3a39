/* health.h - warnings that follow from a daemon's counters.
 *
 * Threads: one.
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
