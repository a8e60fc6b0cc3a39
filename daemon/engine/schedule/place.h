/* daemon/engine/schedule/place.h - where the threads of a team run.
 *
 * Room:     engine. May include: the C library.
 * Does:     give every thread of the team a processor of its own, among those that the
 *           process may use. Without it the kernel was seen to leave two threads on one
 *           processor, and the runtime's own binding would bind the other threads too.
 * Threads:  functions say.
 */
#ifndef ENG_PLACE_H
#define ENG_PLACE_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define ENG_PLACES_MAX 1024u
#define ENG_TEAMS_MAX  8u /* of a process, that share its processors */

/* In a process that is not ours the first thread is somebody's who asks for a step: it
 * stays as it is. The others may be anywhere but where it is, for the kernel wakes them
 * there, behind it: a step of two threads took as long as one of one, as a rule. They are
 * not bound to one processor each: another thread of the process may be on it. */
struct eng_places {
    uint32_t count; /* processors the process may use; 0: unknown, nobody is placed */
    uint16_t cpu[ENG_PLACES_MAX];
    uint32_t team; /* number of the team, as several may step at once; 0: the first */
    bool is_guest; /* in a process that is not ours */
    int first_on;  /* then: where the first thread is; set by it before each step */
};

/* The processors that the calling thread may use. Before it is placed. The runtime sets
 * itself up, too: libomp opens files at its first call, which a sandbox would forbid
 * later. [any] */
void eng_places_init(struct eng_places *places);

/* The same processors for another team of the process, in another order: where each team
 * has work for one thread only, these are not on one processor. [any] */
void eng_places_for_team(const struct eng_places *first, uint32_t team,
                         struct eng_places *places);

/* Bind the calling thread, the `thread`-th of a team, to a processor of its own, unless
 * it is bound there already; in a team larger than `places`, to all of them. NULL:
 * nothing. The runtime may replace threads when a team shrinks and grows, and a new one
 * begins where the thread that opened the region is bound, so every region calls it.
 * Costs a comparison once a thread is where it belongs. [team] */
void eng_place_thread(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count);

/* Bind `thread` to that one of the places, or to all of them (negative). [any] */
bool eng_places_bind(const struct eng_places *places, int cpu, pthread_t thread);

/* It was lent a processor (seat.h), and others no longer wait for it: back to its own.
 * Costs a comparison otherwise. [team] */
void eng_place_return(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count);

/* Processors of a team: those of `places`, or if it is NULL, of the first thread that
 * asks. [any] */
uint32_t eng_places_processors(const struct eng_places *places);

/* Open one region, so that the team exists and is placed before the first step.
 * [compute] */
void eng_places_warm_up(const struct eng_places *places, uint32_t threads);

#endif
