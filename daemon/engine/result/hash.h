/* hash.h - the hash of an answer: one number that differs when any record differs.
 *
 * Version 2 of the hash (proto/PROTOCOL.md, "The hash of an answer"): the sum, modulo
 * 2^128, of the XXH3-128 of each record and of the number of records. A sum does not ask
 * for an order, so each thread adds up the records at hand, and pages or parts of a scene
 * add up as well. Whether the order is canonical is for tests to check.
 */
#ifndef ENG_HASH_H
#define ENG_HASH_H

#include <stddef.h>
#include <stdint.h>

/* Hashes of records, added up; 0 for none. */
__extension__ typedef unsigned __int128 eng_hash_sum;

/* What `count` records, one behind the other, add. */
eng_hash_sum eng_hash_records(const void *records, uint64_t count, uint32_t record_bytes);

/* The hash of all `count` records whose sum is known: hash[0] high, hash[1] low. */
void eng_hash_end(eng_hash_sum sum, uint64_t count, uint64_t hash[2]);

/* The hash of an answer in mode any: XXH3-128 of the verdict. */
void eng_hash_verdict(uint32_t verdict, uint64_t hash[2]);

#endif
