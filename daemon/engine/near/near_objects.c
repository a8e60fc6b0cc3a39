/* near_objects.c - what is asked of objects two by two. */
#include "near_objects.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"
#include "names.h"
#include "thickness.h"

/* An object, or some leaves of it, for any thread. */
struct eng_near_share {
    double low; /* NEAREST: the least x of its bounds */
    uint32_t object;
    uint32_t first; /* DEPTH: leaves, for the vertices that they own; count 0: .. */
    uint32_t count; /* .. for crossings with objects behind it */
};

/* Pairs of objects that are kept. */
#define CAPACITY_LEAST 16u
#define CAPACITY_MOST  (1u << 22) /* 80 MiB */

#define SHARE_LEAVES 256u

/* The slack of the square of a distance of bounds: more than what its rounding adds. */
#define BOUNDS_SLACK 0x1p-40

/* ---- the nearest pairs of last time ------------------------------------------------ */

static void free_cache(struct eng_nearest_cache *cache)
{
    eng_free(cache->entries);
    *cache = (struct eng_nearest_cache){0};
}

static uint64_t cache_bytes(const struct eng_nearest_cache *cache)
{
    return cache->capacity * sizeof *cache->entries;
}

static void forget_cache(struct eng_nearest_cache *cache)
{
    if (cache->count > 0) {
        memset(cache->entries, 0, cache->capacity * sizeof *cache->entries);
        cache->count = 0;
    }
}

/* Pairs are of two different objects. */
static bool is_free(const struct pccd_pair *entry)
{
    return entry->object_a == entry->object_b;
}

/* The entry of two objects, by id, or the free one where it belongs. */
static struct pccd_pair *entry_of(const struct eng_nearest_cache *cache, uint32_t a,
                                  uint32_t b)
{
    uint64_t low = a < b ? a : b;
    uint64_t high = a < b ? b : a;
    uint64_t mixed = (high << 32 | low) * UINT64_C(0x9e3779b97f4a7c15);
    uint32_t at = (uint32_t)(mixed >> 32) & (cache->capacity - 1);
    for (;;) {
        struct pccd_pair *entry = &cache->entries[at];
        if (is_free(entry) || (entry->object_a == a && entry->object_b == b) ||
            (entry->object_a == b && entry->object_b == a)) {
            return entry;
        }
        at = (at + 1) & (cache->capacity - 1);
    }
}

static bool reserve(struct eng_nearest_cache *cache, uint64_t count)
{
    uint32_t capacity = cache->capacity > 0 ? cache->capacity : CAPACITY_LEAST;
    while (capacity < 2 * count && capacity < CAPACITY_MOST) {
        capacity *= 2;
    }
    if (capacity < 2 * count) {
        return false;
    }
    if (capacity > cache->capacity) {
        struct pccd_pair *entries = eng_alloc(capacity, sizeof *entries);
        if (!entries) {
            return false;
        }
        memset(entries, 0, capacity * sizeof *entries);
        eng_free(cache->entries);
        cache->entries = entries;
        cache->capacity = capacity;
    }
    return true;
}

static void learn(struct eng_nearest_cache *cache, const struct pccd_near *records,
                  uint64_t count)
{
    forget_cache(cache);
    if (!reserve(cache, count)) {
        return;
    }
    for (uint64_t i = 0; i < count; i++) {
        const struct pccd_near *record = &records[i];
        assert(record->object_a != record->object_b);
        *entry_of(cache, record->object_a, record->object_b) =
            (struct pccd_pair){.kind = record->kind,
                               .object_a = record->object_a,
                               .feature_a = record->feature_a,
                               .object_b = record->object_b,
                               .feature_b = record->feature_b};
    }
    cache->count = (uint32_t)count;
}

