/* ids.c - which object of a scene has an id. */
#include "ids.h"

#include <assert.h>

#include "memory.h"
#include "pccd_types.h"

#define SIZE_LEAST 16u

void eng_ids_deinit(struct eng_ids *ids)
{
    eng_free(ids->table);
    *ids = (struct eng_ids){.table = NULL};
}

uint64_t eng_ids_bytes(const struct eng_ids *ids)
{
    return (uint64_t)ids->size * sizeof *ids->table;
}

/* Where an id is looked for first. Ids are numbers from 1 on, as a rule: this spreads
 * others, too. */
static uint32_t home(const struct eng_ids *ids, uint32_t id)
{
    return (id * 0x9e3779b1u) >> 7 & (ids->size - 1);
}

static uint32_t next(const struct eng_ids *ids, uint32_t place)
{
    return (place + 1) & (ids->size - 1);
}

/* The place of an id, or the free one where it would be. */
static uint32_t place_of(const struct eng_ids *ids, uint32_t id)
{
    uint32_t place = home(ids, id);
    while (ids->table[place].object != ENG_NO_OBJECT && ids->table[place].id != id) {
        place = next(ids, place);
    }
    return place;
}

int eng_ids_reserve(struct eng_ids *ids, uint32_t count)
{
    struct eng_ids grown = {.size = ids->size > SIZE_LEAST ? ids->size : SIZE_LEAST};
    while (grown.size / 2 < count) {
        grown.size *= 2; /* ends: handles have 20 bits */
    }
    if (grown.size == ids->size) {
        return PCCD_OK;
    }
    grown.table = eng_alloc(grown.size, sizeof *grown.table);
    if (!grown.table) {
        return PCCD_E_NOMEM;
    }
    for (uint32_t i = 0; i < grown.size; i++) {
        grown.table[i].object = ENG_NO_OBJECT;
    }
    for (uint32_t i = 0; i < ids->size; i++) {
        if (ids->table[i].object != ENG_NO_OBJECT) {
            eng_ids_add(&grown, ids->table[i].id, ids->table[i].object);
        }
    }
    eng_ids_deinit(ids);
    *ids = grown;
    return PCCD_OK;
}

void eng_ids_add(struct eng_ids *ids, uint32_t id, uint32_t object)
{
    uint32_t place = place_of(ids, id);
    assert(ids->table[place].object == ENG_NO_OBJECT && object != ENG_NO_OBJECT);
    ids->table[place] = (struct eng_ids_place){id, object};
}

void eng_ids_remove(struct eng_ids *ids, uint32_t id)
{
    uint32_t hole = place_of(ids, id);
    assert(ids->table[hole].object != ENG_NO_OBJECT);
    for (uint32_t place = next(ids, hole); ids->table[place].object != ENG_NO_OBJECT;
         place = next(ids, place)) {
        /* It may move up unless its home lies behind the hole. */
        uint32_t away = (place - home(ids, ids->table[place].id)) & (ids->size - 1);
        if (away >= ((place - hole) & (ids->size - 1))) {
            ids->table[hole] = ids->table[place];
            hole = place;
        }
    }
    ids->table[hole].object = ENG_NO_OBJECT;
}

uint32_t eng_ids_find(const struct eng_ids *ids, uint32_t id)
{
    return ids->size == 0 ? ENG_NO_OBJECT : ids->table[place_of(ids, id)].object;
}
