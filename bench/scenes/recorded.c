/* recorded.c - two frames of $PCCD_DATA. */
#include "data.h"
#include "families.h"
#include "ply.h"

/* The recorded frames themselves are not rounded. */
static void interpolate(const struct ply frames[2], double share, double (*x)[3])
{
    for (uint32_t v = 0; v < frames[0].vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            double start = frames[0].x[v][k];
            double end = frames[1].x[v][k];
            x[v][k] = share < 1 ? start + share * (end - start) : end;
        }
    }
}

bool bench_read_recorded(struct bench_scene *scene, const char *const names[2],
                         uint32_t steps)
{
    struct ply frames[2] = {{0}, {0}};
    char path[DATA_PATH_MAX];
    bool good = true;
    for (int f = 0; f < 2 && good; f++) {
        good = data_find(names[f], path) && ply_read(path, &frames[f]);
    }
    good = good && frames[0].vertex_count == frames[1].vertex_count;
    if (good) {
        uint32_t count = frames[0].vertex_count;
        bench_scene_add_mesh(scene, count, frames[0].triangle_count,
                             (const uint32_t(*)[3])frames[0].triangles);
        double(*x)[3] = bench_scene_store(scene, steps + 1);
        for (uint32_t i = 0; i <= steps; i++) {
            interpolate(frames, (double)i / steps, x + (size_t)i * count);
        }
    }
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
    return good;
}
