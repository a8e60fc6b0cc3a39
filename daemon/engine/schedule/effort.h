/* daemon/engine/schedule/effort.h - does a team pay for a step?
 *
 * Room:     engine. May include: step.h.
 * Does:     remember how much work the last steps of a scene were, and guess the next.
 * Threads:  [compute].
 */
#ifndef ENG_EFFORT_H
#define ENG_EFFORT_H

#include "step.h"

struct eng_effort {
    uint64_t work_ns[ENG_MODE_PAIRS + 1]; /* of all threads, by mode; 0: not known */
    bool paid;                            /* the last answer; the next one clings to it */
};

/* Should the next step in this mode be taken by more than one thread? */
bool eng_effort_pays(struct eng_effort *effort, enum eng_mode mode, uint32_t triangles);

/* A step was done from beginning to end; `work_ns` is the time that its threads took,
 * without waiting. */
void eng_effort_learn(struct eng_effort *effort, enum eng_mode mode, uint64_t work_ns);

/* The scene is another one. */
void eng_effort_forget(struct eng_effort *effort);

#endif
