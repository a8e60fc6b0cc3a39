/* test.c - elementary tests of a chunk of candidates. */
#include "test.h"

#include <assert.h>
#include <string.h>

#include "finding.h"
#include "kernel.h"
#include "near_work.h"
#include "paper_features.h"
#include "solvers.h"
#include "thick_work.h"

static void load_point(const struct eng_scene *scene, struct eng_query *query, int point,
                       uint32_t v)
{
    memcpy(query->x[0][point], scene->x[1 - scene->now][v], sizeof query->x[0][point]);
    memcpy(query->x[1][point], scene->x[scene->now][v], sizeof query->x[1][point]);
}

/* The vertices of a candidate; the last is repeated. */
static void get_vertices(const struct eng_trees *trees, enum pccd_kind kind, uint32_t a,
                         uint32_t b, uint32_t v[4])
{
    const uint32_t *points = common_kinds[kind].points;
    eng_feature_vertices(trees, points[0], a, v);
    eng_feature_vertices(trees, points[1], b, v + points[0]);
    for (uint32_t i = points[0] + points[1]; i < 4; i++) {
        v[i] = v[i - 1];
    }
}

void eng_query_load(const struct eng_scene *scene, enum pccd_kind kind, uint32_t a,
                    uint32_t b, struct eng_query *query)
{
    uint32_t v[4];
    get_vertices(eng_trees_of(scene), kind, a, b, v);
    query->kind = kind;
    for (int i = 0; i < 4; i++) {
        load_point(scene, query, i, v[i]);
    }
}

/* Names as records carry them: object id and local index. */
static struct pccd_pair name_of(const struct eng_scene *scene, enum pccd_kind kind,
                                uint32_t a, uint32_t b)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    const uint32_t *points = common_kinds[kind].points;
    const struct eng_object *object_a =
        &scene->objects[eng_feature_object(trees, points[0], a)];
    const struct eng_object *object_b =
        &scene->objects[eng_feature_object(trees, points[1], b)];
    return (struct pccd_pair){kind, object_a->id,
                              a - eng_feature_first(object_a, points[0]), object_b->id,
                              b - eng_feature_first(object_b, points[1])};
}

static void load_pair(const struct eng_scene *scene, enum pccd_kind kind, uint32_t a,
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
    uint32_t pair[GROUP]; /* of the chunk */
    uint32_t count;
};

/* The points of candidates first .. first + GROUP - 1. */
static void load_group(const struct eng_scene *scene, enum pccd_kind kind,
                       const struct eng_chunk *chunk, uint32_t first, struct group *group)
{
    memset(group, 0, sizeof *group);
    group->count = chunk->count - first < GROUP ? chunk->count - first : GROUP;
    for (uint32_t i = 0; i < group->count; i++) {
        load_pair(scene, kind, chunk->a[first + i], chunk->b[first + i],
                  &group->points[4 * (size_t)i]);
        group->pair[i] = first + i;
        for (uint32_t k = 0; k < 4; k++) {
            group->quads[i][k] = 4 * i + k;
        }
    }
}

/* The names of candidates index[count] of the group that is being tested. */
static void name_candidates(const struct eng_worker *worker, enum pccd_kind kind,
                            const uint32_t *index, uint32_t count,
                            struct pccd_pair *names)
{
    const struct eng_chunk *chunk = &eng_paper_work_of(worker)->chunks[kind];
    uint32_t first = eng_paper_work_of(worker)->group_first;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t at = first + index[i];
        names[i] = name_of(worker->scene, kind, chunk->a[at], chunk->b[at]);
    }
}

/* The words of the points: near_work.h. */
static void name_points(const struct eng_scene *scene, enum pccd_kind kind,
                        const struct eng_chunk *chunk, uint32_t first,
                        struct group *group)
{
    const struct eng_trees *trees = eng_trees_of(scene);
    for (uint32_t i = 0; i < group->count; i++) {
        uint32_t v[4];
        get_vertices(trees, kind, chunk->a[first + i], chunk->b[first + i], v);
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t at = trees->vertices[v[k]].object;
            const struct eng_object *object = &scene->objects[at];
            struct eng_point *point = &group->points[4 * i + k];
            point->word0 = (uint64_t)at << 32 | v[k];
            point->word1 = (uint64_t)object->id << 32 | (v[k] - object->vertices.first);
        }
    }
}

/* Pairs of a group that meet at a distance are tested: only the others stay. */
static void test_thick(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_chunk *chunk, uint32_t first, struct group *group)
{
    eng_paper_work_of(worker)->group_first = first;
    name_points(worker->scene, kind, chunk, first, group);
    group->count =
        eng_thick_test(worker, kind, group->points, (const uint32_t(*)[4])group->quads,
                       group->count, false, name_candidates);
    const uint32_t *rest = eng_thick_work_of(worker)->rest;
    if (!eng_solvers[kind].search) {
        group->count = 0; /* what keeps no distance is not tested */
    }
    for (uint32_t i = 0; i < group->count; i++) {
        memmove(group->quads[i], group->quads[rest[i]], sizeof group->quads[i]);
        group->pair[i] = group->pair[rest[i]];
    }
}

