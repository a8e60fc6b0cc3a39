/* registry_pairs.h - remembers which pairs of objects ignore each other. */
#ifndef REGISTRY_PAIRS_H
#define REGISTRY_PAIRS_H

#include <stdbool.h>
#include <stdint.h>

struct registry_pair {
    uint32_t a; /* handles, the lesser first */
    uint32_t b;
    uint32_t order; /* in which they were told */
    bool ignored;
};

/* What was said, the last word on a pair counts. All zero: nothing. */
struct registry_pairs {
    struct registry_pair *said; /* [room] */
    uint32_t count;
    uint32_t room;
    bool is_unsettled; /* the last word on a pair may not be the only one */
};

/* Returns 0 or PCCD_E_NOMEM: it has not been noted. */
int registry_pairs_note(struct registry_pairs *pairs, uint32_t a, uint32_t b,
                        bool ignored);
/* The object is gone. O(count). */
void registry_pairs_forget(struct registry_pairs *pairs, uint32_t object);
/* Leave those that ignore each other, each once, in the order of their handles. Nothing
 * where nothing was told since the last time, else O(count log count). */
void registry_pairs_settle(struct registry_pairs *pairs);
/* Whether two objects ignore each other. O(log count), of pairs that are settled. */
bool registry_pairs_has(const struct registry_pairs *pairs, uint32_t a, uint32_t b);
void registry_pairs_deinit(struct registry_pairs *pairs);

#endif
