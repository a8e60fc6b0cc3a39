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

/* One array on its way to the daemon. */
struct upload {
    uint32_t mesh;
    uint32_t part;
    uint32_t format;
    const uint8_t *source;
    uint32_t item_bytes;
    uint32_t count;
};

static int send_chunk(struct cli_pipeline *pipeline, const struct upload *upload,
                      uint32_t first, uint32_t count)
{
    struct pccd_client *client = pipeline->client;
    struct proto_MESH_DATA_request request = {.mesh = upload->mesh,
                                              .part = upload->part,
                                              .format = upload->format,
                                              .first = first,
                                              .count = count};
    uint32_t slot = 0;
    int status = cli_slot_begin(client, cli_deadline(client, -1), &slot);

    if (status != 0) {
        return status;
    }
    memcpy(cli_slot_payload(&client->ring, slot),
           upload->source + (size_t)first * upload->item_bytes,
           (size_t)count * upload->item_bytes);
    request.slot = slot;
    request.seq = cli_slot_publish(&client->ring, slot);
    status = cli_pipeline_send(pipeline, PROTO_METHOD_MESH_DATA, &request, slot, NULL);
    if (status != 0) {
        cli_slot_abort(&client->ring, slot);
    }
    return status;
}

static int send_array(struct cli_pipeline *pipeline, const struct upload *upload)
{
    const struct cli_ring *ring = &pipeline->client->ring;
    uint64_t slot_bytes =
        ring->slot_stride < CHUNK_BYTES ? ring->slot_stride : CHUNK_BYTES;
    uint32_t chunk = (uint32_t)(slot_bytes / upload->item_bytes);
    int status = 0;

    assert(chunk > 0); /* or the upload would never end */
    for (uint32_t first = 0; status == 0 && first < upload->count;) {
        uint32_t count = upload->count - first < chunk ? upload->count - first : chunk;

        status = send_chunk(pipeline, upload, first, count);
        first += count;
    }
    return status;
}

static int send_arrays(struct cli_pipeline *pipeline, const struct upload arrays[PARTS])
{
    int status = 0;

    for (int part = 0; status == 0 && part < PARTS; part++) {
        status = send_array(pipeline, &arrays[part]);
    }
    return status;
}

/* Upload and commit a mesh that the daemon has announced. What has not arrived whole is
 * not committed. */
static int fill_mesh(struct pccd_client *client, const struct upload arrays[PARTS],
                     struct proto_MESH_COMMIT_result *result)
{
    struct proto_MESH_COMMIT_request request = {.mesh = arrays[0].mesh};
    struct cli_pipeline pipeline = {.client = client};
    int status = 0;

    /* One array at a time: a daemon whose queue is short refuses what comes at once. */
    for (int part = 0; status == 0 && part < PARTS; part++) {
        status = cli_pipeline_end(&pipeline, send_array(&pipeline, &arrays[part]));
    }
    if (status == 0) {
        status = cli_call_sync(client, PROTO_METHOD_MESH_COMMIT, &request, result,
                               cli_deadline(client, -1));
    }
    return status;
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
        : data->vertex_count == 0                       ? "no vertices"
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
    if (status == 0 && is_free && (client->link.features & PROTO_FEATURE_FREE) == 0) {
        status = cli_fail(client, PCCD_E_VERSION,
                          "mesh.data: the daemon at %s is older than this; it knows "
                          "triangles alone",
                          client->url);
    }
    if (status == 0 && data->radii != NULL) {
        status = cli_check_thick(client, "mesh.data");
    }
    if (status == 0 && client->ring.upload.base == NULL) {
        status = cli_ring_reserve(client, first_slot_bytes(client, data),
                                  cli_deadline(client, -1));
    }
    return status;
}

static void arrays_of(uint32_t mesh, const struct pccd_mesh_data *data,
                      struct upload arrays[PARTS])
{
    arrays[PART_VERTICES] =
        (struct upload){mesh,
                        PART_VERTICES,
                        (uint32_t)data->format,
                        data->x,
                        (uint32_t)common_vertex_bytes((uint32_t)data->format),
                        data->vertex_count};
    arrays[PART_TRIANGLES] = (struct upload){mesh,
                                             PART_TRIANGLES,
                                             0,
                                             (const uint8_t *)data->triangles,
                                             sizeof(uint32_t[3]),
                                             data->triangle_count};
    arrays[PART_RADII] = (struct upload){mesh,
                                         PART_RADII,
                                         0,
                                         (const uint8_t *)data->radii,
                                         sizeof(double),
                                         data->radii != NULL ? data->vertex_count : 0};
    arrays[PART_EDGES] = (struct upload){mesh,
                                         PART_EDGES,
                                         0,
                                         (const uint8_t *)data->edges,
                                         sizeof(uint32_t[2]),
                                         data->edge_count};
    arrays[PART_POINTS] = (struct upload){mesh,
                                          PART_POINTS,
                                          0,
                                          (const uint8_t *)data->points,
                                          sizeof(uint32_t),
                                          data->point_count};
}

