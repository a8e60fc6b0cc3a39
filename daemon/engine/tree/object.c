/* object.c - the binary hierarchy of an object comes and goes.
 *
 * Room:     engine.
 * Does:     give an object its ranges of the flat arrays, copy its topology there with
 *           global indices, have its hierarchy built; take it all back.
 * Does not: build (build.c).
 * Threads:  [compute].
 */
#include <string.h>

#include "aside.h"
#include "build.h"
#include "rebuild.h"
#include "refit.h"
#include "step_memory.h"

static int take(struct eng_ranges *ranges, uint32_t count, struct eng_range *range)
{
    uint32_t first = 0;
    int status = count > 0 ? eng_ranges_take(ranges, count, &first) : ENG_OK;
    if (status == ENG_OK) {
        *range = (struct eng_range){first, count};
    }
    return status;
}

static void give(struct eng_ranges *ranges, struct eng_range *range)
{
    if (range->count > 0) {
        eng_ranges_give(ranges, range->first, range->count);
        range->count = 0;
    }
}

void eng_object_fell(struct eng_scene *scene, struct eng_object *object)
{
    eng_aside_forget(&scene->memory->aside, object->nodes);
    give(&scene->edge_ranges, &object->edges);
    give(&scene->triangle_ranges, &object->triangles);
    give(&scene->node_ranges, &object->nodes);
}

/* Grow one array up to `end`; *capacity is that of all that grow together. */
static int reserve(void *array, size_t bytes, uint32_t end, uint32_t *capacity)
{
    if (end <= *capacity) {
        return ENG_OK;
    }
    uint32_t more = eng_world_grown(*capacity, end);
    int status = eng_world_grow(array, more, bytes);
    *capacity = status == ENG_OK ? more : *capacity;
    return status;
}

int eng_tree_reserve(struct eng_scene *scene)
{
    int status = reserve(&scene->vertices, sizeof *scene->vertices,
                         scene->vertex_ranges.end, &scene->box_capacity);
    if (status == ENG_OK) {
        status = reserve(&scene->edges, sizeof *scene->edges, scene->edge_ranges.end,
                         &scene->edge_capacity);
    }
    if (status == ENG_OK) {
        status = reserve(&scene->triangles, sizeof *scene->triangles,
                         scene->triangle_ranges.end, &scene->triangle_capacity);
    }
    uint32_t upkeep_capacity = scene->node_capacity;
    if (status == ENG_OK) {
        status = reserve(&scene->upkeep, sizeof *scene->upkeep, scene->node_ranges.end,
                         &upkeep_capacity);
    }
    if (status == ENG_OK) {
        status = reserve(&scene->nodes, sizeof *scene->nodes, scene->node_ranges.end,
                         &scene->node_capacity);
    }
    return status;
}

static int take_all(struct eng_scene *scene, struct eng_object *object)
{
    const struct eng_mesh_info *info = &object->mesh->info;
    int status = take(&scene->edge_ranges, info->edge_count, &object->edges);
    if (status == ENG_OK) {
        status = take(&scene->triangle_ranges, info->triangle_count, &object->triangles);
    }
    if (status == ENG_OK) {
        /* 2n - 1 of n <= 2^31 - 1 fits. */
        status = take(&scene->node_ranges, 2 * info->triangle_count - 1, &object->nodes);
    }
    return status == ENG_OK ? eng_tree_reserve(scene) : status;
}

/* The topology with global indices. */
static void copy_in(struct eng_scene *scene, uint32_t object_idx)
{
    const struct eng_object *object = &scene->objects[object_idx];
    const struct eng_mesh *mesh = object->mesh;
    uint32_t v0 = object->vertices.first;
    uint32_t e0 = object->edges.first;
    memset(scene->vertices + v0, 0, object->vertices.count * sizeof *scene->vertices);
    for (uint32_t i = 0; i < object->vertices.count; i++) {
        scene->vertices[v0 + i].object = object_idx;
    }
    if (object->edges.count > 0) {
        memset(scene->edges + e0, 0, object->edges.count * sizeof *scene->edges);
    }
    for (uint32_t i = 0; i < object->edges.count; i++) {
        scene->edges[e0 + i].a = v0 + mesh->edges[i][0];
        scene->edges[e0 + i].b = v0 + mesh->edges[i][1];
        scene->edges[e0 + i].object = object_idx;
    }
    for (uint32_t i = 0; i < object->triangles.count; i++) {
        struct eng_triangle *triangle = &scene->triangles[object->triangles.first + i];
        *triangle = mesh->triangles[i];
        triangle->object = object_idx;
        for (int k = 0; k < 3; k++) {
            triangle->v[k] += v0;
            triangle->e[k] += triangle->e[k] == ENG_NO_EDGE ? 0 : e0;
        }
    }
    memset(scene->nodes + object->nodes.first, 0,
           object->nodes.count * sizeof *scene->nodes);
    for (uint32_t i = 0; i < object->nodes.count; i++) {
        scene->upkeep[object->nodes.first + i].object = object_idx;
    }
}

/* Boxes of an object where the scene stands. The positions of a step that is staged
 * already wait in the other buffer, which is looked away from. */
static void refit_where_it_stands(struct eng_scene *scene,
                                  const struct eng_object *object)
{
    double(*staged)[3] = scene->x[1 - scene->now];
    scene->x[1 - scene->now] = scene->x[scene->now];
    eng_refit_object(scene, object);
    scene->x[1 - scene->now] = staged;
}

static int plant(struct eng_scene *scene, uint32_t object_idx)
{
    struct eng_object *object = &scene->objects[object_idx];
    int status = take_all(scene, object);
    if (status == ENG_OK) {
        copy_in(scene, object_idx);
        status = eng_build_object(scene, object_idx);
    }
    if (status != ENG_OK) {
        eng_object_fell(scene, object);
        return status;
    }
    refit_where_it_stands(scene, object);
    eng_regions_mark(scene, object->nodes);
    eng_rebuild_note(scene, object->nodes);
    return ENG_OK;
}

int eng_plant_objects(struct eng_scene *scene)
{
    int status = ENG_OK;
    for (uint32_t i = 0; i < scene->object_capacity && status == ENG_OK; i++) {
        if (scene->objects[i].mesh && scene->objects[i].nodes.count == 0) {
            status = plant(scene, i);
        }
    }
    return status;
}
