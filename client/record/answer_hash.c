/* answer_hash.c - the hash of an answer, computed anew from its records. */
#include "answer_hash.h"

#include <assert.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

/* sum += what, modulo 2^128. */
static void add(uint64_t sum[2], XXH128_hash_t what)
{
    sum[1] += what.low64;
    sum[0] += what.high64 + (sum[1] < what.low64 ? 1 : 0);
}

void record_verdict_hash(uint32_t verdict, uint64_t hash[2])
{
    hash[0] = hash[1] = 0;
    add(hash, XXH3_128bits(&verdict, sizeof verdict));
}

void record_answer_hash(uint32_t version, const void *records, uint64_t count,
                        size_t record_bytes, uint64_t hash[2])
{
    const unsigned char *record = records;

    assert(version == 1 || version == 2);
    assert(records != NULL || count == 0);
    hash[0] = hash[1] = 0;
    if (version == 1) {
        add(hash, XXH3_128bits(record, count * record_bytes));
        return;
    }
    for (uint64_t i = 0; i < count; i++) {
        add(hash, XXH3_128bits(record + i * record_bytes, record_bytes));
    }
    add(hash, XXH3_128bits(&count, sizeof count));
}
