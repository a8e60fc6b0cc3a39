/* part.h - this rank's part of a mesh file.
 *
 * Room:     client/mpi/program. May include: meshfile.h, pccd_mpi.h, slices.h.
 * Does:     read a file, of which all ranks have a copy, and keep a slice of its
 *           vertices, triangles, edges and points: the whole is here only meanwhile.
 * Threads:  one.
 */
#ifndef PROGRAM_PART_H
#define PROGRAM_PART_H

#include "meshfile.h"
#include "pccd_mpi.h"

struct part {
    struct ctl_mesh slice;
    struct ctl_mesh whole; /* its counts; no arrays */
};

/* The slice of `path`; `before`, if it is not NULL, is the part of before_path that this
 * rank has, and the files have to be two frames of one mesh (ctl_mesh_match). Errors:
 * those of ctl_mesh_read and ctl_mesh_match. Not collective. */
int part_read(const char *path, const struct part *before, const char *before_path,
              struct part *part, struct ctl_error *error);
void part_deinit(struct part *part);

/* As pccd_mpi_mesh_put asks for it. */
struct pccd_mpi_part part_to_put(const struct part *part);

#endif
