/* sweep_ask.c - a mechanism in a daemon, and what meets in one of its motions. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "joints.h"
#include "link.h"
#include "shown.h"
#include "sweep.h"

#define TOLERANCE_MIN 1e-12

static int fail(struct sweep *sweep, int status)
{
    return status == PCCD_OK
               ? PCCD_OK
               : ctl_error_set(sweep->error, status, "%s: %s%s", sweep->robot->path,
                               pccd_error_text(sweep->client),
                               status == PCCD_E_TIMEOUT ? "; --timeout gives it longer"
                                                        : "");
}

/* Refuse joints and places that can be none, by the names that the file has for them. */
static int judge_joints(const struct sweep *sweep, const double *from, const double *to)
{
    const struct robot *robot = sweep->robot;
    const uint32_t count = robot->joint_count;
    for (uint32_t i = 0; i < count + robot->shape_count; i++) {
        const char *fault = common_joint_fault(&sweep->joints[i], i);
        if (fault != NULL && i < count) {
            const char *name = tool_shown(robot->joints[i].name);
            return ctl_error_set(sweep->error, PCCD_E_INVAL,
                                 "%s: joint \"%s\", at %g to %g: %s", robot->path, name,
                                 from[i], to[i], fault);
        }
        if (fault != NULL) {
            const char *name = robot->parts[robot->shapes[i - count].part].name;
            return ctl_error_set(sweep->error, PCCD_E_INVAL, "%s: where \"%s\" is: %s",
                                 robot->path, tool_shown(name), fault);
        }
    }
    return PCCD_OK;
}

static int put_shape(struct sweep *sweep, struct robot_shape *shape)
{
    struct pccd_mesh_info info = {.edge_count = 0};
    int status = scene_put_mesh(sweep->client, &shape->mesh, &shape->registered, &info);
    shape->edge_count = info.edge_count;
    if (status == PCCD_OK) {
        status = pccd_scene_add(sweep->client, sweep->scene, shape->registered,
                                &shape->handle);
    }
    if (status == PCCD_OK) {
        status = ctl_name_object(sweep->client, sweep->scene, shape->handle,
                                 sweep->robot->parts[shape->part].name);
    }
    shape->settings.what |= PCCD_OBJECT_SELF; /* it is rigid */
    shape->settings.self_collision = false;
    return status == PCCD_OK ? pccd_object_set(sweep->client, sweep->scene, shape->handle,
                                               &shape->settings)
                             : status;
}

/* Return the radius that is part of the distance a shape keeps: a clearance takes the
 * place of an object's thickness, but the radius of a sphere or capsule is its shape. */
static double radius_of(const struct robot_shape *shape, bool has_clearance)
{
    bool is_round = shape->form == ROBOT_SPHERE || shape->form == ROBOT_CAPSULE;
    return is_round || !has_clearance ? shape->settings.radius : 0;
}

/* Return the distance that two shapes keep, of which neither may be ignored. */
static double clearance_of(const struct sweep *sweep, const struct robot_shape *a,
                           const struct robot_shape *b)
{
    double said = robot_clearance(sweep->robot, a->part, b->part);
    bool has_own = said != ROBOT_PLAIN;
    double radii = radius_of(a, has_own) + radius_of(b, has_own);
    double distance = (has_own ? said : sweep->clearance) + radii;
    /* Rounding may not make it less. */
    return radii > 0 ? distance * (1 + 4 * DBL_EPSILON) : distance;
}

/* Say how near two shapes may come. If any two have a clearance of their own, each pair
 * has, and the separation is only what is searched with. */
static int set_pair(struct sweep *sweep, const struct robot_shape *a,
                    const struct robot_shape *b)
{
    if (robot_never_asks(sweep->robot, a->part, b->part)) {
        return pccd_pair_ignore(sweep->client, sweep->scene, a->handle, b->handle, true);
    }
    if (!scene_is_met(&a->settings, &b->settings) ||
        !scene_is_met(&b->settings, &a->settings)) {
        return PCCD_OK;
    }
    sweep->pair_count++;
    if (!robot_has_clearances(sweep->robot)) {
        return PCCD_OK;
    }
    return pccd_pair_clearance(sweep->client, sweep->scene, a->handle, b->handle,
                               clearance_of(sweep, a, b));
}

