/* claim.h - makes two jobs that use the same thing, such as a shared scene, run one after
 * the other.
 *
 * Threads: [any], one at a time; the compute queue's lock.
 */
#ifndef SRV_CLAIM_H
#define SRV_CLAIM_H

#include <stdbool.h>
#include <stdint.h>

/* Part of the thing that is claimed. All zero: it is free. */
struct srv_claim {
    bool is_taken;
};

static inline bool srv_claims_are_free(struct srv_claim *const *claims, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (claims[i]->is_taken) {
            return false;
        }
    }
    return true;
}

static inline void srv_claims_set(struct srv_claim *const *claims, uint32_t count,
                                  bool is_taken)
{
    for (uint32_t i = 0; i < count; i++) {
        claims[i]->is_taken = is_taken;
    }
}

#endif
