/* client/ctl/record/frames.h - a recording of the frames of a mesh, for commands that
 * show recordings.
 *
 * Room:     client/ctl. May include: error.h, link.h.
 * Does:     have a daemon compute the steps from frame to frame, and record them in a
 *           file that goes away again.
 * Threads:  one.
 */
#ifndef CTL_FRAMES_H
#define CTL_FRAMES_H

#include "error.h"
#include "link.h"

#define FRAMES_PATH_BYTES 4096

/* Zero before; `path` has the recording's afterwards. */
struct frames_recording {
    char folder[FRAMES_PATH_BYTES]; /* ours; "": none */
    char path[FRAMES_PATH_BYTES];
};

/* Record `count` files of one mesh, at least one; one alone stands still for a step. The
 * file is named after the first and the last. Errors: those of reading and matching them;
 * of the daemon; E_CANCELLED: interrupted. */
int frames_record(struct frames_recording *recording, char *const *files, uint32_t count,
                  const struct ctl_link *link, struct ctl_error *error);
/* Take file and folder away. */
void frames_remove(struct frames_recording *recording);

#endif
