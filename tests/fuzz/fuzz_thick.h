/* fuzz_thick.h - the engine's test of thick features against the oracle's.
 *
 * Make pairs of features by families that are hard for one reason each, and compare every
 * verdict, flag and time, by doubles and by integers alone. The oracle takes most of the
 * time; so it may judge some cases only, and of the others what doubles say is compared
 * with what integers say.
 */
#ifndef FUZZ_THICK_H
#define FUZZ_THICK_H

#include <stdio.h>

#include "prng.h"
#include "thick.h"

struct oracle_first;

enum fuzz_thick_family {
    FUZZ_THICK_RANDOM,
    FUZZ_THICK_GRID,
    FUZZ_THICK_TANGENT,    /* the least distance is a double: r, or 2^-52 beside it */
    FUZZ_THICK_MINIMUM,    /* r is that of random features, up to some 2^-53 of it */
    FUZZ_THICK_THROUGHOUT, /* the distance does not change for a while */
    FUZZ_THICK_SLIVER,     /* as thin as 2^-54, or edges nearly parallel */
    FUZZ_THICK_COLLAPSE,   /* a feature is less than it was, at one instant */
    FUZZ_THICK_SHRINK,     /* points meet at an end, others only nearly, by noise */
    FUZZ_THICK_DEGENERATE, /* all the time */
    FUZZ_THICK_FLAT,       /* all in one plane */
    FUZZ_THICK_INSIDE,     /* begins within r, with an approach */
    FUZZ_THICK_ZERO,       /* r = 0, or 2^-1000 */
    FUZZ_THICK_FAR,        /* from the origin, 1e18 */
    FUZZ_THICK_POWERS,     /* of two, far apart */
    FUZZ_THICK_DENORMAL,
    FUZZ_THICK_FAMILIES
};

struct fuzz_thick_case {
    enum fuzz_thick_family family;
    struct eng_thick_query query;
    double tolerance;
};

struct fuzz_thick_counts {
    uint64_t cases;
    uint64_t hits;
    uint64_t initial;
    uint64_t inside;      /* at t = 0, with an approach */
    uint64_t inseparable; /* no axis keeps them apart by r over the step */
    uint64_t by_integers; /* that doubles left open */
};

struct fuzz_thick_run {
    struct prng prng;
    FILE *log; /* of failures */
    struct eng_thick thick;
    struct eng_exact contacts;
    uint32_t least_kind;  /* as for fuzz_thick_make; 0 at first */
    uint64_t oracle_each; /* the oracle judges one case of so many; 1: all */
    uint64_t judged;      /* cases that it did */
    uint64_t failures;
    uint64_t kinds[4];  /* cases by kind */
    uint64_t trends[3]; /* those judged, by whether the distance falls, stays, rises */
    uint64_t touching;  /* of those judged, at t = 0 */
    struct fuzz_thick_counts counts[FUZZ_THICK_FAMILIES];
};

const char *fuzz_thick_name(enum fuzz_thick_family family);

/* Return the number of points of the feature of a, side 0, or of b, side 1. */
int fuzz_thick_points(const struct fuzz_thick_case *made, int side);
bool fuzz_thick_is_of_b(const struct fuzz_thick_case *made, int point);
/* least_kind: 0 for all kinds, PCCD_VE for VE and VV alone. */
void fuzz_thick_make(struct prng *prng, uint32_t least_kind,
                     struct fuzz_thick_case *made);

void fuzz_thick_init(struct fuzz_thick_run *run, uint64_t seed, FILE *log);
void fuzz_thick_deinit(struct fuzz_thick_run *run);

/* Truth of a case, by the oracle; `first` is NULL where they do not meet. The caller
 * frees it with oracle_first_free. */
struct fuzz_thick_truth {
    bool is_inside;
    struct oracle_first *first;
};
struct fuzz_thick_truth fuzz_thick_truth_of(const struct fuzz_thick_case *made);
/* Return what is wrong with a hit (NULL: none was found), or NULL. */
const char *fuzz_thick_judge_hit(const struct fuzz_thick_case *made,
                                 const struct fuzz_thick_truth *truth,
                                 const struct eng_hit *hit);

bool fuzz_thick_same_hit(const struct eng_hit *a, const struct eng_hit *b);
/* A case, and what is wrong with a hit. */
void fuzz_thick_print(FILE *log, const struct fuzz_thick_case *made,
                      const struct eng_hit *hit, const char *what);

/* More cases, until some have failed. */
void fuzz_thick_more(struct fuzz_thick_run *run, uint64_t count);

struct fuzz_thick_counts fuzz_thick_total(const struct fuzz_thick_run *run);

#endif
