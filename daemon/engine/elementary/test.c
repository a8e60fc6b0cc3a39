/* daemon/engine/elementary/test.c - elementary tests of a chunk of candidates.
 *
 * Room:     engine.
 * Does:     copy the points of a few pairs at a time, test them, keep the contacts.
 * Threads:  [team].
 */
#include "test.h"

#include <string.h>

static void load_point(const struct eng_scene *scene, struct eng_query *query, int point,
                       uint32_t v)
{
    memcpy(query->x[0][point], scene->x[1 - scene->now][v], sizeof query->x[0][point]);
    memcpy(query->x[1][point], scene->x[scene->now][v], sizeof query->x[1][point]);
}

void eng_query_load(const struct eng_scene *scene, enum eng_kind kind, uint32_t a,
                    uint32_t b, struct eng_query *query)
{
    query->kind = kind;
    if (kind == ENG_VF) {
        const uint32_t *v = scene->triangles[b].v;
        load_point(scene, query, 0, a);
        load_point(scene, query, 1, v[0]);
        load_point(scene, query, 2, v[1]);
        load_point(scene, query, 3, v[2]);
    } else {
        load_point(scene, query, 0, scene->edges[a].a);
        load_point(scene, query, 1, scene->edges[a].b);
        load_point(scene, query, 2, scene->edges[b].a);
        load_point(scene, query, 3, scene->edges[b].b);
    }
}

/* Names as records carry them: object id and local index. */
static struct eng_pair name_of(const struct eng_scene *scene, enum eng_kind kind,
                               uint32_t a, uint32_t b)
{
    const struct eng_object *object_a;
    const struct eng_object *object_b;
    if (kind == ENG_VF) {
        object_a = &scene->objects[scene->vertices[a].object];
        object_b = &scene->objects[scene->triangles[b].object];
        return (struct eng_pair){ENG_VF, object_a->id, a - object_a->vertices.first,
                                 object_b->id, b - object_b->triangles.first};
    }
    object_a = &scene->objects[scene->edges[a].object];
    object_b = &scene->objects[scene->edges[b].object];
    return (struct eng_pair){ENG_EE, object_a->id, a - object_a->edges.first,
                             object_b->id, b - object_b->edges.first};
}

void eng_test_keep(struct eng_worker *worker, const struct eng_pair *name,
                   const struct eng_hit *hit)
{
    if (worker->settings->mode == ENG_MODE_ANY) {
        if (hit->flags & ENG_PROVED) {
            worker->proved_seen++;
            atomic_store_explicit(&worker->stop->stopped, true, memory_order_relaxed);
        } else {
            worker->possible_seen++;
        }
        return;
    }
    if (worker->settings->mode == ENG_MODE_FIRST && (hit->flags & ENG_PROVED)) {
        eng_worker_tighten(worker, hit->toi_hi);
    }
    struct eng_contact *contact = eng_found_add(&worker->found, name);
    if (!contact) {
        return;
    }
    contact->flags = hit->flags;
    contact->toi = hit->toi;
    contact->toi_hi = hit->toi_hi;
    memcpy(contact->param, hit->param, sizeof contact->param);
    memcpy(contact->normal, hit->normal, sizeof contact->normal);
    contact->reserved = 0;
}

static void load_pair(const struct eng_scene *scene, enum eng_kind kind, uint32_t a,
                      uint32_t b, struct eng_point points[4])
{
    struct eng_query query;
    eng_query_load(scene, kind, a, b, &query);
    for (int i = 0; i < 4; i++) {
        memcpy(points[i].x0, query.x[0][i], sizeof points[i].x0);
        memcpy(points[i].x1, query.x[1][i], sizeof points[i].x1);
    }
}

/* Pairs whose points are copied at a time: 8 KiB. */
#define GROUP 32u

struct group {
    struct eng_point points[4 * GROUP];
    uint32_t quads[GROUP][4];
    uint32_t count;
};

