/* robot.c - a mechanism, whatever file it comes from. */
#include "robot.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "shown.h"

#define AXIS_MIN   1e-9
#define LENGTH_MAX 1e18

static int lack_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the mechanism");
}

/* ---- puts one together ------------------------------------------------------------- */

int robot_alloc(struct robot *robot, size_t joints, size_t parts, size_t shapes,
                struct ctl_error *error)
{
    robot->joints = calloc(joints + 1, sizeof *robot->joints);
    robot->parts = calloc(parts + 1, sizeof *robot->parts);
    robot->shapes = calloc(shapes + 1, sizeof *robot->shapes);
    robot->start = calloc(joints + 1, sizeof *robot->start);
    if (robot->joints == NULL || robot->parts == NULL || robot->shapes == NULL ||
        robot->start == NULL) {
        return lack_memory(error);
    }
    for (size_t i = 0; i < joints; i++) {
        robot->joints[i] = (struct robot_joint){.parent = ROBOT_NONE,
                                                .place = ROBOT_AT_ORIGIN,
                                                .axis = {1, 0, 0},
                                                .leader = ROBOT_NONE,
                                                .said = {1, 0}};
    }
    for (size_t i = 0; i < parts; i++) {
        robot->parts[i].joint = ROBOT_NONE;
    }
    for (size_t i = 0; i < shapes; i++) {
        robot->shapes[i] =
            (struct robot_shape){.size = {1, 1, 1}, .place = ROBOT_AT_ORIGIN};
    }
    return PCCD_OK;
}

uint32_t robot_find_joint(const struct robot *robot, const char *name)
{
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        if (strcmp(robot->joints[i].name, name) == 0) {
            return i;
        }
    }
    return ROBOT_NONE;
}

uint32_t robot_find_part(const struct robot *robot, const char *name)
{
    for (uint32_t i = 0; i < robot->part_count; i++) {
        if (strcmp(robot->parts[i].name, name) == 0) {
            return i;
        }
    }
    return ROBOT_NONE;
}

int robot_set_pair(struct robot *robot, uint32_t a, uint32_t b, double clearance,
                   struct ctl_error *error)
{
    void *list = robot->pairs;
    if (!array_reserve(&list, robot->pair_count, &robot->pair_room,
                       sizeof *robot->pairs)) {
        return lack_memory(error);
    }
    robot->pairs = list;
    robot->pairs[robot->pair_count++] = (struct robot_pair){{a, b}, clearance};
    return PCCD_OK;
}

void robot_close(struct robot *robot)
{
    for (uint32_t i = 0; i < robot->shape_count; i++) {
        ctl_mesh_deinit(&robot->shapes[i].mesh);
    }
    xml_close(&robot->xml);
    free(robot->joints);
    free(robot->parts);
    free(robot->shapes);
    free(robot->pairs);
    free(robot->start);
    free(robot->states);
    *robot = (struct robot){.path = NULL};
}

void robot_turn(struct robot_place *place, const double rpy[3])
{
    double sr = sin(rpy[0] / 2), cr = cos(rpy[0] / 2), sp = sin(rpy[1] / 2);
    double cp = cos(rpy[1] / 2), sy = sin(rpy[2] / 2), cy = cos(rpy[2] / 2);
    place->rotation[0] = sr * cp * cy - cr * sp * sy;
    place->rotation[1] = cr * sp * cy + sr * cp * sy;
    place->rotation[2] = cr * cp * sy - sr * sp * cy;
    place->rotation[3] = cr * cp * cy + sr * sp * sy;
}

/* ---- judges it --------------------------------------------------------------------- */

