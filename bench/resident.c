/* bench/resident.c - a measured scene inside the engine.
 *
 * Room:     bench.
 * Does:     see resident.h.
 * Threads:  one.
 */
#include "resident.h"

#include <stdio.h>
#include <stdlib.h>

/* Everything here is valid input, so a refusal ends the program. */
static void must(int status, const char *what)
{
    if (status != ENG_OK) {
        fprintf(stderr, "engine: %s: status %d\n", what, status);
        exit(2);
    }
}

void bench_world_init(struct bench_world *world, const struct bench_scene *source,
                      uint32_t frame)
{
    world->source = source;
    world->frame = frame;
    must(eng_scene_new(NULL, &world->scene), "eng_scene_new");
    for (uint32_t i = 0; i < source->object_count; i++) {
        const struct bench_object *object = &source->objects[i];
        struct eng_mesh *mesh;
        uint32_t bad;
        must(eng_mesh_new(object->vertex_count, object->triangle_count, &mesh),
             "eng_mesh_new");
        must(eng_mesh_write_vertices(mesh, ENG_F64, 0, object->vertex_count,
                                     bench_scene_x(source, frame, i)),
             "eng_mesh_write_vertices");
        must(eng_mesh_write_triangles(mesh, 0, object->triangle_count, object->triangles,
                                      &bad),
             "eng_mesh_write_triangles");
        must(eng_mesh_commit(mesh), "eng_mesh_commit");
        must(eng_scene_add(world->scene, mesh, i + 1, &world->object_idx[i]),
             "eng_scene_add");
        eng_mesh_release(mesh);
    }
}

void bench_world_deinit(struct bench_world *world)
{
    eng_scene_free(world->scene);
    world->scene = NULL;
}

void bench_world_step(struct bench_world *world, uint32_t from, enum eng_mode mode,
                      struct eng_step_result *result)
{
    const struct bench_scene *source = world->source;
    struct eng_step_settings settings = ENG_STEP_SETTINGS_DEFAULT;
    settings.mode = mode;
    settings.contact_max = UINT32_MAX;
    eng_stage_begin(world->scene);
    for (uint32_t i = 0; i < source->object_count; i++) {
        const void *x0 = bench_scene_x(source, from, i);
        const void *x1 = bench_scene_x(source, from + 1, i);
        uint32_t count = source->objects[i].vertex_count;
        uint32_t idx = world->object_idx[i];
        must(world->frame == from
                 ? eng_stage_x1(world->scene, idx, ENG_F64, 0, count, x1)
                 : eng_stage_x0x1(world->scene, idx, ENG_F64, 0, count, x0, x1),
             "eng_stage");
    }
    must(eng_step(world->scene, &settings, result), "eng_step");
    world->frame = from + 1;
}
