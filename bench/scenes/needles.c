/* needles.c - pairs of triangles that are nearly segments.
 *
 * Lay pairs of triangles of length 1 and a width of 1e-8 on a grid, each pair far from
 * all others. The two of every other pair are nearly parallel, from 0.3 down to 3e-5
 * beside each other. A normal of such a triangle has half of its bits left. All 6 VF and
 * 9 EE pairs of two are nearer than 2.
 */
#include <math.h>

#include "families.h"
#include "prng.h"

#define SIDE    22u /* of the grid: 10 648 pairs of triangles */
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
    uint32_t side = small ? 4 : SIDE;
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
