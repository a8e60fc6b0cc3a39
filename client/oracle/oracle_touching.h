/* oracle_touching.h - what becomes of two features that touch at t = 0, by looking at
 * where everything is at one time so soon after that nothing has happened in between.
 *
 * Threads: [any]; no global state.
 */
#ifndef ORACLE_ORACLE_TOUCHING_H
#define ORACLE_ORACLE_TOUCHING_H

#include <gmp.h>
#include <stdint.h>

/* A surface: vertices at t = 0 and t = 1, and what is made of them. A face whose last two
 * corners are the same is a free edge, one of three equal corners a free point. */
struct oracle_surface {
    const double (*x[2])[3];
    const uint32_t (*leaves)[3];
    uint32_t leaf_count;
    uint32_t face_count; /* the first so many leaves are faces, whatever their corners */
};

enum oracle_fate { ORACLE_ENTERS, ORACLE_SLIDES, ORACLE_LEAVES };

/* Decide what becomes of features that touch at t = 0, by vertices: count_a of surface a,
 * 1 of VF, 2 of EE, then those of b. Only of surfaces whose coordinates around the
 * features have no more than 500 bits between the largest and the smallest. */
enum oracle_fate oracle_touching_fate(const struct oracle_surface *a,
                                      const struct oracle_surface *b, int count_a,
                                      const uint32_t v[4]);

/* Set `soon` to the time at which it looks for such features, a power of two. */
void oracle_touching_soon(const struct oracle_surface *a, const struct oracle_surface *b,
                          int count_a, const uint32_t v[4], mpq_t soon);

#endif
