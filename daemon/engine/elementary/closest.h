/* closest.h - finds the nearest points of two features (vertex and face, or two edges) at
 * one moment.
 *
 * Find (beta, gamma) in the domain for which p - beta b - gamma c is shortest. The result
 * is approximate: it proposes directions and describes contacts, and decides nothing.
 */
#ifndef ENG_CLOSEST_H
#define ENG_CLOSEST_H

#include "pose.h"
#include "query.h"

struct eng_closest {
    double beta, gamma; /* in the domain of the kind */
    double gap[3];      /* p - beta b - gamma c */
};

void eng_closest_to_origin(enum pccd_kind kind, const struct eng_pose *pose,
                           struct eng_closest *closest);

#endif
