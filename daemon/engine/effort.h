/* effort.h - decides whether the next step is computed by one thread or by a team,
 * from how long the last ones took.
 */
#ifndef ENG_EFFORT_H
#define ENG_EFFORT_H

#include "question.h"

struct eng_effort {
    uint64_t work_ns[PCCD_MODE_PAIRS + 1]; /* of all threads, by mode; 0: not known */
    bool paid; /* the last answer; the next one clings to it */
    struct eng_effort_took {
        uint64_t alone_ns, team_ns; /* from beginning to end, smoothed; 0: not known */
        uint32_t turns;             /* steps that this has decided */
    } took[PCCD_MODE_PAIRS + 1];
};

/* Should the next step in this mode be taken by more than one thread? */
bool eng_effort_pays(struct eng_effort *effort, enum pccd_mode mode, uint32_t triangles);

/* Work of the next step in this mode; before the first, a guess. */
uint64_t eng_effort_expects(const struct eng_effort *effort, enum pccd_mode mode,
                            uint32_t triangles);
/* Is so much work, in pieces that do not depend on each other, worth a team? */
bool eng_effort_is_enough(uint64_t work_ns);

/* The same where this part, 0 .. 1, of what is searched as a rule moves. */
bool eng_effort_pays_for(const struct eng_effort *effort, enum pccd_mode mode,
                         double part);

/* A step was done from beginning to end; `work_ns` is the time that its threads took,
 * without waiting. */
void eng_effort_learn(struct eng_effort *effort, enum pccd_mode mode, uint64_t work_ns);

/* The same of a step that left out what stood still, and searched this part, 0 .. 1, of
 * what is searched as a rule. It can only show that the work is less than was believed:
 * one slow step at the beginning would else stand for as long as something stands. */
void eng_effort_learn_part(struct eng_effort *effort, enum pccd_mode mode, double part,
                           uint64_t work_ns);

/* How long it took, by a team or not. */
void eng_effort_time(struct eng_effort *effort, enum pccd_mode mode, bool by_team,
                     uint64_t took_ns);

/* The scene is another one. */
void eng_effort_forget(struct eng_effort *effort);

#endif
