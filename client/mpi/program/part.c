/* part.c - this rank's part of a mesh, frame by frame. */
#include "part.h"

#include <stdlib.h>

#include "together.h"

/* Explain what differs between two files, which are read once more. */
static int explain(const char *path, const char *first_path, struct ctl_error *error)
{
    struct ctl_mesh one = {0}, other = {0};
    int status = ctl_mesh_read(first_path, &one, error);
    if (status == PCCD_OK) {
        const struct ctl_reading like = {.like = &one};
        status = ctl_mesh_read_as(path, &like, &other, error);
    }
    ctl_mesh_deinit(&one);
    ctl_mesh_deinit(&other);
    return status == PCCD_OK
               ? ctl_error_set(error, PCCD_E_INVAL, "%s or %s changed while it was read",
                               first_path, path)
               : status;
}

int part_read(struct part *part, uint32_t index, struct ctl_mesh *frame,
              struct ctl_error *error)
{
    struct ctl_frames *files = &part->files;
    int status = PCCD_OK;
    if (part->is_whole) {
        status = ctl_frames_read(files, index, frame, error);
        if (status == PCCD_OK) {
            ctl_mesh_keep_part(frame, (uint32_t)together_rank(),
                               (uint32_t)together_size());
        }
        return status;
    }
    ctl_mesh_deinit(frame);
    if (index == 0) {
        *frame = (struct ctl_mesh){.path = files->mesh.path,
                                   .x = files->mesh.x,
                                   .format = files->mesh.format,
                                   .vertex_count = files->mesh.vertex_count,
                                   .part = files->mesh.part};
        files->mesh.x = NULL;
        return PCCD_OK;
    }
    const struct ctl_reading reading = {.number = (uint32_t)together_rank(),
                                        .count = (uint32_t)together_size(),
                                        .like = &files->shape};
    status = ctl_mesh_read_as(files->names[index], &reading, frame, error);
    ctl_mesh_drop_shape(frame);
    return status == PCCD_E_INVAL ? explain(files->names[index], files->mesh.path, error)
                                  : status;
}

/* Return what this rank puts of a list that is this rank's, or of all ranks; *count: how
 * many rows. */
static const uint32_t *rows_of(const struct part *part, enum ctl_kind kind,
                               uint32_t *count)
{
    const struct ctl_list *list = &part->files.mesh.lists[kind];
    const uint64_t ranks = (uint64_t)together_size(), rank = (uint64_t)together_rank();
    uint64_t first = part->is_whole ? list->count * rank / ranks : 0;
    uint64_t end = part->is_whole ? list->count * (rank + 1) / ranks : list->count;
    *count = (uint32_t)(end - first);
    return *count > 0 ? list->vertices + first * ((uint64_t)kind + 1) : NULL;
}

struct pccd_mpi_part part_to_put(const struct part *part, const struct ctl_mesh *first)
{
    struct pccd_mpi_part put = {.struct_bytes = sizeof put,
                                .vertex_total = first->part.vertex_total,
                                .triangle_total = part->files.mesh.triangles.total,
                                .vertex_count = first->vertex_count,
                                .format = first->format,
                                .x = first->x};
    put.triangles = rows_of(part, CTL_TRIANGLES, &put.triangle_count);
    put.edges = rows_of(part, CTL_EDGES, &put.edge_count);
    put.points = rows_of(part, CTL_POINTS, &put.point_count);
    return put;
}

void part_drop_rows(struct part *part)
{
    struct ctl_mesh *mesh = &part->files.mesh, *shape = &part->files.shape;
    for (int kind = 0; kind < CTL_KINDS && !part->is_whole; kind++) {
        struct ctl_list *list = &mesh->lists[kind], *other = &shape->lists[kind];
        if (list->vertices != other->vertices) {
            free(list->vertices);
        }
        free(other->vertices);
        *list = *other = (struct ctl_list){.count = 0};
    }
}

void part_close(struct part *part)
{
    if (!part->is_whole) {
        part->files.names = NULL; /* they are the sequence's */
        ctl_mesh_deinit(&part->named);
    }
    free(part->edges);
    ctl_frames_close(&part->files);
    *part = (struct part){.edges = NULL};
}
