/* render_draw.c - a step of a recording becomes a picture. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "export.h"
#include "picture.h"
#include "printable.h"
#include "render.h"

#define GROUPS      64u /* colours of times */
#define DEGREE      0.017453292519943295
#define AZIMUTH     25.0
#define ELEVATION   16.0
#define PLACE_ROOM  1.6f /* around the features of a contact */
#define PLACE_LEAST 0.01 /* of the scene, where they have no size */

/* The direction to the eye: azimuth 0 looks along the axis after the one that is up. */
static void find_eye(const struct render *render, float from[3])
{
    bool is_given = !isnan(render->azimuth);
    double a = (is_given ? render->azimuth : AZIMUTH) * DEGREE;
    double e = (is_given ? render->elevation : ELEVATION) * DEGREE;
    uint32_t up = render->up == PICTURE_UP_Y ? 1 : render->up == PICTURE_UP_Z ? 2 : 0;
    from[up] = (float)sin(e);
    from[(up + 1) % 3] = (float)(cos(e) * cos(a));
    from[(up + 2) % 3] = (float)(cos(e) * sin(a));
}

static void name_step(const struct render *render, const struct still *still, char *title,
                      size_t room)
{
    if (render->is_near) {
        snprintf(title, room, "question %" PRIu64 ", %" PRIu64 " %s", still->step,
                 still->line_count, proto_plural(still->line_count, "record", "records"));
    } else if (render->contact > 0) {
        snprintf(title, room,
                 "step %" PRIu64 " at t = %.6g, contact %" PRIu64 " of %" PRIu64,
                 still->step, still->t, render->contact, still->contact_count);
    } else {
        snprintf(title, room, "step %" PRIu64 ", %" PRIu64 " %s", still->step,
                 still->contact_count,
                 proto_plural(still->contact_count, "contact", "contacts"));
    }
}

/* The features of the chosen contact, and what is around them. */
static struct picture_place place_of(const struct render *render,
                                     const struct still *still)
{
    struct picture_place place = {.radius = 0};
    if (render->contact > 0) {
        const struct still_contact *contact = &still->contacts[still->chosen];
        for (uint32_t k = 0; k < 3; k++) {
            place.at[k] = contact->at[k] +
                          (render->is_thick ? contact->share * contact->reach[k] : 0);
        }
        place.radius = contact->radius > 0 ? PLACE_ROOM * contact->radius
                                           : (float)(PLACE_LEAST * still->extent);
    }
    return place;
}

/* Lines by their shares of the greatest distance. */
static void mark_lines(const struct still *still, double greatest,
                       struct picture_mark *marks)
{
    for (uint64_t i = 0; i < still->line_count; i++) {
        double share = greatest > 0 ? still->lines[i].distance / greatest : 0;
        memcpy(marks[i].at, still->lines[i].ends[0], sizeof marks[i].at);
        memcpy(marks[i].to, still->lines[i].ends[1], sizeof marks[i].to);
        marks[i].is_line = true;
        marks[i].group = (uint32_t)(share * (GROUPS - 1));
    }
}

/* A dot, over a line to the nearest point of its first feature if it is at a distance;
 * the dot is where they touch. Returns how many marks there are now. */
static uint32_t mark_contact(const struct still_contact *contact, bool is_thick,
                             struct picture_mark *marks, uint32_t count)
{
    uint32_t group = contact->toi > 0 ? (uint32_t)(contact->toi * GROUPS) : 0;
    struct picture_mark mark = {.group = group < GROUPS ? group : GROUPS - 1};
    const float *reach = contact->reach;
    memcpy(mark.at, contact->at, sizeof mark.at);
    if (reach[0] != 0 || reach[1] != 0 || reach[2] != 0) {
        mark.is_line = true;
        for (uint32_t k = 0; k < 3; k++) {
            mark.to[k] = mark.at[k] + reach[k];
        }
        marks[count++] = mark;
        mark.is_line = false;
    }
    for (uint32_t k = 0; k < 3 && is_thick; k++) {
        mark.at[k] += contact->share * reach[k];
    }
    marks[count] = mark;
    return count + 1;
}

