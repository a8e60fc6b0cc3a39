/* layers.c - a stack of waving sheets, of any size.
 *
 * Room:     bench/scenes.
 * Does:     lay sheets of squares one above the other, whose waves pass and touch those
 *           of the neighbours. Squares are as large, and waves as long, in a small stack
 *           as in a large one, so there is as much to find a triangle in each. Lengths
 *           are in units of the side of a square.
 * Threads:  one.
 */
#include <math.h>
#include <stdlib.h>

#include "families.h"
#include "surface.h"

#define FRAMES 16u
#define GAP    2.0  /* between two sheets */
#define HEIGHT 1.06 /* of a wave: crests of two sheets meet by a tenth of a square */
#define LENGTH 23.0 /* of a wave */
#define TURN   0.12 /* radians that a wave goes on from frame to frame */
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
    double phase = 0.7 * layer + sign * TURN * frame;
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
