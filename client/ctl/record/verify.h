/* verify.h - checks the answer of a recorded step against exact arithmetic (`pccdctl
 * verify`).
 *
 * Recompute every record and every number of an answer, and a sample of pairs that were
 * not reported, by exact rational arithmetic that shares nothing with the engine; say of
 * what else it was not checked.
 *
 * Threads: one.
 */
#ifndef CTL_VERIFY_H
#define CTL_VERIFY_H

#include "play.h"

struct verify_settings {
    uint64_t seed;
    uint64_t contacts_max; /* of a step that are checked, a sample; 0: all */
    uint64_t sample;       /* pairs of a step that are near, and not in the answer */
};

struct verify_counts {
    uint64_t steps;
    uint64_t contacts;     /* proved ones, and right */
    uint64_t possible;     /* not proved, and not contradicted */
    uint64_t non_contacts; /* of the sample, and right */
    uint64_t unchecked;    /* steps of which nothing could be checked */
    uint64_t nears;        /* questions about what is near */
    uint64_t near_records; /* of them, and right, with all else that is near left out */
    uint64_t nears_unchecked;
};

/* What was found to be wrong. */
struct verify_witness {
    uint64_t step;
    char what[200];
    bool has_pair;
    struct pccd_pair pair;
    double p[8][3]; /* as oracle.h orders them */
    bool has_claim; /* toi and toi_hi of the record */
    double toi, toi_hi;
    bool has_contact; /* exact: the first contact lies in [lo, hi] */
    double lo, hi;
};

#define VERIFY_WHY_BYTES 160

/* What came of a step or a question; without pointers, so that other processes can be
 * told. */
struct verify_result {
    uint64_t step;
    bool is_near;
    bool is_wrong; /* `witness` says how */
    /* Why it, or a part of its answer, could not be checked; "": all of it was, but for
     * what the settings leave out. */
    char unchecked[VERIFY_WHY_BYTES];
    struct verify_counts counts;
    struct verify_witness witness;
};

/* Check a step, all of its answer but for what was measured (times, counters, threads,
 * the method). PCCD_OK with *result, else an error. */
int verify_step(const struct play_step *step, const struct verify_settings *settings,
                struct verify_result *result, struct ctl_error *error);
/* verify_distance.c: an answer about what is near, likewise. */
int verify_distances(const struct play_near *near, struct verify_result *result,
                     struct ctl_error *error);
/* One that was not repeated, because it had failed by chance. */
void verify_skip(uint64_t step, bool is_near, struct verify_result *result);

/* How a step begins, exactly: edges that pass through faces and, with an approach, pairs
 * within their distance. */
struct verify_start {
    bool is_known; /* it was asked, and is not too much to decide */
    uint64_t crossings, inside;
};

/* ---- parts of it; false: wrong, and the result says how ---------------------------- */

/* verify_numbers.c: the numbers of an answer, against its records. */
bool verify_numbers(const struct play_step *step, struct verify_result *result);
/* verify_near.c: a sample of pairs near each other that are not in the answer. */
bool verify_near(const struct play_step *step, const struct verify_settings *settings,
                 struct verify_result *result);
/* verify_distance.c: what a step says of how it begins, and what is true of that. */
bool verify_start(const struct play_step *step, struct verify_result *result,
                  struct verify_start *start, struct ctl_error *error, int *status);
/* verify_any.c: whether the verdict of mode any is that of all pairs and of the start. */
bool verify_any(const struct play_step *step, const struct verify_start *start,
                struct verify_result *result, struct ctl_error *error, int *status);
/* verify_place.c: why the parameters or the normal of a contact whose times are right
 * cannot be; NULL: they can. Of a thick pair r > 0. */
const char *verify_place(const struct pccd_contact *contact, const double p[8][3],
                         double r);

/* ---- what they use ----------------------------------------------------------------- */

/* Whether the answer holds the pair. */
bool verify_has(const struct play_step *step, const struct pccd_pair *pair);
/* Whether nothing ended the step before it was done. */
bool verify_is_complete(const struct play_step *step);
/* The result is wrong, with the exact time of the pair's contact if it has one. Returns
 * false. */
bool verify_wrong(struct verify_result *result, const struct play_step *step,
                  const struct pccd_pair *pair, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Something was not checked; what was said first stays. Returns true. */
bool verify_leave(struct verify_result *result, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Numbers of a step's answer: the daemon's, or what was recorded. */
uint32_t verify_mode(const struct play_step *step);
double verify_toi_first(const struct play_step *step);
uint32_t verify_verdict(const struct play_step *step);
uint32_t verify_incomplete(const struct play_step *step);

#endif
