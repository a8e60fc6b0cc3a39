/* render_draw.c - a step of a recording becomes a picture. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "picture.h"
#include "printable.h"
#include "render.h"

#define DEGREE      0.017453292519943295
#define AZIMUTH     25.0
#define ELEVATION   16.0
#define PLACE_ROOM  1.6f /* around the features of a contact */
#define PLACE_LEAST 0.01 /* of the scene, where they have no size */
#define TURNS       16u  /* directions around the normal */
#define NEAR        1e-3 /* of the contact's radius: what it lies on hides nothing */
#define STEEP       0.3  /* what a steeper view costs, beside how far it is turned away */

/* ---- from where a contact can be seen ---------------------------------------------- */

/* Sines of angles to the plane in which the surfaces touch. */
static const double tilts[] = {0.3, -0.3, 0.8, -0.8};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* False for a vector without length. */
static bool normalize(double x[3])
{
    double length = sqrt(dot(x, x));
    for (int k = 0; k < 3; k++) {
        x[k] /= length > 0 ? length : 1;
    }
    return length > 0;
}

/* Return whether the ray meets the triangle farther than `near` away. */
static bool meets(const double at[3], const double way[3], double near,
                  const float (*x)[3], const uint32_t v[3])
{
    double a[3], b[3], from[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)x[v[1]][k] - (double)x[v[0]][k];
        b[k] = (double)x[v[2]][k] - (double)x[v[0]][k];
        from[k] = at[k] - (double)x[v[0]][k];
    }
    cross(way, b, p);
    double area = dot(a, p);
    if (area == 0) {
        return false;
    }
    cross(from, a, q);
    double u = dot(from, p) / area, w = dot(way, q) / area;
    return u >= 0 && w >= 0 && u + w <= 1 && dot(b, q) / area > near;
}

static bool is_free(const struct snapshot *snapshot, const double at[3],
                    const double way[3], double near)
{
    for (uint32_t o = 0; o < snapshot->object_count; o++) {
        const struct snapshot_object *object = &snapshot->objects[o];
        for (uint32_t i = 0; i < object->triangle_count; i++) {
            if (meets(at, way, near, (const float(*)[3])object->x,
                      object->triangles[i])) {
                return false;
            }
        }
    }
    return true;
}

/* `from`, unit, is the wanted direction from contact snapshot->chosen to the eye, and
 * becomes the one of those with a free view that is least turned away from it; it stays
 * where none of them has a free view. */
static void choose_viewpoint(const struct snapshot *snapshot, float from[3])
{
    const struct snapshot_contact *contact = &snapshot->contacts[snapshot->chosen];
    const double wanted[3] = {from[0], from[1], from[2]};
    double at[3], normal[3], side[3], other[3], least = INFINITY;
    for (int k = 0; k < 3; k++) {
        at[k] = contact->at[k];
        normal[k] = contact->normal[k];
    }
    if (!normalize(normal)) {
        return;
    }
    cross(normal, wanted, side);
    if (!normalize(side)) { /* seen along the normal: any side will do */
        const double axes[2][3] = {{1, 0, 0}, {0, 1, 0}};
        cross(normal, axes[fabs(normal[0]) > 0.9], side);
        normalize(side);
    }
    cross(side, normal, other); /* of the plane, towards the eye that is wanted */
    for (uint32_t i = 0; i < TURNS * sizeof tilts / sizeof tilts[0]; i++) {
        double tilt = tilts[i / TURNS], flat = sqrt(1 - tilt * tilt);
        double turn = 2 * M_PI * (i % TURNS) / TURNS;
        double way[3];
        for (int k = 0; k < 3; k++) {
            way[k] =
                flat * (cos(turn) * other[k] + sin(turn) * side[k]) + tilt * normal[k];
        }
        double cost = 1 - dot(way, wanted) + STEEP * fabs(tilt);
        if (cost < least && is_free(snapshot, at, way, NEAR * (double)contact->radius)) {
            least = cost;
            for (int k = 0; k < 3; k++) {
                from[k] = (float)way[k];
            }
        }
    }
}

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

static void name_step(const struct render *render, const struct snapshot *snapshot,
                      char *title, size_t room)
{
    if (render->is_near) {
        snprintf(title, room, "question %" PRIu64 ", %" PRIu64 " %s", snapshot->step,
                 snapshot->line_count,
                 proto_plural(snapshot->line_count, "record", "records"));
    } else if (render->contact > 0) {
        snprintf(title, room,
                 "step %" PRIu64 " at t = %.6g, contact %" PRIu64 " of %" PRIu64,
                 snapshot->step, snapshot->t, render->contact, snapshot->contact_count);
    } else {
        snprintf(title, room, "step %" PRIu64 ", %" PRIu64 " %s", snapshot->step,
                 snapshot->contact_count,
                 proto_plural(snapshot->contact_count, "contact", "contacts"));
    }
}