int sweep_begin(struct sweep *sweep)
{
    const struct robot *robot = sweep->robot;
    sweep->joints =
        calloc((size_t)robot->joint_count + robot->shape_count, sizeof *sweep->joints);
    sweep->motions = calloc(robot->shape_count, sizeof *sweep->motions);
    if (sweep->joints == NULL || sweep->motions == NULL) {
        return ctl_error_set(sweep->error, PCCD_E_NOMEM, "out of memory");
    }
    sweep->separation = robot_has_clearances(robot) ? 0 : sweep->clearance;
    int status = pccd_scene_create(sweep->client, NULL, &sweep->scene);
    for (uint32_t i = 0; i < robot->shape_count && status == PCCD_OK; i++) {
        struct robot_shape *shape = &robot->shapes[i];
        status = put_shape(sweep, shape);
        sweep->motions[i] = (struct pccd_motion){.object = shape->handle,
                                                 .first = robot->joint_count + i,
                                                 .count = shape->mesh.vertex_count};
    }
    for (uint32_t a = 0; a < robot->shape_count; a++) {
        for (uint32_t b = a + 1; b < robot->shape_count && status == PCCD_OK; b++) {
            status = set_pair(sweep, &robot->shapes[a], &robot->shapes[b]);
        }
    }
    return fail(sweep, status);
}

void sweep_end(struct sweep *sweep)
{
    free(sweep->joints);
    free(sweep->motions);
}

static uint32_t shape_of(const struct robot *robot, uint32_t handle)
{
    uint32_t i = 0;
    while (i + 1 < robot->shape_count && robot->shapes[i].handle != handle) {
        i++;
    }
    return i;
}

static void set_shapes(const struct robot *robot, uint32_t a, uint32_t b,
                       struct sweep_hit *hit)
{
    uint32_t first = shape_of(robot, a), second = shape_of(robot, b);
    hit->shapes[0] = first < second ? first : second;
    hit->shapes[1] = first < second ? second : first;
}

/* Take what the records of a page say: the earliest begin of all, and the earliest end of
 * those that are proved, else the latest one. */
static void take_records(const struct robot *robot, const struct pccd_answer *page,
                         struct sweep_hit *hit)
{
    for (uint64_t i = 0; i < page->count; i++) {
        const struct pccd_contact *record = &page->contacts[i];
        bool is_proved = (record->flags & PCCD_PROVED) != 0;
        bool is_first = !hit->is_there || is_proved > hit->is_proved;
        if (is_first ||
            (is_proved == hit->is_proved &&
             (is_proved ? record->toi_hi < hit->t[1] : record->toi_hi > hit->t[1]))) {
            hit->t[1] = record->toi_hi;
            set_shapes(robot, record->object_a, record->object_b, hit);
        }
        hit->t[0] = hit->is_there ? fmin(hit->t[0], record->toi) : record->toi;
        hit->is_proved = hit->is_proved || is_proved;
        hit->is_there = true;
    }
}

int sweep_ask(struct sweep *sweep, const double *from, const double *to, double distance,
              double tolerance, struct sweep_hit *hit)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    struct pccd_answer page = PCCD_ANSWER_INIT;
    uint64_t step;
    settings.mode = PCCD_MODE_FIRST;
    settings.threads = sweep->threads;
    settings.separation = distance;
    settings.tolerance = fmin(fmax(tolerance, TOLERANCE_MIN), 1);
    *hit = (struct sweep_hit){.is_there = false};
    robot_joints(sweep->robot, from, to, sweep->joints);
    if (judge_joints(sweep, from, to) != PCCD_OK) {
        return PCCD_E_INVAL;
    }
    sweep->asked++;
    settings.joints = sweep->joints;
    settings.joint_count = sweep->robot->joint_count + sweep->robot->shape_count;
    int status = pccd_submit(sweep->client, sweep->scene, sweep->motions,
                             sweep->robot->shape_count, &settings, &step);
    if (status == PCCD_OK) {
        status = pccd_wait(sweep->client, step, -1, &page);
    }
    while (status == PCCD_OK) {
        bool is_whole = page.incomplete == PCCD_COMPLETE ||
                        page.incomplete == PCCD_INCOMPLETE_RESULT_FULL;
        uint64_t cursor = page.cursor, total = page.total;
        take_records(sweep->robot, &page, hit);
        pccd_answer_release(sweep->client, &page);
        if (!is_whole && !hit->is_proved) {
            *hit = (struct sweep_hit){.is_there = true, .is_unknown = true, .t = {0, 1}};
        } else if (!is_whole) { /* what was not decided may be earlier */
            hit->t[0] = 0;
        }
        if (!is_whole || cursor >= total) {
            break;
        }
        status = pccd_fetch(sweep->client, sweep->scene, step, cursor, &page);
    }
    return fail(sweep, status);
}

