/* handlers_mesh.c - mesh.create, data, commit, edges and destroy.
 *
 * Room:     server. See call.h.
 * Does:     admission on [loop]; everything that touches vertices on [compute].
 * Does not: allocate what the quota has not been charged for.
 * Threads:  [loop], but for functions named work_.
 */
#include <string.h>

#include "call.h"
#include "invariant.h"
#include "loop.h"
#include "now.h"
#include "request.h"
#include "session.h"
#include "wire.h"

enum { PART_VERTICES = 0, PART_TRIANGLES = 1, PART_COUNT = 2 };

/* The mesh of a handle; NULL with the error set. */
static struct srv_mesh *find_mesh(struct srv_call *call, uint32_t handle)
{
    struct srv_mesh *mesh = srv_handles_get(&call->session->meshes, handle);
    if (mesh == NULL) {
        proto_error_set(&call->error, PCCD_E_HANDLE, "there is no mesh 0x%x", handle);
    }
    return mesh;
}

/* ---- create, destroy --------------------------------------------------------------- */

int srv_on_MESH_CREATE(struct srv_call *call)
{
    struct srv_session *session = call->session;
    struct srv_quota *quota = &session->loop->quota;
    const struct proto_MESH_CREATE_request *request = &call->params.MESH_CREATE;
    if (request->vertex_count < 1 || request->vertex_count > PROTO_COUNT_MAX ||
        request->triangle_count < 1 || request->triangle_count > PROTO_COUNT_MAX) {
        return proto_error_set(&call->error, PCCD_E_INVAL,
                               "a mesh has 1 to %u vertices and triangles, not %u and %u",
                               PROTO_COUNT_MAX, request->vertex_count,
                               request->triangle_count);
    }
    uint64_t triangles =
        srv_triangle_charge(request->vertex_count, request->triangle_count);
    int status =
        srv_quota_charge(quota, session->user, SRV_QUOTA_MESHES, 1, &call->error);
    if (status != 0) {
        return status;
    }
    status = srv_quota_charge(quota, session->user, SRV_QUOTA_TRIANGLES, triangles,
                              &call->error);
    if (status != 0) {
        goto refund_mesh;
    }
    struct srv_mesh *mesh =
        srv_mesh_new(session, request->vertex_count, request->triangle_count);
    if (mesh == NULL) {
        status = proto_error_set(&call->error, PCCD_E_NOMEM, "no memory for a mesh");
        goto refund_triangles;
    }
    status = srv_handles_add(&session->meshes, mesh, &call->result.MESH_CREATE.mesh);
    if (status != 0) {
        srv_resource_drop(&mesh->resource); /* refunds both */
        return proto_error_set(&call->error, status, "no handle for a mesh");
    }
    return 0;

refund_triangles:
    srv_quota_refund(quota, session->user, SRV_QUOTA_TRIANGLES, triangles);
refund_mesh:
    srv_quota_refund(quota, session->user, SRV_QUOTA_MESHES, 1);
    return status;
}

int srv_on_MESH_DESTROY(struct srv_call *call)
{
    uint32_t handle = call->params.MESH_DESTROY.mesh;
    struct srv_mesh *mesh = find_mesh(call, handle);
    if (mesh == NULL) {
        return PCCD_E_HANDLE;
    }
    srv_handles_remove(&call->session->meshes, handle);
    srv_resource_drop(&mesh->resource);
    call->result.MESH_DESTROY.done = true;
    return 0;
}

/* ---- data -------------------------------------------------------------------------- */

/* Copy a chunk from `payload` into the engine's mesh. */
static int copy_chunk(struct srv_request *request, struct eng_mesh *engine,
                      const void *payload)
{
    const struct proto_MESH_DATA_request *data = &request->params.MESH_DATA;
    uint32_t bad_triangle = 0;
    int status = data->part == PART_VERTICES
                     ? eng_mesh_write_vertices(engine, (enum eng_format)data->format,
                                               data->first, data->count, payload)
                     : eng_mesh_write_triangles(engine, data->first, data->count, payload,
                                                &bad_triangle);
    switch (status) {
    case ENG_OK:
        return 0;
    case ENG_E_INDEX:
        return proto_error_set(&request->error, PCCD_E_INDEX,
                               "triangle %u names a vertex beyond the mesh's %u",
                               bad_triangle, request->plan.mesh->vertex_count);
    case ENG_E_NOTFINITE:
        return proto_error_set(&request->error, PCCD_E_NOTFINITE,
                               "a vertex from %u to %u is not finite or beyond 1e18",
                               data->first, data->first + data->count - 1);
    case ENG_E_STATE:
        return proto_error_set(&request->error, PCCD_E_STATE,
                               eng_mesh_is_committed(engine)
                                   ? "mesh 0x%x is committed"
                                   : "mesh 0x%x: the chunk leaves a gap before it",
                               data->mesh);
    default:
        status = srv_wire_status(status);
        return proto_error_set(&request->error, status, "mesh 0x%x: %s", data->mesh,
                               proto_status_text(status));
    }
}

