/* stage_turning.c - joints of a step, and the objects that hang on them. */
#include "stage_turning.h"

#include "ingest.h"
#include "joints.h"
#include "memory.h"
#include "path.h"
#include "world.h"

/* Joints of a step, at most: no index comes near PCCD_NO_JOINT. */
#define JOINTS_MAX (1u << 24)

int eng_stage_joints(struct eng_scene *scene, const void *source, uint32_t count,
                     uint32_t *base, struct eng_bad_joint *bad)
{
    struct eng_joints *joints = &scene->staged_joints;
    *bad = (struct eng_bad_joint){0, NULL};
    if (!scene->staging) {
        return PCCD_E_INVAL;
    }
    if (count > JOINTS_MAX - joints->count) {
        return PCCD_E_LIMIT;
    }
    uint32_t first = joints->count;
    int status = eng_array_extend(&joints->items, &joints->capacity, first + count,
                                  sizeof *joints->items);
    if (status != PCCD_OK) {
        return status;
    }
    struct pccd_joint *items = joints->items + first;
    eng_ingest_bytes(items, source, count * sizeof *items);
    if (!eng_joints_check(items, count, &bad->joint, &bad->why)) {
        return PCCD_E_INVAL;
    }
    for (uint32_t i = 0; i < count; i++) {
        items[i].parent += items[i].parent != PCCD_NO_JOINT ? first : 0;
    }
    joints->count = first + count;
    *base = first;
    return PCCD_OK;
}

int eng_stage_turning(struct eng_scene *scene, uint32_t object_idx, uint32_t joint)
{
    const struct eng_object *object = eng_scene_object(scene, object_idx);
    if (!scene->staging || !object || joint >= scene->staged_joints.count) {
        return PCCD_E_INVAL;
    }
    const struct pccd_joint *joints = scene->staged_joints.items;
    uint32_t length = 0;
    for (uint32_t at = joint; at != PCCD_NO_JOINT; at = joints[at].parent) {
        if (++length > ENG_PATH_JOINTS_MAX) {
            return PCCD_E_LIMIT;
        }
    }
    return eng_stage_on_joint(scene, object_idx, joint);
}

const char *eng_turning_refuses(const struct eng_question *question)
{
    return question->mode == PCCD_MODE_PAIRS ? "mode pairs"
           : eng_asks_touching(question)
               ? "what becomes of what touches (`approach` takes what begins near)"
           : eng_asks_part(question) ? "a part of a step"
           : question->weigh         ? "weights of candidates"
                                     : NULL;
}
