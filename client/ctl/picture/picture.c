/* picture.c - the objects of a step, as they are seen from somewhere.
 *
 * Source: union-find with path halving (Tarjan and van Leeuwen 1984).
 */
#include "picture.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "export.h"
#include "pccd_types.h"

#define HALF_VIEW   0.34f  /* tangent of half the vertical angle of view */
#define MARGIN      1.12f  /* room around the scene */
#define ZOOM_LEAST  0.01f  /* of the view, that marks take at least */
#define PLACE_LEAST 1e-5f  /* of the view, that a place takes at least */
#define FLAT_COSINE 0.643f /* 50 degrees between the normals of two triangles */
#define LINE_WIDTH  0.35f  /* picture pixels */
#define ROD_LEAST   1.1f   /* radius of a rod, picture pixels */
#define POINT_LEAST 2.0f   /* of a point */
/* Pixels that balls and capsules take together, a minute: as many as if each of 10^5
 * triangles took the fourth part of a hundredth of the picture. */
#define PIXELS_MAX 10000000000u

static const float sky_top[3] = {0.97f, 0.98f, 0.99f};
static const float sky_bottom[3] = {0.78f, 0.82f, 0.87f};

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const float a[3], const float b[3], float out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalize(float x[3])
{
    float length = sqrtf(dot(x, x)) + 1e-30f;
    for (uint32_t k = 0; k < 3; k++) {
        x[k] /= length;
    }
}

/* ---- normals ----------------------------------------------------------------------- */

/* An edge of a triangle, and the corners at its ends: those of its lower vertex first. */
struct side {
    uint32_t low, high; /* vertices */
    uint32_t corners[2];
};

static int by_vertices(const void *left, const void *right)
{
    const struct side *a = left, *b = right;
    if (a->low != b->low) {
        return a->low < b->low ? -1 : 1;
    }
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return a->corners[0] < b->corners[0] ? -1 : a->corners[0] > b->corners[0];
}

static uint32_t root_of(uint32_t *above, uint32_t corner)
{
    while (above[corner] != corner) {
        above[corner] = above[above[corner]];
        corner = above[corner];
    }
    return corner;
}

static void join(uint32_t *above, uint32_t a, uint32_t b)
{
    uint32_t root_a = root_of(above, a), root_b = root_of(above, b);
    above[root_a > root_b ? root_a : root_b] = root_a > root_b ? root_b : root_a;
}

/* Set the normal of a triangle, as long as twice its area, in units of 4^octave. */
static void area_normal(const struct snapshot_object *mesh, uint32_t t, int octave,
                        float normal[3])
{
    const uint32_t *v = mesh->triangles[t];
    float a[3], b[3];
    for (uint32_t k = 0; k < 3; k++) {
        a[k] = ldexpf(mesh->x[v[1]][k] - mesh->x[v[0]][k], -octave);
        b[k] = ldexpf(mesh->x[v[2]][k] - mesh->x[v[0]][k], -octave);
    }
    normal[0] = a[1] * b[2] - a[2] * b[1];
    normal[1] = a[2] * b[0] - a[0] * b[2];
    normal[2] = a[0] * b[1] - a[1] * b[0];
}

/* Join the corners of triangles that share an edge and are nearly flat there. */
static void join_flat(struct side *sides, uint32_t count, const float (*faces)[3],
                      uint32_t *above)
{
    qsort(sides, count, sizeof *sides, by_vertices);
    for (uint32_t i = 1; i < count; i++) {
        const struct side *a = &sides[i - 1], *b = &sides[i];
        const float *face_a = faces[a->corners[0] / 3],
                    *face_b = faces[b->corners[0] / 3];
        float lengths = sqrtf(dot(face_a, face_a)) * sqrtf(dot(face_b, face_b));
        /* A triangle without area has no direction of its own, and parts nothing. */
        if (a->low == b->low && a->high == b->high &&
            dot(face_a, face_b) >= FLAT_COSINE * lengths) {
            join(above, a->corners[0], b->corners[0]);
            join(above, a->corners[1], b->corners[1]);
        }
    }
}

