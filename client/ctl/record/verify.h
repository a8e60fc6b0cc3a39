/* client/ctl/record/verify.h - checks the answer of a recorded step against exact
 * arithmetic (`pccdctl verify`).
 *
 * Room:     client/ctl. May include: play.h, oracle.h.
 * Does:     recompute every record, and a sample of pairs that were not reported, by
 *           exact rational arithmetic that shares nothing with the engine.
 * Does not: print.
 * Threads:  one.
 * Source:   the definition of a contact in oracle.h.
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

/* Check a step. PCCD_OK with *is_right; *witness is set when it is not. */
int verify_step(const struct play_step *step, const struct verify_settings *settings,
                struct verify_counts *counts, struct verify_witness *witness,
                bool *is_right, struct ctl_error *error);

/* verify_near.c: pairs near each other that are not in the answer. */
bool verify_near(const struct play_step *step, const struct verify_settings *settings,
                 struct verify_counts *counts, struct verify_witness *witness);

/* verify_distance.c: an answer about what is near, all of it. As verify_step. */
int verify_distances(const struct play_near *near, struct verify_counts *counts,
                     struct verify_witness *witness, bool *is_right,
                     struct ctl_error *error);

/* ---- what both use --------------------------------------------------------------- */

/* Whether the answer holds the pair. */
bool verify_has(const struct play_step *step, const struct pccd_pair *pair);
/* *witness, with the exact time of the pair's contact if it has one. Returns false. */
bool verify_wrong(struct verify_witness *witness, const struct play_step *step,
                  const struct pccd_pair *pair, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Numbers of a step's answer: the daemon's, or what was recorded. */
uint32_t verify_mode(const struct play_step *step);
double verify_toi_first(const struct play_step *step);
uint32_t verify_verdict(const struct play_step *step);

#endif
