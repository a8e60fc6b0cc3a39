/* thick.c - balls, capsules and triangles with a thickness.
 *
 * Coordinates of the eye: to the right, up, and how far away. The ray through a pixel is
 * depth * (a, b, 1).
 */
#include "picture.h"

#include <math.h>
#include <string.h>

/* Of the radius: along an edge the sides of its triangles are in front of what rounds it,
 * so that the two do not take turns. */
#define SEAM 0.999

struct capsule {
    double from[3], to[3]; /* in coordinates of the eye */
    double way[3];         /* unit, from the one to the other */
    double length, radius;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void see(const struct picture_canvas *canvas, const float x[3], double seen[3])
{
    for (uint32_t axis = 0; axis < 3; axis++) {
        seen[axis] = axis == 2 ? (double)canvas->distance : 0;
        for (uint32_t k = 0; k < 3; k++) {
            seen[axis] += ((double)x[k] - (double)canvas->centre[k]) *
                          (double)canvas->axes[axis][k];
        }
    }
}

/* Widen a range of slopes, of what is aside by how far it is away, by those of a circle
 * before the eye. */
static void widen(double aside, double away, double radius, double slopes[2])
{
    double square = away * away - radius * radius;
    if (!(square > 0 && away > 0)) {
        slopes[0] = -INFINITY;
        slopes[1] = INFINITY;
        return;
    }
    double half = radius * sqrt(aside * aside + square);
    slopes[0] = fmin(slopes[0], (aside * away - half) / square);
    slopes[1] = fmax(slopes[1], (aside * away + half) / square);
}

/* The whole pixels of a range of places, on a canvas of `limit` of them; false: none. */
static bool pixels_of(double low, double high, uint32_t limit, uint32_t *first,
                      uint32_t *last)
{
    if (!(high >= 0 && low < (double)limit)) {
        return false;
    }
    *first = (uint32_t)fmax(floor(low), 0);
    *last = (uint32_t)fmin(floor(high), (double)limit - 1);
    return true;
}

/* Return the depth at which the ray enters the ball; INFINITY: nowhere. */
static double meet_ball(const double centre[3], double radius, const double ray[3])
{
    double length = dot(ray, ray), along = dot(ray, centre);
    double root = along * along - length * (dot(centre, centre) - radius * radius);
    double depth = root >= 0 ? (along - sqrt(root)) / length : INFINITY;
    return depth > 0 ? depth : INFINITY;
}

/* The same of a capsule. *on: the point of its segment that is nearest to there. */
static double meet(const struct capsule *capsule, const double ray[3], double on[3])
{
    double turn = dot(ray, capsule->way), begin = dot(capsule->from, capsule->way);
    double a = dot(ray, ray) - turn * turn;
    double b = turn * begin - dot(ray, capsule->from);
    double c = dot(capsule->from, capsule->from) - begin * begin -
               capsule->radius * capsule->radius;
    double root = b * b - a * c, depth = INFINITY;
    if (capsule->length > 0 && a > 0) {
        depth = root >= 0 ? (-b - sqrt(root)) / a : INFINITY;
        double at = depth * turn - begin;
        if (depth > 0 && at >= 0 && at <= capsule->length) {
            for (uint32_t k = 0; k < 3; k++) {
                on[k] = capsule->from[k] + at * capsule->way[k];
            }
            return depth;
        }
    }
    double of_from = meet_ball(capsule->from, capsule->radius, ray);
    double of_to = meet_ball(capsule->to, capsule->radius, ray);
    memcpy(on, of_from < of_to ? capsule->from : capsule->to, sizeof capsule->from);
    return fmin(of_from, of_to);
}

static struct capsule capsule_of(const struct picture_canvas *canvas, const float from[3],
                                 const float to[3], double radius)
{
    struct capsule capsule = {.radius = radius};
    see(canvas, from, capsule.from);
    see(canvas, to, capsule.to);
    for (uint32_t k = 0; k < 3; k++) {
        capsule.way[k] = capsule.to[k] - capsule.from[k];
    }
    capsule.length = sqrt(dot(capsule.way, capsule.way));
    for (uint32_t k = 0; k < 3 && capsule.length > 0; k++) {
        capsule.way[k] /= capsule.length;
    }
    return capsule;
}

/* Columns [0], [1] and rows [2], [3] in which it may be seen; false: in none. */
static bool find_pixels(const struct picture_canvas *canvas,
                        const struct capsule *capsule, uint32_t part[4])
{
    const double middle[2] = {0.5 * canvas->raster.width, 0.5 * canvas->raster.height};
    double wide[2] = {INFINITY, -INFINITY}, high[2] = {INFINITY, -INFINITY};
    double focus = (double)canvas->focus, radius = capsule->radius;
    widen(capsule->from[0], capsule->from[2], radius, wide);
    widen(capsule->to[0], capsule->to[2], radius, wide);
    widen(capsule->from[1], capsule->from[2], radius, high);
    widen(capsule->to[1], capsule->to[2], radius, high);
    return pixels_of(middle[0] + focus * wide[0], middle[0] + focus * wide[1],
                     canvas->raster.width, &part[0], &part[1]) &&
           pixels_of(middle[1] - focus * high[1], middle[1] - focus * high[0],
                     canvas->raster.height, &part[2], &part[3]);
}

uint64_t thick_pixels(const struct picture_canvas *canvas, const float from[3],
                      const float to[3], double radius)
{
    const struct capsule capsule = capsule_of(canvas, from, to, radius);
    uint32_t part[4];
    return find_pixels(canvas, &capsule, part)
               ? (part[1] - part[0] + 1) * (uint64_t)(part[3] - part[2] + 1)
               : 0;
}

void thick_segment(struct picture_canvas *canvas, const float from[3], const float to[3],
                   double radius, const struct raster_surface *surface)
{
    const struct capsule capsule = capsule_of(canvas, from, to, radius);
    const double middle[2] = {0.5 * canvas->raster.width, 0.5 * canvas->raster.height};
    double focus = (double)canvas->focus;
    uint32_t part[4];
    if (!find_pixels(canvas, &capsule, part)) {
        return;
    }
    for (uint32_t y = part[2]; y <= part[3]; y++) {
        for (uint32_t x = part[0]; x <= part[1]; x++) {
            const double ray[3] = {(x + 0.5 - middle[0]) / focus,
                                   (middle[1] - y - 0.5) / focus, 1};
            double on[3], depth = meet(&capsule, ray, on);
            if (!isfinite(depth)) {
                continue;
            }
            float normal[3] = {0, 0, 0};
            for (uint32_t k = 0; k < 9; k++) {
                double out = (depth * ray[k / 3] - on[k / 3]) / radius;
                normal[k % 3] += (float)out * canvas->axes[k / 3][k % 3];
            }
            raster_pixel(&canvas->raster, x, y, (float)(1 / depth), normal, surface);
        }
    }
}

/* Unit; false for a triangle without area. */
static bool normal_of(const float *const x[3], double normal[3])
{
    double a[3], b[3];
    for (uint32_t k = 0; k < 3; k++) {
        a[k] = (double)x[1][k] - (double)x[0][k];
        b[k] = (double)x[2][k] - (double)x[0][k];
    }
    for (uint32_t k = 0; k < 3; k++) {
        normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
    double length = sqrt(dot(normal, normal));
    for (uint32_t k = 0; k < 3 && length > 0; k++) {
        normal[k] /= length;
    }
    return length > 0;
}

void thick_triangle(struct picture_canvas *canvas, const float *const x[3],
                    const float normals[3][3], double radius,
                    const struct raster_surface *surface)
{
    double out[3];
    for (uint32_t i = 0; i < 3; i++) {
        thick_segment(canvas, x[i], x[(i + 1) % 3], SEAM * radius, surface);
    }
    for (int side = -1; side <= 1 && normal_of(x, out); side += 2) {
        struct raster_corner corners[3];
        for (uint32_t i = 0; i < 3; i++) {
            float at[3];
            for (uint32_t k = 0; k < 3; k++) {
                at[k] = (float)((double)x[i][k] + side * radius * out[k]);
            }
            picture_project(canvas, at, &corners[i]);
            memcpy(corners[i].normal, normals[i], sizeof corners[i].normal);
        }
        raster_triangle(&canvas->raster, corners, surface);
    }
}
