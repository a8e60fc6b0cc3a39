/* positions.c - where the objects are that another daemon would have to be told of.
 *
 * Room:     client/lib. May include: positions.h, client/registry.
 * Does:     the segments of answered steps, in the order of the steps, into the client's
 *           registry.
 * Does not: read anything of a slot but ranges that were handed out: lengths come from
 *           the library's own copy of the segment table.
 * Threads:  [owner].
 */
#include "positions.h"

#include <assert.h>

#include "registry_positions.h"

/* What a segment brings an object; `payload` is of its slot. */
static int place(struct registry_object *object, const struct proto_segment *segment,
                 const uint8_t *payload)
{
    const struct registry_motion motion = {.is_rigid =
                                               segment->kind == PROTO_SEGMENT_RIGID,
                                           .format = segment->format,
                                           .first = segment->first,
                                           .count = segment->count,
                                           .end = payload + segment->offset1};

    return registry_place(object, &motion);
}

/* The object of a segment of an answered step that no later step has overwritten. */
static struct registry_object *find_current(struct registry_scene *scene,
                                            const struct cli_slot *own, uint32_t at)
{
    const struct proto_segment *segment = &own->segments[at];
    struct registry_object *object =
        scene != NULL ? registry_object(scene, segment->object) : NULL;

    if (object == NULL || own->step < object->since ||
        segment->first + (uint64_t)segment->count > object->mesh->vertex_count) {
        return NULL;
    }
    return object;
}

static bool is_superseded(struct pccd_client *client, const struct cli_slot *own)
{
    struct registry_scene *scene = registry_scene(&client->registry, own->scene);

    for (uint32_t i = 0; i < own->segment_count; i++) {
        if (find_current(scene, own, i) != NULL) {
            return false;
        }
    }
    return true;
}

static bool is_whole(const struct registry_object *object,
                     const struct proto_segment *segment)
{
    return segment->first == 0 && segment->count == object->mesh->vertex_count;
}

void cli_positions_answered(struct pccd_client *client, uint32_t slot, uint64_t step)
{
    struct cli_slot *own = &client->ring.slots[slot];
    struct registry_scene *scene = registry_scene(&client->registry, own->scene);

    if (scene == NULL) {
        return;
    }
    assert(own->state == CLI_SLOT_FREE && step > 0);
    own->step = step;
    own->state = CLI_SLOT_KEPT;
    for (uint32_t i = 0; i < own->segment_count; i++) {
        struct registry_object *object = find_current(scene, own, i);

        if (object != NULL && is_whole(object, &own->segments[i])) {
            object->since = step;
        }
    }
    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        struct cli_slot *other = &client->ring.slots[i];

        if (other->state == CLI_SLOT_KEPT && is_superseded(client, other)) {
            other->state = CLI_SLOT_FREE;
            cli_slot_offer(&client->ring, i);
        }
    }
}

int cli_positions_fold(struct pccd_client *client, uint32_t slot)
{
    struct cli_slot *own = &client->ring.slots[slot];
    struct registry_scene *scene = registry_scene(&client->registry, own->scene);

    assert(own->state == CLI_SLOT_KEPT);
    for (uint32_t i = 0; i < own->segment_count; i++) {
        struct registry_object *object = find_current(scene, own, i);
        int status = object == NULL ? 0
                                    : place(object, &own->segments[i],
                                            cli_slot_payload(&client->ring, slot));

        if (status != 0) {
            return cli_fail(client, status,
                            "no memory to keep the positions of object 0x%x",
                            own->segments[i].object);
        }
    }
    own->state = CLI_SLOT_FREE;
    cli_slot_offer(&client->ring, slot);
    return 0;
}

int cli_positions_fold_all(struct pccd_client *client)
{
    uint32_t oldest;
    int status = 0;

    while (status == 0 &&
           (oldest = cli_slot_oldest_kept(&client->ring)) != CLI_SLOT_NONE) {
        status = cli_positions_fold(client, oldest);
    }
    return status;
}
