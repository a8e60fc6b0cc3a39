/* records.h - turns what libpccd found in this rank into this rank's part of the answer.
 *
 * Threads: one.
 */
#ifndef RANKS_RECORDS_H
#define RANKS_RECORDS_H

#include "world.h"

/* What is counted of kept records. */
struct ranks_sums {
    uint64_t counts[PCCD_KINDS_MAX];
    uint64_t possible, initial, inside, coincident, total;
    uint64_t hash[4]; /* the sum of their hashes, 32 bits each, the lowest first */
    double toi_first; /* 2: there is none */
};

/* Before libpccd computes an answer: there are no records yet, and no page of the last
 * one is held. Contacts and pairs of a step get their numbers on their way to a page. */
void ranks_records_begin(struct pccd_mpi *world);

/* One page of records; keeps the right ones behind those of the pages before.
 * PCCD_E_NOMEM. */
int ranks_records_take(struct pccd_mpi *world, const struct pccd_answer *page);
/* The same of a page that is all contacts or pairs of a step, without a copy: it stays
 * until ranks_records_begin, which releases it. False: that is not possible. */
bool ranks_records_hold(struct pccd_mpi *world, const struct pccd_answer *page);

/* Room for so many more; PCCD_E_NOMEM. */
int ranks_records_reserve(struct pccd_mpi *world, uint64_t more);
/* Put records of what is near in canonical order. */
void ranks_records_sort(struct pccd_near *records, uint64_t count);
int ranks_record_compare(const void *a, const void *b);
/* Does this rank have the first feature of a record with numbers of the whole? */
bool ranks_record_is_own(struct pccd_mpi *world, const struct pccd_near *record);

/* Of mode first: the least toi_hi here; what begins later than `limit` goes. */
double ranks_records_limit(const struct pccd_mpi *world);
void ranks_records_drop_later(struct pccd_mpi *world, double limit);

/* Of all contacts or pairs of a step, as they came: libpccd has counted them. */
void ranks_records_told(const struct pccd_mpi *world, const struct pccd_answer *answer,
                        struct ranks_sums *sums);
/* Count and hash what is kept of them. */
void ranks_records_sum(const struct pccd_mpi *world, struct ranks_sums *sums);
/* The same of records about what is near; the least d_lo and the greatest d_hi, 2e18 and
 * 0 without any. */
void ranks_records_sum_near(const struct pccd_mpi *world, struct ranks_sums *sums,
                            double *least, double *greatest);
/* Adds bounds to the sums. */
void ranks_bounds_sum(const struct ranks_bound *bounds, uint64_t count,
                      struct ranks_sums *sums);
/* The hash of an answer from the sum over all ranks; of mode any, of its verdict. */
void ranks_records_hash(const struct ranks_sums *sums, uint64_t hash[2]);
void ranks_verdict_hash(uint32_t verdict, uint64_t hash[2]);

/* What records are sorted by: kind, object_a, feature_a, object_b, feature_b. */
#define RANKS_NAME_WORDS 5
void ranks_record_name(const char *record, enum pccd_mode mode,
                       uint32_t name[RANKS_NAME_WORDS]);
static inline bool ranks_name_is_before(const uint32_t a[RANKS_NAME_WORDS],
                                        const uint32_t b[RANKS_NAME_WORDS])
{
    for (int k = 0; k < RANKS_NAME_WORDS; k++) {
        if (a[k] != b[k]) {
            return a[k] < b[k];
        }
    }
    return false;
}

static inline size_t ranks_record_bytes(enum pccd_mode mode)
{
    return mode == PCCD_MODE_PAIRS ? sizeof(struct pccd_pair)
                                   : sizeof(struct pccd_contact);
}

#endif