/* Announce, upload and commit; arrays[].mesh is set to the new handle. */
static int make_mesh(struct pccd_client *client, struct upload arrays[PARTS],
                     uint32_t want, struct proto_MESH_COMMIT_result *result)
{
    struct proto_MESH_CREATE_request request = {.vertex_count = arrays[0].count,
                                                .triangle_count = arrays[1].count,
                                                .want = want,
                                                .edge_count = arrays[PART_EDGES].count,
                                                .point_count = arrays[PART_POINTS].count};
    struct proto_MESH_CREATE_result created;
    struct proto_MESH_DESTROY_request destroy;
    char text[CLI_TEXT_BYTES];
    int status = cli_call_sync(client, PROTO_METHOD_MESH_CREATE, &request, &created,
                               cli_deadline(client, -1));

    if (status != 0) {
        return status;
    }
    for (int part = 0; part < PARTS; part++) {
        arrays[part].mesh = created.mesh;
    }
    status = fill_mesh(client, arrays, result);
    if (status == 0) {
        return 0;
    }
    /* Nothing half-made stays in the daemon; what went wrong first is what counts. */
    memcpy(text, client->error, sizeof text);
    destroy.mesh = created.mesh;
    (void)cli_call_sync(client, PROTO_METHOD_MESH_DESTROY, &destroy, NULL,
                        cli_deadline(client, -1));
    return cli_fail(client, status, "%s", text);
}

int cli_mesh_send(struct cli_pipeline *pipeline, const struct registry_mesh *copy,
                  uint32_t want, uint32_t *handle)
{
    struct pccd_client *client = pipeline->client;
    struct proto_MESH_CREATE_request create = {.vertex_count = copy->vertex_count,
                                               .triangle_count = copy->triangle_count,
                                               .want = want,
                                               .edge_count = copy->named_edge_count,
                                               .point_count = copy->named_point_count};
    struct proto_MESH_CREATE_result created = {.mesh = want};
    struct proto_MESH_COMMIT_request commit;
    struct upload arrays[PARTS];
    int status = want != 0 ? cli_pipeline_send(pipeline, PROTO_METHOD_MESH_CREATE,
                                               &create, CLI_SLOT_NONE, NULL)
                           : cli_call_sync(client, PROTO_METHOD_MESH_CREATE, &create,
                                           &created, cli_deadline(client, -1));

    *handle = commit.mesh = created.mesh;
    arrays_of(created.mesh,
              &(struct pccd_mesh_data){.x = copy->x,
                                       .format = (enum pccd_format)copy->format,
                                       .vertex_count = copy->vertex_count,
                                       .triangle_count = copy->triangle_count,
                                       .triangles = (const uint32_t *)copy->triangles,
                                       .radii = copy->radii,
                                       .edges = (const uint32_t *)copy->named_edges,
                                       .points = copy->named_points,
                                       .edge_count = copy->named_edge_count,
                                       .point_count = copy->named_point_count},
              arrays);
    status = status != 0 ? status : send_arrays(pipeline, arrays);
    return status != 0 ? status
                       : cli_pipeline_send(pipeline, PROTO_METHOD_MESH_COMMIT, &commit,
                                           CLI_SLOT_NONE, NULL);
}

/* Announce other contents for a mesh, upload and commit them. */
static int replace_mesh(struct pccd_client *client, const struct upload arrays[PARTS],
                        struct proto_MESH_COMMIT_result *result)
{
    struct proto_MESH_REPLACE_request request = {.mesh = arrays[0].mesh,
                                                 .vertex_count = arrays[0].count,
                                                 .triangle_count = arrays[1].count,
                                                 .edge_count = arrays[PART_EDGES].count,
                                                 .point_count =
                                                     arrays[PART_POINTS].count};
    struct proto_MESH_REPLACE_result announced;
    char text[CLI_TEXT_BYTES];
    int status = cli_call_sync(client, PROTO_METHOD_MESH_REPLACE, &request, &announced,
                               cli_deadline(client, -1));

    if (status != 0) {
        return status;
    }
    status = fill_mesh(client, arrays, result);
    if (status != 0) {
        /* What was announced is forgotten; the mesh goes on as it was. */
        memcpy(text, client->error, sizeof text);
        request = (struct proto_MESH_REPLACE_request){.mesh = request.mesh};
        (void)cli_call_sync(client, PROTO_METHOD_MESH_REPLACE, &request, NULL,
                            cli_deadline(client, -1));
        return cli_fail(client, status, "%s", text);
    }
    return 0;
}

