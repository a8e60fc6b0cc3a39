/* object.c - the binary hierarchy of an object comes and goes. */
#include <assert.h>
#include <string.h>

#include "array.h"
#include "build.h"
#include "feature.h"
#include "memory.h"
#include "rebuild.h"
#include "refit.h"

static int take(struct eng_ranges *ranges, uint32_t count, struct eng_range *range)
{
    uint32_t first = 0;
    int status = count > 0 ? eng_ranges_take(ranges, count, &first) : PCCD_OK;
    if (status == PCCD_OK) {
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
    struct eng_trees *trees = eng_trees_of(scene);
    struct eng_planted *planted = object->slots[ENG_SLOT_PAPER];
    if (planted) {
        give(&trees->edge_ranges, &planted->edges);
        give(&trees->triangle_ranges, &planted->triangles);
        give(&trees->node_ranges, &planted->nodes);
        eng_free(planted);
        object->slots[ENG_SLOT_PAPER] = NULL;
    }
}

/* Grow one array up to `end`; *capacity is that of all that grow together. */
static int reserve(void *array, size_t bytes, uint32_t end, uint32_t *capacity)
{
    if (end <= *capacity) {
        return PCCD_OK;
    }
    uint32_t more = eng_array_grown(*capacity, end);
    int status = eng_array_grow(array, more, bytes);
    *capacity = status == PCCD_OK ? more : *capacity;
    return status;
}

/* Up to these ends, and that of the vertices. */
static int reserve_up_to(struct eng_scene *scene, uint32_t edge_end,
                         uint32_t triangle_end, uint32_t node_end)
{
    struct eng_trees *trees = eng_trees_of(scene);
    int status = reserve(&trees->vertices, sizeof *trees->vertices,
                         scene->vertex_ranges.end, &trees->box_capacity);
    if (status == PCCD_OK) {
        status =
            reserve(&trees->edges, sizeof *trees->edges, edge_end, &trees->edge_capacity);
    }
    if (status == PCCD_OK) {
        status = reserve(&trees->triangles, sizeof *trees->triangles, triangle_end,
                         &trees->triangle_capacity);
    }
    uint32_t upkeep_capacity = trees->node_capacity;
    if (status == PCCD_OK) {
        status =
            reserve(&trees->upkeep, sizeof *trees->upkeep, node_end, &upkeep_capacity);
    }
    if (status == PCCD_OK) {
        status =
            reserve(&trees->nodes, sizeof *trees->nodes, node_end, &trees->node_capacity);
    }
    return status;
}

int eng_tree_reserve(struct eng_scene *scene)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    return reserve_up_to(scene, trees->edge_ranges.end, trees->triangle_ranges.end,
                         trees->node_ranges.end);
}

/* Whatever was taken when this fails, eng_object_fell gives back. */
static int take_all(struct eng_scene *scene, struct eng_object *object)
{
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_mesh_info *info = &object->mesh->info;
    struct eng_planted *planted = eng_alloc(1, sizeof *planted);
    if (!planted) {
        return PCCD_E_NOMEM;
    }
    *planted = (struct eng_planted){0};
    object->slots[ENG_SLOT_PAPER] = planted;
    int status = take(&trees->edge_ranges, info->edge_count, &planted->edges);
    if (status == PCCD_OK) {
        status =
            take(&trees->triangle_ranges, object->mesh->leaf_count, &planted->triangles);
    }
    if (status == PCCD_OK) {
        /* 2n - 1 of n <= 2^31 - 1 fits. */
        status =
            take(&trees->node_ranges, 2 * object->mesh->leaf_count - 1, &planted->nodes);
    }
    return status == PCCD_OK ? eng_tree_reserve(scene) : status;
}

