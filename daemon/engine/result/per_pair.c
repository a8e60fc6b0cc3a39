/* per_pair.c - a hash table of contacts by their two objects. */
#include "per_pair.h"

#include <assert.h>
#include <string.h>

#include "memory.h"
#include "order.h"

#define CAPACITY_LEAST 256u
#define CAPACITY_MOST  (1u << 30)

void eng_per_pair_deinit(struct eng_per_pair *table)
{
    eng_free(table->contacts);
    eng_free(table->slots);
    memset(table, 0, sizeof *table);
}

uint64_t eng_per_pair_bytes(const struct eng_per_pair *table)
{
    return table->capacity * (sizeof *table->contacts + 2 * sizeof *table->slots);
}

void eng_per_pair_begin(struct eng_per_pair *table)
{
    if (table->capacity > CAPACITY_LEAST && table->count < table->capacity / 16) {
        eng_per_pair_deinit(table);
    } else if (table->capacity > 0) {
        memset(table->slots, 0, 2 * (size_t)table->capacity * sizeof *table->slots);
    }
    table->count = 0;
    table->recent = 0;
}

bool eng_contact_is_before(const struct pccd_contact *a, const struct pccd_contact *b)
{
    if (a->toi != b->toi) {
        return a->toi < b->toi;
    }
    struct eng_name name = eng_name_of((const void *)a, sizeof *a);
    struct eng_name other = eng_name_of((const void *)b, sizeof *b);
    return eng_name_compare(&name, &other) < 0;
}

static bool are_of_same(const struct pccd_contact *a, const struct pccd_contact *b)
{
    return (a->object_a == b->object_a && a->object_b == b->object_b) ||
           (a->object_a == b->object_b && a->object_b == b->object_a);
}

/* The slot of the contact of its two objects, in whichever order they are, or the free
 * one where it belongs. */
static uint32_t *slot_of(const struct eng_per_pair *table,
                          const struct pccd_contact *contact)
{
    uint32_t low = contact->object_a, high = contact->object_b;
    if (low > high) {
        low = contact->object_b;
        high = contact->object_a;
    }
    uint64_t hash = ((uint64_t)high << 32 | low) * 0x9e3779b97f4a7c15u;
    uint32_t last = 2 * table->capacity - 1;
    uint32_t at = (uint32_t)(hash >> 32) & last;
    assert(table->count < table->capacity);
    while (table->slots[at] != 0 &&
           !are_of_same(&table->contacts[table->slots[at] - 1], contact)) {
        at = (at + 1) & last;
    }
    return &table->slots[at];
}

/* Make room for one more, so that some are free behind it. */
static int grow(struct eng_per_pair *table)
{
    uint32_t capacity = table->capacity > 0 ? 2 * table->capacity : CAPACITY_LEAST;
    if (table->capacity >= CAPACITY_MOST) {
        return PCCD_E_NOMEM;
    }
    struct eng_per_pair larger = {
        .contacts = eng_alloc(capacity, sizeof *larger.contacts),
        .slots = eng_alloc(2 * (size_t)capacity, sizeof *larger.slots),
        .capacity = capacity,
        .recent = table->recent};
    if (!larger.contacts || !larger.slots) {
        eng_per_pair_deinit(&larger);
        return PCCD_E_NOMEM;
    }
    memset(larger.slots, 0, 2 * (size_t)capacity * sizeof *larger.slots);
    for (uint32_t i = 0; i < table->count; i++) {
        *slot_of(&larger, &table->contacts[i]) = i + 1;
        larger.contacts[i] = table->contacts[i];
        larger.count = i + 1;
    }
    eng_free(table->contacts);
    eng_free(table->slots);
    *table = larger;
    return PCCD_OK;
}

int eng_per_pair_add(struct eng_per_pair *table, const struct pccd_contact *contact)
{
    struct pccd_contact *known = NULL;
    if (table->recent < table->count &&
        are_of_same(&table->contacts[table->recent], contact)) {
        known = &table->contacts[table->recent];
    } else {
        int status = table->count + 1 >= table->capacity ? grow(table) : PCCD_OK;
        if (status != PCCD_OK) {
            return status;
        }
        uint32_t *slot = slot_of(table, contact);
        if (*slot == 0) {
            table->contacts[table->count] = *contact;
            *slot = ++table->count;
        }
        table->recent = *slot - 1;
        known = &table->contacts[table->recent];
    }
    if (eng_contact_is_before(contact, known)) {
        *known = *contact;
    }
    return PCCD_OK;
}

const struct pccd_contact *eng_per_pair_find(const struct eng_per_pair *table,
                                             const struct pccd_contact *contact)
{
    uint32_t number = table->count > 0 ? *slot_of(table, contact) : 0;
    return number > 0 ? &table->contacts[number - 1] : NULL;
}
