/* thin.c - a cloud above a sheet, and hair. */
#include <math.h>

#include "families.h"
#include "prng.h"

#define PI       3.14159265358979323846
#define POINTS_R 0x1p-12 /* at which pairs meet */
#define HAIR_R   0x1p-10

/* ---- a cloud above a sheet --------------------------------------------------------- */

#define SIDE  224u /* squares of the sheet along an edge: 100 352 triangles */
#define CLOUD 1000000u
#define DEEP  52.0 /* the cloud is within so many r of the sheet, on both sides */

static double height_at(double x, double y)
{
    return 0.05 * sin(2 * PI * x) * cos(3 * PI * y);
}

static void add_sheet(struct bench_scene *scene, uint32_t side)
{
    uint32_t row = side + 1;
    struct bench_object *sheet = bench_scene_add(scene, row * row, 2 * side * side);
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t corner = i / side * row + i % side;
        const uint32_t square[2][3] = {{corner, corner + 1, corner + row},
                                       {corner + 1, corner + row + 1, corner + row}};
        for (uint32_t k = 0; k < 6; k++) {
            sheet->triangles[2 * i + k / 3][k % 3] = square[k / 3][k % 3];
        }
    }
}

static void make_points(struct bench_scene *scene, bool small, bool is_self)
{
    const double r = POINTS_R;
    uint32_t side = small ? 16 : SIDE;
    uint32_t count = small ? 2000 : CLOUD;
    struct bench_object *cloud = bench_scene_add(scene, count, 0);
    struct prng prng = {29};
    cloud->point_count = count;
    cloud->points = bench_scene_alloc(count, sizeof *cloud->points);
    for (uint32_t i = 0; i < count; i++) {
        cloud->points[i] = i;
    }
    add_sheet(scene, side);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        scene->objects[i].radius = r / 2;
        scene->objects[i].is_not_self = !is_self;
    }
    double(*x)[3] = bench_scene_store(scene, 2);
    uint32_t all = scene->vertex_count;
    for (uint32_t i = 0; i < all; i++) {
        bool is_point = i < count;
        uint32_t v = i - count;
        x[i][0] = is_point ? prng_between(&prng, 0, 1) : (double)(v % (side + 1)) / side;
        x[i][1] = is_point ? prng_between(&prng, 0, 1) : (double)(v / (side + 1)) / side;
        x[i][2] = height_at(x[i][0], x[i][1]) +
                  (is_point ? prng_between(&prng, -DEEP * r, DEEP * r) : 0);
        x[all + i][0] = x[i][0];
        x[all + i][1] = x[i][1];
        x[all + i][2] = x[i][2] + (is_point ? -5 * r : r);
    }
}

void bench_make_points(struct bench_scene *scene, bool small)
{
    make_points(scene, small, false);
}

void bench_make_points_self(struct bench_scene *scene, bool small)
{
    make_points(scene, small, true);
}

/* ---- hair -------------------------------------------------------------------------- */

#define STRANDS  100u /* along each side of the skin */
#define SEGMENTS 100u
#define LENGTH   5.0 /* of a segment, in r */

/* Place vertex `k` of a strand at first: strands stand on a grid and wave together. */
static void place_hair(uint32_t strand, uint32_t strands, uint32_t k, double x[3])
{
    const double r = HAIR_R;
    double wave = 8 * r * sin(0.2 * k);
    x[0] = 4 * r * (strand % strands) + wave;
    x[1] = 4 * r * (uint32_t)(strand / strands) + 0.5 * wave;
    x[2] = LENGTH * r * k;
}

void bench_make_hair(struct bench_scene *scene, bool small)
{
    uint32_t strands = small ? 8 : STRANDS;
    uint32_t segments = small ? 10 : SEGMENTS;
    uint32_t count = strands * strands;
    struct bench_object *hair = bench_scene_add(scene, count * (segments + 1), 0);
    struct prng prng = {31};
    hair->radius = HAIR_R / 2;
    hair->rest_rings = 3;
    hair->edge_count = count * segments;
    hair->edges = bench_scene_alloc(hair->edge_count, sizeof *hair->edges);
    for (uint32_t i = 0; i < hair->edge_count; i++) {
        hair->edges[i][0] = i / segments * (segments + 1) + i % segments;
        hair->edges[i][1] = hair->edges[i][0] + 1;
    }
    uint32_t all = scene->vertex_count;
    double(*x)[3] = bench_scene_store(scene, 2);
    for (uint32_t strand = 0; strand < count; strand++) {
        double turn = prng_between(&prng, 0, 2 * PI);
        for (uint32_t k = 0; k <= segments; k++) {
            double *from = x[strand * (segments + 1) + k];
            double *to = x[all + strand * (segments + 1) + k];
            place_hair(strand, strands, k, from);
            to[0] = from[0] + 2 * HAIR_R * cos(turn + 0.05 * k);
            to[1] = from[1] + 2 * HAIR_R * sin(turn + 0.05 * k);
            to[2] = from[2];
        }
    }
}
