/* solve.h - decides one elementary test with certainty: contact or no contact, and when.
 *
 * Threads: one thread for one scratch.
 * Source: error bounds are derived in BOUNDS.md.
 */
#ifndef ENG_SOLVE_H
#define ENG_SOLVE_H

#include "exact.h"

/* True: a contact, *hit is set. False: certainly no contact, or none that
 * begins before or at `t_end` (pass 1 to search the whole step). The bytes of *hit depend
 * on the query and on `tolerance` alone, not on t_end. */
bool eng_solve(const struct eng_query *query, double tolerance, double t_end,
               struct eng_exact *exact, struct eng_hit *hit);

/* What eng_solve does where the bracket kernel is unsure: the search by spans of time,
 * and exact arithmetic behind it. Decides any query, in some 500 ns; its *hit need not
 * have the bytes of eng_solve. */
bool eng_search(const struct eng_query *query, double tolerance, double t_end,
                struct eng_exact *exact, struct eng_hit *hit);

#endif
