/* near_query.h - what threads look for that find out what is near, in the place of
 * contacts.
 *
 * Threads: [any]; but for the bounds and `meets`, nothing changes while the team is at
 * work.
 */
#ifndef ENG_NEAR_QUERY_H
#define ENG_NEAR_QUERY_H

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

struct eng_near_query {
    enum pccd_near_what what;
    uint32_t kinds; /* bit k: pairs of enum pccd_kind or pccd_near_kind k are tested */
    uint32_t end;   /* of the step: 0 or 1 */
    double distance;
    bool counts_only; /* of what is found no records are made */
    /* Radii or rest of objects enter: pairs within `reach`, the distance and the largest
     * radii, rounded up, are looked at one by one (thick_work.h, near_best.h). */
    bool is_thick;
    double reach;
    float growth;       /* the distance as boxes know it, in their frame, rounded up */
    float reach_growth; /* likewise the reach, where boxes have no radii in them */
    /* VERTICES: by the scene's vertices, the least bound so far: bits of a double,
     * whose order is that of the numbers; first those of INFINITY. */
    _Atomic uint64_t *bounds;
    /* CROSSINGS: some features are known to cross or to touch. Of those that touch no
     * more is asked for, so that they are not looked for any more. */
    atomic_bool *meets;
};

/* Need pairs of that kind not be looked for? Relaxed: it is a hint. */
static inline bool eng_near_leaves_out(const struct eng_near_query *near, uint32_t kind)
{
    return near && near->what == PCCD_NEAR_CROSSINGS && kind != PCCD_EF &&
           atomic_load_explicit(near->meets, memory_order_relaxed);
}

/* The distance at which boxes of a kind are looked at: what crosses has boxes that
 * meet. */
static inline float eng_near_growth_of(const struct eng_near_query *near, uint32_t kind)
{
    return kind == PCCD_EF ? 0 : near->growth;
}

/* Does a pair not matter that is farther apart than something else is from each of its
 * points? */
static inline bool eng_near_narrows(const struct eng_near_query *near)
{
    return near && near->what == PCCD_NEAR_VERTICES;
}

/* Boxes are not within 2^80 of nowhere (boxes.h), and hold coordinates below that. */
#define ENG_GROWTH_MOST 0x1p80f

/* `distance` in a frame of this scale, a power of two. */
static inline float eng_near_growth(double distance, double scale)
{
    double scaled = distance * scale; /* exact, or infinite */
    float growth = scaled < (double)ENG_GROWTH_MOST ? (float)scaled : ENG_GROWTH_MOST;
    return (double)growth < scaled && growth < ENG_GROWTH_MOST
               ? nextafterf(growth, ENG_GROWTH_MOST)
               : growth;
}

#endif
