/* fuzz_scene.c - the contacts of a few objects of one shape, by brute force. */
#include "fuzz_scene.h"

#include <stdlib.h>
#include <string.h>

#include "oracle_scene.h"

#define OBJECTS_MAX 16u

void fuzz_scene_find(const struct fuzz_scene *scene, struct fuzz_scene_truth *truth)
{
    struct oracle_object objects[OBJECTS_MAX];
    struct oracle_contacts found;
    for (uint32_t i = 0; i < scene->count && i < OBJECTS_MAX; i++) {
        objects[i] = (struct oracle_object){.object_id = i,
                                            .vertex_count = scene->vertex_count,
                                            .triangle_count = scene->triangle_count,
                                            .x0 = scene->x0 + i * scene->vertex_count,
                                            .x1 = scene->x1 + i * scene->vertex_count,
                                            .triangles = scene->triangles};
    }
    oracle_scene(objects, scene->count, &found);
    truth->count = found.count;
    truth->beside = found.beside;
    truth->contacts = calloc(found.count + 1, sizeof *truth->contacts);
    if (!truth->contacts) {
        abort();
    }
    for (size_t i = 0; i < found.count; i++) {
        const struct oracle_pair *pair = &found.pairs[i];
        const uint32_t name[5] = {pair->kind, pair->object_a, pair->feature_a,
                                  pair->object_b, pair->feature_b};
        memcpy(truth->contacts[i], name, sizeof name);
    }
    oracle_contacts_deinit(&found);
}

void fuzz_scene_forget(struct fuzz_scene_truth *truth)
{
    free(truth->contacts);
}
