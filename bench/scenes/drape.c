/* drape.c - a cloth that falls over a ball, which then spins. */
#include "tumble.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench_scene.h"
#include "prng.h"

#define GRAVITY         9.81
#define DRAG            4.0 /* share of the velocity that goes in a second */
#define BALL_FRICTION   6.0
#define GROUND_FRICTION 20.0

/* Shares of an error that a substep puts right. Shear and bending give way. */
#define STRETCH 1.0
#define SHEAR   0.3
#define BENDING 0.02
#define PARTING 0.05 /* of two particles that are too near */

/* Buckets of cells: neighbours are in different ones, some that are far in the same. */
#define BITS_XY 6u
#define BITS_Z  5u
#define BUCKETS (1u << (2 * BITS_XY + BITS_Z))

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- forces ------------------------------------------------------------------------ */

static void fall(struct drape *drape, double step_s)
{
    double keep = 1 - DRAG * step_s;
    for (uint32_t i = 0; i < drape->count; i++) {
        double *v = drape->velocity[i];
        v[2] -= GRAVITY * step_s;
        for (int k = 0; k < 3; k++) {
            v[k] *= keep;
            drape->before[i][k] = drape->x[i][k];
            drape->x[i][k] += step_s * v[k];
        }
    }
}

/* Nobody goes farther in a substep than half of what particles keep from each other. */
static void take_velocities(struct drape *drape, double step_s, double most)
{
    for (uint32_t i = 0; i < drape->count; i++) {
        double way[3];
        for (int k = 0; k < 3; k++) {
            way[k] = drape->x[i][k] - drape->before[i][k];
        }
        double length = sqrt(dot(way, way));
        double share = length > most ? most / length : 1;
        for (int k = 0; k < 3; k++) {
            drape->velocity[i][k] = way[k] * share / step_s;
        }
    }
}

/* ---- the cloth itself -------------------------------------------------------------- */

/* Bring two particles nearer to being `rest` apart, by a share of what they are off. */
static inline void hold(double a[3], double b[3], double rest, double share)
{
    double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double length = sqrt(dot(way, way));
    if (length > 0) {
        double move = 0.5 * share * (length - rest) / length;
        for (int k = 0; k < 3; k++) {
            a[k] += move * way[k];
            b[k] -= move * way[k];
        }
    }
}

/* All pairs (row, column), (row + down, column + right); right may be negative. */
static void hold_all(struct drape *drape, uint32_t down, int right, double rest,
                     double share)
{
    uint32_t side = drape->settings.side;
    uint32_t begin = right < 0 ? (uint32_t)-right : 0;
    uint32_t end = right > 0 ? side - (uint32_t)right : side;
    for (uint32_t row = 0; row + down < side; row++) {
        for (uint32_t column = begin; column < end; column++) {
            uint32_t a = row * side + column;
            uint32_t b = (uint32_t)((int64_t)(a + down * side) + right);
            hold(drape->x[a], drape->x[b], rest, share);
        }
    }
}

static void hold_cloth(struct drape *drape, double edge)
{
    const double diagonal = edge * sqrt(2);
    hold_all(drape, 0, 2, 2 * edge, BENDING);
    hold_all(drape, 2, 0, 2 * edge, BENDING);
    hold_all(drape, 1, 1, diagonal, SHEAR);
    hold_all(drape, 1, -1, diagonal, SHEAR);
    hold_all(drape, 0, 1, edge, STRETCH);
    hold_all(drape, 1, 0, edge, STRETCH);
}

/* ---- ball and ground --------------------------------------------------------------- */

static double spin_at(const struct drape_settings *settings, double time)
{
    double spin = settings->spin_gain * (time - settings->spin_from);
    return spin < 0 ? 0 : spin < settings->spin_most ? spin : settings->spin_most;
}

double drape_turn(const struct drape_settings *settings, uint32_t frame)
{
    double time = settings->frame_s * frame - settings->spin_from;
    double ramp = settings->spin_most / settings->spin_gain;
    double rest = time - ramp;
    return time <= 0   ? 0
           : rest <= 0 ? 0.5 * settings->spin_gain * time * time
                       : settings->spin_most * (0.5 * ramp + rest);
}

/* Take the part along a surface out of a way, as far as friction reaches at that depth.
 * `out` is across the surface, of any length. */
static void rub(double x[3], double slip[3], const double out[3], double grip)
{
    double along = dot(slip, out) / dot(out, out);
    for (int k = 0; k < 3; k++) {
        slip[k] -= along * out[k];
    }
    double way = sqrt(dot(slip, slip));
    double share = way > grip ? grip / way : 1;
    for (int k = 0; k < 3; k++) {
        x[k] -= share * slip[k];
    }
}

/* Out of the ball, and along with its surface. */
static void meet_ball(struct drape *drape, double step_s)
{
    const struct drape_settings *settings = &drape->settings;
    double radius = settings->radius + settings->gap;
    double turn = spin_at(settings, drape->time) * step_s;
    for (uint32_t i = 0; i < drape->count; i++) {
        double *x = drape->x[i];
        double out[3] = {x[0], x[1], x[2] - settings->height};
        double square = dot(out, out);
        if (square >= radius * radius || !(square > 0)) {
            continue;
        }
        double length = sqrt(square);
        double depth = radius - length;
        double slip[3] = {x[0] - drape->before[i][0] + turn * out[1],
                          x[1] - drape->before[i][1] - turn * out[0],
                          x[2] - drape->before[i][2]};
        rub(x, slip, out, BALL_FRICTION * depth);
        for (int k = 0; k < 3; k++) {
            x[k] += depth / length * out[k];
        }
    }
}

