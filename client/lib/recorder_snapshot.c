/* recorder_snapshot.c - how a segment of a recording begins. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "coordinates.h"
#include "payload.h"
#include "recorder.h"
#include "recorder_shared.h"
#include "replica.h"
#include "rpc.h"

static int write_begin(struct pccd_client *client)
{
    const struct cli_recorder *recorder = client->recorder;
    struct record_begin begin = {.pid = (uint32_t)client->owner,
                                 .daemon_pid = client->pid,
                                 .segment = recorder->segment,
                                 .flags =
                                     (recorder->has_records ? RECORD_HAS_RECORDS : 0u) |
                                     recorder->up << RECORD_UP_SHIFT};
    struct timespec now;

    (void)clock_gettime(CLOCK_REALTIME, &now);
    begin.unix_ns = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
    (void)snprintf(begin.library, sizeof begin.library, "%.15s", pccd_version());
    (void)snprintf(begin.cpu, sizeof begin.cpu, "%.15s", client->cpu);
    return cli_record_add(client, RECORD_BEGIN,
                          &(struct record_part){&begin, sizeof begin}, 1);
}

static int write_scene(struct pccd_client *client, const struct registry_scene *kept)
{
    struct record_scene scene = {.scene = kept->handle};

    return cli_record_add(client, RECORD_SCENE,
                          &(struct record_part){&scene, sizeof scene}, 1);
}

static int write_meshes(struct pccd_client *client)
{
    int status = 0;

    for (const struct registry_mesh *mesh = client->registry.meshes;
         mesh != NULL && status == 0; mesh = mesh->next) {
        const struct registry_shape shape = registry_mesh_shape(mesh);

        status = cli_record_put_shape(client, &(struct record_mesh){.mesh = mesh->handle},
                                      &shape, cli_record_add);
    }
    return status;
}

/* Meshes that are gone, but for the objects made of them. */
static int write_gone(struct pccd_client *client)
{
    int status = 0;

    for (const struct registry_mesh *mesh = client->registry.meshes;
         status == 0 && mesh != NULL; mesh = mesh->next) {
        struct record_gone gone = {.mesh = mesh->handle};

        status = mesh->is_destroyed
                     ? cli_record_add(client, RECORD_MESH_GONE,
                                      &(struct record_part){&gone, sizeof gone}, 1)
                     : 0;
    }
    return status;
}

static int write_place(struct pccd_client *client, const struct registry_scene *scene,
                       const struct registry_object *kept)
{
    struct record_place place = {.scene = scene->handle, .object = kept->handle};
    struct record_part parts[2] = {{&place, sizeof place}};

    if (kept->placing == REGISTRY_AS_REGISTERED) {
        return 0;
    }
    if (kept->placing == REGISTRY_RIGID) {
        place.placing = RECORD_PLACED_RIGID;
        place.format = PCCD_FORMAT_F64;
        parts[1] = (struct record_part){kept->m, sizeof kept->m};
    } else {
        place.placing = RECORD_PLACED_FREELY;
        place.format = kept->format;
        parts[1] = (struct record_part){kept->x, kept->mesh->vertex_count *
                                                     common_vertex_bytes(kept->format)};
    }
    return cli_record_add(client, RECORD_PLACE, parts, 2);
}

static int write_filter(struct pccd_client *client, const struct registry_scene *scene,
                        const struct registry_object *kept)
{
    struct record_filter filter;

    record_filter_make(&filter, scene->handle, kept->handle, kept->what,
                       &kept->attributes);
    return kept->what == 0
               ? 0
               : cli_record_add(client, RECORD_FILTER,
                                &(struct record_part){&filter, sizeof filter}, 1);
}

/* Write what an object is called, if anything. */
static int write_name(struct pccd_client *client, const struct registry_scene *scene,
                      const struct registry_object *kept)
{
    return kept->name == NULL ? 0
                              : cli_record_put_name(client, scene->handle, kept->handle,
                                                    kept->name, cli_record_add);
}

