/* play_up.c - which axis points up in a recording. */
#include <math.h>
#include <string.h>

#include "play.h"

/* Things fall along an axis if they move so many times as far against it as along both
 * others, and so much of that goes one way; what walks does not fall. */
#define UP_TIMES 2.0
#define UP_PART  0.25
#define UP_ELSE  2u /* y */
/* Kinds that say nothing of motion. */
#define UNREAD (1u << RECORD_ANSWER | 1u << RECORD_RECORDS)

struct falling {
    double moved[3]; /* mean motion of each object's vertices, over all steps; .. */
    double way[3];   /* .. the same without signs */
};

static void add_step(struct falling *falling, const struct registry_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct registry_object *object = &scene->objects[i];
        const uint32_t count = object->mesh->vertex_count;
        for (uint32_t v = 0; v < count; v++) {
            for (uint32_t k = 0; k < 3; k++) {
                double way = (object->x1[v][k] - object->x0[v][k]) / count;
                falling->moved[k] += way;
                falling->way[k] += fabs(way);
            }
        }
    }
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
    int status = record_reader_open(&reader, settings->from != NULL ? settings->from
                                                                    : settings->path);
    while (status == PCCD_OK && up == 0 &&
           record_reader_skim(&reader, ~UNREAD, &view) == 1) {
        struct record_begin begin;
        if (view.kind == RECORD_BEGIN) {
            memcpy(&begin, view.payload, sizeof begin);
            up = begin.flags >> RECORD_UP_SHIFT & RECORD_UP_MASK;
        } else if (recorded_item_take(&item, &view)) {
            if (!item.is_near && recorded_state_move(&state, &item, &error) == PCCD_OK) {
                add_step(falling, registry_scene(&state, item.frame.scene));
            }
        } else {
            status = recorded_state_follow(&state, &view, &error);
        }
    }
    registry_deinit(&state);
    record_reader_deinit(&reader);
    return up;
}

uint32_t play_up(const struct play_settings *parts)
{
    struct falling falling = {.moved = {0}};
    for (; parts->path != NULL; parts++) {
        uint32_t up = read_motion(parts, &falling);
        if (up != 0) {
            return up;
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        const double *moved = falling.moved;
        double others = fmax(fabs(moved[(k + 1) % 3]), fabs(moved[(k + 2) % 3]));
        if (-moved[k] > UP_TIMES * others && -moved[k] > UP_PART * falling.way[k]) {
            return k + 1;
        }
    }
    return UP_ELSE;
}