/* The points of candidates first .. first + GROUP - 1. */
static void load_group(const struct eng_scene *scene, enum eng_kind kind,
                       const struct eng_chunk *chunk, uint32_t first, struct group *group)
{
    memset(group, 0, sizeof *group);
    group->count = chunk->count - first < GROUP ? chunk->count - first : GROUP;
    for (uint32_t i = 0; i < group->count; i++) {
        load_pair(scene, kind, chunk->a[first + i], chunk->b[first + i],
                  &group->points[4 * (size_t)i]);
        for (uint32_t k = 0; k < 4; k++) {
            group->quads[i][k] = 4 * i + k;
        }
    }
}

/* Keep those of candidates first .. first + GROUP - 1 that no axis separates: by the
 * coordinates themselves, so that it does not matter how boxes were rounded. */
static void keep_group(struct eng_worker *worker, enum eng_kind kind,
                       const struct eng_chunk *chunk, uint32_t first)
{
    struct group group;
    uint32_t kept[GROUP];
    load_group(worker->scene, kind, chunk, first, &group);
    uint32_t count = worker->kernels->apart(
        kind, group.points, (const uint32_t(*)[4])group.quads, group.count, kept);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t pair = first + kept[i];
        struct eng_pair name =
            name_of(worker->scene, kind, chunk->a[pair], chunk->b[pair]);
        eng_found_add(&worker->found, &name); /* a full list says so itself */
    }
}

/* Test candidates first .. first + GROUP - 1. */
static void test_group(struct eng_worker *worker, enum eng_kind kind,
                       const struct eng_chunk *chunk, uint32_t first)
{
    struct group group;
    struct eng_batch *batch = &worker->batch;
    load_group(worker->scene, kind, chunk, first, &group);
    uint32_t hits = eng_batch_test(worker->kernels, kind, group.points,
                                   (const uint32_t(*)[4])group.quads, group.count,
                                   worker->settings->tolerance, worker->time_bound,
                                   &worker->exact, batch);
    worker->record.tests += group.count;
    worker->tally.survivors += batch->survivors;
    for (uint32_t i = 0; i < hits && !eng_stop_is_set(worker->stop); i++) {
        uint32_t pair = first + batch->index[i];
        struct eng_pair name =
            name_of(worker->scene, kind, chunk->a[pair], chunk->b[pair]);
        eng_test_keep(worker, &name, &batch->hits[i]);
    }
}

void eng_test_count(struct eng_worker *worker, enum eng_kind kind, uint32_t candidates)
{
    if (kind == ENG_VF) {
        worker->tally.candidates_vf += candidates;
    } else {
        worker->tally.candidates_ee += candidates;
    }
}

void eng_test_end(struct eng_worker *worker, enum eng_kind kind, uint32_t tested,
                  uint64_t begin_ns)
{
    uint64_t end_ns = eng_now_ns();
    worker->record.tests_ns += end_ns - begin_ns;
    if (tested > 0) {
        eng_trace_add(worker->settings->trace, worker->thread, ENG_TRACE_TESTS, begin_ns,
                      end_ns, kind, tested);
    }
}

void eng_test_chunk(struct eng_worker *worker, enum eng_kind kind)
{
    uint64_t begin_ns = eng_now_ns();
    struct eng_chunk *chunk = kind == ENG_VF ? &worker->vf : &worker->ee;
    uint32_t count = chunk->count;
    eng_test_count(worker, kind, count);
    for (uint32_t i = 0; i < chunk->count && !eng_stop_is_set(worker->stop); i += GROUP) {
        if (worker->settings->mode == ENG_MODE_PAIRS) {
            keep_group(worker, kind, chunk, i);
        } else {
            test_group(worker, kind, chunk, i);
        }
    }
    chunk->count = 0;
    eng_worker_should_stop(worker);
    eng_test_end(worker, kind, count, begin_ns);
}
