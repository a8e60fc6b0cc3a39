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
#include "feature.h"
#include "memory.h"
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

/* Up to these ends, and that of the vertices. */
static int reserve_up_to(struct eng_scene *scene, uint32_t edge_end,
                         uint32_t triangle_end, uint32_t node_end)
{
    int status = reserve(&scene->vertices, sizeof *scene->vertices,
                         scene->vertex_ranges.end, &scene->box_capacity);
    if (status == ENG_OK) {
        status =
            reserve(&scene->edges, sizeof *scene->edges, edge_end, &scene->edge_capacity);
    }
    if (status == ENG_OK) {
        status = reserve(&scene->triangles, sizeof *scene->triangles, triangle_end,
                         &scene->triangle_capacity);
    }
    uint32_t upkeep_capacity = scene->node_capacity;
    if (status == ENG_OK) {
        status =
            reserve(&scene->upkeep, sizeof *scene->upkeep, node_end, &upkeep_capacity);
    }
    if (status == ENG_OK) {
        status =
            reserve(&scene->nodes, sizeof *scene->nodes, node_end, &scene->node_capacity);
    }
    return status;
}

int eng_tree_reserve(struct eng_scene *scene)
{
    return reserve_up_to(scene, scene->edge_ranges.end, scene->triangle_ranges.end,
                         scene->node_ranges.end);
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

/* The topology with global indices; first_edge: eng_feature_index. */
static void copy_in(struct eng_scene *scene, uint32_t object_idx,
                    const uint32_t *first_edge)
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
        const struct eng_face *face = &mesh->triangles[i];
        triangle->owns = face->owns;
        triangle->object = object_idx;
        for (int k = 0; k < 3; k++) {
            uint32_t edge =
                eng_feature_edge(mesh, first_edge, face->v[k], face->v[(k + 1) % 3]);
            triangle->v[k] = v0 + face->v[k];
            triangle->e[k] = edge == ENG_NO_EDGE ? ENG_NO_EDGE : e0 + edge;
        }
    }
    memset(scene->nodes + object->nodes.first, 0,
           object->nodes.count * sizeof *scene->nodes);
    for (uint32_t i = 0; i < object->nodes.count; i++) {
        scene->upkeep[object->nodes.first + i].object = object_idx;
    }
}

/* Boxes of all objects that have hierarchies, where the scene stands, in the frames that
 * they have now. The positions of a step that is staged already wait in the other buffer,
 * which is looked away from. */
static void refit_where_they_stand(struct eng_scene *scene, uint32_t first, uint32_t end)
{
    double(*staged)[3] = scene->x[1 - scene->now];
    scene->x[1 - scene->now] = scene->x[scene->now];
    for (uint32_t i = first; i < end; i++) {
        if (scene->objects[i].mesh && scene->objects[i].nodes.count > 0) {
            eng_refit_object(scene, &scene->objects[i]);
        }
    }
    scene->x[1 - scene->now] = staged;
}

static int plant(struct eng_scene *scene, uint32_t object_idx)
{
    struct eng_object *object = &scene->objects[object_idx];
    const struct eng_mesh *mesh = object->mesh;
    uint32_t *first_edge =
        eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *first_edge);
    if (!first_edge) {
        return ENG_E_NOMEM;
    }
    int status = take_all(scene, object);
    if (status == ENG_OK) {
        eng_feature_index(mesh, first_edge);
        copy_in(scene, object_idx, first_edge);
    }
    eng_free(first_edge);
    if (status == ENG_OK) {
        status = eng_build_object(scene, object_idx);
    }
    if (status != ENG_OK) {
        eng_object_fell(scene, object);
        return status;
    }
    refit_where_they_stand(scene, object_idx, object_idx + 1);
    eng_regions_mark(scene, object->nodes);
    eng_rebuild_note(scene, object->nodes);
    return ENG_OK;
}

/* At most what a range allocator hands out. */
static uint32_t end_of(const struct eng_ranges *ranges, uint64_t more)
{
    return more < ranges->limit - ranges->end ? ranges->end + (uint32_t)more
                                              : ranges->limit;
}

/* Room for all objects without a hierarchy, and for the nodes above them, at once: one by
 * one, each array would grow past what it needs. */
static int reserve_for(struct eng_scene *scene)
{
    uint64_t edges = 0;
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh && object->nodes.count == 0) {
            edges += object->mesh->info.edge_count;
            triangles += object->mesh->info.triangle_count;
        }
    }
    if (triangles == 0) {
        return ENG_OK;
    }
    return reserve_up_to(
        scene, end_of(&scene->edge_ranges, edges),
        end_of(&scene->triangle_ranges, triangles),
        end_of(&scene->node_ranges, 2 * triangles + scene->object_count));
}

int eng_plant_objects(struct eng_scene *scene)
{
    int status = reserve_for(scene);
    for (uint32_t i = 0; i < scene->object_capacity && status == ENG_OK; i++) {
        if (scene->objects[i].mesh && scene->objects[i].nodes.count == 0) {
            status = plant(scene, i);
        }
    }
    if (status == ENG_OK && (scene->framing.number != scene->tree_frames)) {
        /* Those that had a hierarchy before have boxes in other frames. */
        refit_where_they_stand(scene, 0, scene->object_capacity);
    }
    return status;
}
