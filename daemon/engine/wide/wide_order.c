/* daemon/engine/wide/wide_order.c - the order in which an object's features are stored.
 *
 * Room:     engine.
 * Does:     median splits of the centroids.
 * Threads:  [any].
 */
#include "wide_order.h"

#include <assert.h>
#include <string.h>

#include "boxes.h"
#include "memory.h"
#include "topology.h"

/* Ranges that wait while another is split: a range is split near its middle, so that of
 * n < 2^32 items there are no more than this. */
#define STACK_MAX 64u

struct part {
    uint32_t first;
    uint32_t count;
};

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

void eng_wide_sort(struct eng_split_item *items, uint32_t count, uint32_t least)
{
    struct part stack[STACK_MAX];
    uint32_t waiting = 0;
    stack[waiting++] = (struct part){0, count};
    while (waiting > 0) {
        struct part part = stack[--waiting];
        if (part.count <= least) {
            continue;
        }
        struct eng_split_item *first = items + part.first;
        uint32_t middle = middle_of(part.count, least);
        eng_median_split(first, part.count, middle, eng_median_axis(first, part.count));
        assert(waiting + 2 <= STACK_MAX);
        stack[waiting++] = (struct part){part.first + middle, part.count - middle};
        stack[waiting++] = (struct part){part.first, middle};
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

static uint32_t list(const struct eng_mesh *mesh, const double (*x)[3],
                     enum eng_wide_kind kind, struct eng_split_item *items)
{
    uint32_t count = 0;
    if (kind == ENG_WIDE_EDGES) {
        for (; count < mesh->info.edge_count; count++) {
            items[count] = item_of(x, mesh->edges[count], 2, count);
        }
        return count;
    }
    for (uint32_t t = 0; t < mesh->info.triangle_count; t++) {
        const struct eng_triangle *triangle = &mesh->triangles[t];
        if (kind == ENG_WIDE_FACES) {
            items[count++] = item_of(x, triangle->v, 3, t);
            continue;
        }
        for (unsigned k = 0; k < 3; k++) {
            if (triangle->owns & ENG_OWNS_VERTEX(k)) {
                items[count++] = item_of(x, &triangle->v[k], 1, triangle->v[k]);
            }
        }
    }
    return count;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

int eng_wide_order_new(const struct eng_mesh *mesh, const double (*x)[3],
                       struct eng_wide_order **order)
{
    const struct eng_mesh_info *info = &mesh->info;
    uint32_t used = info->vertex_count - info->isolated_count;
    const uint32_t count[ENG_WIDE_KINDS] = {used, info->edge_count, info->triangle_count};
    uint32_t most = larger(used, larger(info->edge_count, info->triangle_count));
    size_t all = (size_t)count[0] + count[1] + count[2];
    struct eng_wide_order *made =
        eng_alloc(1, sizeof *made + all * sizeof *made->feature[0]);
    struct eng_split_item *items = made ? eng_alloc(most, sizeof *items) : NULL;
    if (!items) {
        eng_free(made);
        return ENG_E_NOMEM;
    }
    uint32_t *next = (uint32_t *)(void *)(made + 1);
    for (enum eng_wide_kind kind = 0; kind < ENG_WIDE_KINDS; kind++) {
        uint32_t listed = list(mesh, x, kind, items);
        assert(listed == count[kind]);
        eng_wide_sort(items, listed, ENG_WIDE);
        made->count[kind] = listed;
        made->feature[kind] = next;
        for (uint32_t i = 0; i < listed; i++) {
            *next++ = items[i].id;
        }
    }
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
