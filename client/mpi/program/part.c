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
        status = ctl_mesh_read_like(path, &one, before_path, &other, error);
    }
    ctl_mesh_deinit(&one);
    ctl_mesh_deinit(&other);
    return status == PCCD_OK
               ? ctl_error_set(error, PCCD_E_INVAL, "%s or %s changed while it was read",
                               before_path, path)
               : status;
}

int part_read(const char *path, const struct ctl_mesh *before, const char *before_path,
              struct ctl_mesh *part, struct ctl_error *error)
{
    if (before == NULL) {
        return ctl_mesh_read_part(path, (uint32_t)together_rank(),
                                  (uint32_t)together_size(), part, error);
    }
    int status = ctl_mesh_read_like(path, before, before_path, part, error);
    return status == PCCD_E_INVAL ? explain(path, before_path, error) : status;
}

struct pccd_mpi_part part_to_put(const struct ctl_mesh *part)
{
    return (struct pccd_mpi_part){.struct_bytes = sizeof(struct pccd_mpi_part),
                                  .vertex_total = part->part.vertex_total,
                                  .triangle_total = part->part.triangle_total,
                                  .vertex_count = part->vertex_count,
                                  .format = part->format,
                                  .x = part->x,
                                  .triangle_count = part->triangle_count,
                                  .edge_count = part->edge_count,
                                  .point_count = part->point_count,
                                  .triangles = (const uint32_t *)part->triangles,
                                  .edges = (const uint32_t *)part->edges,
                                  .points = part->points};
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
