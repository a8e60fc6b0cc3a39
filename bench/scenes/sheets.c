/* sheets.c - sheets that are crushed, fly through each other, jump. */
#include <math.h>
#include <stdlib.h>

#include "families.h"
#include "prng.h"
#include "surface.h"

#define FRAMES 16u
#define WAVES  12

struct sheets {
    uint32_t side;
    double waves[3][WAVES][4]; /* crumpled: wave numbers, phase, speed */
};

static struct sheets *make(struct bench_scene *scene, uint32_t side, uint32_t sheet_count)
{
    struct sheets *sheets = bench_scene_alloc(1, sizeof *sheets);
    struct surface surface;
    sheets->side = side;
    for (uint32_t i = 0; i < sheet_count; i++) {
        surface_sheet(&surface, side);
        surface_add(&surface, scene);
    }
    scene->frame_count = FRAMES;
    scene->state = sheets;
    scene->free_state = free;
    return sheets;
}

/* A sheet crushed into a ball: each coordinate is a sum of waves over the sheet. */
static void place_crumpled(const struct bench_scene *scene, uint32_t frame,
                           double (*x)[3])
{
    const struct sheets *sheets = scene->state;
    uint32_t side = sheets->side;
    for (uint32_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (side - 1);
        double v = (double)(i / side) / (side - 1);
        for (int k = 0; k < 3; k++) {
            x[i][k] = 0;
            for (int w = 0; w < WAVES; w++) {
                const double *wave = sheets->waves[k][w];
                x[i][k] += 0.1 * sin(wave[0] * u + wave[1] * v + wave[2] +
                                     wave[3] * 0.05 * frame);
            }
        }
    }
}

void bench_make_crumpled(struct bench_scene *scene, bool small)
{
    struct sheets *sheets = make(scene, small ? 21 : 91, 1);
    struct prng prng = {7};
    for (int k = 0; k < 3 * WAVES; k++) {
        double *wave = sheets->waves[k / WAVES][k % WAVES];
        wave[0] = 14 * prng_between(&prng, -0.5, 0.5);
        wave[1] = 14 * prng_between(&prng, -0.5, 0.5);
        wave[2] = prng_between(&prng, 0, 2 * BENCH_PI);
        wave[3] = prng_between(&prng, -0.5, 0.5);
    }
    scene->place = place_crumpled;
}

static void place_wavy(double (*x)[3], uint32_t side, const double at[3], double phase)
{
    for (uint32_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (side - 1);
        double v = (double)(i / side) / (side - 1);
        x[i][0] = at[0] + u;
        x[i][1] = at[1] + v;
        x[i][2] = at[2] + 0.02 * sin(9 * u + phase) * cos(7 * v - phase);
    }
}

/* One sheet flies through another: a step of twenty edges, flat sheets, no thickness. */
static void place_fast(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct sheets *sheets = scene->state;
    uint32_t side = sheets->side;
    double way = frame % 2 ? 10.0 / side : -10.0 / side;
    place_wavy(x, side, (const double[]){0, 0, 0}, 0);
    place_wavy(x + scene->objects[1].first_vertex, side,
               (const double[]){0.3 / side, 0.4 / side, way}, 1 + 0.1 * frame);
}

void bench_make_fast(struct bench_scene *scene, bool small)
{
    make(scene, small ? 17 : 72, 2);
    scene->place = place_fast;
}

/* A wavy sheet jumps a hundred sides away and back, past a sheet that waits halfway. */
static void place_teleport(const struct bench_scene *scene, uint32_t frame,
                           double (*x)[3])
{
    const struct sheets *sheets = scene->state;
    uint32_t side = sheets->side;
    double jump = frame % 2 ? 100 : 0;
    place_wavy(x, side, (const double[]){jump, 0.5 * jump, 0}, 0.1 * frame);
    place_wavy(x + scene->objects[1].first_vertex, side, (const double[]){50, 25, 0.5},
               0);
}

void bench_make_teleport(struct bench_scene *scene, bool small)
{
    make(scene, small ? 17 : 72, 2);
    scene->place = place_teleport;
}
