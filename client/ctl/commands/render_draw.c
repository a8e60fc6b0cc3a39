/* render_draw.c - a step of a recording becomes a picture. */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "picture.h"
#include "place.h"
#include "printable.h"
#include "render.h"
#include "shown.h"

#define DEGREE      0.017453292519943295
#define AZIMUTH     25.0
#define ELEVATION   16.0
#define SHOWN       15u  /* triangles and rods of each side around a contact */
#define COARSER     3.0f /* times as much as the finer side needs may be shown */
#define PLACE_ROOM  1.2f /* around them */
#define PLACE_LEAST 0.01 /* of the scene, where features have no size */
#define SAMPLES     3u   /* triangles of each side that are looked for */
#define UNSEEN      1.0  /* what it costs when none of a side's is seen */
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

/* Triangles beside a contact, a point of each. */
struct samples {
    double at[2][SAMPLES][3]; /* of the first and the second feature */
    uint32_t count[2];
};

/* Return the object of the first or the second feature of a contact, which is there. */
static const struct snapshot_object *object_of(const struct snapshot *snapshot,
                                               const struct snapshot_contact *contact,
                                               uint32_t side)
{
    uint32_t handle = side == 0 ? contact->object_a : contact->object_b;
    uint32_t i = 0;
    while (i + 1 < snapshot->object_count && snapshot->objects[i].handle != handle) {
        i++;
    }
    return &snapshot->objects[i];
}

static bool has_corner(const uint32_t v[3], uint32_t corner)
{
    return v[0] == corner || v[1] == corner || v[2] == corner;
}

/* Find triangles that have the features of a contact, and in each a point near it. */
static void find_samples(const struct snapshot *snapshot,
                         const struct snapshot_contact *contact, struct samples *samples)
{
    for (uint32_t side = 0; side < 2; side++) {
        const struct snapshot_object *object = object_of(snapshot, contact, side);
        const uint32_t points = common_kinds[contact->kind].points[side];
        uint32_t *count = &samples->count[side];
        *count = 0;
        for (uint32_t i = 0; i < object->triangle_count && *count < SAMPLES; i++) {
            const uint32_t *v = object->triangles[i];
            bool has = true;
            for (uint32_t k = 0; k < points; k++) {
                has = has && has_corner(v, contact->corners[side][k]);
            }
            for (uint32_t k = 0; has && k < 3; k++) {
                double middle = ((double)object->x[v[0]][k] + (double)object->x[v[1]][k] +
                                 (double)object->x[v[2]][k]) /
                                3;
                samples->at[side][*count][k] = ((double)contact->at[k] + middle) / 2;
            }
            *count += has;
        }
    }
}

/* Return what it costs that triangles beside a contact are not seen. */
static double cost_of_hidden(const struct snapshot *snapshot,
                             const struct samples *samples, const double way[3],
                             double near)
{
    double cost = 0;
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t hidden = 0;
        for (uint32_t i = 0; i < samples->count[side]; i++) {
            hidden += !is_free(snapshot, samples->at[side][i], way, near);
        }
        cost += hidden > 0 ? UNSEEN * hidden / samples->count[side] : 0;
    }
    return cost;
}

/* `from`, unit, is the wanted direction from contact snapshot->chosen to the eye, and
 * becomes the one of those with a free view that costs least: by how far it is turned
 * away, and by what of both sides is hidden. It stays where none of them has a free
 * view. */
static void choose_viewpoint(const struct snapshot *snapshot, float from[3])
{
    const struct snapshot_contact *contact = &snapshot->contacts[snapshot->chosen];
    const double wanted[3] = {from[0], from[1], from[2]};
    const double near = NEAR * (double)contact->radius;
    double at[3], normal[3], side[3], other[3], least = INFINITY;
    struct samples samples;
    find_samples(snapshot, contact, &samples);
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
        if (cost < least && is_free(snapshot, at, way, near)) {
            cost += cost_of_hidden(snapshot, &samples, way, near);
        } else {
            cost = INFINITY;
        }
        if (cost < least) {
            least = cost;
            for (int k = 0; k < 3; k++) {
                from[k] = (float)way[k];
            }
        }
    }
}

