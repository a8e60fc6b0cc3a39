/* per_pair.h - the first contact of each two objects, for mode first-per-pair.
 *
 * Threads: one thread for one table; find from any while nothing is added.
 */
#ifndef ENG_PER_PAIR_H
#define ENG_PER_PAIR_H

#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

struct eng_per_pair {
    struct pccd_contact *contacts; /* [count] of capacity, one for each two objects */
    uint32_t *slots; /* [2 * capacity] by hash: number of a contact and 1; 0: free */
    uint32_t count, capacity; /* capacity: a power of two, or 0 */
    uint32_t recent;          /* number of the last one that was looked for */
};

void eng_per_pair_deinit(struct eng_per_pair *table);
uint64_t eng_per_pair_bytes(const struct eng_per_pair *table);

/* Empty it. Memory that the last step did not need is freed. */
void eng_per_pair_begin(struct eng_per_pair *table);

/* Return whether `a` comes before `b`: by toi, then in canonical order. */
bool eng_contact_is_before(const struct pccd_contact *a, const struct pccd_contact *b);

/* Keep `contact` if it comes before that of the same two objects, or is the first of
 * them. PCCD_E_NOMEM: all is as before. */
int eng_per_pair_add(struct eng_per_pair *table, const struct pccd_contact *contact);

/* Return the contact of the two objects of `contact`; NULL: there is none. */
const struct pccd_contact *eng_per_pair_find(const struct eng_per_pair *table,
                                             const struct pccd_contact *contact);

#endif
