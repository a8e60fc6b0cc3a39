/* wide_state.c - what the method `wide` keeps of a scene. */
#include "wide_state.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

static int create(struct eng_scene *scene)
{
    assert(!scene->slots[ENG_SLOT_WIDE]);
    struct eng_wide_state *state = eng_alloc(1, sizeof *state);
    if (!state) {
        return PCCD_E_NOMEM;
    }
    memset(state, 0, sizeof *state);
    eng_wide_init(&state->trees);
    eng_wide_resort_init(&state->resort);
    scene->slots[ENG_SLOT_WIDE] = state;
    return PCCD_OK;
}

static void destroy(struct eng_scene *scene)
{
    struct eng_wide_state *state = eng_wide_state_of(scene);
    if (state) {
        eng_wide_deinit(&state->trees);
        eng_wide_owners_deinit(&state->owners);
        eng_wide_resort_deinit(&state->resort);
        eng_wide_leads_deinit(&state->leads);
        eng_free(state);
        scene->slots[ENG_SLOT_WIDE] = NULL;
    }
}

static uint64_t bytes(const struct eng_scene *scene)
{
    const struct eng_wide_state *state = eng_wide_state_of(scene);
    uint64_t orders = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_wide_object *kept = eng_wide_object_of(&scene->objects[i]);
        if (scene->objects[i].mesh) {
            orders += sizeof *kept + (kept->own ? kept->own->bytes : 0);
        }
    }
    return sizeof *state + orders + eng_wide_bytes(&state->trees) +
           eng_wide_owners_bytes(&state->owners) + eng_wide_resort_bytes(&state->resort) +
           eng_wide_leads_bytes(&state->leads);
}

static int add(struct eng_scene *scene, struct eng_object *object)
{
    assert(object->mesh && !object->slots[ENG_SLOT_WIDE]);
    const struct eng_mesh *mesh = object->mesh;
    struct eng_wide_object *kept = eng_alloc(1, sizeof *kept);
    if (!kept) {
        return PCCD_E_NOMEM;
    }
    *kept = (struct eng_wide_object){.order = mesh->order};
    if (!kept->order) {
        int status = eng_wide_order_new(mesh, (const double(*)[3])mesh->x,
                                        scene->settings.threads, &kept->own);
        if (status != PCCD_OK) {
            eng_free(kept);
            return status;
        }
        kept->order = kept->own;
    }
    object->slots[ENG_SLOT_WIDE] = kept;
    return PCCD_OK;
}

static void drop(struct eng_scene *scene, struct eng_object *object)
{
    (void)scene;
    struct eng_wide_object *kept = eng_wide_object_of(object);
    if (kept) {
        eng_free(kept->own);
        eng_free(kept);
        object->slots[ENG_SLOT_WIDE] = NULL;
    }
}

static void changed(struct eng_scene *scene)
{
    eng_wide_of(scene)->is_stale = true;
}

static void emptied(struct eng_scene *scene)
{
    struct eng_wide_state *state = eng_wide_state_of(scene);
    eng_wide_deinit(&state->trees);
    eng_wide_owners_deinit(&state->owners);
    eng_wide_leads_deinit(&state->leads);
    memset(&state->trees, 0, sizeof state->trees);
    memset(&state->owners, 0, sizeof state->owners);
    eng_wide_init(&state->trees);
}

const struct eng_slot_calls eng_wide_slot = {.create = create,
                                             .destroy = destroy,
                                             .bytes = bytes,
                                             .add = add,
                                             .drop = drop,
                                             .changed = changed,
                                             .emptied = emptied};
