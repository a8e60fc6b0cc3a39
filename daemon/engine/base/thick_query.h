/* thick_query.h - one elementary test of thick features, which asks whether two
 * features come within a distance of each other.
 */
#ifndef ENG_THICK_QUERY_H
#define ENG_THICK_QUERY_H

#include "query.h"

struct eng_thick_query {
    /* Coordinates are finite, of magnitude at most 1e18. */
    struct eng_query query;
    double radius[3]; /* each 0 .. 1e18: of feature a, of feature b, the separation */
    double approach;  /* 0, or 0 < approach < 1 */
};

/* Within 2 u of the sum of the three. */
static inline double eng_thick_sum(const double radius[3])
{
    return radius[0] + radius[1] + radius[2];
}

/* Not below the sum. */
static inline double eng_thick_reach(const double radius[3])
{
    return eng_thick_sum(radius) * (1 + 4 * ENG_U);
}

#endif
