/* daemon/engine/elementary/distance_order.h - which of two distances is less, exactly.
 *
 * Room:     engine. May include: distance.h.
 * Does:     compare the distances of two pairs of features, by the first stage that is
 *           sure: pairs of doubles, then integers. Whoever has bounds of them by doubles
 *           looks at those first.
 * Threads:  one thread for one struct eng_distance_order. Comparing allocates nothing.
 * Source:   elementary/BOUNDS.md, "Which distance is less".
 */
#ifndef ENG_DISTANCE_ORDER_H
#define ENG_DISTANCE_ORDER_H

#include "distance.h"

/* Room for two quotients, their products across and one of these shifted. */
struct eng_distance_order {
    mp_limb_t *block;
};

/* PCCD_E_NOMEM: there is nothing to deinit. */
int eng_distance_order_init(struct eng_distance_order *order);
void eng_distance_order_deinit(struct eng_distance_order *order);
size_t eng_distance_order_bytes(void);

/* The points of a pair of features, as in distance.h. */
struct eng_features {
    enum pccd_kind kind;
    double x[4][3];
};

/* Sign of the distance of a less that of b; never ENG_UNSURE. */
enum eng_sign eng_distance_order(struct eng_distance_order *order,
                                 struct eng_distances *distances,
                                 const struct eng_features *a,
                                 const struct eng_features *b);

#endif
