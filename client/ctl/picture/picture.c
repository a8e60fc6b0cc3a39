/* client/ctl/picture/picture.c - meshes and contacts as a PNG.
 *
 * Room:     client/ctl.
 * Does:     camera, smooth normals, marks, legend; halves a canvas of twice the size, so
 *           that edges are smooth.
 * Does not: fill pixels; see raster.c.
 * Threads:  one at a time; nothing is shared.
 * Source:   picture.h.
 */
#include "picture.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pccd_types.h"
#include "raster.h"

#define OVERSAMPLING 2
#define HALF_VIEW    0.34f /* tangent of half the vertical angle of view */
#define MARGIN       1.12f /* room around the scene */
#define DOT_RADIUS   2.1f  /* picture pixels */
#define DOT_HIDDEN   0.30f /* opacity of marks behind a surface */
#define LINE_WIDTH   0.35f /* picture pixels */

static const float sky_top[3] = {0.97f, 0.98f, 0.99f};
static const float sky_bottom[3] = {0.78f, 0.82f, 0.87f};
static const float ink[3] = {0.13f, 0.16f, 0.21f};

struct camera {
    float centre[3];
    float axes[3][3]; /* right, up, away from the eye; unit */
    float distance;   /* from the eye to the centre */
    float focus;      /* canvas pixels per unit at distance 1 */
};

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

/* The middle of the bounding box. */
static void find_centre(const struct picture *picture, float centre[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t m = 0; m < picture->mesh_count; m++) {
            for (uint32_t i = 0; i < picture->meshes[m].vertex_count; i++) {
                low = fminf(low, picture->meshes[m].x[i][k]);
                high = fmaxf(high, picture->meshes[m].x[i][k]);
            }
        }
        centre[k] = low + (high - low) / 2.0f;
    }
}

/* Look at the centre from `from`, just far enough away to see every vertex. */
static void place_camera(const struct picture *picture, struct camera *camera)
{
    static const float up[3] = {0, 1, 0};
    float *right = camera->axes[0], *above = camera->axes[1], *away = camera->axes[2];
    find_centre(picture, camera->centre);
    for (uint32_t k = 0; k < 3; k++) {
        away[k] = -picture->from[k];
    }
    normalize(away);
    cross(away, up, right);
    normalize(right);
    cross(right, away, above);
    float wide = HALF_VIEW * PICTURE_WIDTH / PICTURE_HEIGHT / MARGIN;
    float high = HALF_VIEW / MARGIN;
    camera->distance = 0.0f;
    for (uint32_t m = 0; m < picture->mesh_count; m++) {
        for (uint32_t i = 0; i < picture->meshes[m].vertex_count; i++) {
            float d[3];
            for (uint32_t k = 0; k < 3; k++) {
                d[k] = picture->meshes[m].x[i][k] - camera->centre[k];
            }
            float needed =
                fmaxf(fabsf(dot(d, right)) / wide, fabsf(dot(d, above)) / high) -
                dot(d, away);
            camera->distance = fmaxf(camera->distance, needed);
        }
    }
    camera->focus = 0.5f * PICTURE_HEIGHT * OVERSAMPLING / HALF_VIEW;
}

static void project(const struct camera *camera, const float x[3],
                    struct raster_corner *corner)
{
    float d[3];
    for (uint32_t k = 0; k < 3; k++) {
        d[k] = x[k] - camera->centre[k];
    }
    float depth = dot(d, camera->axes[2]) + camera->distance;
    corner->nearness = 1.0f / fmaxf(depth, 1e-6f);
    float scale = camera->focus * corner->nearness;
    corner->x = 0.5f * PICTURE_WIDTH * OVERSAMPLING + scale * dot(d, camera->axes[0]);
    corner->y = 0.5f * PICTURE_HEIGHT * OVERSAMPLING - scale * dot(d, camera->axes[1]);
}

/* Each vertex' normal is the sum of its triangles', weighted by their area. */
static void smooth_normals(const struct picture_mesh *mesh, struct raster_corner *corners)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles[t];
        float a[3], b[3], normal[3];
        for (uint32_t k = 0; k < 3; k++) {
            a[k] = mesh->x[v[1]][k] - mesh->x[v[0]][k];
            b[k] = mesh->x[v[2]][k] - mesh->x[v[0]][k];
        }
        cross(a, b, normal);
        for (uint32_t k = 0; k < 9; k++) {
            corners[v[k / 3]].normal[k % 3] += normal[k % 3];
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        normalize(corners[i].normal);
    }
}

static bool draw_mesh(struct raster *raster, const struct camera *camera,
                      const struct picture_mesh *mesh)
{
    struct raster_corner *corners = calloc(mesh->vertex_count, sizeof(*corners));
    struct raster_surface surface = {.line_width = LINE_WIDTH * OVERSAMPLING};
    if (corners == NULL) {
        return false;
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        project(camera, mesh->x[i], &corners[i]);
    }
    smooth_normals(mesh, corners);
    memcpy(surface.front, mesh->front, sizeof(surface.front));
    memcpy(surface.back, mesh->back, sizeof(surface.back));
    /* The light stands to the upper left behind the eye. */
    for (uint32_t k = 0; k < 3; k++) {
        surface.eye[k] = -camera->axes[2][k];
        surface.light[k] =
            surface.eye[k] + 0.9f * camera->axes[1][k] - 0.8f * camera->axes[0][k];
    }
    normalize(surface.light);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangles[t];
        const struct raster_corner three[3] = {corners[v[0]], corners[v[1]],
                                               corners[v[2]]};
        raster_triangle(raster, three, &surface);
    }
    free(corners);
    return true;
}

