/* sieve.h - points rounded to a grid of whole numbers, by which most pairs are rejected
 * before doubles are read.
 *
 * Marks take half the bytes of the points themselves, so a vector holds twice as many.
 * Differences of whole numbers are exact, so what the sieve may reject depends on the
 * size of a pair and not on its distance from the origin.
 */
#ifndef ENG_SIEVE_H
#define ENG_SIEVE_H

#include <stdbool.h>
#include <stdint.h>

/* The number of a coordinate is the whole one that is nearest to (x - origin) scale: of
 * |x - origin| scale <= ENG_GRID_REACH. Differences of two numbers, and 8 more, fit. */
struct eng_grid {
    double origin[3];
    double scale; /* a power of two */
};

#define ENG_GRID_REACH (0x1p30 - 8)

/* A point at both ends of the step. How near another feature is to it there, at most, as
 * is known by now: so much is to be taken from the reach of sift_near, both being bits of
 * floats; 0: nothing is known. Any thread may write one while others read it. */
struct eng_mark {
    _Alignas(32) int32_t q0[3];
    _Atomic int32_t less0;
    int32_t q1[3];
    _Atomic int32_t less1;
};

/* Pairs are named by a number of each feature; VF: the vertex's is its point, a_corner is
 * not looked at. EE: b_corner[2] is not. */
struct eng_sieve {
    const struct eng_mark *marks;
    const uint32_t *a_corner[2];
    const uint32_t *b_corner[3];
    float t_end;      /* <= 1: pairs that certainly do not meet up to then go, too */
    bool swept;       /* the boxes around the pairs' whole motions overlap, no more */
    bool in_time;     /* the pairs share a time on all axes: eng_join.in_time */
    bool cubic_first; /* which of two tests goes first; the sieve's own, false before */
    bool narrows;     /* sift_near: what is known of a pair's points counts, that of which
                       * least is */
};

/* Places behind the last pair that the sieve may write to. */
#define ENG_SIEVE_SPARE 16u

#endif
