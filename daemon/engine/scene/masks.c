/* masks.c - which objects of a scene are tested against each other. */
#include "masks.h"

#include <assert.h>
#include <string.h>

#include "clock.h"
#include "memory.h"
#include "pccd_types.h"

/* A hash table of pairs of numbers, each with a value, in which (a, b) and (b, a) are the
 * same pair. Changed by one thread at a time, while nobody reads; reads: [any].
 *
 * All zero is the empty set. Places are tried one after the other from the one that the
 * hash names on; a place that is taken away is filled by those behind it, so that a
 * search ends at the first empty one. */
struct eng_pairset_slot {
    uint64_t key; /* lesser << 32 | greater, or ENG_PAIRSET_EMPTY */
    double value;
};

/* ---- a set of pairs ---------------------------------------------------------------- */

#define CAPACITY_MIN 64u

static uint64_t key_of(uint32_t a, uint32_t b)
{
    assert(a != b);
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Where the search for a key begins. */
static uint32_t home_of(const struct eng_pairset *set, uint64_t key)
{
    uint64_t mixed = key * set->factor;
    mixed = (mixed ^ mixed >> 32) * 0x9e3779b97f4a7c15u;
    return (uint32_t)(mixed >> 32) & (set->capacity - 1);
}

/* The place of a key, or the empty one where it would be. At least half are empty. */
static uint32_t find(const struct eng_pairset *set, uint64_t key)
{
    uint32_t at = home_of(set, key);
    while (set->slots[at].key != key && set->slots[at].key != ENG_PAIRSET_EMPTY) {
        at = (at + 1) & (set->capacity - 1);
    }
    return at;
}

void eng_pairset_deinit(struct eng_pairset *set)
{
    eng_free(set->slots);
    *set = (struct eng_pairset){0};
}

size_t eng_pairset_bytes(const struct eng_pairset *set)
{
    return set->capacity * sizeof *set->slots;
}

/* Places for twice as many. */
static int grow(struct eng_pairset *set)
{
    struct eng_pairset more = *set;
    more.capacity = set->capacity ? 2 * set->capacity : CAPACITY_MIN;
    more.factor =
        set->capacity ? set->factor : (common_now_ns() + (uintptr_t)set) << 1 | 1;
    more.slots = eng_alloc(more.capacity, sizeof *more.slots);
    if (!more.slots) {
        return PCCD_E_NOMEM;
    }
    memset(more.slots, 0xff, more.capacity * sizeof *more.slots); /* empty */
    for (uint32_t i = 0; i < set->capacity; i++) {
        struct eng_pairset_slot slot = set->slots[i];
        if (slot.key != ENG_PAIRSET_EMPTY) {
            more.slots[find(&more, slot.key)] = slot;
        }
    }
    eng_free(set->slots);
    *set = more;
    return PCCD_OK;
}

int eng_pairset_add(struct eng_pairset *set, uint32_t a, uint32_t b, double value)
{
    uint64_t key = key_of(a, b);
    if (eng_pairset_has(set, a, b)) {
        set->slots[find(set, key)].value = value;
        return PCCD_OK;
    }
    if (2 * (set->count + 1) > set->capacity) {
        int status = grow(set);
        if (status != PCCD_OK) {
            return status;
        }
    }
    set->slots[find(set, key)] = (struct eng_pairset_slot){key, value};
    set->count++;
    return PCCD_OK;
}

/* Empty a place. What follows it without a gap and would be looked for from there, or
 * from before it, moves up. */
static void clear(struct eng_pairset *set, uint32_t gap)
{
    uint32_t mask = set->capacity - 1;
    for (uint32_t at = (gap + 1) & mask; set->slots[at].key != ENG_PAIRSET_EMPTY;
         at = (at + 1) & mask) {
        uint32_t home = home_of(set, set->slots[at].key);
        if (((at - home) & mask) >= ((at - gap) & mask)) {
            set->slots[gap] = set->slots[at];
            gap = at;
        }
    }
    set->slots[gap].key = ENG_PAIRSET_EMPTY;
    if (--set->count == 0) {
        eng_pairset_deinit(set);
    }
}

void eng_pairset_remove(struct eng_pairset *set, uint32_t a, uint32_t b)
{
    if (eng_pairset_has(set, a, b)) {
        clear(set, find(set, key_of(a, b)));
    }
}

bool eng_pairset_has(const struct eng_pairset *set, uint32_t a, uint32_t b)
{
    uint64_t key = key_of(a, b);
    return set->count > 0 && set->slots[find(set, key)].key == key;
}

double eng_pairset_value(const struct eng_pairset *set, uint32_t a, uint32_t b,
                         double other)
{
    uint64_t key = key_of(a, b);
    if (set->count == 0) {
        return other;
    }
    const struct eng_pairset_slot *slot = &set->slots[find(set, key)];
    return slot->key == key ? slot->value : other;
}

bool eng_pairset_take(struct eng_pairset *set, uint32_t a, uint32_t *from,
                      uint32_t *other, double *value)
{
    /* What moves up into a place that was emptied is looked at next; what goes round from
     * the start to the end of the places was looked at before. */
    for (; *from < set->capacity; ++*from) {
        uint64_t key = set->slots[*from].key;
        uint32_t lesser = (uint32_t)(key >> 32);
        uint32_t greater = (uint32_t)key;
        if (key != ENG_PAIRSET_EMPTY && (lesser == a || greater == a)) {
            *other = lesser == a ? greater : lesser;
            *value = set->slots[*from].value;
            clear(set, *from);
            return true;
        }
    }
    return false;
}

bool eng_pairset_next(const struct eng_pairset *set, uint32_t *from, uint32_t pair[2],
                      double *value)
{
    while (*from < set->capacity) {
        const struct eng_pairset_slot *slot = &set->slots[(*from)++];
        if (slot->key != ENG_PAIRSET_EMPTY) {
            pair[0] = (uint32_t)(slot->key >> 32);
            pair[1] = (uint32_t)slot->key;
            *value = slot->value;
            return true;
        }
    }
    return false;
}

/* Take out every pair of which `goes` says so: it is asked once of each. One look at
 * every place, however many go. */
static void prune(struct eng_pairset *set,
                  bool (*goes)(void *context, uint32_t a, uint32_t b, double value),
                  void *context)
{
    /* What moves up into a place that was emptied is asked about next. What goes round
     * from the start was asked about there, and stays: up to the first gap, which nothing
     * goes round, those are asked about last. */
    uint32_t start = 0;
    while (start < set->capacity && set->slots[start].key != ENG_PAIRSET_EMPTY) {
        start++;
    }
    for (uint32_t i = 0, n = set->capacity; i < n && set->capacity > 0;) {
        uint32_t at = (start + i) & (set->capacity - 1);
        const struct eng_pairset_slot *slot = &set->slots[at];
        if (slot->key != ENG_PAIRSET_EMPTY && goes(context, (uint32_t)(slot->key >> 32),
                                                   (uint32_t)slot->key, slot->value)) {
            clear(set, at); /* without the last one, there are no places */
        } else {
            i++;
        }
    }
}

static const struct eng_masks_entry at_first = {
    .group = 1, .mask = UINT64_MAX, .self = true};

void eng_masks_init(struct eng_masks *masks)
{
    memset(masks, 0, sizeof *masks);
}

void eng_masks_deinit(struct eng_masks *masks)
{
    eng_free(masks->entries);
    eng_pairset_deinit(&masks->pairs);
}

uint64_t eng_masks_bytes(const struct eng_masks *masks)
{
    return (uint64_t)masks->capacity * sizeof *masks->entries +
           eng_pairset_bytes(&masks->pairs);
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

/* A pair goes, which was said to be so. */
static void count_out(struct eng_masks *masks, uint32_t a, uint32_t b, double value)
{
    masks->entries[a].pairs--;
    masks->entries[b].pairs--;
    masks->ignored_count -= value == ENG_PAIR_IGNORED;
}

int eng_masks_set_pair(struct eng_masks *masks, uint32_t a, uint32_t b, double value)
{
    assert(a != b && a < masks->capacity && b < masks->capacity);
    double before = eng_masks_pair(masks, a, b);
    if (value == before) {
        return PCCD_OK;
    }
    if (value == ENG_PAIR_PLAIN) {
        eng_pairset_remove(&masks->pairs, a, b);
        count_out(masks, a, b, before);
        masks->version++;
        return PCCD_OK;
    }
    if (before == ENG_PAIR_PLAIN && masks->pairs.count >= PROTO_IGNORED_PER_SCENE) {
        return PCCD_E_LIMIT;
    }
    int status = eng_pairset_add(&masks->pairs, a, b, value);
    if (status == PCCD_OK) {
        masks->entries[a].pairs += before == ENG_PAIR_PLAIN;
        masks->entries[b].pairs += before == ENG_PAIR_PLAIN;
        masks->ignored_count += value == ENG_PAIR_IGNORED;
        masks->ignored_count -= before == ENG_PAIR_IGNORED;
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

static bool goes(void *context, uint32_t a, uint32_t b, double value)
{
    struct eng_masks *masks = context;
    if (!masks->entries[a].is_excluded && !masks->entries[b].is_excluded) {
        return false;
    }
    count_out(masks, a, b, value);
    return true;
}

void eng_masks_purge_excluded(struct eng_masks *masks)
{
    prune(&masks->pairs, goes, masks);
    masks->version++;
}

void eng_masks_forget(struct eng_masks *masks, uint32_t object)
{
    assert(object < masks->capacity);
    struct eng_masks_entry *entry = &masks->entries[object];
    uint32_t from = 0;
    uint32_t other;
    double value;
    while (entry->pairs > 0 &&
           eng_pairset_take(&masks->pairs, object, &from, &other, &value)) {
        count_out(masks, object, other, value);
    }
    masks->changed_count -= entry->is_changed;
    masks->left_out_count -= entry->left_out != ENG_SELF_TESTED;
    *entry = at_first;
    masks->version++;
}
