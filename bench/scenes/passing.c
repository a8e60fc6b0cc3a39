/* passing.c - two bodies that pass each other and meet. */
#include <math.h>

#include "families.h"
#include "surface.h"

#define FRAMES    60u
#define FAR       2.6 /* between their middles, at first and at last */
#define NEAR      1.8
#define RATE      0.05 /* radians a frame */
#define RINGS     50u  /* 9800 triangles */
#define RINGS_FEW 8u
#define BUMP      0.08

static void place_ball(uint32_t rings, uint32_t index, uint32_t frame, double (*x)[3])
{
    double apart = FAR + (NEAR - FAR) * frame / (FRAMES - 1);
    double turn = RATE * frame * (index == 0 ? 1 : -1);
    uint32_t count = 2 + 2 * rings * (rings - 1);
    for (uint32_t v = 0; v < count; v++) {
        double p;
        double a;
        surface_ball_angles(rings, v, &p, &a);
        double radius = 1 - BUMP + BUMP * sin(7 * p) * cos(6 * a) * sin(p);
        x[v][0] = radius * sin(p) * cos(a + turn) + (index == 0 ? 0 : apart);
        x[v][1] = radius * sin(p) * sin(a + turn);
        x[v][2] = radius * cos(p);
    }
}

void bench_make_passing(struct bench_scene *scene, bool small)
{
    uint32_t rings = small ? RINGS_FEW : RINGS;
    for (uint32_t i = 0; i < 2; i++) {
        struct surface ball;
        surface_ball(&ball, rings);
        surface_add(&ball, scene);
    }
    double(*x)[3] = bench_scene_store(scene, FRAMES);
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        for (uint32_t i = 0; i < 2; i++) {
            place_ball(rings, i, frame,
                       x + frame * scene->vertex_count + scene->objects[i].first_vertex);
        }
    }
}
