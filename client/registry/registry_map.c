/* registry_map.c - a hash table of handles. */
#include "registry.h"

#include <assert.h>
#include <stdlib.h>

#include "pccd_types.h"

struct registry_map_entry {
    uint32_t handle; /* 0: none here */
    uint64_t value;
};

#define ROOM_MIN 16u

static uint32_t place_of(const struct registry_map *map, uint32_t handle)
{
    return (uint32_t)((uint64_t)handle * 0x9e3779b97f4a7c15u >> 32) & (map->room - 1);
}

/* The entry of a handle, or the free one where it would be. There is a free one. */
static struct registry_map_entry *find(const struct registry_map *map, uint32_t handle)
{
    uint32_t at = place_of(map, handle);

    while (map->entries[at].handle != 0 && map->entries[at].handle != handle) {
        at = (at + 1) & (map->room - 1);
    }
    return &map->entries[at];
}

static int grow(struct registry_map *map)
{
    struct registry_map larger = {.room = map->room == 0 ? ROOM_MIN : map->room * 2,
                                  .count = map->count};

    larger.entries = calloc(larger.room, sizeof *larger.entries);
    if (larger.entries == NULL) {
        return PCCD_E_NOMEM;
    }
    for (uint32_t i = 0; i < map->room; i++) {
        if (map->entries[i].handle != 0) {
            *find(&larger, map->entries[i].handle) = map->entries[i];
        }
    }
    free(map->entries);
    *map = larger;
    return 0;
}

int registry_map_put(struct registry_map *map, uint32_t handle, uint64_t value)
{
    struct registry_map_entry *entry;

    assert(handle != 0);
    if (2 * (map->count + 1) > map->room && grow(map) != 0) {
        return PCCD_E_NOMEM;
    }
    entry = find(map, handle);
    map->count += entry->handle == 0;
    *entry = (struct registry_map_entry){handle, value};
    return 0;
}

bool registry_map_get(const struct registry_map *map, uint32_t handle, uint64_t *value)
{
    const struct registry_map_entry *entry;

    if (map->count == 0 || handle == 0) {
        return false;
    }
    entry = find(map, handle);
    if (entry->handle == 0) {
        return false;
    }
    *value = entry->value;
    return true;
}

void registry_map_remove(struct registry_map *map, uint32_t handle)
{
    struct registry_map_entry *gap = map->count > 0 ? find(map, handle) : NULL;
    uint32_t at;

    if (gap == NULL || gap->handle == 0) {
        return;
    }
    map->count--;
    /* Those behind it move up, unless they stand at their place or between it and the
     * gap. */
    at = (uint32_t)(gap - map->entries);
    for (;;) {
        uint32_t behind;

        at = (at + 1) & (map->room - 1);
        if (map->entries[at].handle == 0) {
            break;
        }
        behind = (at - place_of(map, map->entries[at].handle)) & (map->room - 1);
        if (behind >= ((at - (uint32_t)(gap - map->entries)) & (map->room - 1))) {
            *gap = map->entries[at];
            gap = &map->entries[at];
        }
    }
    *gap = (struct registry_map_entry){0, 0};
}

void registry_map_deinit(struct registry_map *map)
{
    free(map->entries);
    *map = (struct registry_map){.entries = NULL};
}
