/* swept.c - the swept boxes of a scene's step. */
#include "steps.h"

#include <stdlib.h>
#include <string.h>

#include "aabb.h"
#include "report.h"
#include "trees.h"
#include "world.h"

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
    uint32_t counts[PEER_GROUPS] = {0};
    for (uint32_t i = 0; i < world->source->object_count; i++) {
        const struct eng_object *object = eng_scene_object(scene, world->object_idx[i]);
        counts[PEER_VERTICES] += object->vertices.count;
        counts[PEER_EDGES] += eng_paper_object_of(object)->edges.count;
        counts[PEER_FACES] += eng_paper_object_of(object)->triangles.count;
    }
    /* Objects that only ever come lie one after the other. */
    struct peer_features *groups = input->groups;
    for (int i = 0; i < PEER_GROUPS; i++) {
        groups[i].count = counts[i];
        groups[i].boxes = bench_alloc(counts[i], sizeof *groups[i].boxes);
        groups[i].corners = bench_alloc(counts[i], sizeof *groups[i].corners);
    }
    for (uint32_t i = 0; i < counts[PEER_VERTICES]; i++) {
        uint32_t corners[3] = {i, i, i};
        memcpy(groups[PEER_VERTICES].corners[i], corners, sizeof corners);
    }
    for (uint32_t i = 0; i < counts[PEER_EDGES]; i++) {
        const struct eng_edge *edge = &eng_trees_of(scene)->edges[i];
        uint32_t corners[3] = {edge->a, edge->b, edge->b};
        memcpy(groups[PEER_EDGES].corners[i], corners, sizeof corners);
    }
    for (uint32_t i = 0; i < counts[PEER_FACES]; i++) {
        memcpy(groups[PEER_FACES].corners[i], eng_trees_of(scene)->triangles[i].v,
               3 * sizeof(uint32_t));
    }
    for (int i = 0; i < PEER_GROUPS; i++) {
        place(&groups[i], scene);
    }
}

void peers_swept_deinit(struct peer_input *input)
{
    for (int i = 0; i < PEER_GROUPS; i++) {
        free(input->groups[i].boxes);
        free(input->groups[i].corners);
    }
}

uint32_t peers_index(const struct bench_world *world, uint32_t points, uint32_t object_id,
                     uint32_t feature)
{
    uint32_t object_idx = world->object_idx[BENCH_OBJECT_OF(object_id)];
    return eng_feature_first(&world->scene->objects[object_idx], points) + feature;
}
