/* walker.h - one worker that performs tasks outside a step, so that they can be timed.
 *
 * Threads: one.
 */
#ifndef MODEL_WALKER_H
#define MODEL_WALKER_H

#include "near_query.h"
#include "step.h"
#include "worker.h"

struct model_walker {
    struct eng_worker *worker;
    struct eng_pool pool;
    struct eng_stop stop;
    struct eng_step_settings settings;
    struct eng_scene *scene;
};

/* `near`: what is looked for in the place of contacts; NULL: contacts are. */
void model_walker_init(struct model_walker *walker, struct eng_scene *scene,
                       const struct eng_near_query *near);
void model_walker_deinit(struct model_walker *walker);

/* Forget what was found; worker and scene are as at the start of a step, so that regions
 * of the tree are looked at anew. */
struct eng_worker *model_walker_begin(struct model_walker *walker);

/* Ends the program with 2 unless `good`: no memory. */
void model_must(bool good, const char *what);

#endif
