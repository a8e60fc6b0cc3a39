/* hash.c - the hash of an answer. */
#include "hash.h"

#include <assert.h>

#include "pccd_types.h"

/* In this file: with a length that the compiler knows, a record takes 60 instructions. */
#define XXH_INLINE_ALL
#include <xxhash.h>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "records are hashed as they lie");

static inline eng_hash_sum hash_bytes(const void *data, size_t bytes)
{
    XXH128_hash_t hash = XXH3_128bits(data, bytes);
    return (eng_hash_sum)hash.high64 << 64 | hash.low64;
}

static inline eng_hash_sum add_up(const unsigned char *record, uint64_t count,
                                  size_t record_bytes)
{
    eng_hash_sum sum = 0;
    for (uint64_t i = 0; i < count; i++) {
        sum += hash_bytes(record + i * record_bytes, record_bytes);
    }
    return sum;
}

eng_hash_sum eng_hash_records(const void *records, uint64_t count, uint32_t record_bytes)
{
    assert(records || count == 0);
    switch (record_bytes) {
    case sizeof(struct pccd_contact):
        return add_up(records, count, sizeof(struct pccd_contact));
    case sizeof(struct pccd_pair):
        return add_up(records, count, sizeof(struct pccd_pair));
    default:
        return add_up(records, count, record_bytes);
    }
}

static void tell(eng_hash_sum sum, uint64_t hash[2])
{
    hash[0] = (uint64_t)(sum >> 64);
    hash[1] = (uint64_t)sum;
}

void eng_hash_end(eng_hash_sum sum, uint64_t count, uint64_t hash[2])
{
    tell(sum + hash_bytes(&count, sizeof count), hash);
}

void eng_hash_verdict(uint32_t verdict, uint64_t hash[2])
{
    tell(hash_bytes(&verdict, sizeof verdict), hash);
}
