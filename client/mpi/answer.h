/* answer.h - makes one answer of what the ranks found. */
#ifndef RANKS_ANSWER_H
#define RANKS_ANSWER_H

#include "world.h"

/* ---- Turns what libpccd found in this rank into this rank's part of the answer. */

/* Sums over the records that are kept. */
struct ranks_sums {
    uint64_t counts[PCCD_KINDS_MAX];
    uint64_t possible, initial, inside, coincident, total;
    uint64_t hash[4]; /* the sum of their hashes, 32 bits each, the lowest first */
    double toi_first; /* 2: there is none */
};

/* Begin with no records, before libpccd computes an answer, and release the page of the
 * last one that is held. Contacts and pairs of a step get their numbers on their way to a
 * page. */
void ranks_records_begin(struct pccd_mpi *world);

/* Take one page of records; keep the right ones behind those of the pages before.
 * PCCD_E_NOMEM. */
int ranks_records_take(struct pccd_mpi *world, const struct pccd_answer *page);
/* Take a page that is all contacts or pairs of a step, without a copy: it stays until
 * ranks_records_begin, which releases it. Return false if that is not possible. */
bool ranks_records_hold(struct pccd_mpi *world, const struct pccd_answer *page);

/* Make room for so many more; PCCD_E_NOMEM. */
int ranks_records_reserve(struct pccd_mpi *world, uint64_t more);
/* Put records of what is near in canonical order. */
void ranks_records_sort(struct pccd_near *records, uint64_t count);
int ranks_record_compare(const void *a, const void *b);
/* Return whether this rank has the first feature of a record with numbers of the
 * whole. */
bool ranks_record_is_own(struct pccd_mpi *world, const struct pccd_near *record);

/* Return the least toi_hi here, in mode first; then drop what begins later than
 * `limit`. */
double ranks_records_limit(const struct pccd_mpi *world);
void ranks_records_drop_later(struct pccd_mpi *world, double limit);

/* Set the sums to libpccd's own, for all contacts or pairs of a step, as they came. */
void ranks_records_told(const struct pccd_mpi *world, const struct pccd_answer *answer,
                        struct ranks_sums *sums);
/* Count and hash what is kept of them. */
void ranks_records_sum(const struct pccd_mpi *world, struct ranks_sums *sums);
/* Count and hash what is kept of records about what is near, and find the least d_lo and
 * the greatest d_hi, 2e18 and 0 without any. */
void ranks_records_count_near(const struct pccd_mpi *world, struct ranks_sums *sums,
                              double *least, double *greatest);
/* Add bounds to the sums. */
void ranks_bounds_sum(const struct ranks_bound *bounds, uint64_t count,
                      struct ranks_sums *sums);
/* Make the hash of an answer from the sum over all ranks. */
void ranks_records_hash(const struct ranks_sums *sums, uint64_t hash[2]);
/* Make the hash of an answer of mode any from its verdict. */
void ranks_verdict_hash(uint32_t verdict, uint64_t hash[2]);

/* Write the name of a record, which records are sorted by: kind, object_a, feature_a,
 * object_b, feature_b. */
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

/* Collective. Make the answer to a step of `answer`, which is libpccd's in this rank,
 * without records; the kept ones are world->records. cut_ns: how long a cut took before
 * this step; 0: there was none. */
int ranks_answer_make(struct pccd_mpi *world, const struct pccd_step_settings *settings,
                      uint64_t cut_ns, struct pccd_answer *answer);
/* Collective. Make so the answer to a question about what is near. */
int ranks_answer_make_near(struct pccd_mpi *world, const struct pccd_near_settings *near,
                           struct pccd_answer *answer);

/* ---- Closest features that several ranks have found.
 *
 * A pair is found by the rank that owns its first feature. The closest features of the
 * pair may begin with another one: an end of its second edge, say. */

/* Collective. Move world->strays of all ranks to the records of those that own them. */
int ranks_merge(struct pccd_mpi *world);

/* ---- Bounds of vertices: for each, the least distance of the pairs that it is
 * part of.
 *
 * A pair is found by the rank that owns its first feature. A vertex of it may have been
 * given to another rank. So bounds go the way back on which positions came. */

/* Collective. Set world->bounds and world->bound_values, of the objects that were asked
 * for, after a question whose bounds of local vertices are world->records. answer: total,
 * hash and distance_max are written, which all ranks have then. */
int ranks_bounds_make(struct pccd_mpi *world, const struct pccd_near_settings *near,
                      struct pccd_answer *answer);

/* ---- Answers that are too long.
 *
 * The limit is of the whole answer, as in one process: the first records in canonical
 * order are kept. Each rank's libpccd keeps as many of its own, so those are among
 * them. */

#endif
