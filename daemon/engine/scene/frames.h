/* daemon/engine/scene/frames.h - where the boxes of a scene's objects are measured from.
 *
 * Room:     engine. May include: frame.h, mesh.h.
 * Does:     choose a frame for each object before a step, so that single precision is
 *           fine enough for its boxes wherever the object is and however small.
 * Does not: touch what is decided exactly: elementary tests read the coordinates.
 * Threads:  [compute].
 *
 * Frames move whole objects closer together without changing what meets what. Along one
 * axis the objects fall into groups such that at both ends of the step all of one group
 * lies below all of the next. Two features of one group have the same origin, so their
 * distance along the axis is the true one at all times. Two features of different groups
 * are apart along the axis at both ends in the same order, and so in between: they never
 * meet, whatever their boxes say. So an empty gap between two groups may be shortened.
 */
#ifndef ENG_FRAMES_H
#define ENG_FRAMES_H

#include "frame.h"
#include "mesh.h"

struct eng_scene;

/* One object along one axis, while frames are chosen. */
struct eng_frame_item {
    double low[2]; /* at both ends */
    double high[2];
    double next_low[2]; /* the least of this object and all behind it */
    uint32_t object;
};

/* Of a scene. */
struct eng_framing {
    /* Which frames the boxes are measured in: the number of the choice, which shows
     * whether boxes are older; 0: in coordinates as they are. */
    uint64_t number;
    uint64_t chosen;              /* the last number */
    double scale;                 /* of all frames; 1 if there are none */
    unsigned ends[2];             /* of x[]: the ends of the step that they are for */
    struct eng_frame_item *items; /* [object_capacity] scratch to choose them */
};

/* Choose the frames of all objects: of a step whose t = 0 is in the positions x[from] and
 * t = 1 in x[to]. Objects are measured as they are as long as that is fine enough, which
 * it is for most scenes. O(objects); where it is not, O(n log n) of them. */
void eng_frames_choose(struct eng_scene *scene, unsigned from, unsigned to);

/* Around all objects at both ends of that step, as they are measured. False: there is no
 * object. */
bool eng_frames_extent(const struct eng_scene *scene, double low[3], double high[3]);

/* A frame for the features of one mesh among themselves, with vertices at x. */
struct eng_frame eng_frame_alone(const struct eng_mesh *mesh, const double (*x)[3]);

#endif
