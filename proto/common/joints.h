/* joints.h - which joints can be joints, and where a link is at a time of the step.
 *
 * Judge a table of joints (struct pccd_joint), and give the transform that a body which
 * hangs on one has, in doubles: at t = 0 and t = 1 where its vertices are then for all
 * that comes after the step. Daemon, library and replay each compute that, and must agree
 * bit for bit. Between the two ends it is for who shows something: what meets there is
 * the engine's to bound.
 *
 * Threads: [any], computing to nearest (rounding.h).
 */
#ifndef COMMON_JOINTS_H
#define COMMON_JOINTS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "pccd_types.h"
#include "proto_limits.h"
#include "sine.h"

#define COMMON_JOINT_LENGTH_MIN 1e-9 /* of axes and quaternions */
#define COMMON_JOINT_LENGTH_MAX 1e9

/* ---- which can be joints ----------------------------------------------------------- */

static inline double common_length(const double v[3])
{
    return sqrt((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
}

static inline bool common_are_numbers(const double *v, int count)
{
    for (int i = 0; i < count; i++) {
        if (!(fabs(v[i]) <= PROTO_COORDINATE_MAX)) {
            return false;
        }
    }
    return true;
}

static inline bool common_are_zeros(const double *v, int count)
{
    for (int i = 0; i < count; i++) {
        if (v[i] != 0) {
            return false;
        }
    }
    return true;
}

static inline bool common_is_joint_length(double length)
{
    return length >= COMMON_JOINT_LENGTH_MIN && length <= COMMON_JOINT_LENGTH_MAX;
}

/* Return what is wrong with joint `at` of a table, a constant text; NULL: nothing. */
static inline const char *common_joint_fault(const struct pccd_joint *joint, uint32_t at)
{
    const bool has_axis =
        joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_SLIDE;
    const double *r = joint->rotation;
    const int values = joint->kind == PCCD_JOINT_FIXED ? 0 : has_axis ? 1 : 3;

    if (joint->kind >= PCCD_JOINT_KIND_COUNT) {
        return "its kind is unknown";
    }
    if (joint->parent != PCCD_NO_JOINT && joint->parent >= at) {
        return "its parent is not before it";
    }
    if (!common_are_numbers(joint->position, 3) || !common_are_numbers(r, 4) ||
        !common_are_numbers(joint->axis, 3) || !common_are_numbers(joint->from, 3) ||
        !common_are_numbers(joint->to, 3)) {
        return "a number is not finite or beyond 1e18";
    }
    if (!common_is_joint_length(
            sqrt((r[0] * r[0] + r[1] * r[1]) + (r[2] * r[2] + r[3] * r[3])))) {
        return "the length of its rotation is not in 1e-9 .. 1e9";
    }
    if (has_axis ? !common_is_joint_length(common_length(joint->axis))
                 : !common_are_zeros(joint->axis, 3)) {
        return has_axis ? "the length of its axis is not in 1e-9 .. 1e9"
                        : "it has an axis, and its kind has none";
    }
    if (!common_are_zeros(joint->from + values, 3 - values) ||
        !common_are_zeros(joint->to + values, 3 - values)) {
        return "it has more values than its kind";
    }
    if ((joint->kind == PCCD_JOINT_TURN &&
         (fabs(joint->from[0]) > COMMON_ANGLE_MAX ||
          fabs(joint->to[0]) > COMMON_ANGLE_MAX)) ||
        (joint->kind == PCCD_JOINT_VECTOR &&
         (common_length(joint->from) > COMMON_ANGLE_MAX ||
          common_length(joint->to) > COMMON_ANGLE_MAX))) {
        return "its angle is beyond 2^20 turns";
    }
    return NULL;
}

/* ---- where a link is --------------------------------------------------------------- */

/* Set the rows of three of m to the turn by an angle about a vector of some length. */
static inline void common_turn(const double axis[3], double angle, double m[12])
{
    double length = common_length(axis), s, c, u[3];

    common_sine(angle, 0, &s, &c);
    for (int k = 0; k < 3; k++) {
        u[k] = length > 0 ? axis[k] / length : 0;
    }
    for (int row = 0; row < 3; row++) {
        for (int k = 0; k < 3; k++) {
            m[4 * row + k] = (1 - c) * (u[row] * u[k]) + (row == k ? c : 0);
        }
    }
    m[1] -= s * u[2];
    m[2] += s * u[1];
    m[4] += s * u[2];
    m[6] -= s * u[0];
    m[8] -= s * u[1];
    m[9] += s * u[0];
}

/* Set m to what follows after it: m x = a (b x). */
static inline void common_transform_after(const double a[12], const double b[12],
                                          double m[12])
{
    double made[12];

    for (int row = 0; row < 3; row++) {
        const double *r = a + 4 * row;

        for (int k = 0; k < 4; k++) {
            made[4 * row + k] =
                ((r[0] * b[k] + r[1] * b[4 + k]) + r[2] * b[8 + k]) + (k == 3 ? r[3] : 0);
        }
    }
    memcpy(m, made, sizeof made);
}

/* Set m to where one joint takes its link in the frame of its parent. */
static inline void common_joint_place(const struct pccd_joint *joint, uint32_t end,
                                      double m[12])
{
    const double *value = end == 0 ? joint->from : joint->to, *r = joint->rotation;
    const double x = r[0], y = r[1], z = r[2], w = r[3];
    const double twice = 2 / ((x * x + y * y) + (z * z + w * w));
    const double length = common_length(joint->axis);
    const double place[12] = {1 - twice * (y * y + z * z), twice * (x * y - z * w),
                              twice * (x * z + y * w),     joint->position[0],
                              twice * (x * y + z * w),     1 - twice * (x * x + z * z),
                              twice * (y * z - x * w),     joint->position[1],
                              twice * (x * z - y * w),     twice * (y * z + x * w),
                              1 - twice * (x * x + y * y), joint->position[2]};
    double moved[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

    if (joint->kind == PCCD_JOINT_TURN) {
        common_turn(joint->axis, value[0], moved);
    } else if (joint->kind == PCCD_JOINT_VECTOR) {
        common_turn(value, common_length(value), moved);
    }
    for (int k = 0; k < 3; k++) {
        moved[4 * k + 3] = joint->kind == PCCD_JOINT_SLIDE
                               ? value[0] * (joint->axis[k] / length)
                           : joint->kind == PCCD_JOINT_SHIFT ? value[k]
                                                             : 0;
    }
    common_transform_after(place, moved, m);
}

/* Set m to where the link of `joint` is in the world at time t, 0 .. 1, of a table
 * without faults, aligned or not: m takes the registered vertices of a body that hangs on
 * it there (common_transform), at both ends of the step to the last bit. */
static inline void common_joint_transform(const void *joints, uint32_t joint, double t,
                                          double m[12])
{
    bool is_first = true;

    for (uint32_t next = joint; next != PCCD_NO_JOINT;) {
        struct pccd_joint at;
        double place[12];

        memcpy(&at, (const uint8_t *)joints + next * sizeof at, sizeof at);
        for (int k = 0; k < 3 && t > 0 && t < 1; k++) {
            at.from[k] += t * (at.to[k] - at.from[k]);
        }
        common_joint_place(&at, t < 1 ? 0 : 1, place);
        if (is_first) {
            memcpy(m, place, sizeof place);
        } else {
            common_transform_after(place, m, m);
        }
        is_first = false;
        next = at.parent;
    }
}

#endif
