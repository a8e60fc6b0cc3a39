/* daemon/engine/near/closest_features.c - the features between which a distance is.
 *
 * Room:     engine.
 * Does:     see closest_features.h.
 * Threads:  [team].
 */
#include "closest_features.h"

#include <assert.h>
#include <string.h>

#include "kinds.h"

/* The edge between two vertices, which has one: edges are in the order of (higher, lower)
 * vertex. */
static uint32_t edge_between(const struct eng_mesh *mesh, uint32_t v, uint32_t w)
{
    uint32_t low_end = v < w ? v : w;
    uint32_t high_end = v < w ? w : v;
    uint32_t low = 0;
    uint32_t high = mesh->info.edge_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        const uint32_t *edge = mesh->edges[middle];
        bool is_below = edge[1] != high_end ? edge[1] < high_end : edge[0] < low_end;
        low = is_below ? middle + 1 : low;
        high = is_below ? high : middle;
    }
    assert(mesh->edges[low][0] == low_end && mesh->edges[low][1] == high_end);
    return low;
}

/* A point of a pair: its side, 0: of a, 1: of b, and what it is. */
struct point {
    uint32_t side;
    const struct eng_point *is;
};

static uint32_t id_of(const struct point *point)
{
    return (uint32_t)(point->is->word1 >> 32);
}

/* Vertex of its object's mesh. */
static uint32_t local_of(const struct point *point)
{
    return (uint32_t)point->is->word1;
}

/* The points of the pair that the distance is between, those of a first. */
static void list_points(enum pccd_kind kind, const struct eng_point *const all[4],
                        uint32_t bits, struct point points[4])
{
    uint32_t of_a = common_kinds[kind].points[0];
    for (; bits != 0; bits &= bits - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(bits);
        *points++ = (struct point){i >= of_a, all[i]};
    }
}

static void turn(struct eng_distance *at)
{
    for (int k = 0; k < 3; k++) {
        at->direction[k] = 0.0 - at->direction[k];
    }
}

/* Two vertices. */
static void name_vertices(const struct point points[2], struct pccd_pair *closest,
                          struct eng_distance *at)
{
    bool is_turned = points[0].is->word1 > points[1].is->word1;
    const struct point *first = &points[is_turned];
    const struct point *second = &points[!is_turned];
    *closest = (struct pccd_pair){PCCD_VV, id_of(first), local_of(first), id_of(second),
                                  local_of(second)};
    at->param[0] = 0;
    at->param[1] = 0;
    if (is_turned) {
        turn(at);
    }
}

/* Where the foot is along the pair's edge, or along a side of its face, from the first of
 * the two ends in the order of the pair: what is said of the pair, as that is a function
 * of the vertex and the edge alone. It is a multiple of 2^-32, halves to even, so that 1
 * less it is the position from the other end. */
static double position_along(const struct pccd_pair *pair,
                             const struct eng_distance *distance, uint32_t side)
{
    if (pair->kind == PCCD_EE) {
        return distance->param[side];
    }
    uint32_t corners = distance->points >> 1; /* the lowest bit is the vertex's */
    return distance->param[corners == 3 ? 0 : 1];
}

/* The edge with these ends: the pair's own, or a side of its face. */
static uint32_t edge_of(const struct eng_scene *scene, const struct pccd_pair *pair,
                        const struct point ends[2])
{
    if (pair->kind == PCCD_EE) {
        return ends[0].side == 0 ? pair->feature_a : pair->feature_b;
    }
    const struct eng_mesh *mesh = scene->objects[ends[0].is->word0 >> 32].mesh;
    return edge_between(mesh, local_of(&ends[0]), local_of(&ends[1]));
}

/* A vertex and an edge: the two points of one side are the edge's. */
static void name_edge(const struct eng_scene *scene, const struct pccd_pair *pair,
                      const struct eng_distance *distance, const struct point points[3],
                      struct pccd_pair *closest, struct eng_distance *at)
{
    bool is_first = points[0].side != points[1].side; /* the vertex is of a */
    const struct point *vertex = &points[is_first ? 0 : 2];
    const struct point *ends = &points[is_first ? 1 : 0];
    uint32_t side = ends[0].side;
    assert(side == ends[1].side && vertex->side != side);
    uint32_t edge = edge_of(scene, pair, ends);
    *closest = (struct pccd_pair){PCCD_VE, id_of(vertex), local_of(vertex),
                                  id_of(&ends[0]), edge};
    double position = position_along(pair, distance, side);
    at->param[0] = 0;
    /* The points are in the order of the pair's feature, the edge begins at the lower. */
    at->param[1] = local_of(&ends[0]) < local_of(&ends[1]) ? position : 1 - position;
    if (!is_first) {
        turn(at);
    }
}

void eng_closest_features(const struct eng_scene *scene, const struct pccd_pair *pair,
                          const struct eng_point *const all[4],
                          const struct eng_distance *distance, struct pccd_pair *closest,
                          struct eng_distance *at)
{
    struct point points[4];
    *at = *distance;
    *closest = *pair;
    switch (distance->type) {
    case ENG_NEAREST_VV:
        list_points(pair->kind, all, distance->points, points);
        name_vertices(points, closest, at);
        break;
    case ENG_NEAREST_VE:
        list_points(pair->kind, all, distance->points, points);
        name_edge(scene, pair, distance, points, closest, at);
        break;
    default: /* all points of the pair */
        assert((uint32_t)distance->type == pair->kind);
    }
}
