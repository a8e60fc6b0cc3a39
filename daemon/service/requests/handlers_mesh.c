/* handlers_mesh.c - mesh.create, replace, data, commit, edges and destroy. */
#include <string.h>

#include "call.h"
#include "coordinates.h"
#include "invariant.h"
#include "meshes.h"
#include "now.h"
#include "replacement.h"
#include "request.h"
#include "service.h"
#include "session.h"

/* Copied at a time, and then it is the turn of others: 0.2 ms, page faults included. */
#define PART_ITEMS 16384u

enum {
    PART_VERTICES = 0,
    PART_TRIANGLES = 1,
    PART_RADII = 2,
    PART_EDGES = 3,
    PART_POINTS = 4,
    PART_COUNT = 5
};

/* The mesh of a handle; NULL with the error set: there is none, or it is busy. */
static struct srv_mesh *find_mesh(struct srv_call *call, uint32_t handle)
{
    struct srv_mesh *mesh = srv_handles_get(&call->session->meshes, handle);
    if (mesh == NULL) {
        (void)srv_refuse_handle(call, call->session, "mesh", handle);
        return NULL;
    }
    return srv_mesh_refuse_busy(mesh, handle, &call->error) == 0 ? mesh : NULL;
}

/* Return what data and commit are meant for: the replacement, where one was announced. */
static struct srv_shape *shape_to_fill(const struct srv_mesh *mesh)
{
    return mesh->next != NULL ? mesh->next : mesh->current;
}

/* ---- create, destroy --------------------------------------------------------------- */

int srv_on_MESH_CREATE(struct srv_call *call)
{
    struct srv_session *session = call->session;
    const struct proto_MESH_CREATE_request *request = &call->params.MESH_CREATE;
    const struct eng_mesh_counts counts = {request->vertex_count, request->triangle_count,
                                           request->edge_count, request->point_count};
    struct srv_shape *shape = NULL;
    int status = srv_shape_admit(&session->owner, &counts, &shape, &call->error);
    if (status != 0) {
        return status;
    }
    struct srv_mesh *mesh =
        srv_mesh_new(++session->service->mesh_last, shape, &call->error);
    if (mesh == NULL) {
        srv_resource_drop(&shape->resource); /* refunds it */
        return call->error.code;
    }
    uint32_t *handle = &call->result.MESH_CREATE.mesh;
    *handle = request->want;
    status =
        srv_session_handle(session, &session->meshes, "mesh", mesh, handle, &call->error);
    if (status != 0) {
        srv_mesh_free(mesh);
        return status;
    }
    mesh->handle = *handle;
    return 0;
}

int srv_on_MESH_DESTROY(struct srv_call *call)
{
    uint32_t handle = call->params.MESH_DESTROY.mesh;
    struct srv_mesh *mesh = find_mesh(call, handle);
    if (mesh == NULL) {
        return call->error.code;
    }
    srv_handles_remove(&call->session->meshes, handle);
    srv_mesh_free(mesh);
    call->result.MESH_DESTROY.done = true;
    return 0;
}

/* ---- replace ----------------------------------------------------------------------- */

/* Announce a replacement. One that was announced before is dropped either way. */
int srv_on_MESH_REPLACE(struct srv_call *call)
{
    const struct proto_MESH_REPLACE_request *request = &call->params.MESH_REPLACE;
    struct srv_mesh *mesh = find_mesh(call, request->mesh);
    if (mesh == NULL) {
        return call->error.code;
    }
    if (!mesh->is_committed) {
        return proto_error_set(&call->error, PCCD_E_STATE, "mesh 0x%x is not committed",
                               request->mesh);
    }
    const struct eng_mesh_counts counts = {request->vertex_count, request->triangle_count,
                                           request->edge_count, request->point_count};
    const struct eng_mesh_counts nothing = {0};
    bool forget = memcmp(&counts, &nothing, sizeof counts) == 0;
    struct srv_shape *shape = NULL;
    if (!forget) {
        int status =
            srv_shape_admit(&call->session->owner, &counts, &shape, &call->error);
        if (status != 0) {
            return status;
        }
    }
    if (mesh->next != NULL) {
        srv_resource_drop(&mesh->next->resource);
    }
    mesh->next = shape;
    call->result.MESH_REPLACE.generation = mesh->generation + (forget ? 0 : 1);
    return 0;
}

