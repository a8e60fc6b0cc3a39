/* distance_rule.h - what the distance of two features is between: two vertices, a vertex
 * and an edge, or their insides.
 *
 * Threads: one thread for one struct eng_numbers.
 */
#ifndef ENG_DISTANCE_RULE_H
#define ENG_DISTANCE_RULE_H

#include "number.h"
#include "pccd_types.h"
#include "query.h"

/* The distance is sqrt(num / den) 2^unit. */
struct eng_distance_exact {
    enum eng_nearest type;
    uint32_t points;
    struct eng_number num;
    struct eng_number den;
    /* param[i] is `at[i]`, or share[i] / den where that is NAN. */
    double at[2];
    struct eng_number share[2];
    /* direction[k] is g[k] / sqrt(gg), or less that, where num is not 0. */
    struct eng_vector g;
    struct eng_number gg;
    enum eng_sign side;
};

/* Set *way to the distance of the points that `numbers` were loaded with. Where
 * they do not suffice, set numbers->is_unsure; then *way means nothing. */
void eng_distance_rule(struct eng_numbers *numbers, enum pccd_kind kind,
                       const uint8_t rank[4], struct eng_distance_exact *way);

/* Decide eng_distance_crosses by these numbers. */
bool eng_crossing_rule(struct eng_numbers *numbers);

#endif
