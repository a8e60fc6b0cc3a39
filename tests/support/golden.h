/* golden.h - fixed scenes whose answers are written down as hashes (golden hashes). */
#ifndef TESTS_GOLDEN_H
#define TESTS_GOLDEN_H

#include "play.h"

#define GOLDEN_STEPS_MAX 8u

/* Modes with records, as columns. */
enum { GOLDEN_ALL, GOLDEN_FIRST, GOLDEN_PAIRS, GOLDEN_MODES };

struct golden_step {
    uint64_t count[GOLDEN_MODES];
    uint64_t hash[GOLDEN_MODES][2]; /* version 1 (record_hash.h), high word first */
};

struct golden {
    enum play_kind kind;
    uint32_t triangle_count;
    uint64_t seed;
    struct golden_step steps[GOLDEN_STEPS_MAX];
};

/* The last one is a small one, for the product of all settings. */
#define GOLDEN_PLAYS (PLAY_KINDS + 1)
extern const struct golden golden_plays[GOLDEN_PLAYS];

#endif
