/* team.h - how the threads of a rank share a loop over much.
 *
 * Say how many threads a loop gets, and which part of it each has:
 *
 *     const int team = ranks_team(world, count);
 *     #pragma omp parallel for num_threads(team) schedule(static, 1)
 *     for (int t = 0; t < team; t++) {
 *         ... from ranks_part(count, t, team) to ranks_part(count, t + 1, team) - 1
 *     }
 *
 * Threads: [team] is such a thread; all else one.
 *
 * libpccd computes by the calling thread, so both have the same OpenMP team; it is of one
 * size, because the runtime ends threads where it shrinks and starts them where it grows.
 */
#ifndef RANKS_TEAM_H
#define RANKS_TEAM_H

#include "world.h"

/* Vertices or records from which on a team is woken: a vertex takes 2 to 4 ns, a record
 * 12, and to wake one some 20 us. libpccd's step needs it anyway. */
#define RANKS_TEAM_MIN 16384u

/* Return how many threads are to work on `count` vertices or records: 1 at least. */
static inline int ranks_team(const struct pccd_mpi *world, uint64_t count)
{
    return count < RANKS_TEAM_MIN ? 1 : (int)world->team;
}

/* Return where the part of thread t of a team begins. count < 2^48. */
static inline uint64_t ranks_part(uint64_t count, int t, int team)
{
    return count * (uint64_t)t / (uint64_t)team;
}

/* Find which of a run of `count` items, the first of which is the `at`-th of all, are
 * among begin .. end - 1 of all: *first .. *last - 1 of the run. Return false if there
 * are none. */
static inline bool ranks_part_of_run(uint64_t at, uint64_t count, uint64_t begin,
                                     uint64_t end, uint64_t *first, uint64_t *last)
{
    *first = begin > at ? begin - at : 0;
    *last = end < at + count ? (end > at ? end - at : 0) : count;
    return *first < *last;
}

#endif
