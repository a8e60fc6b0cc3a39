/* positions.c - where the objects are that another daemon would have to be told of. */
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

/* The segments of a slot, one by one, each with its scene. All zero: before the first. */
struct walk {
    uint32_t at;
    uint32_t next;                /* segment */
    uint32_t entry;               /* of a batch: the next of its table of scenes */
    uint32_t end;                 /* of the segments of the scene at hand */
    struct registry_scene *scene; /* NULL: there is none of that handle any more */
};

static bool walk_on(const struct pccd_client *client, const struct cli_slot *own,
                    struct walk *walk)
{
    if (walk->next == own->segment_count) {
        return false;
    }
    walk->at = walk->next++;
    while (walk->at >= walk->end) { /* ends: the scenes have all segments together */
        bool is_batch = own->scene_count > 0;

        assert(!is_batch || walk->entry < own->scene_count);
        walk->end += is_batch ? own->scenes[walk->entry].segments : own->segment_count;
        walk->scene = registry_scene(
            &client->registry, is_batch ? own->scenes[walk->entry].scene : own->scene);
        walk->entry++;
    }
    return true;
}

static bool is_superseded(struct pccd_client *client, const struct cli_slot *own)
{
    struct walk walk = {0};

    while (walk_on(client, own, &walk)) {
        if (find_current(walk.scene, own, walk.at) != NULL) {
            return false;
        }
    }
    return true;
}

void cli_positions_leave_out(struct pccd_client *client, uint32_t slot,
                             const struct pccd_scene_answer *scenes)
{
    struct cli_slot *own = &client->ring.slots[slot];
    uint32_t at = 0;

    for (uint32_t i = 0; i < own->scene_count; i++) {
        for (uint32_t end = at + own->scenes[i].segments; at < end; at++) {
            if (scenes[i].status != 0) {
                own->segments[at].object = 0; /* no object has this handle */
            }
        }
    }
}

static bool is_whole(const struct registry_object *object,
                     const struct proto_segment *segment)
{
    return segment->first == 0 && segment->count == object->mesh->vertex_count;
}

void cli_positions_answered(struct pccd_client *client, uint32_t slot, uint64_t step)
{
    struct cli_slot *own = &client->ring.slots[slot];
    struct walk walk = {0};

    assert(own->state == CLI_SLOT_FREE && step > 0);
    own->step = step;
    own->state = CLI_SLOT_KEPT;
    while (walk_on(client, own, &walk)) {
        struct registry_object *object = find_current(walk.scene, own, walk.at);

        if (object != NULL && is_whole(object, &own->segments[walk.at])) {
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
    struct walk walk = {0};

    assert(own->state == CLI_SLOT_KEPT);
    while (walk_on(client, own, &walk)) {
        struct registry_object *object = find_current(walk.scene, own, walk.at);
        int status = object == NULL ? 0
                                    : place(object, &own->segments[walk.at],
                                            cli_slot_payload(&client->ring, slot));

        if (status != 0) {
            return cli_fail(client, status,
                            "no memory to keep the positions of object 0x%x",
                            own->segments[walk.at].object);
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
