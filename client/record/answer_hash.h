/* answer_hash.h - computes the hash of an answer from its records, to check the hash that
 * the daemon sent.
 *
 * Compute both versions (proto/PROTOCOL.md, "The hash of an answer"). A recording is
 * checked by the version that it was made with, whatever version daemons have today.
 */
#ifndef RECORD_ANSWER_HASH_H
#define RECORD_ANSWER_HASH_H

#include <stddef.h>
#include <stdint.h>

#include "pccd_types.h"

/* hash[0] high, hash[1] low, of all records of an answer, in their order; `version` is 1
 * or 2. Not for mode any: its hash is that of the verdict, in both versions. */
void record_answer_hash(uint32_t version, const void *records, uint64_t count,
                        size_t record_bytes, uint64_t hash[2]);
/* The same of mode any, in both versions. */
void record_verdict_hash(uint32_t verdict, uint64_t hash[2]);
/* The record that record_answer_hash takes of answers about the bounds of vertices, whose
 * records are the bounds alone. */
struct record_bound {
    uint32_t object, vertex;
    double bound;
};

#endif
