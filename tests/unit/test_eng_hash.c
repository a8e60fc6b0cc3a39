/* test_eng_hash.c - the hash of an answer.
 *
 * Source: proto/PROTOCOL.md, "The hash of an answer".
 */
#include "eng_kit.h"
#include "order.h"
#include "record_hash.h"

static const uint32_t sizes[2] = {sizeof(struct pccd_pair), sizeof(struct pccd_contact)};

static void expect(const uint64_t hash[2], uint64_t high, uint64_t low)
{
    if (hash[0] != high || hash[1] != low) {
        fail_msg("0x%016llx, 0x%016llx", (unsigned long long)hash[0],
                 (unsigned long long)hash[1]);
    }
}

/* If it failed: a client that hashes records as PROTOCOL.md says would take right answers
 * for wrong ones. */
CASE(hash__has_the_values_that_the_protocol_tells)
{
    const struct pccd_pair pairs[2] = {{0, 1, 2, 3, 4}, {1, 1, 5, 3, 6}};
    unsigned char contacts[2 * sizeof(struct pccd_contact)];
    uint64_t hash[2];
    for (size_t i = 0; i < sizeof contacts; i++) {
        contacts[i] = (unsigned char)i;
    }
    eng_hash_end(0, 0, hash);
    expect(hash, 0x2c0a8a99dc147d54, 0x45c3b49d035665b2);
    eng_hash_end(eng_hash_records(pairs, 1, sizeof *pairs), 1, hash);
    expect(hash, 0x2841e5ef35f08604, 0xa9c89d7e04bc89dc);
    eng_hash_end(eng_hash_records(pairs, 2, sizeof *pairs), 2, hash);
    expect(hash, 0x2541185d055d371b, 0x5945dcf6861e618a);
    eng_hash_end(eng_hash_records(contacts, 2, sizeof(struct pccd_contact)), 2, hash);
    expect(hash, 0x1751fe42f627f939, 0x94cc2c85012975bd);
    eng_hash_verdict(PCCD_VERDICT_YES, hash);
    expect(hash, 0x0c3864a6c15091ba, 0x5c17dcab9fc3967b);
}

/* If it failed: two answers that differ could not be told apart by their hashes. */
CASE(hash__follows_every_bit_and_the_number_of_records)
{
    for (int k = 0; k < 2; k++) {
        unsigned char records[9 * sizeof(struct pccd_contact) + 1];
        uint32_t each = sizes[k];
        for (size_t i = 0; i < sizeof records; i++) {
            records[i] = (unsigned char)(i * 31);
        }
        eng_hash_sum sum = eng_hash_records(records + 1, 8, each); /* not aligned */
        for (size_t bit = 0; bit < 8 * 8 * each; bit++) {
            records[1 + bit / 8] ^= (unsigned char)(1u << bit % 8);
            assert_true(eng_hash_records(records + 1, 8, each) != sum);
            records[1 + bit / 8] ^= (unsigned char)(1u << bit % 8);
        }
        uint64_t eight[2];
        uint64_t nine[2];
        eng_hash_end(sum, 8, eight);
        eng_hash_end(sum, 9, nine);
        assert_memory_not_equal(eight, nine, sizeof eight);
        assert_true(eng_hash_records(records + 1, 9, each) != sum);
    }
}

/* If it failed: the hash of an answer would depend on threads or pages, or on the order
 * in which they take records. */
CASE(hash__parts_in_any_order_add_up_to_the_whole)
{
    struct prng random = {83};
    for (int k = 0; k < 2; k++) {
        uint32_t each = sizes[k];
        unsigned char *records = test_room(500 * each);
        for (size_t i = 0; i < 500 * each; i++) {
            records[i] = (unsigned char)prng_next(&random);
        }
        for (uint64_t count = 0; count <= 500; count += 1 + count / 9) {
            uint64_t cut = count > 0 ? prng_next(&random) % count : 0;
            uint64_t whole[2];
            uint64_t parts[2];
            eng_hash_sum sum = eng_hash_records(records + cut * each, count - cut, each);
            sum += eng_hash_records(records, cut, each);
            eng_hash_end(sum, count, parts);
            record_hash_2(records, count, each, whole);
            assert_memory_equal(parts, whole, sizeof whole);
        }
        free(records);
    }
}
