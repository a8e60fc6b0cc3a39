/* thick.h - the elementary test of thickness: do two features come within a distance of
 * each other during the step, and when first?
 *
 * Decide a query of VF, EE, VE or VV with a distance r: by doubles with margins, and by
 * integers where they are not sure. A miss is certain, and every contact is proved.
 *
 * Threads: one thread for one scratch. Decisions allocate nothing.
 * Source: BOUNDS.md, "Thick features".
 *
 * An example: two vertices, 4 m apart, of which one moves onto the other; r = 1 m. They
 * are within r from t = 3/4 on, so toi <= 3/4 <= toi_hi.
 *
 * *Distance* is Euclidean, between the closed features, at one time; r is the exact sum
 * of three doubles. Exactly r is within. With r = 0 VF and EE are what eng_solve says,
 * byte for byte.
 *
 * *What begins inside*, d(0) <= r, where d(0) is the distance at t = 0:
 *   approach 0       it meets at once: PCCD_INITIAL, toi = toi_hi = 0
 *   0 < approach < 1 it meets where the distance is at most approach d(0), at whatever
 *                    time; PCCD_INSIDE. With d(0) = 0: PCCD_INITIAL, too.
 *
 * *Time*: with r > 0, [toi, toi_hi] is the cell of time (thick_exact.h) in which the
 * first t lies at which the distance is at most r. Cells are 2^-30 long, or shorter if
 * the tolerance asks for it. So the bytes are a function of the first time and of the
 * tolerance alone, whichever stage has found them; before toi the distance is more
 * than r.
 */
#ifndef ENG_THICK_H
#define ENG_THICK_H

#include "exact.h"
#include "kernel.h"
#include "query.h"
#include "thick_exact.h"

/* Who decides. The answer is the same. */
enum eng_thick_stage { ENG_THICK_BY_DOUBLES, ENG_THICK_BY_INTEGERS, ENG_THICK_STAGES };

struct eng_thick {
    enum eng_thick_stage first; /* the stage to begin with; for tests */
    uint64_t decided[ENG_THICK_STAGES];
    struct eng_thick_exact exact;
};

/* Allocate the integers. PCCD_E_NOMEM: there is nothing to deinit. What follows never
 * fails for memory. */
int eng_thick_init(struct eng_thick *thick);
void eng_thick_deinit(struct eng_thick *thick);

/* Decide a query. True: the distance is at most r at some time, and *hit is set. False:
 * it is not, or not in a cell that begins before or at `t_end`. The bytes of *hit depend
 * on the query and on `tolerance`, 1e-12 .. 1, alone. param and normal are those of the
 * nearest points at the double toi, by doubles: normal from feature b to feature a, zeros
 * where they coincide up to rounding. VE: param[1] is the position along the edge.
 * `contacts` decides the queries with r = 0. */
bool eng_thick_solve(struct eng_thick *thick, struct eng_exact *contacts,
                     const struct eng_thick_query *query, double tolerance, double t_end,
                     struct eng_hit *hit);

/* ---- in parts, for batch.h --------------------------------------------------------- */

/* Return the depth of the longest cells that are not longer than the tolerance, nor than
 * 2^-30. */
int eng_thick_depth(double tolerance);

/* Return whether a query is VF or EE with r = 0, which eng_solve decides. */
bool eng_thick_is_thin(uint32_t kind, const double radius[3]);

/* Decide, as eng_thick_solve, a query that is not thin; param and normal are not set.
 * `advance`: what the kernel said of it, up to t_end and by eng_thick_depth; the query is
 * looked at only if that is UNDECIDED. False: *hit may be set to one that begins after
 * t_end. */
bool eng_thick_decide(struct eng_thick *thick, const struct eng_thick_query *query,
                      const struct eng_advance *advance, double tolerance, double t_end,
                      struct eng_hit *hit);

#endif