/* The direction to the eye: azimuth 0 looks along the axis after `axis`, which is up. */
static void find_eye(const struct render *render, uint32_t axis, float from[3])
{
    bool is_given = !isnan(render->azimuth);
    double a = (is_given ? render->azimuth : AZIMUTH) * DEGREE;
    double e = (is_given ? render->elevation : ELEVATION) * DEGREE;
    uint32_t up = axis > 0 ? axis - 1 : 1;
    from[up] = (float)sin(e);
    from[(up + 1) % 3] = (float)(cos(e) * cos(a));
    from[(up + 2) % 3] = (float)(cos(e) * sin(a));
}

/* Return whether the picture is of a few contacts, or of one, and close to them. */
static bool is_close(const struct render *render, const struct snapshot *snapshot)
{
    return render->contact > 0 ||
           ((render->at == RENDER_AT_FEW || render->at == RENDER_AT_CONTACTS) &&
            !render->is_film && snapshot->contact_count > 0 &&
            snapshot->contact_count <= RENDER_FEW);
}

static void name_step(const struct render *render, const struct snapshot *snapshot,
                      char *title, size_t room)
{
    char when[48] = "";
    if (is_close(render, snapshot)) {
        snprintf(when, sizeof when, " at t = %s", tool_shown_number(snapshot->t));
    }
    if (render->is_near) {
        snprintf(title, room, "question %" PRIu64 ", %" PRIu64 " %s", snapshot->step,
                 snapshot->line_count,
                 proto_plural(snapshot->line_count, "record", "records"));
    } else if (render->contact > 0) {
        snprintf(title, room, "step %" PRIu64 "%s, contact %" PRIu64 " of %" PRIu64,
                 snapshot->step, when, snapshot->chosen + 1, snapshot->contact_count);
    } else {
        snprintf(title, room, "step %" PRIu64 "%s, %" PRIu64 " %s", snapshot->step, when,
                 snapshot->contact_count,
                 proto_plural(snapshot->contact_count, "contact", "contacts"));
    }
}

/* "vertex 3 of cloth meets face 12 of ball at (0.2, 0.2, 0)", of the chosen contact; the
 * place where the picture is of the moment at which it happens. */
static void name_pair(const struct snapshot *snapshot, char *text, size_t room)
{
    const struct snapshot_contact *contact = &snapshot->contacts[snapshot->chosen];
    const uint32_t features[2] = {contact->feature_a, contact->feature_b};
    size_t used = 0;
    for (uint32_t side = 0; side < 2 && used < room; side++) {
        const struct snapshot_object *object = object_of(snapshot, contact, side);
        const uint32_t points = common_kinds[contact->kind].points[side];
        const uint32_t *v = contact->corners[side];
        char other[16] = "", owner[64] = "";
        if (points == 2) {
            snprintf(other, sizeof other, "-%" PRIu32, v[1]);
        }
        if (snapshot->object_count > 1 && object->name != NULL) {
            snprintf(owner, sizeof owner, " of %s", tool_shown(object->name));
        } else if (snapshot->object_count > 1) { /* as the page of inspect calls it */
            snprintf(owner, sizeof owner, " of object %td", object - snapshot->objects);
        }
        used += (size_t)snprintf(text + used, room - used, "%s%s %" PRIu32 "%s%s",
                                 side == 0 ? "" : " meets ", common_feature_names[points],
                                 points == 2 ? v[0] : features[side], other, owner);
    }
    if (used < room && snapshot->t == fmin(fmax(contact->toi, 0), 1)) {
        double at[3];
        for (uint32_t k = 0; k < 3; k++) {
            at[k] = (double)contact->at[k] + snapshot->origin[k];
            at[k] = fabs(at[k]) > FLT_EPSILON * snapshot->extent ? at[k] : 0;
        }
        snprintf(text + used, room - used, " at (%s, %s, %s)", tool_shown_number(at[0]),
                 tool_shown_number(at[1]), tool_shown_number(at[2]));
    }
}

/* Return how far the farthest of the SHOWN triangles and rods of an object is that are
 * nearest to a point; of fewer, the farthest vertex. */
