/* near_warm.c - where the search for the nearest begins. */
#include "near_warm.h"

#include <assert.h>
#include <string.h>

#include "memory.h"

#define CAPACITY_LEAST 16u
#define CAPACITY_MOST  (1u << 22) /* 80 MiB */

void eng_near_warm_deinit(struct eng_near_warm *warm)
{
    eng_free(warm->entries);
    *warm = (struct eng_near_warm){0};
}

uint64_t eng_near_warm_bytes(const struct eng_near_warm *warm)
{
    return warm->capacity * sizeof *warm->entries;
}

void eng_near_warm_forget(struct eng_near_warm *warm)
{
    if (warm->count > 0) {
        memset(warm->entries, 0, warm->capacity * sizeof *warm->entries);
        warm->count = 0;
    }
}

/* Pairs are of two different objects. */
static bool is_free(const struct pccd_pair *entry)
{
    return entry->object_a == entry->object_b;
}

/* The entry of two objects, by id, or the free one where it belongs. */
static struct pccd_pair *entry_of(const struct eng_near_warm *warm, uint32_t a,
                                  uint32_t b)
{
    uint64_t low = a < b ? a : b;
    uint64_t high = a < b ? b : a;
    uint64_t mixed = (high << 32 | low) * UINT64_C(0x9e3779b97f4a7c15);
    uint32_t at = (uint32_t)(mixed >> 32) & (warm->capacity - 1);
    for (;;) {
        struct pccd_pair *entry = &warm->entries[at];
        if (is_free(entry) || (entry->object_a == a && entry->object_b == b) ||
            (entry->object_a == b && entry->object_b == a)) {
            return entry;
        }
        at = (at + 1) & (warm->capacity - 1);
    }
}

static bool reserve(struct eng_near_warm *warm, uint64_t count)
{
    uint32_t capacity = warm->capacity > 0 ? warm->capacity : CAPACITY_LEAST;
    while (capacity < 2 * count && capacity < CAPACITY_MOST) {
        capacity *= 2;
    }
    if (capacity < 2 * count) {
        return false;
    }
    if (capacity > warm->capacity) {
        struct pccd_pair *entries = eng_alloc(capacity, sizeof *entries);
        if (!entries) {
            return false;
        }
        memset(entries, 0, capacity * sizeof *entries);
        eng_free(warm->entries);
        warm->entries = entries;
        warm->capacity = capacity;
    }
    return true;
}

void eng_near_warm_learn(struct eng_near_warm *warm, const struct pccd_near *records,
                         uint64_t count)
{
    eng_near_warm_forget(warm);
    if (!reserve(warm, count)) {
        return;
    }
    for (uint64_t i = 0; i < count; i++) {
        const struct pccd_near *record = &records[i];
        assert(record->object_a != record->object_b);
        *entry_of(warm, record->object_a, record->object_b) =
            (struct pccd_pair){.kind = record->kind,
                               .object_a = record->object_a,
                               .feature_a = record->feature_a,
                               .object_b = record->object_b,
                               .feature_b = record->feature_b};
    }
    warm->count = (uint32_t)count;
}

bool eng_near_warm_find(const struct eng_near_warm *warm, const struct eng_scene *scene,
                        uint32_t a, uint32_t b, struct eng_near_pair *pair)
{
    if (warm->count == 0) {
        return false;
    }
    const struct pccd_pair *entry =
        entry_of(warm, scene->objects[a].id, scene->objects[b].id);
    if (is_free(entry)) {
        return false;
    }
    bool is_turned = entry->object_a != scene->objects[a].id;
    uint32_t first = is_turned ? b : a;
    uint32_t second = is_turned ? a : b;
    if (entry->kind == PCCD_VF) {
        *pair = eng_near_vf(scene, first, entry->feature_a, second, entry->feature_b);
    } else if (entry->kind == PCCD_EF) {
        *pair =
            eng_near_ef(scene, first, scene->objects[first].mesh->edges[entry->feature_a],
                        second, entry->feature_b);
    } else {
        *pair =
            eng_near_ee(scene, first, scene->objects[first].mesh->edges[entry->feature_a],
                        second, scene->objects[second].mesh->edges[entry->feature_b]);
    }
    return true;
}
