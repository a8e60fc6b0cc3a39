/* slices.c - a mesh that every rank has read, in parts.
 *
 * Room:     client/mpi/program.
 * Does:     cut by numbers.
 * Threads:  one.
 * Source:   slices.h.
 */
#include "slices.h"

#include <stdlib.h>

#include "check_run.h"
#include "coordinates.h"
#include "together.h"

uint32_t slices_first(uint32_t count, int r)
{
    return (uint32_t)((uint64_t)count * (uint32_t)r / (uint32_t)together_size());
}

int slices_put_mesh(struct pccd_mpi *world, const struct ctl_mesh *mesh, uint32_t *handle,
                    struct pccd_mesh_info *info, struct slice *slice)
{
    int rank = together_rank();
    uint32_t triangle = slices_first(mesh->triangle_count, rank);
    uint32_t edge = slices_first(mesh->edge_count, rank);
    uint32_t point = slices_first(mesh->point_count, rank);
    slice->first = slices_first(mesh->vertex_count, rank);
    slice->count = slices_first(mesh->vertex_count, rank + 1) - slice->first;
    const struct pccd_mpi_part part = {
        .struct_bytes = sizeof part,
        .vertex_total = mesh->vertex_count,
        .triangle_total = mesh->triangle_count,
        .vertex_count = slice->count,
        .format = mesh->format,
        .x = (const char *)mesh->x +
             (size_t)slice->first * common_vertex_bytes(mesh->format),
        .triangle_count = slices_first(mesh->triangle_count, rank + 1) - triangle,
        .edge_count = slices_first(mesh->edge_count, rank + 1) - edge,
        .point_count = slices_first(mesh->point_count, rank + 1) - point,
        .triangles = mesh->triangles ? mesh->triangles[triangle] : NULL,
        .edges = mesh->edges ? mesh->edges[edge] : NULL,
        .points = mesh->points ? mesh->points + point : NULL};
    return pccd_mpi_mesh_put(world, &part, handle, info);
}

int slices_find_edges(const struct ctl_mesh *mesh, struct pccd_edge **edges,
                      struct ctl_error *error)
{
    const struct pccd_options options = {
        .struct_bytes = sizeof options, .url = "direct:", .no_keep = true};
    struct pccd_client *client = NULL;
    uint32_t handle = 0;
    struct pccd_mesh_info info;
    int status = pccd_connect(&options, &client);
    if (status == PCCD_OK) {
        status = check_run_put_mesh(client, mesh, &handle, &info);
    }
    if (status == PCCD_OK) {
        *edges = malloc(((size_t)info.edge_count + 1) * sizeof **edges);
        status = *edges == NULL
                     ? PCCD_E_NOMEM
                     : pccd_mesh_edges(client, handle, *edges, info.edge_count);
    }
    if (status != PCCD_OK) {
        (void)ctl_error_set(error, status, "edges: %s", pccd_status_text(status));
    }
    pccd_close(client);
    return status;
}
