/* place.h - what is known of where two features are nearest, a pair to each lane.
 *
 * Threads: [any]; inline only. Included by files of this folder alone.
 * Source: BOUNDS.md, "Distances in lanes".
 */
#ifndef ENG_PLACE_H
#define ENG_PLACE_H

#include <stdbool.h>

#include "across.h"
#include "nearest.h"

/* At most one of the masks `vertices`, `foot` and `inside` is set, and means that the
 * distance certainly is between those. What does not belong to it is any number.
 *
 * A point of the first feature and one of the second are chosen: the two vertices; the
 * vertex and the edge's nearer end; or what is nearest to the feet of the insides. */
struct eng_parts {
    eng_dm vertices;
    eng_dm foot;
    eng_dm inside;
    struct eng_v w;      /* from the second to the first of the points that are chosen */
    struct eng_v e;      /* foot: the edge, in one direction or the other */
    struct eng_across n; /* inside: across both features */
    eng_d nn;            /* n . n */
    eng_d share[2];      /* inside: params times n . n */
    eng_d share_error[2];
    /* Else param[i] is 1 where `is_one` is set and 0 elsewhere; moved, where `moves` is
     * set, by how far along e the foot is. */
    eng_dm is_one[2];
    eng_dm moves[2];
    eng_d code; /* bits: type | points << 2, as struct eng_distance has them */
};

/* The bits of a small number; not to compute with. */
ENG_INLINE eng_d eng_bits(uint32_t value)
{
    return eng_d_of((eng_di){0} + (int64_t)value);
}

ENG_INLINE eng_d eng_bits_or(eng_d a, eng_d b)
{
    return eng_d_of(eng_di_of(a) | eng_di_of(b));
}

/* `points` | type, by the masks. */
ENG_INLINE void eng_set_code(struct eng_parts *parts, eng_d points, uint32_t inside)
{
    eng_d type =
        eng_d_select(parts->foot, eng_bits(ENG_NEAREST_VE), eng_bits(ENG_NEAREST_VV));
    parts->code = eng_d_select(parts->inside, eng_bits(inside | 15u << 2),
                               eng_bits_or(points, type));
}

/* Of (a x b) . n, whatever a and b are: `sizes` is the product of theirs. */
ENG_INLINE eng_d eng_share_error(eng_d sizes, const struct eng_across *n)
{
    return sizes * (7 * n->error + 52 * ENG_U * n->size) + ENG_LOST;
}

#endif
