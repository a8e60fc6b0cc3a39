/* rings.c - vertices that few edges join. */
#include "topology.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "memory.h"

/* Vertices of a list, on average. */
#define LENGTH_MAX 256u

struct eng_rings {
    uint64_t *first; /* [vertex_count + 1] */
    uint32_t *near;  /* [first[vertex_count]] each list in order, without its vertex */
};

static void rings_free(struct eng_rings *rings)
{
    if (rings) {
        eng_free(rings->first);
        eng_free(rings->near);
        eng_free(rings);
    }
}

static struct eng_rings *rings_new(uint32_t vertex_count, uint64_t capacity)
{
    struct eng_rings *rings = eng_alloc(1, sizeof *rings);
    if (!rings) {
        return NULL;
    }
    rings->first = eng_alloc((size_t)vertex_count + 1, sizeof *rings->first);
    rings->near = eng_alloc(capacity, sizeof *rings->near);
    if (!rings->first || !rings->near) {
        rings_free(rings);
        return NULL;
    }
    return rings;
}

/* Those of n = 1: the other ends of all edges. */
static struct eng_rings *neighbours_of(const struct eng_mesh *mesh)
{
    uint32_t count = mesh->info.vertex_count;
    struct eng_rings *rings = rings_new(count, 2 * (uint64_t)mesh->info.edge_count + 1);
    if (!rings) {
        return NULL;
    }
    memset(rings->first, 0, ((size_t)count + 1) * sizeof *rings->first);
    for (uint32_t e = 0; e < mesh->info.edge_count; e++) {
        rings->first[mesh->edges[e][0]]++;
        rings->first[mesh->edges[e][1]]++;
    }
    uint64_t end = 0;
    for (uint32_t v = 0; v <= count; v++) {
        end += rings->first[v];
        rings->first[v] = end;
    }
    for (uint32_t e = mesh->info.edge_count; e-- > 0;) {
        const uint32_t *v = mesh->edges[e];
        rings->near[--rings->first[v[0]]] = v[1];
        rings->near[--rings->first[v[1]]] = v[0];
    }
    return rings;
}

static int compare(const void *a, const void *b)
{
    const uint32_t *x = a;
    const uint32_t *y = b;
    return *x < *y ? -1 : *x > *y;
}

struct scratch {
    uint32_t *list; /* [vertex_count] */
    uint32_t *seen; /* [vertex_count] v + 1 for what is in the list of v */
    const atomic_bool *cancel;
};

static bool is_cancelled(const struct scratch *scratch)
{
    return scratch->cancel && atomic_load_explicit(scratch->cancel, memory_order_relaxed);
}

/* Add what at most n edges lead to from v to the list. Returns how many; some are missing
 * if it is cancelled. */
static uint32_t search(const struct eng_rings *neighbours, uint32_t rings, uint32_t v,
                       const struct scratch *scratch)
{
    uint32_t *list = scratch->list;
    uint32_t *seen = scratch->seen;
    uint32_t begin = 0;
    uint32_t count = 0;
    seen[v] = v + 1;
    for (uint32_t n = 0; n < rings; n++) {
        uint32_t end = n == 0 ? 1 : count;
        for (uint32_t i = begin; i < end && !is_cancelled(scratch); i++) {
            uint32_t from = n == 0 ? v : list[i];
            for (uint64_t k = neighbours->first[from]; k < neighbours->first[from + 1];
                 k++) {
                uint32_t w = neighbours->near[k];
                if (seen[w] != v + 1) {
                    seen[w] = v + 1;
                    list[count++] = w;
                }
            }
        }
        begin = n == 0 ? 0 : end;
    }
    return count;
}

/* The length of all lists, if they are not too long and it is not cancelled. */
static int measure(const struct eng_rings *neighbours, const struct eng_mesh *mesh,
                   uint32_t rings, const struct scratch *scratch, uint64_t *length)
{
    uint32_t count = mesh->info.vertex_count;
    *length = 1;
    memset(scratch->seen, 0, count * sizeof *scratch->seen);
    for (uint32_t v = 0; v < count; v++) {
        *length += search(neighbours, rings, v, scratch);
        if (*length > (uint64_t)count * LENGTH_MAX) {
            return PCCD_E_LIMIT;
        }
        if (is_cancelled(scratch)) {
            return PCCD_E_CANCELLED;
        }
    }
    return PCCD_OK;
}

