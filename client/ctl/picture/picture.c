/* picture.c - meshes and contacts, drawn. */
#include "picture.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pccd_types.h"

#define HALF_VIEW   0.34f /* tangent of half the vertical angle of view */
#define MARGIN      1.12f /* room around the scene */
#define ZOOM_LEAST  0.01f /* of the view, that marks take at least */
#define PLACE_LEAST 1e-5f /* of the view, that a place takes at least */
#define LINE_WIDTH  0.35f /* picture pixels */
#define ROD_LEAST   1.1f  /* radius of a rod, picture pixels */
#define POINT_LEAST 2.0f  /* of a point */
#define SMALL       640u  /* a picture is, if it has fewer pixels from side to side */
/* Pixels that balls and capsules take together, a minute: as many as if each of 10^5
 * triangles took the fourth part of a hundredth of the picture. */
#define PIXELS_MAX 10000000000u

static const float sky_top[3] = {0.97f, 0.98f, 0.99f};
static const float sky_bottom[3] = {0.78f, 0.82f, 0.87f};
const float picture_ink[3] = {0.13f, 0.16f, 0.21f};

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

/* Of the feature that has these vertices, as it is drawn. */
static float radius_of(const struct picture *picture, const struct picture_mesh *mesh,
                       const uint32_t *vertices, uint32_t count)
{
    float most = 0;
    for (uint32_t i = 0; i < count && mesh->radii != NULL; i++) {
        most = fmaxf(most, mesh->radii[vertices[i]]);
    }
    return picture->is_thick ? most + picture->gap : most;
}

