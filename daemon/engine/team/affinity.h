/* affinity.h - binds each thread of a team to a processor of its own (thread affinity).
 *
 * Choose among the processors that the process may use. Without this, the kernel was seen
 * to leave two threads on one processor. The OpenMP runtime's own binding would bind the
 * other threads too.
 */
#ifndef ENG_AFFINITY_H
#define ENG_AFFINITY_H

#include <stdbool.h>
#include <stdint.h>

/* ---- processors -------------------------------------------------------------------- */

#define ENG_PROCESSORS_MAX 1024u
#define ENG_TEAMS_MAX      8u /* of a process, that share its processors */

/* In a process that is not ours the first thread is somebody's who asks for a step: it
 * stays as it is. The others may be anywhere but where it is, for the kernel wakes them
 * there, behind it: a step of two threads took as long as one of one, as a rule. They are
 * not bound to one processor each: another thread of the process may be on it. */
struct eng_affinity {
    uint32_t count; /* processors the process may use; 0: unknown, nobody is placed */
    uint16_t cpu[ENG_PROCESSORS_MAX];
    uint32_t team; /* number of the team, as several may step at once; 0: the first */
    bool is_guest; /* in a process that is not ours */
    int first_on;  /* then: where the first thread is; set by it before each step */
};

/* List the processors that the calling thread may use, before it is placed, and those to
 * which the runtime binds threads (OMP_PROC_BIND). The runtime sets itself up, too:
 * libomp opens files at its first call, which a sandbox would forbid later. [any] */
void eng_affinity_init(struct eng_affinity *affinity);

/* Let the calling thread run on all of them. False: the system refuses. [any] */
bool eng_affinity_unbind_thread(const struct eng_affinity *affinity);

/* List the same processors for another team of the process, in another order: where each
 * team has work for one thread only, these are not on one processor. [any] */
void eng_affinity_for_team(const struct eng_affinity *first, uint32_t team,
                           struct eng_affinity *affinity);

/* Return how many processors a team has: those of `affinity`, or if it is NULL, of the
 * first thread that asks. [any] */
uint32_t eng_affinity_processors(const struct eng_affinity *affinity);

/* Bind the calling thread, the `thread`-th of a team, to a processor of its own, unless
 * it is bound there already; in a team of more threads than there are processors, to all
 * of them. NULL: nothing. The runtime may replace threads when a team shrinks and grows,
 * and a new one begins where the thread that opened the region is bound, so every region
 * calls it. Costs a comparison once a thread is where it belongs. [team] */
void eng_affinity_bind_thread(const struct eng_affinity *affinity, uint32_t thread,
                              uint32_t team_count);

/* Bind the calling thread to its own processor again if it was lent another (below):
 * others no longer wait for it. Costs a comparison otherwise. [team] */
void eng_affinity_return(const struct eng_affinity *affinity, uint32_t thread,
                         uint32_t team_count);

/* ---- a thread that waits lends its processor to one that has lost its own ---------- */

/* The progress of one that waits in looking at the others. All zero: not begun. */
struct eng_processor_look {
    uint32_t mate;     /* of the others, from the next one on */
    uint64_t ran_ns;   /* of a processor it had had at the last look; 0: not looked at */
    uint64_t since_ns; /* when that was */
};

/* Say that the calling thread waits for others, maybe asleep; or no longer. [team] */
void eng_processor_set_waiting(const struct eng_affinity *affinity, uint32_t thread,
                               bool is_waiting);

/* Look at one of the others; called every 50 us or so, with the time, by a thread that
 * waits. One that has not run since the last look, and is not asleep, is put on the
 * caller's processor, where it runs as soon as the caller sleeps: true. [team] */
bool eng_processor_lend(const struct eng_affinity *affinity, uint32_t thread,
                        uint32_t team_count, uint64_t now_ns,
                        struct eng_processor_look *look);

#endif
