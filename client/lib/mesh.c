/* mesh.c - meshes: upload in chunks, commit, edges. */

#include <assert.h>
#include <string.h>

#include "attach.h"
#include "client.h"
#include "connection.h"
#include "coordinates.h"
#include "recorder.h"
#include "replica.h"
#include "rpc.h"

#define CHUNK_BYTES                                                                      \
    (1u << 20) /* of a slot at most: small enough to overlap copy and check */

/* Parts of a mesh, each an array; all but the first may be empty. */
enum { PART_VERTICES, PART_TRIANGLES, PART_RADII, PART_EDGES, PART_POINTS, PARTS };

struct part {
    const void *source;
    uint32_t item_bytes;
    uint32_t count;
};

static void parts_of(const struct registry_shape *shape, struct part parts[PARTS])
{
    parts[PART_VERTICES] = (struct part){
        shape->x, (uint32_t)common_vertex_bytes(shape->format), shape->vertex_count};
    parts[PART_TRIANGLES] =
        (struct part){shape->triangles, sizeof(uint32_t[3]), shape->triangle_count};
    parts[PART_RADII] = (struct part){shape->radii, sizeof(double),
                                      shape->radii != NULL ? shape->vertex_count : 0};
    parts[PART_EDGES] =
        (struct part){shape->edges, sizeof(uint32_t[2]), shape->edge_count};
    parts[PART_POINTS] =
        (struct part){shape->points, sizeof(uint32_t), shape->point_count};
}

/* Send items of a part by a slot; the request says of which mesh and part. */
static int send_chunk(struct cli_pipeline *pipeline,
                      struct proto_MESH_DATA_request *request, const struct part *part)
{
    struct pccd_client *client = pipeline->client;
    uint32_t slot = 0;
    int status = cli_slot_begin(client, cli_deadline(client, -1), &slot);

    if (status != 0) {
        return status;
    }
    memcpy(cli_slot_payload(&client->ring, slot),
           (const uint8_t *)part->source + (size_t)request->first * part->item_bytes,
           (size_t)request->count * part->item_bytes);
    request->slot = slot;
    request->seq = cli_slot_publish(&client->ring, slot);
    status = cli_pipeline_send(pipeline, PROTO_METHOD_MESH_DATA, request, slot, NULL);
    if (status != 0) {
        cli_slot_abort(&client->ring, slot);
    }
    return status;
}

static int send_part(struct cli_pipeline *pipeline, uint32_t mesh, uint32_t number,
                     uint32_t format, const struct part *part)
{
    const struct cli_ring *ring = &pipeline->client->ring;
    uint64_t slot_bytes =
        ring->slot_stride < CHUNK_BYTES ? ring->slot_stride : CHUNK_BYTES;
    uint32_t most = (uint32_t)(slot_bytes / part->item_bytes);
    int status = 0;

    assert(most > 0); /* or the upload would never end */
    for (uint32_t first = 0, count; status == 0 && first < part->count; first += count) {
        uint32_t left = part->count - first;

        count = left < most ? left : most;

        struct proto_MESH_DATA_request request = {.mesh = mesh,
                                                  .part = number,
                                                  .format = format,
                                                  .first = first,
                                                  .count = count};

        status = send_chunk(pipeline, &request, part);
    }
    return status;
}

/* All parts of a mesh that the daemon has announced. `waits`: for each of them, as a
 * daemon whose queue is short refuses what comes at once. */
static int send_parts(struct cli_pipeline *pipeline, uint32_t mesh,
                      const struct registry_shape *shape, bool waits)
{
    struct part parts[PARTS];
    int status = 0;

    parts_of(shape, parts);
    for (uint32_t i = 0; status == 0 && i < PARTS; i++) {
        status = send_part(pipeline, mesh, i, i == PART_VERTICES ? shape->format : 0,
                           &parts[i]);
        status = waits ? cli_pipeline_end(pipeline, status) : status;
    }
    return status;
}

static struct proto_MESH_CREATE_request create_request(const struct registry_shape *shape,
                                                       uint32_t want)
{
    return (struct proto_MESH_CREATE_request){.vertex_count = shape->vertex_count,
                                              .triangle_count = shape->triangle_count,
                                              .want = want,
                                              .edge_count = shape->edge_count,
                                              .point_count = shape->point_count};
}

