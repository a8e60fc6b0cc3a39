/* play_up.c - which axis points up in a recording. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "play.h"

/* Things fall along an axis if they move so many times as far against it as along both
 * others, and so much of that goes one way; what walks does not fall. */
#define UP_TIMES 2.0
#define UP_PART  0.25
#define UP_ELSE  2u /* y */
/* Kinds that say nothing of motion. */
#define UNREAD (1u << RECORD_ANSWER | 1u << RECORD_RECORDS)

struct falling {
    double moved[3];   /* mean motion of each object's vertices, over all steps; .. */
    double way[3];     /* .. the same without signs */
    struct last *last; /* ours: [count] */
    uint32_t count;
    size_t room;
};

/* The last step of an object that is not added yet. */
struct last {
    uint32_t scene, object;
    double x[3]; /* the middle of its vertices at the begin */
    double moved[3], way[3];
};

/* Return how much of its last step an object took, 0 to 1, if it is at `x` now: a program
 * may ask often, and go as far as is safe each time. */
static double part_taken(const struct last *last, const double x[3])
{
    double along = 0, whole = 0;
    for (uint32_t k = 0; k < 3; k++) {
        along += (x[k] - last->x[k]) * last->moved[k];
        whole += last->moved[k] * last->moved[k];
    }
    return whole > 0 ? fmin(fmax(along / whole, 0), 1) : 1;
}

static void add(struct falling *falling, const struct last *last, double part)
{
    for (uint32_t k = 0; k < 3; k++) {
        falling->moved[k] += part * last->moved[k];
        falling->way[k] += part * last->way[k];
    }
}

static struct last step_of(const struct registry_scene *scene,
                           const struct registry_object *object)
{
    struct last step = {.scene = scene->handle, .object = object->handle};
    const uint32_t count = object->mesh->vertex_count;
    for (uint32_t v = 0; v < count; v++) {
        for (uint32_t k = 0; k < 3; k++) {
            double way = (object->x1[v][k] - object->x0[v][k]) / count;
            step.x[k] += object->x0[v][k] / count;
            step.moved[k] += way;
            step.way[k] += fabs(way);
        }
    }
    return step;
}

/* Return the last step of an object; NULL: it had none. They stand in the order of their
 * scenes' lists, so that the one behind `before` is nearly always right. */
static struct last *find(const struct falling *falling, const struct last *before,
                         const struct last *step)
{
    const uint32_t from = before != NULL ? (uint32_t)(before - falling->last) + 1 : 0;
    for (uint32_t i = 0; i < falling->count; i++) {
        struct last *last = &falling->last[(from + i) % falling->count];
        if (last->scene == step->scene && last->object == step->object) {
            return last;
        }
    }
    return NULL;
}

/* Add what the objects of a scene took of their last steps. False without memory. */
static bool add_step(struct falling *falling, const struct registry_scene *scene)
{
    struct last *last = NULL;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct last step = step_of(scene, &scene->objects[i]);
        last = find(falling, last, &step);
        if (last != NULL) {
            add(falling, last, part_taken(last, step.x));
        } else if (array_reserve((void **)&falling->last, falling->count, &falling->room,
                                 sizeof step)) {
            last = &falling->last[falling->count++];
        } else {
            return false;
        }
        *last = step;
    }
    return true;
}

/* Add the motion of a recording, as far as it can be read. Returns the axis that it has
 * been given; 0: none. */
static uint32_t read_motion(const struct play_settings *settings, struct falling *falling)
{
    struct record_reader reader;
    struct record_view view;
    struct registry state = {.meshes = NULL};
    struct recorded_item item;
    struct ctl_error error;
    uint32_t up = 0;
    falling->count = 0; /* of another recording */
    int status = record_reader_open(&reader, settings->from != NULL ? settings->from
                                                                    : settings->path);
    while (status == PCCD_OK && up == 0 &&
           record_reader_skim(&reader, ~UNREAD, &view) == 1) {
        struct record_begin begin;
        if (view.kind == RECORD_BEGIN) {
            memcpy(&begin, view.payload, sizeof begin);
            up = begin.flags >> RECORD_UP_SHIFT & RECORD_UP_MASK;
        } else if (recorded_item_take(&item, &view)) {
            if (!item.is_near && recorded_state_move(&state, &item, &error) == PCCD_OK &&
                !add_step(falling, registry_scene(&state, item.frame.scene))) {
                status = PCCD_E_NOMEM;
            }
        } else {
            status = recorded_state_follow(&state, &view, &error);
        }
    }
    for (uint32_t i = 0; i < falling->count; i++) {
        add(falling, &falling->last[i], 1);
    }
    registry_deinit(&state);
    record_reader_deinit(&reader);
    return up;
}

uint32_t play_up(const struct play_settings *parts)
{
    struct falling falling = {.moved = {0}};
    uint32_t up = 0;
    for (; parts->path != NULL; parts++) {
        up = up != 0 ? up : read_motion(parts, &falling);
    }
    free(falling.last);
    for (uint32_t k = 0; k < 3 && up == 0; k++) {
        const double *moved = falling.moved;
        double others = fmax(fabs(moved[(k + 1) % 3]), fabs(moved[(k + 2) % 3]));
        if (-moved[k] > UP_TIMES * others && -moved[k] > UP_PART * falling.way[k]) {
            up = k + 1;
        }
    }
    return up != 0 ? up : UP_ELSE;
}
