/* tests/unit/test_eng_hash.c - the hash of an answer, alone or in shares.
 *
 * Room:     engine (hash.h).
 * Does:     known values, sensitivity to every bit, sums of blocks against the library.
 * Does not: test the library's hash of a few bytes.
 * Threads:  one.
 * Source:   daemon/engine/result/hash.h.
 */
#include "eng_kit.h"

#include <string.h>

#include "hash.h"

/* If it failed: two answers could not be compared by their hashes. */
static void hash__follows_the_content(void **state)
{
    (void)state;
    uint8_t a[300];
    uint8_t b[301];
    for (size_t i = 0; i < sizeof a; i++) {
        a[i] = (uint8_t)(i * 31);
    }
    memcpy(b + 1, a, sizeof a); /* elsewhere in memory, not aligned */
    uint64_t first[2];
    uint64_t second[2];
    eng_hash(a, sizeof a, first);
    eng_hash(b + 1, sizeof a, second);
    assert_memory_equal(first, second, sizeof first);
    for (size_t bit = 0; bit < 8 * sizeof a; bit++) {
        b[1 + bit / 8] ^= (uint8_t)(1u << bit % 8);
        eng_hash(b + 1, sizeof a, second);
        assert_memory_not_equal(first, second, sizeof first);
        b[1 + bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    eng_hash(a, 0, first);
    eng_hash(NULL, 0, second);
    assert_memory_equal(first, second, sizeof first);
    assert_true(first[0] == 0x99aa06d3014798d8u && first[1] == 0x6001c324468d497fu);
}

/* The hash from sums that are made last to first. */
static void hash_in_shares(const unsigned char *data, size_t bytes, uint64_t hash[2])
{
    static struct eng_hash_sum sums[40];
    struct eng_hash_sum chain;
    size_t blocks = eng_hash_blocks(bytes);
    assert_true(blocks <= sizeof sums / sizeof *sums);
    for (size_t i = blocks; i-- > 0;) {
        eng_hash_block(data + i * ENG_HASH_BLOCK_BYTES, &sums[i]);
    }
    eng_hash_begin(&chain);
    eng_hash_add(&chain, sums, blocks / 2);
    eng_hash_add(&chain, sums + blocks / 2, blocks - blocks / 2);
    eng_hash_end(&chain, data, bytes, hash);
}

/* If it failed: the hash of an answer would depend on the number of threads. */
static void hash__shares_give_the_hash_of_the_whole(void **state)
{
    (void)state;
    static unsigned char data[32768 + 3];
    struct kit_random random = {83};
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (unsigned char)kit_u64(&random);
    }
    for (size_t bytes = 241; bytes <= sizeof data; bytes += bytes < 5000 ? 1 : 61) {
        uint64_t whole[2];
        uint64_t shares[2];
        eng_hash(data, bytes, whole);
        hash_in_shares(data, bytes, shares);
        assert_memory_equal(shares, whole, sizeof whole);
        eng_hash(data + 3, bytes - 3, whole); /* not aligned */
        if (bytes - 3 > 240) {
            hash_in_shares(data + 3, bytes - 3, shares);
            assert_memory_equal(shares, whole, sizeof whole);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hash__follows_the_content),
        cmocka_unit_test(hash__shares_give_the_hash_of_the_whole),
    };
    return cmocka_run_group_tests_name("eng_hash", tests, NULL, NULL);
}
