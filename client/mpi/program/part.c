/* part.c - this rank's part of a mesh file.
 *
 * Room:     client/mpi/program.
 * Does:     read the piece with the rank's number; compare it with that of the frame
 *           before.
 * Threads:  one.
 * Source:   part.h.
 */
#include "part.h"

#include <stdlib.h>
#include <string.h>

#include "check_run.h"
#include "together.h"

/* What differs is told of the files, which are read once more. */
static int explain(const char *path, const char *before_path, struct ctl_error *error)
{
    struct ctl_mesh one = {0}, other = {0};
    int status = ctl_mesh_read(before_path, &one, error);
    if (status == PCCD_OK) {
        const struct ctl_reading like = {.like = &one};
        status = ctl_mesh_read_as(path, &like, &other, error);
    }
    ctl_mesh_deinit(&one);
    ctl_mesh_deinit(&other);
    return status == PCCD_OK
               ? ctl_error_set(error, PCCD_E_INVAL, "%s or %s changed while it was read",
                               before_path, path)
               : status;
}

int part_read(const char *path, const struct ctl_mesh *before, struct ctl_mesh *part,
              struct ctl_error *error)
{
    const struct ctl_reading reading = {.number = (uint32_t)together_rank(),
                                        .count = (uint32_t)together_size(),
                                        .like = before};
    int status = ctl_mesh_read_as(path, &reading, part, error);
    return before != NULL && status == PCCD_E_INVAL ? explain(path, before->path, error)
                                                    : status;
}

struct pccd_mpi_part part_to_put(const struct ctl_mesh *part)
{
    return (struct pccd_mpi_part){.struct_bytes = sizeof(struct pccd_mpi_part),
                                  .vertex_total = part->part.vertex_total,
                                  .triangle_total = part->triangles.total,
                                  .vertex_count = part->vertex_count,
                                  .format = part->format,
                                  .x = part->x,
                                  .triangle_count = part->triangles.count,
                                  .edge_count = part->edges.count,
                                  .point_count = part->points.count,
                                  .triangles = part->triangles.vertices,
                                  .edges = part->edges.vertices,
                                  .points = part->points.vertices};
}

static int find_edges(const struct ctl_mesh *mesh, struct pccd_edge **edges,
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

int part_read_whole(const char *path, struct ctl_mesh *whole, struct pccd_edge **edges,
                    struct ctl_error *error)
{
    int status = ctl_mesh_read(path, whole, error);
    return status == PCCD_OK ? find_edges(whole, edges, error) : status;
}
