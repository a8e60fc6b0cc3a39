/* over_box.c - a small cloth that comes down on a box. */
#include <math.h>

#include "families.h"
#include "surface.h"

#define SIDE   15u
#define LENGTH 1.4  /* of the cloth; the box is 1 wide and 0.5 high */
#define ABOVE  0.02 /* the lowest point of the cloth, at first */
#define WAVE   0.01
#define FALL   0.05 /* of its middle, in the step */

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
    for (uint32_t v = 0; v < SIDE * SIDE; v++) {
        double u = (double)(v % SIDE) / (SIDE - 1) - 0.5;
        double w = (double)(v / SIDE) / (SIDE - 1) - 0.5;
        double way = FALL * (1 + u * u + w * w); /* the corners hang down */
        x[v][0] = LENGTH * u;
        x[v][1] = LENGTH * w;
        x[v][2] = ABOVE + WAVE * (1 + sin(9 * u + 1) * cos(7 * w)) - frame * way;
    }
}

void bench_make_over_box(struct bench_scene *scene)
{
    struct surface cloth;
    surface_sheet(&cloth, SIDE);
    surface_add(&cloth, scene);
    (void)bench_scene_add_mesh(scene, 8, 12, box_faces);
    double(*x)[3] = bench_scene_store(scene, 2);
    for (uint32_t frame = 0; frame < 2; frame++) {
        place_cloth(frame, x + frame * scene->vertex_count);
        place_box(x + frame * scene->vertex_count + SIDE * SIDE);
    }
}
