/* share.h - divides a loop into equal parts, one for each thread.
 *
 * Divide items 0 .. count - 1 into one run for each thread of a team. A thread takes its
 * own run first, then what others have left. So it finds in its cache what it wrote a
 * step before, and threads compete for a counter only at the end.
 */
#ifndef ENG_SHARE_H
#define ENG_SHARE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct eng_share {
    _Alignas(128) atomic_uint next; /* that nobody has taken */
    uint32_t end;
};

/* Where the run of thread `i` of `threads` begins; i = threads: where all end. */
static inline uint32_t eng_share_begin(uint32_t count, uint32_t i, uint32_t threads)
{
    return (uint32_t)((uint64_t)count * i / threads);
}

/* Whose run item `i` is in, give or take one. */
static inline uint32_t eng_share_of(uint32_t count, uint32_t i, uint32_t threads)
{
    return (uint32_t)((uint64_t)i * threads / count);
}

/* Before the region. [compute] */
static inline void eng_share_init(struct eng_share *share, uint32_t count, uint32_t i,
                                  uint32_t threads)
{
    atomic_init(&share->next, eng_share_begin(count, i, threads));
    share->end = eng_share_begin(count, i + 1, threads);
}

/* False: nothing is left. Relaxed: what is taken was made before the region. [team] */
static inline bool eng_share_take(struct eng_share *share, uint32_t *item)
{
    if (atomic_load_explicit(&share->next, memory_order_relaxed) >= share->end) {
        return false;
    }
    *item = atomic_fetch_add_explicit(&share->next, 1, memory_order_relaxed);
    return *item < share->end;
}

#endif
