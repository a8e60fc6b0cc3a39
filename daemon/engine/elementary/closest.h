/* daemon/engine/elementary/closest.h - the nearest points of two features at one moment.
 *
 * Room:     engine. May include: motion.h.
 * Does:     find (beta, gamma) in the domain for which p - beta b - gamma c is shortest.
 *           Approximate: it proposes directions and describes contacts, it decides
 *           nothing.
 * Threads:  [any].
 */
#ifndef ENG_CLOSEST_H
#define ENG_CLOSEST_H

#include "motion.h"

struct eng_closest {
    double beta, gamma; /* in the domain of the kind */
    double gap[3];      /* p - beta b - gamma c */
};

void eng_closest_to_origin(enum eng_kind kind, const struct eng_pose *pose,
                           struct eng_closest *closest);

#endif