static bool find_in_cache(const struct eng_nearest_cache *cache,
                          const struct eng_scene *scene, uint32_t a, uint32_t b,
                          struct eng_near_pair *pair)
{
    if (cache->count == 0) {
        return false;
    }
    const struct pccd_pair *entry =
        entry_of(cache, scene->objects[a].id, scene->objects[b].id);
    if (is_free(entry)) {
        return false;
    }
    bool is_turned = entry->object_a != scene->objects[a].id;
    uint32_t first = is_turned ? b : a;
    uint32_t second = is_turned ? a : b;
    const uint32_t(*edges_a)[2] = (const uint32_t(*)[2])scene->objects[first].mesh->edges;
    const uint32_t(*edges_b)[2] =
        (const uint32_t(*)[2])scene->objects[second].mesh->edges;
    uint32_t of_a = entry->feature_a;
    uint32_t of_b = entry->feature_b;
    switch (entry->kind) {
    case PCCD_VF:
        *pair = eng_near_vf(scene, first, of_a, second, of_b);
        break;
    case PCCD_EF:
        *pair = eng_near_ef(scene, first, edges_a[of_a], second, of_b);
        break;
    case PCCD_VE:
        *pair = eng_near_ve(scene, first, of_a, second, edges_b[of_b]);
        break;
    case PCCD_VV:
        *pair = eng_near_vv(scene, first, of_a, second, of_b);
        break;
    default:
        *pair = eng_near_ee(scene, first, edges_a[of_a], second, edges_b[of_b]);
    }
    return true;
}

void eng_near_objects_forget(struct eng_near_objects *objects)
{
    forget_cache(&objects->cache);
}

void eng_near_objects_deinit(struct eng_near_objects *objects)
{
    for (uint32_t i = 0; i < objects->search_count; i++) {
        eng_near_search_free(objects->searches[i]);
    }
    free_cache(&objects->cache);
    eng_free(objects->shares);
    *objects = (struct eng_near_objects){0};
}

uint64_t eng_near_objects_bytes(const struct eng_near_objects *objects)
{
    return objects->search_count * (sizeof *objects->searches[0] + eng_numbers_bytes() +
                                    eng_distance_order_bytes()) +
           objects->share_capacity * sizeof *objects->shares +
           cache_bytes(&objects->cache);
}

/* ---- who is asked for -------------------------------------------------------------- */

static int choose(struct eng_near_objects *objects)
{
    const struct eng_scene *scene = objects->scene;
    for (int side = 0; side < 2; side++) {
        uint32_t id = objects->ask.objects[side];
        objects->chosen[side] = id != 0 ? eng_ids_find(&scene->ids, id) : ENG_NO_OBJECT;
        if (id != 0 && objects->chosen[side] == ENG_NO_OBJECT) {
            return PCCD_E_HANDLE;
        }
    }
    if (objects->chosen[0] == ENG_NO_OBJECT) { /* the one that is chosen comes first */
        objects->chosen[0] = objects->chosen[1];
        objects->chosen[1] = ENG_NO_OBJECT;
    }
    return objects->chosen[0] == objects->chosen[1] && objects->chosen[0] != ENG_NO_OBJECT
               ? PCCD_E_INVAL
               : PCCD_OK;
}

static bool is_asked(const struct eng_near_objects *objects, uint32_t a, uint32_t b)
{
    const uint32_t *chosen = objects->chosen;
    if (a == b) {
        return false;
    }
    for (int side = 0; side < 2; side++) {
        if (chosen[side] != ENG_NO_OBJECT && a != chosen[side] && b != chosen[side]) {
            return false;
        }
    }
    return eng_masks_allows(&objects->scene->masks, a, b);
}

static bool is_asked_with_any(const struct eng_near_objects *objects, uint32_t a)
{
    const struct eng_scene *scene = objects->scene;
    for (uint32_t b = 0; b < scene->object_capacity; b++) {
        if (scene->objects[b].mesh && is_asked(objects, a, b)) {
            return true;
        }
    }
    return false;
}

static int add_share(struct eng_near_objects *objects, uint32_t object, uint32_t first,
                     uint32_t count)
{
    int status = eng_array_extend(&objects->shares, &objects->share_capacity,
                                  objects->share_count + 1, sizeof *objects->shares);
    if (status != PCCD_OK) {
        return status;
    }
    objects->shares[objects->share_count++] =
        (struct eng_near_share){.object = object, .first = first, .count = count};
    return PCCD_OK;
}

