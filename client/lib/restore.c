/* restore.c - tell another daemon what the last one knew.
 *
 * Everything goes through the slots of the new ring, which are all free. Then the slots
 * of the old one are copied over, and the new memory is mapped where the old one was:
 * pointers that the user has into it stay valid.
 */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

#include "attach.h"
#include "coordinates.h"
#include "link.h"
#include "replica.h"
#include "rpc.h"
#include "step.h"

#define SEGMENTS 64u /* of a step that brings positions back */
#define AT_ONCE  1u  /* deadline_ns: move, and look for nothing */

/* ---- meshes and scenes ------------------------------------------------------------- */

static int restore_meshes(struct cli_pipeline *pipeline, bool destroyed)
{
    int status = 0;

    for (struct registry_mesh *mesh = pipeline->client->registry.meshes;
         status == 0 && mesh != NULL; mesh = mesh->next) {
        if (mesh->is_destroyed == destroyed) {
            status = cli_mesh_send(pipeline, mesh, destroyed ? 0 : mesh->handle,
                                   &mesh->made_handle);
        }
    }
    return status;
}

/* Those that were destroyed while objects were made of them go again. */
static int destroy_again(struct pccd_client *client)
{
    for (struct registry_mesh *mesh = client->registry.meshes; mesh != NULL;
         mesh = mesh->next) {
        struct proto_MESH_DESTROY_request request = {.mesh = mesh->made_handle};
        int status = mesh->is_destroyed
                         ? cli_call_sync(client, PROTO_METHOD_MESH_DESTROY, &request,
                                         NULL, cli_deadline(client, -1))
                         : 0;

        if (status != 0) {
            return status;
        }
    }
    return 0;
}

/* Restore what the objects of a scene may meet. Most have nothing that was ever set. */
static int restore_filters(struct cli_pipeline *pipeline, struct registry_scene *scene)
{
    int status = 0;

    registry_pairs_settle(&scene->pairs);
    for (uint32_t i = 0; status == 0 && i < scene->object_count; i++) {
        const struct registry_object *object = &scene->objects[i];
        struct proto_OBJECT_SET_request set = {
            .scene = scene->handle, .object = object->handle, .what = object->what};

        COMMON_ATTRIBUTES_COPY(&set, &object->attributes);
        set.has_name = object->name != NULL;
        if (set.has_name) {
            (void)snprintf(set.name, sizeof set.name, "%s", object->name);
        }
        if (object->what != 0 || set.has_name) {
            status = cli_pipeline_send(pipeline, PROTO_METHOD_OBJECT_SET, &set,
                                       CLI_SLOT_NONE, NULL);
        }
    }
    for (uint32_t i = 0; status == 0 && i < scene->pairs.count; i++) {
        const struct registry_pair *pair = &scene->pairs.said[i];
        struct proto_SCENE_IGNORE_request ignore = {.scene = scene->handle,
                                                    .a = pair->a,
                                                    .b = pair->b,
                                                    .ignored = pair->ignored,
                                                    .has_clearance = pair->has_clearance,
                                                    .clearance = pair->clearance};

        /* Of a scene that is shared, others bring their objects back as they can. */
        if (registry_object(scene, ignore.a) != NULL &&
            registry_object(scene, ignore.b) != NULL) {
            status = cli_pipeline_send(pipeline, PROTO_METHOD_SCENE_IGNORE, &ignore,
                                       CLI_SLOT_NONE, NULL);
        }
    }
    return status;
}

static int restore_scene(struct cli_pipeline *pipeline,
                         const struct registry_scene *scene)
{
    const struct registry_settings *settings = &scene->settings;
    struct proto_SCENE_CREATE_request create = {.want = scene->handle,
                                                .share = settings->share,
                                                .rights = settings->rights,
                                                .owner = settings->owner};
    int status;

    static_assert(sizeof create.name == sizeof settings->name, "the whole name");
    memcpy(create.name, settings->name, sizeof create.name);
    status = cli_pipeline_send(pipeline, PROTO_METHOD_SCENE_CREATE, &create,
                               CLI_SLOT_NONE, NULL);
    for (uint32_t i = 0; status == 0 && i < scene->object_count; i++) {
        const struct registry_object *object = &scene->objects[i];
        struct proto_SCENE_ADD_request add = {.scene = scene->handle,
                                              .mesh = object->mesh->made_handle,
                                              .want = object->handle};

        status = cli_pipeline_send(pipeline, PROTO_METHOD_SCENE_ADD, &add, CLI_SLOT_NONE,
                                   NULL);
    }
    return status;
}