/* The topology with global indices; first_edge: eng_feature_index. */
static void copy_in(struct eng_scene *scene, uint32_t object_idx,
                    const uint32_t *first_edge)
{
    assert(scene->objects[object_idx].mesh);
    struct eng_trees *trees = eng_trees_of(scene);
    const struct eng_object *object = &scene->objects[object_idx];
    const struct eng_mesh *mesh = object->mesh;
    const struct eng_planted *planted = eng_planted_of(object);
    uint32_t v0 = object->vertices.first;
    uint32_t e0 = planted->edges.first;
    memset(trees->vertices + v0, 0, object->vertices.count * sizeof *trees->vertices);
    for (uint32_t i = 0; i < object->vertices.count; i++) {
        trees->vertices[v0 + i].object = object_idx;
    }
    if (planted->edges.count > 0) {
        memset(trees->edges + e0, 0, planted->edges.count * sizeof *trees->edges);
    }
    for (uint32_t i = 0; i < planted->edges.count; i++) {
        trees->edges[e0 + i].a = v0 + mesh->edges[i][0];
        trees->edges[e0 + i].b = v0 + mesh->edges[i][1];
        trees->edges[e0 + i].object = object_idx;
    }
    for (uint32_t i = 0; i < planted->triangles.count; i++) {
        struct eng_triangle *triangle = &trees->triangles[planted->triangles.first + i];
        const struct eng_face *face = &mesh->leaves[i];
        triangle->owns = face->owns;
        triangle->object = object_idx;
        for (int k = 0; k < 3; k++) {
            uint32_t edge =
                eng_feature_edge(mesh, first_edge, face->v[k], face->v[(k + 1) % 3]);
            triangle->v[k] = v0 + face->v[k];
            triangle->e[k] = edge == ENG_NO_EDGE ? ENG_NO_EDGE : e0 + edge;
            if (eng_mesh_is_foreign(mesh, PCCD_TREE_VERTICES, face->v[k])) {
                triangle->owns |= ENG_FOREIGN_VERTEX(k);
            }
            if (edge != ENG_NO_EDGE && eng_mesh_is_foreign(mesh, PCCD_TREE_EDGES, edge)) {
                triangle->owns |= ENG_FOREIGN_EDGE(k);
            }
        }
    }
    memset(trees->nodes + planted->nodes.first, 0,
           planted->nodes.count * sizeof *trees->nodes);
    for (uint32_t i = 0; i < planted->nodes.count; i++) {
        trees->upkeep[planted->nodes.first + i].object = object_idx;
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
        if (eng_planted_of(&scene->objects[i])->nodes.count > 0) {
            eng_refit_object(scene, &scene->objects[i]);
        }
    }
    scene->x[1 - scene->now] = staged;
}

static int plant(struct eng_scene *scene, uint32_t object_idx)
{
    assert(!scene->objects[object_idx].slots[ENG_SLOT_PAPER]);
    struct eng_object *object = &scene->objects[object_idx];
    const struct eng_mesh *mesh = object->mesh;
    uint32_t *first_edge =
        eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *first_edge);
    if (!first_edge) {
        return PCCD_E_NOMEM;
    }
    int status = take_all(scene, object);
    if (status == PCCD_OK) {
        eng_feature_index(mesh, first_edge);
        copy_in(scene, object_idx, first_edge);
    }
    eng_free(first_edge);
    if (status == PCCD_OK) {
        status = eng_build_object(scene, object_idx);
    }
    if (status != PCCD_OK) {
        eng_object_fell(scene, object);
        return status;
    }
    if (eng_mesh_has_foreign(mesh)) {
        eng_trees_of(scene)->has_foreign = true;
        eng_foreign_mark(eng_trees_of(scene), eng_planted_of(object)->nodes);
    }
    refit_where_they_stand(scene, object_idx, object_idx + 1);
    if (!object->is_new) { /* it may stand, and have moved in the step before */
        eng_trees_of(scene)->boxes_of = 0;
    }
    eng_regions_mark(scene, eng_planted_of(object)->nodes);
    eng_rebuild_note(scene, eng_planted_of(object)->nodes);
    return PCCD_OK;
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
    struct eng_trees *trees = eng_trees_of(scene);
    uint64_t edges = 0;
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        const struct eng_object *object = &scene->objects[i];
        if (object->mesh && eng_planted_of(object)->nodes.count == 0) {
            edges += object->mesh->info.edge_count;
            triangles += object->mesh->leaf_count;
        }
    }
    if (triangles == 0) {
        return PCCD_OK;
    }
    return reserve_up_to(
        scene, end_of(&trees->edge_ranges, edges),
        end_of(&trees->triangle_ranges, triangles),
        end_of(&trees->node_ranges, 2 * triangles + scene->object_count));
}

int eng_plant_objects(struct eng_scene *scene)
{
    struct eng_trees *trees = eng_trees_of(scene);
    int status = reserve_for(scene);
    for (uint32_t i = 0; i < scene->object_capacity && status == PCCD_OK; i++) {
        if (scene->objects[i].mesh &&
            eng_planted_of(&scene->objects[i])->nodes.count == 0) {
            status = plant(scene, i);
        }
    }
    if (status == PCCD_OK && (scene->framing.number != trees->frames)) {
        /* Those that had a hierarchy before have boxes in other frames. */
        trees->boxes_of = 0;
        refit_where_they_stand(scene, 0, scene->object_capacity);
    }
    return status;
}
