/* solvers.h - the table that says how the queries of each kind are decided.
 *
 * The same for all kinds: features of one mesh that share a vertex are not tested; a pair
 * is a candidate if the moving boxes around its features overlap; the first test is
 * `reject_axes` of kernel.h; the exact decision is behind `search`, which asks for it.
 */
#ifndef ENG_SOLVERS_H
#define ENG_SOLVERS_H

#include "exact.h"

struct eng_solver {
    /* Do sift, filter and bracket of kernel.h reject and decide its pairs, as many at a
     * time as a vector has lanes? If not, each pair that `reject_axes` leaves is
     * searched. */
    bool has_kernels;
    /* Decides any query, by exact arithmetic where rounding hides the answer. True: a
     * contact that begins before or at `t_end`, and *hit is set; [toi, toi_hi] is at most
     * `tolerance` long. Where exact->span.watch has stopped, the answer means nothing.
     * NULL: features of the kind only meet at a distance (thick.h). */
    bool (*search)(const struct eng_query *query, double tolerance, double t_end,
                   struct eng_exact *exact, struct eng_hit *hit);
};

extern const struct eng_solver eng_solvers[PCCD_KIND_COUNT];

#endif