/* ---- positions --------------------------------------------------------------------- */

/* A step that brings objects to their places, with the table at the start of its slot and
 * the positions behind. */
struct placing {
    struct cli_pipeline *pipeline;
    const struct registry_scene *scene;
    uint32_t slot; /* CLI_SLOT_NONE: none is begun */
};

static int flush(struct placing *placing)
{
    struct pccd_client *client = placing->pipeline->client;
    /* `place`: the daemon knows by this that nobody stepped here. */
    struct proto_FRAME_SUBMIT_request request = {.scene = placing->scene->handle,
                                                 .slot = placing->slot,
                                                 .mode = PCCD_MODE_ANY,
                                                 .place = true,
                                                 .deadline_ns = AT_ONCE};
    int status;

    if (placing->slot == CLI_SLOT_NONE) {
        return 0;
    }
    request.segments = client->ring.slots[placing->slot].segment_count;
    assert(request.segments > 0 && request.segments <= SEGMENTS);
    request.seq = cli_slot_publish(&client->ring, placing->slot);
    status = cli_pipeline_send(placing->pipeline, PROTO_METHOD_FRAME_SUBMIT, &request,
                               placing->slot, NULL);
    if (status != 0) {
        cli_slot_abort(&client->ring, placing->slot);
    }
    placing->slot = CLI_SLOT_NONE;
    return status;
}

static bool has_room(const struct cli_ring *ring, uint32_t slot, size_t bytes)
{
    return ring->slots[slot].segment_count < SEGMENTS &&
           ring->slots[slot].used_bytes + bytes <= ring->slot_stride;
}

/* Add a segment whose both ends are the `bytes` at `source`. */
static int add(struct placing *placing, struct proto_segment segment, const void *source,
               size_t bytes)
{
    struct cli_ring *ring = &placing->pipeline->client->ring;
    struct cli_slot *own;
    uint8_t *payload;
    int status = 0;

    if (placing->slot != CLI_SLOT_NONE && !has_room(ring, placing->slot, bytes)) {
        status = flush(placing);
    }
    if (status == 0 && placing->slot == CLI_SLOT_NONE) {
        status =
            cli_slot_begin(placing->pipeline->client,
                           cli_deadline(placing->pipeline->client, -1), &placing->slot);
    }
    if (status != 0) {
        return status;
    }
    own = &ring->slots[placing->slot];
    if (own->segment_count == 0) {
        own->used_bytes = SEGMENTS * sizeof segment;
    }
    payload = cli_slot_payload(ring, placing->slot);
    segment.offset0 = segment.offset1 = own->used_bytes;
    memcpy(payload + own->segment_count++ * sizeof segment, &segment, sizeof segment);
    memcpy(payload + own->used_bytes, source, bytes);
    own->used_bytes += cli_round_up(bytes, CLI_RANGE_ALIGN);
    return 0;
}

static int add_vertices(struct placing *placing, const struct registry_object *object)
{
    const size_t vertex_bytes = common_vertex_bytes(object->format);
    const uint64_t room = placing->pipeline->client->ring.slot_stride -
                          SEGMENTS * sizeof(struct proto_segment);
    const uint32_t vertex_count = object->mesh->vertex_count;
    const uint32_t most = room / vertex_bytes < vertex_count
                              ? (uint32_t)(room / vertex_bytes)
                              : vertex_count;
    int status = 0;

    for (uint32_t first = 0; status == 0 && first < vertex_count; first += most) {
        struct proto_segment segment = {
            .object = object->handle,
            .kind = PROTO_SEGMENT_X0X1,
            .format = (uint16_t)object->format,
            .first = first,
            .count = vertex_count - first < most ? vertex_count - first : most};

        status = add(placing, segment, (const uint8_t *)object->x + first * vertex_bytes,
                     segment.count * vertex_bytes);
    }
    return status;
}

