/* nearest.h - what is said of the distance of two features. */
#ifndef ENG_NEAREST_H
#define ENG_NEAREST_H

#include <stdint.h>

/* What a distance is between. */
enum eng_nearest {
    ENG_NEAREST_VF = 0,
    ENG_NEAREST_EE = 1,
    ENG_NEAREST_VE = 2,
    ENG_NEAREST_VV = 3
};

struct eng_distance {
    /* The distance, rounded down and up to doubles of at most 33 significant bits: equal
     * where it is one. */
    double lo;
    double hi;
    /* Where: VF weights of the second and the third corner, EE positions on the first and
     * the second edge, 0 at its first end. 0 .. 1. The nearest multiples of 2^-32, halves
     * to even. */
    double param[2];
    /* Of length 1, from the second feature to the first, each coordinate rounded
     * likewise; zeros at distance 0. */
    double direction[3];
    /* The one of the fewest points between which the distance is. Among equals, of two
     * vertices those of the least lower rank, then of the least higher one; of a vertex
     * and an edge those of the least rank of the vertex, then of the edge's higher, then
     * of its lower end. Parallel edges are VV or VE, never EE. */
    enum eng_nearest type;
    uint32_t points; /* bit i: point i of the pair is one of them */
};

/* How much is wanted of a pair that is near enough. */
enum eng_distance_wanted {
    ENG_DISTANCE_WITHIN, /* that it is: no number */
    ENG_DISTANCE_LENGTH, /* lo and hi */
    ENG_DISTANCE_WHOLE   /* all of it */
};

#endif
