/* sweep_ask.c - a mechanism in a daemon, and what meets in one of its motions. */
#include <math.h>
#include <stdlib.h>

#include "sweep.h"

#define TOLERANCE_MIN 1e-12

static int fail(struct sweep *sweep, int status)
{
    return status == PCCD_OK
               ? PCCD_OK
               : ctl_error_set(sweep->error, status, "%s: %s", sweep->robot->path,
                               pccd_error_text(sweep->client));
}

static int put_shape(struct sweep *sweep, struct robot_shape *shape)
{
    uint32_t mesh;
    int status = scene_put_mesh(sweep->client, &shape->mesh, &mesh, NULL);
    if (status == PCCD_OK) {
        status = pccd_scene_add(sweep->client, sweep->scene, mesh, &shape->handle);
    }
    shape->settings.what |= PCCD_OBJECT_SELF; /* it is rigid */
    shape->settings.self_collision = false;
    return status == PCCD_OK ? pccd_object_set(sweep->client, sweep->scene, shape->handle,
                                               &shape->settings)
                             : status;
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
            const struct robot_shape *first = &robot->shapes[a];
            const struct robot_shape *second = &robot->shapes[b];
            if (robot_never_asks(robot, first->part, second->part)) {
                status = pccd_pair_ignore(sweep->client, sweep->scene, first->handle,
                                          second->handle, true);
            } else {
                sweep->pair_count++;
            }
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
            hit->is_there = true;
            hit->t[0] = 0;
            hit->t[1] = 1;
        }
        if (!is_whole || cursor >= total) {
            break;
        }
        status = pccd_fetch(sweep->client, sweep->scene, step, cursor, &page);
    }
    return fail(sweep, status);
}

/* Ask about where the last motion began; a record becomes a hit. */
static int look_for(struct sweep *sweep, enum pccd_near_what what, struct sweep_hit *hit)
{
    struct pccd_near_settings settings = PCCD_NEAR_SETTINGS_INIT;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    settings.what = what;
    settings.end = 0;
    settings.threads = sweep->threads;
    int status = pccd_ask_near(sweep->client, sweep->scene, NULL, 0, &settings, &answer);
    if (status == PCCD_OK && answer.count > 0) {
        *hit = (struct sweep_hit){.is_there = true, .is_proved = true};
        set_shapes(sweep->robot, answer.near[0].object_a, answer.near[0].object_b, hit);
    }
    pccd_answer_release(sweep->client, &answer);
    return status;
}

int sweep_look(struct sweep *sweep, struct sweep_hit *hit)
{
    int status = look_for(sweep, PCCD_NEAR_CROSSINGS, hit);
    if (status == PCCD_OK && !sweep->is_open && !(hit->is_there && hit->t[1] == 0)) {
        status = look_for(sweep, PCCD_NEAR_DEPTH, hit);
        sweep->is_open = status == PCCD_E_INVAL;
        status = sweep->is_open ? PCCD_OK : status;
    }
    return fail(sweep, status);
}
