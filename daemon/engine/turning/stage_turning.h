/* stage_turning.h - stages objects that turn: on joints, in the place of positions.
 *
 * Stage, between begin and eng_step, beside the writes of scene.h: first joints, then the
 * objects that hang on them. Such an object moves exactly as its joints say; where it
 * begins and ends are those poses rounded, as eng_stage_rigid makes them, so that the
 * next step goes on from there.
 *
 * Threads: [compute].
 */
#ifndef ENG_STAGE_TURNING_H
#define ENG_STAGE_TURNING_H

#include "question.h"
#include "scene.h"

/* A joint that is not as struct pccd_joint says. */
struct eng_bad_joint {
    uint32_t joint;  /* index among those that were given */
    const char *why; /* a constant text */
};

/* Copy the joints of a table, `source` [count], once: another process may write it.
 * Parents are indices in the table. *base: what is added to an index of the table for
 * eng_stage_turning, or for a path. PCCD_E_INVAL: *bad, or nothing is being staged
 * (why NULL); PCCD_E_LIMIT: too many in this step; PCCD_E_NOMEM. */
int eng_stage_joints(struct eng_scene *scene, const void *source, uint32_t count,
                     uint32_t *base, struct eng_bad_joint *bad);

/* Stage all of an object as hanging on a joint: an index of the step's, base included.
 * Two objects that hang on joints of one table move against each other by the joints
 * between them alone. PCCD_E_INVAL: no such object or joint; PCCD_E_LIMIT: more than
 * ENG_PATH_JOINTS_MAX joints between it and the world; PCCD_E_NOTFINITE: it would be
 * beyond 1e18; PCCD_E_NOMEM. */
int eng_stage_turning(struct eng_scene *scene, uint32_t object_idx, uint32_t joint);

/* Return what of a question has no answer where objects turn, in words; NULL: all of it
 * has. Such a step is PCCD_E_INVAL. [any] */
const char *eng_turning_refuses(const struct eng_question *question);

#endif