/* Add the parts of two objects to those that meet, once. */
static int add_meeting(const struct sweep *sweep, uint32_t a, uint32_t b,
                       struct sweep_answer *answer)
{
    const struct robot *robot = sweep->robot;
    void *list = answer->meeting;
    struct sweep_hit of;
    set_shapes(robot, a, b, &of);
    const struct robot_pair pair = {
        .parts = {robot->shapes[of.shapes[0]].part, robot->shapes[of.shapes[1]].part}};
    for (size_t i = 0; i < answer->meeting_count; i++) {
        if (memcmp(answer->meeting[i].parts, pair.parts, sizeof pair.parts) == 0) {
            return PCCD_OK;
        }
    }
    if (!array_reserve(&list, answer->meeting_count, &answer->meeting_room,
                       sizeof *answer->meeting)) {
        return PCCD_E_NOMEM;
    }
    answer->meeting = list;
    answer->meeting[answer->meeting_count++] = pair;
    return PCCD_OK;
}

/* Ask about where the last motion began, of two objects (0: of all); a record becomes a
 * hit, or all of them are added to those that meet, if `all` is not NULL. */
static int look_for(struct sweep *sweep, enum pccd_near_what what, uint32_t a, uint32_t b,
                    struct sweep_hit *hit, struct sweep_answer *all)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings.what = what;
    settings.at_begin = true;
    settings.object_a = a;
    settings.object_b = b;
    settings.threads = sweep->threads;
    int status = pccd_ask_near(sweep->client, sweep->scene, NULL, 0, &settings, &answer);
    if (status == PCCD_OK && answer.count > 0) {
        *hit = (struct sweep_hit){.is_there = true, .is_proved = true};
        set_shapes(sweep->robot, answer.near[0].object_a, answer.near[0].object_b, hit);
    }
    bool has_more = status == PCCD_OK;
    while (has_more) {
        const uint64_t step = answer.step, cursor = answer.cursor;
        has_more = all != NULL && cursor < answer.total;
        for (uint64_t i = 0; i < answer.count && all != NULL && status == PCCD_OK; i++) {
            const struct pccd_near *near = &answer.near[i];
            status = add_meeting(sweep, near->object_a, near->object_b, all);
        }
        pccd_answer_release(sweep->client, &answer);
        if (has_more && status == PCCD_OK) {
            status = pccd_fetch(sweep->client, sweep->scene, step, cursor, &answer);
        }
        has_more = has_more && status == PCCD_OK;
    }
    return status;
}

/* Look for a shape within another one. The answer for all takes closed meshes alone; if
 * one is open, each pair is asked, and those with an open one are not known. */
static int look_within(struct sweep *sweep, struct sweep_hit *hit,
                       struct sweep_answer *all)
{
    const struct robot *robot = sweep->robot;
    int status =
        sweep->is_open ? PCCD_E_INVAL : look_for(sweep, PCCD_NEAR_DEPTH, 0, 0, hit, all);
    if (status != PCCD_E_INVAL) {
        return status;
    }
    sweep->is_open = true;
    status = PCCD_OK;
    for (uint32_t a = 0; a < robot->shape_count; a++) {
        for (uint32_t b = a + 1; b < robot->shape_count; b++) {
            const struct robot_shape *first = &robot->shapes[a],
                                     *other = &robot->shapes[b];
            bool is_known = all == NULL && hit->is_there && hit->t[1] == 0;
            if (status != PCCD_OK || is_known ||
                robot_never_asks(robot, first->part, other->part)) {
                continue;
            }
            status =
                look_for(sweep, PCCD_NEAR_DEPTH, first->handle, other->handle, hit, all);
            status = status == PCCD_E_INVAL ? PCCD_OK : status;
        }
    }
    return status;
}

int sweep_look(struct sweep *sweep, struct sweep_hit *hit)
{
    int status = look_for(sweep, PCCD_NEAR_CROSSINGS, 0, 0, hit, NULL);
    if (status == PCCD_OK && !(hit->is_there && hit->t[1] == 0)) {
        status = look_within(sweep, hit, NULL);
    }
    return fail(sweep, status);
}

/* ---- where two shapes are nearest -------------------------------------------------- */

void sweep_pose(struct sweep *sweep, const double *values, uint32_t shape, double m[12])
{
    robot_joints(sweep->robot, values, values, sweep->joints);
    common_joint_transform(sweep->joints, sweep->robot->joint_count + shape, 0, m);
}

