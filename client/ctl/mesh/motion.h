/* client/ctl/mesh/motion.h - the frames that one file has: a glTF file, PC2 or MDD. */
#ifndef CTL_MOTION_H
#define CTL_MOTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "pccd_types.h"
#include "text.h"

/* Wishes about a file whose frames are not numbered; other files ignore them. */
#define FRAMES_RATE_MIN 1e-6 /* frames a second */
#define FRAMES_RATE_MAX 1e6

struct ctl_motion_wish {
    double rate;           /* frames a second, finite and > 0; 0: at its keyframes */
    const char *animation; /* its name, or number from 0; NULL: what the reader chooses */
    bool takes_cut;        /* of a point cache that is cut off behind its second frame,
                              those that are not whole are there, and cannot be read */
};

struct ctl_mesh;

/* Open until ctl_motion_close; it stays where it is, as does the path. */
struct ctl_motion {
    struct ctl_file file;
    uint32_t frame_count;    /* at least 1 */
    uint32_t vertex_count;   /* 0: shape() alone reads the only frame (glTF at rest) */
    enum pccd_format format; /* of what read() fills */
    void *state;             /* the reader's; of malloc */
    /* Fill x[vertex_count][3], float or double, of a frame: 0 to frame_count - 1, in any
     * order. Errors: E_SYSTEM, E_NOMEM, E_FORMAT, E_NOTFINITE; the text names file, frame
     * and byte. */
    int (*read)(const struct ctl_motion *motion, uint32_t frame, void *x,
                struct ctl_error *error);
    /* Fill `mesh`, which is empty but for path and error, with the shape and the first
     * frame's positions: of an only one floats, if that is exact. NULL: it has positions
     * alone. */
    int (*shape)(const struct ctl_motion *motion, struct ctl_mesh *mesh);
    /* Which frame that is in the file's own words, such as "frame 3" or "0.25 s". */
    void (*name)(const struct ctl_motion *motion, uint32_t frame, char *text,
                 size_t bytes);
    /* What a user should know of these frames, a sentence or two; false: nothing. NULL:
     * there never is. */
    bool (*note)(const struct ctl_motion *motion, char *text, size_t bytes);
    /* Give back what the state has. NULL: nothing. */
    void (*close)(struct ctl_motion *motion);
};

/* Fill a motion whose file was opened; a pipe has been read to its end. */
typedef int ctl_motion_reader(struct ctl_motion *motion,
                              const struct ctl_motion_wish *wish);

/* Open a file, and fill an empty motion by the reader. Errors: E_SYSTEM, E_NOMEM,
 * E_FORMAT and those of the reader; the motion is empty then. */
int ctl_motion_open(const char *path, ctl_motion_reader *reader,
                    const struct ctl_motion_wish *wish, struct ctl_motion *motion,
                    struct ctl_error *error);
/* Close a motion, also an empty one; it is empty then. */
void ctl_motion_close(struct ctl_motion *motion);

/* Fill a motion with all frames of a file. Of glTF without a wish for one all animations
 * that move a mesh are played at once, if no two of them move the same thing; else the
 * first of them. E_INVAL: there is no animation that is wished for. Of point caches a
 * piece of 64 KiB is in memory, of a pipe all. */
ctl_motion_reader ctl_gltf_open, ctl_pc2_open, ctl_mdd_open;

#endif
