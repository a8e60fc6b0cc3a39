/* box_frames.h - chooses the frame of each object: the local coordinates in which its
 * boxes are stored.
 *
 * Frames move whole objects closer together without changing what meets what. Along one
 * axis the objects fall into groups such that at both ends of the step all of one group
 * lies below all of the next. Two features of one group have the same origin, so their
 * distance along the axis is the true one at all times. Two features of different groups
 * are apart along the axis at both ends in the same order, and so in between: they never
 * meet, whatever their boxes say. So an empty gap between two groups may be shortened.
 *
 * What does not help: two fine objects far from each other, both beside one that reaches
 * from the one to the other. All three are one group, and floats are finest at the finest
 * of them. Two sheets of 3481 squares, 1 m wide and 10^7 m apart along x, above one road,
 * have 19 times the candidates that they have without it; 10^5 m apart they have as many.
 */
#ifndef ENG_BOX_FRAMES_H
#define ENG_BOX_FRAMES_H

#include "world.h"

/* Choose the frames of all objects: of a step whose t = 0 is in the positions x[from] and
 * t = 1 in x[to]. Objects are measured as they are as long as that is fine enough, which
 * it is for most scenes. O(objects); where it is not, O(n log n) of them. */
void eng_box_frames_choose(struct eng_scene *scene, unsigned from, unsigned to);

/* Return whether features never lie farther apart in the frames than they are, along any
 * axis, at either end. For steps they may: two of different groups cannot meet anyway.
 * For steps with thickness, and whoever asks what is near, they must not. */
bool eng_box_frames_keep_distances(const struct eng_scene *scene);

/* Choose frames that do. Gaps are shortened at each end by itself. */
void eng_box_frames_choose_keeping(struct eng_scene *scene, unsigned from, unsigned to);

/* Choose frames for the step that the scene has just moved on by, that keep distances if
 * it has thickness. Where little moves, and they still do as they should, the frames of
 * the step before stay. */
void eng_box_frames_follow(struct eng_scene *scene);

/* Write the bounds of all objects at both ends of the step that frames were last chosen
 * for, as they are measured. False: there is no object. */
bool eng_box_frames_extent(const struct eng_scene *scene, double low[3], double high[3]);

/* Return a frame for the features of one mesh among themselves, with vertices at x. */
struct eng_box_frame eng_box_frame_alone(const struct eng_mesh *mesh,
                                         const double (*x)[3]);

#endif
