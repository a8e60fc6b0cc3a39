/* exact_roots.h - finds, exactly, the first time at which a polynomial is zero while
 * others have given signs: the time of a contact.
 *
 * Threads: one thread for one scratch. The interval at hand is that of span->roots.
 */
#ifndef ENG_EXACT_ROOTS_H
#define ENG_EXACT_ROOTS_H

#include "exact.h"

/* Conditions that are demanded at a root. With a plane: span->n is not 0, and the sides,
 * which are span->side[0 .. count - 1], are parallel to it there and do not point the
 * other way. Without: the first coordinates of the sides are not negative. */
struct eng_conditions {
    int count;
    bool has_plane;
    int value_count; /* `count`, or one more */
    /* Set span->condition[i] to a polynomial that is not negative at a root that
     * satisfies: one for each side, which with a plane is side . n, and then n . n, which
     * is not 0 there. How far they are from 0 decides how short an interval is named. */
    void (*set_value)(struct eng_exact_span *span,
                      const struct eng_conditions *conditions, int i);
    /* Return whether side i is certainly 0 at the root. NULL: nobody knows without
     * computing. */
    bool (*is_zero)(struct eng_exact_span *span, int i, const struct eng_root *root);
};

/* Return whether the conditions hold at the left end of the interval at hand. */
bool eng_roots_hold_at_left(struct eng_exact_span *span,
                            const struct eng_conditions *conditions);

/* Return whether they hold at the only root in the interval at hand, and set which sides
 * are 0 there. It is root number `number` to which this search comes. Whether there is a
 * contact is asked first and then, of the same span, where it is: what the one search has
 * computed the other knows. Uses span->before. */
bool eng_roots_hold_at(struct eng_exact_span *span,
                       const struct eng_conditions *conditions, int number,
                       bool is_zero[ENG_EXACT_CONDITIONS]);

/* Note that something happens between the left end of the interval at hand and `wide`
 * intervals later. The times are rounded outward; of what was found before and this, the
 * earlier is kept. */
void eng_roots_found_at(struct eng_exact_span *span, unsigned wide);

/* Return whether some root in [0, 1] of `poly`, which is of degree 3 or less and not
 * zero, satisfies the conditions. With span->wants_first the root is the first of them,
 * and span->found says where; else it is any. */
bool eng_roots_satisfy(struct eng_exact_span *span, const struct eng_poly *poly,
                       const struct eng_conditions *conditions);

#endif
