/* truth_kit.c - the public scenes, as tests take them. */
#include "truth_kit.h"

#include "cases.h"

void truth_find(const char *name, char path[DATA_PATH_MAX])
{
    if (!data_find(name, path)) {
        test_skip("no such frames in $PCCD_DATA");
    }
}

void truth_read_frames(const struct data_scene *scene, struct ply frames[2])
{
    for (int end = 0; end < 2; end++) {
        char path[DATA_PATH_MAX];
        truth_find(scene->frames[end], path);
        assert_true(ply_read(path, &frames[end]));
    }
    assert_int_equal(frames[0].vertex_count, frames[1].vertex_count);
    assert_int_equal(frames[0].triangle_count, frames[1].triangle_count);
    assert_memory_equal(frames[0].triangles, frames[1].triangles,
                        frames[0].triangle_count * sizeof *frames[0].triangles);
}

struct oracle_object truth_object(const struct ply frames[2])
{
    return (struct oracle_object){.object_id = 0,
                                  .vertex_count = frames[0].vertex_count,
                                  .triangle_count = frames[0].triangle_count,
                                  .x0 = (truth_points)frames[0].x,
                                  .x1 = (truth_points)frames[1].x,
                                  .triangles = (const uint32_t(*)[3])frames[0].triangles};
}
