/* near.c - scenes to ask what is near, and how much of a step is safe. */
#include <math.h>

#include "families.h"
#include "prng.h"
#include "surface.h"

/* ---- needles -----------------------------------------------------------------------
 *
 * Pairs of triangles of length 1 and a width of 1e-8 on a grid, each pair far from all
 * others. The two of every other pair are nearly parallel, from 0.3 down to 3e-5 beside
 * each other. A normal of such a triangle has half of its bits left. All 6 VF and 9 EE
 * pairs of two are nearer than 2. */

#define NEEDLES 22u /* of the grid: 10 648 pairs of triangles */
#define SPACING 6.0
#define WIDTH   1e-8
#define SHIFT   0.25 /* in a step */

static void draw_direction(struct prng *prng, double u[3])
{
    double square;
    do {
        square = 0;
        for (int k = 0; k < 3; k++) {
            u[k] = prng_between(prng, -1, 1);
            square += u[k] * u[k];
        }
    } while (square > 1 || square < 0.01);
    for (int k = 0; k < 3; k++) {
        u[k] /= sqrt(square);
    }
}

static void draw_needle(struct prng *prng, const double start[3], const double u[3],
                        double (*x)[3])
{
    double along = prng_between(prng, 0.1, 0.9);
    for (int k = 0; k < 3; k++) {
        x[0][k] = start[k];
        x[1][k] = start[k] + u[k];
        x[2][k] = start[k] + along * u[k] + prng_between(prng, -WIDTH, WIDTH);
    }
}

static void draw_pair(struct prng *prng, const double at[3], bool parallel,
                      double (*x)[3])
{
    double u[3];
    double beside[3];
    double gap = 0.3 * pow(10, prng_between(prng, -4, 0));
    draw_direction(prng, u);
    draw_needle(prng, at, u, x);
    for (int k = 0; k < 3; k++) {
        beside[k] = at[k] + prng_between(prng, -gap, gap);
        u[k] += prng_between(prng, -WIDTH, WIDTH);
    }
    if (!parallel) {
        draw_direction(prng, u);
    }
    draw_needle(prng, beside, u, x + 3);
}

void bench_make_needles(struct bench_scene *scene, bool small)
{
    uint32_t side = small ? 4 : NEEDLES;
    uint32_t pairs = side * side * side;
    struct bench_object *needles = bench_scene_add(scene, 6 * pairs, 2 * pairs);
    struct prng prng = {17};
    for (uint32_t i = 0; i < 6 * pairs; i++) {
        needles->triangles[i / 3][i % 3] = i;
    }
    double(*x)[3] = bench_scene_store(scene, 2);
    for (uint32_t i = 0; i < pairs; i++) {
        double at[3] = {SPACING * (i % side), SPACING * (i / side % side),
                        SPACING * (i / side / side)};
        draw_pair(&prng, at, i % 2 == 0, x + 6 * i);
    }
    for (uint32_t i = 0; i < 6 * pairs; i++) {
        for (int k = 0; k < 3; k++) {
            x[6 * pairs + i][k] = x[i][k] + SHIFT;
        }
    }
}

/* ---- two bodies that pass each other and meet -------------------------------------- */

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

/* ---- a small cloth that comes down on a box ---------------------------------------- */

#define CLOTH_SIDE   15u
#define CLOTH_LENGTH 1.4  /* of the cloth; the box is 1 wide and 0.5 high */
#define ABOVE        0.02 /* the lowest point of the cloth, at first */
#define WAVE         0.01
#define FALL         0.05 /* of its middle, in the step */

static const uint32_t box_faces[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7},
                                          {0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5},
                                          {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};

static void place_box(double (*x)[3])
{
    for (uint32_t v = 0; v < 8; v++) {
        x[v][0] = v % 4 == 1 || v % 4 == 2 ? 0.5 : -0.5;
        x[v][1] = v % 4 >= 2 ? 0.5 : -0.5;
        x[v][2] = v < 4 ? -0.5 : 0;
    }
}

static void place_cloth(uint32_t frame, double (*x)[3])
{
    for (uint32_t v = 0; v < CLOTH_SIDE * CLOTH_SIDE; v++) {
        double u = (double)(v % CLOTH_SIDE) / (CLOTH_SIDE - 1) - 0.5;
        double w = (double)(v / CLOTH_SIDE) / (CLOTH_SIDE - 1) - 0.5;
        double way = FALL * (1 + u * u + w * w); /* the corners hang down */
        x[v][0] = CLOTH_LENGTH * u;
        x[v][1] = CLOTH_LENGTH * w;
        x[v][2] = ABOVE + WAVE * (1 + sin(9 * u + 1) * cos(7 * w)) - frame * way;
    }
}

void bench_make_over_box(struct bench_scene *scene)
{
    struct surface cloth;
    surface_sheet(&cloth, CLOTH_SIDE);
    surface_add(&cloth, scene);
    (void)bench_scene_add_mesh(scene, 8, 12, box_faces);
    double(*x)[3] = bench_scene_store(scene, 2);
    for (uint32_t frame = 0; frame < 2; frame++) {
        place_cloth(frame, x + frame * scene->vertex_count);
        place_box(x + frame * scene->vertex_count + CLOTH_SIDE * CLOTH_SIDE);
    }
}