static struct registry_shape shape_of(const struct upload arrays[PARTS])
{
    assert(arrays[0].part == PART_VERTICES && arrays[1].part == PART_TRIANGLES);
    return (struct registry_shape){.format = arrays[0].format,
                                   .vertex_count = arrays[0].count,
                                   .triangle_count = arrays[1].count,
                                   .edge_count = arrays[PART_EDGES].count,
                                   .point_count = arrays[PART_POINTS].count,
                                   .x = arrays[0].source,
                                   .triangles = arrays[1].source,
                                   .edges = arrays[PART_EDGES].source,
                                   .points = arrays[PART_POINTS].source,
                                   .radii = arrays[PART_RADII].source};
}

/* Create a mesh (*mesh = 0) or replace one, and keep a copy. When another daemon took
 * over on the way, all is sent to that one from the beginning; but a mesh over which
 * daemons end is as any request is (recover.c). */
static int register_mesh(struct pccd_client *client, struct upload arrays[PARTS],
                         uint32_t *mesh, struct pccd_mesh_info *info)
{
    struct registry_mesh *copy = NULL;
    struct proto_MESH_COMMIT_result result;
    uint64_t before;
    uint32_t want;
    int status;

    const struct registry_shape shape = shape_of(arrays);

    if (client->keeps) {
        copy = registry_mesh_copy(&shape);
        if (copy == NULL) {
            return cli_fail(client, PCCD_E_NOMEM,
                            "no memory for a copy of the mesh (options.no_keep)");
        }
    }
    want = *mesh == 0 ? cli_take_handle(client) : 0; /* of each daemon that is asked */
    client->link.uploads_ended = 0;
    do {
        before = client->link.told_anew;
        status = *mesh == 0 ? make_mesh(client, arrays, want, &result)
                            : replace_mesh(client, arrays, &result);
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
    *mesh = arrays[0].mesh;
    if (copy != NULL) {
        cli_replica_mesh(client, *mesh, copy);
    }
    cli_record_mesh(client, *mesh, &shape);
    if (info != NULL) {
        fill_info(info, &result);
    }
    return 0;
}

int pccd_mesh_put(struct pccd_client *client, const struct pccd_mesh_data *asked,
                  uint32_t *mesh, struct pccd_mesh_info *info)
{
    struct pccd_mesh_data data;
    struct upload arrays[PARTS];
    uint32_t handle;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (asked == NULL || mesh == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "mesh: %s is NULL",
                        asked == NULL ? "data" : "mesh");
    }
    status = cli_struct_read(client, "data of the mesh", asked, &data, sizeof data);
    status = status != 0 ? status : check_mesh(client, &data);
    if (status != 0) {
        return status;
    }
    handle = *mesh;
    arrays_of(handle, &data, arrays);
    status = register_mesh(client, arrays, &handle, info);
    if (status == 0) {
        *mesh = handle;
    }
    return status;
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

/* One page of edges: as many as the result region has room for. */
static int fetch_edges(struct pccd_client *client, uint32_t mesh, uint32_t first,
                       uint32_t count, struct pccd_edge *edges, uint32_t *fetched)
{
    struct proto_MESH_EDGES_request request = {
        .mesh = mesh, .first = first, .count = count};
    struct proto_MESH_EDGES_result result;
    uint64_t page;
    int status = cli_call_page(client, PROTO_METHOD_MESH_EDGES, &request, &result,
                               cli_deadline(client, -1), &page);

    if (status == 0 && (result.count == 0 || result.count > count)) {
        status =
            cli_fail(client, PCCD_E_BUSY,
                     "mesh.edges: no room in the result region: release answers first");
    }
    if (status == 0) {
        memcpy(edges, cli_page_base(client, page) + result.offset,
               result.count * sizeof *edges);
        *fetched = result.count;
    }
    cli_page_release(client, page);
    return status;
}

int pccd_mesh_edges(struct pccd_client *client, uint32_t mesh, struct pccd_edge *edges,
                    uint32_t edge_count)
{
    uint32_t got = 0;
    uint32_t fetched = 0;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (edges == NULL && edge_count > 0) {
        return cli_fail(client, PCCD_E_INVAL, "mesh.edges: edges is NULL");
    }
    status = cli_ring_ensure(client);
    for (; status == 0 && got < edge_count; got += fetched) {
        fetched = 0;
        status = fetch_edges(client, mesh, got, edge_count - got, edges + got, &fetched);
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