static int restore_positions(struct cli_pipeline *pipeline,
                             const struct registry_scene *scene)
{
    struct placing placing = {
        .pipeline = pipeline, .scene = scene, .slot = CLI_SLOT_NONE};
    int status = 0;

    for (uint32_t i = 0; status == 0 && i < scene->object_count; i++) {
        const struct registry_object *object = &scene->objects[i];

        if (object->placing == REGISTRY_RIGID) {
            struct proto_segment segment = {.object = object->handle,
                                            .kind = PROTO_SEGMENT_RIGID,
                                            .format = PCCD_FORMAT_F64,
                                            .count = object->mesh->vertex_count};

            status = add(&placing, segment, object->m, sizeof object->m);
        } else if (object->placing == REGISTRY_FREELY) {
            status = add_vertices(&placing, object);
        }
    }
    return status != 0 ? status : flush(&placing);
}

/* ---- the ring ---------------------------------------------------------------------- */

/* Bring the slots of `old` over, and the new memory to where its was. */
static int carry_over(struct pccd_client *client, struct cli_ring *old)
{
    struct cli_ring *ring = &client->ring;
    struct proto_upload *fresh = ring->upload.base;
    const uint8_t *from = old->upload.base;
    void *moved;

    if (ring->upload.bytes != old->upload.bytes ||
        ring->slot_stride != old->slot_stride || ring->slot_count != old->slot_count) {
        return cli_fail(client, PCCD_E_BADMSG, "shm.attach: another ring than before");
    }
    for (uint32_t i = 0; i < ring->slot_count; i++) {
        size_t offset = sizeof(struct proto_upload) + i * ring->slot_stride;

        if (old->slots[i].state != CLI_SLOT_FREE) {
            int status = cli_slot_take(client, i, cli_deadline(client, -1));

            if (status != 0) {
                return status;
            }
            memcpy((uint8_t *)ring->upload.base + offset, from + offset,
                   old->slots[i].used_bytes);
        }
        atomic_store_explicit(&fresh->slots[i].seq, old->slots[i].seq,
                              memory_order_release);
    }
    /* Nothing else can take the place of the old mapping in between. */
    moved = mremap(ring->upload.base, ring->upload.bytes, ring->upload.bytes,
                   MREMAP_MAYMOVE | MREMAP_FIXED, old->upload.base);
    if (moved == MAP_FAILED) {
        return cli_fail(client, PCCD_E_SYSTEM, "mremap: %s", strerror(errno));
    }
    ring->upload.base = moved;
    old->upload.base = NULL;
    cli_page_retire(client, &old->result);
    memcpy(ring->slots, old->slots, sizeof ring->slots);
    memset(old->slots, 0, sizeof old->slots);
    cli_ring_deinit(old); /* its descriptor */
    return 0;
}

/* No answer is waited for that nothing depends on: a thousand clients of a daemon that
 * has crashed wait for each round trip of each other. */
static int restore_all(struct pccd_client *client)
{
    struct cli_pipeline pipeline = {.client = client,
                                    .is_careful = client->link.tries > 1};
    int status = restore_meshes(&pipeline, false);

    status = status != 0 ? status : restore_meshes(&pipeline, true);
    for (struct registry_scene *scene = client->registry.scenes;
         status == 0 && scene != NULL; scene = scene->next) {
        status = restore_scene(&pipeline, scene);
        status = status != 0 ? status : restore_filters(&pipeline, scene);
        status = status != 0 ? status : restore_positions(&pipeline, scene);
    }
    status = cli_pipeline_end(&pipeline, status);
    return status != 0 ? status : destroy_again(client);
}

int cli_restore(struct pccd_client *client)
{
    uint64_t begin_ns = common_now_ns();
    struct cli_ring old;
    int status = cli_positions_fold_all(client); /* what only the old memory holds */

    if (status != 0) {
        return status;
    }
    assert(client->link.is_recovering && client->keeps);
    old = client->ring;
    memset(&client->ring, 0, sizeof client->ring);
    client->ring.upload = client->ring.result = (struct proto_memory)PROTO_MEMORY_NONE;
    if (old.upload.base != NULL) {
        status = cli_ring_attach(client, old.slot_stride, old.slot_count, old.slot_count,
                                 cli_deadline(client, -1));
    } else if (client->registry.meshes != NULL) {
        status = cli_ring_reserve(client, PROTO_SLOT_BYTES_MIN, cli_deadline(client, -1));
    }
    status = status != 0 ? status : restore_all(client);
    if (status == 0 && old.upload.base != NULL) {
        status = carry_over(client, &old);
    }
    if (status != 0) {
        cli_ring_deinit(&client->ring);
        client->ring = old;
        return status;
    }
    client->link.info.restore_ns = common_now_ns() - begin_ns;
    return 0;
}
