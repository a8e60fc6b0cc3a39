/* side_scene.c - a question about some leaves alone. */
#include "near_objects.h"

#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "numbers.h"
#include "parts.h"
#include "rank_sort.h"

/* ---- leaves ------------------------------------------------------------------------ */

/* Sort the leaves of each object, and keep each once; what any copy of it owns is
 * owned. */
static int sort_leaves(struct pccd_mpi *world, const struct ranks_remote_leaf *leaves,
                       uint64_t count, struct ranks_remote_leaf **sorted, uint64_t *each)
{
    struct ranks_key *keys = ranks_array(2 * count, sizeof *keys);
    *sorted = ranks_array(count, sizeof **sorted);
    *each = 0;
    if (keys == NULL || *sorted == NULL) {
        free(keys);
        return ranks_no_memory(world);
    }
    for (uint64_t i = 0; i < count; i++) {
        keys[i] = (struct ranks_key){
            (uint64_t)leaves[i].object << 32 | leaves[i].leaf.number, i};
    }
    const struct ranks_key *order = ranks_sort(keys, keys + count, count);
    for (uint64_t i = 0; i < count; i++) {
        const struct ranks_remote_leaf *leaf = &leaves[order[i].value];
        uint32_t owns = leaf->is_ghost ? 0 : leaf->leaf.owns;
        if (i == 0 || order[i].key != order[i - 1].key) {
            (*sorted)[*each] = *leaf;
            (*sorted)[(*each)++].leaf.owns = 0;
        }
        (*sorted)[*each - 1].leaf.owns |= owns;
    }
    free(keys);
    return PCCD_OK;
}

/* An object of leaves[count], whose numbers in this scene are found; where its vertices
 * are goes to *x. */
static int make_object(struct pccd_mpi *world, const struct ranks_remote_leaf *leaves,
                       uint32_t count, struct ranks_object *object, double (**x)[3])
{
    uint32_t(*at)[3] = ranks_array(count, sizeof *at);
    object->own = ranks_array(count, sizeof *object->own);
    if (at == NULL || object->own == NULL) {
        free(at);
        return ranks_no_memory(world);
    }
    object->own_count = count;
    for (uint32_t i = 0; i < count; i++) {
        object->own[i] = leaves[i].leaf;
    }
    int status = ranks_local_make(world, object);
    if (status == PCCD_OK) {
        *x = ranks_array(object->local.vertex_count, sizeof **x);
        status = *x == NULL
                     ? ranks_no_memory(world)
                     : ranks_local_corners(world, &object->local, object->own, count, at);
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        for (int k = 0; k < 3; k++) {
            memcpy((*x)[at[i][k]], leaves[i].x[k], sizeof **x);
        }
    }
    free(at);
    return status;
}

static int make_objects(struct pccd_mpi *world, const struct ranks_remote_leaf *leaves,
                        uint64_t count, struct ranks_side_scene *side)
{
    uint64_t begin = 0;
    for (uint32_t o = 0; o < world->object_count; o++) {
        side->objects[o].mesh = world->objects[o]->mesh;
        side->objects[o].settings = world->objects[o]->settings;
    }
    while (begin < count) {
        uint32_t o = leaves[begin].object;
        uint64_t end = begin;
        while (end < count && leaves[end].object == o) {
            end++;
        }
        int status = make_object(world, leaves + begin, (uint32_t)(end - begin),
                                 &side->objects[o], &side->x[o]);
        if (status != PCCD_OK) {
            return status;
        }
        begin = end;
    }
    return PCCD_OK;
}

/* ---- the scene --------------------------------------------------------------------- */

/* Collective: radii[o] of local vertices, where an object has them by vertex. */
static int fetch_radii(struct pccd_mpi *world, const struct ranks_side_scene *side,
                       double **radii)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        const struct ranks_object *object = &side->objects[o];
        double(*x)[3] = NULL;
        if (object->mesh->has_radii && !(object->settings.radius > 0)) {
            status = ranks_fetch_registered(world, object->mesh, object->local.vertices,
                                            object->local.vertex_count, &x, &radii[o]);
        }
        free(x);
    }
    return status;
}

static int add_object(struct pccd_mpi *world, uint32_t scene, const double *radii,
                      const double (*x)[3], struct ranks_object *object)
{
    struct pccd_object_settings settings = {.struct_bytes = sizeof settings,
                                            .what = PCCD_OBJECT_GROUP | PCCD_OBJECT_MASK |
                                                    PCCD_OBJECT_RADIUS};
    COMMON_ATTRIBUTES_COPY(&settings, &object->settings);
    int status = ranks_local_register(world, object, x, radii, true);
    if (status != PCCD_OK) {
        return status;
    }
    status = pccd_scene_add(world->client, scene, object->local_mesh, &object->handle);
    if (status == PCCD_OK) {
        status = pccd_object_set(world->client, scene, object->handle, &settings);
    }
    return ranks_local_status(world, status, "no object of a scene beside");
}

