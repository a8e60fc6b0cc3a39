/* seat.h - lends the processor of a waiting thread to a thread of the team that has
 * lost its own to another program.
 */
#ifndef ENG_SEAT_H
#define ENG_SEAT_H

#include <stdbool.h>
#include <stdint.h>

#include "processors.h"

/* How far one that waits has got with looking at the others. All zero: not begun. */
struct eng_seat_look {
    uint32_t mate;     /* of the others, from the next one on */
    uint64_t ran_ns;   /* of a processor it had had at the last look; 0: not looked at */
    uint64_t since_ns; /* when that was */
};

/* The calling thread is the `thread`-th of a team, until it ends or is another. Nothing
 * without places, or where there are fewer than threads. [team] */
void eng_seat_take(const struct eng_affinity *affinity, uint32_t thread,
                   uint32_t team_count);

/* True: it was lent a processor, and is to go back to its own. [team] */
bool eng_seat_end_loan(const struct eng_affinity *affinity, uint32_t thread,
                       uint32_t team_count);

/* It waits for others, maybe asleep; or no longer. [team] */
void eng_seat_set_waiting(const struct eng_affinity *affinity, uint32_t thread,
                          bool is_waiting);

/* Look at one of the others; called every 50 us or so, with the time, by a thread that
 * waits. One that has not run since the last look, and is not asleep, is put on the
 * caller's processor, where it runs as soon as the caller sleeps: true. [team] */
bool eng_seat_lend(const struct eng_affinity *affinity, uint32_t thread,
                   uint32_t team_count, uint64_t now_ns, struct eng_seat_look *look);

#endif
