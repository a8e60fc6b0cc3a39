/* sweep_draw.c - a mechanism becomes a picture. */
#include "sweep_draw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "coordinates.h"
#include "joints.h"
#include "shown.h"

#define POSES       7u /* that are paler */
#define PALE        0.75f
#define AXIS_WEIGHT 1.3f /* of the turning axis, to the eye */
#define MARK        (PICTURE_COLOURS - 1)

static const float pair_colours[2][3] = {{0.16f, 0.42f, 0.86f}, {0.95f, 0.42f, 0.12f}};
static const float other_colour[3] = {0.74f, 0.75f, 0.77f};
static const float pale_colour[3] = {0.93f, 0.94f, 0.96f};

void sweep_scene_take(struct sweep_scene *scene, const struct sweep_range *range,
                      const struct sweep_answer *answer)
{
    struct sweep_scene taken = {.range = *range, .least = answer->least[1]};
    taken.worth = answer->jam_count > 0        ? SWEEP_WORTH_JAM
                  : answer->gap_count > 0      ? SWEEP_WORTH_GAP
                  : isfinite(answer->least[1]) ? SWEEP_WORTH_LEAST
                                               : SWEEP_WORTH_FREE;
    if (taken.worth == SWEEP_WORTH_JAM) {
        taken.at = answer->jams[0];
    } else if (taken.worth == SWEEP_WORTH_GAP) {
        taken.at.at = answer->gaps[0];
    } else if (taken.worth == SWEEP_WORTH_LEAST) {
        taken.at = answer->nearest;
    } else {
        for (uint32_t k = 0; k < range->count; k++) {
            taken.at.at.ends[k][0] =
                range->ends[k][0] + (range->ends[k][1] - range->ends[k][0]) / 2;
        }
    }
    bool is_nearer = taken.worth == SWEEP_WORTH_LEAST && scene->worth == taken.worth &&
                     taken.least < scene->least;
    if (taken.worth > scene->worth || is_nearer) {
        *scene = taken;
    }
}

/* A picture that is made, of what is in `shown`. */
struct drawing {
    struct sweep *sweep;
    const struct sweep_scene *scene;
    struct snapshot shown;
    float (*colours)[3];
    double *values; /* [joint_count] */
    uint32_t shapes[2];
};

/* Copy the rows of a list that name vertices; NULL: no memory. */
static void *copy_rows(const struct ctl_list *from, size_t kind)
{
    size_t bytes = from->count * (kind + 1) * sizeof *from->vertices;
    void *to = malloc(bytes + 1);
    if (to != NULL && bytes > 0) {
        memcpy(to, from->vertices, bytes);
    }
    return to;
}

/* Add a shape where the values of joints have it. Return false without memory. */
static bool add_shape(struct drawing *drawing, uint32_t i, float pale)
{
    const struct robot_shape *shape = &drawing->sweep->robot->shapes[i];
    const double(*x)[3] = shape->mesh.x;
    uint32_t count = shape->mesh.vertex_count, place = drawing->shown.object_count++;
    struct snapshot_object *object = &drawing->shown.objects[place];
    double m[12], at[3];
    *object =
        (struct snapshot_object){.handle = place,
                                 .vertex_count = count,
                                 .triangle_count = shape->mesh.triangles.count,
                                 .edge_count = shape->mesh.edges.count,
                                 .point_count = shape->mesh.points.count,
                                 .x = malloc((count + 1) * sizeof *object->x),
                                 .radii = malloc((count + 1) * sizeof *object->radii),
                                 .triangles = copy_rows(&shape->mesh.triangles, 2),
                                 .edges = copy_rows(&shape->mesh.edges, 1),
                                 .points = copy_rows(&shape->mesh.points, 0)};
    if (object->x == NULL || object->radii == NULL || object->triangles == NULL ||
        object->edges == NULL || object->points == NULL) {
        return false;
    }
    sweep_pose(drawing->sweep, drawing->values, i, m);
    for (uint32_t v = 0; v < count; v++) {
        common_transform(m, x[v], at);
        object->radii[v] = (float)shape->settings.radius;
        for (uint32_t k = 0; k < 3; k++) {
            object->x[v][k] = (float)(at[k] - drawing->shown.origin[k]);
        }
    }
    bool is_pair = drawing->shapes[0] != drawing->shapes[1];
    const float *colour = is_pair && i == drawing->shapes[0]   ? pair_colours[0]
                          : is_pair && i == drawing->shapes[1] ? pair_colours[1]
                                                               : other_colour;
    for (uint32_t k = 0; k < 3; k++) {
        drawing->colours[place][k] = colour[k] + pale * (pale_colour[k] - colour[k]);
    }
    return true;
}