/* Handles are in the order of those in the world. */
static int add_objects(struct pccd_mpi *world, uint32_t scene, double *const *radii,
                       struct ranks_side_scene *side)
{
    int status = PCCD_OK;
    for (uint32_t o = 0; o < world->object_count && status == PCCD_OK; o++) {
        if (side->objects[o].own_count > 0) {
            status = add_object(world, scene, radii[o], (const double(*)[3])side->x[o],
                                &side->objects[o]);
        }
    }
    return status;
}

/* The handle here of an object in the world; 0: it has no leaf here. */
static uint32_t handle_here(const struct pccd_mpi *world,
                            const struct ranks_side_scene *side, uint32_t handle)
{
    return side->objects[ranks_place_of_object(world, handle)].handle;
}

static int ignore_pairs(struct pccd_mpi *world, uint32_t scene,
                        const struct ranks_side_scene *side)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < world->ignored_count && status == PCCD_OK; i++) {
        uint32_t a = handle_here(world, side, world->ignored[i].a);
        uint32_t b = handle_here(world, side, world->ignored[i].b);
        if (a != 0 && b != 0) {
            status = pccd_pair_ignore(world->client, scene, a, b, true);
        }
    }
    return ranks_local_status(world, status, "not ignored in a scene beside");
}

/* ---- the answer -------------------------------------------------------------------- */

/* The place of an object, by its handle here: records have few, one after the other. */
static uint32_t place_of(const struct pccd_mpi *world,
                         const struct ranks_side_scene *side, uint32_t handle,
                         uint32_t last)
{
    uint32_t o = last;
    while (side->objects[o].handle != handle) {
        o = (o + 1) % world->object_count;
    }
    return o;
}

static uint32_t number_of(const struct ranks_local *local, uint32_t points,
                          uint32_t feature)
{
    return points == 1   ? local->vertices[feature]
           : points == 2 ? local->edges[feature]
                         : local->triangles[feature];
}

static int take_page(struct pccd_mpi *world, struct ranks_side_scene *side,
                     const struct pccd_answer *page)
{
    uint64_t bytes = (side->count + page->count + 1) * sizeof *side->records;
    struct pccd_near *records = realloc(side->records, bytes);
    uint32_t a = 0, b = 0;
    if (records == NULL) {
        return ranks_no_memory(world);
    }
    side->records = records;
    for (uint64_t i = 0; i < page->count; i++) {
        struct pccd_near *record = &records[side->count++];
        *record = page->near[i];
        const uint32_t *points = common_kinds[record->kind].points;
        a = place_of(world, side, record->object_a, a);
        b = place_of(world, side, record->object_b, b);
        record->object_a = world->objects[a]->handle;
        record->object_b = world->objects[b]->handle;
        record->feature_a =
            number_of(&side->objects[a].local, points[0], record->feature_a);
        record->feature_b =
            number_of(&side->objects[b].local, points[1], record->feature_b);
    }
    return PCCD_OK;
}

static int take_pages(struct pccd_mpi *world, uint32_t scene, struct pccd_answer *answer,
                      struct ranks_side_scene *side)
{
    struct pccd_answer page = *answer;
    for (;;) {
        uint64_t cursor = page.cursor;
        int status = take_page(world, side, &page);
        pccd_answer_release(world->client, &page);
        side->answer.incomplete = page.incomplete == PCCD_INCOMPLETE_RESULT_FULL
                                      ? PCCD_COMPLETE
                                      : page.incomplete;
        if (status != PCCD_OK || cursor >= answer->total) {
            return status;
        }
        status = pccd_fetch(world->client, scene, answer->step, cursor, &page);
        if (status != PCCD_OK) {
            return ranks_local_status(world, status, "a page of records did not come");
        }
    }
}

/* With handles of that scene. False: an object that is named has no leaf here. */
static bool name_here(const struct pccd_mpi *world, const struct ranks_side_scene *side,
                      struct pccd_near_settings *near)
{
    uint32_t *const named[2] = {&near->object_a, &near->object_b};
    bool is_here = true;
    for (int i = 0; i < 2; i++) {
        uint32_t here = *named[i] != 0 ? handle_here(world, side, *named[i]) : 0;
        is_here = is_here && (*named[i] == 0 || here != 0);
        *named[i] = here;
    }
    return is_here;
}

/* In this rank alone. Records of others than those that are named are none. */
static int ask(struct pccd_mpi *world, uint32_t scene,
               const struct pccd_near_settings *near, struct ranks_side_scene *side)
{
    struct pccd_near_settings here = *near;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    bool is_here = name_here(world, side, &here);
    here.at_begin = false;
    int status = pccd_ask_near(world->client, scene, NULL, 0, &here, &answer);
    if (status != PCCD_OK) {
        return ranks_local_status(world, status, "the question failed");
    }
    side->answer = answer;
    side->answer.near = NULL;
    status = take_pages(world, scene, &answer, side);
    if (!is_here) {
        side->count = side->answer.crossings = 0;
    }
    return status;
}