/* ---- data -------------------------------------------------------------------------- */

static uint64_t item_bytes_of(const struct proto_MESH_DATA_request *data)
{
    const uint64_t bytes[PART_COUNT] = {[PART_VERTICES] =
                                            common_vertex_bytes(data->format),
                                        [PART_TRIANGLES] = sizeof(uint32_t[3]),
                                        [PART_RADII] = sizeof(double),
                                        [PART_EDGES] = sizeof(uint32_t[2]),
                                        [PART_POINTS] = sizeof(uint32_t)};
    return bytes[data->part];
}

/* The names of the items of each part, one and many. */
static const char *const item_names[PART_COUNT][2] = {{"vertex", "vertices"},
                                                      {"triangle", "triangles"},
                                                      {"radius", "vertices"},
                                                      {"edge", "edges"},
                                                      {"point", "points"}};

static uint32_t items_of(const struct eng_mesh_counts *counts, uint32_t part)
{
    const uint32_t items[PART_COUNT] = {[PART_VERTICES] = counts->vertices,
                                        [PART_TRIANGLES] = counts->triangles,
                                        [PART_RADII] = counts->vertices,
                                        [PART_EDGES] = counts->edges,
                                        [PART_POINTS] = counts->points};
    return items[part];
}

static int write_items(struct eng_mesh *engine,
                       const struct proto_MESH_DATA_request *data, uint32_t first,
                       uint32_t count, const uint8_t *payload, uint32_t *bad_item)
{
    switch (data->part) {
    case PART_VERTICES:
        return eng_mesh_write_vertices(engine, (enum pccd_format)data->format, first,
                                       count, payload);
    case PART_TRIANGLES:
        return eng_mesh_write_triangles(engine, first, count, payload, bad_item);
    case PART_EDGES:
        return eng_mesh_write_edges(engine, first, count, payload, bad_item);
    case PART_POINTS:
        return eng_mesh_write_points(engine, first, count, payload, bad_item);
    default: /* slots are aligned to 8 bytes */
        return eng_mesh_write_radii(engine, first, count,
                                    (const double *)(const void *)payload);
    }
}

/* Say which of these vertices has a coordinate that is none: the client may have changed
 * it since. */
static int explain_stray(struct srv_request *request, uint32_t first, uint32_t count,
                         const uint8_t *x)
{
    uint32_t format = request->params.MESH_DATA.format;
    uint32_t at = 0;
    double number = 0;
    for (; at < 3 * count; at++) {
        number = common_coordinate(x, format, at);
        if (!common_is_coordinate(number)) {
            break;
        }
    }
    return proto_error_set(&request->error, PCCD_E_NOTFINITE,
                           "%c of vertex %u is %.17g, not finite or beyond 1e18",
                           (int)"xyz"[at % 3], first + at / 3, number);
}

/* The first vertex beyond the mesh that an item names. */
static uint32_t bad_vertex(const struct srv_request *request, uint32_t item,
                           const uint8_t *payload)
{
    uint64_t bytes = item_bytes_of(&request->params.MESH_DATA);
    uint32_t vertex = 0;
    for (uint64_t at = 0; at < bytes; at += sizeof vertex) {
        memcpy(&vertex, payload + item * bytes + at, sizeof vertex);
        if (vertex >= request->plan.shape->counts.vertices) {
            break;
        }
    }
    return vertex;
}

