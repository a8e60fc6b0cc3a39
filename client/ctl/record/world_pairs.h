/* client/ctl/record/world_pairs.h - pairs of objects that ignore each other.
 *
 * Room:     client/ctl. May include: the C library.
 * Does:     a set of pairs, in their order.
 * Threads:  one.
 */
#ifndef CTL_WORLD_PAIRS_H
#define CTL_WORLD_PAIRS_H

#include <stdbool.h>
#include <stdint.h>

/* All zero: none. */
struct world_pairs {
    uint32_t (*items)[2]; /* [room] handles, the lesser first */
    uint32_t count;
    uint32_t room;
};

/* Have `count` pairs ignore each other, or not any more. PCCD_OK or PCCD_E_NOMEM. */
int world_pairs_set(struct world_pairs *pairs, const uint32_t (*which)[2], uint32_t count,
                    bool ignored);
bool world_pairs_has(const struct world_pairs *pairs, uint32_t a, uint32_t b);
/* The object is gone. */
void world_pairs_forget(struct world_pairs *pairs, uint32_t object);
void world_pairs_deinit(struct world_pairs *pairs);

#endif
