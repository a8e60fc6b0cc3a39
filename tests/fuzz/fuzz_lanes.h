/* fuzz_lanes.h - distances of many pairs at once against those of one at a time. */
#ifndef FUZZ_LANES_H
#define FUZZ_LANES_H

#include "fuzz_distance.h"

/* Chunks of up to this many: several vectors of the widest set, and a rest. */
#define FUZZ_LANES_MAX 100u

struct fuzz_lanes_run {
    struct prng prng;
    FILE *log; /* of failures */
    struct eng_distances distances;
    bool is_sharp; /* all cases are those of fuzz_sharp.h; else some chunks' are */
    uint64_t chunks;
    uint64_t cases;
    uint64_t failures;
    /* By the reference set. */
    uint64_t beyond;   /* farther than d, by boxes or planes */
    uint64_t measured; /* what those left: farther than d, by its length */
    uint64_t sure;     /* all numbers */
    uint64_t vague;    /* within d, numbers not known */
    uint64_t open;
    uint64_t types[4]; /* of the sure ones */
    uint64_t crossings;
    uint64_t past; /* edges that certainly do not pass through */
    uint64_t open_crossings;
};

void fuzz_lanes_init(struct fuzz_lanes_run *run, uint64_t seed, FILE *log);
void fuzz_lanes_deinit(struct fuzz_lanes_run *run);

/* More chunks, until one has failed. */
void fuzz_lanes_more(struct fuzz_lanes_run *run, uint64_t chunks);

#endif
