/* fuzz_distance.h - exact distances of the engine against those of the oracle. */
#ifndef FUZZ_DISTANCE_H
#define FUZZ_DISTANCE_H

#include <stdio.h>

#include "distance.h"
#include "prng.h"
#include "winding.h"

enum fuzz_distance_family {
    FUZZ_DISTANCE_RANDOM,
    FUZZ_DISTANCE_NEEDLE,     /* a 10^-8 of their length wide, or nearly parallel */
    FUZZ_DISTANCE_PARALLEL,   /* edges; a face and the way to its vertex */
    FUZZ_DISTANCE_FOOT,       /* exactly on an edge or at a corner */
    FUZZ_DISTANCE_COINCIDENT, /* some points are one */
    FUZZ_DISTANCE_FAR,        /* from the origin, 1e18 */
    FUZZ_DISTANCE_POWERS,     /* of two, far apart */
    FUZZ_DISTANCE_DENORMAL,
    FUZZ_DISTANCE_DEGENERATE, /* segments and points for faces, points for edges */
    FUZZ_DISTANCE_KNOWN,      /* the distance is a double */
    FUZZ_DISTANCE_GRID,
    FUZZ_DISTANCE_SLENDER, /* needles that lanes decide */
    FUZZ_DISTANCE_FAMILIES
};

/* A pair, and a face with its edge. x[0..3]: the points of the pair; all five: as
 * eng_distance_crosses takes them. */
struct fuzz_distance_case {
    enum fuzz_distance_family family;
    enum pccd_kind kind;
    double x[5][3];
    uint8_t rank[4];
    double d;
};

struct fuzz_distance_run {
    struct prng prng;
    FILE *log; /* of failures */
    struct eng_distances distances;
    bool all_stages; /* of every case; else one by chance, and the usual first one */
    uint64_t cases;
    uint64_t failures;
    uint64_t types[4];
    uint64_t within;
    uint64_t crossings;
    uint64_t inside; /* x[0] in the tetrahedron of the other four */
    uint64_t on_surface;
    uint64_t family_cases[FUZZ_DISTANCE_FAMILIES];
    /* Of the usual way: how many were decided by each stage. */
    uint64_t stages[FUZZ_DISTANCE_FAMILIES][ENG_DISTANCE_STAGES];
};

const char *fuzz_distance_name(enum fuzz_distance_family family);
enum fuzz_distance_family fuzz_distance_family_some(struct prng *prng);
void fuzz_distance_make(struct prng *prng, enum fuzz_distance_family family,
                        enum pccd_kind kind, struct fuzz_distance_case *made);

void fuzz_distance_init(struct fuzz_distance_run *run, uint64_t seed, FILE *log);
void fuzz_distance_deinit(struct fuzz_distance_run *run);

struct oracle_distance;

/* The first of the engine's numbers that is not the oracle's, or NULL. */
const char *fuzz_distance_differ(const struct eng_distance *got,
                                 const struct oracle_distance *due);

/* Return what is wrong with the engine's answer to a case from `first` on, or NULL. */
const char *fuzz_distance_judge(struct fuzz_distance_run *run,
                                const struct fuzz_distance_case *made,
                                enum eng_distance_stage first);

/* More cases, until some have failed. */
void fuzz_distance_more(struct fuzz_distance_run *run, uint64_t count);

#endif
