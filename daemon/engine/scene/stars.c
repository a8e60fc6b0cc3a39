/* stars.c - the leaves around a vertex. */
#include "topology.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

struct eng_stars {
    uint64_t *first;  /* [vertex_count + 1] */
    uint32_t *leaves; /* [first[vertex_count]] */
};

static void stars_free(struct eng_stars *stars)
{
    if (stars) {
        eng_free(stars->first);
        eng_free(stars->leaves);
        eng_free(stars);
    }
}

/* Corners that are the same count once. */
static bool is_first_corner(const struct eng_face *leaf, uint32_t k)
{
    return k == 0 || (leaf->v[k] != leaf->v[0] && (k == 1 || leaf->v[k] != leaf->v[1]));
}

static struct eng_stars *make(const struct eng_mesh *mesh)
{
    const size_t count = mesh->info.vertex_count;
    struct eng_stars *stars = eng_alloc(1, sizeof *stars);
    if (!stars) {
        return NULL;
    }
    stars->first = eng_alloc(count + 1, sizeof *stars->first);
    stars->leaves = eng_alloc(3 * (size_t)mesh->leaf_count, sizeof *stars->leaves);
    if (!stars->first || !stars->leaves) {
        stars_free(stars);
        return NULL;
    }
    memset(stars->first, 0, (count + 1) * sizeof *stars->first);
    for (uint32_t i = 0; i < mesh->leaf_count; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            stars->first[mesh->leaves[i].v[k]] += is_first_corner(&mesh->leaves[i], k);
        }
    }
    uint64_t end = 0;
    for (size_t v = 0; v <= count; v++) {
        end += stars->first[v];
        stars->first[v] = end;
    }
    for (uint32_t i = mesh->leaf_count; i-- > 0;) {
        for (uint32_t k = 0; k < 3; k++) {
            if (is_first_corner(&mesh->leaves[i], k)) {
                stars->leaves[--stars->first[mesh->leaves[i].v[k]]] = i;
            }
        }
    }
    return stars;
}

int eng_stars_prepare(struct eng_mesh *mesh)
{
    assert(mesh->committed);
    if (atomic_load_explicit(&mesh->stars, memory_order_acquire)) {
        return PCCD_OK;
    }
    struct eng_account *before = eng_charge_to(mesh->account);
    struct eng_stars *made = make(mesh);
    struct eng_stars *none = NULL;
    int status = made ? PCCD_OK : PCCD_E_NOMEM;
    /* Release: whoever sees the lists sees what is in them. */
    if (made && !atomic_compare_exchange_strong_explicit(&mesh->stars, &none, made,
                                                         memory_order_acq_rel,
                                                         memory_order_acquire)) {
        stars_free(made); /* another thread was first */
    }
    (void)eng_charge_to(before);
    return status;
}

const uint32_t *eng_stars_of(const struct eng_mesh *mesh, uint32_t v, uint64_t *count)
{
    const struct eng_stars *stars =
        atomic_load_explicit(&mesh->stars, memory_order_acquire);
    *count = stars->first[v + 1] - stars->first[v];
    return stars->leaves + stars->first[v];
}

void eng_stars_deinit(struct eng_mesh *mesh)
{
    stars_free(atomic_load_explicit(&mesh->stars, memory_order_acquire));
}

uint64_t eng_stars_bytes(const struct eng_mesh *mesh)
{
    return atomic_load_explicit(&mesh->stars, memory_order_acquire)
               ? ((uint64_t)mesh->info.vertex_count + 1) * sizeof(uint64_t) +
                     (uint64_t)mesh->leaf_count * 3 * sizeof(uint32_t)
               : 0;
}
