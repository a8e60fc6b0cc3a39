/* wide_join.c - from two nodes to the pairs of features below them.
 *
 * See wide_join.h. Each level has a list of pairs that wait; one is refined into the list
 * of the level below, at most 256, before the next is taken. The blocks of features that
 * two nodes lead to are joined all at a time.
 */
#include "wide_join.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "wide.h"
#include "wide_cells.h"
#include "wide_owner.h"

/* Joins of two blocks between two looks: some 200 us. */
#define JOINS_PER_LOOK 1024u

/* Bounds on time that are near. Boxes around the way until then are hardly larger than
 * boxes that move, and take half as long to compare. Nor are times looked at: hardly
 * anything comes or goes until then, and what is apart at first is left out for that. */
#define NEAR_MOST 0x1p-4f

/* The marks of what is not foreign, of a side of a kind; NULL: there are none, or what is
 * on that side is first in no pair. */
static const uint16_t *own_marks(const struct eng_wide *wide, enum pccd_kind kind,
                                 int side, uint32_t level)
{
    const struct eng_wide_tree *tree = &wide->trees[eng_wide_tree_of(kind, side)];
    bool may_be_first = eng_wide_tree_of(kind, side) == eng_wide_tree_of(kind, 0);
    return tree->has_own && may_be_first ? tree->own + tree->first[level] : NULL;
}

/* Set the keys, which say which of two features comes first. */
static void set_keys(const struct eng_wide *wide, enum pccd_kind kind,
                     struct eng_join *job)
{
    enum pccd_tree tree = eng_wide_tree_of(kind, 0);
    bool is_of_vertices = tree == PCCD_TREE_VERTICES;
    job->keys = is_of_vertices ? &wide->points[0].word1 : wide->trees[tree].keys;
    job->key_stride = is_of_vertices ? sizeof *wide->points / sizeof *job->keys : 1;
}

void eng_wide_join_begin(struct eng_wide_join *join, const struct eng_wide *wide,
                         enum eng_join_boxes boxes)
{
    assert(wide->level_count >= 1 && wide->level_count <= ENG_WIDE_LEVELS_MAX);
    uint32_t farthest = atomic_load_explicit(&wide->farthest, memory_order_relaxed);
    join->kernels = wide->kernels;
    join->wide = wide;
    join->owners = NULL;
    join->kinds = eng_wide_asked_kinds(wide, false);
    join->stopped = false;
    join->looked = 0;
    join->pairs = 0;
    memset(join->below, 0, sizeof join->below);
    memset(join->jobs, 0, sizeof join->jobs);
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        const struct eng_wide_tree *a = &wide->trees[eng_wide_tree_of(kind, 0)];
        const struct eng_wide_tree *b = &wide->trees[eng_wide_tree_of(kind, 1)];
        bool is_quantised = boxes != ENG_JOIN_SWEPT && wide->has_quantised;
        join->chunks[kind].count = 0;
        for (uint32_t level = 0; level < wide->level_count; level++) {
            struct eng_join *job = &join->jobs[kind][level];
            *job = (struct eng_join){.a_own = own_marks(wide, kind, 0, level),
                                     .b_own = own_marks(wide, kind, 1, level),
                                     .boxes = boxes,
                                     .farthest = farthest,
                                     .t_end = 1};
            if (job->b_own && level == 0) {
                set_keys(wide, kind, job);
            }
            if (is_quantised) {
                job->a_quantised = a->quantised + a->first[level];
                job->b_quantised = b->quantised + b->first[level];
                job->b_quantised_boxes = b->quantised_boxes + b->first[level];
            } else {
                job->a = eng_wide_blocks(a, level);
                job->b = eng_wide_blocks(b, level);
                job->b_boxes = eng_wide_boxes(b, level);
            }
            for (int k = 0; k < 3; k++) {
                job->a_corner[k] = a->corner[k];
                job->b_corner[k] = b->corner[k];
            }
        }
    }
    for (uint32_t level = 0; level < wide->level_count; level++) {
        join->lists[level].count = 0;
    }
}

void eng_wide_join_prune(struct eng_wide_join *join, const struct eng_wide *wide)
{
    assert(wide->has_moving);
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        const struct eng_wide_tree *a = &wide->trees[eng_wide_tree_of(kind, 0)];
        const struct eng_wide_tree *b = &wide->trees[eng_wide_tree_of(kind, 1)];
        for (uint32_t level = 0; level < wide->level_count; level++) {
            join->jobs[kind][level].a_moving = a->moving + a->first[level];
            join->jobs[kind][level].b_moving = b->moving + b->first[level];
        }
    }
}

/* More cells than there are: from the least number to the greatest. */
#define CELLS_MOST (1 << 17)

/* A distance in whole cells. */
static int32_t cells_of(float distance, float scale)
{
    float cells = ceilf(distance * scale);
    return cells < CELLS_MOST ? (int32_t)cells : CELLS_MOST;
}

void eng_wide_join_at(struct eng_wide_join *join, const struct eng_wide *wide,
                      const struct eng_question *question)
{
    assert(question->end <= 1 && question->sought.growth >= 0);
    join->kinds =
        question->sought.kinds & (eng_wide_asked_kinds(wide, true) | 1u << PCCD_EF);
    for (uint32_t level = 0; level < ENG_WIDE_LEVELS_MAX; level++) {
        for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
            struct eng_join *job = &join->jobs[kind][level];
            float growth = eng_near_growth_of(question, kind);
            job->end = question->end;
            job->growth = growth;
            for (int k = 0; k < 3; k++) {
                job->cells[k] = cells_of(growth, wide->quantising.scale[k]);
            }
        }
    }
}