static int list_shares(struct eng_near_objects *objects)
{
    const struct eng_scene *scene = objects->scene;
    int status = PCCD_OK;
    objects->share_count = 0;
    for (uint32_t i = 0; i < scene->object_capacity && status == PCCD_OK; i++) {
        if (!scene->objects[i].mesh || !is_asked_with_any(objects, i)) {
            continue;
        }
        uint32_t leaves = scene->objects[i].mesh->leaf_count;
        if (objects->ask.verb == PCCD_NEAR_NEAREST) {
            status = add_share(objects, i, 0, leaves);
        }
        if (objects->ask.verb == PCCD_NEAR_DEPTH) {
            status = add_share(objects, i, 0, 0);
        }
        for (uint32_t first = 0;
             objects->ask.verb == PCCD_NEAR_DEPTH && first < leaves && status == PCCD_OK;
             first += SHARE_LEAVES) {
            uint32_t left = leaves - first;
            status =
                add_share(objects, i, first, left < SHARE_LEAVES ? left : SHARE_LEAVES);
        }
    }
    return status;
}

static bool has_faces(const struct eng_object *object)
{
    return object->mesh->info.triangle_count > 0;
}

/* The surfaces of all that are listed, which are asked for. */
static int check_closed(const struct eng_near_objects *objects,
                        struct eng_open_mesh_error *open)
{
    int status = PCCD_OK;
    for (uint32_t i = 0; i < objects->share_count; i++) {
        const struct eng_object *object =
            &objects->scene->objects[objects->shares[i].object];
        struct eng_open_edge edge;
        if (objects->shares[i].count > 0 || !has_faces(object) ||
            eng_mesh_has_foreign(object->mesh)) {
            continue; /* once an object; of a part others know */
        }
        int of_mesh = eng_mesh_is_closed(object->mesh, &edge);
        if (of_mesh == PCCD_E_NOMEM) {
            return of_mesh;
        }
        if (of_mesh == PCCD_E_INVAL && (status == PCCD_OK || object->id < open->object)) {
            status = of_mesh;
            open->object = object->id;
            open->edge = edge;
        }
    }
    return status;
}

int eng_near_objects_prepare(struct eng_near_objects *objects,
                             const struct eng_scene *scene,
                             const struct eng_question *ask, uint32_t threads,
                             struct eng_open_mesh_error *open)
{
    assert(threads >= 1 && threads <= ENG_THREADS_MAX);
    assert(common_near_is_of_objects(ask->verb));
    objects->scene = scene;
    objects->ask = *ask;
    objects->ask.gap = ask->verb == PCCD_NEAR_NEAREST ? ask->gap : 0;
    open->object = 0;
    int status = choose(objects);
    if (status == PCCD_OK) {
        status = list_shares(objects);
    }
    if (status == PCCD_OK && objects->ask.verb == PCCD_NEAR_DEPTH) {
        status = check_closed(objects, open);
    }
    while (status == PCCD_OK && objects->search_count < threads) {
        status = eng_near_search_new(&objects->searches[objects->search_count]);
        objects->search_count += status == PCCD_OK;
    }
    return status;
}

/* ---- where they are ---------------------------------------------------------------- */

static const struct eng_bounds *bounds_of(const struct eng_near_objects *objects,
                                          uint32_t object)
{
    const struct eng_scene *scene = objects->scene;
    unsigned at = objects->ask.end == 1 ? scene->now : 1 - scene->now;
    return &scene->objects[object].bounds[at];
}

static int compare_shares(const void *a, const void *b)
{
    const struct eng_near_share *of_a = a;
    const struct eng_near_share *of_b = b;
    if (of_a->low != of_b->low) {
        return of_a->low < of_b->low ? -1 : 1;
    }
    return of_a->object < of_b->object ? -1 : of_a->object > of_b->object;
}

