/* fuzz_thick_lanes.h - thick features in chunks against one at a time. */
#ifndef FUZZ_THICK_LANES_H
#define FUZZ_THICK_LANES_H

#include "batch.h"
#include "fuzz_thick.h"
#include "thick.h"

#define FUZZ_THICK_CHUNK 100u

struct fuzz_thick_lanes {
    struct prng prng;
    FILE *log;
    struct eng_thick thick;
    struct eng_exact contacts;
    uint64_t cases;
    uint64_t failures;
    uint64_t survivors; /* of these cases: that the kernel did not reject */
    uint64_t hits;
    uint64_t sets;
};

void fuzz_thick_lanes_init(struct fuzz_thick_lanes *run, uint64_t seed, FILE *log);
void fuzz_thick_lanes_deinit(struct fuzz_thick_lanes *run);

/* More chunks, until some have failed. */
void fuzz_thick_lanes_more(struct fuzz_thick_lanes *run, uint64_t chunks);

#endif
