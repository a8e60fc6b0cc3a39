/* solve.h - decides one elementary test with certainty: contact or no contact, and when.
 *
 * Threads: one thread for one scratch.
 * Source: error bounds are derived in BOUNDS.md.
 */
#ifndef ENG_SOLVE_H
#define ENG_SOLVE_H

#include "exact.h"

/* Decide a query. True: a contact, *hit is set. False: certainly no contact, or none that
 * begins before or at `t_end` (pass 1 to search the whole step). The bytes of *hit depend
 * on the query and on `tolerance` alone, not on t_end. */
bool eng_solve(const struct eng_query *query, double tolerance, double t_end,
               struct eng_exact *exact, struct eng_hit *hit);

/* Decide as eng_solve does where the bracket kernel is unsure: the search by spans of
 * time, and exact arithmetic behind it. Decides any query, in some 500 ns; its *hit need
 * not have the bytes of eng_solve. */
bool eng_search(const struct eng_query *query, double tolerance, double t_end,
                struct eng_exact *exact, struct eng_hit *hit);

/* Find when features that touch at t = 0 meet next (exact.h). MEETS: *hit is set, and
 * says PCCD_PROVED alone; its bracket is at most `tolerance` long. */
enum eng_again eng_search_again(const struct eng_query *query, double tolerance,
                                struct eng_exact *exact, struct eng_hit *hit);

/* ---- points in a plane of two axes (plane.c) --------------------------------------- */

/* Queries in which three or four points have exactly equal x, y or z at both ends of the
 * step, as on a table or in a regular mesh. In that plane a point meets an edge,
 * and rounding would hide whether the point is inside the domain or the points are
 * coplanar at all. */

enum eng_plane { ENG_PLANE_UNSURE, ENG_PLANE_MEET, ENG_PLANE_MISS };

/* Decide whether the features meet in a span at whose ends l and r, 0 <= l < r <= 1, the
 * cubic of `query` certainly has other signs. ENG_PLANE_UNSURE where they are not as
 * described. */
enum eng_plane eng_plane_look(const struct eng_query *query, double l, double r);

/* Find the first contact of features that do not touch at t = 0, where all four points
 * have a coordinate in common, or a point and an edge have one and the fourth point is on
 * one side of them all the time. MEET: it is in [*l, *r], which is at most as long as
 * `tolerance`; MISS: there is none in the step; UNSURE: they are not as described, or
 * doubles do not know. */
enum eng_plane eng_plane_first(const struct eng_query *query, double tolerance, double *l,
                               double *r);

/* ---- the solvers of all kinds ------------------------------------------------------ */

/* Decides the queries of a kind. The same for all kinds: features of one mesh that share
 * a vertex are not tested; a pair is a candidate if the moving boxes around its features
 * overlap; the first test is `reject_axes` of kernel.h; the exact decision is behind
 * `search`, which asks for it. */
struct eng_solver {
    /* Sift, filter and bracket of kernel.h reject and decide its pairs, as many at a time
     * as a vector has lanes. If not, each pair that `reject_axes` leaves is searched. */
    bool has_kernels;
    /* Decide any query, by exact arithmetic where rounding hides the answer. True: a
     * contact that begins before or at `t_end`, and *hit is set; [toi, toi_hi] is at most
     * `tolerance` long. Where exact->span.interrupt has stopped it, the answer is void.
     * NULL: features of the kind only meet at a distance (thick.h). */
    bool (*search)(const struct eng_query *query, double tolerance, double t_end,
                   struct eng_exact *exact, struct eng_hit *hit);
};

extern const struct eng_solver eng_solvers[PCCD_KIND_COUNT];

#endif