static void fill_info(struct pccd_mesh_info *info,
                      const struct proto_MESH_COMMIT_result *result)
{
    info->vertex_count = result->vertex_count;
    info->triangle_count = result->triangle_count;
    info->edge_count = result->edge_count;
    info->duplicate_count = result->duplicate_count;
    info->degenerate_count = result->degenerate_count;
    info->isolated_count = result->isolated_count;
    info->generation = result->generation;
    info->build_ns = result->build_ns;
    info->free_edge_count = result->free_edge_count;
    info->free_point_count = result->free_point_count;
}

/* Slots for the first mesh: a frame that moves it, or its triangles, whichever is more,
 * so that its first frame finds slots that are large enough. Who has chosen a size has
 * chosen it. */
static uint64_t first_slot_bytes(const struct pccd_client *client,
                                 const struct pccd_mesh_data *data)
{
    uint64_t frame =
        pccd_frame_bytes(1, data->vertex_count * common_vertex_bytes(data->format));
    uint64_t triangles = (uint64_t)data->triangle_count * sizeof(uint32_t[3]);
    uint64_t bytes = frame > triangles ? frame : triangles;

    if (client->slot_bytes > 0) {
        return PROTO_SLOT_BYTES_MIN;
    }
    return bytes < CHUNK_BYTES ? bytes : CHUNK_BYTES;
}

/* The arguments of create and replace, and a ring to send them through. */
static int check_mesh(struct pccd_client *client, const struct pccd_mesh_data *data)
{
    bool is_free = data->edge_count > 0 || data->point_count > 0;
    const char *wrong =
        data->x == NULL ? "x is NULL"
        : data->triangles == NULL && (data->triangle_count > 0 || !is_free)
            ? "triangles is NULL"
        : data->vertex_count == 0 ? "no vertices"
        : (data->vertex_count | data->triangle_count | data->edge_count |
           data->point_count) > PROTO_COUNT_MAX
            ? "more than 2147483647 vertices, triangles, edges or points"
        : data->triangle_count == 0 && !is_free         ? "no triangles"
        : data->edges == NULL && data->edge_count > 0   ? "edges is NULL"
        : data->points == NULL && data->point_count > 0 ? "points is NULL"
        : (unsigned)data->format >= PCCD_FORMAT_COUNT   ? "unknown format"
                                                        : NULL;
    int status;

    if (wrong != NULL) {
        return cli_fail(client, PCCD_E_INVAL, "mesh: %s", wrong);
    }
    status = cli_alive(client);
    if (status == 0 && client->ring.upload.base == NULL) {
        status = cli_ring_reserve(client, first_slot_bytes(client, data),
                                  cli_deadline(client, -1));
    }
    return status;
}

/* Announce a mesh (*mesh = 0, then it has a handle), or other contents for one. */
static int announce(struct pccd_client *client, const struct registry_shape *shape,
                    uint32_t want, uint32_t *mesh)
{
    const struct proto_MESH_CREATE_request create = create_request(shape, want);
    const struct proto_MESH_REPLACE_request replace = {
        .mesh = *mesh,
        .vertex_count = shape->vertex_count,
        .triangle_count = shape->triangle_count,
        .edge_count = shape->edge_count,
        .point_count = shape->point_count};
    struct proto_MESH_CREATE_result created = {.mesh = *mesh};
    struct proto_MESH_REPLACE_result replaced;
    int status = *mesh == 0 ? cli_call_sync(client, PROTO_METHOD_MESH_CREATE, &create,
                                            &created, cli_deadline(client, -1))
                            : cli_call_sync(client, PROTO_METHOD_MESH_REPLACE, &replace,
                                            &replaced, cli_deadline(client, -1));

    if (status == 0) {
        *mesh = created.mesh;
    }
    return status;
}

/* Nothing half-made stays in the daemon; a mesh that there was goes on as it was. What
 * went wrong first is what counts. */
static int take_back(struct pccd_client *client, uint32_t mesh, bool is_new, int status)
{
    const struct proto_MESH_DESTROY_request destroy = {.mesh = mesh};
    const struct proto_MESH_REPLACE_request nothing = {.mesh = mesh};
    char text[CLI_TEXT_BYTES];

    memcpy(text, client->error, sizeof text);
    (void)cli_call_sync(client,
                        is_new ? PROTO_METHOD_MESH_DESTROY : PROTO_METHOD_MESH_REPLACE,
                        is_new ? (const void *)&destroy : (const void *)&nothing, NULL,
                        cli_deadline(client, -1));
    return cli_fail(client, status, "%s", text);
}

