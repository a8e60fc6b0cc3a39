/* world.c - the positions of a scene, and its objects by index. */
#include "world.h"

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "memory.h"
#include "pccd_types.h"

int eng_world_reserve(struct eng_scene *scene)
{
    uint32_t end = scene->vertex_ranges.end;
    if (end <= scene->vertex_capacity) {
        return PCCD_OK;
    }
    uint32_t capacity = eng_array_grown(scene->vertex_capacity, end);
    int status = eng_array_grow(&scene->x[0], capacity, sizeof *scene->x[0]);
    if (status == PCCD_OK) {
        status = eng_array_grow(&scene->x[1], capacity, sizeof *scene->x[1]);
    }
    if (status == PCCD_OK) {
        status =
            eng_array_grow(&scene->moving.moves, capacity, sizeof *scene->moving.moves);
    }
    if (status == PCCD_OK) {
        scene->vertex_capacity = capacity;
    }
    return status;
}

struct eng_object *eng_scene_object(const struct eng_scene *scene, uint32_t object_idx)
{
    return object_idx < scene->object_capacity && scene->objects[object_idx].mesh
               ? &scene->objects[object_idx]
               : NULL;
}

/* ---- which object has an id -------------------------------------------------------- */

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
    ids->table[place] = (struct eng_ids_entry){id, object};
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

/* ---- ranges of consecutive indices ------------------------------------------------- */

void eng_ranges_init(struct eng_ranges *ranges, uint32_t limit)
{
    memset(ranges, 0, sizeof *ranges);
    ranges->limit = limit;
}

void eng_ranges_deinit(struct eng_ranges *ranges)
{
    eng_free(ranges->holes);
    eng_ranges_init(ranges, 0);
}

static void remove_hole(struct eng_ranges *ranges, uint32_t i)
{
    ranges->hole_count--;
    memmove(&ranges->holes[i], &ranges->holes[i + 1],
            (ranges->hole_count - i) * sizeof *ranges->holes);
}

/* One more range is about to exist, so one more hole may appear when it goes. */
static int reserve_hole(struct eng_ranges *ranges)
{
    if (ranges->taken < ranges->hole_capacity) {
        return PCCD_OK;
    }
    uint32_t capacity = ranges->hole_capacity ? ranges->hole_capacity * 2 : 16;
    struct eng_range *holes = eng_realloc(ranges->holes, capacity, sizeof *holes);
    if (!holes) {
        return PCCD_E_NOMEM;
    }
    ranges->holes = holes;
    ranges->hole_capacity = capacity;
    return PCCD_OK;
}

int eng_ranges_take(struct eng_ranges *ranges, uint32_t count, uint32_t *first)
{
    assert(count >= 1);
    assert(count > 0);
    int status = reserve_hole(ranges);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < ranges->hole_count; i++) {
        struct eng_range *hole = &ranges->holes[i];
        if (hole->count >= count) {
            *first = hole->first;
            hole->first += count;
            hole->count -= count;
            if (hole->count == 0) {
                remove_hole(ranges, i);
            }
            ranges->taken++;
            return PCCD_OK;
        }
    }
    if (count > ranges->limit - ranges->end) {
        return PCCD_E_LIMIT;
    }
    *first = ranges->end;
    ranges->end += count;
    ranges->taken++;
    return PCCD_OK;
}

void eng_ranges_give(struct eng_ranges *ranges, uint32_t first, uint32_t count)
{
    assert(count >= 1 && count <= ranges->end && first <= ranges->end - count);
    assert(ranges->taken > 0);
    uint32_t i = 0;
    while (i < ranges->hole_count && ranges->holes[i].first < first) {
        i++;
    }
    struct eng_range *below = i > 0 ? &ranges->holes[i - 1] : NULL;
    struct eng_range *above = i < ranges->hole_count ? &ranges->holes[i] : NULL;
    assert(!below || below->first + below->count <= first);
    assert(!above || first + count <= above->first);
    assert(ranges->taken > 0);
    ranges->taken--;
    bool joins_below = below && below->first + below->count == first;
    bool joins_above = above && first + count == above->first;
    if (joins_below) {
        below->count += count;
        if (joins_above) {
            below->count += above->count;
            remove_hole(ranges, i);
        }
    } else if (joins_above) {
        above->first = first;
        above->count += count;
    } else {
        assert(ranges->hole_count < ranges->hole_capacity);
        memmove(&ranges->holes[i + 1], &ranges->holes[i],
                (ranges->hole_count - i) * sizeof *ranges->holes);
        ranges->holes[i] = (struct eng_range){first, count};
        ranges->hole_count++;
    }
    struct eng_range *last = &ranges->holes[ranges->hole_count - 1];
    if (last->first + last->count == ranges->end) {
        ranges->end = last->first;
        ranges->hole_count--;
    }
}