bool picture_normals(const struct snapshot_object *mesh, int octave, float (*normals)[3])
{
    const uint32_t count = 3 * mesh->triangle_count;
    struct side *sides = malloc((count + 1) * sizeof *sides);
    float(*faces)[3] = malloc((mesh->triangle_count + 1) * sizeof *faces);
    uint32_t *above = malloc((count + 1) * sizeof *above);
    bool has_memory = sides != NULL && faces != NULL && above != NULL;
    for (uint32_t i = 0; has_memory && i < count; i++) {
        const uint32_t *v = mesh->triangles[i / 3];
        uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
        bool is_up = v[i % 3] < v[next % 3];
        sides[i] = (struct side){.low = is_up ? v[i % 3] : v[next % 3],
                                 .high = is_up ? v[next % 3] : v[i % 3],
                                 .corners = {is_up ? i : next, is_up ? next : i}};
        above[i] = i;
        if (i % 3 == 0) {
            area_normal(mesh, i / 3, octave, faces[i / 3]);
        }
    }
    if (has_memory) {
        join_flat(sides, count, (const float(*)[3])faces, above);
        memset(normals, 0, count * sizeof *normals);
    }
    for (uint32_t i = 0; has_memory && i < count; i++) {
        uint32_t root = root_of(above, i);
        for (uint32_t k = 0; k < 3; k++) {
            normals[root][k] += faces[i / 3][k];
        }
    }
    for (uint32_t i = 0; has_memory && i < count; i++) {
        uint32_t root = root_of(above, i); /* not after i: it has its length already */
        if (root == i) {
            normalize(normals[i]);
        } else {
            memcpy(normals[i], normals[root], sizeof normals[i]);
        }
    }
    free(sides);
    free(faces);
    free(above);
    return has_memory;
}

/* ---- camera ------------------------------------------------------------------------ */

/* Return the radius with which the feature that has these vertices is drawn. */
static float radius_of(const struct picture *picture, const struct snapshot_object *mesh,
                       const uint32_t *vertices, uint32_t count)
{
    float most = 0;
    for (uint32_t i = 0; i < count && mesh->radii != NULL; i++) {
        most = fmaxf(most, mesh->radii[vertices[i]]);
    }
    return picture->is_thick ? most + (float)(picture->snapshot->separation / 2) : most;
}

/* Room that is needed around a vertex. */
static float room_of(const struct picture *picture, const struct snapshot_object *mesh,
                     uint32_t vertex)
{
    bool has_round = picture->is_thick || mesh->edge_count > 0 || mesh->point_count > 0;
    return has_round ? radius_of(picture, mesh, &vertex, 1) : 0;
}

/* The middle of the box around all vertices, or around all marks; or the place that is to
 * be seen. */
static void find_centre(const struct picture *picture, float centre[3])
{
    if (picture->place != NULL) {
        memcpy(centre, picture->place->at, sizeof picture->place->at);
        return;
    }
    bool at_marks = picture->is_at_marks && picture->mark_count > 0;
    bool has_bounds = !at_marks && picture->bounds != NULL;
    for (uint32_t k = 0; k < 3; k++) {
        float low = has_bounds ? picture->bounds[0][k] : INFINITY;
        float high = has_bounds ? picture->bounds[1][k] : -INFINITY;
        for (uint32_t m = 0;
             m < picture->snapshot->object_count && !at_marks && !has_bounds; m++) {
            const struct snapshot_object *mesh = &picture->snapshot->objects[m];
            for (uint32_t i = 0; i < mesh->vertex_count; i++) {
                float room = room_of(picture, mesh, i);
                low = fminf(low, mesh->x[i][k] - room);
                high = fmaxf(high, mesh->x[i][k] + room);
            }
        }
        for (uint32_t i = 0; i < picture->mark_count && at_marks; i++) {
            low = fminf(low, picture->marks[i].at[k]);
            high = fmaxf(high, picture->marks[i].at[k]);
        }
        centre[k] = low + (high - low) / 2.0f;
    }
}