/* In this rank alone: the scene, from its making to its end. */
static int ask_in_scene(struct pccd_mpi *world, const struct pccd_near_settings *near,
                        double *const *radii, struct ranks_side_scene *side)
{
    uint32_t scene = 0;
    int status = pccd_scene_create(world->client, NULL, &scene);
    if (status != PCCD_OK) {
        return ranks_local_status(world, status, "no scene beside");
    }
    status = add_objects(world, scene, radii, side);
    if (status == PCCD_OK) {
        status = ignore_pairs(world, scene, side);
    }
    if (status == PCCD_OK) {
        status = ask(world, scene, near, side);
    }
    int ended = pccd_scene_destroy(world->client, scene);
    for (uint32_t o = 0; o < world->object_count; o++) {
        if (side->objects[o].local_mesh != 0 && ended == PCCD_OK) {
            ended = pccd_mesh_destroy(world->client, side->objects[o].local_mesh);
        }
    }
    return status != PCCD_OK || ended == PCCD_OK
               ? status
               : ranks_local_status(world, ended, "a scene beside does not end");
}

int ranks_side_scene_ask(struct pccd_mpi *world, const struct ranks_remote_leaf *leaves,
                         uint64_t count, const struct pccd_near_settings *near,
                         struct ranks_side_scene *side)
{
    size_t objects = (size_t)world->object_count + 1;
    struct ranks_remote_leaf *sorted = NULL;
    double **radii = calloc(objects, sizeof *radii);
    *side = (struct ranks_side_scene){.objects = calloc(objects, sizeof *side->objects),
                                      .x = calloc(objects, sizeof *side->x)};
    int status = radii == NULL || side->objects == NULL || side->x == NULL
                     ? ranks_no_memory(world)
                     : sort_leaves(world, leaves, count, &sorted, &count);
    if (status == PCCD_OK) {
        status = make_objects(world, sorted, count, side);
    }
    status = ranks_agree_on(&world->link, status);
    if (status == PCCD_OK && near->what == PCCD_NEAR_NEAREST) {
        status = fetch_radii(world, side, radii);
    }
    if (status == PCCD_OK) {
        ranks_stop_open(&world->stop);
        status = ranks_agree_on(&world->link, ask_in_scene(world, near, radii, side));
        ranks_stop_close(&world->stop);
    }
    for (uint32_t o = 0; o < world->object_count && radii != NULL; o++) {
        free(radii[o]);
    }
    free((void *)radii);
    free(sorted);
    return status;
}

void ranks_side_scene_add(struct ranks_side_scene *last,
                          const struct ranks_side_scene *earlier)
{
    struct pccd_answer *to = &last->answer;
    const struct pccd_answer *from = &earlier->answer;
    to->incomplete =
        from->incomplete > to->incomplete ? from->incomplete : to->incomplete;
#define ADD(unused, type, name, of_step, of_near, member, meaning)                       \
    to->member += from->member;
    COMMON_COUNTERS(ADD, )
    COMMON_TIMES(ADD, )
#undef ADD
}

void ranks_side_scene_deinit(const struct pccd_mpi *world, struct ranks_side_scene *side)
{
    for (uint32_t o = 0; o < world->object_count; o++) {
        if (side->objects != NULL) {
            ranks_local_deinit(&side->objects[o].local);
            free(side->objects[o].own);
        }
        if (side->x != NULL) {
            free(side->x[o]);
        }
    }
    free(side->objects);
    free((void *)side->x);
    free(side->records);
}

static bool has_feature(const struct ranks_leaf *leaf, uint32_t points, uint32_t feature)
{
    const uint32_t *of = points == 1 ? leaf->v : leaf->side;
    return points == 3 ? leaf->number == feature
                       : of[0] == feature || of[1] == feature || of[2] == feature;
}

void ranks_side_scene_find(const struct ranks_side_scene *side, uint32_t object,
                           uint32_t points, uint32_t feature,
                           struct ranks_remote_leaf *remote)
{
    const struct ranks_object *of = &side->objects[object];
    uint32_t i = 0;
    while (!has_feature(&of->own[i], points, feature)) {
        i++;
    }
    *remote = (struct ranks_remote_leaf){.object = object, .leaf = of->own[i]};
    for (int k = 0; k < 3; k++) {
        uint32_t v =
            ranks_place_of(of->local.vertices, of->local.vertex_count, remote->leaf.v[k]);
        memcpy(remote->x[k], side->x[object][v], sizeof remote->x[k]);
    }
}

void ranks_side_scene_vertex(const struct pccd_mpi *world,
                             const struct ranks_side_scene *side, uint32_t handle,
                             uint32_t vertex, double x[3])
{
    uint32_t o = ranks_place_of_object(world, handle);
    const struct ranks_local *local = &side->objects[o].local;
    uint32_t at = ranks_place_of(local->vertices, local->vertex_count, vertex);
    memcpy(x, side->x[o][at], 3 * sizeof *x);
}
