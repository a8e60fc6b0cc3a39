/* joints.c - check what is said of joints. */
#include "path.h"

#include <math.h>
#include <stddef.h>

#include "sine.h"

#define NUMBER_MAX 1e18
#define LENGTH_MIN 1e-9
#define LENGTH_MAX 1e9

static bool are_numbers(const double *x, int count)
{
    for (int i = 0; i < count; i++) {
        if (!(fabs(x[i]) <= NUMBER_MAX)) {
            return false;
        }
    }
    return true;
}

static bool are_zeros(const double *x, int count)
{
    for (int i = 0; i < count; i++) {
        if (x[i] != 0) {
            return false;
        }
    }
    return true;
}

static bool is_length(const double *x, int count)
{
    double square = 0;
    for (int i = 0; i < count; i++) {
        square += x[i] * x[i];
    }
    double length = sqrt(square);
    return length >= LENGTH_MIN && length <= LENGTH_MAX;
}

static bool is_angle(const double *x)
{
    return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) <= ENG_ANGLE_MAX;
}

/* Return what is wrong with the joint at `index`, or NULL. */
static const char *find_fault(const struct pccd_joint *joint, uint32_t index)
{
    if (joint->kind >= PCCD_JOINT_KIND_COUNT) {
        return "its kind is unknown";
    }
    if (joint->parent >= index && joint->parent != PCCD_NO_JOINT) {
        return "its parent is not a joint before it";
    }
    if (!are_numbers(joint->position, 3) || !are_numbers(joint->rotation, 4) ||
        !are_numbers(joint->axis, 3) || !are_numbers(joint->from, 3) ||
        !are_numbers(joint->to, 3)) {
        return "a number is not finite or of magnitude above 1e18";
    }
    if (!is_length(joint->rotation, 4)) {
        return "the length of its rotation's quaternion is not 1e-9 .. 1e9";
    }
    bool has_axis = joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_SLIDE;
    if (has_axis && !is_length(joint->axis, 3)) {
        return "the length of its axis is not 1e-9 .. 1e9";
    }
    if (!has_axis && !are_zeros(joint->axis, 3)) {
        return "its kind has no axis, and the axis is not 0";
    }
    int used = has_axis ? 1 : joint->kind == PCCD_JOINT_FIXED ? 0 : 3;
    if (!are_zeros(joint->from + used, 3 - used) ||
        !are_zeros(joint->to + used, 3 - used)) {
        return "a value that its kind does not use is not 0";
    }
    bool turns = joint->kind == PCCD_JOINT_TURN || joint->kind == PCCD_JOINT_VECTOR;
    if (turns && !(is_angle(joint->from) && is_angle(joint->to))) {
        return "its angle is larger than 2^20 turns";
    }
    return NULL;
}

bool eng_joints_check(const struct pccd_joint *joints, uint32_t count, uint32_t *joint,
                      const char **why)
{
    for (uint32_t i = 0; i < count; i++) {
        const char *fault = find_fault(&joints[i], i);
        if (fault != NULL) {
            *joint = i;
            *why = fault;
            return false;
        }
    }
    return true;
}
