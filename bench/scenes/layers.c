/* layers.c - a stack of waving sheets, of any size; two with any number of contacts.
 *
 * Squares are as large, and waves as long, in a small stack as in a large one, so there
 * is as much to find a triangle in each. Lengths are in units of the side of a square.
 */
#include <math.h>
#include <stdlib.h>

#include "families.h"
#include "surface.h"

#define FRAMES 64u
#define GAP    2.0  /* between two sheets */
#define HEIGHT 2.1  /* of a wave: crests pass through the sheet above by a little */
#define LENGTH 23.0 /* of a wave */
#define TURN   0.12 /* radians that the waves go on from frame to frame */
#define DRIFT  0.21 /* squares that a sheet goes aside, every other one the other way */

struct layers {
    uint32_t side;
    double *wave[2]; /* [side] of the columns, of the rows */
};

static void place_sheet(const struct layers *layers, uint32_t layer, uint32_t frame,
                        double (*x)[3])
{
    const double number = 2 * BENCH_PI / LENGTH;
    double sign = layer % 2 ? -1 : 1;
    double phase = 0.5 * BENCH_PI * layer + TURN * frame;
    double drift = sign * DRIFT * frame;
    for (uint32_t i = 0; i < layers->side; i++) {
        layers->wave[0][i] = sin(number * (i + drift) + phase);
        layers->wave[1][i] = cos(1.07 * number * (i - drift) - phase);
    }
    for (uint32_t row = 0; row < layers->side; row++) {
        for (uint32_t column = 0; column < layers->side; column++) {
            (*x)[0] = column + drift;
            (*x)[1] = row - 0.6 * drift;
            (*x)[2] =
                GAP * layer + HEIGHT * layers->wave[0][column] * layers->wave[1][row];
            x++;
        }
    }
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    for (uint32_t layer = 0; layer < scene->object_count; layer++) {
        place_sheet(scene->state, layer, frame, x + scene->objects[layer].first_vertex);
    }
}

static void free_state(void *state)
{
    struct layers *layers = state;
    free(layers->wave[0]);
    free(layers->wave[1]);
    free(layers);
}

void bench_make_layers(struct bench_scene *scene, uint32_t layer_count, uint32_t side)
{
    struct layers *layers = bench_scene_alloc(1, sizeof *layers);
    layers->side = side;
    layers->wave[0] = bench_scene_alloc(side, sizeof(double));
    layers->wave[1] = bench_scene_alloc(side, sizeof(double));
    for (uint32_t i = 0; i < layer_count; i++) {
        struct surface surface;
        surface_sheet(&surface, side);
        surface_add(&surface, scene);
    }
    scene->frame_count = FRAMES;
    scene->place = place;
    scene->state = layers;
    scene->free_state = free_state;
}

void bench_make_layers_10m(struct bench_scene *scene, bool small)
{
    /* 8 x 2 x 791 x 791 = 10 010 896 triangles */
    bench_make_layers(scene, 8, small ? 9 : 792);
}

/* ---- as many contacts as are asked for --------------------------------------------- */

#define WAY 0.3 /* of vertices that pass through the other sheet, to either side */

struct crossing {
    uint32_t side;
    uint32_t count; /* of vertices that do */
};

static void place_crossing(const struct bench_scene *scene, uint32_t frame,
                           double (*x)[3])
{
    const struct crossing *crossing = scene->state;
    uint32_t side = crossing->side;
    for (uint32_t sheet = 0; sheet < 2; sheet++) {
        for (uint32_t i = 0; i < side * side; i++, x++) {
            double u = i % side + 0.3 * sheet;
            double v = i / side + 0.4 * sheet;
            double above = i >= crossing->count ? 2 * WAY : frame % 2 ? WAY : -WAY;
            (*x)[0] = u;
            (*x)[1] = v;
            (*x)[2] = 0.05 * sin(0.9 * u + frame) * cos(0.7 * v) + sheet * above;
        }
    }
}

void bench_make_crossing(struct bench_scene *scene, uint32_t side, uint32_t count)
{
    struct crossing *crossing = bench_scene_alloc(1, sizeof *crossing);
    *crossing = (struct crossing){side, count};
    for (int i = 0; i < 2; i++) {
        struct surface surface;
        surface_sheet(&surface, side);
        surface_add(&surface, scene);
    }
    scene->frame_count = FRAMES;
    scene->place = place_crossing;
    scene->state = crossing;
    scene->free_state = free;
}
