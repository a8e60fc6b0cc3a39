/* follow.c - what crosses where a step ends, from what crosses where it begins and what
 * meets in between.
 *
 * An edge that passes strictly through a face at the end, and did not at the begin, came
 * there by one of its ends, or by a side of the face: one of five pairs of features, a
 * vertex and a face or two edges, touched on the way (BOUNDS.md of the engine, "Features
 * that touch"). So it is beside a contact of the step. A daemon that is asked compares
 * all faces, which takes as long as the step.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "judge.h"
#include "oracle_distance.h"

/* ---- what is around a vertex ------------------------------------------------------- */

/* Rows that have a vertex: of[first[v]] to of[first[v + 1] - 1]. */
struct follow_rows {
    uint32_t *first, *of;
};
struct follow_mesh {
    struct follow_rows edges, faces;
};

static bool list_rows(struct follow_rows *rows, uint32_t vertex_count,
                      const uint32_t *corners, uint32_t width, uint32_t count)
{
    uint32_t *first = rows->first = calloc((size_t)vertex_count + 2, sizeof *first);
    uint32_t *of = rows->of = malloc(((size_t)width * count + 1) * sizeof *of);
    if (first == NULL || of == NULL) {
        return false;
    }
    for (size_t i = 0; i < (size_t)width * count; i++) {
        first[corners[i] + 2]++;
    }
    for (size_t v = 2; v < (size_t)vertex_count + 2; v++) {
        first[v] += first[v - 1];
    }
    for (size_t i = 0; i < (size_t)width * count; i++) {
        of[first[corners[i] + 1]++] = (uint32_t)(i / width);
    }
    return true;
}

/* List what is around the vertices of an object, once. Errors: E_NOMEM, those of
 * pccd_mesh_edges. */
static int look_around(struct follow *follow, struct pccd_client *client, uint32_t place)
{
    struct scene_object *object = &follow->scene->objects[place];
    const struct ctl_mesh *mesh = &object->files.mesh;
    struct follow_mesh *around = &follow->meshes[place];
    if (around->faces.of != NULL) {
        return PCCD_OK;
    }
    int status = scene_edges(object, client);
    if (status == PCCD_OK &&
        !(list_rows(&around->edges, mesh->vertex_count, &object->edges[0].a, 2,
                    object->info.edge_count) &&
          list_rows(&around->faces, mesh->vertex_count, mesh->triangles.vertices, 3,
                    mesh->triangles.count))) {
        status = PCCD_E_NOMEM;
    }
    return status;
}

/* ---- does it cross? ---------------------------------------------------------------- */

/* Return the sign of det[b - a, c - a, d - a] if doubles tell it, else 0. Source:
 * Shewchuk, Adaptive precision floating-point arithmetic, 1997: the error is below
 * (7 + 56 u) u of the sum of all products. What underflow adds, of differences below
 * 2^62, is below 2^-900. */
static int sign_of_volume(const double *a, const double *b, const double *c,
                          const double *d)
{
    double det = 0, sum = 0;
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3, l = (i + 2) % 3;
        double left = (c[k] - a[k]) * (d[l] - a[l]);
        double right = (c[l] - a[l]) * (d[k] - a[k]);
        det += (b[i] - a[i]) * (left - right);
        sum += fabs(b[i] - a[i]) * (fabs(left) + fabs(right));
    }
    return fabs(det) <= 0x1p-49 * sum + 0x1p-900 ? 0 : det > 0 ? 1 : -1;
}

/* Return whether the edge from p[0] to p[1] passes strictly through the face p[2..4]. */
static bool crosses(const double p[5][3])
{
    int ends[2] = {sign_of_volume(p[2], p[3], p[4], p[0]),
                   sign_of_volume(p[2], p[3], p[4], p[1])};
    if (ends[0] * ends[1] > 0) {
        return false;
    }
    int turns[3];
    for (int k = 0; k < 3; k++) {
        turns[k] = sign_of_volume(p[0], p[1], p[2 + k], p[2 + (k + 1) % 3]);
    }
    if (turns[0] * turns[1] < 0 || turns[1] * turns[2] < 0 || turns[2] * turns[0] < 0) {
        return false;
    }
    return ends[0] * ends[1] * turns[0] * turns[1] * turns[2] != 0 || oracle_crosses(p);
}

/* ---- a step ------------------------------------------------------------------------ */

struct following {
    struct follow *follow;
    struct pccd_client *client;
    uint32_t number;
    struct crossings *to;
};

/* Add an edge and a face, objects by their places, that cross in frame `number`. */
static int add(const struct following *following, const uint32_t places[2], uint32_t edge,
               uint32_t face)
{
    struct scene_object *objects = following->follow->scene->objects;
    struct crossings *to = following->to;
    const uint32_t features[2] = {edge, face};
    uint32_t corners[2][3];
    double p[5][3];
    for (uint32_t side = 0; side < 2; side++) {
        struct scene_object *object = &objects[places[side]];
        int status = scene_corners(object, following->client, 2 + side, features[side],
                                   corners[side]);
        if (status != PCCD_OK) {
            return status;
        }
        scene_vertices(scene_at(object, following->number), 2 + side, corners[side],
                       &p[2 * side]);
    }
    for (int i = 0; i < 6 && places[0] == places[1]; i++) {
        if (corners[0][i / 3] == corners[1][i % 3]) {
            return PCCD_OK;
        }
    }
    void *of = to->of;
    if (!crosses((const double(*)[3])p)) {
        return PCCD_OK;
    }
    if (!array_reserve(&of, to->count, &to->room, sizeof *to->of)) {
        return PCCD_E_NOMEM;
    }
    to->of = of;
    to->of[to->count++] = (struct crossing){objects[places[0]].handle, edge,
                                            objects[places[1]].handle, face};
    return PCCD_OK;
}

