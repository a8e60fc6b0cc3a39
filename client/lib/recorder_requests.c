/* recorder_requests.c - requests as chunks of a recording, this client's and what others
 * do to a scene that it shares.
 */
#include "recorder.h"

#include <string.h>

#include "coordinates.h"
#include "payload.h"

/* ---- shapes ------------------------------------------------------------------------ */

int cli_record_put_shape(struct pccd_client *client, const struct record_mesh *of,
                         const struct registry_shape *shape, cli_record_fn add)
{
    static const uint8_t zeros[8];
    struct record_mesh head = *of;
    size_t bytes = shape->vertex_count * common_vertex_bytes(shape->format);
    const struct record_part parts[] = {
        {&head, sizeof head},
        {shape->x, bytes},
        {zeros, (8 - bytes % 8) % 8},
        {shape->radii, shape->radii != NULL ? shape->vertex_count * sizeof(double) : 0},
        {shape->triangles, shape->triangle_count * sizeof(uint32_t[3])},
        {shape->edges, shape->edge_count * sizeof(uint32_t[2])},
        {shape->points, shape->point_count * sizeof(uint32_t)}};

    head.format = shape->format;
    head.vertex_count = shape->vertex_count;
    head.triangle_count = shape->triangle_count;
    head.edge_count = shape->edge_count;
    head.point_count = shape->point_count;
    head.has_radii = shape->radii != NULL;
    return add(client, head.mesh != 0 ? RECORD_MESH : RECORD_GUEST, parts,
               sizeof parts / sizeof parts[0]);
}

int cli_record_put_name(struct pccd_client *client, uint32_t scene, uint32_t object,
                        const char *name, cli_record_fn add)
{
    const struct record_name head = {
        .scene = scene, .object = object, .bytes = (uint32_t)strlen(name)};
    const struct record_part parts[] = {{&head, sizeof head}, {name, head.bytes}};

    return add(client, RECORD_NAME, parts, 2);
}

/* ---- movements --------------------------------------------------------------------- */

/* Set what a step and a question both say. */
#define OF_BOTH(request)                                                                 \
    .step = (request)->step, .scene = (request)->scene,                                  \
    .segment_count = (request)->segments, .method = (request)->method,                   \
    .threads = (request)->threads, .deadline_ns = (request)->deadline_ns

static struct record_frame near_of(const struct proto_SCENE_NEAR_request *request)
{
    return (struct record_frame){OF_BOTH(request),
                                 .tells = request->tells_crossings,
                                 .what = request->what,
                                 .end = request->end,
                                 .objects = {request->object_a, request->object_b},
                                 .distance = request->distance,
                                 .gap = request->gap};
}

static struct record_frame frame_of(const struct proto_FRAME_SUBMIT_request *request)
{
    return (struct record_frame){OF_BOTH(request),
                                 .tells = request->tells_start,
                                 .mode = request->mode,
                                 .touching = request->touching,
                                 .tolerance = request->tolerance,
                                 .separation = request->separation,
                                 .approach = request->approach,
                                 .resolution = request->resolution};
}

int cli_record_motion(struct pccd_client *client, int method,
                      const union cli_params *params, const struct record_part moved[2])
{
    bool is_near = method == PROTO_METHOD_SCENE_NEAR;
    const char *tuning =
        is_near ? params->SCENE_NEAR.tuning : params->FRAME_SUBMIT.tuning;
    struct record_frame frame =
        is_near ? near_of(&params->SCENE_NEAR) : frame_of(&params->FRAME_SUBMIT);
    enum record_kind kind = is_near           ? RECORD_NEAR
                            : frame.step != 0 ? RECORD_FRAME
                                              : RECORD_MOVE;
    const struct record_part parts[3] = {{&frame, sizeof frame}, moved[0], moved[1]};

    memcpy(frame.tuning, tuning, strnlen(tuning, sizeof frame.tuning - 1));
    return cli_record_add(client, kind, parts, 3);
}

/* ---- what was made, set or destroyed ----------------------------------------------- */

/* Write what an object may meet, and what it may not; what it is called. */
static int write_settings(struct pccd_client *client,
                          const struct proto_OBJECT_SET_request *set, cli_record_fn add)
{
    struct common_attributes given;
    struct record_filter filter;

    COMMON_ATTRIBUTES_COPY(&given, set);
    record_filter_make(&filter, set->scene, set->object, set->what, &given);
    int status = set->what == 0 /* it was only looked at */
                     ? 0
                     : add(client, RECORD_FILTER,
                           &(struct record_part){&filter, sizeof filter}, 1);
    return status == 0 && set->has_name
               ? cli_record_put_name(client, set->scene, set->object, set->name, add)
               : status;
}

static int write_pair(struct pccd_client *client,
                      const struct proto_SCENE_IGNORE_request *request, cli_record_fn add)
{
    const struct record_pairs head = {.scene = request->scene, .count = 1};
    const struct record_pair pair = {.a = request->a,
                                     .b = request->b,
                                     .said = request->has_clearance ? RECORD_CLEARANCE
                                             : request->ignored     ? RECORD_IGNORED
                                                                    : RECORD_NOTHING,
                                     .clearance = request->clearance};
    const struct record_part parts[2] = {{&head, sizeof head}, {&pair, sizeof pair}};

    return add(client, RECORD_PAIRS, parts, 2);
}

int cli_record_change(struct pccd_client *client, int method,
                      const union cli_params *params, const void *answer,
                      cli_record_fn add)
{
    struct record_scene scene;
    struct record_object object;
    struct record_gone gone = {.scene = 0};
    struct record_part part = {&gone, sizeof gone};
    enum record_kind kind;

    switch (method) {
    case PROTO_METHOD_SCENE_CREATE: {
        const struct proto_SCENE_CREATE_result *result = answer;

        if (result == NULL) {
            return 0; /* it came too late: nobody knows its handle */
        }
        scene = (struct record_scene){.scene = result->scene};
        part = (struct record_part){&scene, sizeof scene};
        kind = RECORD_SCENE;
        break;
    }
    case PROTO_METHOD_SCENE_ADD: {
        const struct proto_SCENE_ADD_result *result = answer;

        if (result == NULL) {
            return 0;
        }
        object = (struct record_object){.scene = params->SCENE_ADD.scene,
                                        .mesh = params->SCENE_ADD.mesh,
                                        .object = result->object};
        part = (struct record_part){&object, sizeof object};
        kind = RECORD_OBJECT;
        break;
    }
    case PROTO_METHOD_SCENE_DESTROY:
        gone.scene = params->SCENE_DESTROY.scene;
        kind = RECORD_SCENE_GONE;
        break;
    case PROTO_METHOD_SCENE_REMOVE:
        gone.scene = params->SCENE_REMOVE.scene;
        gone.object = params->SCENE_REMOVE.object;
        kind = RECORD_OBJECT_GONE;
        break;
    case PROTO_METHOD_MESH_DESTROY:
        gone.mesh = params->MESH_DESTROY.mesh;
        kind = RECORD_MESH_GONE;
        break;
    case PROTO_METHOD_OBJECT_SET:
        return write_settings(client, &params->OBJECT_SET, add);
    case PROTO_METHOD_SCENE_IGNORE:
        return write_pair(client, &params->SCENE_IGNORE, add);
    default:
        return 0;
    }
    return add(client, kind, &part, 1);
}
