/* oracle_scene.c - every contact of a small scene, by brute force.
 *
 * Room:     client/oracle.
 * Does:     list vertices in use, edges and faces of all objects with the boxes of their
 *           motion, and try every pair.
 * Threads:  [any].
 */
#include "oracle_scene.h"

#include <stdlib.h>
#include <string.h>

/* A vertex, an edge or a face of any object. */
struct feature {
    uint32_t object; /* index into the objects */
    uint32_t index;
    uint32_t v[3]; /* 1, 2 or 3 vertices */
    double lo[3];  /* of its motion */
    double hi[3];
};

struct features {
    struct feature *items;
    size_t count;
    size_t capacity;
};

static void *grow(void *block, size_t bytes)
{
    block = realloc(block, bytes);
    if (!block) {
        abort();
    }
    return block;
}

static void add_feature(struct features *features, const struct oracle_object *objects,
                        uint32_t object, uint32_t index, const uint32_t *v, int corners)
{
    if (features->count == features->capacity) {
        features->capacity = features->capacity ? 2 * features->capacity : 256;
        features->items =
            grow(features->items, features->capacity * sizeof *features->items);
    }
    struct feature *feature = &features->items[features->count++];
    feature->object = object;
    feature->index = index;
    for (int i = 0; i < corners; i++) {
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
    uint32_t(*edges)[2] =
        grow(NULL, ((size_t)object->triangle_count * 3 + 1) * sizeof *edges);
    uint32_t n = 0;
    for (uint32_t i = 0; i < object->triangle_count * 3; i++) {
        uint32_t a = object->triangles[i / 3][i % 3];
        uint32_t b = object->triangles[i / 3][(i % 3 + 1) % 3];
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

static void add_object(const struct oracle_object *objects, uint32_t at,
                       struct features *vertices, struct features *edges,
                       struct features *faces)
{
    const struct oracle_object *object = &objects[at];
    bool *used = calloc((size_t)object->vertex_count + 1, sizeof *used);
    uint32_t edge_count;
    uint32_t(*pairs)[2] = oracle_edges(object, &edge_count);
    if (!used) {
        abort();
    }
    for (uint32_t i = 0; i < object->triangle_count; i++) {
        add_feature(faces, objects, at, i, object->triangles[i], 3);
        for (int k = 0; k < 3; k++) {
            used[object->triangles[i][k]] = true;
        }
    }
    for (uint32_t i = 0; i < object->vertex_count; i++) {
        if (used[i]) {
            add_feature(vertices, objects, at, i, &i, 1);
        }
    }
    for (uint32_t i = 0; i < edge_count; i++) {
        add_feature(edges, objects, at, i, pairs[i], 2);
    }
    free(pairs);
    free(used);
}

static bool boxes_meet(const struct feature *a, const struct feature *b)
{
    for (int k = 0; k < 3; k++) {
        if (a->lo[k] > b->hi[k] || b->lo[k] > a->hi[k]) {
            return false;
        }
    }
    return true;
}

static bool share_vertex(const struct feature *a, int a_corners, const struct feature *b,
                         int b_corners)
{
    if (a->object != b->object) {
        return false;
    }
    for (int i = 0; i < a_corners * b_corners; i++) {
        if (a->v[i / b_corners] == b->v[i % b_corners]) {
            return true;
        }
    }
    return false;
}

static void copy_point(double p[8][3], int i, const struct oracle_object *object,
                       uint32_t v)
{
    memcpy(p[i], object->x0[v], sizeof p[i]);
    memcpy(p[4 + i], object->x1[v], sizeof p[4 + i]);
}

void oracle_vf_points(const struct oracle_object *a, uint32_t vertex,
                      const struct oracle_object *b, uint32_t face, double p[8][3])
{
    copy_point(p, 0, a, vertex);
    for (int i = 0; i < 3; i++) {
        copy_point(p, 1 + i, b, b->triangles[face][i]);
    }
}

void oracle_ee_points(const struct oracle_object *a, const uint32_t edge_a[2],
                      const struct oracle_object *b, const uint32_t edge_b[2],
                      double p[8][3])
{
    for (int i = 0; i < 2; i++) {
        copy_point(p, i, a, edge_a[i]);
        copy_point(p, 2 + i, b, edge_b[i]);
    }
}

/* Is point i above point j along an axis at both ends? */
static bool is_above(const double p[8][3], int i, int j, int axis)
{
    return p[i][axis] > p[j][axis] && p[4 + i][axis] > p[4 + j][axis];
}

bool oracle_is_apart(enum oracle_kind kind, const double p[8][3])
{
    int first_count = kind == ORACLE_VF ? 1 : 2;
    for (int axis = 0; axis < 3; axis++) {
        bool above = true;
        bool below = true;
        for (int i = 0; i < first_count; i++) {
            for (int j = first_count; j < 4; j++) {
                above &= is_above(p, i, j, axis);
                below &= is_above(p, j, i, axis);
            }
        }
        if (above || below) {
            return true;
        }
    }
    return false;
}

static void try_pair(const struct oracle_object *objects, enum oracle_kind kind,
                     const struct feature *a, const struct feature *b,
                     struct oracle_contacts *contacts)
{
    double p[8][3];
    int a_corners = kind == ORACLE_VF ? 1 : 2;
    int b_corners = kind == ORACLE_VF ? 3 : 2;
    if (!boxes_meet(a, b) || share_vertex(a, a_corners, b, b_corners)) {
        return;
    }
    if (kind == ORACLE_VF) {
        oracle_vf_points(&objects[a->object], a->index, &objects[b->object], b->index, p);
    } else {
        oracle_ee_points(&objects[a->object], a->v, &objects[b->object], b->v, p);
    }
    contacts->queries++;
    contacts->beside += !oracle_is_apart(kind, (const double(*)[3])p);
    if (!oracle_hits(kind, (const double(*)[3])p)) {
        return;
    }
    /* Grow at powers of two. */
    if ((contacts->count & (contacts->count - 1)) == 0) {
        contacts->pairs =
            grow(contacts->pairs, (2 * contacts->count + 1) * sizeof *contacts->pairs);
    }
    struct oracle_pair pair = {kind, objects[a->object].object_id, a->index,
                               objects[b->object].object_id, b->index};
    if (kind == ORACLE_EE && pair.object_a > pair.object_b) {
        pair = (struct oracle_pair){kind, pair.object_b, pair.feature_b, pair.object_a,
                                    pair.feature_a};
    }
    contacts->pairs[contacts->count++] = pair;
}

int oracle_pair_compare(const void *a, const void *b)
{
    const struct oracle_pair *l = a;
    const struct oracle_pair *r = b;
    const uint32_t left[5] = {l->kind, l->object_a, l->feature_a, l->object_b,
                              l->feature_b};
    const uint32_t right[5] = {r->kind, r->object_a, r->feature_a, r->object_b,
                               r->feature_b};
    for (int i = 0; i < 5; i++) {
        if (left[i] != right[i]) {
            return left[i] < right[i] ? -1 : 1;
        }
    }
    return 0;
}

static bool anything(const void *context, uint32_t a, uint32_t b)
{
    (void)context;
    (void)a;
    (void)b;
    return true;
}

void oracle_scene(const struct oracle_object *objects, uint32_t object_count,
                  struct oracle_contacts *contacts)
{
    oracle_scene_where(objects, object_count, anything, NULL, contacts);
}

void oracle_scene_where(const struct oracle_object *objects, uint32_t object_count,
                        bool (*may_meet)(const void *context, uint32_t a, uint32_t b),
                        const void *context, struct oracle_contacts *contacts)
{
    struct features vertices = {NULL, 0, 0};
    struct features edges = {NULL, 0, 0};
    struct features faces = {NULL, 0, 0};
    memset(contacts, 0, sizeof *contacts);
    for (uint32_t i = 0; i < object_count; i++) {
        add_object(objects, i, &vertices, &edges, &faces);
    }
    for (size_t i = 0; i < vertices.count; i++) {
        for (size_t j = 0; j < faces.count; j++) {
            const struct feature *vertex = &vertices.items[i];
            const struct feature *face = &faces.items[j];
            if (may_meet(context, objects[vertex->object].object_id,
                         objects[face->object].object_id)) {
                try_pair(objects, ORACLE_VF, vertex, face, contacts);
            }
        }
    }
    for (size_t i = 0; i < edges.count; i++) {
        for (size_t j = i + 1; j < edges.count; j++) {
            const struct feature *a = &edges.items[i];
            const struct feature *b = &edges.items[j];
            if (may_meet(context, objects[a->object].object_id,
                         objects[b->object].object_id)) {
                try_pair(objects, ORACLE_EE, a, b, contacts);
            }
        }
    }
    if (contacts->count > 0) {
        qsort(contacts->pairs, contacts->count, sizeof *contacts->pairs,
              oracle_pair_compare);
    }
    free(vertices.items);
    free(edges.items);
    free(faces.items);
}

void oracle_contacts_deinit(struct oracle_contacts *contacts)
{
    free(contacts->pairs);
    memset(contacts, 0, sizeof *contacts);
}
