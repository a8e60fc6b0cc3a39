/* paper_test.c - the candidates of a chunk, as the narrow phase takes them. */
#include <string.h>

#include "narrow.h"
#include "paper_work.h"
#include "trees.h"

/* The vertices of a candidate; of fewer than four the last is repeated. */
static void get_vertices(const struct eng_trees *trees, uint32_t kind, uint32_t a,
                         uint32_t b, uint32_t *v)
{
    const uint32_t *points = common_kinds[kind].points;
    eng_feature_vertices(trees, points[0], a, v);
    eng_feature_vertices(trees, points[1], b, v + points[0]);
    for (uint32_t i = points[0] + points[1]; i < 4; i++) {
        v[i] = v[i - 1];
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

/* Pairs whose points are copied at a time: 10 KiB. */
#define GROUP 32u

struct group {
    struct eng_point points[5 * GROUP];
    uint32_t indices[5 * GROUP]; /* 4 of a pair, of EF 5 */
};

/* A vertex, its index in the scene in `v`, and the words of narrow.h. */
static void load_point_of(const struct eng_scene *scene, uint32_t v,
                          struct eng_point *point)
{
    uint32_t at = eng_trees_of(scene)->vertices[v].object;
    const struct eng_object *object = &scene->objects[at];
    memcpy(point->x0, scene->x[1 - scene->now][v], sizeof point->x0);
    memcpy(point->x1, scene->x[scene->now][v], sizeof point->x1);
    point->word0 = (uint64_t)at << 32 | v;
    point->word1 = (uint64_t)object->id << 32 | (v - object->vertices.first);
}

/* The points of candidates first .. first + GROUP - 1. */
static struct eng_pairs load_group(const struct eng_scene *scene, uint32_t kind,
                                   const struct eng_chunk *chunk, uint32_t first,
                                   struct group *group)
{
    uint32_t count = chunk->count - first < GROUP ? chunk->count - first : GROUP;
    uint32_t width = kind == PCCD_EF ? 5 : 4;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t v[5];
        get_vertices(eng_trees_of(scene), kind, chunk->a[first + i], chunk->b[first + i],
                     v);
        for (uint32_t k = 0; k < width; k++) {
            uint32_t at = width * i + k;
            load_point_of(scene, v[k], &group->points[at]);
            group->indices[at] = at;
        }
    }
    return (struct eng_pairs){.kind = kind,
                              .known = ENG_KNOWN_BOXES,
                              .count = count,
                              .points = group->points,
                              .quads = (const uint32_t(*)[4])(const void *)group->indices,
                              .fives =
                                  (const uint32_t(*)[5])(const void *)group->indices};
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

void eng_test_chunk(struct eng_worker *worker, enum pccd_kind kind)
{
    uint64_t begin_ns = common_now_ns();
    struct eng_paper_work *work = eng_paper_work_of(worker);
    struct eng_chunk *chunk = &work->chunks[kind];
    uint32_t count = chunk->count;
    eng_count_candidates(worker, kind, count);
    for (uint32_t i = 0; i < count && !eng_stop_is_set(worker->stop); i += GROUP) {
        struct group group;
        struct eng_pairs pairs = load_group(worker->scene, kind, chunk, i, &group);
        work->group_first = i;
        eng_narrow_test(worker, &pairs, name_candidates);
    }
    chunk->count = 0;
    eng_worker_should_stop(worker);
    eng_count_test_time(worker, kind, count, begin_ns);
}