/* Announce, upload and commit. What has not arrived whole is not committed. */
static int send_mesh(struct pccd_client *client, const struct registry_shape *shape,
                     uint32_t want, uint32_t *mesh,
                     struct proto_MESH_COMMIT_result *result)
{
    struct proto_MESH_COMMIT_request commit;
    struct cli_pipeline pipeline = {.client = client};
    bool is_new = *mesh == 0;
    int status = announce(client, shape, want, mesh);

    if (status != 0) {
        return status;
    }
    commit.mesh = *mesh;
    status = send_parts(&pipeline, *mesh, shape, true);
    if (status == 0) {
        status = cli_call_sync(client, PROTO_METHOD_MESH_COMMIT, &commit, result,
                               cli_deadline(client, -1));
    }
    return status == 0 ? 0 : take_back(client, *mesh, is_new, status);
}

int cli_mesh_send(struct cli_pipeline *pipeline, const struct registry_mesh *copy,
                  uint32_t want, uint32_t *handle)
{
    const struct registry_shape shape = registry_mesh_shape(copy);
    const struct proto_MESH_CREATE_request create = create_request(&shape, want);
    struct proto_MESH_CREATE_result created = {.mesh = want};
    struct proto_MESH_COMMIT_request commit;
    int status = want != 0
                     ? cli_pipeline_send(pipeline, PROTO_METHOD_MESH_CREATE, &create,
                                         CLI_SLOT_NONE, NULL)
                     : cli_call_sync(pipeline->client, PROTO_METHOD_MESH_CREATE, &create,
                                     &created, cli_deadline(pipeline->client, -1));

    *handle = commit.mesh = created.mesh;
    status = status != 0 ? status : send_parts(pipeline, created.mesh, &shape, false);
    return status != 0 ? status
                       : cli_pipeline_send(pipeline, PROTO_METHOD_MESH_COMMIT, &commit,
                                           CLI_SLOT_NONE, NULL);
}

/* Create a mesh (*mesh = 0) or replace one, and keep a copy. When another daemon took
 * over on the way, all is sent to that one from the beginning; but a mesh over which
 * daemons end is as any request is (recover.c). */
static int register_mesh(struct pccd_client *client, const struct registry_shape *shape,
                         uint32_t *mesh, struct pccd_mesh_info *info)
{
    struct registry_mesh *copy = NULL;
    struct proto_MESH_COMMIT_result result;
    uint64_t before;
    uint32_t want;
    uint32_t made;
    int status;

    if (client->keeps) {
        copy = registry_mesh_copy(shape);
        if (copy == NULL) {
            return cli_fail(client, PCCD_E_NOMEM,
                            "no memory for a copy of the mesh (options.no_keep)");
        }
    }
    want = *mesh == 0 ? cli_take_handle(client) : 0; /* of each daemon that is asked */
    client->link.uploads_ended = 0;
    do {
        before = client->link.told_anew;
        made = *mesh;
        status = send_mesh(client, shape, want, &made, &result);
    } while (status != 0 && !client->dead && client->link.told_anew != before &&
             client->link.uploads_ended < client->link.daemons_max);
    if (status != 0 && client->link.uploads_ended >= client->link.daemons_max) {
        status = cli_fail(client, PCCD_E_DISCONNECTED,
                          "mesh: daemon after daemon has ended before it was registered");
    }
    if (status != 0) {
        registry_mesh_free(copy);
        return status;
    }
    *mesh = made;
    if (copy != NULL) {
        cli_replica_mesh(client, made, copy);
    }
    cli_record_mesh(client, made, shape);
    if (info != NULL) {
        fill_info(info, &result);
    }
    return 0;
}

int pccd_mesh_put(struct pccd_client *client, const struct pccd_mesh_data *asked,
                  uint32_t *mesh, struct pccd_mesh_info *info)
{
    struct pccd_mesh_data data;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (asked == NULL || mesh == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "mesh: %s is NULL",
                        asked == NULL ? "data" : "mesh");
    }
    status = cli_struct_read(client, "data of the mesh", asked, &data, sizeof data);
    status = status != 0 ? status : check_mesh(client, &data);
    return status != 0 ? status
                       : register_mesh(client,
                                       &(struct registry_shape){
                                           .format = (uint32_t)data.format,
                                           .vertex_count = data.vertex_count,
                                           .triangle_count = data.triangle_count,
                                           .edge_count = data.edge_count,
                                           .point_count = data.point_count,
                                           .x = data.x,
                                           .triangles = data.triangles,
                                           .edges = data.edges,
                                           .points = data.points,
                                           .radii = data.radii},
                                       mesh, info);
}

