/* client/ctl/mesh/gltf_animation.h - what moves the nodes of a glTF file, and when.
 *
 * Room:     client/ctl. May include: gltf_accessor.h, gltf_node.h, motion.h.
 * Does:     choose animations, make frames of their keyframes or at a rate, and put the
 *           nodes where they are at one of them, in doubles: STEP, LINEAR, CUBICSPLINE.
 *           What moves no mesh, such as a camera's keys, makes no frames.
 * Does not: place vertices.
 * Threads:  one at a time.
 * Source:   "glTF 2.0 Specification", 3.11 and appendix C.
 */
#ifndef CTL_GLTF_ANIMATION_H
#define CTL_GLTF_ANIMATION_H

#include "gltf_accessor.h"
#include "gltf_node.h"
#include "motion.h"

enum gltf_path { GLTF_TRANSLATION, GLTF_ROTATION, GLTF_SCALE, GLTF_WEIGHTS, GLTF_PATHS };
enum gltf_between { GLTF_STEP, GLTF_LINEAR, GLTF_CUBICSPLINE };

/* One thing of one node. */
struct gltf_channel {
    size_t node;
    enum gltf_path path;
    enum gltf_between between;
    struct gltf_accessor times, values;
};

struct gltf_animation {
    struct gltf_channel *channels;
    size_t channel_count, channel_room;
    double *times; /* [time_count]: of all keys, ascending */
    size_t time_count, time_room;
    double rate;          /* frames a second; 0: a frame at each of the times */
    uint32_t frame_count; /* 0: nothing moves */
    /* For the report. */
    size_t moving_count; /* animations of the file that move a mesh, */
    size_t read_count;   /* and that were read */
    int64_t first;       /* of those, in the file */
    double turn_degrees; /* the greatest of a node between two keyframes */
    bool is_curved;      /* a node moves along a curve between two keys */
};

/* Choose the animation that has the name, or the number, of the wish; without one all
 * that move a mesh, if no two of them move the same, else the first of these. Then
 * nodes that move a mesh must be known. Errors: E_FORMAT, E_INVAL (no such animation),
 * E_LIMIT, E_NOMEM. */
int gltf_animation_read(struct gltf *gltf, struct gltf_tree *tree,
                        const struct ctl_motion_wish *wish,
                        struct gltf_animation *animation);
void gltf_animation_deinit(struct gltf_animation *animation);
/* When a frame is, in seconds. */
double gltf_animation_time(const struct gltf_animation *animation, uint32_t frame);
/* Write to the nodes what they have at a time: before the first key and after the last
 * what they have there. */
void gltf_animation_pose(const struct gltf_animation *animation, struct gltf_tree *tree,
                         double time);

#endif