/* The eye's axes: it looks against `from`, and what is up stays up. */
static void turn_camera(const struct picture *picture, struct picture_canvas *canvas)
{
    const uint32_t axis = picture->up > 0 ? picture->up - 1 : 1;
    float up[3] = {0, 0, 0}, other[3] = {0, 0, 0};
    float *right = canvas->axes[0], *above = canvas->axes[1], *away = canvas->axes[2];
    up[axis] = other[(axis + 1) % 3] = 1;
    for (uint32_t k = 0; k < 3; k++) {
        away[k] = -picture->from[k];
    }
    normalize(away);
    cross(away, up, right);
    if (dot(right, right) < 1e-8f) { /* straight from above: some way is right */
        cross(away, other, right);
    }
    normalize(right);
    cross(right, away, above);
}

static void offset_of(const struct picture_canvas *canvas, const float x[3], float d[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        d[k] = x[k] - canvas->centre[k];
    }
}

/* Tangents of the half angles of view, less a margin. */
static void view_of(const struct picture_canvas *canvas, float *wide, float *high)
{
    *high = HALF_VIEW / MARGIN;
    *wide = *high * (float)canvas->width / (float)canvas->height;
}

/* Return how much of the view the marks take: 1 when they just fill it. */
static float share_of_marks(const struct picture *picture,
                            const struct picture_canvas *canvas)
{
    float wide, high, share = 0;
    view_of(canvas, &wide, &high);
    for (uint32_t i = 0; i < picture->mark_count; i++) {
        float d[3];
        offset_of(canvas, picture->marks[i].at, d);
        float depth = dot(d, canvas->axes[2]) + canvas->distance;
        share = fmaxf(share, fabsf(dot(d, canvas->axes[0])) / (depth * wide));
        share = fmaxf(share, fabsf(dot(d, canvas->axes[1])) / (depth * high));
    }
    return share;
}

/* So far away that a point, and the room around it, is seen. */
static void step_back(struct picture_canvas *canvas, const float x[3], float room)
{
    float d[3], wide, high;
    view_of(canvas, &wide, &high);
    offset_of(canvas, x, d);
    float aside = fabsf(dot(d, canvas->axes[0])) + room * hypotf(1, wide);
    float above = fabsf(dot(d, canvas->axes[1])) + room * hypotf(1, high);
    float needed = fmaxf(aside / wide, above / high) - dot(d, canvas->axes[2]);
    canvas->distance = fmaxf(canvas->distance, needed);
}

/* Look at the centre from `from`, just far enough away to see every vertex; what is to be
 * seen larger is seen at a smaller angle, so that nothing comes behind the eye. */
static void place_camera(const struct picture *picture, struct picture_canvas *canvas)
{
    float wide, high;
    find_centre(picture, canvas->centre);
    turn_camera(picture, canvas);
    view_of(canvas, &wide, &high);
    canvas->distance = 0.0f;
    for (uint32_t i = 0; i < 8 && picture->bounds != NULL; i++) {
        float corner[3];
        for (uint32_t k = 0; k < 3; k++) {
            corner[k] = picture->bounds[i >> k & 1][k];
        }
        step_back(canvas, corner, 0);
    }
    for (uint32_t m = 0; m < picture->snapshot->object_count && picture->bounds == NULL;
         m++) {
        const struct snapshot_object *mesh = &picture->snapshot->objects[m];
        for (uint32_t i = 0; i < mesh->vertex_count; i++) {
            step_back(canvas, mesh->x[i], room_of(picture, mesh, i));
        }
    }
    canvas->focus = 0.5f * (float)canvas->height * PICTURE_OVERSAMPLING / HALF_VIEW *
                    (picture->zoom > 0 ? picture->zoom : 1.0f);
    if (picture->place != NULL) {
        float share = picture->place->radius / (canvas->distance * high);
        canvas->focus /= fminf(fmaxf(share, PLACE_LEAST), 1.0f);
    } else if (picture->is_at_marks && picture->mark_count > 0) {
        float least = fmaxf(picture->room / (canvas->distance * high), ZOOM_LEAST);
        canvas->focus /= fminf(fmaxf(share_of_marks(picture, canvas), least), 1.0f);
    }
}

