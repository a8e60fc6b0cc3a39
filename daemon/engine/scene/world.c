/* daemon/engine/scene/world.c - the flat arrays of a scene.
 *
 * Room:     engine.
 * Does:     grow the arrays with the ranges that are handed out; those of binary
 *           hierarchies: tree/object.c.
 * Threads:  [compute].
 */
#include "world.h"

#include <string.h>

#include "memory.h"

uint32_t eng_world_grown(uint32_t capacity, uint32_t end)
{
    uint64_t more = (uint64_t)capacity + capacity / 8;
    return more > UINT32_MAX || more < end ? end : (uint32_t)more;
}

int eng_world_grow(void *array, uint32_t capacity, size_t bytes)
{
    /* Pointers to different types may not be accessed as void *; their bytes may. */
    void *block;
    memcpy(&block, array, sizeof block);
    block = eng_realloc(block, capacity, bytes);
    if (!block) {
        return ENG_E_NOMEM;
    }
    memcpy(array, &block, sizeof block);
    return ENG_OK;
}

int eng_world_reserve(struct eng_scene *scene)
{
    uint32_t end = scene->vertex_ranges.end;
    if (end <= scene->vertex_capacity) {
        return ENG_OK;
    }
    uint32_t capacity = eng_world_grown(scene->vertex_capacity, end);
    int status = eng_world_grow(&scene->x[0], capacity, sizeof *scene->x[0]);
    if (status == ENG_OK) {
        status = eng_world_grow(&scene->x[1], capacity, sizeof *scene->x[1]);
    }
    if (status == ENG_OK) {
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
