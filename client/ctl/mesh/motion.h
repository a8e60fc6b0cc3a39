/* client/ctl/mesh/motion.h - the positions that one file has for several frames.
 *
 * Room:     client/ctl. May include: error.h, pccd_types.h.
 * Does:     what an animated glTF file, PC2 and MDD have in common: frames of one shape,
 *           of which one at a time is read.
 * Does not: say what the shape is: a mesh file does (meshfile.h).
 * Threads:  one at a time.
 */
#ifndef CTL_MOTION_H
#define CTL_MOTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "error.h"
#include "pccd_types.h"

/* What is wanted of a file whose frames are not numbered; of others nothing. */
struct ctl_motion_wish {
    double rate;           /* frames a second, finite and > 0; 0: at its keyframes */
    const char *animation; /* its name, or number from 0; NULL: what the reader chooses */
};

/* Filled by whoever opens the file; then close() ends it. */
struct ctl_motion {
    uint32_t frame_count; /* at least 1 */
    uint32_t vertex_count;
    enum pccd_format format; /* of what read() fills */
    void *state;             /* the reader's */
    /* Fill x[vertex_count][3], float or double, of a frame: 0 to frame_count - 1, in any
     * order. Errors: E_SYSTEM, E_NOMEM, E_FORMAT, E_NOTFINITE; the text names file, frame
     * and byte. */
    int (*read)(const struct ctl_motion *motion, uint32_t frame, void *x,
                struct ctl_error *error);
    /* Which frame that is in the file's own words, such as "frame 3" or "0.25 s". */
    void (*name)(const struct ctl_motion *motion, uint32_t frame, char *text,
                 size_t bytes);
    /* What a user should know of these frames, a sentence or two; false: nothing. NULL:
     * there never is. */
    bool (*note)(const struct ctl_motion *motion, char *text, size_t bytes);
    void (*close)(struct ctl_motion *motion);
};

#endif