static int work_data(struct srv_request *request)
{
    const struct proto_MESH_DATA_request *data = &request->params.MESH_DATA;
    struct srv_ring *ring = request->plan.ring;
    struct eng_mesh *engine = NULL;
    const uint8_t *payload = NULL;
    int status = srv_mesh_engine(request->plan.mesh, &engine);
    if (status != 0) {
        return proto_error_set(
            &request->error, status, "no memory for %u vertices and %u triangles",
            request->plan.mesh->vertex_count, request->plan.mesh->triangle_count);
    }
    status = srv_ring_open_slot(ring, data->slot, data->seq, &payload, &request->error);
    if (status != 0) {
        return status;
    }
    status = copy_chunk(request, engine, payload);
    int torn = srv_ring_check_slot(ring, data->slot, data->seq, &request->error);
    srv_request_return_slot(request);
    if (torn != 0 || status != 0) {
        return torn != 0 ? torn : status; /* a change explains any other complaint */
    }
    uint64_t item_bytes = data->part == PART_VERTICES ? srv_vertex_bytes(data->format)
                                                      : sizeof(uint32_t[3]);
    request->upload_bytes = data->count * item_bytes;
    uint32_t vertices = 0;
    uint32_t triangles = 0;
    eng_mesh_received(engine, &vertices, &triangles);
    request->result.MESH_DATA.received =
        data->part == PART_VERTICES ? vertices : triangles;
    return 0;
}

/* Everything about a chunk that can be told from its message. */
static int check_chunk(struct srv_call *call, const struct srv_mesh *mesh,
                       const struct srv_ring *ring)
{
    const struct proto_MESH_DATA_request *data = &call->params.MESH_DATA;
    if (data->part >= PART_COUNT || data->format >= PCCD_FORMAT_COUNT) {
        return proto_error_set(&call->error, PCCD_E_INVAL, "unknown part %u or format %u",
                               data->part, data->format);
    }
    bool vertices = data->part == PART_VERTICES;
    uint32_t limit = vertices ? mesh->vertex_count : mesh->triangle_count;
    if (data->count < 1 || data->first >= limit || data->count > limit - data->first) {
        return proto_error_set(
            &call->error, PCCD_E_INVAL, "%u %s from %u on; mesh 0x%x has %u", data->count,
            vertices ? "vertices" : "triangles", data->first, data->mesh, limit);
    }
    uint64_t item_bytes = vertices ? srv_vertex_bytes(data->format) : sizeof(uint32_t[3]);
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
        return PCCD_E_HANDLE;
    }
    struct srv_ring *ring = NULL;
    int status = srv_request_ring(call, &ring);
    if (status == 0) {
        status = srv_request_slot(call, ring, data->slot, data->seq);
    }
    if (status == 0) {
        status = check_chunk(call, mesh, ring);
    }
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {
        .work = work_data, .ring = ring, .mesh = mesh, .takes_slot = true};
    return srv_request_start(call, &plan);
}

/* ---- commit ------------------------------------------------------------------------ */

static int work_commit(struct srv_request *request)
{
    struct srv_mesh *mesh = request->plan.mesh;
    struct eng_mesh *engine = NULL;
    int status = srv_mesh_engine(mesh, &engine);
    if (status != 0) {
        return proto_error_set(&request->error, status, "no memory for the mesh");
    }
    uint64_t start_ns = srv_now_ns();
    int failed = eng_mesh_commit(engine);
    if (failed == ENG_E_STATE && !eng_mesh_is_committed(engine)) {
        uint32_t vertices = 0;
        uint32_t triangles = 0;
        eng_mesh_received(engine, &vertices, &triangles);
        return proto_error_set(&request->error, PCCD_E_STATE,
                               "%u of %u vertices and %u of %u triangles have arrived",
                               vertices, mesh->vertex_count, triangles,
                               mesh->triangle_count);
    }
    if (failed != ENG_OK) {
        status = srv_wire_status(failed);
        return proto_error_set(
            &request->error, status, "mesh 0x%x: %s", request->params.MESH_COMMIT.mesh,
            failed == ENG_E_STATE ? "is committed already" : proto_status_text(status));
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
        .build_ns = srv_now_ns() - start_ns,
    };
    return 0;
}

int srv_on_MESH_COMMIT(struct srv_call *call)
{
    struct srv_mesh *mesh = find_mesh(call, call->params.MESH_COMMIT.mesh);
    if (mesh == NULL) {
        return PCCD_E_HANDLE;
    }
    struct srv_plan plan = {
        .work = work_commit, .mesh = mesh, .ring = call->session->ring};
    return srv_request_start(call, &plan);
}

/* ---- edges ------------------------------------------------------------------------- */

static int work_edges(struct srv_request *request)
{
    const struct proto_MESH_EDGES_request *edges = &request->params.MESH_EDGES;
    const struct eng_mesh *engine = request->plan.mesh->engine;
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
    request->result.MESH_EDGES = (struct proto_MESH_EDGES_result){
        .count = (uint32_t)page.count, .offset = page.position, .release = page.release};
    return 0;
}

int srv_on_MESH_EDGES(struct srv_call *call)
{
    struct srv_mesh *mesh = find_mesh(call, call->params.MESH_EDGES.mesh);
    if (mesh == NULL) {
        return PCCD_E_HANDLE;
    }
    struct srv_ring *ring = NULL;
    int status = srv_request_ring(call, &ring);
    if (status != 0) {
        return status;
    }
    struct srv_plan plan = {.work = work_edges, .ring = ring, .mesh = mesh};
    return srv_request_start(call, &plan);
}
