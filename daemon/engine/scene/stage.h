/* stage.h - makes the staged positions those of the step that begins. */
#ifndef ENG_STAGE_H
#define ENG_STAGE_H

#include "world.h"

/* Close the staging (if none is open: an empty one) and move the scene on: x[1 - now] is
 * then t = 0 and x[now] t = 1. PCCD_E_SEGMENT: two writes to one vertex; the scene stands
 * where it stood and the staging is gone. */
int eng_stage_commit(struct eng_scene *scene);

/* Between enter and leave the step that the scene has moved on by is that part of it:
 * x[1 - now] and x[now] are where its vertices are at span[0] and span[1], which is x0 +
 * t (x1 - x0), each operation rounded to the nearest double, and not beyond x0 and x1; x1
 * itself at 1. So two parts that follow each other share their positions. Boxes, and
 * records of what stands, are of no step before or behind it. PCCD_E_NOMEM: reserve. */
int eng_part_reserve(struct eng_scene *scene);
void eng_part_enter(struct eng_scene *scene, const double span[2]);
void eng_part_leave(struct eng_scene *scene);

#endif
