/* daemon/engine/result/hash.c - the hash of an answer, alone or in shares.
 *
 * Room:     engine.
 * Does:     leave whole data to the library; the same arithmetic for blocks out of turn.
 * Threads:  [any].
 * Source:   xxHash 0.8, doc/xxhash_spec.md: the default secret, accumulation of stripes,
 *           scrambling after a block, the end of large inputs.
 */
#include "hash.h"

#include <assert.h>
#include <string.h>
#include <xxhash.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define STRIPE_BYTES      64u
#define SECRET_BYTES      192u
#define STRIPES_PER_BLOCK (ENG_HASH_BLOCK_BYTES / STRIPE_BYTES)

#define PRIME32_1 0x9e3779b1u
#define PRIME32_2 0x85ebca77u
#define PRIME32_3 0xc2b2ae3du
#define PRIME64_1 0x9e3779b185ebca87u
#define PRIME64_2 0xc2b2ae3d27d4eb4fu
#define PRIME64_3 0x165667b19e3779f9u
#define PRIME64_4 0x85ebca77c2b2ae63u
#define PRIME64_5 0x27d4eb2f165667c5u

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "words are read as they lie");

static const unsigned char secret[SECRET_BYTES] = {
    0xb8, 0xfe, 0x6c, 0x39, 0x23, 0xa4, 0x4b, 0xbe, 0x7c, 0x01, 0x81, 0x2c, 0xf7, 0x21,
    0xad, 0x1c, 0xde, 0xd4, 0x6d, 0xe9, 0x83, 0x90, 0x97, 0xdb, 0x72, 0x40, 0xa4, 0xa4,
    0xb7, 0xb3, 0x67, 0x1f, 0xcb, 0x79, 0xe6, 0x4e, 0xcc, 0xc0, 0xe5, 0x78, 0x82, 0x5a,
    0xd0, 0x7d, 0xcc, 0xff, 0x72, 0x21, 0xb8, 0x08, 0x46, 0x74, 0xf7, 0x43, 0x24, 0x8e,
    0xe0, 0x35, 0x90, 0xe6, 0x81, 0x3a, 0x26, 0x4c, 0x3c, 0x28, 0x52, 0xbb, 0x91, 0xc3,
    0x00, 0xcb, 0x88, 0xd0, 0x65, 0x8b, 0x1b, 0x53, 0x2e, 0xa3, 0x71, 0x64, 0x48, 0x97,
    0xa2, 0x0d, 0xf9, 0x4e, 0x38, 0x19, 0xef, 0x46, 0xa9, 0xde, 0xac, 0xd8, 0xa8, 0xfa,
    0x76, 0x3f, 0xe3, 0x9c, 0x34, 0x3f, 0xf9, 0xdc, 0xbb, 0xc7, 0xc7, 0x0b, 0x4f, 0x1d,
    0x8a, 0x51, 0xe0, 0x4b, 0xcd, 0xb4, 0x59, 0x31, 0xc8, 0x9f, 0x7e, 0xc9, 0xd9, 0x78,
    0x73, 0x64, 0xea, 0xc5, 0xac, 0x83, 0x34, 0xd3, 0xeb, 0xc3, 0xc5, 0x81, 0xa0, 0xff,
    0xfa, 0x13, 0x63, 0xeb, 0x17, 0x0d, 0xdd, 0x51, 0xb7, 0xf0, 0xda, 0x49, 0xd3, 0x16,
    0x55, 0x26, 0x29, 0xd4, 0x68, 0x9e, 0x2b, 0x16, 0xbe, 0x58, 0x7d, 0x47, 0xa1, 0xfc,
    0x8f, 0xf8, 0xb8, 0xd1, 0x7a, 0xd0, 0x31, 0xce, 0x45, 0xcb, 0x3a, 0x8f, 0x95, 0x16,
    0x04, 0x28, 0xaf, 0xd7, 0xfb, 0xca, 0xbb, 0x4b, 0x40, 0x7e,
};

static uint64_t load(const unsigned char *from)
{
    uint64_t word;
    memcpy(&word, from, sizeof word);
    return word;
}

typedef uint64_t lanes __attribute__((vector_size(16)));

static lanes load_lanes(const unsigned char *from)
{
    lanes words;
    memcpy(&words, from, sizeof words);
    return words;
}

