/* robot_scene.c - takes a mechanism from a scene file that has joints. */
#include <inttypes.h>
#include <string.h>

#include "robot.h"
#include "shown.h"

static int lack_memory(struct ctl_error *error)
{
    return ctl_error_set(error, PCCD_E_NOMEM, "no memory for the mechanism");
}

/* Find a joint by its name; E_FORMAT: there is none. */
static int find(const struct robot *robot, uint32_t line, const char *name,
                uint32_t *joint, struct ctl_error *error)
{
    *joint = robot_find_joint(robot, name);
    return *joint != ROBOT_NONE
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_FORMAT,
                               "%s:%" PRIu32 ": no joint has the name \"%s\"",
                               robot->path, line, tool_shown(name));
}

static int take_joint(struct robot *robot, const struct scene_joint *from,
                      struct ctl_error *error)
{
    static const enum pccd_joint_kind kinds[] = {[SCENE_FIXED] = PCCD_JOINT_FIXED,
                                                 [SCENE_REVOLUTE] = PCCD_JOINT_TURN,
                                                 [SCENE_CONTINUOUS] = PCCD_JOINT_TURN,
                                                 [SCENE_PRISMATIC] = PCCD_JOINT_SLIDE};
    if (robot_find_joint(robot, from->name) != ROBOT_NONE) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s:%" PRIu32 ": another joint has the name \"%s\"",
                             robot->path, from->line, tool_shown(from->name));
    }
    struct robot_joint *to = &robot->joints[robot->joint_count++];
    to->name = from->name;
    to->line = from->line;
    to->leader_name = from->follows;
    to->kind = kinds[from->type];
    to->said[0] = from->multiplier;
    to->said[1] = from->offset;
    memcpy(to->place.position, from->position, sizeof from->position);
    robot_turn(&to->place, from->rpy);
    memcpy(to->axis, from->axis, sizeof from->axis);
    memcpy(to->range, from->range, sizeof from->range);
    if (from->type == SCENE_CONTINUOUS) {
        to->range[0] = -ROBOT_PI;
        to->range[1] = ROBOT_PI;
    }
    return PCCD_OK;
}

/* Copy a mesh in the unit of the scene, as doubles. */
static int copy_mesh(const struct ctl_mesh *from, double unit, struct ctl_mesh *to,
                     struct ctl_error *error)
{
    *to = (struct ctl_mesh){.error = error};
    if (ctl_mesh_alloc_vertices(to, PCCD_FORMAT_F64, from->vertex_count) != PCCD_OK) {
        return lack_memory(error);
    }
    double *x = to->x;
    for (size_t i = 0; i < from->vertex_count * (size_t)3; i++) {
        bool is_double = from->format == PCCD_FORMAT_F64;
        x[i] = unit * (is_double ? ((const double *)from->x)[i]
                                 : (double)((const float *)from->x)[i]);
    }
    for (uint32_t kind = 0; kind < CTL_KINDS; kind++) {
        const struct ctl_list *rows = &from->lists[kind];
        for (uint32_t i = 0; i < rows->count; i++) {
            const uint32_t *row = rows->vertices + (size_t)i * (kind + 1);
            if (ctl_mesh_add(to, (enum ctl_kind)kind, row) != PCCD_OK) {
                return lack_memory(error);
            }
        }
    }
    return PCCD_OK;
}

static int take_object(struct robot *robot, const struct scene_object *from,
                       struct ctl_error *error)
{
    struct robot_part *part = &robot->parts[robot->part_count];
    struct robot_shape *shape = &robot->shapes[robot->shape_count++];
    part->name = from->name;
    part->line = shape->line = from->line;
    shape->part = robot->part_count++;
    if (from->files.count > 1) {
        return ctl_error_set(error, PCCD_E_FORMAT,
                             "%s:%" PRIu32 ": object \"%s\" has more than one frame: "
                             "what is swept is rigid",
                             robot->path, from->line, tool_shown(from->name));
    }
    shape->settings = from->settings;
    int status = copy_mesh(&from->files.mesh, from->unit, &shape->mesh, error);
    return status == PCCD_OK && from->joint != NULL
               ? find(robot, from->line, from->joint, &part->joint, error)
               : status;
}

int robot_take_scene(struct robot *robot, const struct scene *scene,
                     struct ctl_error *error)
{
    int status = robot_alloc(robot, scene->joint_count, scene->object_count,
                             scene->object_count, error);
    robot->path = scene->path;
    for (uint32_t i = 0; i < scene->joint_count && status == PCCD_OK; i++) {
        status = take_joint(robot, &scene->joints[i], error);
    }
    for (uint32_t i = 0; i < scene->joint_count && status == PCCD_OK; i++) {
        const struct scene_joint *joint = &scene->joints[i];
        if (joint->parent != NULL) {
            status =
                find(robot, joint->line, joint->parent, &robot->joints[i].parent, error);
        }
    }
    for (uint32_t i = 0; i < scene->object_count && status == PCCD_OK; i++) {
        status = take_object(robot, &scene->objects[i], error);
    }
    for (size_t i = 0; i < scene->pair_count && status == PCCD_OK; i++) {
        const struct scene_pair *pair = &scene->pairs[i];
        status = robot_set_pair(robot, pair->objects[0], pair->objects[1],
                                pair->is_ignored ? ROBOT_APART : pair->clearance, error);
    }
    return status == PCCD_OK ? robot_finish(robot, error) : status;
}
