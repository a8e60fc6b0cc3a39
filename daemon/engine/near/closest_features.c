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

/* Local vertices of a feature of so many points; in the order of the mesh. */
static void local_points(const struct eng_mesh *mesh, uint32_t points, uint32_t feature,
                         uint32_t *v)
{
    switch (points) {
    case 1:
        v[0] = feature;
        break;
    case 2:
        memcpy(v, mesh->edges[feature], 2 * sizeof *v);
        break;
    default:
        assert(points == 3);
        memcpy(v, mesh->triangles[feature].v, 3 * sizeof *v);
    }
}

uint32_t eng_closest_points(const struct eng_scene *scene,
                            const struct eng_near_name *name, uint32_t vertex[5])
{
    const uint32_t *points = common_kinds[name->pair.kind].points;
    const uint32_t feature[2] = {name->pair.feature_a, name->pair.feature_b};
    uint32_t count = 0;
    for (int side = 0; side < 2; side++) {
        const struct eng_object *object = &scene->objects[name->object[side]];
        local_points(object->mesh, points[side], feature[side], vertex + count);
        for (uint32_t i = 0; i < points[side]; i++) {
            vertex[count++] += object->vertices.first;
        }
    }
    return count;
}

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

/* A point of a pair. */
struct point {
    uint32_t side;  /* 0: of a, 1: of b */
    uint32_t local; /* vertex of its object's mesh */
};

/* The points of the pair that the distance is between, those of a first. */
static uint32_t list_points(const struct eng_scene *scene,
                            const struct eng_near_name *name, uint32_t bits,
                            struct point points[4])
{
    uint32_t vertex[5];
    uint32_t all = eng_closest_points(scene, name, vertex);
    uint32_t of_a = common_kinds[name->pair.kind].points[0];
    uint32_t count = 0;
    for (uint32_t i = 0; i < all; i++) {
        if (bits >> i & 1) {
            uint32_t side = i >= of_a;
            uint32_t first = scene->objects[name->object[side]].vertices.first;
            points[count++] = (struct point){side, vertex[i] - first};
        }
    }
    return count;
}

static uint32_t id_of(const struct eng_near_name *name, uint32_t side)
{
    return side == 0 ? name->pair.object_a : name->pair.object_b;
}

static void turn(struct eng_distance *at)
{
    for (int k = 0; k < 3; k++) {
        at->direction[k] = 0.0 - at->direction[k];
    }
}

/* Two vertices. */
static void name_vertices(const struct eng_near_name *name, const struct point points[2],
                          struct pccd_pair *closest, struct eng_distance *at)
{
    uint32_t id[2] = {id_of(name, points[0].side), id_of(name, points[1].side)};
    bool is_turned = id[0] != id[1] ? id[0] > id[1] : points[0].local > points[1].local;
    uint32_t first = is_turned;
    uint32_t second = !is_turned;
    *closest = (struct pccd_pair){PCCD_VV, id[first], points[first].local, id[second],
                                  points[second].local};
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
static double position_along(const struct eng_near_name *name,
                             const struct eng_distance *distance, uint32_t side)
{
    if (name->pair.kind == PCCD_EE) {
        return distance->param[side];
    }
    uint32_t corners = distance->points >> 1; /* the lowest bit is the vertex's */
    return distance->param[corners == 3 ? 0 : 1];
}

/* A vertex and an edge: the two points of one side are the edge's. */
static void name_edge(const struct eng_scene *scene, const struct eng_near_name *name,
                      const struct eng_distance *distance, const struct point points[3],
                      struct pccd_pair *closest, struct eng_distance *at)
{
    bool is_first = points[0].side != points[1].side; /* the vertex is of a */
    const struct point *vertex = &points[is_first ? 0 : 2];
    const struct point *ends = &points[is_first ? 1 : 0];
    uint32_t side = ends[0].side;
    assert(side == ends[1].side && vertex->side != side);
    const struct eng_mesh *mesh = scene->objects[name->object[side]].mesh;
    uint32_t edge = edge_between(mesh, ends[0].local, ends[1].local);
    *closest = (struct pccd_pair){PCCD_VE, id_of(name, vertex->side), vertex->local,
                                  id_of(name, side), edge};
    double position = position_along(name, distance, side);
    at->param[0] = 0;
    /* The points are in the order of the pair's feature, the edge begins at the lower. */
    at->param[1] = ends[0].local < ends[1].local ? position : 1 - position;
    if (!is_first) {
        turn(at);
    }
}

void eng_closest_features(const struct eng_scene *scene, const struct eng_near_name *name,
                          const struct eng_distance *distance, struct pccd_pair *closest,
                          struct eng_distance *at)
{
    struct point points[4];
    *at = *distance;
    *closest = name->pair;
    switch (distance->type) {
    case ENG_NEAREST_VV:
        list_points(scene, name, distance->points, points);
        name_vertices(name, points, closest, at);
        break;
    case ENG_NEAREST_VE:
        list_points(scene, name, distance->points, points);
        name_edge(scene, name, distance, points, closest, at);
        break;
    default: /* all points of the pair */
        assert((uint32_t)distance->type == name->pair.kind);
    }
}
