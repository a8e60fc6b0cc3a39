/* random.h - repeatable random numbers for the tests of this folder.
 *
 * Threads: one per generator.
 */
#ifndef TEST_PROTO_RANDOM_H
#define TEST_PROTO_RANDOM_H

#include <stdint.h>
#include <stdlib.h>

struct random {
    uint64_t state;
};

static inline uint64_t random_seed(void)
{
    const char *seed = getenv("PCCD_SEED");
    return seed != NULL ? strtoull(seed, NULL, 0) : 20240517u;
}

static inline uint64_t random_u64(struct random *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline uint64_t random_below(struct random *random, uint64_t bound)
{
    return random_u64(random) % bound;
}

/* Of every magnitude, and often at the ends: MessagePack has a form for each width. */
static inline uint64_t random_magnitude(struct random *random)
{
    uint64_t value = random_u64(random) >> random_below(random, 64);
    uint64_t which = random_below(random, 8);
    return which == 0 ? 0 : which == 1 ? UINT64_MAX : value;
}

#endif