static int write_object(struct pccd_client *client, const struct registry_scene *scene,
                        const struct registry_object *kept)
{
    const struct record_object object = {
        .scene = scene->handle, .mesh = kept->mesh->handle, .object = kept->handle};
    int status = cli_record_add(client, RECORD_OBJECT,
                                &(struct record_part){&object, sizeof object}, 1);

    status = status != 0 ? status : write_place(client, scene, kept);
    status = status != 0 ? status : write_filter(client, scene, kept);
    return status != 0 ? status : write_name(client, scene, kept);
}

/* Those of its objects that ignore each other, or have a clearance. */
static int write_pairs(struct pccd_client *client, struct registry_scene *scene)
{
    struct record_pairs head = {.scene = scene->handle};
    struct record_part parts[2] = {{&head, sizeof head}};
    struct record_pair *pairs;
    int status;

    registry_pairs_settle(&scene->pairs);
    if (scene->pairs.count == 0) {
        return 0;
    }
    pairs = calloc(scene->pairs.count, sizeof *pairs);
    if (pairs == NULL) {
        return cli_record_stop_because(client, PCCD_E_NOMEM, "no memory for pairs");
    }
    for (; head.count < scene->pairs.count; head.count++) {
        const struct registry_pair *pair = &scene->pairs.said[head.count];

        pairs[head.count] = (struct record_pair){
            .a = pair->a,
            .b = pair->b,
            .said = pair->has_clearance ? RECORD_CLEARANCE : RECORD_IGNORED,
            .clearance = pair->clearance};
    }
    parts[1] = (struct record_part){pairs, head.count * sizeof *pairs};
    status = cli_record_add(client, RECORD_PAIRS, parts, 2);
    free(pairs);
    return status;
}

/* Its journal says what is in it. */
static bool is_shared(const struct registry_scene *scene)
{
    return scene->settings.name[0] != '\0';
}

static int begin_journals(struct pccd_client *client)
{
    int status = 0;

    for (const struct registry_scene *scene = client->registry.scenes;
         status == 0 && scene != NULL; scene = scene->next) {
        status = is_shared(scene) ? cli_journal_begin(client, scene->handle) : 0;
    }
    return status;
}

static int write_scenes(struct pccd_client *client)
{
    int status = 0;

    for (struct registry_scene *scene = client->registry.scenes;
         status == 0 && scene != NULL; scene = scene->next) {
        status = write_scene(client, scene);
        for (uint32_t i = 0; status == 0 && !is_shared(scene) && i < scene->object_count;
             i++) {
            status = write_object(client, scene, &scene->objects[i]);
        }
        status = status != 0 || is_shared(scene) ? status : write_pairs(client, scene);
    }
    return status;
}

/* The segments of a scene of a batch, with offsets as in a slot of its own, and where its
 * positions lie. */
static struct record_part rebase(const struct pccd_client *client,
                                 const struct cli_call *call,
                                 const struct proto_segment *from, uint32_t count,
                                 struct proto_segment *table)
{
    const struct cli_slot *own = &client->ring.slots[call->slot];
    const struct proto_segment *behind = from + count;
    uint64_t table_bytes = count * sizeof *table;
    uint64_t first = from->kind == PROTO_SEGMENT_X1 ? from->offset1 : from->offset0;
    uint64_t end = behind == own->segments + own->segment_count ? own->used_bytes
                   : behind->kind == PROTO_SEGMENT_X1           ? behind->offset1
                                                                : behind->offset0;

    for (uint32_t i = 0; i < count; i++) {
        table[i] = from[i];
        if (from[i].kind != PROTO_SEGMENT_TURNING) {
            table[i].offset1 = from[i].offset1 - first + table_bytes;
        }
        if (from[i].kind != PROTO_SEGMENT_X1) {
            table[i].offset0 = from[i].offset0 - first + table_bytes;
        }
    }
    return (struct record_part){cli_slot_payload(&client->ring, call->slot) + first,
                                end - first};
}

