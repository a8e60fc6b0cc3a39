/* registry_map.h - finds what belongs to a handle, among many. */
#ifndef REGISTRY_MAP_H
#define REGISTRY_MAP_H

#include <stdbool.h>
#include <stdint.h>

struct registry_map_entry {
    uint32_t handle; /* 0: none here */
    uint64_t value;
};

/* All zero: empty. */
struct registry_map {
    struct registry_map_entry *entries; /* [room], a power of two; half of it is free */
    uint32_t room;
    uint32_t count;
};

/* Handles are not 0. The value is replaced if there is one. 0 or PCCD_E_NOMEM. */
int registry_map_put(struct registry_map *map, uint32_t handle, uint64_t value);
/* False: there is none, and *value is as before. */
bool registry_map_get(const struct registry_map *map, uint32_t handle, uint64_t *value);
/* Nothing if there is none. */
void registry_map_remove(struct registry_map *map, uint32_t handle);
void registry_map_deinit(struct registry_map *map);

#endif
