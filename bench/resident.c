/* resident.c - a measured scene inside the engine. */
#include "resident.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "affinity.h"
#include "report.h"

/* Everything here is valid input, so a refusal ends the program. */
static void must(int status, const char *what)
{
    if (status != PCCD_OK) {
        fprintf(stderr, "engine: %s: status %d\n", what, status);
        exit(2);
    }
}

void bench_team_environment(char **argv)
{
    struct eng_affinity all;
    if (getenv("GOMP_SPINCOUNT") == NULL && setenv("GOMP_SPINCOUNT", "2000", 0) == 0) {
        /* The next image begins where OMP_PROC_BIND has bound this thread by now. */
        eng_affinity_init(&all);
        (void)eng_affinity_unbind_thread(&all);
        execv("/proc/self/exe", argv);
        perror("starting anew with GOMP_SPINCOUNT");
    }
}

static struct eng_mesh *make_mesh(const struct bench_frames *frames, uint32_t i)
{
    const struct bench_object *object = &frames->scene->objects[i];
    struct eng_mesh *mesh;
    uint32_t bad;
    const struct eng_mesh_counts counts = {object->vertex_count, object->triangle_count,
                                           object->edge_count, object->point_count};
    must(eng_mesh_make(&counts, &mesh), "eng_mesh_make");
    must(eng_mesh_write_vertices(mesh, PCCD_FORMAT_F64, 0, object->vertex_count,
                                 bench_frames_x(frames, 0, i)),
         "eng_mesh_write_vertices");
    if (counts.triangles > 0) {
        must(eng_mesh_write_triangles(mesh, 0, counts.triangles, object->triangles, &bad),
             "eng_mesh_write_triangles");
    }
    if (counts.edges > 0) {
        must(eng_mesh_write_edges(mesh, 0, counts.edges, object->edges, &bad),
             "eng_mesh_write_edges");
    }
    if (counts.points > 0) {
        must(eng_mesh_write_points(mesh, 0, counts.points, object->points, &bad),
             "eng_mesh_write_points");
    }
    must(eng_mesh_commit(mesh, 1), "eng_mesh_commit");
    return mesh;
}

static void set_thickness(struct bench_world *world, uint32_t i)
{
    const struct bench_object *object = &world->source->objects[i];
    const struct eng_object_thickness thickness = {
        .has_radius = true, .radius = object->radius, .rest_rings = object->rest_rings};
    const struct eng_object_filter filter = {
        .group = 1, .mask = UINT64_MAX, .self = !object->is_not_self};
    must(eng_scene_set_thickness(world->scene, world->object_idx[i], &thickness),
         "eng_scene_set_thickness");
    must(eng_scene_set_filter(world->scene, world->object_idx[i], &filter),
         "eng_scene_set_filter");
}

void bench_world_init(struct bench_world *world, const struct bench_frames *frames,
                      const struct eng_scene_settings *settings)
{
    world->source = frames->scene;
    world->frame = frames->from;
    world->object_idx = bench_alloc(frames->scene->object_count, sizeof(uint32_t));
    must(eng_scene_new(settings, &world->scene), "eng_scene_new");
    for (uint32_t i = 0; i < frames->scene->object_count; i++) {
        struct eng_mesh *mesh = make_mesh(frames, i);
        must(eng_scene_add(world->scene, mesh, BENCH_OBJECT_ID(i), &world->object_idx[i]),
             "eng_scene_add");
        eng_mesh_release(mesh);
        if (frames->scene->objects[i].radius > 0) {
            set_thickness(world, i);
        }
    }
}

void bench_world_deinit(struct bench_world *world)
{
    eng_scene_free(world->scene);
    free(world->object_idx);
    world->scene = NULL;
    world->object_idx = NULL;
}

void bench_world_follow(struct bench_world *world, const struct bench_frames *frames)
{
    uint32_t object = frames->told->break_object;
    if (world->source == frames->scene) {
        return;
    }
    struct eng_mesh *mesh = make_mesh(frames, object);
    must(eng_scene_replace(world->scene, world->object_idx[object], mesh),
         "eng_scene_replace");
    eng_mesh_release(mesh);
    world->source = frames->scene;
}

struct eng_question bench_step_settings(enum pccd_mode mode)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.mode = mode;
    settings.method = PCCD_METHOD_PAPER;
    settings.contact_max = UINT32_MAX;
    return settings;
}

void bench_world_step(struct bench_world *world, const struct bench_frames *frames,
                      const struct eng_question *settings, struct eng_step_result *result)
{
    const struct bench_scene *source = frames->scene;
    bench_world_follow(world, frames);
    eng_stage_begin(world->scene);
    eng_stage_share(world->scene, settings->threads, settings->affinity);
    for (uint32_t i = 0; i < source->object_count; i++) {
        const void *x0 = bench_frames_x(frames, 0, i);
        const void *x1 = bench_frames_x(frames, 1, i);
        uint32_t count = source->objects[i].vertex_count;
        uint32_t idx = world->object_idx[i];
        must(world->frame == frames->from
                 ? eng_stage_x1(world->scene, idx, PCCD_FORMAT_F64, 0, count, x1)
                 : eng_stage_x0x1(world->scene, idx, PCCD_FORMAT_F64, 0, count, x0, x1),
             "eng_stage");
    }
    must(eng_step(world->scene, settings, result), "eng_step");
    world->frame = frames->from + 1;
}

void bench_world_near(struct bench_world *world, const struct bench_frames *frames,
                      bool moves, const struct eng_question *settings,
                      struct eng_step_result *result)
{
    const struct bench_scene *source = frames->scene;
    if (moves) {
        eng_stage_begin(world->scene);
        eng_stage_share(world->scene, settings->threads, settings->affinity);
        for (uint32_t i = 0; i < source->object_count; i++) {
            must(eng_stage_x1(world->scene, world->object_idx[i], PCCD_FORMAT_F64, 0,
                              source->objects[i].vertex_count,
                              bench_frames_x(frames, 0, i)),
                 "eng_stage_x1");
        }
        world->frame = frames->from;
    }
    must(eng_near(world->scene, settings, result), "eng_near");
}