void picture_project(const struct picture_canvas *canvas, const float x[3],
                     struct raster_corner *corner)
{
    float d[3];
    offset_of(canvas, x, d);
    float depth = dot(d, canvas->axes[2]) + canvas->distance;
    corner->nearness = 1.0f / fmaxf(depth, fmaxf(1e-6f * canvas->distance, FLT_MIN));
    float scale = canvas->focus * corner->nearness;
    corner->x = 0.5f * (float)canvas->raster.width + scale * dot(d, canvas->axes[0]);
    corner->y = 0.5f * (float)canvas->raster.height - scale * dot(d, canvas->axes[1]);
}

/* The light stands to the upper left behind the eye. */
static struct raster_surface surface_of(const struct picture *picture,
                                        const struct picture_canvas *canvas,
                                        uint32_t place)
{
    struct raster_surface surface = {.line_width = LINE_WIDTH * PICTURE_OVERSAMPLING};
    colour_of_object(place, surface.front, surface.back);
    for (uint32_t k = 0; k < 3 && picture->colours != NULL; k++) {
        surface.front[k] = surface.back[k] = picture->colours[place][k];
    }
    for (uint32_t k = 0; k < 3; k++) {
        surface.eye[k] = -canvas->axes[2][k];
        surface.light[k] =
            surface.eye[k] + 0.9f * canvas->axes[1][k] - 0.8f * canvas->axes[0][k];
    }
    normalize(surface.light);
    return surface;
}

/* Edges of rods, then points. */
static uint64_t free_count(const struct snapshot_object *mesh)
{
    return (uint64_t)mesh->edge_count + mesh->point_count;
}

/* The ends of the i-th of these, and its radius: never so thin that nobody sees it. */
static double find_free(const struct picture *picture,
                        const struct picture_canvas *canvas,
                        const struct snapshot_object *mesh, uint64_t i,
                        const float *ends[2])
{
    bool is_edge = i < mesh->edge_count;
    const uint32_t *v = is_edge ? mesh->edges[i] : &mesh->points[i - mesh->edge_count];
    struct raster_corner corners[2];
    for (uint32_t side = 0; side < 2; side++) {
        ends[side] = mesh->x[v[is_edge ? side : 0]];
        picture_project(canvas, ends[side], &corners[side]);
    }
    float least = (is_edge ? ROD_LEAST : POINT_LEAST) * PICTURE_OVERSAMPLING /
                  canvas->focus / fmaxf(corners[0].nearness, corners[1].nearness);
    return (double)fmaxf(radius_of(picture, mesh, v, is_edge ? 2 : 1), least);
}

static void draw_free(const struct picture *picture, struct picture_canvas *canvas,
                      const struct snapshot_object *mesh,
                      const struct raster_surface *surface)
{
    for (uint64_t i = 0; i < free_count(mesh); i++) {
        const float *ends[2];
        double radius = find_free(picture, canvas, mesh, i, ends);
        thick_segment(canvas, ends[0], ends[1], radius, surface);
    }
}

/* Those of all balls and capsules. */
static uint64_t count_pixels(const struct picture *picture,
                             const struct picture_canvas *canvas)
{
    uint64_t pixels = 0;
    for (uint32_t m = 0; m < picture->snapshot->object_count; m++) {
        const struct snapshot_object *mesh = &picture->snapshot->objects[m];
        for (uint64_t i = 0; i < free_count(mesh); i++) {
            const float *ends[2];
            double radius = find_free(picture, canvas, mesh, i, ends);
            pixels += thick_pixels(canvas, ends[0], ends[1], radius);
        }
        for (uint64_t i = 0; picture->is_thick && i < 3 * (uint64_t)mesh->triangle_count;
             i++) {
            const uint32_t *v = mesh->triangles[i / 3];
            double radius = (double)radius_of(picture, mesh, v, 3);
            pixels += radius > 0 ? thick_pixels(canvas, mesh->x[v[i % 3]],
                                                mesh->x[v[(i + 1) % 3]], radius)
                                 : 0;
        }
    }
    return pixels;
}