/* The points of candidates first .. first + GROUP - 1 that meet at no distance. */
static void load_thin(struct eng_worker *worker, enum pccd_kind kind,
                      const struct eng_chunk *chunk, uint32_t first, struct group *group)
{
    load_group(worker->scene, kind, chunk, first, group);
    if (worker->scene->thickness.is_on) {
        test_thick(worker, kind, chunk, first, group);
    }
}

/* Keep those of candidates first .. first + GROUP - 1 that no axis separates: by the
 * coordinates themselves, so that it does not matter how boxes were rounded. */
static void keep_group(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_chunk *chunk, uint32_t first)
{
    assert(first < chunk->count);
    struct group group;
    uint32_t kept[GROUP];
    load_thin(worker, kind, chunk, first, &group);
    uint32_t count = worker->kernels->reject_axes(
        kind, group.points, (const uint32_t(*)[4])group.quads, group.count, kept);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t pair = group.pair[kept[i]];
        struct pccd_pair name =
            name_of(worker->scene, kind, chunk->a[pair], chunk->b[pair]);
        eng_found_add(&worker->found, &name); /* a full list says so itself */
    }
}

/* Test candidates first .. first + GROUP - 1. */
static void test_group(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_chunk *chunk, uint32_t first)
{
    assert(first < chunk->count);
    struct group group;
    struct eng_batch *batch = &eng_paper_work_of(worker)->batch;
    load_thin(worker, kind, chunk, first, &group);
    uint32_t hits = eng_batch_test(worker->kernels, kind, group.points,
                                   (const uint32_t(*)[4])group.quads, group.count,
                                   worker->question->tolerance, worker->time_bound,
                                   &worker->exact, batch);
    worker->record.tests += group.count;
    worker->tally.survivors += batch->survivors;
    for (uint32_t i = 0; i < hits && !eng_stop_is_set(worker->stop); i++) {
        uint32_t pair = group.pair[batch->index[i]];
        struct pccd_pair name =
            name_of(worker->scene, kind, chunk->a[pair], chunk->b[pair]);
        eng_test_keep(worker, &name, &batch->hits[i]);
    }
}

/* ---- what is near ------------------------------------------------------------------ */

/* Edges that pass through faces: candidates first .. first + GROUP - 1. */
static void cross_group(struct eng_worker *worker, const struct eng_chunk *chunk,
                        uint32_t first)
{
    const struct eng_scene *scene = worker->scene;
    const struct eng_trees *trees = eng_trees_of(scene);
    struct eng_point points[5 * GROUP];
    uint32_t fives[GROUP][5];
    uint32_t count = chunk->count - first < GROUP ? chunk->count - first : GROUP;
    memset(points, 0, sizeof points);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t v[5];
        eng_feature_vertices(trees, 2, chunk->a[first + i], v);
        eng_feature_vertices(trees, 3, chunk->b[first + i], v + 2);
        for (uint32_t k = 0; k < 5; k++) {
            struct eng_point *point = &points[5 * i + k];
            memcpy(point->x0, scene->x[1 - scene->now][v[k]], sizeof point->x0);
            memcpy(point->x1, scene->x[scene->now][v[k]], sizeof point->x1);
            fives[i][k] = 5 * i + k;
        }
    }
    eng_near_cross(worker, points, (const uint32_t(*)[5])fives, count, name_candidates);
}

static void test_near(struct eng_worker *worker, enum pccd_kind kind,
                      const struct eng_chunk *chunk, uint32_t first)
{
    struct group group;
    eng_paper_work_of(worker)->group_first = first;
    if (kind == (enum pccd_kind)PCCD_EF) {
        cross_group(worker, chunk, first);
        return;
    }
    load_group(worker->scene, kind, chunk, first, &group);
    name_points(worker->scene, kind, chunk, first, &group);
    eng_near_test(worker, kind, group.points, (const uint32_t(*)[4])group.quads,
                  group.count, false, name_candidates);
}

void eng_test_chunk(struct eng_worker *worker, enum pccd_kind kind)
{
    uint64_t begin_ns = common_now_ns();
    struct eng_chunk *chunk = &eng_paper_work_of(worker)->chunks[kind];
    uint32_t count = chunk->count;
    eng_test_count(worker, kind, count);
    for (uint32_t i = 0; i < chunk->count && !eng_stop_is_set(worker->stop); i += GROUP) {
        if (eng_asks_near(worker->question)) {
            test_near(worker, kind, chunk, i);
        } else if (worker->question->mode == PCCD_MODE_PAIRS) {
            keep_group(worker, kind, chunk, i);
        } else {
            test_group(worker, kind, chunk, i);
        }
    }
    chunk->count = 0;
    eng_worker_should_stop(worker);
    eng_test_end(worker, kind, count, begin_ns);
}
