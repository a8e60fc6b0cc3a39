/* recorded.c - two frames of $PCCD_DATA.
 *
 * Room:     bench/scenes. May include: tests/support/{data,ply}.h.
 * Does:     read frames that have the same faces, as one object.
 * Threads:  one.
 */
#include <string.h>

#include "data.h"
#include "families.h"
#include "ply.h"

bool bench_read_recorded(struct bench_scene *scene, const char *const names[2])
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
        double(*x)[3] = bench_scene_store(scene, 2);
        memcpy(x, frames[0].x, count * sizeof *x);
        memcpy(x + count, frames[1].x, count * sizeof *x);
    }
    ply_deinit(&frames[0]);
    ply_deinit(&frames[1]);
    return good;
}