static struct pccd_mesh_data triangles_alone(const void *x, enum pccd_format format,
                                             uint32_t vertex_count,
                                             const uint32_t (*triangles)[3],
                                             uint32_t triangle_count)
{
    return (struct pccd_mesh_data){.struct_bytes = sizeof(struct pccd_mesh_data),
                                   .x = x,
                                   .format = format,
                                   .vertex_count = vertex_count,
                                   .triangle_count = triangle_count,
                                   .triangles = triangles != NULL ? triangles[0] : NULL};
}

int pccd_mesh_create(struct pccd_client *client, const void *x, enum pccd_format format,
                     uint32_t vertex_count, const uint32_t (*triangles)[3],
                     uint32_t triangle_count, uint32_t *mesh, struct pccd_mesh_info *info)
{
    const struct pccd_mesh_data data =
        triangles_alone(x, format, vertex_count, triangles, triangle_count);
    uint32_t made = 0;
    int status = pccd_mesh_put(client, &data, mesh != NULL ? &made : NULL, info);

    if (status == 0) {
        *mesh = made;
    }
    return status;
}

int pccd_mesh_replace(struct pccd_client *client, uint32_t mesh, const void *x,
                      enum pccd_format format, uint32_t vertex_count,
                      const uint32_t (*triangles)[3], uint32_t triangle_count,
                      struct pccd_mesh_info *info)
{
    const struct pccd_mesh_data data =
        triangles_alone(x, format, vertex_count, triangles, triangle_count);

    CLI_ENTER_OR_RETURN(client);
    if (mesh == 0) {
        return cli_fail(client, PCCD_E_HANDLE, "mesh.replace: there is no mesh 0");
    }
    return pccd_mesh_put(client, &data, &mesh, info);
}

/* One page of edges from `got` on: as many as the result region has room for. */
static int fetch_edges(struct pccd_client *client, uint32_t mesh, uint32_t edge_count,
                       struct pccd_edge *edges, uint32_t *got, uint32_t *total)
{
    struct proto_MESH_EDGES_request request = {
        .mesh = mesh, .first = *got, .count = edge_count - *got};
    struct proto_MESH_EDGES_result result;
    uint64_t page;
    int status = cli_call_page(client, PROTO_METHOD_MESH_EDGES, &request, &result,
                               cli_deadline(client, -1), &page);

    if (status != 0) {
        return status;
    }
    *total = result.total;
    if (edge_count < *total) {
        status = cli_fail(client, PCCD_E_INVAL,
                          "mesh.edges: edge_count is %u, mesh 0x%x has %u edges",
                          edge_count, mesh, *total);
    } else if (result.count > request.count || (result.count == 0 && *got < *total)) {
        status =
            cli_fail(client, PCCD_E_BUSY,
                     "mesh.edges: no room in the result region: release answers first");
    } else if (result.count > 0) {
        memcpy(edges + *got, cli_page_base(client, page) + result.offset,
               result.count * sizeof *edges);
        *got += result.count;
    }
    cli_page_release(client, page);
    return status;
}

int pccd_mesh_edges(struct pccd_client *client, uint32_t mesh, struct pccd_edge *edges,
                    uint32_t edge_count)
{
    uint32_t got = 0;
    uint32_t total = 0;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (edges == NULL && edge_count > 0) {
        return cli_fail(client, PCCD_E_INVAL, "mesh.edges: edges is NULL");
    }
    status = cli_ring_ensure(client);
    if (status == 0) {
        do {
            status = fetch_edges(client, mesh, edge_count, edges, &got, &total);
        } while (status == 0 && got < total);
    }
    return status;
}

int pccd_mesh_destroy(struct pccd_client *client, uint32_t mesh)
{
    struct proto_MESH_DESTROY_request request = {.mesh = mesh};

    CLI_ENTER_OR_RETURN(client);
    return cli_call_sync(client, PROTO_METHOD_MESH_DESTROY, &request, NULL,
                         cli_deadline(client, -1));
}
