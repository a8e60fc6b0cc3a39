/* prng.h - repeatable random numbers for generators and property tests. */
#ifndef TESTS_PRNG_H
#define TESTS_PRNG_H

#include <stdint.h>
#include <stdlib.h>

struct prng {
    uint64_t state;
};

/* PCCD_SEED of the environment, else a fixed number. */
static inline uint64_t prng_seed(void)
{
    const char *seed = getenv("PCCD_SEED");
    return seed ? strtoull(seed, NULL, 0) : 20240517u;
}

static inline uint64_t prng_next(struct prng *prng)
{
    uint64_t z = prng->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline uint64_t prng_below(struct prng *prng, uint64_t bound)
{
    return prng_next(prng) % bound;
}

static inline uint32_t prng_u32(struct prng *prng, uint32_t bound)
{
    return (uint32_t)prng_below(prng, bound);
}

/* An integer in -bound .. bound: arithmetic on a few of them is exact. */
static inline double prng_integer(struct prng *prng, uint32_t bound)
{
    return (double)prng_u32(prng, 2 * bound + 1) - (double)bound;
}

/* lo <= x < hi, with the 53 bits of a double. */
static inline double prng_between(struct prng *prng, double lo, double hi)
{
    return lo + (hi - lo) * ((double)(prng_next(prng) >> 11) * 0x1p-53);
}

#endif