/* Lower half times upper half of each lane. */
static lanes multiply_halves(lanes key)
{
#ifdef __SSE2__ /* one instruction, which compilers do not see in the other form */
    return (lanes)_mm_mul_epu32((__m128i)key, (__m128i)(key >> 32));
#else
    return (key & 0xffffffffu) * (key >> 32);
#endif
}

/* Add `count` stripes: to each lane a product of its own and its neighbour's words. */
static void accumulate(struct eng_hash_sum *sum, const unsigned char *from, size_t count,
                       const unsigned char *keys)
{
    for (unsigned i = 0; i < 8; i += 2) {
        lanes products = {0, 0};
        lanes words = {0, 0};
        for (size_t stripe = 0; stripe < count; stripe++) {
            lanes word = load_lanes(from + STRIPE_BYTES * stripe + 8 * i);
            words += word;
            products += multiply_halves(word ^ load_lanes(keys + 8 * stripe + 8 * i));
        }
        sum->lane[i] += products[0] + words[1];
        sum->lane[i + 1] += products[1] + words[0];
    }
}

void eng_hash(const void *data, size_t bytes, uint64_t hash[2])
{
    XXH128_hash_t h = XXH3_128bits(data, bytes);
    hash[0] = h.high64;
    hash[1] = h.low64;
}

void eng_hash_block(const unsigned char *block, struct eng_hash_sum *sum)
{
    *sum = (struct eng_hash_sum){{0}};
    accumulate(sum, block, STRIPES_PER_BLOCK, secret);
}

void eng_hash_begin(struct eng_hash_sum *chain)
{
    *chain = (struct eng_hash_sum){{PRIME32_3, PRIME64_1, PRIME64_2, PRIME64_3, PRIME64_4,
                                    PRIME32_2, PRIME64_5, PRIME32_1}};
}

/* Each lane times PRIME32_1, modulo 2^64. */
static lanes multiply_by_prime(lanes lane)
{
    const lanes prime = {PRIME32_1, PRIME32_1};
#ifdef __SSE2__
    lanes low = (lanes)_mm_mul_epu32((__m128i)lane, (__m128i)prime);
    lanes high = (lanes)_mm_mul_epu32((__m128i)(lane >> 32), (__m128i)prime);
    return low + (high << 32);
#else
    return lane * prime;
#endif
}

void eng_hash_add(struct eng_hash_sum *chain, const struct eng_hash_sum *blocks,
                  size_t count)
{
    const unsigned char *keys = secret + SECRET_BYTES - STRIPE_BYTES;
    lanes lane[4];
    memcpy(lane, chain, sizeof lane);
    for (size_t block = 0; block < count; block++) {
#pragma GCC unroll 4
        for (unsigned i = 0; i < 4; i++) { /* side by side: each waits for itself */
            lanes sum = lane[i];
            sum += load_lanes((const unsigned char *)&blocks[block].lane[2 * i]);
            sum ^= sum >> 47;
            sum ^= load_lanes(keys + 16 * i);
            lane[i] = multiply_by_prime(sum);
        }
    }
    memcpy(chain, lane, sizeof lane);
}

static uint64_t fold(uint64_t a, uint64_t b)
{
    __extension__ typedef unsigned __int128 wide;
    wide product = (wide)a * b;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

static uint64_t merge(const struct eng_hash_sum *chain, const unsigned char *keys,
                      uint64_t start)
{
    for (unsigned i = 0; i < 8; i += 2) {
        start += fold(chain->lane[i] ^ load(keys + 8 * i),
                      chain->lane[i + 1] ^ load(keys + 8 * i + 8));
    }
    start ^= start >> 37;
    start *= 0x165667919e3779f9u;
    return start ^ start >> 32;
}

void eng_hash_end(struct eng_hash_sum *chain, const void *data, size_t bytes,
                  uint64_t hash[2])
{
    assert(bytes > 240);
    const unsigned char *from = data;
    size_t done = eng_hash_blocks(bytes) * ENG_HASH_BLOCK_BYTES;
    size_t stripes = (bytes - 1 - done) / STRIPE_BYTES;
    accumulate(chain, from + done, stripes, secret);
    /* The last 64 bytes, some of them for the second time. */
    accumulate(chain, from + bytes - STRIPE_BYTES, 1,
               secret + SECRET_BYTES - STRIPE_BYTES - 7);
    hash[0] = merge(chain, secret + SECRET_BYTES - STRIPE_BYTES - 11,
                    ~((uint64_t)bytes * PRIME64_2));
    hash[1] = merge(chain, secret + 11, (uint64_t)bytes * PRIME64_1);
}
