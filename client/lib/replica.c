/* replica.c - what another daemon would have to be told. */
#include "replica.h"

#include <assert.h>
#include <string.h>

#include "joints.h"
#include "registry.h"
#include "rounding.h"

/* Drop the replica: what is incomplete is of no use. */
static void keep_nothing(struct pccd_client *client)
{
    client->keeps = false;
}

void cli_replica_mesh(struct pccd_client *client, uint32_t handle,
                      struct registry_mesh *copy)
{
    assert(client->keeps && copy != NULL);
    if (registry_put_mesh(&client->registry, handle, copy, client->next_step) != 0) {
        keep_nothing(client);
    }
}

static void add_scene(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_SCENE_CREATE_request *asked = &call->params.SCENE_CREATE;
    const struct proto_SCENE_CREATE_result *result = call->result;
    struct registry_settings settings = {
        .share = asked->share, .rights = asked->rights, .owner = asked->owner};

    static_assert(sizeof settings.name == sizeof asked->name, "the whole name");
    memcpy(settings.name, asked->name, sizeof settings.name);
    if (settings.name[0] != '\0' && settings.share == PCCD_SHARE_CREATE) {
        settings.share = PCCD_SHARE_OPEN; /* others may be faster next time */
    }
    if (registry_scene(&client->registry, result->scene) == NULL &&
        registry_add_scene(&client->registry, result->scene, &settings) == NULL) {
        keep_nothing(client);
    }
}

static void remove_scene(struct pccd_client *client, uint32_t handle)
{
    struct registry_scene *scene = registry_scene(&client->registry, handle);

    if (scene != NULL) {
        registry_remove_scene(&client->registry, scene);
    }
}

static void add_object(struct pccd_client *client, const struct cli_call *call)
{
    const struct proto_SCENE_ADD_request *asked = &call->params.SCENE_ADD;
    const struct proto_SCENE_ADD_result *result = call->result;
    struct registry_scene *scene = registry_scene(&client->registry, asked->scene);
    struct registry_mesh *mesh = registry_mesh(&client->registry, asked->mesh);

    if (scene != NULL && registry_object(scene, result->object) != NULL) {
        return; /* said once more */
    }
    if (scene == NULL || mesh == NULL ||
        registry_add_object(scene, mesh, result->object, client->next_step) == NULL) {
        keep_nothing(client);
    }
}

/* NULL: it is not known. */
static struct registry_object *find_object(struct pccd_client *client, uint32_t in,
                                           uint32_t handle, struct registry_scene **scene)
{
    *scene = registry_scene(&client->registry, in);
    return *scene != NULL ? registry_object(*scene, handle) : NULL;
}

static void remove_object(struct pccd_client *client,
                          const struct proto_SCENE_REMOVE_request *asked)
{
    struct registry_scene *scene;
    struct registry_object *object =
        find_object(client, asked->scene, asked->object, &scene);

    if (object != NULL) {
        registry_remove_object(&client->registry, scene, object);
    }
}

static void set_object(struct pccd_client *client,
                       const struct proto_OBJECT_SET_request *set)
{
    struct registry_scene *scene;
    struct registry_object *object = find_object(client, set->scene, set->object, &scene);

    if (object != NULL) {
        struct common_attributes given;

        COMMON_ATTRIBUTES_COPY(&given, set);
        registry_set_object(object, set->what, &given);
        if (set->has_name &&
            registry_name_object(object, set->name, strlen(set->name)) != 0) {
            keep_nothing(client);
        }
    }
}

static void set_pair(struct pccd_client *client,
                     const struct proto_SCENE_IGNORE_request *pair)
{
    struct registry_scene *scene = registry_scene(&client->registry, pair->scene);
    const struct registry_pair said = {.a = pair->a,
                                       .b = pair->b,
                                       .ignored = pair->ignored,
                                       .has_clearance = pair->has_clearance,
                                       .clearance = pair->clearance};

    if (scene != NULL && registry_pairs_note(&scene->pairs, &said) != 0) {
        keep_nothing(client);
    }
}

static void destroy_mesh(struct pccd_client *client, uint32_t handle)
{
    struct registry_mesh *mesh = registry_mesh(&client->registry, handle);

    if (mesh != NULL) {
        registry_destroy_mesh(&client->registry, mesh);
    }
}

void cli_replica_answer(struct pccd_client *client, struct cli_call *call)
{
    client->has_made = client->has_made || call->method == PROTO_METHOD_SCENE_CREATE ||
                       call->method == PROTO_METHOD_MESH_COMMIT;
    if (!client->keeps) {
        return;
    }
    switch (call->method) {
    case PROTO_METHOD_SCENE_CREATE:
        if (call->result != NULL) { /* else nobody knows its handle */
            add_scene(client, call);
        }
        break;
    case PROTO_METHOD_SCENE_DESTROY:
        remove_scene(client, call->params.SCENE_DESTROY.scene);
        break;
    case PROTO_METHOD_SCENE_ADD:
        if (call->result != NULL) {
            add_object(client, call);
        }
        break;
    case PROTO_METHOD_SCENE_REMOVE:
        remove_object(client, &call->params.SCENE_REMOVE);
        break;
    case PROTO_METHOD_OBJECT_SET:
        set_object(client, &call->params.OBJECT_SET);
        break;
    case PROTO_METHOD_SCENE_IGNORE:
        set_pair(client, &call->params.SCENE_IGNORE);
        break;
    case PROTO_METHOD_MESH_DESTROY:
        destroy_mesh(client, call->params.MESH_DESTROY.mesh);
        break;
    default:
        break;
    }
}

void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request)
{
    /* Without memory for it, its further pages are refused as those of a step. There is
     * no scene 0, whatever a daemon says of it. */
    if (request->scene != 0) {
        (void)registry_map_put(&client->nears, request->scene, request->step);
    }
}

void cli_near_forget(struct pccd_client *client, uint32_t scene)
{
    registry_map_remove(&client->nears, scene);
}

bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step)
{
    uint64_t last = 0;

    return step != 0 && registry_map_get(&client->nears, scene, &last) && last == step;
}

/* ---- positions --------------------------------------------------------------------- */

/* Return the first vertex that a segment moves. */
static uint32_t first_of(const struct proto_segment *segment)
{
    return segment->kind == PROTO_SEGMENT_TURNING ? 0 : segment->first;
}

/* Place what a segment brings an object; `payload` is of its slot. A body that turned is
 * where a transform would have brought it. */
static int place(struct registry_object *object, const struct proto_segment *segment,
                 const uint8_t *payload)
{
    bool turns = segment->kind == PROTO_SEGMENT_TURNING;
    struct registry_motion motion = {.is_rigid =
                                         turns || segment->kind == PROTO_SEGMENT_RIGID,
                                     .format = segment->format,
                                     .first = first_of(segment),
                                     .count = segment->count,
                                     .end = payload + segment->offset1};
    double m[12];

    if (turns) {
        COMMON_ROUNDING_HERE;
        common_joint_transform(payload + segment->offset0 + sizeof(struct proto_joints),
                               segment->first, 1, m);
        motion.end = m;
    }
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
        first_of(segment) + (uint64_t)segment->count > object->mesh->vertex_count) {
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
    return first_of(segment) == 0 && segment->count == object->mesh->vertex_count;
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
