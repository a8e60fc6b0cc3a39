/* record_hash.h - computes the hash of an answer from its records, by the definition. */
#ifndef TESTS_RECORD_HASH_H
#define TESTS_RECORD_HASH_H

#include <stddef.h>
#include <stdint.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

/* hash[0] high, hash[1] low: XXH3-128 of all records as one string of bytes. */
static inline void record_hash_1(const void *records, uint64_t count, size_t record_bytes,
                                 uint64_t hash[2])
{
    XXH128_hash_t all = XXH3_128bits(records, count * record_bytes);
    hash[0] = all.high64;
    hash[1] = all.low64;
}

static inline void record_hash_add(XXH128_hash_t what, uint64_t sum[2])
{
    sum[1] += what.low64;
    sum[0] += what.high64 + (sum[1] < what.low64);
}

/* The sum of the XXH3-128 of each record and of their number. */
static inline void record_hash_2(const void *records, uint64_t count, size_t record_bytes,
                                 uint64_t hash[2])
{
    hash[0] = hash[1] = 0;
    for (uint64_t i = 0; i < count; i++) {
        record_hash_add(
            XXH3_128bits((const unsigned char *)records + i * record_bytes, record_bytes),
            hash);
    }
    record_hash_add(XXH3_128bits(&count, sizeof count), hash);
}

#endif
