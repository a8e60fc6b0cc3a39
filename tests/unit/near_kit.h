/* near_kit.h - asks what is nearest, or how deep, in every way that must not matter.
 *
 * Threads: one.
 */
#ifndef TEST_NEAR_KIT_H
#define TEST_NEAR_KIT_H

#include "eng_kit.h"
#include "near.h"

/* A scene of meshes whose ids are 1, 2, ... in the order in which they are added. */
struct near_kit {
    struct eng_scene *scene;
    uint32_t count;
    uint32_t idx[64];
};

void near_kit_begin(struct near_kit *kit);
void near_kit_end(struct near_kit *kit);
/* Takes the caller's reference. */
void near_kit_add(struct near_kit *kit, struct eng_mesh *mesh);

/* An axis-aligned box of 12 triangles whose normals point outward, from its corner `low`
 * to `high`; `inward`: inward. */
struct eng_mesh *near_kit_box(const double low[3], const double high[3], bool inward);

struct eng_question near_kit_settings(enum pccd_near_what what);

/* Ask in every way: the same complete answer each time. Records are the last one's. */
struct eng_step_result near_kit_ask(struct near_kit *kit,
                                    const struct eng_question *settings);

/* Record i of an answer. */
static inline const struct pccd_near *
near_kit_record(const struct eng_step_result *result, uint64_t i)
{
    return (const struct pccd_near *)result->records + i;
}

#endif
