/* oracle_features.c - the vertices, edges and faces of a scene. */
#include "oracle_near.h"

#include <stdlib.h>
#include <string.h>

void *oracle_grow(void *block, size_t bytes)
{
    block = realloc(block, bytes);
    if (!block) {
        abort();
    }
    return block;
}

static struct oracle_feature *add_feature(struct oracle_features *features,
                                          const struct oracle_object *objects,
                                          uint32_t object, uint32_t index,
                                          const uint32_t *v, uint32_t points)
{
    if (features->count == features->capacity) {
        features->capacity = features->capacity ? 2 * features->capacity : 256;
        features->items =
            oracle_grow(features->items, features->capacity * sizeof *features->items);
    }
    struct oracle_feature *feature = &features->items[features->count++];
    feature->object = object;
    feature->index = index;
    feature->points = points;
    feature->is_free = false;
    for (uint32_t i = 0; i < points; i++) {
        const double *ends[2] = {objects[object].x0[v[i]], objects[object].x1[v[i]]};
        feature->v[i] = v[i];
        for (int k = 0; k < 6; k++) {
            double x = ends[k / 3][k % 3];
            if ((i == 0 && k < 3) || x < feature->lo[k % 3]) {
                feature->lo[k % 3] = x;
            }
            if ((i == 0 && k < 3) || x > feature->hi[k % 3]) {
                feature->hi[k % 3] = x;
            }
        }
    }
    return feature;
}

static int compare_edges(const void *a, const void *b)
{
    const uint32_t *left = a;
    const uint32_t *right = b;
    for (int i = 1; i >= 0; i--) {
        if (left[i] != right[i]) {
            return left[i] < right[i] ? -1 : 1;
        }
    }
    return 0;
}

uint32_t (*oracle_edges(const struct oracle_object *object, uint32_t *count))[2]
{
    uint32_t sides = object->triangle_count * 3;
    uint32_t(*edges)[2] =
        oracle_grow(NULL, ((size_t)sides + object->edge_count + 1) * sizeof *edges);
    uint32_t n = 0;
    for (uint32_t i = 0; i < sides + object->edge_count; i++) {
        const uint32_t *named = i < sides ? NULL : object->edges[i - sides];
        uint32_t a = named ? named[0] : object->triangles[i / 3][i % 3];
        uint32_t b = named ? named[1] : object->triangles[i / 3][(i % 3 + 1) % 3];
        if (a != b) {
            edges[n][0] = a < b ? a : b;
            edges[n++][1] = a < b ? b : a;
        }
    }
    qsort(edges, n, sizeof *edges, compare_edges);
    *count = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (*count == 0 || compare_edges(edges[i], edges[*count - 1]) != 0) {
            memmove(edges[(*count)++], edges[i], sizeof *edges);
        }
    }
    return edges;
}

static void add_vertices(const struct oracle_object *objects, uint32_t at,
                         struct oracle_features *vertices)
{
    const struct oracle_object *object = &objects[at];
    enum { UNUSED, POINT, PART }; /* a point, or a part of something */
    uint8_t *use = calloc((size_t)object->vertex_count + 1, sizeof *use);
    if (!use) {
        abort();
    }
    for (uint32_t i = 0; i < object->point_count; i++) {
        use[object->points[i]] = POINT;
    }
    for (uint32_t i = 0; i < object->edge_count; i++) {
        use[object->edges[i][0]] = POINT; /* of one without another end */
    }
    for (uint32_t i = 0; i < object->edge_count; i++) {
        for (int k = 0; object->edges[i][0] != object->edges[i][1] && k < 2; k++) {
            use[object->edges[i][k]] = PART;
        }
    }
    for (uint32_t i = 0; i < 3 * object->triangle_count; i++) {
        use[object->triangles[i / 3][i % 3]] = PART;
    }
    for (uint32_t i = 0; i < object->vertex_count; i++) {
        if (use[i] != UNUSED) {
            add_feature(vertices, objects, at, i, &i, 1)->is_free = use[i] == POINT;
        }
    }
    free(use);
}

static void add_edges(const struct oracle_object *objects, uint32_t at,
                      struct oracle_features *edges)
{
    struct oracle_object triangles_alone = objects[at];
    uint32_t edge_count;
    uint32_t side_count;
    triangles_alone.edge_count = 0;
    uint32_t(*pairs)[2] = oracle_edges(&objects[at], &edge_count);
    uint32_t(*sides)[2] = oracle_edges(&triangles_alone, &side_count);
    for (uint32_t i = 0; i < edge_count; i++) {
        bool is_side = side_count > 0 && bsearch(pairs[i], sides, side_count,
                                                 sizeof *sides, compare_edges) != NULL;
        add_feature(edges, objects, at, i, pairs[i], 2)->is_free = !is_side;
    }
    free(pairs);
    free(sides);
}

static void add_faces(const struct oracle_object *objects, uint32_t at,
                      struct oracle_features *faces)
{
    for (uint32_t i = 0; i < objects[at].triangle_count; i++) {
        add_feature(faces, objects, at, i, objects[at].triangles[i], 3);
    }
}

void oracle_features_list(const struct oracle_object *objects, uint32_t object_count,
                          uint32_t points, struct oracle_features *features)
{
    memset(features, 0, sizeof *features);
    for (uint32_t i = 0; i < object_count; i++) {
        if (points == 1) {
            add_vertices(objects, i, features);
        } else if (points == 2) {
            add_edges(objects, i, features);
        } else {
            add_faces(objects, i, features);
        }
    }
}

void oracle_features_keep_free(struct oracle_features *features)
{
    size_t kept = 0;
    for (size_t i = 0; i < features->count; i++) {
        features->items[kept] = features->items[i];
        kept += features->items[i].is_free;
    }
    features->count = kept;
}

void oracle_features_deinit(struct oracle_features *features)
{
    free(features->items);
    memset(features, 0, sizeof *features);
}

bool oracle_features_share_vertex(const struct oracle_feature *a,
                                  const struct oracle_feature *b)
{
    if (a->object != b->object) {
        return false;
    }
    for (uint32_t i = 0; i < a->points * b->points; i++) {
        if (a->v[i / b->points] == b->v[i % b->points]) {
            return true;
        }
    }
    return false;
}
