/* masks.c - which objects of a scene are tested against each other. */
#include "masks.h"

#include <assert.h>
#include <string.h>

#include "array.h"
#include "memory.h"

static const struct eng_masks_entry at_first = {
    .group = 1, .mask = UINT64_MAX, .self = true};

void eng_masks_init(struct eng_masks *masks)
{
    memset(masks, 0, sizeof *masks);
}

void eng_masks_deinit(struct eng_masks *masks)
{
    eng_free(masks->entries);
    eng_pairset_deinit(&masks->ignored);
}

uint64_t eng_masks_bytes(const struct eng_masks *masks)
{
    return (uint64_t)masks->capacity * sizeof *masks->entries +
           eng_pairset_bytes(&masks->ignored);
}

int eng_masks_reserve(struct eng_masks *masks, uint32_t capacity)
{
    if (capacity <= masks->capacity) {
        return PCCD_OK;
    }
    if (eng_array_grow(&masks->entries, capacity, sizeof *masks->entries) != PCCD_OK) {
        return PCCD_E_NOMEM;
    }
    for (uint32_t i = masks->capacity; i < capacity; i++) {
        masks->entries[i] = at_first;
    }
    masks->capacity = capacity;
    return PCCD_OK;
}

void eng_masks_set(struct eng_masks *masks, uint32_t object,
                   const struct eng_object_filter *bits)
{
    assert(object < masks->capacity && bits);
    struct eng_masks_entry *entry = &masks->entries[object];
    masks->changed_count -= entry->is_changed;
    entry->group = bits->group;
    entry->mask = bits->mask;
    entry->self = bits->self;
    entry->is_changed = entry->group != at_first.group || entry->mask != at_first.mask ||
                        entry->self != at_first.self;
    masks->changed_count += entry->is_changed;
    masks->version++;
}

void eng_masks_leave_out(struct eng_masks *masks, uint32_t object, enum eng_self left_out)
{
    assert(object < masks->capacity);
    struct eng_masks_entry *entry = &masks->entries[object];
    masks->left_out_count -= entry->left_out != ENG_SELF_TESTED;
    masks->left_out_count += left_out != ENG_SELF_TESTED;
    entry->left_out = left_out;
}

int eng_masks_ignore(struct eng_masks *masks, uint32_t a, uint32_t b, bool ignored)
{
    assert(a != b && a < masks->capacity && b < masks->capacity);
    bool was_ignored = eng_masks_ignores(masks, a, b);
    if (ignored == was_ignored) {
        return PCCD_OK;
    }
    if (!ignored) {
        eng_pairset_remove(&masks->ignored, a, b);
        masks->entries[a].ignored--;
        masks->entries[b].ignored--;
        masks->version++;
        return PCCD_OK;
    }
    if (masks->ignored.count >= PROTO_IGNORED_PER_SCENE) {
        return PCCD_E_LIMIT;
    }
    int status = eng_pairset_add(&masks->ignored, a, b);
    if (status == PCCD_OK) {
        masks->entries[a].ignored++;
        masks->entries[b].ignored++;
        masks->version++;
    }
    return status;
}

void eng_masks_exclude(struct eng_masks *masks, uint32_t object)
{
    assert(object < masks->capacity);
    const struct eng_object_filter nothing = {.group = 0, .mask = 0, .self = false};
    eng_masks_set(masks, object, &nothing);
    masks->entries[object].is_excluded = true;
}

static bool goes(void *context, uint32_t a, uint32_t b)
{
    const struct eng_masks *masks = context;
    if (!masks->entries[a].is_excluded && !masks->entries[b].is_excluded) {
        return false;
    }
    masks->entries[a].ignored--;
    masks->entries[b].ignored--;
    return true;
}

void eng_masks_purge_excluded(struct eng_masks *masks)
{
    eng_pairset_prune(&masks->ignored, goes, masks);
    masks->version++;
}

void eng_masks_forget(struct eng_masks *masks, uint32_t object)
{
    assert(object < masks->capacity);
    struct eng_masks_entry *entry = &masks->entries[object];
    uint32_t from = 0;
    uint32_t other;
    while (entry->ignored > 0 &&
           eng_pairset_take(&masks->ignored, object, &from, &other)) {
        entry->ignored--;
        masks->entries[other].ignored--;
    }
    masks->changed_count -= entry->is_changed;
    masks->left_out_count -= entry->left_out != ENG_SELF_TESTED;
    *entry = at_first;
    masks->version++;
}
