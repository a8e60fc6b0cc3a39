/* stage.h - makes the staged positions those of the step that begins. */
#ifndef ENG_STAGE_H
#define ENG_STAGE_H

#include "world.h"

/* Close the staging (if none is open: an empty one) and move the scene on: x[1 - now] is
 * then t = 0 and x[now] t = 1. PCCD_E_SEGMENT: two writes to one vertex; the scene stands
 * where it stood and the staging is gone. */
int eng_stage_commit(struct eng_scene *scene);

#endif
