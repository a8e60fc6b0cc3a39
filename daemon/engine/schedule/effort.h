/* daemon/engine/schedule/effort.h - does a team pay for a step?
 *
 * Room:     engine. May include: step.h.
 * Does:     remember how much work the last steps of a scene were and how long they took,
 *           by one thread and by a team, and guess the next.
 * Threads:  [compute].
 */
#ifndef ENG_EFFORT_H
#define ENG_EFFORT_H

#include "step.h"

struct eng_effort {
    uint64_t work_ns[ENG_MODE_PAIRS + 1]; /* of all threads, by mode; 0: not known */
    bool paid;                            /* the last answer; the next one clings to it */
    struct eng_effort_took {
        uint64_t alone_ns, team_ns; /* from beginning to end, smoothed; 0: not known */
        uint32_t turns;             /* steps that this has decided */
    } took[ENG_MODE_PAIRS + 1];
};

/* Should the next step in this mode be taken by more than one thread? */
bool eng_effort_pays(struct eng_effort *effort, enum eng_mode mode, uint32_t triangles);

/* A step was done from beginning to end; `work_ns` is the time that its threads took,
 * without waiting. */
void eng_effort_learn(struct eng_effort *effort, enum eng_mode mode, uint64_t work_ns);

/* How long it took, by a team or not. */
void eng_effort_time(struct eng_effort *effort, enum eng_mode mode, bool by_team,
                     uint64_t took_ns);

/* The scene is another one. */
void eng_effort_forget(struct eng_effort *effort);

#endif
