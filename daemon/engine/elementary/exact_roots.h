/* daemon/engine/elementary/exact_roots.h - roots in a span that satisfy conditions.
 *
 * Room:     engine. May include: exact.h.
 * Does:     tell whether a polynomial has a root in [0, 1] at which other polynomials
 *           have the signs that they should, and where the first one is.
 * Threads:  one thread for one scratch.
 *
 * An interval [num, num + 1] / 2^k of the span is named by span->num and k.
 */
#ifndef ENG_EXACT_ROOTS_H
#define ENG_EXACT_ROOTS_H

#include "exact.h"

/* What span->condition[count] demand at a root: >= 0, or > 0 for the last one if
 * `last_is_strict`. */
struct eng_conditions {
    int count;
    bool last_is_strict;
};

/* Do all conditions hold at the left end of interval `num` / 2^k? */
bool eng_roots_hold_at_left(struct eng_exact_span *span,
                            const struct eng_conditions *conditions, unsigned long k);

/* Something happens between num / 2^k and (num + `wide`) / 2^k. Rounded outward, and
 * merged with what was found before. */
void eng_roots_found_at(struct eng_exact_span *span, unsigned long k, unsigned wide);

/* Does some root of `poly` (not zero) in [0, 1] satisfy the first conditions->count of
 * span->condition? Ends because distinct roots separate and shared ones are recognised.
 * With span->wants_first the root is the first of them, and span->found says where; else
 * it is any. */
bool eng_roots_satisfy(struct eng_exact_span *span, const struct eng_poly *poly,
                       const struct eng_conditions *conditions);

#endif
