/* pairset.h - a hash set of pairs of numbers in which (a, b) and (b, a) are the same
 * pair.
 *
 * Threads: changed by one thread at a time, while nobody reads; reads: [any].
 */
#ifndef ENG_PAIRSET_H
#define ENG_PAIRSET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All zero is the empty set. Places are tried one after the other from the one that the
 * hash names on; a place that is taken away is filled by those behind it, so that a
 * search ends at the first empty one. */
struct eng_pairset {
    uint64_t *slots;   /* [capacity] lesser << 32 | greater, or ENG_PAIRSET_EMPTY */
    uint64_t factor;   /* of the hash, odd: who chooses the pairs does not know it */
    uint32_t capacity; /* a power of two; 0: no memory is held */
    uint32_t count;    /* at most half of the capacity */
};

/* Of two different numbers, the lesser is never 2^32 - 1. */
#define ENG_PAIRSET_EMPTY UINT64_MAX

void eng_pairset_deinit(struct eng_pairset *set);
size_t eng_pairset_bytes(const struct eng_pairset *set);

/* a != b. PCCD_E_NOMEM: the set is as before. */
int eng_pairset_add(struct eng_pairset *set, uint32_t a, uint32_t b);

/* The memory goes with the last pair. */
void eng_pairset_remove(struct eng_pairset *set, uint32_t a, uint32_t b);
bool eng_pairset_has(const struct eng_pairset *set, uint32_t a, uint32_t b);

/* The next pair after *from, which is 0 first; false: there are no more. */
bool eng_pairset_next(const struct eng_pairset *set, uint32_t *from, uint32_t pair[2]);

/* Take a pair out that has `a`; *other is the other number. False: there is none. A
 * search for all of them goes on at *from, which is 0 first. */
bool eng_pairset_take(struct eng_pairset *set, uint32_t a, uint32_t *from,
                      uint32_t *other);

/* Take out every pair of which `goes` says so: it is asked once of each. One look at
 * every place, however many go. */
void eng_pairset_prune(struct eng_pairset *set,
                       bool (*goes)(void *context, uint32_t a, uint32_t b),
                       void *context);

#endif