/* One scene of a batch: a step as any other. `table`: room for its segments. */
static int write_scene_frame(struct pccd_client *client, const struct cli_call *call,
                             uint32_t scene, uint32_t first, struct proto_segment *table)
{
    const struct proto_BATCH_SUBMIT_request *batch = &call->params.BATCH_SUBMIT;
    const struct cli_slot *own = &client->ring.slots[call->slot];
    uint32_t count = own->scenes[scene].segments;
    union cli_params params = {.FRAME_SUBMIT = {.scene = own->scenes[scene].scene,
                                                .segments = count,
                                                .mode = batch->mode,
                                                .method = batch->method,
                                                .threads = batch->threads,
                                                .tolerance = batch->tolerance,
                                                .deadline_ns = batch->deadline_ns,
                                                .step = batch->step + scene,
                                                .separation = batch->separation,
                                                .approach = batch->approach,
                                                .touching = batch->touching,
                                                .resolution = batch->resolution}};
    struct record_part moved[2] = {{table, count * sizeof *table}, {NULL, 0}};

    static_assert(sizeof params.FRAME_SUBMIT.tuning == sizeof batch->tuning, "a text");
    memcpy(params.FRAME_SUBMIT.tuning, batch->tuning, sizeof batch->tuning);
    if (count > 0) {
        moved[1] = rebase(client, call, own->segments + first, count, table);
    }
    return cli_record_motion(client, PROTO_METHOD_FRAME_SUBMIT, &params, moved);
}

/* A batch: the steps of its scenes, one after the other, but for those whose journal says
 * when it was their turn. */
static int write_batch(struct pccd_client *client, const struct cli_call *call)
{
    const struct cli_slot *own = &client->ring.slots[call->slot];
    struct proto_segment *table = malloc((own->segment_count + 1) * sizeof *table);
    uint32_t first = 0;
    int status = 0;

    assert(own->scene_count == call->params.BATCH_SUBMIT.scenes);
    if (table == NULL) {
        return cli_record_stop_because(client, PCCD_E_NOMEM, "no memory for a batch");
    }
    for (uint32_t i = 0; status == 0 && i < own->scene_count; i++) {
        if (!cli_journal_has(client, own->scenes[i].scene)) {
            status = write_scene_frame(client, call, i, first, table);
        }
        first += own->scenes[i].segments;
    }
    free(table);
    return status;
}

int cli_record_step(struct pccd_client *client, const struct cli_call *call)
{
    bool is_near = call->method == PROTO_METHOD_SCENE_NEAR;
    uint32_t scene =
        is_near ? call->params.SCENE_NEAR.scene : call->params.FRAME_SUBMIT.scene;
    uint32_t segments =
        is_near ? call->params.SCENE_NEAR.segments : call->params.FRAME_SUBMIT.segments;
    struct record_part moved[2] = {{NULL, 0}, {NULL, 0}};

    assert(cli_call_is_step(call->method) && call->step != 0);
    if (call->method == PROTO_METHOD_BATCH_SUBMIT) {
        return write_batch(client, call);
    }
    if (cli_journal_has(client, scene)) {
        return 0; /* the journal says when it was its turn */
    }
    if (call->slot != CLI_SLOT_NONE && segments > 0) {
        moved[0] = (struct record_part){cli_slot_payload(&client->ring, call->slot),
                                        client->ring.slots[call->slot].used_bytes};
    }
    return cli_record_motion(client, call->method, &call->params, moved);
}

/* Steps that are not in what is kept yet, in the order of their sending. */
static int write_unanswered(struct pccd_client *client)
{
    uint64_t after = 0;
    int status = 0;

    for (;;) {
        const struct cli_call *next = NULL;

        for (uint32_t i = 0; i < client->calls_end; i++) {
            const struct cli_call *call = &client->calls[i];

            if (cli_call_is_sent(call) && cli_call_is_step(call->method) &&
                !call->recovery && call->serial > after &&
                (next == NULL || call->serial < next->serial)) {
                next = call;
            }
        }
        if (next == NULL || status != 0) {
            return status;
        }
        after = next->serial;
        status = cli_record_step(client, next);
    }
}

int cli_record_snapshot(struct pccd_client *client)
{
    int status = cli_positions_fold_all(client);

    assert(client->keeps);
    assert(status != 0 || cli_slot_oldest_kept(&client->ring) == CLI_SLOT_NONE);
    client->recorder->is_beginning = true;
    status = status != 0 ? status : write_begin(client);
    status = status != 0 ? status : write_meshes(client);
    status = status != 0 ? status : write_scenes(client);
    status = status != 0 ? status : write_gone(client);
    client->recorder->is_beginning = false;
    status = status != 0 ? status : begin_journals(client);
    return status != 0 ? status : write_unanswered(client);
}
