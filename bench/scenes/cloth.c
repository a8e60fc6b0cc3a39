/* cloth.c - a sheet laid over a turning ball.
 *
 * Room:     bench/scenes.
 * Does:     lay it on the ball down to an angle; let it hang in pleats below, all of it
 *           turning with the ball. The pleats deepen with time until neighbours touch.
 *           Lengths are in units of half the sheet's side.
 * Threads:  one.
 */
#include <math.h>
#include <stdlib.h>

#include "families.h"
#include "surface.h"

#define FRAMES 16u

struct cloth {
    uint32_t side;
    uint32_t rings;
    bool still;
};

static void place_sheet(double (*x)[3], uint32_t side, double time)
{
    const double radius = 0.3;
    const double pleats = 9;
    double reach = 0.9 + 0.6 * time;
    double turn = 1.5 * time;
    double gap = 0.004 - 0.003 * time;
    for (uint32_t i = 0; i < side * side; i++) {
        double u = (double)(i % side) / (side - 1) * 2 - 1;
        double v = (double)(i / side) / (side - 1) * 2 - 1;
        double along = sqrt(u * u + v * v); /* from the middle, on the cloth */
        double angle = atan2(v, u);
        double polar = along / radius < reach ? along / radius : reach;
        double below = along - polar * radius;
        double depth = below / (below + 0.2);
        double out = (radius + gap) * sin(polar) + depth * 0.12 * sin(pleats * angle);
        angle += depth * (0.2 + 0.5 * time) * sin(2 * pleats * angle) / pleats + turn;
        x[i][0] = (out + 0.3 * below) * cos(angle);
        x[i][1] = (out + 0.3 * below) * sin(angle);
        x[i][2] = (radius + gap) * cos(polar) - 0.9 * below;
    }
}

static void place_ball(double (*x)[3], uint32_t rings, double radius, double turn)
{
    uint32_t count = 2 * rings * (rings - 1) + 2;
    for (uint32_t v = 0; v < count; v++) {
        double polar;
        double azimuth;
        surface_ball_angles(rings, v, &polar, &azimuth);
        x[v][0] = radius * sin(polar) * cos(azimuth + turn);
        x[v][1] = radius * sin(polar) * sin(azimuth + turn);
        x[v][2] = radius * cos(polar);
    }
}

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct cloth *cloth = scene->state;
    /* Frames of a fortieth of the whole motion: about an edge of way at the rim. */
    double time = 0.3 + (cloth->still ? 0 : frame) / 40.0;
    place_sheet(x, cloth->side, time);
    place_ball(x + scene->objects[1].first_vertex, cloth->rings, 0.3, 1.5 * time);
}

static void make(struct bench_scene *scene, uint32_t side, bool still)
{
    struct cloth *cloth = bench_scene_alloc(1, sizeof *cloth);
    struct surface surface;
    *cloth = (struct cloth){side, side / 3, still};
    surface_sheet(&surface, side);
    surface_add(&surface, scene);
    surface_ball(&surface, cloth->rings);
    surface_add(&surface, scene);
    scene->frame_count = FRAMES;
    scene->place = place;
    scene->state = cloth;
    scene->free_state = free;
}

void bench_make_cloth_20k(struct bench_scene *scene, bool small)
{
    make(scene, small ? 21 : 91, false);
}

void bench_make_cloth_100k(struct bench_scene *scene, bool small)
{
    make(scene, small ? 31 : 203, false);
}

void bench_make_still(struct bench_scene *scene, bool small)
{
    make(scene, small ? 21 : 91, true);
}