/* Copy the next part of a chunk from its slot into the engine's mesh. */
static int copy_part(struct srv_request *request, struct eng_mesh *engine)
{
    const struct proto_MESH_DATA_request *data = &request->params.MESH_DATA;
    uint32_t left = data->count - request->items_done;
    uint32_t count = left < PART_ITEMS ? left : PART_ITEMS;
    uint32_t first = data->first + request->items_done;
    uint32_t bad_item = 0;
    const uint8_t *payload = request->payload + request->items_done * item_bytes_of(data);
    request->items_done += count;
    int status = write_items(engine, data, first, count, payload, &bad_item);
    switch (status) {
    case PCCD_OK:
        return 0;
    case PCCD_E_INDEX:
        return proto_error_set(
            &request->error, PCCD_E_INDEX,
            "%s %u names vertex %u; the mesh has %u vertices, which begin at 0",
            item_names[data->part][0], bad_item,
            bad_vertex(request, bad_item - first, payload),
            request->plan.shape->counts.vertices);
    case PCCD_E_NOTFINITE:
        return explain_stray(request, first, count, payload);
    case PCCD_E_INVAL:
    case PCCD_E_LIMIT:
        return proto_error_set(
            &request->error, status, "a radius from vertex %u to %u is %s", data->first,
            data->first + data->count - 1,
            status == PCCD_E_LIMIT ? "beyond 1e18" : "negative or not finite");
    case PCCD_E_STATE:
        return proto_error_set(&request->error, PCCD_E_STATE,
                               eng_mesh_is_committed(engine)
                                   ? "mesh 0x%x is committed"
                                   : "mesh 0x%x: the chunk leaves a gap before it",
                               data->mesh);
    default:
        return proto_error_set(&request->error, status, "mesh 0x%x: %s", data->mesh,
                               proto_status_text(status));
    }
}

/* The mesh to write to; before the first part also the slot. */
static int open_data(struct srv_request *request, struct eng_mesh **engine)
{
    const struct proto_MESH_DATA_request *data = &request->params.MESH_DATA;
    const struct srv_shape *shape = request->plan.shape;
    if (request->items_done > 0) {
        *engine = shape->engine;
        return atomic_load_explicit(&request->job.cancel, memory_order_relaxed)
                   ? proto_error_set(&request->error, PCCD_E_CANCELLED,
                                     "mesh 0x%x: cancelled, %u of %u items were copied",
                                     data->mesh, request->items_done, data->count)
                   : 0;
    }
    int status = srv_shape_engine(request->plan.shape, engine);
    if (status != 0) {
        return proto_error_set(&request->error, status,
                               "no memory for %u vertices and %u triangles",
                               shape->counts.vertices, shape->counts.triangles);
    }
    return srv_ring_open_slot(request->plan.ring, data->slot, data->seq,
                              &request->payload, &request->error);
}

static int work_data(struct srv_request *request)
{
    const struct proto_MESH_DATA_request *data = &request->params.MESH_DATA;
    struct srv_ring *ring = request->plan.ring;
    struct eng_mesh *engine = NULL;
    int status = open_data(request, &engine);
    if (status != 0) {
        return status;
    }
    status = copy_part(request, engine);
    if (status == 0 && request->items_done < data->count) {
        request->job.goes_on = true; /* whether the slot has changed is seen in the end */
        return 0;
    }
    int torn = srv_ring_check_slot(ring, data->slot, data->seq, &request->error);
    srv_request_return_slot(request);
    if (torn != 0 || status != 0) {
        return torn != 0 ? torn : status; /* a change explains any other complaint */
    }
    request->upload_bytes = data->count * item_bytes_of(data);
    struct eng_mesh_counts received;
    eng_mesh_received(engine, &received);
    request->result.MESH_DATA.received = data->part == PART_RADII
                                             ? data->first + data->count
                                             : items_of(&received, data->part);
    return 0;
}