void eng_near_objects_begin(struct eng_near_objects *objects)
{
    atomic_init(&objects->next, 0);
    atomic_init(&objects->crossings, 0);
    if (objects->ask.verb == PCCD_NEAR_NEAREST && objects->share_count > 0) {
        for (uint32_t i = 0; i < objects->share_count; i++) {
            objects->shares[i].low =
                bounds_of(objects, objects->shares[i].object)->low[0];
        }
        qsort(objects->shares, objects->share_count, sizeof *objects->shares,
              compare_shares);
    }
}

/* Return whether bounds of two objects are certainly farther apart than a distance. */
static bool are_farther(const struct eng_bounds *a, const struct eng_bounds *b,
                        double distance)
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double gap = fmax(a->low[k] - b->high[k], b->low[k] - a->high[k]);
        square += gap > 0 ? gap * gap : 0;
    }
    return square > distance * distance * (1 + BOUNDS_SLACK) + 0x1p-1000;
}

/* ---- nearest ----------------------------------------------------------------------- */

static void add_record(const struct eng_near_search *search, struct eng_worker *worker)
{
    struct pccd_near record;
    eng_near_describe(&search->best, &search->best.pair, &record);
    struct pccd_pair name = {.kind = record.kind,
                             .object_a = record.object_a,
                             .feature_a = record.feature_a,
                             .object_b = record.object_b,
                             .feature_b = record.feature_b};
    void *place = eng_found_add(&worker->found, &name);
    if (place) {
        memcpy(place, &record, sizeof record);
    }
}

/* The largest radius of an object, if radii count. */
static double largest_radius(const struct eng_near_objects *objects,
                             const struct eng_worker *worker, uint32_t object)
{
    return worker->question->sought.is_thick
               ? eng_thickness_most(&objects->scene->objects[object])
               : 0;
}

/* An object with all that begin behind it. */
static void perform_nearest(struct eng_near_objects *objects,
                            struct eng_near_search *search, struct eng_worker *worker,
                            uint32_t share)
{
    uint32_t a = objects->shares[share].object;
    const struct eng_bounds *of_a = bounds_of(objects, a);
    struct eng_near_limits limits = {.distance = objects->ask.distance,
                                     .gap = objects->ask.gap,
                                     .most = {largest_radius(objects, worker, a)}};
    for (uint32_t i = share + 1; i < objects->share_count; i++) {
        uint32_t b = objects->shares[i].object;
        if (objects->shares[i].low - of_a->high[0] > worker->question->sought.reach ||
            ((i & 1023u) == 0 && eng_worker_should_stop(worker))) {
            return;
        }
        limits.most[1] = largest_radius(objects, worker, b);
        if (!is_asked(objects, a, b) ||
            are_farther(of_a, bounds_of(objects, b),
                        eng_sum_up(limits.distance,
                                   eng_sum_up(limits.most[0], limits.most[1])))) {
            continue;
        }
        struct eng_near_pair first;
        bool is_warm = find_in_cache(&objects->cache, objects->scene, a, b, &first);
        worker->record.task_units++;
        if (!eng_near_search_objects(search, a, b, &limits, is_warm ? &first : NULL)) {
            return;
        }
        if (search->best.is_made) {
            add_record(search, worker);
        }
    }
}

/* ---- depth ------------------------------------------------------------------------- */

static bool is_within(const struct eng_bounds *bounds, const double x[3])
{
    for (int k = 0; k < 3; k++) {
        if (x[k] < bounds->low[k] || x[k] > bounds->high[k]) {
            return false;
        }
    }
    return true;
}

/* A vertex of one object and the surface of another. *face: that found last. False: it
 * was stopped. */
