/* near_warm.h - which features of two objects were the nearest last time: where the next
 * search begins.
 *
 * Keep the pairs of an answer by their objects. Whoever uses one looks at it first, so
 * that all that is farther is left out from the beginning: what is nearest does not
 * depend on it.
 *
 * Threads: learn, forget: [compute]; find: [team].
 */
#ifndef ENG_NEAR_WARM_H
#define ENG_NEAR_WARM_H

#include "near_best.h"

struct eng_near_warm {
    struct pccd_pair *entries; /* [capacity] by a hash of the objects; all 0: none */
    uint32_t capacity;         /* 0 or a power of two */
    uint32_t count;
};

void eng_near_warm_deinit(struct eng_near_warm *warm);
uint64_t eng_near_warm_bytes(const struct eng_near_warm *warm);

/* Objects came, went or have another mesh. */
void eng_near_warm_forget(struct eng_near_warm *warm);

/* The records of a complete answer in the place of what is kept. Where memory is short
 * nothing is. */
void eng_near_warm_learn(struct eng_near_warm *warm, const struct pccd_near *records,
                         uint64_t count);

/* False: nothing is known of two objects, by index. */
bool eng_near_warm_find(const struct eng_near_warm *warm, const struct eng_scene *scene,
                        uint32_t a, uint32_t b, struct eng_near_pair *pair);

#endif
