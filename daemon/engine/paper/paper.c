/* paper.c - what the method `paper` keeps of a scene. */
#include "paper.h"

#include <assert.h>

#include "memory.h"

static int create(struct eng_scene *scene)
{
    assert(!scene->slots[ENG_SLOT_PAPER]);
    struct eng_paper *paper = eng_alloc(1, sizeof *paper);
    if (!paper) {
        return PCCD_E_NOMEM;
    }
    eng_trees_init(&paper->trees);
    paper->plan = (struct eng_refit_plan){0};
    eng_assignment_init(&paper->assignment);
    eng_background_init(&paper->background);
    scene->slots[ENG_SLOT_PAPER] = paper;
    return PCCD_OK;
}

static void destroy(struct eng_scene *scene)
{
    struct eng_paper *paper = eng_paper_of(scene);
    if (paper) {
        eng_trees_deinit(&paper->trees);
        eng_refit_plan_deinit(&paper->plan);
        eng_assignment_deinit(&paper->assignment);
        eng_background_deinit(&paper->background);
        eng_free(paper);
        scene->slots[ENG_SLOT_PAPER] = NULL;
    }
}

static uint64_t bytes(const struct eng_scene *scene)
{
    const struct eng_paper *paper = eng_paper_of(scene);
    uint64_t planted = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        planted += scene->objects[i].mesh && scene->objects[i].slots[ENG_SLOT_PAPER]
                       ? sizeof(struct eng_paper_object)
                       : 0;
    }
    return sizeof *paper + planted + eng_trees_bytes(&paper->trees) +
           eng_refit_plan_bytes(&paper->plan) + eng_background_bytes(&paper->background);
}

static void drop(struct eng_scene *scene, struct eng_object *object)
{
    eng_background_forget(&eng_paper_of(scene)->background,
                          eng_paper_object_of(object)->nodes);
    eng_paper_drop_object(scene, object);
}

static void changed(struct eng_scene *scene)
{
    eng_trees_of(scene)->top_is_stale = true;
}

const struct eng_slot_calls eng_paper_slot = {.create = create,
                                              .destroy = destroy,
                                              .bytes = bytes,
                                              .drop = drop,
                                              .changed = changed};
