/* daemon/engine/schedule/seat.h - the threads of a team, as they see each other.
 *
 * Room:     engine. May include: place.h.
 * Does:     let a thread that waits for another, whose processor somebody else has taken,
 *           lend it its own: theirs may be free at the next tick, but a tick is 4 ms.
 * Threads:  functions say.
 */
#ifndef ENG_SEAT_H
#define ENG_SEAT_H

#include <stdbool.h>
#include <stdint.h>

#include "place.h"

/* How far one that waits has got with looking at the others. All zero: not begun. */
struct eng_seat_look {
    uint32_t mate;     /* of the others, from the next one on */
    uint64_t ran_ns;   /* of a processor it had had at the last look; 0: not looked at */
    uint64_t since_ns; /* when that was */
};

/* The calling thread is the `thread`-th of a team, until it ends or is another. Nothing
 * without places, or where there are fewer than threads. [team] */
void eng_seat_take(const struct eng_places *places, uint32_t thread, uint32_t team_count);

/* True: it was lent a processor, and is to go back to its own. [team] */
bool eng_seat_end_loan(const struct eng_places *places, uint32_t thread,
                       uint32_t team_count);

/* It waits for others, maybe asleep; or no longer. [team] */
void eng_seat_set_waiting(const struct eng_places *places, uint32_t thread,
                          bool is_waiting);

/* Look at one of the others; called every 50 us or so, with the time, by a thread that
 * waits. One that has not run since the last look, and is not asleep, is put on the
 * caller's processor, where it runs as soon as the caller sleeps: true. [team] */
bool eng_seat_lend(const struct eng_places *places, uint32_t thread, uint32_t team_count,
                   uint64_t now_ns, struct eng_seat_look *look);

#endif