void eng_wide_join_until(struct eng_wide_join *join, float t_end)
{
    assert(t_end >= 0 && t_end <= 1);
    for (uint32_t level = 0; level < ENG_WIDE_LEVELS_MAX; level++) {
        for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
            struct eng_join *job = &join->jobs[kind][level];
            job->t_end = t_end;
            if (t_end <= NEAR_MOST) {
                job->boxes = ENG_JOIN_NEAR;
                job->in_time = false;
            }
        }
    }
}

static void flush(struct eng_wide_join *join, enum pccd_kind kind)
{
    join->flush(join->owner, kind, &join->chunks[kind]);
    assert(join->chunks[kind].count == 0);
}

/* Pairs of blocks of features, of one pair of nodes. */
static void join_features(struct eng_wide_join *join, enum pccd_kind kind,
                          const uint32_t *a, const uint32_t *b, uint32_t count)
{
    struct eng_join *job = &join->jobs[kind][0];
    struct eng_join_round *round = &join->round;
    struct eng_wide_chunk *chunk = &join->chunks[kind];
    eng_join_begin(round, a, b, count);
    for (;;) {
        uint32_t *out_a = chunk->a + chunk->count;
        uint32_t *out_b = chunk->b + chunk->count;
        uint32_t room = ENG_CHUNK_MAX - chunk->count;
        uint32_t found =
            join->kernels->join_features[kind](job, round, out_a, out_b, room);
        if (eng_wide_is_of_free(kind)) {
            found = eng_wide_free_keep(join->wide, kind, 0, out_a, out_b, found);
        }
        chunk->count += found;
        if (eng_join_has_ended(round) || join->stopped) {
            return;
        }
        flush(join, kind);
    }
}

/* Roots that may not meet, that stand or are foreign: of all other pairs that has been
 * seen to (keep). */
static bool is_allowed(const struct eng_wide_join *join, enum pccd_kind kind,
                       uint32_t level, uint32_t n, uint32_t m)
{
    const struct eng_join *job = &join->jobs[kind][level];
    if (job->a_moving && job->a_moving[n] == 0 && job->b_moving[m] == 0) {
        return false;
    }
    if (job->a_own && job->a_own[n] == 0 && (!job->b_own || job->b_own[m] == 0)) {
        return false;
    }
    return !join->owners || eng_wide_owners_allow(join->owners, kind, level, n, m);
}

void eng_wide_join_refine(struct eng_wide_join *join, enum pccd_kind kind, uint32_t level,
                          uint32_t n, uint32_t m)
{
    assert(level >= 1 && join->lists[level - 1].count == 0);
    struct eng_wide_list *below = &join->lists[level - 1];
    assert(below->count == 0);
    if (!is_allowed(join, kind, level, n, m)) {
        return;
    }
    eng_join_begin(&join->round, &n, &m, 1);
    below->count = join->kernels->join_nodes(&join->jobs[kind][level], &join->round,
                                             below->a, below->b, ENG_JOIN_MAX);
    join->pairs++;
    join->below[kind] += below->count;
    if (eng_wide_is_of_free(kind)) {
        below->count =
            eng_wide_free_keep(join->wide, kind, level, below->a, below->b, below->count);
    }
    if (join->owners) {
        eng_wide_owners_keep(join->owners, kind, level, n, m, below);
    }
}

void eng_wide_join_nodes(struct eng_wide_join *join, enum pccd_kind kind, uint32_t level,
                         uint32_t n, uint32_t m)
{
    uint32_t top = level;
    if (level == 0) {
        if (is_allowed(join, kind, level, n, m)) {
            join_features(join, kind, &n, &m, 1);
        }
        return;
    }
    eng_wide_join_refine(join, kind, level--, n, m);
    while (level < top && !join->stopped) {
        struct eng_wide_list *list = &join->lists[level];
        if (list->count == 0) {
            level++;
            continue;
        }
        join->looked += level == 0 ? list->count : 1;
        if (join->looked >= JOINS_PER_LOOK) {
            join->looked = 0;
            join->look(join->owner);
        }
        if (level == 0) {
            join_features(join, kind, list->a, list->b, list->count);
            list->count = 0;
            continue;
        }
        list->count--;
        n = list->a[list->count];
        m = list->b[list->count];
        eng_wide_join_refine(join, kind, level--, n, m);
    }
    for (; level < top; level++) {
        join->lists[level].count = 0;
    }
}

void eng_wide_join_flush(struct eng_wide_join *join)
{
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        if (join->kinds >> kind & 1) {
            flush(join, kind);
        }
    }
}

uint64_t eng_wide_join_nodes_apart(const struct eng_wide_join *join, enum pccd_kind kind)
{
    uint64_t apart = 0;
    for (uint32_t level = 1; level < ENG_WIDE_LEVELS_MAX; level++) {
        apart += join->jobs[kind][level].apart_in_time;
    }
    return apart;
}

uint64_t eng_wide_join_test_count(const struct eng_wide_join *join)
{
    uint64_t tests = 0;
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        for (uint32_t level = 0; level < ENG_WIDE_LEVELS_MAX; level++) {
            tests += join->jobs[kind][level].tests;
        }
    }
    return tests;
}

uint64_t eng_wide_join_still_count(const struct eng_wide_join *join)
{
    uint64_t still = 0;
    for (enum pccd_kind kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        for (uint32_t level = 0; level < ENG_WIDE_LEVELS_MAX; level++) {
            still += join->jobs[kind][level].still;
        }
    }
    return still;
}