/* Contacts by their times, the chosen one over the others. Returns how many marks. */
static uint32_t mark_contacts(const struct render *render, const struct still *still,
                              struct picture_mark *marks)
{
    uint32_t count = 0;
    for (uint64_t i = 0; i < still->contact_count; i++) {
        if (render->contact == 0 || i != still->chosen) {
            count = mark_contact(&still->contacts[i], render->is_thick, marks, count);
        }
    }
    if (render->contact > 0) {
        count =
            mark_contact(&still->contacts[still->chosen], render->is_thick, marks, count);
        marks[count - 1].is_chosen = true;
    }
    return count;
}

static void make_meshes(const struct still *still, struct picture_mesh *meshes)
{
    for (uint32_t i = 0; i < still->object_count; i++) {
        const struct still_object *object = &still->objects[i];
        meshes[i] =
            (struct picture_mesh){.x = (const float(*)[3])object->x,
                                  .triangles = (const uint32_t(*)[3])object->triangles,
                                  .edges = (const uint32_t(*)[2])object->edges,
                                  .points = object->points,
                                  .radii = object->radii,
                                  .vertex_count = object->vertex_count,
                                  .triangle_count = object->triangle_count,
                                  .edge_count = object->edge_count,
                                  .point_count = object->point_count};
        colour_of_object(i, meshes[i].front, meshes[i].back);
    }
}

/* The next picture of a film. */
static int add_picture(const struct picture *picture, struct film *film,
                       struct ctl_error *error)
{
    void *png = NULL;
    size_t bytes = 0;
    int status = picture_encode(picture, film->path, &png, &bytes, error);
    if (status == PCCD_OK) {
        status = film_add(film, png, bytes, error);
    }
    free(png);
    return status;
}

int render_draw(const struct render *render, const struct still *still, FILE *file,
                struct film *film, const float (*bounds)[3], struct ctl_error *error)
{
    struct picture_mesh *meshes = calloc(still->object_count + 1, sizeof *meshes);
    struct picture_mark *marks =
        calloc(2 * still->contact_count + still->line_count + 1, sizeof *marks);
    double greatest = still_greatest(still);
    struct picture_group groups[GROUPS];
    struct picture_scale scale = {.title = "time of impact", .low = "0", .high = "1"};
    char title[128];
    if (meshes == NULL || marks == NULL) {
        free(meshes);
        free(marks);
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", render->path);
    }
    make_meshes(still, meshes);
    uint32_t mark_count = still->lines != NULL ? (uint32_t)still->line_count
                                               : mark_contacts(render, still, marks);
    if (still->lines != NULL) {
        mark_lines(still, greatest, marks);
        snprintf(scale.title, sizeof scale.title, "distance");
        snprintf(scale.high, sizeof scale.high, "%.4g", greatest);
    }
    for (uint32_t i = 0; i < GROUPS; i++) {
        groups[i].label[0] = '\0';
        colour_of_time(((double)i + 0.5) / GROUPS, groups[i].colour);
    }
    name_step(render, still, title, sizeof title);
    struct picture_place place = place_of(render, still);
    struct picture picture = {.meshes = meshes,
                              .marks = marks,
                              .groups = groups,
                              .mesh_count = still->object_count,
                              .mark_count = mark_count,
                              .group_count = GROUPS,
                              .up = render->up,
                              .width = render->width,
                              .height = render->height,
                              .zoom = (float)render->zoom,
                              .is_at_marks = render->is_at_contacts,
                              .bounds = bounds,
                              .is_thick = render->is_thick,
                              .gap = (float)(still->separation / 2),
                              .place = render->contact > 0 ? &place : NULL,
                              .title = title,
                              .scale =
                                  still->lines == NULL || greatest > 0 ? &scale : NULL};
    find_eye(render, picture.from);
    if (render->contact > 0 && isnan(render->azimuth)) {
        viewpoint_choose(still, picture.from);
    }
    int status = film != NULL ? add_picture(&picture, film, error)
                              : picture_write(&picture, file, render->path, error);
    free(meshes);
    free(marks);
    return status;
}