/* Set the first joint of the range, which moves, and what follows it. */
static void set_value(struct drawing *drawing, double value)
{
    if (drawing->scene->range.count > 0) {
        drawing->values[drawing->scene->range.joints[0]] = value;
    }
    robot_follow(drawing->sweep->robot, drawing->values);
}

/* Add all shapes, behind them those that move, along their way. */
static bool add_all(struct drawing *drawing)
{
    const struct sweep_scene *scene = drawing->scene;
    const double *ends = scene->range.ends[0];
    uint32_t count = drawing->sweep->robot->shape_count;
    bool has_room = true;
    for (uint32_t i = 0; i < count && has_room; i++) {
        double first[12], middle[12];
        set_value(drawing, ends[0]);
        sweep_pose(drawing->sweep, drawing->values, i, first);
        set_value(drawing, ends[0] + (ends[1] - ends[0]) / 2);
        sweep_pose(drawing->sweep, drawing->values, i, middle);
        bool moves = scene->range.count > 0 && memcmp(first, middle, sizeof first) != 0;
        for (uint32_t p = 0; p < POSES && moves && has_room; p++) {
            set_value(drawing, ends[0] + (ends[1] - ends[0]) * p / (POSES - 1));
            has_room = add_shape(drawing, i, PALE);
        }
    }
    set_value(drawing, scene->at.at.ends[0][0]);
    return has_room;
}

/* Look along the axis of a joint that turns, more or less, else from the side. */
static void find_eye(struct drawing *drawing, float from[3])
{
    const struct robot *robot = drawing->sweep->robot;
    uint32_t joint = drawing->scene->range.joints[0];
    from[0] = 0.75f;
    from[1] = -0.45f;
    from[2] = 0.5f;
    if (drawing->scene->range.count > 0 && robot->joints[joint].kind == PCCD_JOINT_TURN) {
        double m[12], axis[3], length = 0, side = 0;
        const double *own = robot->joints[joint].axis;
        common_joint_transform(drawing->sweep->joints, joint, 0, m);
        for (uint32_t k = 0; k < 3; k++) {
            axis[k] = m[4 * k] * own[0] + m[4 * k + 1] * own[1] + m[4 * k + 2] * own[2];
            length += axis[k] * axis[k];
            side += axis[k] * (double)from[k];
        }
        for (uint32_t k = 0; k < 3; k++) {
            from[k] += (float)(axis[k] / copysign(sqrt(length), side)) * AXIS_WEIGHT;
        }
    }
}

static void name_scene(const struct drawing *drawing, bool is_found, char *title,
                       size_t room)
{
    static const char *const words[] = {[SWEEP_WORTH_NONE] = "start",
                                        [SWEEP_WORTH_FREE] = "free",
                                        [SWEEP_WORTH_LEAST] = "free, least distance",
                                        [SWEEP_WORTH_GAP] = "undecided",
                                        [SWEEP_WORTH_JAM] = "jams"};
    const struct sweep_scene *scene = drawing->scene;
    const struct robot *robot = drawing->sweep->robot;
    size_t used = (size_t)snprintf(title, room, "%s", words[scene->worth]);
    for (uint32_t k = 0; k < scene->range.count && used < room; k++) {
        used +=
            (size_t)snprintf(title + used, room - used, "%s %s = %s", k > 0 ? "," : " at",
                             tool_shown(robot->joints[scene->range.joints[k]].name),
                             tool_shown_number(scene->at.at.ends[k][0]));
    }
    for (uint32_t i = 0; i < 2 && is_found && used < room; i++) {
        const struct robot_shape *shape = &robot->shapes[drawing->shapes[i]];
        used +=
            (size_t)snprintf(title + used, room - used, "%s%s", i > 0 ? " and " : ": ",
                             tool_shown(robot->parts[shape->part].name));
    }
}

