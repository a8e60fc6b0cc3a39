/* sweep_draw.h - a picture of what came of a sweep. */
#ifndef CTL_SWEEP_DRAW_H
#define CTL_SWEEP_DRAW_H

#include "picture.h"
#include "sweep.h"

/* Worth of a picture, the last one most. */
enum sweep_worth {
    SWEEP_WORTH_NONE,
    SWEEP_WORTH_FREE,
    SWEEP_WORTH_LEAST,
    SWEEP_WORTH_GAP,
    SWEEP_WORTH_JAM
};

/* A configuration to be drawn; {0}: where the mechanism starts. */
struct sweep_scene {
    enum sweep_worth worth;
    struct sweep_range range;
    struct sweep_jam at; /* the same shape twice: whatever is nearest there */
    double least;        /* of SWEEP_WORTH_LEAST */
};

/* Take the configuration of an answer if it is worth more than what there is: a jam, a
 * part that stays undecided, the least distance, the middle of the range. Of several the
 * first, or the least distance of all. */
void sweep_scene_take(struct sweep_scene *scene, const struct sweep_range *range,
                      const struct sweep_answer *answer);

/* Draw all parts there, in colour the two that meet or are nearest, and the place; paler
 * behind them what moves, at values over the range of the first joint. Joints that are
 * not of the range are at `values`. Errors: those of sweep_nearest and picture_write. */
int sweep_draw(struct sweep *sweep, const struct sweep_scene *scene, const double *values,
               FILE *file, const char *path);

#endif
