/* poses.h - the poses of a path at the times that were asked for last, kept.
 *
 * All pairs of two bodies are looked at at the same few times, and a pose takes longer
 * than what is done with it.
 *
 * Threads: one thread for one struct eng_poses.
 */
#ifndef ENG_POSES_H
#define ENG_POSES_H

#include "path.h"

#define ENG_POSES_KEPT 256u /* a power of two; 30 KiB */

struct eng_poses {
    const struct eng_path *path;
    double t[ENG_POSES_KEPT]; /* -1: none is kept here */
    struct eng_path_pose pose[ENG_POSES_KEPT];
};

/* Forget what is kept, and take a path; it stays the caller's. */
void eng_poses_begin(struct eng_poses *poses, const struct eng_path *path);

/* Return the pose at time t, 0 .. 1, until the next one is asked for. */
const struct eng_path_pose *eng_poses_at(struct eng_poses *poses, double t);

#endif
