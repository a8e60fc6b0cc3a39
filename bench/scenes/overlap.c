/* overlap.c - triangles that all fill the same cube; one alone. */
#include "families.h"
#include "prng.h"

#define FRAMES 16u

void bench_make_all_overlap(struct bench_scene *scene, bool small)
{
    uint32_t count = small ? 20 : 120;
    struct bench_object *soup = bench_scene_add(scene, 3 * count, count);
    struct prng prng = {11};
    for (uint32_t i = 0; i < 3 * count; i++) {
        soup->triangles[i / 3][i % 3] = i;
    }
    double(*x)[3] = bench_scene_store(scene, FRAMES);
    for (uint32_t i = 0; i < FRAMES * 3 * count; i++) {
        /* Corners of a triangle in different octants, so that its box is large. */
        for (unsigned k = 0; k < 3; k++) {
            double low = (i % 3 + k) % 3 == 0 ? 0.8 : (i % 3 + k) % 3 == 1 ? 0 : 0.4;
            x[i][k] = low + prng_between(&prng, 0, 0.2);
        }
    }
}

/* `count` triangles of such a size that each overlaps some ten others. */
void bench_make_soup(struct bench_scene *scene, uint32_t count)
{
    struct prng prng = {7};
    double side = 1;
    while (side * side * side < count) {
        side *= 1.0625;
    }
    struct bench_object *soup = bench_scene_add(scene, 3 * count, count);
    for (uint32_t i = 0; i < 3 * count; i++) {
        soup->triangles[i / 3][i % 3] = i;
    }
    double(*x)[3] = bench_scene_store(scene, FRAMES);
    for (uint32_t i = 0; i < FRAMES * 3 * count; i++) {
        uint32_t corner = i % (3 * count);
        for (unsigned k = 0; k < 3; k++) {
            if (i >= 3 * count) { /* from where it was */
                x[i][k] = x[corner][k] + prng_between(&prng, -0.1, 0.1);
            } else if (corner % 3 == 0) {
                x[i][k] = prng_between(&prng, 0, side);
            } else {
                x[i][k] = x[i - corner % 3][k] + prng_between(&prng, -1, 1);
            }
        }
    }
}

void bench_make_one_triangle(struct bench_scene *scene, bool small)
{
    const uint32_t triangle[1][3] = {{0, 1, 2}};
    (void)small;
    bench_scene_add_mesh(scene, 3, 1, triangle);
    double(*x)[3] = bench_scene_store(scene, FRAMES);
    for (uint32_t i = 0; i < FRAMES * 3; i++) {
        for (unsigned k = 0; k < 3; k++) {
            x[i][k] = (i % 3 == k) + 0.1 * (i / 3 % 2);
        }
    }
}
