/* distance_order.h - which surfaces are less far apart, exactly.
 *
 * Compare the distances of the surfaces of two pairs of features, or of one and a number,
 * by the first stage that is sure: pairs of doubles, if their radii add up to the same;
 * integers. Whoever has bounds of them by doubles looks at those first.
 *
 * Threads: one thread for one struct eng_distance_order. Comparing allocates nothing.
 * Source: elementary/BOUNDS.md, "Which distance is less".
 */
#ifndef ENG_DISTANCE_ORDER_H
#define ENG_DISTANCE_ORDER_H

#include "distance.h"

/* Room for two quotients, their products across, and what radii make of these. */
struct eng_distance_order {
    mp_limb_t *block;
};

/* Allocate the room. PCCD_E_NOMEM: there is nothing to deinit. */
int eng_distance_order_init(struct eng_distance_order *order);
void eng_distance_order_deinit(struct eng_distance_order *order);
size_t eng_distance_order_bytes(void);

/* A pair of features: points as in distance.h, and radii, each 0 .. 1e18. Its surfaces
 * are apart by the distance less the exact sum of both radii, which may be below 0. */
struct eng_features {
    enum pccd_kind kind;
    double x[4][3];
    double radius[2];
};

/* Return the sign of the exact sum of the radii `a` less that of `b`. */
enum eng_sign eng_radii_order(const double a[2], const double b[2]);

/* Return the sign of how far the surfaces of a are apart less how far those of b are;
 * never ENG_UNSURE. */
enum eng_sign eng_distance_order(struct eng_distance_order *order,
                                 struct eng_distances *distances,
                                 const struct eng_features *a,
                                 const struct eng_features *b);

/* Return whether the surfaces are at most d apart, 0 <= d <= 1e18. d itself is within. */
bool eng_distance_order_within(struct eng_distance_order *order,
                               struct eng_distances *distances,
                               const struct eng_features *features, double d);

#endif