/* Everything about a chunk that can be told from its message. */
static int check_chunk(struct srv_call *call, const struct srv_shape *shape,
                       const struct srv_ring *ring)
{
    const struct proto_MESH_DATA_request *data = &call->params.MESH_DATA;
    if (data->part >= PART_COUNT || data->format >= PCCD_FORMAT_COUNT) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "unknown part %u or format %u",
                               data->part, data->format);
    }
    uint32_t limit = items_of(&shape->counts, data->part);
    if (data->count < 1 || data->first >= limit || data->count > limit - data->first) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "%u %s from %u on; mesh 0x%x has %u", data->count,
                               item_names[data->part][1], data->first, data->mesh, limit);
    }
    uint64_t item_bytes = item_bytes_of(data);
    if (data->count > ring->slot_stride / item_bytes) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "%u items of %llu bytes do not fit in a slot of %llu",
                               data->count, (unsigned long long)item_bytes,
                               (unsigned long long)ring->slot_stride);
    }
    return 0;
}

int srv_on_MESH_DATA(struct srv_call *call)
{
    const struct proto_MESH_DATA_request *data = &call->params.MESH_DATA;
    struct srv_mesh *mesh = find_mesh(call, data->mesh);
    if (mesh == NULL) {
        return call->error.code;
    }
    struct srv_shape *shape = shape_to_fill(mesh);
    struct srv_ring *ring = NULL;
    int status = srv_admit_ring(call, &ring);
    if (status == 0) {
        status = srv_admit_slot(call, ring, data->slot, data->seq);
    }
    if (status == 0) {
        status = check_chunk(call, shape, ring);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {
        .work = work_data, .ring = ring, .shape = shape, .takes_slot = true};
    return srv_request_start(call, &plan);
}

/* ---- commit ------------------------------------------------------------------------ */

/* Refuse, and say which part of what was announced is not there. */
static int refuse_unfinished(struct srv_request *request, const struct eng_mesh *engine,
                             const struct eng_mesh_counts *counts)
{
    struct eng_mesh_counts received;
    eng_mesh_received(engine, &received);
    if (received.edges < counts->edges || received.points < counts->points) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "%u of %u edges and %u of %u points have arrived",
                               received.edges, counts->edges, received.points,
                               counts->points);
    }
    return proto_error_set(&request->error, PCCD_E_STATE,
                           "%u of %u vertices and %u of %u triangles have arrived",
                           received.vertices, counts->vertices, received.triangles,
                           counts->triangles);
}

/* Derive what the mesh needs, and describe it. A replacement that was derived already,
 * and then failed, is tried again. */
static int derive(struct srv_request *request)
{
    struct srv_shape *shape = request->plan.shape;
    struct eng_mesh *engine = NULL;
    int status = srv_shape_engine(shape, &engine);
    if (status != 0) {
        return proto_error_set(&request->error, status, "no memory for the mesh");
    }
    uint32_t threads = request->session->service->options->threads_max;
    bool is_derived = request->plan.replacement != NULL && eng_mesh_is_committed(engine);
    int failed = is_derived ? PCCD_OK : eng_mesh_commit(engine, threads);
    if (failed == PCCD_E_STATE && !eng_mesh_is_committed(engine)) {
        return refuse_unfinished(request, engine, &shape->counts);
    }
    if (failed != PCCD_OK) {
        return proto_error_set(
            &request->error, failed, "mesh 0x%x: %s", request->params.MESH_COMMIT.mesh,
            failed == PCCD_E_STATE ? "is committed already" : proto_status_text(failed));
    }
    if (!is_derived) { /* without memory for it the objects do without */
        (void)eng_mesh_sort_features(engine, threads);
    }
    struct eng_mesh_info info;
    eng_mesh_get_info(engine, &info);
    request->result.MESH_COMMIT = (struct proto_MESH_COMMIT_result){
        .vertex_count = info.vertex_count,
        .triangle_count = info.triangle_count,
        .edge_count = info.edge_count,
        .duplicate_count = info.duplicate_count,
        .degenerate_count = info.degenerate_count,
        .isolated_count = info.isolated_count,
        .free_edge_count = info.free_edge_count,
        .free_point_count = info.free_point_count,
        .generation = request->plan.generation,
    };
    return 0;
}

