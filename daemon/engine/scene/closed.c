/* closed.c - is a mesh closed? */
#include "closed.h"

#include <assert.h>
#include <string.h>

#include "feature.h"
#include "memory.h"

/* What a mesh keeps: this, or the number of its first open edge + FIRST_OPEN. */
enum { NOT_KNOWN = 0, CLOSED = 1, FIRST_OPEN = 2 };

/* *balance: of each edge, runs up less runs down, modulo 2^32. */
static void count_runs(const struct eng_mesh *mesh, const uint32_t *first,
                       uint32_t *balance)
{
    for (uint32_t i = 0; i < mesh->info.triangle_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = mesh->leaves[i].v[k];
            uint32_t to = mesh->leaves[i].v[(k + 1) % 3];
            if (from != to) {
                balance[eng_feature_edge(mesh, first, from, to)] += from < to ? 1 : -1u;
            }
        }
    }
}

static int find_out(const struct eng_mesh *mesh, uint32_t *state)
{
    uint32_t *first = eng_alloc((size_t)mesh->info.vertex_count + 1, sizeof *first);
    uint32_t *balance = eng_alloc((size_t)mesh->info.edge_count + 1, sizeof *balance);
    int status = first && balance ? PCCD_OK : PCCD_E_NOMEM;
    if (status == PCCD_OK) {
        memset(balance, 0, ((size_t)mesh->info.edge_count + 1) * sizeof *balance);
        eng_feature_index(mesh, first);
        count_runs(mesh, first, balance);
        uint32_t edge = 0;
        while (edge < mesh->info.edge_count && balance[edge] == 0) {
            edge++;
        }
        *state = edge < mesh->info.edge_count ? FIRST_OPEN + edge : CLOSED;
    }
    eng_free(first);
    eng_free(balance);
    return status;
}

static void describe(const struct eng_mesh *mesh, uint32_t edge,
                     struct eng_open_edge *open)
{
    const uint32_t *ends = mesh->edges[edge];
    *open = (struct eng_open_edge){{ends[0], ends[1]}, {0, 0}};
    for (uint32_t i = 0; i < mesh->info.triangle_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = mesh->leaves[i].v[k];
            uint32_t to = mesh->leaves[i].v[(k + 1) % 3];
            open->runs[0] += from == ends[0] && to == ends[1];
            open->runs[1] += from == ends[1] && to == ends[0];
        }
    }
}

int eng_mesh_is_closed(struct eng_mesh *mesh, struct eng_open_edge *open)
{
    assert(mesh->committed);
    uint32_t state = atomic_load_explicit(&mesh->closed, memory_order_relaxed);
    if (state == NOT_KNOWN) {
        int status = find_out(mesh, &state);
        if (status != PCCD_OK) {
            return status;
        }
        atomic_store_explicit(&mesh->closed, state, memory_order_relaxed);
    }
    if (state == CLOSED) {
        return PCCD_OK;
    }
    describe(mesh, state - FIRST_OPEN, open);
    return PCCD_E_INVAL;
}
