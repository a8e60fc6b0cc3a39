/* part.h - this rank's part of a mesh file.
 *
 * Room:     client/mpi/program. May include: meshfile.h, pccd_mpi.h.
 * Does:     read a file, of which all ranks have a copy, and keep a run of its vertices,
 *           triangles, edges and points; tell the root of the whole what only it names.
 * Threads:  one.
 */
#ifndef PROGRAM_PART_H
#define PROGRAM_PART_H

#include "meshfile.h"
#include "pccd_mpi.h"

/* The part of `path`; `before`, if it is not NULL, is the part of another file that this
 * rank has, and the files have to be two frames of one mesh (ctl_mesh_match). Errors:
 * those of ctl_mesh_read_as. Not collective. */
int part_read(const char *path, const struct ctl_mesh *before, struct ctl_mesh *part,
              struct ctl_error *error);

/* As pccd_mpi_mesh_put asks for it. */
struct pccd_mpi_part part_to_put(const struct ctl_mesh *part);

/* In this rank alone: the whole mesh of a file, and all its edges, allocated. Errors:
 * those of ctl_mesh_read and of libpccd, which is asked about the mesh. */
int part_read_whole(const char *path, struct ctl_mesh *whole, struct pccd_edge **edges,
                    struct ctl_error *error);

#endif
