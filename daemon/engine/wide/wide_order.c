/* daemon/engine/wide/wide_order.c - the order in which an object's features are stored.
 *
 * Room:     engine.
 * Does:     median splits of the centroids, the first ones of them until there is a part
 *           for every thread, and then the parts.
 * Threads:  [any]; opens parallel regions if it is told to. The order does not depend on
 *           how many threads made it: each split is of a list that they do not change.
 */
#include "wide_order.h"

#include <assert.h>
#include <string.h>

#include "boxes.h"
#include "memory.h"
#include "topology.h"

/* Features of an object below which one thread orders them: some 3 ms. */
#define TEAM_FEATURES_MIN 32768u

/* Parts for each thread, so that they end together, and of the three trees at most. */
#define PARTS_PER_THREAD 8u
#define PARTS_MAX        (ENG_WIDE_KINDS << 8)

/* Where to split `count` > least items. */
static uint32_t middle_of(uint32_t count, uint32_t least)
{
    uint64_t step = least;
    while (step * ENG_WIDE < count) {
        step *= ENG_WIDE;
    }
    uint64_t middle = (count / 2 + step / 2) / step * step;
    return (uint32_t)(middle > 0 ? middle : step);
}

/* Split a part that is longer than `least` in two; returns the second, or none. */
static struct eng_wide_range split(struct eng_split_item *items,
                                   struct eng_wide_range *part, uint32_t least)
{
    struct eng_split_item *first = items + part->first;
    uint32_t count = part->count;
    if (count <= least) {
        return (struct eng_wide_range){part->first + count, 0};
    }
    part->count = middle_of(count, least);
    eng_median_split(first, count, part->count, eng_median_axis(first, count));
    return (struct eng_wide_range){part->first + part->count, count - part->count};
}

void eng_wide_sorter_begin(struct eng_wide_sorter *sorter, uint32_t count, uint32_t least)
{
    sorter->least = least;
    sorter->waiting = 1;
    sorter->stack[0] = (struct eng_wide_range){0, count};
    sorter->is_splitting = false;
}

/* A range is split near its middle, so that of n < 2^32 items no more wait at a time than
 * there are levels, and one. */
static void push(struct eng_wide_sorter *sorter, struct eng_wide_range range)
{
    assert(sorter->waiting < sizeof sorter->stack / sizeof *sorter->stack);
    sorter->stack[sorter->waiting++] = range;
}

static void sort_range(struct eng_split_item *items, struct eng_wide_range all,
                       uint32_t least)
{
    struct eng_wide_sorter sorter;
    eng_wide_sorter_begin(&sorter, all.count, least);
    while (sorter.waiting > 0) {
        struct eng_wide_range range = sorter.stack[--sorter.waiting];
        if (range.count > least) {
            struct eng_wide_range second = split(items + all.first, &range, least);
            push(&sorter, second);
            push(&sorter, range);
        }
    }
}

/* One more pass over the range that is being split. */
static void pass(struct eng_wide_sorter *sorter, struct eng_split_item *items)
{
    struct eng_wide_range range = sorter->range;
    if (eng_median_round(&sorter->median, items + range.first)) {
        uint32_t middle = sorter->median.middle;
        push(sorter, (struct eng_wide_range){range.first + middle, range.count - middle});
        push(sorter, (struct eng_wide_range){range.first, middle});
        sorter->is_splitting = false;
    }
}

bool eng_wide_sorter_advance(struct eng_wide_sorter *sorter, struct eng_split_item *items,
                             uint32_t whole)
{
    if (sorter->is_splitting) {
        pass(sorter, items);
        return true;
    }
    if (sorter->waiting == 0) {
        return false;
    }
    struct eng_wide_range range = sorter->stack[--sorter->waiting];
    if (range.count <= whole) {
        sort_range(items, range, sorter->least);
    } else if (range.count > sorter->least) {
        sorter->range = range;
        sorter->is_splitting = true;
        eng_median_begin(&sorter->median, range.count,
                         middle_of(range.count, sorter->least),
                         eng_median_axis(items + range.first, range.count));
    }
    return true;
}

void eng_wide_sort(struct eng_split_item *items, uint32_t count, uint32_t least)
{
    sort_range(items, (struct eng_wide_range){0, count}, least);
}