/* The features of the chosen contact, and what is around them. */
static struct picture_place place_of(const struct render *render,
                                     const struct snapshot *snapshot)
{
    struct picture_place place = {.radius = 0};
    if (render->contact > 0) {
        const struct snapshot_contact *contact = &snapshot->contacts[snapshot->chosen];
        for (uint32_t k = 0; k < 3; k++) {
            place.at[k] = contact->at[k] +
                          (render->is_thick ? contact->share * contact->reach[k] : 0);
        }
        place.radius = contact->radius > 0 ? PLACE_ROOM * contact->radius
                                           : (float)(PLACE_LEAST * snapshot->extent);
    }
    return place;
}

/* Lines by their shares of the greatest distance. */
static void mark_lines(const struct snapshot *snapshot, double greatest,
                       struct picture_mark *marks)
{
    for (uint64_t i = 0; i < snapshot->line_count; i++) {
        double share = greatest > 0 ? snapshot->lines[i].distance / greatest : 0;
        memcpy(marks[i].at, snapshot->lines[i].ends[0], sizeof marks[i].at);
        memcpy(marks[i].to, snapshot->lines[i].ends[1], sizeof marks[i].to);
        marks[i].is_line = true;
        marks[i].colour = (uint32_t)(share * (PICTURE_COLOURS - 1));
    }
}

/* A dot, over a line to the nearest point of its first feature if it is at a distance;
 * the dot is where they touch. Returns how many marks there are now. */
static uint32_t mark_contact(const struct snapshot_contact *contact, bool is_thick,
                             struct picture_mark *marks, uint32_t count)
{
    uint32_t colour = contact->toi > 0 ? (uint32_t)(contact->toi * PICTURE_COLOURS) : 0;
    struct picture_mark mark = {.colour = colour < PICTURE_COLOURS ? colour
                                                                   : PICTURE_COLOURS - 1};
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

/* The one that is drawn larger; contact_count: none is. */
static uint64_t chosen_of(const struct render *render, const struct snapshot *snapshot)
{
    uint64_t chosen = render->contact > 0 ? snapshot->chosen : snapshot->contact_count;
    for (uint64_t i = 0; render->marks_first && i < snapshot->contact_count; i++) {
        if (chosen == snapshot->contact_count ||
            snapshot->contacts[i].toi < snapshot->contacts[chosen].toi) {
            chosen = i;
        }
    }
    return chosen;
}

/* Contacts by their times, the chosen one over the others. Returns how many marks. */
static uint32_t mark_contacts(const struct render *render,
                              const struct snapshot *snapshot, struct picture_mark *marks)
{
    uint64_t chosen = chosen_of(render, snapshot);
    uint32_t count = 0;
    for (uint64_t i = 0; i < snapshot->contact_count; i++) {
        if (i != chosen) {
            count = mark_contact(&snapshot->contacts[i], render->is_thick, marks, count);
        }
    }
    if (chosen < snapshot->contact_count) {
        count = mark_contact(&snapshot->contacts[chosen], render->is_thick, marks, count);
        marks[count - 1].is_chosen = true;
    }
    return count;
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

int render_draw(const struct render *render, const struct snapshot *snapshot, FILE *file,
                struct film *film, const float (*bounds)[3], struct ctl_error *error)
{
    struct picture_mark *marks =
        calloc(2 * snapshot->contact_count + snapshot->line_count + 1, sizeof *marks);
    double greatest = snapshot_greatest(snapshot);
    struct picture_scale scale = {.title = "time of impact", .low = "0", .high = "1"};
    char title[128];
    if (marks == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", render->path);
    }
    uint32_t mark_count = snapshot->lines != NULL
                              ? (uint32_t)snapshot->line_count
                              : mark_contacts(render, snapshot, marks);
    if (snapshot->lines != NULL) {
        mark_lines(snapshot, greatest, marks);
        snprintf(scale.title, sizeof scale.title, "distance");
        snprintf(scale.high, sizeof scale.high, "%.4g", greatest);
    }
    name_step(render, snapshot, title, sizeof title);
    struct picture_place place = place_of(render, snapshot);
    struct picture picture = {.snapshot = snapshot,
                              .marks = marks,
                              .mark_count = mark_count,
                              .up = render->up,
                              .width = render->width,
                              .height = render->height,
                              .zoom = (float)render->zoom,
                              .is_at_marks = render->is_at_contacts,
                              .bounds = bounds,
                              .is_thick = render->is_thick,
                              .place = render->contact > 0 ? &place : NULL,
                              .title = title,
                              .scale = snapshot->lines == NULL || greatest > 0 ? &scale
                                                                               : NULL};
    find_eye(render, picture.from);
    if (render->contact > 0 && isnan(render->azimuth)) {
        choose_viewpoint(snapshot, picture.from);
    }
    int status = film != NULL ? add_picture(&picture, film, error)
                              : picture_write(&picture, file, render->path, error);
    free(marks);
    return status;
}
