/* each.h - does something with each of many items, by several threads: of a batch, a step
 * with each scene.
 *
 * Threads: [compute]; it opens one parallel region.
 */
#ifndef ENG_EACH_H
#define ENG_EACH_H

#include <stdint.h>

#include "affinity.h"

struct eng_each {
    uint32_t count;                      /* items 0 .. count - 1 */
    uint32_t threads;                    /* at most so many, >= 1; 1: the calling one */
    const struct eng_affinity *affinity; /* where they belong; NULL: anywhere */
    /* [team] `thread`: 0 is the calling one. The first item of each thread is the one
     * with its number. */
    void (*item)(void *context, uint32_t item, uint32_t thread);
    void *context;
};

/* Returns when all items are done; what was done with them is visible then. The threads
 * pay for memory as the calling one does (memory.h). */
void eng_each(const struct eng_each *each);

#endif
