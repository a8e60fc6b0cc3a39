/* daemon/engine/result/hash.h - the hash of an answer, alone or in shares.
 *
 * Room:     engine. May include: the C library.
 * Does:     XXH3-128 without a seed. What a block of the data adds to the hash depends on
 *           that block alone, so many threads can look at a block each; what is left for
 *           one is to chain the sums, a sixteenth of the bytes.
 * Threads:  [any].
 * Source:   xxHash 0.8, doc/xxhash_spec.md, "XXH3 algorithm for large inputs".
 */
#ifndef ENG_HASH_H
#define ENG_HASH_H

#include <stddef.h>
#include <stdint.h>

#define ENG_HASH_BLOCK_BYTES 1024u

/* What one whole block adds. */
struct eng_hash_sum {
    uint64_t lane[8];
};

/* XXH3-128 of `bytes`: hash[0] high, hash[1] low. */
void eng_hash(const void *data, size_t bytes, uint64_t hash[2]);

/* Blocks of `bytes` that have a sum; the rest, 1 to 1024 bytes, is taken at the end. */
static inline size_t eng_hash_blocks(size_t bytes)
{
    return bytes == 0 ? 0 : (bytes - 1) / ENG_HASH_BLOCK_BYTES;
}

void eng_hash_block(const unsigned char *block, struct eng_hash_sum *sum);

/* The same as eng_hash, for more than 240 bytes (the algorithm is another for fewer),
 * from the sums of all blocks in their order. */
void eng_hash_begin(struct eng_hash_sum *chain);
void eng_hash_add(struct eng_hash_sum *chain, const struct eng_hash_sum *blocks,
                  size_t count);
void eng_hash_end(struct eng_hash_sum *chain, const void *data, size_t bytes,
                  uint64_t hash[2]);

#endif
