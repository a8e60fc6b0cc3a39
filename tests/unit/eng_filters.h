/* eng_filters.h - remembers which objects of a scene may meet, to check the engine's
 * masks.
 */
#ifndef TEST_ENG_FILTERS_H
#define TEST_ENG_FILTERS_H

#include "cases.h"
#include "prng.h"
#include "scene.h"

#define FILTERS_OBJECTS_MAX 128u
#define FILTERS_IGNORED_MAX 256u

struct filters_object {
    uint32_t id;
    struct eng_object_filter bits;
};

/* All zero: every object is as it begins. */
struct filters {
    struct filters_object objects[FILTERS_OBJECTS_MAX]; /* those that were set */
    uint32_t object_count;
    uint32_t ignored[FILTERS_IGNORED_MAX][2]; /* ids, the lesser first */
    uint32_t ignored_count;
};

/* Place of the objects of the scene. */
struct filters_place {
    uint32_t id;
    uint32_t idx;
};

bool filters_may_meet(const struct filters *filters, uint32_t id_a, uint32_t id_b);

void filters_set(struct filters *filters, struct eng_scene *scene,
                 struct filters_place place, struct eng_object_filter bits);
void filters_ignore(struct filters *filters, struct eng_scene *scene,
                    struct filters_place a, struct filters_place b, bool ignored);

/* Change a few of them. Four groups; most pairs may meet, and all at times. */
void filters_draw(struct filters *filters, struct eng_scene *scene,
                  const struct filters_place *places, uint32_t count, struct prng *prng);

/* The object is gone from the scene. */
void filters_forget(struct filters *filters, uint32_t id);

/* Another scene with some of the same objects, which are as they begin. */
void filters_apply(const struct filters *filters, struct eng_scene *scene,
                   const struct filters_place *places, uint32_t count);

#endif