/* Draw what is nearest at the values, and everything else. */
static int draw(struct drawing *drawing, FILE *file, const char *path)
{
    struct sweep *sweep = drawing->sweep;
    double points[2][3] = {{0, 0, 0}, {0, 0, 0}};
    bool is_found = false;
    char title[96];
    int status =
        sweep_nearest(sweep, drawing->values, drawing->shapes, points, &is_found);
    if (status != PCCD_OK) {
        return status;
    }
    memcpy(drawing->shown.origin, points[0], sizeof points[0]);
    bool has_room = add_all(drawing);
    struct picture_mark marks[2] = {{.is_line = true, .colour = MARK},
                                    {.is_chosen = true, .colour = MARK}};
    struct picture picture = {.snapshot = &drawing->shown,
                              .marks = marks,
                              .mark_count = is_found ? 2 : 0,
                              .up = 3,
                              .is_thick = true,
                              .title = title,
                              .colours = (const float(*)[3])drawing->colours,
                              .behind_count = drawing->shown.object_count};
    const struct robot_shape *shapes = sweep->robot->shapes;
    double radii[2] = {shapes[drawing->shapes[0]].settings.radius,
                       shapes[drawing->shapes[1]].settings.radius};
    double way[3] = {points[1][0] - points[0][0], points[1][1] - points[0][1],
                     points[1][2] - points[0][2]};
    double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    double share = length > 0 ? (1 + (radii[0] - radii[1]) / length) / 2 : 0;
    for (uint32_t k = 0; k < 3; k++) { /* half way between the surfaces */
        marks[0].to[k] = (float)way[k];
        marks[1].at[k] = (float)(share * way[k]);
    }
    for (uint32_t i = 0; i < sweep->robot->shape_count && has_room; i++) {
        has_room = add_shape(drawing, i, 0);
    }
    find_eye(drawing, picture.from);
    name_scene(drawing, is_found, title, sizeof title);
    return has_room ? picture_write(&picture, file, path, sweep->error)
                    : ctl_error_set(sweep->error, PCCD_E_NOMEM, "out of memory");
}

int sweep_draw(struct sweep *sweep, const struct sweep_scene *scene, const double *values,
               FILE *file, const char *path)
{
    const struct robot *robot = sweep->robot;
    size_t count = (size_t)robot->shape_count * (POSES + 1);
    struct drawing drawing = {
        .sweep = sweep,
        .scene = scene,
        .shown = {.objects = calloc(count, sizeof *drawing.shown.objects)},
        .colours = calloc(count, sizeof *drawing.colours),
        .values = calloc(robot->joint_count + 1u, sizeof *values),
        .shapes = {scene->at.shapes[0], scene->at.shapes[1]}};
    int status = PCCD_E_NOMEM;
    if (drawing.shown.objects == NULL || drawing.colours == NULL ||
        drawing.values == NULL) {
        status = ctl_error_set(sweep->error, PCCD_E_NOMEM, "out of memory");
    } else {
        memcpy(drawing.values, values, robot->joint_count * sizeof *values);
        for (uint32_t k = 0; k < scene->range.count; k++) {
            drawing.values[scene->range.joints[k]] = scene->at.at.ends[k][0];
        }
        robot_follow(robot, drawing.values);
        status = draw(&drawing, file, path);
    }
    snapshot_deinit(&drawing.shown);
    free(drawing.colours);
    free(drawing.values);
    return status;
}
