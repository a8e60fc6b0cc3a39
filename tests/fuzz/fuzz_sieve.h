/* fuzz_sieve.h - checks that the sieve (kernel.h) rejects only pairs without a contact.
 */
#ifndef FUZZ_SIEVE_H
#define FUZZ_SIEVE_H

#include "batch.h"
#include "prng.h"

struct fuzz_sieve {
    uint64_t looked_at; /* pairs of a set, added up */
    uint64_t kept;      /* of these */
    uint32_t count;     /* queries that the grid could hold */
    struct eng_mark marks[4 * ENG_CHUNK_MAX];
    uint32_t corner[4][ENG_CHUNK_MAX];
    uint32_t pair[ENG_CHUNK_MAX]; /* of the chunk, each of `count` */
    uint32_t a[ENG_CHUNK_MAX + ENG_SIEVE_SPARE];
    uint32_t b[ENG_CHUNK_MAX + ENG_SIEVE_SPARE];
    uint32_t first_b[ENG_CHUNK_MAX]; /* what the first set has kept */
};

/* A chunk and the true answers to it. */
struct fuzz_answered {
    enum pccd_kind kind;
    uint32_t count;
    const struct eng_query *queries;
    const bool *found;
    const struct eng_hit *hits;
    double t_end;
};

/* NULL, or what is wrong; *wrong: the query. */
const char *fuzz_sieve_check(struct fuzz_sieve *sieve, struct prng *prng,
                             const struct fuzz_answered *chunk, uint32_t *wrong);

#endif
