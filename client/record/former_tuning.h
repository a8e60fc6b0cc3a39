/* former_tuning.h - translates how earlier recordings say how threads share a step:
 * numbers then, a text today.
 */
#ifndef RECORD_FORMER_TUNING_H
#define RECORD_FORMER_TUNING_H

#include "payload.h"

/* "" where all three numbers are 0, as in every frame that is written now; a number that
 * has never had a meaning counts as 0. */
void record_former_tuning(const struct record_frame *frame, char text[PCCD_TUNING_BYTES]);

#endif
