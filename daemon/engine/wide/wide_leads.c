/* wide_leads.c - the pairs that bounded vertices in the last answer. */
#include "wide_leads.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

/* Vertices that are taken at a time: their pairs fit a chunk. */
#define TAKEN ENG_CHUNK_MAX

void eng_wide_leads_deinit(struct eng_wide_leads *leads)
{
    eng_free((void *)leads->of);
    memset(leads, 0, sizeof *leads);
}

uint64_t eng_wide_leads_bytes(const struct eng_wide_leads *leads)
{
    return leads->capacity * sizeof *leads->of;
}

static void forget(struct eng_wide_leads *leads)
{
    for (uint32_t i = 0; i < leads->capacity; i++) {
        atomic_init(&leads->of[i], 0);
    }
}

int eng_wide_leads_reserve(struct eng_wide_leads *leads, const struct eng_wide *wide)
{
    uint32_t slots = wide->trees[PCCD_TREE_VERTICES].slot_count;
    if (slots <= leads->capacity) {
        return PCCD_OK;
    }
    eng_wide_leads_deinit(leads);
    leads->of = eng_alloc(slots, sizeof *leads->of);
    if (!leads->of) {
        return PCCD_E_NOMEM;
    }
    leads->capacity = slots;
    forget(leads);
    return PCCD_OK;
}

void eng_wide_leads_begin(struct eng_wide_leads *leads, const struct eng_wide *wide,
                          uint32_t masks_version)
{
    if (leads->assembled != wide->assembled || leads->masks_version != masks_version) {
        forget(leads);
    }
    leads->assembled = wide->assembled;
    leads->masks_version = masks_version;
    atomic_store_explicit(&leads->next, 0, memory_order_relaxed);
}

static uint64_t lead_of(const struct eng_wide_leads *leads, uint32_t vertex)
{
    return atomic_load_explicit(&leads->of[vertex], memory_order_relaxed);
}

/* Return whether no vertex of a feature that comes before `vertex` has that pair. */
static bool is_first(const struct eng_wide_leads *leads, const struct eng_wide *wide,
                     enum pccd_tree tree, uint32_t slot, uint32_t vertex, uint64_t lead)
{
    for (uint32_t k = 0; k <= (uint32_t)tree; k++) {
        uint32_t other =
            tree == PCCD_TREE_VERTICES ? slot : wide->trees[tree].corner[k][slot];
        if (other < vertex && lead_of(leads, other) == lead) {
            return false;
        }
    }
    return true;
}

bool eng_wide_leads_take(struct eng_wide_leads *leads, const struct eng_wide *wide,
                         struct eng_wide_chunk *chunks)
{
    const uint32_t slots = wide->trees[PCCD_TREE_VERTICES].slot_count;
    /* Relaxed: each vertex is handed out once, and what it leads to is only a hint. */
    uint32_t first = atomic_fetch_add_explicit(&leads->next, TAKEN, memory_order_relaxed);
    if (first >= slots) {
        return false;
    }
    uint32_t end = slots - first < TAKEN ? slots : first + TAKEN;
    for (uint32_t vertex = first; vertex < end; vertex++) {
        uint64_t lead = lead_of(leads, vertex);
        enum pccd_kind kind = lead >> 62 & 1 ? PCCD_EE : PCCD_VF;
        uint32_t a = lead >> 31 & 0x7fffffff;
        uint32_t b = lead & 0x7fffffff;
        struct eng_wide_chunk *chunk = &chunks[kind];
        if (lead != 0 &&
            is_first(leads, wide, eng_wide_tree_of(kind, 0), a, vertex, lead) &&
            is_first(leads, wide, eng_wide_tree_of(kind, 1), b, vertex, lead)) {
            assert(chunk->count < ENG_CHUNK_MAX);
            chunk->a[chunk->count] = a;
            chunk->b[chunk->count++] = b;
        }
    }
    return true;
}
