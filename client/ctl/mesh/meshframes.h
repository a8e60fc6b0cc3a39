/* client/ctl/mesh/meshframes.h - the frames of one mesh, from files.
 *
 * Room:     client/ctl. May include: meshfile.h, motion.h, sequence.h.
 * Does:     open the files that were named, in the order of sequence.h: a mesh file is
 *           a frame, or as many as it has; a file of positions alone (PC2, MDD) has those
 *           of the mesh file before it, whose own positions are no frame then. All frames
 *           have the first one's shape; one at a time is read.
 * Threads:  one at a time.
 * Source:   used by check, load and near, and by pccd-mpi.
 */
#ifndef CTL_MESHFRAMES_H
#define CTL_MESHFRAMES_H

#include <stdint.h>

#include "error.h"
#include "meshfile.h"
#include "motion.h"
#include "sequence.h"

struct ctl_frames_options {
    struct ctl_motion_wish wish; /* of a file that moves by itself */
};

/* A file, and the frames that come from it. */
struct ctl_frames_source {
    const char *path; /* of the sequence */
    uint32_t frame_first, frame_count;
    struct ctl_motion motion; /* read is NULL: it is a mesh file with one frame */
};

struct ctl_frames {
    struct ctl_sequence sequence;
    struct ctl_mesh mesh;   /* the shape of all, with the positions of the first */
    const char *shape_path; /* the file that the shape is from */
    uint32_t count;
    char **names; /* [count]: where each is from, for reports */
    uint32_t source_count;
    struct ctl_frames_source *sources; /* in the order of the frames */
};

/* Open `paths`, names or patterns; `frames` is ctl_frames_close's to give back then, also
 * on error. Errors: those of ctl_sequence_expand, ctl_mesh_read and of the readers of
 * motions; E_INVAL for positions without a mesh file, or of other vertices than it has.
 */
int ctl_frames_open(struct ctl_frames *frames, char *const *paths, uint32_t path_count,
                    const struct ctl_frames_options *options, struct ctl_error *error);
/* Fill `frame`, which is empty or another frame, with the positions of frame `index`, and
 * no shape. Errors: likewise; E_INVAL, with both files and the first difference, where
 * its shape is another one. */
int ctl_frames_read(struct ctl_frames *frames, uint32_t index, struct ctl_mesh *frame,
                    struct ctl_error *error);
void ctl_frames_close(struct ctl_frames *frames);

#endif
