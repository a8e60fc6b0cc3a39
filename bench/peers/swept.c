/* swept.c - the swept boxes of a scene's step. */
#include "steps.h"

#include <stdlib.h>
#include <string.h>

#include "aabb.h"
#include "report.h"
#include "trees.h"
#include "world.h"

static void list_init(struct peer_features *features, uint32_t count)
{
    features->count = count;
    features->boxes = bench_alloc(count, sizeof *features->boxes);
    features->corners = bench_alloc(count, sizeof *features->corners);
}

static void add_point(struct peer_box *box, const double x[3])
{
    for (int k = 0; k < 3; k++) {
        float lo = eng_round_down(x[k]);
        float hi = eng_round_up(x[k]);
        box->lo[k] = lo < box->lo[k] ? lo : box->lo[k];
        box->hi[k] = hi > box->hi[k] ? hi : box->hi[k];
    }
}

/* Corners are in place. */
static void place(struct peer_features *features, const struct eng_scene *scene)
{
    for (uint32_t i = 0; i < features->count; i++) {
        struct peer_box *box = &features->boxes[i];
        *box = (struct peer_box){{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}};
        for (int corner = 0; corner < 3; corner++) {
            add_point(box, scene->x[0][features->corners[i][corner]]);
            add_point(box, scene->x[1][features->corners[i][corner]]);
        }
    }
}

void peers_swept_init(struct peer_input *input, const struct bench_world *world)
{
    const struct eng_scene *scene = world->scene;
    uint32_t counts[3] = {0, 0, 0};
    for (uint32_t i = 0; i < world->source->object_count; i++) {
        const struct eng_object *object = eng_scene_object(scene, world->object_idx[i]);
        counts[0] += object->vertices.count;
        counts[1] += eng_paper_object_of(object)->edges.count;
        counts[2] += eng_paper_object_of(object)->triangles.count;
    }
    /* Objects that only ever come lie one after the other. */
    list_init(&input->vertices, counts[0]);
    list_init(&input->edges, counts[1]);
    list_init(&input->faces, counts[2]);
    for (uint32_t i = 0; i < counts[0]; i++) {
        uint32_t corners[3] = {i, i, i};
        memcpy(input->vertices.corners[i], corners, sizeof corners);
    }
    for (uint32_t i = 0; i < counts[1]; i++) {
        const struct eng_edge *edge = &eng_trees_of(scene)->edges[i];
        uint32_t corners[3] = {edge->a, edge->b, edge->b};
        memcpy(input->edges.corners[i], corners, sizeof corners);
    }
    for (uint32_t i = 0; i < counts[2]; i++) {
        memcpy(input->faces.corners[i], eng_trees_of(scene)->triangles[i].v,
               3 * sizeof(uint32_t));
    }
    place(&input->vertices, scene);
    place(&input->edges, scene);
    place(&input->faces, scene);
}

static void list_deinit(struct peer_features *features)
{
    free(features->boxes);
    free(features->corners);
}

void peers_swept_deinit(struct peer_input *input)
{
    list_deinit(&input->vertices);
    list_deinit(&input->edges);
    list_deinit(&input->faces);
}

uint32_t peers_index(const struct bench_world *world, uint32_t points, uint32_t object_id,
                     uint32_t feature)
{
    uint32_t object_idx = world->object_idx[BENCH_OBJECT_OF(object_id)];
    return eng_feature_first(&world->scene->objects[object_idx], points) + feature;
}
