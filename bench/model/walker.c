/* walker.c - one worker outside a step. */
#include "walker.h"

#include <stdio.h>
#include <stdlib.h>

#include "memory.h"
#include "near_work.h"
#include "paper_work.h"
#include "wide_test.h"
#include "world.h"

void model_must(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "model: no memory for %s\n", what);
        exit(2);
    }
}

void model_walker_init(struct model_walker *walker, struct eng_scene *scene,
                       const struct eng_near_query *near)
{
    walker->settings = (struct eng_step_settings)ENG_STEP_SETTINGS_DEFAULT;
    walker->settings.contact_max = UINT32_MAX;
    walker->settings.near = near;
    walker->scene = scene;
    walker->worker = eng_alloc(1, sizeof *walker->worker);
    model_must(walker->worker != NULL, "a worker");
    eng_worker_init(walker->worker);
    eng_pool_init(&walker->pool);
}

void model_walker_deinit(struct model_walker *walker)
{
    eng_paper_work_free(walker->worker);
    eng_wide_work_free(walker->worker);
    eng_near_work_free(walker->worker);
    eng_worker_deinit(walker->worker);
    eng_free(walker->worker);
    eng_pool_deinit(&walker->pool);
}

struct eng_worker *model_walker_begin(struct model_walker *walker)
{
    walker->scene->step++;
    eng_pool_reset(&walker->pool, 1);
    eng_stop_init(&walker->stop, &walker->settings);
    model_must(eng_paper_work_reserve(walker->worker, walker->scene) == PCCD_OK,
               "a worker's queues");
    eng_worker_begin(walker->worker, walker->scene, &walker->settings, &walker->stop,
                     &walker->pool);
    eng_paper_work_begin(walker->worker);
    if (walker->settings.near) {
        model_must(eng_near_work_reserve(walker->worker) == PCCD_OK, "distances");
        const struct eng_name_range range = eng_near_range(walker->scene);
        eng_near_work_begin(walker->worker, &range);
    }
    walker->worker->thread = 0;
    return walker->worker;
}