/* Room that is needed around a vertex. */
static float room_of(const struct picture *picture, const struct picture_mesh *mesh,
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
        for (uint32_t m = 0; m < picture->mesh_count && !at_marks && !has_bounds; m++) {
            const struct picture_mesh *mesh = &picture->meshes[m];
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
    static const float ups[3][3] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    float *right = canvas->axes[0], *above = canvas->axes[1], *away = canvas->axes[2];
    for (uint32_t k = 0; k < 3; k++) {
        away[k] = -picture->from[k];
    }
    normalize(away);
    cross(away, ups[picture->up], right);
    if (dot(right, right) < 1e-8f) { /* straight from above: some way is right */
        cross(away, ups[(picture->up + 1) % 3], right);
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

/* How much of the view the marks take: 1 when they just fill it. */
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
    for (uint32_t m = 0; m < picture->mesh_count && picture->bounds == NULL; m++) {
        const struct picture_mesh *mesh = &picture->meshes[m];
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
        canvas->focus /= fminf(fmaxf(share_of_marks(picture, canvas), ZOOM_LEAST), 1.0f);
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
static struct raster_surface surface_of(const struct picture_canvas *canvas,
                                        const struct picture_mesh *mesh)
{
    struct raster_surface surface = {.line_width = LINE_WIDTH * PICTURE_OVERSAMPLING};
    memcpy(surface.front, mesh->front, sizeof surface.front);
    memcpy(surface.back, mesh->back, sizeof surface.back);
    for (uint32_t k = 0; k < 3; k++) {
        surface.eye[k] = -canvas->axes[2][k];
        surface.light[k] =
            surface.eye[k] + 0.9f * canvas->axes[1][k] - 0.8f * canvas->axes[0][k];
    }
    normalize(surface.light);
    return surface;
}

/* Edges of rods, then points. */
static uint64_t free_count(const struct picture_mesh *mesh)
{
    return (uint64_t)mesh->edge_count + mesh->point_count;
}

/* The ends of the i-th of these, and its radius: never so thin that nobody sees it. */
static double find_free(const struct picture *picture,
                        const struct picture_canvas *canvas,
                        const struct picture_mesh *mesh, uint64_t i, const float *ends[2])
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
                      const struct picture_mesh *mesh)
{
    const struct raster_surface surface = surface_of(canvas, mesh);
    for (uint64_t i = 0; i < free_count(mesh); i++) {
        const float *ends[2];
        double radius = find_free(picture, canvas, mesh, i, ends);
        thick_segment(canvas, ends[0], ends[1], radius, &surface);
    }
}

/* Those of all balls and capsules. */
static uint64_t count_pixels(const struct picture *picture,
                             const struct picture_canvas *canvas)
{
    uint64_t pixels = 0;
    for (uint32_t m = 0; m < picture->mesh_count; m++) {
        const struct picture_mesh *mesh = &picture->meshes[m];
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
                           const struct picture_mesh *mesh)
{
    struct raster_corner *corners = calloc(mesh->vertex_count + 1, sizeof *corners);
    float(*normals)[3] = malloc((3 * (size_t)mesh->triangle_count + 1) * sizeof *normals);
    const struct raster_surface surface = surface_of(canvas, mesh);
    int octave;
    (void)frexpf(fmaxf(canvas->distance, FLT_MIN), &octave);
    if (corners == NULL || normals == NULL || !crease_normals(mesh, octave, normals)) {
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
                (const float(*)[3])normals + 3 * (size_t)t, (double)radius, &surface);
            continue;
        }
        struct raster_corner three[3] = {corners[v[0]], corners[v[1]], corners[v[2]]};
        for (uint32_t k = 0; k < 3; k++) {
            memcpy(three[k].normal, normals[3 * t + k], sizeof three[k].normal);
        }
        raster_triangle(&canvas->raster, three, &surface);
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
    for (uint32_t m = 0; m < picture->mesh_count; m++) {
        if (!draw_triangles(picture, canvas, &picture->meshes[m])) {
            return PCCD_E_NOMEM;
        }
        draw_free(picture, canvas, &picture->meshes[m]);
    }
    return PCCD_OK;
}

void picture_place_mark(const struct picture *picture,
                        const struct picture_canvas *canvas,
                        const struct picture_mark *mark, struct raster_corner *corner)
{
    picture_project(canvas, mark->at, corner);
    if (picture->is_thick && mark->is_chosen) {
        corner->nearness = INFINITY; /* between two that touch it would be hidden */
    }
}

float picture_mark_radius(const struct picture_mark *mark)
{
    return mark->is_chosen ? 3 * PICTURE_DOT_RADIUS : PICTURE_DOT_RADIUS;
}

/* Its ends are larger, or it would not be seen where it is short. */
static void draw_line(const struct picture *picture, struct picture_canvas *canvas,
                      const struct picture_mark *mark)
{
    const float *colour = picture->groups[mark->group].colour;
    struct raster_corner ends[2] = {{.x = 0}, {.x = 0}};
    picture_project(canvas, mark->at, &ends[0]);
    picture_project(canvas, mark->to, &ends[1]);
    raster_line(&canvas->raster, ends, PICTURE_LINE_RADIUS * PICTURE_OVERSAMPLING, colour,
                PICTURE_DOT_HIDDEN);
    for (uint32_t i = 0; i < 2; i++) {
        raster_dot(&canvas->raster, &ends[i], PICTURE_DOT_RADIUS * PICTURE_OVERSAMPLING,
                   colour, PICTURE_DOT_HIDDEN);
    }
}

void picture_draw_marks(const struct picture *picture, struct picture_canvas *canvas)
{
    for (uint32_t i = 0; i < picture->mark_count; i++) {
        const struct picture_mark *mark = &picture->marks[i];
        struct raster_corner corner = {0};
        if (mark->is_line) {
            draw_line(picture, canvas, mark);
            continue;
        }
        picture_place_mark(picture, canvas, mark, &corner);
        raster_dot(&canvas->raster, &corner,
                   picture_mark_radius(mark) * PICTURE_OVERSAMPLING,
                   picture->groups[mark->group].colour, PICTURE_DOT_HIDDEN);
    }
}

/* A bar of the groups' colours below `y`, with what its ends mean. A letter is 10 units
 * wide. */
static void draw_scale(const struct picture *picture, struct raster *raster, uint32_t y,
                       uint32_t unit)
{
    const uint32_t left = 28 * unit, wide = 200 * unit, high = 12 * unit;
    raster_text(raster, left, y, 2 * unit, picture_ink, picture->scale->title);
    y += 22 * unit;
    for (uint32_t i = 0; i < wide; i++) {
        uint32_t group = i * picture->group_count / wide;
        raster_box(raster, left + i, y, 1, high, picture->groups[group].colour);
    }
    y += high + 6 * unit;
    raster_text(raster, left, y, 2 * unit, picture_ink, picture->scale->low);
    uint32_t text_wide = (uint32_t)strlen(picture->scale->high) * 12 * unit;
    raster_text(raster, left + wide - (text_wide < wide ? text_wide : wide), y, 2 * unit,
                picture_ink, picture->scale->high);
}

void picture_draw_legend(const struct picture *picture, struct picture_canvas *canvas)
{
    /* In a small picture the words would hide what it is of. */
    const uint32_t unit =
        canvas->width < SMALL ? PICTURE_OVERSAMPLING / 2 : PICTURE_OVERSAMPLING;
    const uint32_t scale = 2 * unit, left = 28 * unit;
    uint32_t y = 26 * unit;
    raster_text(&canvas->raster, left, y, scale, picture_ink, picture->title);
    for (uint32_t i = 0; i < picture->group_count; i++) {
        if (picture->groups[i].label[0] == '\0') {
            continue;
        }
        y += 26 * unit;
        /* Nearer than anything, so that the sample is never hidden. */
        struct raster_corner sample = {.x = (float)(left + 3 * scale),
                                       .y = (float)y + 3.5f * (float)scale,
                                       .nearness = INFINITY};
        raster_dot(&canvas->raster, &sample, 6.0f * (float)unit,
                   picture->groups[i].colour, 1.0f);
        raster_text(&canvas->raster, left + 9 * scale, y, scale, picture_ink,
                    picture->groups[i].label);
    }
    if (picture->scale != NULL && picture->group_count > 0) {
        draw_scale(picture, &canvas->raster, y + 30 * unit, unit);
    }
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