static bool draw_triangles(const struct picture *picture, struct picture_canvas *canvas,
                           const struct snapshot_object *mesh,
                           const struct raster_surface *surface)
{
    struct raster_corner *corners = calloc(mesh->vertex_count + 1, sizeof *corners);
    float(*normals)[3] = malloc((3 * (size_t)mesh->triangle_count + 1) * sizeof *normals);
    int octave;
    (void)frexpf(fmaxf(canvas->distance, FLT_MIN), &octave);
    if (corners == NULL || normals == NULL || !picture_normals(mesh, octave, normals)) {
        free(corners);
        free(normals);
        return false;
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        picture_project(canvas, mesh->x[i], &corners[i]);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles[t];
        float radius = picture->is_thick ? radius_of(picture, mesh, v, 3) : 0;
        if (radius > 0) {
            thick_triangle(
                canvas, (const float *[]){mesh->x[v[0]], mesh->x[v[1]], mesh->x[v[2]]},
                (const float(*)[3])normals + 3 * (size_t)t, (double)radius, surface);
            continue;
        }
        struct raster_corner three[3] = {corners[v[0]], corners[v[1]], corners[v[2]]};
        for (uint32_t k = 0; k < 3; k++) {
            memcpy(three[k].normal, normals[3 * t + k], sizeof three[k].normal);
        }
        raster_triangle(&canvas->raster, three, surface);
    }
    free(corners);
    free(normals);
    return true;
}

int picture_draw(const struct picture *picture, struct picture_canvas *canvas)
{
    canvas->width = picture->width > 0 ? picture->width : PICTURE_WIDTH;
    canvas->height = picture->height > 0 ? picture->height : PICTURE_HEIGHT;
    if (!raster_init(&canvas->raster, canvas->width * PICTURE_OVERSAMPLING,
                     canvas->height * PICTURE_OVERSAMPLING)) {
        return PCCD_E_NOMEM;
    }
    raster_clear(&canvas->raster, sky_top, sky_bottom);
    place_camera(picture, canvas);
    if (count_pixels(picture, canvas) > PIXELS_MAX) {
        return PCCD_E_LIMIT;
    }
    for (uint32_t m = 0; m < picture->snapshot->object_count; m++) {
        const struct snapshot_object *mesh = &picture->snapshot->objects[m];
        const struct raster_surface surface = surface_of(picture, canvas, m);
        if (m == picture->behind_count && m > 0) {
            raster_forget(&canvas->raster);
        }
        if (!draw_triangles(picture, canvas, mesh, &surface)) {
            return PCCD_E_NOMEM;
        }
        draw_free(picture, canvas, mesh, &surface);
    }
    return PCCD_OK;
}

void picture_halve(struct picture_canvas *canvas)
{
    const uint32_t over = PICTURE_OVERSAMPLING;
    const uint32_t stride = canvas->width * over * 3;
    uint8_t *rgb = canvas->raster.rgb;
    for (uint32_t y = 0; y < canvas->height; y++) {
        for (uint32_t x = 0; x < canvas->width * 3; x++) {
            const uint8_t *corner =
                rgb + (size_t)y * over * stride + (size_t)(x / 3) * over * 3 + x % 3;
            uint32_t sum = over * over / 2;
            for (uint32_t i = 0; i < over * over; i++) {
                sum += corner[i / over * stride + i % over * 3];
            }
            rgb[(size_t)y * canvas->width * 3 + x] = (uint8_t)(sum / (over * over));
        }
    }
}