static void meet_ground(struct drape *drape)
{
    const double up[3] = {0, 0, 1};
    for (uint32_t i = 0; i < drape->count; i++) {
        double *x = drape->x[i];
        if (x[2] < 0) {
            double slip[3] = {x[0] - drape->before[i][0], x[1] - drape->before[i][1], 0};
            rub(x, slip, up, GROUND_FRICTION * -x[2]);
            x[2] = 0;
        }
    }
}

/* ---- the cloth with itself --------------------------------------------------------- */

static uint32_t bucket_of(int64_t x, int64_t y, int64_t z)
{
    const int64_t mask_xy = (1 << BITS_XY) - 1;
    const int64_t mask_z = (1 << BITS_Z) - 1;
    return (uint32_t)((x & mask_xy) | (y & mask_xy) << BITS_XY |
                      (z & mask_z) << 2 * BITS_XY);
}

/* Return the cell of that size that a coordinate is in; all are within a few thousand
 * metres. */
static int64_t cell_of(double x, double size)
{
    return (int64_t)(x / size + 0x1p30);
}

/* Particles by cells of `size`: those of a bucket in the order of their numbers. */
static void sort(struct drape *drape, double size)
{
    memset(drape->first, 0, (BUCKETS + 1) * sizeof *drape->first);
    for (uint32_t i = 0; i < drape->count; i++) {
        const double *x = drape->x[i];
        drape->cell[i] =
            bucket_of(cell_of(x[0], size), cell_of(x[1], size), cell_of(x[2], size));
        drape->first[drape->cell[i]]++;
    }
    for (uint32_t b = 0; b < BUCKETS; b++) {
        drape->first[b + 1] +=
            drape->first[b]; /* the end of the bucket; then its begin */
    }
    for (uint32_t i = drape->count; i-- > 0;) {
        drape->sorted[--drape->first[drape->cell[i]]] = i;
    }
}

static void part(double a[3], double b[3], double least)
{
    double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double square = dot(way, way);
    if (square < least * least && square > 0) {
        double length = sqrt(square);
        double move = 0.5 * PARTING * (least - length) / length;
        for (int k = 0; k < 3; k++) {
            a[k] -= move * way[k];
            b[k] += move * way[k];
        }
    }
}

/* The particle with those of higher numbers in the bucket and, of the cells around it,
 * each pair of cells once: those that come after it in the order x, y, z. */
static void meet_others(struct drape *drape, uint32_t i, double least)
{
    const double *x = drape->x[i];
    int64_t at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = cell_of(x[k], least);
    }
    for (int64_t n = 13; n < 27; n++) {
        uint32_t bucket =
            bucket_of(at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1);
        uint32_t end = drape->first[bucket + 1];
        for (uint32_t s = drape->first[bucket]; s < end; s++) {
            uint32_t j = drape->sorted[s];
            if (n > 13 || j > i) {
                part(drape->x[i], drape->x[j], least);
            }
        }
    }
}

static void meet_itself(struct drape *drape, double least)
{
    sort(drape, least);
    for (uint32_t i = 0; i < drape->count; i++) {
        meet_others(drape, i, least);
    }
}

/* ---- time -------------------------------------------------------------------------- */

void drape_advance(struct drape *drape)
{
    const struct drape_settings *settings = &drape->settings;
    double edge = settings->length / (settings->side - 1);
    double step_s = settings->frame_s / settings->substeps;
    double least = settings->distance * edge;
    for (uint32_t i = 0; i < settings->substeps; i++) {
        fall(drape, step_s);
        hold_cloth(drape, edge);
        meet_itself(drape, least);
        meet_ball(drape, step_s);
        meet_ground(drape);
        take_velocities(drape, step_s, 0.5 * edge);
        drape->time += step_s;
    }
    drape->frame++;
}

void drape_restart(struct drape *drape)
{
    const struct drape_settings *settings = &drape->settings;
    struct prng prng = {settings->seed};
    double edge = settings->length / (settings->side - 1);
    drape->frame = 0;
    drape->time = 0;
    for (uint32_t i = 0; i < drape->count; i++) {
        double *x = drape->x[i];
        x[0] = edge * (i % settings->side) - 0.5 * settings->length;
        x[1] = edge * (i / settings->side) - 0.5 * settings->length;
        x[2] = settings->height + settings->radius + 0.5 * edge +
               prng_between(&prng, 0, 0.3 * edge);
    }
    memset(drape->velocity, 0, drape->count * sizeof *drape->velocity);
}

void drape_init(struct drape *drape, const struct drape_settings *settings)
{
    uint32_t count = settings->side * settings->side;
    *drape = (struct drape){.settings = *settings,
                            .count = count,
                            .x = bench_scene_alloc(count, sizeof *drape->x),
                            .before = bench_scene_alloc(count, sizeof *drape->before),
                            .velocity = bench_scene_alloc(count, sizeof *drape->velocity),
                            .cell = bench_scene_alloc(count, sizeof *drape->cell),
                            .sorted = bench_scene_alloc(count, sizeof *drape->sorted),
                            .first = bench_scene_alloc(BUCKETS + 1, sizeof(uint32_t))};
    drape_restart(drape);
}

void drape_deinit(struct drape *drape)
{
    free(drape->x);
    free(drape->before);
    free(drape->velocity);
    free(drape->cell);
    free(drape->sorted);
    free(drape->first);
    memset(drape, 0, sizeof *drape);
}
