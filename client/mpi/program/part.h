/* part.h - this rank's part of a mesh, frame by frame.
 *
 * Read files, of which all ranks have a copy, and keep a run of the vertices, triangles,
 * edges and points. Of PLY and OBJ no rank has more at any time; others are read whole by
 * each.
 */
#ifndef PROGRAM_PART_H
#define PROGRAM_PART_H

#include "check_run.h"
#include "meshframes.h"
#include "pccd_mpi.h"

struct part_options {
    struct ctl_frames_options frames;
    bool names_features; /* the root wants part.named */
    bool names_objects;  /* the root wants names of objects, where there are several */
};

/* Filled by part_open. */
struct part {
    bool is_whole; /* each rank has all of the shape */
    /* As pccdctl has them; of the shape this rank's part, unless it is whole. */
    struct ctl_frames files;
    /* On the root, if it is wanted: the shape, with vertices that are joined, and its
     * edges. */
    struct ctl_mesh named;
    struct pccd_edge *edges;
    uint32_t edge_count;
};

/* Collective. Open `paths`, names or patterns; `part` is part_close's to give back then,
 * also on error. Errors: those of ctl_frames_open, and of libpccd, which is asked about
 * edges; E_INVAL for a pipe, which can be read once; E_STATE where ranks have other
 * files. */
int part_open(struct part *part, char *const *paths, uint32_t path_count,
              const struct part_options *options, struct ctl_error *error);
/* Fill `frame`, which is empty or another frame, with the positions of frame `index` that
 * this rank keeps. Not collective. Errors: those of ctl_frames_read. */
int part_read(struct part *part, uint32_t index, struct ctl_mesh *frame,
              struct ctl_error *error);
/* Collective. Set *to, for each vertex of the mesh, to the least one that it is joined
 * to; it is the caller's to free, and stays NULL where none is joined.
 * part->files.welded: how many are, but for what only who has all rows knows.
 * `distance`, 0 or more, is as in struct ctl_frames_options. Errors: E_NOMEM, and
 * those of part_read. */
int part_weld(struct part *part, double distance, uint32_t **to, struct ctl_error *error);
/* Return the part as pccd_mpi_mesh_put asks for it; `first` is frame 0. */
struct pccd_mpi_part part_to_put(const struct part *part, const struct ctl_mesh *first);
/* Free what only further frames want: none is read from here on. */
void part_drop_rows(struct part *part);
void part_close(struct part *part);

/* Collective. Say where the earliest contact is of those that ranks bring: `mine`, whose
 * toi is above 1 if this rank has none. It is between features of one object, which goes
 * from the positions that this rank has in frames[0] to those in frames[1]. On the root:
 * with the parts of `objects`, unless that is NULL. `first` stays as it is where no rank
 * has one. The same status on every rank. Errors: those of pccd_mpi_feature, E_SYSTEM. */
int first_find(struct pccd_mpi *world, const struct pccd_contact *mine,
               const struct ctl_mesh *const frames[2], const struct objects *objects,
               struct report_first *first, struct ctl_error *error);

#endif