/* Refuse a joint. */
__attribute__((format(printf, 4, 5))) static int refuse(const struct robot *robot,
                                                        const struct robot_joint *joint,
                                                        struct ctl_error *error,
                                                        const char *format, ...)
{
    char what[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return ctl_error_set(error, PCCD_E_FORMAT, "%s:%" PRIu32 ": joint \"%s\": %s",
                         robot->path, joint->line, tool_shown(joint->name), what);
}

/* Put parents before their children, otherwise in the order of the file. */
static int sort_joints(struct robot *robot, struct ctl_error *error)
{
    uint32_t count = robot->joint_count, done = 0;
    struct robot_joint *sorted = malloc((count + 1) * sizeof *sorted);
    uint32_t *place = malloc((count + 1) * sizeof *place); /* among the sorted */
    int status = sorted != NULL && place != NULL ? PCCD_OK : lack_memory(error);
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        place[i] = ROBOT_NONE;
    }
    for (bool goes_on = true; goes_on && status == PCCD_OK;) {
        goes_on = false;
        for (uint32_t i = 0; i < count; i++) {
            uint32_t parent = robot->joints[i].parent;
            if (place[i] == ROBOT_NONE &&
                (parent == ROBOT_NONE || place[parent] != ROBOT_NONE)) {
                sorted[done] = robot->joints[i];
                sorted[done].parent = parent == ROBOT_NONE ? ROBOT_NONE : place[parent];
                place[i] = done++;
                goes_on = true;
            }
        }
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        if (place[i] == ROBOT_NONE) {
            status = refuse(robot, &robot->joints[i], error,
                            "it hangs on itself, in a ring of joints");
        }
    }
    for (uint32_t i = 0; i < robot->part_count && status == PCCD_OK; i++) {
        struct robot_part *part = &robot->parts[i];
        part->joint = part->joint == ROBOT_NONE ? ROBOT_NONE : place[part->joint];
    }
    if (status == PCCD_OK) {
        memcpy(robot->joints, sorted, count * sizeof *sorted);
    }
    free(place);
    free(sorted);
    return status;
}

/* Find the joint that another one follows in the end. */
static int find_leader(struct robot *robot, struct robot_joint *joint,
                       struct ctl_error *error)
{
    const struct robot_joint *at = joint;
    double factor = 1, offset = 0;
    for (uint32_t steps = 0; at->leader_name != NULL; steps++) {
        uint32_t next = robot_find_joint(robot, at->leader_name);
        if (next == ROBOT_NONE) {
            return refuse(robot, at, error,
                          "it follows a joint \"%s\", and there is none",
                          tool_shown(at->leader_name));
        }
        if (steps == robot->joint_count) {
            return refuse(robot, joint, error, "it follows itself, in a ring of joints");
        }
        offset += factor * at->said[1];
        factor *= at->said[0];
        joint->leader = next;
        at = &robot->joints[next];
    }
    if (at != joint && at->held != NULL) {
        return refuse(robot, joint, error, "it follows \"%s\", which is %s",
                      tool_shown(at->name), at->held);
    }
    joint->factor = factor;
    joint->offset = offset;
    return isfinite(factor + offset)
               ? PCCD_OK
               : refuse(robot, joint, error, "its multiplier or offset is too large");
}

static int judge(const struct robot *robot, struct robot_joint *joint,
                 struct ctl_error *error)
{
    const double *range = joint->range, *axis = joint->axis, *at = joint->place.position;
    double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double farthest = fmax(fmax(fabs(at[0]), fabs(at[1])), fabs(at[2]));
    if (farthest > LENGTH_MAX) {
        return refuse(robot, joint, error, "its place is farther away than 1e18");
    }
    if (joint->kind == PCCD_JOINT_FIXED) {
        return PCCD_OK;
    }
    if (!(length >= AXIS_MIN && length <= 1 / AXIS_MIN)) {
        return refuse(robot, joint, error,
                      "its axis %g %g %g has the length %g, and so no direction", axis[0],
                      axis[1], axis[2], length);
    }
    return range[0] <= range[1]
               ? PCCD_OK
               : refuse(robot, joint, error, "its range ends at %g, before its begin %g",
                        range[1], range[0]);
}

int robot_finish(struct robot *robot, struct ctl_error *error)
{
    int status = robot->joint_count <= ROBOT_JOINTS_MAX
                     ? sort_joints(robot, error)
                     : ctl_error_set(error, PCCD_E_LIMIT, "%s: more than %u joints",
                                     robot->path, ROBOT_JOINTS_MAX);
    for (uint32_t i = 0; i < robot->joint_count && status == PCCD_OK; i++) {
        struct robot_joint *joint = &robot->joints[i];
        status = find_leader(robot, joint, error);
        if (status == PCCD_OK) {
            status = judge(robot, joint, error);
        }
        if (joint->kind != PCCD_JOINT_FIXED) {
            robot->start[i] = fmin(fmax(0, joint->range[0]), joint->range[1]);
        }
    }
    if (status == PCCD_OK) {
        robot_follow(robot, robot->start);
    }
    return status;
}

