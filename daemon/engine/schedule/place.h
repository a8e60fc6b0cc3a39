/* daemon/engine/schedule/place.h - where the threads of a team run.
 *
 * Room:     engine. May include: the C library.
 * Does:     give every thread of the team a processor of its own, among those that the
 *           process may use. Without it the kernel was seen to leave two threads on one
 *           processor, and the runtime's own binding would bind the other threads too.
 *           Let a thread that waits for another, whose processor somebody else has taken,
 *           lend it its own: theirs may be free at the next tick, but a tick is 4 ms.
 * Threads:  functions say.
 */
#ifndef ENG_PLACE_H
#define ENG_PLACE_H

#include <stdbool.h>
#include <stdint.h>

#define ENG_PLACES_MAX 1024u

struct eng_places {
    uint32_t count; /* processors the process may use; 0: unknown, nobody is placed */
    uint16_t cpu[ENG_PLACES_MAX];
};

/* How far one that waits has got with looking at the others. All zero: not begun. */
struct eng_place_look {
    uint32_t mate;   /* of the others, from the next one on */
    uint64_t ran_ns; /* of a processor it had had at the last look; 0: not looked at */
};

/* The processors that the calling thread may use. Before it is placed. The runtime sets
 * itself up, too: libomp opens files at its first call, which a sandbox would forbid
 * later. [any] */
void eng_places_init(struct eng_places *places);

/* Bind the calling thread, the `thread`-th of a team, to a processor of its own, unless
 * it is bound there already; in a team larger than `places`, to all of them. NULL:
 * nothing. The runtime may replace threads when a team shrinks and grows, and a new one
 * begins where the thread that opened the region is bound, so every region calls it.
 * Costs a comparison once a thread is where it belongs. [team] */
void eng_place_thread(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count);

/* It was lent a processor, and others no longer wait for it: back to its own. Costs a
 * comparison otherwise. [team] */
void eng_place_return(const struct eng_places *places, uint32_t thread,
                      uint32_t team_count);

/* It waits for others, maybe asleep, and is not waited for; or no longer. [team] */
void eng_place_set_waiting(const struct eng_places *places, uint32_t thread,
                           bool is_waiting);

/* Look at one of the others; called every 50 us or so by a thread that waits. One that
 * has not run since the last look, and may, is put on the caller's processor, where it
 * runs as soon as the caller sleeps: true. [team] */
bool eng_place_lend(const struct eng_places *places, uint32_t thread, uint32_t team_count,
                    struct eng_place_look *look);

/* Processors of a team: those of `places`, or if it is NULL, of the first thread that
 * asks. [any] */
uint32_t eng_places_processors(const struct eng_places *places);

/* Open one region, so that the team exists and is placed before the first step.
 * [compute] */
void eng_places_warm_up(const struct eng_places *places, uint32_t threads);

#endif
