/* partial.c - a scene of which only a part moves. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "families.h"

struct partial {
    double (*x[2])[3]; /* at even and at odd frames */
};

struct distance {
    double squared;
    uint32_t vertex;
};

static void place(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    const struct partial *partial = scene->state;
    memcpy(x, partial->x[frame % 2], scene->vertex_count * sizeof *x);
}

static void free_state(void *state)
{
    struct partial *partial = state;
    free(partial->x[0]);
    free(partial->x[1]);
    free(partial);
}

static int compare_distances(const void *a, const void *b)
{
    double d = ((const struct distance *)a)->squared;
    double e = ((const struct distance *)b)->squared;
    return (d > e) - (d < e);
}

/* The `count` vertices nearest to the one in the middle of the largest object. */
static void choose_patch(const struct bench_scene *scene, const double (*x)[3],
                         uint32_t count, bool *moves)
{
    const struct bench_object *largest = &scene->objects[0];
    for (uint32_t i = 1; i < scene->object_count; i++) {
        if (scene->objects[i].vertex_count > largest->vertex_count) {
            largest = &scene->objects[i];
        }
    }
    const double *middle = x[largest->first_vertex + largest->vertex_count / 2];
    struct distance *order = bench_scene_alloc(scene->vertex_count, sizeof *order);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        order[v] = (struct distance){0, v};
        for (int k = 0; k < 3; k++) {
            order[v].squared += (x[v][k] - middle[k]) * (x[v][k] - middle[k]);
        }
    }
    qsort(order, scene->vertex_count, sizeof *order, compare_distances);
    for (uint32_t i = 0; i < count; i++) {
        moves[order[i].vertex] = true;
    }
    free(order);
}

/* Return whether i is one of `count` that are spread evenly among `all`. */
static bool is_spread(uint32_t i, uint32_t count, uint32_t all)
{
    return (uint64_t)(i + 1) * count / all > (uint64_t)i * count / all;
}

static void choose(const struct bench_scene *scene, const double (*x)[3],
                   struct bench_moving moving, bool *moves)
{
    bool by_object = moving.what == BENCH_MOVING_OBJECTS;
    uint32_t all = by_object ? scene->object_count : scene->vertex_count;
    uint32_t count = (uint32_t)ceil(moving.share * all);
    count = count < all ? count : all;
    if (moving.what == BENCH_MOVING_PATCH) {
        choose_patch(scene, x, count, moves);
        return;
    }
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct bench_object *object = &scene->objects[i];
        for (uint32_t v = object->first_vertex;
             v < object->first_vertex + object->vertex_count; v++) {
            moves[v] = is_spread(by_object ? i : v, count, all);
        }
    }
}

void bench_make_partial(struct bench_scene *scene, const struct bench_scene *told,
                        uint32_t frame, struct bench_moving moving)
{
    struct partial *partial = bench_scene_alloc(1, sizeof *partial);
    struct bench_frames frames;
    bench_frames_init(&frames, told, frame);
    const struct bench_scene *from = frames.scene;
    bool *moves = bench_scene_alloc(from->vertex_count, sizeof *moves);
    memset(scene, 0, sizeof *scene);
    for (uint32_t i = 0; i < from->object_count; i++) {
        const struct bench_object *object = &from->objects[i];
        bench_scene_add_mesh(scene, object->vertex_count, object->triangle_count,
                             (const uint32_t(*)[3])object->triangles);
    }
    memset(moves, 0, from->vertex_count * sizeof *moves);
    choose(scene, (const double(*)[3])frames.x[0], moving, moves);
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        if (!moves[v]) {
            memcpy(frames.x[1][v], frames.x[0][v], sizeof *frames.x[1]);
        }
    }
    for (int end = 0; end < 2; end++) {
        partial->x[end] = bench_scene_alloc(scene->vertex_count, sizeof(double[3]));
        memcpy(partial->x[end], frames.x[end], scene->vertex_count * sizeof(double[3]));
    }
    scene->name = told->name;
    scene->frame_count = UINT32_MAX;
    scene->hard_frame = told->hard_frame;
    scene->place = place;
    scene->state = partial;
    scene->free_state = free_state;
    free(moves);
    bench_frames_deinit(&frames);
}