static void draw_marks(struct raster *raster, const struct camera *camera,
                       const struct picture *picture)
{
    for (uint32_t i = 0; i < picture->mark_count; i++) {
        const struct picture_mark *mark = &picture->marks[i];
        struct raster_corner corner = {0};
        project(camera, mark->at, &corner);
        raster_dot(raster, &corner, DOT_RADIUS * OVERSAMPLING,
                   picture->groups[mark->group].colour, DOT_HIDDEN);
    }
}

static void draw_legend(struct raster *raster, const struct picture *picture)
{
    const uint32_t scale = 2 * OVERSAMPLING;
    const uint32_t left = 28 * OVERSAMPLING;
    uint32_t y = 26 * OVERSAMPLING;
    raster_text(raster, left, y, scale, ink, picture->title);
    for (uint32_t i = 0; i < picture->group_count; i++) {
        y += 26 * OVERSAMPLING;
        /* Nearer than anything, so that the sample is never hidden. */
        struct raster_corner sample = {.x = (float)(left + 3 * scale),
                                       .y = (float)y + 3.5f * (float)scale,
                                       .nearness = INFINITY};
        raster_dot(raster, &sample, 6.0f * OVERSAMPLING, picture->groups[i].colour, 1.0f);
        raster_text(raster, left + 9 * scale, y, scale, ink, picture->groups[i].label);
    }
}

/* Average each square of OVERSAMPLING^2 samples, in place. */
static void halve(struct raster *raster)
{
    const uint32_t stride = PICTURE_WIDTH * OVERSAMPLING * 3;
    for (uint32_t y = 0; y < PICTURE_HEIGHT; y++) {
        for (uint32_t x = 0; x < PICTURE_WIDTH * 3; x++) {
            const uint8_t *corner = raster->rgb + (size_t)y * OVERSAMPLING * stride +
                                    (size_t)(x / 3) * OVERSAMPLING * 3 + x % 3;
            uint32_t sum = OVERSAMPLING * OVERSAMPLING / 2;
            for (uint32_t i = 0; i < OVERSAMPLING * OVERSAMPLING; i++) {
                sum += corner[i / OVERSAMPLING * stride + i % OVERSAMPLING * 3];
            }
            raster->rgb[(size_t)y * PICTURE_WIDTH * 3 + x] =
                (uint8_t)(sum / (OVERSAMPLING * OVERSAMPLING));
        }
    }
}

static int save(const struct raster *raster, FILE *file, const char *path,
                struct ctl_error *error)
{
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = PICTURE_WIDTH,
                       .height = PICTURE_HEIGHT,
                       .format = PNG_FORMAT_RGB};
    struct stat info;
    /* An older and longer file must not show behind the new one. */
    if (fstat(fileno(file), &info) == 0 && S_ISREG(info.st_mode) &&
        ftruncate(fileno(file), 0) != 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot empty: %s", path,
                             strerror(errno));
    }
    if (png_image_write_to_stdio(&image, file, 0, raster->rgb, 0, NULL) == 0) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                             image.message);
    }
    return PCCD_OK;
}

int picture_open(const char *path, FILE **file, struct ctl_error *error)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    FILE *opened = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (opened == NULL) {
        int status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                                   strerror(errno));
        if (fd >= 0) {
            close(fd);
        }
        return status;
    }
    *file = opened;
    return PCCD_OK;
}

void picture_discard(FILE *file, const char *path)
{
    struct stat info;
    bool is_empty =
        fstat(fileno(file), &info) == 0 && S_ISREG(info.st_mode) && info.st_size == 0;
    fclose(file);
    if (is_empty) {
        unlink(path);
    }
}

int picture_write(const struct picture *picture, FILE *file, const char *path,
                  struct ctl_error *error)
{
    struct raster raster = {0};
    struct camera camera;
    int status;
    bool has_memory =
        raster_init(&raster, PICTURE_WIDTH * OVERSAMPLING, PICTURE_HEIGHT * OVERSAMPLING);
    if (has_memory) {
        raster_clear(&raster, sky_top, sky_bottom);
        place_camera(picture, &camera);
    }
    for (uint32_t m = 0; m < picture->mesh_count && has_memory; m++) {
        has_memory = draw_mesh(&raster, &camera, &picture->meshes[m]);
    }
    if (has_memory) {
        draw_marks(&raster, &camera, picture);
        draw_legend(&raster, picture);
        halve(&raster);
        status = save(&raster, file, path, error);
    } else {
        status =
            ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory for the picture", path);
    }
    if (fclose(file) != 0 && status == PCCD_OK) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "%s: cannot write: %s", path,
                               strerror(errno));
    }
    raster_deinit(&raster);
    return status;
}