static int work_commit(struct srv_request *request)
{
    uint64_t start_ns = common_now_ns();
    struct srv_replacement *replacement = request->plan.replacement;
    int status = derive(request);
    if (status == 0 && replacement != NULL) {
        status = srv_replacement_work(replacement, request->plan.shape,
                                      &request->job.cancel, &request->error);
    }
    request->result.MESH_COMMIT.build_ns = common_now_ns() - start_ns;
    return status;
}

static void finish_commit(struct srv_request *request)
{
    struct srv_session *session = request->session;
    /* NULL: the client is gone, or has destroyed a mesh of one shape meanwhile. */
    struct srv_mesh *mesh =
        srv_handles_get(&session->meshes, request->params.MESH_COMMIT.mesh);
    if (request->plan.replacement != NULL) {
        srv_replacement_finish(session, mesh, request->plan.replacement,
                               request->status == 0);
    } else if (mesh != NULL && request->status == 0) {
        mesh->is_committed = true;
    }
}

int srv_on_MESH_COMMIT(struct srv_call *call)
{
    struct srv_mesh *mesh = find_mesh(call, call->params.MESH_COMMIT.mesh);
    if (mesh == NULL) {
        return call->error.code;
    }
    struct srv_plan plan = {.work = work_commit,
                            .finish = finish_commit,
                            .shape = shape_to_fill(mesh),
                            .ring = call->session->ring,
                            .generation = mesh->generation};
    if (mesh->next != NULL) {
        int status =
            srv_replacement_begin(call->session, mesh, &plan.replacement, &call->error);
        if (status != 0) {
            return status;
        }
        plan.generation++;
        plan.claims = plan.replacement->claims;
        plan.claim_count = plan.replacement->scene_count;
    }
    int status = srv_request_start(call, &plan);
    if (status < 0 && plan.replacement != NULL) {
        srv_replacement_finish(call->session, mesh, plan.replacement, false);
    }
    return status;
}

/* ---- edges ------------------------------------------------------------------------- */

static int work_edges(struct srv_request *request)
{
    const struct proto_MESH_EDGES_request *edges = &request->params.MESH_EDGES;
    const struct eng_mesh *engine = request->plan.shape->engine;
    if (engine == NULL || !eng_mesh_is_committed(engine)) {
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "mesh 0x%x is not committed", edges->mesh);
    }
    struct eng_mesh_info info;
    eng_mesh_get_info(engine, &info);
    if (edges->first > info.edge_count) {
        return proto_error_set(&request->error, PCCD_E_INVAL,
                               "first is %u, mesh 0x%x has %u edges", edges->first,
                               edges->mesh, info.edge_count);
    }
    uint32_t left = info.edge_count - edges->first;
    struct srv_page page;
    void *data = NULL;
    int status = srv_ring_reserve(request->plan.ring, sizeof(struct pccd_edge),
                                  edges->count < left ? edges->count : left, &page, &data,
                                  &request->error);
    if (status != 0) {
        return status;
    }
    if (page.count > 0) {
        memcpy(data, eng_mesh_edges(engine) + edges->first,
               page.count * sizeof(struct pccd_edge));
    }
    request->result.MESH_EDGES =
        (struct proto_MESH_EDGES_result){.count = (uint32_t)page.count,
                                         .offset = page.position,
                                         .release = page.release,
                                         .total = info.edge_count};
    return 0;
}

int srv_on_MESH_EDGES(struct srv_call *call)
{
    struct srv_mesh *mesh = find_mesh(call, call->params.MESH_EDGES.mesh);
    if (mesh == NULL) {
        return call->error.code;
    }
    struct srv_ring *ring = NULL;
    int status = srv_admit_ring(call, &ring);
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_edges, .ring = ring, .shape = mesh->current};
    return srv_request_start(call, &plan);
}
