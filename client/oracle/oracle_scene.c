/* oracle_scene.c - every contact of a small scene, by brute force. */
#include "oracle_scene.h"

#include <stdlib.h>
#include <string.h>

#include "oracle_near.h"

static bool boxes_meet(const struct oracle_feature *a, const struct oracle_feature *b)
{
    for (int k = 0; k < 3; k++) {
        if (a->lo[k] > b->hi[k] || b->lo[k] > a->hi[k]) {
            return false;
        }
    }
    return true;
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

/* Return whether point i is above point j along an axis at both ends. */
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
                     const struct oracle_feature *a, const struct oracle_feature *b,
                     struct oracle_contacts *contacts)
{
    double p[8][3];
    if (oracle_features_share_vertex(a, b)) {
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
        contacts->pairs = oracle_grow(contacts->pairs, (2 * contacts->count + 1) *
                                                           sizeof *contacts->pairs);
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
    struct oracle_features vertices;
    struct oracle_features edges;
    struct oracle_features faces;
    memset(contacts, 0, sizeof *contacts);
    oracle_features_list(objects, object_count, 1, &vertices);
    oracle_features_list(objects, object_count, 2, &edges);
    oracle_features_list(objects, object_count, 3, &faces);
    for (size_t i = 0; i < vertices.count; i++) {
        for (size_t j = 0; j < faces.count; j++) {
            const struct oracle_feature *vertex = &vertices.items[i];
            const struct oracle_feature *face = &faces.items[j];
            if (boxes_meet(vertex, face) &&
                may_meet(context, objects[vertex->object].object_id,
                         objects[face->object].object_id)) {
                try_pair(objects, ORACLE_VF, vertex, face, contacts);
            }
        }
    }
    for (size_t i = 0; i < edges.count; i++) {
        for (size_t j = i + 1; j < edges.count; j++) {
            const struct oracle_feature *a = &edges.items[i];
            const struct oracle_feature *b = &edges.items[j];
            if (boxes_meet(a, b) && may_meet(context, objects[a->object].object_id,
                                             objects[b->object].object_id)) {
                try_pair(objects, ORACLE_EE, a, b, contacts);
            }
        }
    }
    if (contacts->count > 0) {
        qsort(contacts->pairs, contacts->count, sizeof *contacts->pairs,
              oracle_pair_compare);
    }
    oracle_features_deinit(&vertices);
    oracle_features_deinit(&edges);
    oracle_features_deinit(&faces);
}

void oracle_contacts_deinit(struct oracle_contacts *contacts)
{
    free(contacts->pairs);
    memset(contacts, 0, sizeof *contacts);
}