static int fill(struct eng_rings *lists, const struct eng_rings *neighbours,
                const struct eng_mesh *mesh, uint32_t rings,
                const struct scratch *scratch)
{
    uint32_t count = mesh->info.vertex_count;
    uint64_t end = 0;
    memset(scratch->seen, 0, count * sizeof *scratch->seen);
    for (uint32_t v = 0; v < count; v++) {
        uint32_t found = search(neighbours, rings, v, scratch);
        if (is_cancelled(scratch)) {
            return PCCD_E_CANCELLED;
        }
        qsort(scratch->list, found, sizeof *scratch->list, compare);
        memcpy(lists->near + end, scratch->list, found * sizeof *scratch->list);
        lists->first[v] = end;
        end += found;
    }
    lists->first[count] = end;
    return PCCD_OK;
}

/* The lists of n > 0. */
static int make(const struct eng_mesh *mesh, uint32_t rings, const atomic_bool *cancel,
                struct eng_rings **made)
{
    uint32_t count = mesh->info.vertex_count;
    struct eng_rings *neighbours = neighbours_of(mesh);
    struct scratch scratch = {eng_alloc(count, sizeof(uint32_t)),
                              eng_alloc(count, sizeof(uint32_t)), cancel};
    int status = neighbours && scratch.list && scratch.seen ? PCCD_OK : PCCD_E_NOMEM;
    uint64_t length = 0;
    if (status == PCCD_OK) {
        status = measure(neighbours, mesh, rings, &scratch, &length);
    }
    if (status == PCCD_OK) {
        *made = rings_new(count, length);
        status = *made ? fill(*made, neighbours, mesh, rings, &scratch) : PCCD_E_NOMEM;
    }
    if (status != PCCD_OK) {
        rings_free(*made);
        *made = NULL;
    }
    rings_free(neighbours);
    eng_free(scratch.list);
    eng_free(scratch.seen);
    return status;
}

int eng_rings_prepare(struct eng_mesh *mesh, uint32_t rings, const atomic_bool *cancel)
{
    assert(mesh->committed && rings <= ENG_RINGS_MAX);
    struct eng_rings *made = NULL;
    if (rings == 0 ||
        atomic_load_explicit(&mesh->rings[rings - 1], memory_order_acquire)) {
        return PCCD_OK;
    }
    struct eng_account *before = eng_charge_to(mesh->account);
    int status = make(mesh, rings, cancel, &made);
    struct eng_rings *none = NULL;
    /* Release: whoever sees the lists sees what is in them. */
    if (status == PCCD_OK && !atomic_compare_exchange_strong_explicit(
                                 &mesh->rings[rings - 1], &none, made,
                                 memory_order_acq_rel, memory_order_acquire)) {
        rings_free(made); /* another thread was first */
    }
    (void)eng_charge_to(before);
    return status;
}

bool eng_rings_join(const struct eng_mesh *mesh, uint32_t rings, uint32_t v, uint32_t w)
{
    if (v == w) {
        return true;
    }
    if (rings == 0) {
        return false;
    }
    const struct eng_rings *lists =
        atomic_load_explicit(&mesh->rings[rings - 1], memory_order_acquire);
    uint64_t low = lists->first[v];
    uint64_t high = lists->first[v + 1];
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (lists->near[middle] < w) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < lists->first[v + 1] && lists->near[low] == w;
}

void eng_rings_deinit(struct eng_mesh *mesh)
{
    for (uint32_t i = 0; i < ENG_RINGS_MAX; i++) {
        rings_free(atomic_load_explicit(&mesh->rings[i], memory_order_acquire));
    }
}

uint64_t eng_rings_bytes(const struct eng_mesh *mesh)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < ENG_RINGS_MAX; i++) {
        const struct eng_rings *lists =
            atomic_load_explicit(&mesh->rings[i], memory_order_acquire);
        if (lists) {
            bytes += sizeof *lists +
                     ((uint64_t)mesh->info.vertex_count + 1) * sizeof *lists->first +
                     lists->first[mesh->info.vertex_count] * sizeof *lists->near;
        }
    }
    return bytes;
}
