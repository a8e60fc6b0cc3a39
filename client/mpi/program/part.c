/* part.c - this rank's part of a mesh file.
 *
 * Room:     client/mpi/program.
 * Does:     move slices to the front of their arrays, and give back the rest.
 * Threads:  one.
 * Source:   part.h.
 */
#include "part.h"

#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "slices.h"
#include "together.h"

/* Of array[*count] this rank's slice. The memory is given back by a smaller copy, as an
 * array that shrinks in its place may leave a hole behind it. */
static void *keep(void *array, uint32_t *count, size_t item_bytes)
{
    uint32_t first = slices_first(*count, together_rank());
    uint32_t kept = slices_first(*count, together_rank() + 1) - first;
    *count = kept;
    if (array == NULL) {
        return NULL;
    }
    const char *from = (const char *)array + first * item_bytes;
    void *copy = malloc(kept * item_bytes + 1);
    if (copy == NULL) {
        memmove(array, from, kept * item_bytes);
        return array;
    }
    memcpy(copy, from, kept * item_bytes);
    free(array);
    return copy;
}

static void keep_slice(struct ctl_mesh *mesh)
{
    mesh->x = keep(mesh->x, &mesh->vertex_count, common_vertex_bytes(mesh->format));
    mesh->triangles =
        keep(mesh->triangles, &mesh->triangle_count, sizeof *mesh->triangles);
    mesh->edges = keep(mesh->edges, &mesh->edge_count, sizeof *mesh->edges);
    mesh->points = keep(mesh->points, &mesh->point_count, sizeof *mesh->points);
    mesh->triangle_capacity = mesh->triangle_count;
    mesh->edge_capacity = mesh->edge_count;
    mesh->point_capacity = mesh->point_count;
}

static bool have_same_counts(const struct ctl_mesh *a, const struct ctl_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           a->edge_count == b->edge_count && a->point_count == b->point_count;
}

/* What differs is told of the files, which are read once more. */
static int explain(const char *path, const char *before_path, struct ctl_error *error)
{
    struct ctl_mesh one = {0}, other = {0};
    int status = ctl_mesh_read(before_path, &one, error);
    if (status == PCCD_OK) {
        status = ctl_mesh_read(path, &other, error);
    }
    if (status == PCCD_OK) {
        status = ctl_mesh_match(&one, before_path, &other, path, error);
    }
    ctl_mesh_deinit(&one);
    ctl_mesh_deinit(&other);
    return status == PCCD_OK
               ? ctl_error_set(error, PCCD_E_INVAL, "%s or %s changed while it was read",
                               before_path, path)
               : status;
}

int part_read(const char *path, const struct part *before, const char *before_path,
              struct part *part, struct ctl_error *error)
{
    struct ctl_error difference;
    int status = ctl_mesh_read(path, &part->slice, error);
    if (status != PCCD_OK) {
        return status;
    }
    part->whole = (struct ctl_mesh){.vertex_count = part->slice.vertex_count,
                                    .triangle_count = part->slice.triangle_count,
                                    .edge_count = part->slice.edge_count,
                                    .point_count = part->slice.point_count};
    keep_slice(&part->slice);
    if (before != NULL && (!have_same_counts(&before->whole, &part->whole) ||
                           ctl_mesh_match(&before->slice, before_path, &part->slice, path,
                                          &difference) != PCCD_OK)) {
        return explain(path, before_path, error);
    }
    return PCCD_OK;
}

void part_deinit(struct part *part)
{
    ctl_mesh_deinit(&part->slice);
    *part = (struct part){.slice = {0}};
}

struct pccd_mpi_part part_to_put(const struct part *part)
{
    const struct ctl_mesh *slice = &part->slice;
    return (struct pccd_mpi_part){.struct_bytes = sizeof(struct pccd_mpi_part),
                                  .vertex_total = part->whole.vertex_count,
                                  .triangle_total = part->whole.triangle_count,
                                  .vertex_count = slice->vertex_count,
                                  .format = slice->format,
                                  .x = slice->x,
                                  .triangle_count = slice->triangle_count,
                                  .edge_count = slice->edge_count,
                                  .point_count = slice->point_count,
                                  .triangles = (const uint32_t *)slice->triangles,
                                  .edges = (const uint32_t *)slice->edges,
                                  .points = slice->points};
}
