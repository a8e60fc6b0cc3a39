/* pccd_turning.h - bodies that turn: steps in which objects hang on joints.
 *
 * A body that turns leaves the straight line. Here its motion is said as it is meant: a
 * chain of joints (struct pccd_joint of pccd_types.h), whose values go straight while t
 * goes from 0 to 1. All joints of a step are one table; each object that moves so hangs
 * on one of them, and what it meets is decided along the curve. Two that hang on joints
 * of one table move against each other by the joints between them alone.
 *
 * A door of 90 degrees, whose pin is the z axis through `pin`:
 *
 *     struct pccd_joint joints[PCCD_JOINTS_MOST];
 *     uint32_t count = 0;
 *     pccd_joints_screw(pin, (double[3]){0, 0, 1}, M_PI / 2, 0, PCCD_NO_JOINT, joints,
 *                       PCCD_JOINTS_MOST, &count);
 *     struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
 *     settings.joints = joints;
 *     settings.joint_count = count;
 *     struct pccd_motion turns = {.object = door, .first = count - 1,
 *                                 .count = vertex_count};
 *     pccd_step(client, scene, &turns, 1, &settings, &answer);
 *
 * A contact of a body that turns has PCCD_PROVED, as others have, or not: then it is only
 * known that the two come within `resolution` of the distance at which they meet. For
 * example, a ball that rolls exactly along a wall touches it or does not, which no finite
 * computation can tell. Either way they are free before toi, and toi_hi is by when they
 * have met, or the end of the time in which they may.
 *
 * Of a robot: a motion is proved to be free if safe_step is 1, or if the answer is
 * complete and total is 0; an incomplete one may have no contacts, either. It has to
 * begin where nothing crosses (PCCD_NEAR_CROSSINGS with at_begin, pccd_near.h).
 * Obstacles meet each other, too, though they stand still: two that touch are a contact
 * at t = 0 of every step. So give links one group and obstacles another one, which only
 * the mask of links has. With a distance to keep (separation, radii), what is thinner
 * meets itself: turn its self_collision off (struct pccd_object_settings). Links that are
 * joined leave a gap, or ignore each other (pccd_pair_ignore).
 *
 * Threads: as pccd.h, which includes this header; pccd_joints_* and
 * pccd_rotation_of_matrix need no client: [any thread]. What they say of an error is
 * pccd_error_text(NULL).
 */
#ifndef PCCD_TURNING_H
#define PCCD_TURNING_H

#include <stdint.h>

#include "pccd_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

struct pccd_frame;

#define PCCD_JOINTS_MOST 3u /* that one of the pccd_joints_ below adds */

/* ---- what makes joints ------------------------------------------------------------- */

/* Each adds up to PCCD_JOINTS_MOST joints to a table, joints[room]: joints[*count] and so
 * on, on the joint `parent` (PCCD_NO_JOINT: the world). *count is 0 of a new table, such
 * as that of the next step; afterwards it is how many there are, and *count - 1 the joint
 * that a body hangs on. Lengths are in the
 * unit of coordinates, angles in radians, any finite ones of at most 2^20 turns; positive
 * is right-handed. A vector that says a direction may have any length from 1e-9 to 1e9.
 * Errors: E_INVAL: a pointer is NULL, a parent that is not in the table, a number that is
 * not finite or beyond 1e18, a vector or quaternion without direction, an angle that is
 * too large; E_LIMIT: room for less than PCCD_JOINTS_MOST more. */

/* Turn by `angle` about the axis through `centre`, and go by `shift` along it meanwhile:
 * x(t) = centre + R(axis, angle t) (x - centre) + t shift axis / |axis|. */
int pccd_joints_screw(const double centre[3], const double axis[3], double angle,
                      double shift, uint32_t parent, struct pccd_joint *joints,
                      uint32_t room, uint32_t *count);

/* Where a body is: x is at position + R(rotation) x. */
struct pccd_pose {
    double position[3];
    double rotation[4]; /* quaternion x y z w, of any length from 1e-9 to 1e9 */
};

/* Go from one pose to another, the origin straight and the turn at constant speed about
 * one axis: linear and slerp. With `axis` NULL it turns the shortest way; within 1e-6
 * radians of half a turn there is none, and the call is E_INVAL: rounding would choose.
 * Else it turns right-handed about the direction in which the relative axis lies that is
 * nearer to `axis`, by less than a turn; E_INVAL if neither is, within 1e-6. `turns`
 * whole turns are added, in that direction, or against it if negative; if both rotations
 * are the same they are about `axis`. The last pose is reached to within some 1e-15 of a
 * turn: the angle is rounded, and computed by the C library. */
int pccd_joints_poses(const struct pccd_pose *from, const struct pccd_pose *to,
                      int32_t turns, const double axis[3], uint32_t parent,
                      struct pccd_joint *joints, uint32_t room, uint32_t *count);

/* Go from one pose to another, with the rotation vector going straight from w0 to w1, as
 * codes for rigid bodies interpolate it: x(t) = origin(t) + R(w(t) / |w(t)|, |w(t)|) x,
 * both linear in t. */
int pccd_joints_rotation_vector(const double origin0[3], const double origin1[3],
                                const double w0[3], const double w1[3], uint32_t parent,
                                struct pccd_joint *joints, uint32_t room,
                                uint32_t *count);

/* Set `rotation` to the quaternion (x y z w, of length 1, w not negative) of a transform,
 * rows of [R | t], whose R is a rotation: R^T R differs from 1 by at most 1e-6 in each
 * number, and it does not mirror. E_INVAL: else, and the text says by how much it
 * differs. */
int pccd_rotation_of_matrix(const double m[12], double rotation[4]);

/* Set m, rows of [R | t], to where a joint of a table of `count` has its body at time t,
 * 0 .. 1: it takes the registered positions there, at both ends of the step as the daemon
 * has them, to the last bit. At the toi of a contact it tells where that is: with m as
 * both m0 and m1 of the body, pccd_points has its points (pccd_points.h). E_INVAL: also
 * no such joint, or another t. */
int pccd_joints_place(const struct pccd_joint *joints, uint32_t count, uint32_t joint,
                      double t, double m[12]);

/* ---- in a frame -------------------------------------------------------------------- */

/* Copy a table of joints into a frame, once, before what hangs on it; count: 1 .. 65536.
 * Count 8 + 136 * count bytes of payload for it, and a segment for each object. Joints
 * are judged by the daemon: an answer with E_SEGMENT names the joint and what is wrong
 * with it. E_LIMIT: more than was announced; E_STATE: there is one. */
int pccd_frame_joints(struct pccd_frame *frame, const struct pccd_joint *joints,
                      uint32_t count);
/* Add a segment by which all of an object hangs on a joint of the table: its registered
 * positions are in the frame of the joint's link. vertex_count: all its vertices; an
 * answer with E_SEGMENT: it has more, or fewer. E_STATE: there is no table; E_INVAL: no
 * such joint. */
int pccd_frame_turning(struct pccd_frame *frame, uint32_t object, uint32_t joint,
                       uint32_t vertex_count);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