/* Find the points of a record of what is near; its shapes are shapes[2]. */
static int find_points(struct sweep *sweep, const double *values,
                       const struct pccd_near *near, const uint32_t shapes[2],
                       double points[2][3])
{
    struct pccd_body bodies[2] = {{.object = 0}, {.object = 0}};
    struct pccd_edge *edges[2] = {NULL, NULL};
    double m[2][12];
    uint32_t first =
        sweep->robot->shapes[shapes[0]].handle > sweep->robot->shapes[shapes[1]].handle;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < 2 && status == PCCD_OK; i++) {
        const struct robot_shape *shape = &sweep->robot->shapes[shapes[i ^ first]];
        edges[i] = malloc(((size_t)shape->edge_count + 1) * sizeof *edges[i]);
        status = edges[i] != NULL ? pccd_mesh_edges(sweep->client, shape->registered,
                                                    edges[i], shape->edge_count)
                                  : PCCD_E_NOMEM;
        sweep_pose(sweep, values, shapes[i ^ first], m[i]);
        bodies[i] = (struct pccd_body){.object = shape->handle,
                                       .vertex_count = shape->mesh.vertex_count,
                                       .triangle_count = shape->mesh.triangles.count,
                                       .edge_count = shape->edge_count,
                                       .triangles = shape->mesh.triangles.vertices,
                                       .edges = edges[i],
                                       .x0 = shape->mesh.x,
                                       .m0 = m[i],
                                       .m1 = m[i]};
    }
    if (status == PCCD_OK) {
        status = pccd_near_points(bodies, 2, near, 1, 0, (double(*)[2][3])(void *)points);
    }
    free(edges[0]);
    free(edges[1]);
    return status;
}

/* Return by how much the distance of two shapes of a record is above what they keep. */
static double gap_of(const struct sweep *sweep, const struct pccd_near *near)
{
    const struct robot *robot = sweep->robot;
    return near->d_lo - clearance_of(sweep,
                                     &robot->shapes[shape_of(robot, near->object_a)],
                                     &robot->shapes[shape_of(robot, near->object_b)]);
}

/* Take the record of two shapes that are nearest beside what they keep; of any two, if
 * both are one. */
static const struct pccd_near *least_of(const struct sweep *sweep,
                                        const struct pccd_answer *answer,
                                        const uint32_t shapes[2])
{
    const struct robot *robot = sweep->robot;
    const struct pccd_near *least = NULL;
    for (uint64_t i = 0; i < answer->count; i++) {
        const struct pccd_near *near = &answer->near[i];
        struct sweep_hit of;
        set_shapes(robot, near->object_a, near->object_b, &of);
        bool is_asked =
            shapes[0] == shapes[1] || memcmp(of.shapes, shapes, sizeof of.shapes) == 0;
        if (is_asked && (least == NULL || gap_of(sweep, near) < gap_of(sweep, least))) {
            least = near;
        }
    }
    return least;
}

/* Ask how near any two shapes are at these values. Release the answer, also after an
 * error. */
static int ask_nearest(struct sweep *sweep, const double *values,
                       struct pccd_answer *answer)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct sweep_hit hit;
    settings.what = PCCD_NEAR_NEAREST;
    settings.distance = INFINITY;
    settings.at_begin = true;
    settings.threads = sweep->threads;
    int status = sweep_ask(sweep, values, values, 0, 1, &hit);
    if (status == PCCD_OK) {
        status = fail(sweep, pccd_ask_near(sweep->client, sweep->scene, NULL, 0,
                                           &settings, answer));
    }
    if (status == PCCD_OK && answer->count < answer->total) { /* a part tells no least */
        status = ctl_error_set(sweep->error, PCCD_E_LIMIT,
                               "%s: too many shapes to tell which are nearest",
                               sweep->robot->path);
    }
    return status;
}

int sweep_meeting(struct sweep *sweep, const double *values, struct sweep_answer *answer)
{
    struct pccd_answer near = PCCD_ANSWER_INIT;
    struct sweep_hit hit = {.is_there = false};
    int status = ask_nearest(sweep, values, &near);
    if (status != PCCD_OK) {
        pccd_answer_release(sweep->client, &near);
        return status;
    }
    const uint32_t *jam = answer->jams[0].shapes;
    status = add_meeting(sweep, sweep->robot->shapes[jam[0]].handle,
                         sweep->robot->shapes[jam[1]].handle, answer);
    for (uint64_t i = 0; i < near.count && status == PCCD_OK; i++) {
        if (gap_of(sweep, &near.near[i]) <= 0) {
            status =
                add_meeting(sweep, near.near[i].object_a, near.near[i].object_b, answer);
        }
    }
    pccd_answer_release(sweep->client, &near);
    return fail(sweep, status == PCCD_OK ? look_within(sweep, &hit, answer) : status);
}

int sweep_nearest(struct sweep *sweep, const double *values, uint32_t shapes[2],
                  double points[2][3], bool *is_found)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct sweep_hit hit;
    int status = ask_nearest(sweep, values, &answer);
    const struct pccd_near *least =
        status == PCCD_OK ? least_of(sweep, &answer, shapes) : NULL;
    *is_found = least != NULL;
    if (least != NULL) {
        set_shapes(sweep->robot, least->object_a, least->object_b, &hit);
        memcpy(shapes, hit.shapes, sizeof hit.shapes);
        status = fail(sweep, find_points(sweep, values, least, shapes, points));
    }
    pccd_answer_release(sweep->client, &answer);
    return status;
}
