/* brief.c - steps that are certain to end soon. */
#include "brief.h"

#include <assert.h>

#include "methods.h"
#include "rigid.h"
#include "step_memory.h"
#include "wide_state.h"
#include "wide_test.h"

/* What the last step took, as it is believed (effort.h). */
#define WORK_NS 30000u

/* Blocks of sixteen: boxes are made of each, and all pairs of blocks may be joined. Two
 * blocks are 256 tests of boxes, 0.1 us of a vector kernel, 2 without: 16 pairs of
 * vertices and faces, 36 of edges. */
#define VERTEX_BLOCKS 4u
#define EDGE_BLOCKS   8u
#define FACE_BLOCKS   4u

/* Places for objects, taken or not: some loops of a step are over all of them. */
#define OBJECTS 64u

/* The same of a step that does nothing else: some 20 us. */
#define OBJECTS_AT_REST 1024u

bool eng_brief_fits(const struct eng_question *question)
{
    return question->mode != PCCD_MODE_PAIRS && question->distance == 0 &&
           !question->tells_start && !eng_asks_part(question) &&
           eng_method_of(question) == PCCD_METHOD_WIDE;
}

/* The trees are there, and small. */
static bool trees_are_small(const struct eng_wide *wide)
{
    return !wide->is_stale &&
           wide->trees[PCCD_TREE_VERTICES].block_count[0] <= VERTEX_BLOCKS &&
           wide->trees[PCCD_TREE_EDGES].block_count[0] <= EDGE_BLOCKS &&
           wide->trees[PCCD_TREE_FACES].block_count[0] <= FACE_BLOCKS;
}

/* No step beside its search goes on with what takes several. */
static bool has_work_beside(const struct eng_scene *scene)
{
    enum eng_wide_resort_state state = eng_wide_state_of(scene)->resort.state;
    return (state != ENG_WIDE_IDLE && state != ENG_WIDE_TRIED) ||
           !eng_rigid_is_settled(scene);
}

/* Nothing moved in the last step, so nothing does in one that writes nothing. Its boxes
 * are there, and its answer is the last one: it searches nothing, however large the scene
 * is. */
static bool is_at_rest(const struct eng_scene *scene, const struct eng_question *question)
{
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    const struct eng_kept *kept = &memory->kept;
    return scene->moving.objects == 0 && !scene->has_lost_start &&
           scene->object_capacity <= OBJECTS_AT_REST &&
           eng_methods[PCCD_METHOD_WIDE]->has_boxes(scene) && !has_work_beside(scene) &&
           eng_kept_fits(kept, scene, question, scene->moving.number) &&
           !kept->objects_changed && eng_kept_is_brief(kept) &&
           (question->mode != PCCD_MODE_ANY || kept->verdict == PCCD_VERDICT_NO ||
            kept->verdict == PCCD_VERDICT_YES) &&
           eng_step_memory_stays(memory) && eng_wide_work_of(memory->workers[0]);
}

bool eng_brief_is_bounded(const struct eng_scene *scene, const struct eng_team *team)
{
    return trees_are_small(eng_wide_of(scene)) ||
           (scene->moving.objects == 0 && team->prunes && team->has_boxes);
}

bool eng_step_can_be_brief(const struct eng_scene *scene,
                           const struct eng_question *question, bool is_staged)
{
    assert(scene && question);
    const struct eng_step_memory *memory = eng_step_memory_of(scene);
    if (!eng_brief_fits(question) || scene->thickness.may_have_radii) {
        return false;
    }
    if (!is_staged && is_at_rest(scene, question)) {
        return true;
    }
    if (scene->object_capacity > OBJECTS || !trees_are_small(eng_wide_of(scene))) {
        return false;
    }
    /* One worker: those of others, once there are any, are freed by some later step. */
    uint64_t work_ns = memory->effort[PCCD_METHOD_WIDE].work_ns[question->mode];
    return work_ns > 0 && work_ns <= WORK_NS && memory->worker_count == 1 &&
           eng_wide_work_of(memory->workers[0]);
}
