/* bench_scene.c - a scene that is measured: meshes, and positions on demand. */
#include "bench_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "data.h"
#include "ply.h"

#define NO_FRAME UINT32_MAX

void *bench_scene_alloc(size_t count, size_t bytes)
{
    void *block = count > SIZE_MAX / bytes ? NULL : malloc(count * bytes + 1);
    if (!block) {
        fprintf(stderr, "scene: no memory for %zu x %zu bytes\n", count, bytes);
        exit(2);
    }
    return block;
}

static void grow(struct bench_scene *scene)
{
    uint32_t capacity = scene->object_capacity ? scene->object_capacity * 2 : 4;
    struct bench_object *objects = bench_scene_alloc(capacity, sizeof *objects);
    if (scene->object_count > 0) {
        memcpy(objects, scene->objects, scene->object_count * sizeof *objects);
    }
    free(scene->objects);
    scene->objects = objects;
    scene->object_capacity = capacity;
}

struct bench_object *bench_scene_add(struct bench_scene *scene, uint32_t vertex_count,
                                     uint32_t triangle_count)
{
    if (scene->object_count == scene->object_capacity) {
        grow(scene);
    }
    struct bench_object *object = &scene->objects[scene->object_count++];
    *object = (struct bench_object){0};
    object->vertex_count = vertex_count;
    object->triangle_count = triangle_count;
    object->triangles = bench_scene_alloc(triangle_count, sizeof *object->triangles);
    object->first_vertex = scene->vertex_count;
    scene->vertex_count += vertex_count;
    return object;
}

struct bench_object *bench_scene_add_mesh(struct bench_scene *scene,
                                          uint32_t vertex_count, uint32_t triangle_count,
                                          const uint32_t (*triangles)[3])
{
    struct bench_object *object = bench_scene_add(scene, vertex_count, triangle_count);
    memcpy(object->triangles, triangles, triangle_count * sizeof *triangles);
    return object;
}

static void place_stored(const struct bench_scene *scene, uint32_t frame, double (*x)[3])
{
    double(*all)[3] = scene->state;
    memcpy(x, all + (size_t)frame * scene->vertex_count, scene->vertex_count * sizeof *x);
}

double (*bench_scene_store(struct bench_scene *scene, uint32_t frame_count))[3]
{
    scene->frame_count = frame_count;
    scene->place = place_stored;
    scene->state =
        bench_scene_alloc((size_t)frame_count * scene->vertex_count, sizeof(double[3]));
    scene->free_state = free;
    return scene->state;
}

double bench_frames_diagonal(const struct bench_frames *frames)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double lo = INFINITY;
        double hi = -INFINITY;
        for (uint32_t v = 0; v < frames->scene->vertex_count; v++) {
            lo = fmin(lo, frames->x[0][v][k]);
            hi = fmax(hi, frames->x[0][v][k]);
        }
        square += (hi - lo) * (hi - lo);
    }
    return sqrt(square);
}

static int compare_lengths(const void *a, const void *b)
{
    const double *x = a;
    const double *y = b;
    return *x < *y ? -1 : *x > *y;
}

double bench_frames_median_edge(const struct bench_frames *frames)
{
    const struct bench_scene *scene = frames->scene;
    size_t count = 0;
    double *lengths =
        bench_scene_alloc((size_t)bench_scene_triangles(scene), 3 * sizeof *lengths);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const double(*x)[3] = (const double(*)[3])bench_frames_x(frames, 0, i);
        for (uint32_t t = 0; t < scene->objects[i].triangle_count; t++) {
            const uint32_t *v = scene->objects[i].triangles[t];
            for (int k = 0; k < 3; k++) {
                const double *a = x[v[k]];
                const double *b = x[v[(k + 1) % 3]];
                lengths[count++] = hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
            }
        }
    }
    qsort(lengths, count, sizeof *lengths, compare_lengths);
    double median = lengths[count / 2];
    free(lengths);
    return median;
}

uint64_t bench_scene_triangles(const struct bench_scene *scene)
{
    uint64_t count = 0;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        count += scene->objects[i].triangle_count;
    }
    return count;
}

void bench_scene_free(struct bench_scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        free(scene->objects[i].triangles);
        free(scene->objects[i].edges);
        free(scene->objects[i].points);
    }
    free(scene->objects);
    if (scene->free_state) {
        scene->free_state(scene->state);
    }
    if (scene->before) {
        bench_scene_free(scene->before);
        free(scene->before);
    }
    memset(scene, 0, sizeof *scene);
}

void bench_frames_init(struct bench_frames *frames, const struct bench_scene *scene,
                       uint32_t from)
{
    uint32_t count = scene->vertex_count;
    if (scene->before && scene->before->vertex_count > count) {
        count = scene->before->vertex_count;
    }
    frames->told = scene;
    frames->scene = NULL;
    frames->from = NO_FRAME;
    for (int end = 0; end < 2; end++) {
        frames->x[end] = bench_scene_alloc(count, sizeof *frames->x[end]);
    }
    bench_frames_seek(frames, from);
}

void bench_frames_deinit(struct bench_frames *frames)
{
    free(frames->x[0]);
    free(frames->x[1]);
    memset(frames, 0, sizeof *frames);
}

void bench_frames_seek(struct bench_frames *frames, uint32_t from)
{
    const struct bench_scene *told = frames->told;
    const struct bench_scene *scene =
        told->before && from < told->break_frame ? told->before : told;
    if (from == frames->from) {
        return;
    }
    if (scene == frames->scene && from == frames->from + 1) {
        double(*start)[3] = frames->x[1];
        frames->x[1] = frames->x[0];
        frames->x[0] = start;
    } else {
        scene->place(scene, from, frames->x[0]);
    }
    scene->place(scene, from + 1, frames->x[1]);
    frames->scene = scene;
    frames->from = from;
}

/* ---- two frames of $PCCD_DATA ------------------------------------------------------ */

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