static bool perform_vertex(struct eng_near_search *search, struct eng_worker *worker,
                           uint32_t a, uint32_t v, uint32_t b, uint32_t *face)
{
    int64_t winding;
    bool is_on;
    if (!eng_near_search_winding(search, a, v, b, &winding, &is_on)) {
        return false;
    }
    if (is_on || winding == 0) {
        return true;
    }
    if (!eng_near_search_vertex(search, a, v, b, *face)) {
        return false;
    }
    *face = (uint32_t)search->best.pair.feature[1];
    if (search->best.hi > 0) { /* else it is on the surface */
        add_record(search, worker);
    }
    return true;
}

/* An object and all behind it: what passes through what. */
static void perform_crossings(struct eng_near_objects *objects,
                              struct eng_near_search *search, struct eng_worker *worker,
                              uint32_t a)
{
    const struct eng_scene *scene = objects->scene;
    const struct eng_bounds *of_a = bounds_of(objects, a);
    for (uint32_t b = a + 1; b < scene->object_capacity; b++) {
        uint64_t crossings;
        if (!scene->objects[b].mesh || !is_asked(objects, a, b) ||
            are_farther(of_a, bounds_of(objects, b), 0)) {
            continue;
        }
        worker->record.task_units++;
        if (!eng_near_search_crossings(search, a, b, &crossings)) {
            return;
        }
        atomic_fetch_add_explicit(&objects->crossings, crossings, memory_order_relaxed);
    }
}

/* The vertices that some leaves of an object own, and the surfaces of all others. */
static void perform_depth(struct eng_near_objects *objects,
                          struct eng_near_search *search, struct eng_worker *worker,
                          uint32_t share)
{
    const struct eng_scene *scene = objects->scene;
    const struct eng_near_share *part = &objects->shares[share];
    const struct eng_object *object = &scene->objects[part->object];
    const double(*x)[3] = search->best.x + object->vertices.first;
    for (uint32_t b = 0; b < scene->object_capacity; b++) {
        uint32_t face = ENG_NO_FACE;
        if (!scene->objects[b].mesh || !has_faces(&scene->objects[b]) ||
            !is_asked(objects, part->object, b)) {
            continue;
        }
        /* Of a part of a surface, nothing is known of where the rest is. */
        const struct eng_bounds *bounds =
            eng_mesh_has_foreign(scene->objects[b].mesh) ? NULL : bounds_of(objects, b);
        worker->record.task_units++;
        for (uint32_t i = 0; i < 3 * part->count; i++) {
            const struct eng_face *of = &object->mesh->leaves[part->first + i / 3];
            uint32_t v = of->v[i % 3];
            if ((of->owns & ENG_OWNS_VERTEX(i % 3)) != 0 &&
                !eng_mesh_is_foreign(object->mesh, PCCD_TREE_VERTICES, v) &&
                (bounds == NULL || is_within(bounds, x[v])) &&
                !perform_vertex(search, worker, part->object, v, b, &face)) {
                return;
            }
        }
    }
}

void eng_near_objects_perform(struct eng_near_objects *objects,
                              const struct eng_method_calls *method,
                              struct eng_worker *worker)
{
    struct eng_near_search *search = objects->searches[worker->thread];
    eng_near_search_at(search, method, worker, objects->ask.end);
    while (!eng_worker_should_stop(worker)) {
        /* Relaxed: what is taken was made before the region. */
        uint32_t share =
            atomic_fetch_add_explicit(&objects->next, 1, memory_order_relaxed);
        if (share >= objects->share_count) {
            break;
        }
        if (objects->shares[share].count == 0) {
            perform_crossings(objects, search, worker, objects->shares[share].object);
        } else if (objects->ask.verb == PCCD_NEAR_NEAREST) {
            perform_nearest(objects, search, worker, share);
        } else {
            perform_depth(objects, search, worker, share);
        }
    }
    worker->record.box_tests += search->box_tests;
    worker->tally.leaf_pairs += search->best.looked;
}

uint64_t eng_near_objects_crossings(const struct eng_near_objects *objects)
{
    return atomic_load_explicit(&objects->crossings, memory_order_relaxed);
}

void eng_near_objects_learn(struct eng_near_objects *objects, const void *records,
                            uint64_t count)
{
    learn(&objects->cache, records, count);
}
