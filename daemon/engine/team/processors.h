/* processors.h - which processors this process may use, and how to bind a thread to
 * some of them.
 */
#ifndef ENG_PROCESSORS_H
#define ENG_PROCESSORS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

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

/* The processors that the calling thread may use. Before it is placed. The runtime sets
 * itself up, too: libomp opens files at its first call, which a sandbox would forbid
 * later. [any] */
void eng_affinity_init(struct eng_affinity *affinity);

/* The same processors for another team of the process, in another order: where each team
 * has work for one thread only, these are not on one processor. [any] */
void eng_affinity_for_team(const struct eng_affinity *first, uint32_t team,
                           struct eng_affinity *affinity);

/* Where a thread may be bound besides on one processor: on all of the places, or on all
 * but the n-th (ENG_KEPT_OFF - n). */
enum { ENG_KEPT_OFF = -3, ENG_ANYWHERE = -1 };

/* Bind `thread` to that processor, which is one of the places, or as above. [any] */
bool eng_affinity_bind(const struct eng_affinity *affinity, int cpu, pthread_t thread);

/* Processors of a team: those of `places`, or if it is NULL, of the first thread that
 * asks. [any] */
uint32_t eng_affinity_processors(const struct eng_affinity *affinity);

#endif
