/* client/ctl/mesh/meshframes.h - the frames of one mesh, from files.
 *
 * In the order of sequence.h a mesh file is a frame, or as many as it has; a file of
 * positions alone (PC2, MDD) has those of the mesh file before it, whose own positions
 * are no frame then. All frames have the first one's shape; one at a time is read.
 */
#ifndef CTL_MESHFRAMES_H
#define CTL_MESHFRAMES_H

#include <stdbool.h>
#include <stdint.h>

#include "error.h"
#include "meshfile.h"
#include "motion.h"
#include "sequence.h"

struct ctl_frames_options {
    struct ctl_motion_wish wish; /* of a file that moves by itself */
    /* Vertices that are at most so far apart in every frame are one; 0: that are at one
     * place; negative: none are. */
    double weld;
    bool first_alone; /* of later frames only their number is wanted: they are not read */
};

/* Outcome of joining vertices at one place. */
struct ctl_welded {
    double within;        /* what was asked for; 0: at one place */
    uint32_t frame_count; /* that were looked at */
    uint32_t joined;      /* to the least vertex at their place in every frame */
    uint32_t apart;       /* as much in the first frame, and apart in a later one */
    uint32_t more;        /* of weld 0: would be joined at 2^-40 of the size */
    double distance;      /* that is */
    uint32_t flat;        /* triangles that have one vertex twice because of that */
    uint32_t between;     /* of those joined: to a vertex of another object of the file */
};

/* A file, and the frames that come from it. */
struct ctl_frames_source {
    const char *path; /* of the sequence */
    uint32_t frame_first, frame_count;
    struct ctl_motion motion; /* read is NULL: it is a mesh file with one frame */
    bool is_stl;              /* it has corners, which are vertices by their places */
    struct ctl_mesh held;     /* of a pipe, which can be read once */
};

struct ctl_frames {
    struct ctl_sequence sequence;
    /* The shape of all, with the positions of the first, and the path of the file that it
     * is from. A vertex that was joined to another one is there, and nothing names it. */
    struct ctl_mesh mesh;
    struct ctl_mesh shape; /* the same as the file has it; its arrays are mesh's, but for
                              lists where vertices were joined */
    struct ctl_welded welded;
    uint32_t count;
    char **names; /* [count]: where each is from, for reports */
    uint32_t source_count;
    struct ctl_frames_source *sources; /* in the order of the frames */
};

/* Open `paths`, names or patterns; `frames` is ctl_frames_close's to give back then, also
 * on error. Errors: those of ctl_sequence_expand, ctl_mesh_read and of the readers of
 * motions; E_INVAL for positions of other vertices than the mesh file has. */
int ctl_frames_open(struct ctl_frames *frames, char *const *paths, uint32_t path_count,
                    const struct ctl_frames_options *options, struct ctl_error *error);
/* Fill `frame`, which is empty or another frame, with the positions of frame `index`, and
 * no shape. Errors: those of ctl_frames_open; E_INVAL, with both files and the first
 * difference, where its shape is another one. */
int ctl_frames_read(struct ctl_frames *frames, uint32_t index, struct ctl_mesh *frame,
                    struct ctl_error *error);
/* Join vertices of a shape, which the caller has found: give the mesh its rows with to[v]
 * in the place of each vertex v, and count the triangles that are flat because of that.
 * Errors: E_NOMEM. */
int ctl_frames_rename(struct ctl_frames *frames, const uint32_t *to,
                      struct ctl_error *error);
void ctl_frames_close(struct ctl_frames *frames);

#endif
