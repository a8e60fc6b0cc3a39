/* wide_pieces.c - the pieces that a mesh consists of. */
#include "wide_pieces.h"

#include "topology.h"

static uint32_t root_of(uint32_t *parent, uint32_t vertex)
{
    while (parent[vertex] != vertex) {
        parent[vertex] = parent[parent[vertex]];
        vertex = parent[vertex];
    }
    return vertex;
}

/* The lesser root becomes the parent, so that no parent is greater than its child. */
static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    if (parent[a] == parent[b]) {
        return; /* as of most neighbours */
    }
    a = root_of(parent, a);
    b = root_of(parent, b);
    if (a < b) {
        parent[b] = a;
    } else {
        parent[a] = b;
    }
}

uint32_t eng_wide_pieces_find(const struct eng_mesh *mesh, uint32_t *of)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh->info.vertex_count; i++) {
        of[i] = ENG_WIDE_NO_PIECE;
    }
    for (uint32_t i = 0; i < mesh->leaf_count; i++) {
        const uint32_t *v = mesh->leaves[i].v;
        for (int k = 0; k < 3; k++) {
            of[v[k]] = of[v[k]] == ENG_WIDE_NO_PIECE ? v[k] : of[v[k]];
        }
        join(of, v[0], v[1]);
        join(of, v[0], v[2]);
    }
    /* Parents turn into numbers from the first vertex on: each one's parent has its own
     * by then. */
    for (uint32_t i = 0; i < mesh->info.vertex_count; i++) {
        if (of[i] != ENG_WIDE_NO_PIECE) {
            of[i] = of[i] == i ? count++ : of[of[i]];
        }
    }
    return count;
}
