/* path.h - how one body moves as another one sees it: the joints between the two.
 *
 * Make the path from the frame of one link to that of another, without the joints that
 * move both; give its pose at a time with a bound of its error; bound how fast its points
 * go, and how far they leave their chords.
 *
 * The path has the joints of the first link backwards, then those of the second. It takes
 * a point b of the second link to where the first one sees it: x(t) = path(t) b. So what
 * two links of one chain share cancels exactly, and a pair of bodies is always one that
 * stands and one that moves.
 *
 * Threads: [any]; a path is only read.
 * Source: elementary/BOUNDS.md, "Bodies that turn".
 */
#ifndef ENG_PATH_H
#define ENG_PATH_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

#define ENG_PATH_JOINTS_MAX 128u /* of both links together, after what cancels */

/* A joint that moves: a TURN about its z axis, a SHIFT, a VECTOR. A joint backwards is
 * one with the values of the opposite sign; what does not move is in `before`, and so are
 * the values at t = 0 of what slides or shifts, the direction of an axis, and places. */
struct eng_path_joint {
    uint32_t kind;     /* enum pccd_joint_kind: TURN, SHIFT or VECTOR */
    double before[12]; /* rows of [R | t], to the frame of the joint in front of it */
    double from[3]; /* the value at t is from + from_rest + t (by + by_rest); a SHIFT's */
    double from_rest[3]; /* from is 0 */
    double by[3];
    double by_rest[3];
    double rate; /* at least the length of by + by_rest */
    double arm; /* at least the distances of the origin of `before` from the axis z and */
    double far; /* from the origin of the frame that it leads to */
};

struct eng_path {
    uint32_t count;
    double last[12]; /* from the frame of the link that moves to that of the last joint */
    double error[2]; /* as in struct eng_path_pose, at all times */
    double far;      /* at least the distance of the origin of that link in that frame */
    double jerk[2];  /* |x'''| is at most jerk[0] + jerk[1] max(|x|, |y|, |z|) of b */
    struct eng_path_joint joints[ENG_PATH_JOINTS_MAX];
};

/* A pose at one time. For a point b, off by nothing, the doubles ((m0 x + m1 y) + m2 z) +
 * m3 of each row are within error[0] + error[1] max(|x|, |y|, |z|) of the exact place, in
 * Euclidean distance. */
struct eng_path_pose {
    double m[12];
    double error[2];
};

/* Boxes of points in the frame of the link that moves. */
struct eng_path_box {
    double lo[3];
    double hi[3];
};

/* Return whether `count` joints are such as struct pccd_joint says; else set *joint to
 * the first that is not, and *why to what is wrong with it, a constant text. */
bool eng_joints_check(const struct pccd_joint *joints, uint32_t count, uint32_t *joint,
                      const char **why);

/* Make the path from `of`, whose frame it is seen in, to `to`: joints, or PCCD_NO_JOINT
 * for the world. PCCD_E_LIMIT: more than ENG_PATH_JOINTS_MAX joints. */
int eng_path_between(const struct pccd_joint *joints, uint32_t of, uint32_t to,
                     struct eng_path *path);

/* Return whether nothing between the two moves. */
bool eng_path_is_still(const struct eng_path *path);

/* Set *pose to that at time t, 0 .. 1. */
void eng_path_pose(const struct eng_path *path, double t, struct eng_path_pose *pose);

/* Return an upper bound of |x'(s)|, of |x''(s)|, for all points of the box and all times
 * s of [t0, t1], with t as the unit of time. So a point is at most bend (t1 - t0)^2 / 8
 * off the chord between its places at t0 and t1. */
double eng_path_speed(const struct eng_path *path, const struct eng_path_box *box,
                      double t0, double t1);
double eng_path_bend(const struct eng_path *path, const struct eng_path_box *box,
                     double t0, double t1);

/* Return the same bound of |x''| in the whole step for what is between some points, or
 * within `around` of that. */
double eng_path_bend_of(const struct eng_path *path, const double (*x)[3], uint32_t count,
                        double around);

/* A span of time, and how far points leave their chords in it: the exact place of a point
 * b is never farther than the length of m b and the error from where the chord between
 * its exact places at t0 and t1 is at the same time; along a unit vector u it is off by
 * at most |u . m b| and the error. Of a box or a feature its corners are enough. For long
 * chains that is several times less than bend (t1 - t0)^2 / 8 is, and costs less, where
 * the poses are there. */
struct eng_path_span {
    double m[12]; /* the pose at the middle, less the mean of those at the ends; or 0, if
                   * all that joints can do is less than is known by that */
    double error[2]; /* of that, and for what is between, as in struct eng_path_pose */
};

/* Set *span from the poses of a path at t0, at (t0 + t1) / 2, which must be exact, and at
 * t1. */
void eng_path_span(const struct eng_path *path, double t0, double t1,
                   const struct eng_path_pose poses[3], struct eng_path_span *span);

#endif