static double length_of(const double x[3])
{
    return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

/* Return a bound of how far points of a shape are from the origin of its joint. */
static double extent_of(const struct robot_shape *shape)
{
    const double(*x)[3] = shape->mesh.x;
    double away = 0;
    for (uint32_t v = 0; v < shape->mesh.vertex_count; v++) {
        away = fmax(away, length_of(x[v]));
    }
    return length_of(shape->place.position) + away + shape->settings.radius;
}

void robot_measure(const struct robot *robot, const double *from, const double *to,
                   double *reach)
{
    memset(reach, 0, robot->joint_count * sizeof *reach);
    for (uint32_t i = 0; i < robot->shape_count; i++) {
        uint32_t joint = robot->parts[robot->shapes[i].part].joint;
        if (joint != ROBOT_NONE) {
            double extent = extent_of(&robot->shapes[i]) * (1 + 1e-9);
            reach[joint] = fmax(reach[joint], extent);
        }
    }
    for (uint32_t i = robot->joint_count; i-- > 0;) {
        const struct robot_joint *joint = &robot->joints[i];
        double away = length_of(joint->place.position);
        if (joint->kind == PCCD_JOINT_SLIDE) {
            away += fmax(fabs(from[i]), fabs(to[i]));
        }
        if (joint->parent != ROBOT_NONE) {
            away = (away + reach[i]) * (1 + 1e-9);
            reach[joint->parent] = fmax(reach[joint->parent], away);
        }
    }
}

/* ---- uses it ----------------------------------------------------------------------- */

void robot_follow(const struct robot *robot, double *values)
{
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        const struct robot_joint *joint = &robot->joints[i];
        if (joint->leader != ROBOT_NONE) {
            values[i] = joint->factor * values[joint->leader] + joint->offset;
        }
    }
}

bool robot_is_free(const struct robot *robot, uint32_t joint)
{
    return robot->joints[joint].kind != PCCD_JOINT_FIXED &&
           robot->joints[joint].leader == ROBOT_NONE;
}

void robot_joints(const struct robot *robot, const double *from, const double *to,
                  struct pccd_joint *joints)
{
    for (uint32_t i = 0; i < robot->joint_count; i++) {
        const struct robot_joint *joint = &robot->joints[i];
        joints[i] = (struct pccd_joint){.kind = joint->kind, .parent = joint->parent};
        memcpy(joints[i].position, joint->place.position, sizeof joints[i].position);
        memcpy(joints[i].rotation, joint->place.rotation, sizeof joints[i].rotation);
        if (joint->kind != PCCD_JOINT_FIXED) {
            memcpy(joints[i].axis, joint->axis, sizeof joints[i].axis);
            joints[i].from[0] = from[i];
            joints[i].to[0] = to[i];
        }
    }
    for (uint32_t i = 0; i < robot->shape_count; i++) {
        const struct robot_shape *shape = &robot->shapes[i];
        struct pccd_joint *joint = &joints[robot->joint_count + i];
        *joint = (struct pccd_joint){.kind = PCCD_JOINT_FIXED,
                                     .parent = robot->parts[shape->part].joint};
        memcpy(joint->position, shape->place.position, sizeof joint->position);
        memcpy(joint->rotation, shape->place.rotation, sizeof joint->rotation);
    }
}

/* Return the last joint on the way to a part that moves. */
static uint32_t mover_of(const struct robot *robot, uint32_t part)
{
    uint32_t joint = robot->parts[part].joint;
    while (joint != ROBOT_NONE && robot->joints[joint].kind == PCCD_JOINT_FIXED) {
        joint = robot->joints[joint].parent;
    }
    return joint;
}

double robot_clearance(const struct robot *robot, uint32_t a, uint32_t b)
{
    double clearance = ROBOT_PLAIN;
    for (size_t i = 0; i < robot->pair_count; i++) {
        const uint32_t *parts = robot->pairs[i].parts;
        if ((parts[0] == a && parts[1] == b) || (parts[0] == b && parts[1] == a)) {
            clearance = robot->pairs[i].clearance;
        }
    }
    return clearance;
}

bool robot_has_clearances(const struct robot *robot)
{
    bool has = false;
    for (size_t i = 0; i < robot->pair_count && !has; i++) {
        has = robot->pairs[i].clearance != ROBOT_APART;
    }
    return has;
}

bool robot_never_asks(const struct robot *robot, uint32_t a, uint32_t b)
{
    return a == b || mover_of(robot, a) == mover_of(robot, b) ||
           robot_clearance(robot, a, b) == ROBOT_APART;
}
