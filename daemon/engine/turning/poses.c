/* poses.c - the poses that were asked for last. */
#include "poses.h"

#include <string.h>

void eng_poses_begin(struct eng_poses *poses, const struct eng_path *path)
{
    poses->path = path;
    for (uint32_t i = 0; i < ENG_POSES_KEPT; i++) {
        poses->t[i] = -1;
    }
}

/* Return the only place in which the pose of a time is kept. */
static uint32_t place_of(double t)
{
    uint64_t bits;
    memcpy(&bits, &t, sizeof bits);
    return (uint32_t)(bits * 0x9e3779b97f4a7c15u >> 56) % ENG_POSES_KEPT;
}

const struct eng_path_pose *eng_poses_at(struct eng_poses *poses, double t)
{
    uint32_t at = place_of(t);
    if (poses->t[at] != t) {
        eng_path_pose(poses->path, t, &poses->pose[at]);
        poses->t[at] = t;
    }
    return &poses->pose[at];
}
