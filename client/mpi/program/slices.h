/* slices.h - a mesh that every rank has read, as the parts of a mesh of libpccd-mpi.
 *
 * Room:     client/mpi/program. May include: error.h, meshfile.h, pccd_mpi.h.
 * Does:     give each rank a slice of everything; tell the vertices of edges.
 * Threads:  one.
 */
#ifndef PROGRAM_SLICES_H
#define PROGRAM_SLICES_H

#include "error.h"
#include "meshfile.h"
#include "pccd_mpi.h"

/* Of `count` things, the first of rank r. */
uint32_t slices_first(uint32_t count, int r);

/* Vertices of a rank: `count` of them, from `first`. */
struct slice {
    uint32_t first, count;
};

/* Collective: register the mesh, *handle being 0. What went wrong is
 * pccd_mpi_error_text's. */
int slices_put_mesh(struct pccd_mpi *world, const struct ctl_mesh *mesh, uint32_t *handle,
                    struct pccd_mesh_info *info, struct slice *slice);

/* In this rank alone: all edges of the mesh, allocated. Errors: those of libpccd, which
 * is asked about the whole mesh. */
int slices_find_edges(const struct ctl_mesh *mesh, struct pccd_edge **edges,
                      struct ctl_error *error);

#endif