/* All parts, by as many threads. */
static void sort_parts(struct eng_split_item *items, struct eng_wide_range *parts,
                       uint32_t count, int threads)
{
    while (threads > 1 && count < (uint32_t)threads * PARTS_PER_THREAD &&
           2 * count <= PARTS_MAX) {
#pragma omp parallel for schedule(dynamic) num_threads(threads)
        for (uint32_t i = 0; i < count; i++) {
            parts[count + i] = split(items, &parts[i], ENG_WIDE);
        }
        count *= 2;
    }
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (uint32_t i = 0; i < count; i++) {
        sort_range(items, parts[i], ENG_WIDE);
    }
}

/* The centroid of `count` vertices times their number: the order is the same. */
static struct eng_split_item item_of(const double (*x)[3], const uint32_t *vertices,
                                     uint32_t count, uint32_t id)
{
    struct eng_split_item item = {.id = id};
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (uint32_t i = 0; i < count; i++) {
            sum += x[vertices[i]][k];
        }
        item.centroid[k] = (float)sum;
    }
    return item;
}

uint32_t eng_wide_order_sources(const struct eng_mesh *mesh, enum eng_wide_kind kind)
{
    return kind == ENG_WIDE_EDGES ? mesh->info.edge_count : mesh->info.triangle_count;
}

uint32_t eng_wide_order_list(const struct eng_mesh *mesh, const double (*x)[3],
                             enum eng_wide_kind kind, uint32_t first, uint32_t count,
                             struct eng_split_item *items)
{
    uint32_t listed = 0;
    for (uint32_t i = first; i < first + count; i++) {
        if (kind == ENG_WIDE_EDGES) {
            items[listed++] = item_of(x, mesh->edges[i], 2, i);
            continue;
        }
        const struct eng_face *triangle = &mesh->triangles[i];
        if (kind == ENG_WIDE_FACES) {
            items[listed++] = item_of(x, triangle->v, 3, i);
            continue;
        }
        for (unsigned k = 0; k < 3; k++) {
            if (triangle->owns & ENG_OWNS_VERTEX(k)) {
                items[listed++] = item_of(x, &triangle->v[k], 1, triangle->v[k]);
            }
        }
    }
    return listed;
}

static int threads_for(size_t features, uint32_t threads)
{
    uint32_t most = PARTS_MAX / ENG_WIDE_KINDS;
    return features < TEAM_FEATURES_MIN || threads == 0 ? 1
           : threads < most                             ? (int)threads
                                                        : (int)most;
}

int eng_wide_order_new(const struct eng_mesh *mesh, const double (*x)[3],
                       uint32_t threads, struct eng_wide_order **order)
{
    const struct eng_mesh_info *info = &mesh->info;
    const uint32_t count[ENG_WIDE_KINDS] = {info->vertex_count - info->isolated_count,
                                            info->edge_count, info->triangle_count};
    size_t all = (size_t)count[0] + count[1] + count[2];
    struct eng_wide_order *made =
        eng_alloc(1, sizeof *made + all * sizeof *made->feature[0]);
    struct eng_split_item *items = made ? eng_alloc(all, sizeof *items) : NULL;
    struct eng_wide_range *parts = items ? eng_alloc(PARTS_MAX, sizeof *parts) : NULL;
    if (!parts) {
        eng_free(items);
        eng_free(made);
        return ENG_E_NOMEM;
    }
    uint32_t *next = (uint32_t *)(void *)(made + 1);
    size_t first = 0;
    for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        uint32_t listed = eng_wide_order_list(
            mesh, x, kind, 0, eng_wide_order_sources(mesh, kind), items + first);
        assert(listed == count[kind]);
        made->count[kind] = listed;
        made->feature[kind] = next + first;
        parts[kind] = (struct eng_wide_range){first, listed};
        first += listed;
    }
    sort_parts(items, parts, ENG_WIDE_KINDS, threads_for(all, threads));
    for (size_t i = 0; i < all; i++) {
        next[i] = items[i].id;
    }
    eng_free(parts);
    eng_free(items);
    *order = made;
    return ENG_OK;
}

uint64_t eng_wide_order_bytes(const struct eng_wide_order *order)
{
    uint64_t bytes = sizeof *order;
    for (int kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        bytes += (uint64_t)order->count[kind] * sizeof *order->feature[kind];
    }
    return bytes;
}