static float room_of_side(const struct snapshot_object *object, const float at[3])
{
    float nearest[SHOWN], farthest = 0;
    uint32_t count = 0;
    const uint64_t all = (uint64_t)object->triangle_count + object->edge_count;
    for (uint64_t i = 0; i < all; i++) {
        bool is_face = i < object->triangle_count;
        const uint32_t *v =
            is_face ? object->triangles[i] : object->edges[i - object->triangle_count];
        float middle[3] = {-at[0], -at[1], -at[2]};
        for (uint32_t k = 0; k < (is_face ? 9 : 6); k++) {
            middle[k % 3] += object->x[v[k / 3]][k % 3] / (is_face ? 3 : 2);
        }
        float away = hypotf(hypotf(middle[0], middle[1]), middle[2]);
        uint32_t place = count;
        while (place > 0 && nearest[place - 1] > away) {
            place--;
        }
        if (place < SHOWN) {
            count += count < SHOWN;
            memmove(nearest + place + 1, nearest + place,
                    (count - place - 1) * sizeof *nearest);
            nearest[place] = away;
        }
    }
    for (uint32_t i = 0; i < object->vertex_count && count < SHOWN; i++) {
        const float *x = object->x[i];
        farthest =
            fmaxf(farthest, hypotf(hypotf(x[0] - at[0], x[1] - at[1]), x[2] - at[2]));
    }
    return count < SHOWN ? farthest : nearest[SHOWN - 1];
}

/* Return how much is shown around a contact: some triangles of both sides, but where one
 * has much smaller ones no more than a few times what these need. */
static float room_of(const struct snapshot *snapshot,
                     const struct snapshot_contact *contact)
{
    float a = room_of_side(object_of(snapshot, contact, 0), contact->at);
    float b = room_of_side(object_of(snapshot, contact, 1), contact->at);
    float room = fminf(fmaxf(a, b), COARSER * fminf(a, b));
    room = fmaxf(room, (float)(PLACE_LEAST * snapshot->extent));
    return PLACE_ROOM * room;
}

/* The chosen contact, and what is around it. */
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
        place.radius = room_of(snapshot, contact);
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

/* Contacts by their times, the chosen one over the others; those of few are all drawn
 * larger, unless it was asked for one. Returns how many marks. */
static uint32_t mark_contacts(const struct render *render,
                              const struct snapshot *snapshot, struct picture_mark *marks)
{
    bool has_one = render->contact > 0 || render->marks_first;
    bool are_large = is_close(render, snapshot) && !has_one;
    uint32_t count = 0;
    for (uint64_t i = 0; i <= snapshot->contact_count; i++) { /* the chosen one at last */
        bool is_last = i == snapshot->contact_count;
        if (snapshot->contact_count > 0 && (is_last || i != snapshot->chosen)) {
            count = mark_contact(&snapshot->contacts[is_last ? snapshot->chosen : i],
                                 render->is_thick, marks, count);
            marks[count - 1].is_chosen = are_large || (is_last && has_one);
        }
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
    char title[128], pair[256] = "";
    const bool is_few = is_close(render, snapshot);
    if (marks == NULL) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", render->path);
    }
    uint32_t mark_count = snapshot->lines != NULL
                              ? (uint32_t)snapshot->line_count
                              : mark_contacts(render, snapshot, marks);
    if (snapshot->lines != NULL) {
        mark_lines(snapshot, greatest, marks);
        snprintf(scale.title, sizeof scale.title, "distance");
        snprintf(scale.high, sizeof scale.high, "%s", tool_shown_number(greatest));
    }
    name_step(render, snapshot, title, sizeof title);
    if (is_few) {
        name_pair(snapshot, pair, sizeof pair);
    }
    struct picture_place place = place_of(render, snapshot);
    struct picture picture = {.snapshot = snapshot,
                              .marks = marks,
                              .mark_count = mark_count,
                              .up = render->up,
                              .width = render->width,
                              .height = render->height,
                              .zoom = (float)render->zoom,
                              .is_at_marks = is_few || render->at == RENDER_AT_CONTACTS,
                              .bounds = bounds,
                              .is_thick = render->is_thick,
                              .place = render->contact > 0 ? &place : NULL,
                              .title = title,
                              .subtitle = is_few ? pair : NULL,
                              .scale = snapshot->lines == NULL || greatest > 0 ? &scale
                                                                               : NULL};
    find_eye(render, picture.up, picture.from);
    if (picture.is_at_marks && snapshot->contact_count > 0) {
        picture.room = room_of(snapshot, &snapshot->contacts[snapshot->chosen]);
    }
    if (is_few && isnan(render->azimuth)) {
        choose_viewpoint(snapshot, picture.from);
    }
    int status = film != NULL ? add_picture(&picture, film, error)
                              : picture_write(&picture, file, render->path, error);
    free(marks);
    return status;
}
