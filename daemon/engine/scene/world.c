/* world.c - the positions of a scene, and its objects by index. */
#include "world.h"

#include "array.h"

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
