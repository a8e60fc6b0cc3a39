/* closest_features.c - the features between which a distance is. */
#include <assert.h>

#include "narrow.h"

static uint32_t find_edge(struct eng_edges_known *known, const struct eng_mesh *mesh,
                          uint32_t v, uint32_t w)
{
    uint32_t low_end = v < w ? v : w;
    uint32_t high_end = v < w ? w : v;
    struct eng_edge_known *at =
        &known->at[(low_end * 3 + high_end * 5) % ENG_EDGES_KNOWN];
    if (at->mesh != mesh || at->low_end != low_end || at->high_end != high_end) {
        *at = (struct eng_edge_known){mesh, low_end, high_end,
                                      eng_mesh_edge(mesh, low_end, high_end)};
    }
    return at->edge;
}

static uint32_t id_of(const struct eng_point *point)
{
    return (uint32_t)(point->word1 >> 32);
}

/* Vertex of its object's mesh. */
static uint32_t local_of(const struct eng_point *point)
{
    return (uint32_t)point->word1;
}

static void turn(struct eng_distance *at, bool is_turned)
{
    for (int k = 0; k < 3; k++) {
        const double ways[2] = {at->direction[k], 0.0 - at->direction[k]};
        at->direction[k] = ways[is_turned];
    }
}

/* Two vertices, in the order of the pair. */
static void name_vertices(const struct eng_point *a, const struct eng_point *b,
                          struct pccd_pair *name, struct eng_distance *at)
{
    const struct eng_point *const both[2] = {a, b};
    bool is_turned = a->word1 > b->word1;
    const struct eng_point *first = both[is_turned];
    const struct eng_point *second = both[!is_turned];
    *name = (struct pccd_pair){PCCD_VV, id_of(first), local_of(first), id_of(second),
                               local_of(second)};
    at->param[0] = 0;
    at->param[1] = 0;
    turn(at, is_turned);
}

/* A vertex and an edge. `position`: of the foot, from the first of the ends, in the order
 * of the pair, as it is said of the pair: a function of the vertex and the edge alone,
 * and a multiple of 2^-32, halves to even, so that 1 less it is the position from the
 * other end, which an edge begins at if that is the lower one. */
static void name_edge(const struct eng_point *vertex,
                      const struct eng_point *const end[2], uint32_t edge,
                      double position, struct pccd_pair *name, struct eng_distance *at)
{
    const double positions[2] = {position, 1 - position};
    *name =
        (struct pccd_pair){PCCD_VE, id_of(vertex), local_of(vertex), id_of(end[0]), edge};
    at->param[0] = 0;
    at->param[1] = positions[local_of(end[0]) > local_of(end[1])];
}

/* The vertex of a pair of VF and a side of its face. */
static void name_side(const struct eng_scene *scene, struct eng_edges_known *known,
                      const struct eng_point *const all[4], struct pccd_pair *name,
                      struct eng_distance *at)
{
    uint32_t corners = at->points >> 1;
    const struct eng_point *const end[2] = {all[corners == 6 ? 2 : 1],
                                            all[corners == 3 ? 2 : 3]};
    const struct eng_mesh *mesh = scene->objects[end[0]->word0 >> 32].mesh;
    name_edge(all[0], end, find_edge(known, mesh, local_of(end[0]), local_of(end[1])),
              at->param[corners != 3], name, at);
}

/* An end of edge `side` of a pair of EE and the other edge. */
static void name_end(const struct eng_point *const all[4], uint32_t side,
                     struct pccd_pair *name, struct eng_distance *at)
{
    uint32_t is_second = at->points >> (2 * side + 1) & 1; /* of the ends */
    const struct eng_point *const *end = all + 2 * (1 - side);
    name_edge(all[2 * side + is_second], end,
              side == 0 ? name->feature_b : name->feature_a, at->param[1 - side], name,
              at);
    turn(at, side == 1);
}

/* Which of several namings a pair is for; else it is its own closest features. */
enum naming { VERTICES, OF_FIRST, OF_SECOND, NAMINGS };

struct namings {
    uint32_t count[NAMINGS + 1];
    uint16_t pair[NAMINGS + 1][ENG_CHUNK_MAX];
};

static void tell_apart(enum pccd_kind kind, const struct eng_distance *distances,
                       uint32_t count, struct namings *namings)
{
    static_assert(ENG_NEAREST_VF == 0 && ENG_NEAREST_EE == 1 && ENG_NEAREST_VE == 2 &&
                      ENG_NEAREST_VV == 3,
                  "a table");
    static const uint8_t naming_of[4][2] = {{NAMINGS, NAMINGS},
                                            {NAMINGS, NAMINGS},
                                            {OF_FIRST, OF_SECOND},
                                            {VERTICES, VERTICES}};
    for (uint32_t i = 0; i <= NAMINGS; i++) {
        namings->count[i] = 0;
    }
    for (uint32_t i = 0; i < count; i++) {
        bool of_second = kind == PCCD_EE && (distances[i].points & 3) == 3;
        uint32_t naming = naming_of[distances[i].type][of_second];
        if (kind == PCCD_VE && naming == OF_FIRST) {
            naming = NAMINGS; /* it is named already */
        }
        namings->pair[naming][namings->count[naming]++] = (uint16_t)i;
    }
}

void eng_closest_features(struct eng_worker *worker, const struct eng_pairs *pairs)
{
    struct eng_narrow_near *work = worker->narrow->near;
    struct eng_batch *batch = &worker->narrow->batch;
    const enum pccd_kind kind = (enum pccd_kind)pairs->kind;
    struct namings namings;
    assert(batch->found <= ENG_CHUNK_MAX && kind <= PCCD_VV);
    tell_apart(kind, batch->near, batch->found, &namings);
    for (enum naming naming = VERTICES; naming < NAMINGS; naming++) {
        for (uint32_t k = 0; k < namings.count[naming]; k++) {
            uint32_t i = namings.pair[naming][k];
            const uint32_t *quad = pairs->quads[batch->index[i]];
            struct eng_distance *at = &batch->near[i];
            struct pccd_pair *name = &work->names[i];
            const struct eng_point *const all[4] = {
                &pairs->points[quad[0]], &pairs->points[quad[1]], &pairs->points[quad[2]],
                &pairs->points[quad[3]]};
            if (naming == VERTICES) {
                name_vertices(all[__builtin_ctz(at->points)],
                              all[31 - __builtin_clz(at->points)], name, at);
            } else if (kind == PCCD_VF) {
                name_side(worker->scene, &work->edges, all, name, at);
            } else {
                name_end(all, naming == OF_SECOND, name, at);
            }
        }
    }
}