/* Add the edge with each face at another edge. */
static int add_faces(const struct following *following, const uint32_t places[2],
                     uint32_t edge, uint32_t other)
{
    const struct scene_object *object = &following->follow->scene->objects[places[1]];
    const struct follow_rows *faces = &following->follow->meshes[places[1]].faces;
    const uint32_t a = object->edges[other].a, b = object->edges[other].b;
    int status = PCCD_OK;
    for (uint32_t i = faces->first[a]; i < faces->first[a + 1] && status == PCCD_OK;
         i++) {
        const uint32_t *v =
            &object->files.mesh.triangles.vertices[3 * (size_t)faces->of[i]];
        if (v[0] == b || v[1] == b || v[2] == b) {
            status = add(following, places, edge, faces->of[i]);
        }
    }
    return status;
}

/* Add what may cross beside a contact. */
static int add_beside(const struct following *following, const struct pccd_pair *pair)
{
    struct follow *follow = following->follow;
    const uint32_t places[2] = {scene_place_of(follow->scene, pair->object_a),
                                scene_place_of(follow->scene, pair->object_b)};
    int status = PCCD_OK;
    for (int side = 0; side < 2 && status == PCCD_OK; side++) {
        status = places[side] == follow->scene->object_count
                     ? PCCD_E_FORMAT
                     : look_around(follow, following->client, places[side]);
    }
    if (status == PCCD_OK && pair->kind == PCCD_VF) {
        const struct follow_rows *edges = &follow->meshes[places[0]].edges;
        const uint32_t v = pair->feature_a;
        for (uint32_t i = edges->first[v]; i < edges->first[v + 1] && status == PCCD_OK;
             i++) {
            status = add(following, places, edges->of[i], pair->feature_b);
        }
    } else if (status == PCCD_OK && pair->kind == PCCD_EE) {
        const uint32_t turned[2] = {places[1], places[0]};
        status = add_faces(following, places, pair->feature_a, pair->feature_b);
        status = status == PCCD_OK
                     ? add_faces(following, turned, pair->feature_b, pair->feature_a)
                     : status;
    }
    return status;
}

void follow_note(struct follow *follow, const struct pccd_answer *page)
{
    void *pairs = follow->pairs;
    follow->is_whole =
        follow->is_whole && follow->count + page->count <= FOLLOW_CONTACTS_MAX;
    for (uint64_t i = 0; follow->is_whole && i < page->count; i++) {
        const struct pccd_contact *is = &page->contacts[i];
        follow->is_whole =
            array_reserve(&pairs, follow->count, &follow->room, sizeof *follow->pairs);
        follow->pairs = pairs;
        if (follow->is_whole) {
            follow->pairs[follow->count++] = (struct pccd_pair){
                is->kind, is->object_a, is->feature_a, is->object_b, is->feature_b};
        }
    }
}

int follow_begin(struct follow *follow, struct scene *scene, struct ctl_error *error)
{
    follow->scene = scene;
    follow->is_whole = true;
    follow->meshes = calloc(scene->object_count, sizeof *follow->meshes);
    return follow->meshes != NULL
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_NOMEM, "no memory for what crosses");
}

int follow_crossings(struct follow *follow, const struct check_run *run, uint32_t number,
                     const struct crossings *before, struct crossings *to,
                     struct ctl_error *error)
{
    const struct following following = {follow, run->client, number, to};
    int status = PCCD_OK;
    to->count = 0;
    for (size_t i = 0; i < before->count && status == PCCD_OK; i++) {
        const struct crossing *was = &before->of[i];
        const uint32_t places[2] = {scene_place_of(follow->scene, was->object_a),
                                    scene_place_of(follow->scene, was->object_b)};
        status = add(&following, places, was->edge, was->face);
    }
    for (size_t i = 0; i < follow->count && status == PCCD_OK; i++) {
        status = add_beside(&following, &follow->pairs[i]);
    }
    crossings_sort(to);
    to->is_complete = status == PCCD_OK;
    to->ms = 0;
    return status == PCCD_OK
               ? PCCD_OK
               : check_run_fail(run, status, "what crosses was not found", error);
}

void follow_deinit(struct follow *follow)
{
    for (uint32_t i = 0; follow->meshes != NULL && i < follow->scene->object_count; i++) {
        struct follow_mesh *around = &follow->meshes[i];
        free(around->edges.first);
        free(around->edges.of);
        free(around->faces.first);
        free(around->faces.of);
    }
    free(follow->meshes);
    free(follow->pairs);
    *follow = (struct follow){.scene = NULL};
}
