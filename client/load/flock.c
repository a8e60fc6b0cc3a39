/* flock.c - a client that steps many scenes by one request. */
#include "actor.h"

#include <math.h>
#include <stdlib.h>

/* Another scene, whose objects have the handles of the first one's: so have the records,
 * and the hash. */
static int add_scene(struct load_actor *actor, uint32_t *scene)
{
    uint32_t objects[2] = {actor->floor, actor->sheet};
    const uint32_t meshes[2] = {actor->floor_mesh, actor->sheet_mesh};
    int status = pccd_scene_create(actor->client, NULL, scene);
    for (uint32_t i = 0; i < 2 && status == 0; i++) {
        uint32_t made = 0;
        pccd_request_handle(actor->client, objects[i]);
        status = pccd_scene_add(actor->client, *scene, meshes[i], &made);
    }
    return status;
}

static int make_batch(struct load_actor *actor, struct pccd_batch_part *parts)
{
    uint32_t count = actor->load->settings.batch;
    int status = 0;
    for (uint32_t i = 0; i < count && status == 0; i++) {
        parts[i] = (struct pccd_batch_part){.scene = actor->scene,
                                            .object = actor->sheet,
                                            .count = load_sheet_vertices(&actor->shape),
                                            .format = PCCD_FORMAT_F64,
                                            .way = PCCD_BATCH_X0X1};
        status = i > 0 ? add_scene(actor, &parts[i].scene) : 0;
    }
    return status == 0 ? pccd_batch_create(actor->client, parts, count, &actor->batch)
                       : status;
}

int load_flock_open(struct load_actor *actor)
{
    uint32_t count = actor->load->settings.batch;
    struct pccd_batch_part *parts = calloc(count, sizeof *parts);
    actor->places = calloc(2 * (size_t)count, sizeof *actor->places);
    int status =
        parts != NULL && actor->places != NULL ? make_batch(actor, parts) : PCCD_E_NOMEM;
    free(parts);
    return status;
}

void load_flock_close(struct load_actor *actor)
{
    pccd_batch_destroy(actor->batch);
    free(actor->places);
    actor->batch = NULL;
    actor->places = NULL;
}

int load_flock_write(struct load_actor *actor, const struct load_pending *pending)
{
    uint32_t count = actor->load->settings.batch;
    void **x0 = actor->places;
    void **x1 = actor->places + count;
    int status = pccd_batch_begin(actor->batch, x0, x1);
    for (uint32_t i = 0; i < count && status == 0; i++) {
        load_sheet_at(&actor->shape, pending->from, PCCD_FORMAT_F64, x0[i]);
        load_sheet_at(&actor->shape, (pending->from + 1) % LOAD_FRAMES, PCCD_FORMAT_F64,
                      x1[i]);
    }
    if (status == 0 && pending->mischief == LOAD_NOT_FINITE) {
        ((double *)x1[count - 1])[7] = NAN;
    }
    return status;
}

int load_flock_take(struct load_actor *actor, bool *moved)
{
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    int status;
    while ((status = pccd_batch_poll(actor->client, &answer)) == 0) {
        load_judge_batch(actor, &answer);
        pccd_batch_release(actor->client, &answer);
        actor->is_blocked = false;
        *moved = true;
    }
    return status == PCCD_E_AGAIN ? 0 : status;
}
