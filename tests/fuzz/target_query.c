/* target_query.c - elementary tests of any numbers, against exact arithmetic. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz_run.h"
#include "fuzz_target.h"

#define COORDINATES 24u
#define EXTREME     1e18
#define TOLERANCE   1e-6
#define FULL_FROM   248 /* choices from there on: everything, which takes milliseconds */

/* Coordinates as 64, 32, 16 or 8 bits: few bits make queries that are degenerate. */
static double take_coordinate(struct fuzz_input *input, unsigned width)
{
    double value;
    uint64_t bits;
    switch (width) {
    case 0:
        bits = fuzz_take_u64(input);
        memcpy(&value, &bits, sizeof value);
        break;
    case 1: {
        float narrow;
        uint32_t half = fuzz_take_u32(input);
        memcpy(&narrow, &half, sizeof narrow);
        value = (double)narrow;
        break;
    }
    case 2:
        value = (int16_t)fuzz_take_u16(input);
        break;
    default:
        value = (int8_t)fuzz_take_u8(input);
        break;
    }
    return isfinite(value) ? fmax(-EXTREME, fmin(EXTREME, value)) : 0;
}

static void judge(const struct eng_query *query)
{
    static struct eng_exact exact;
    struct fuzz_tally tally = {0};
    struct eng_hit hit;
    double early;
    if (exact.block == NULL && eng_exact_init(&exact) != PCCD_OK) {
        abort();
    }
    bool hits = eng_solve(query, TOLERANCE, 1, &exact, &hit);
    FUZZ_CHECK(fuzz_judge(query, hits ? &hit : NULL, TOLERANCE, &tally, &early) ==
               FUZZ_RIGHT);
}

/* A byte of choices (kind, width), a power of two, then the coordinates. */
void fuzz_query(const uint8_t *data, size_t bytes)
{
    static struct fuzz_run run;
    static bool is_ready;
    struct fuzz_input input = {data, bytes};
    struct eng_query query = {0};
    if (!is_ready) {
        fuzz_run_init(&run, 1, stderr);
        is_ready = true;
    }
    uint8_t choices = fuzz_take_u8(&input);
    int scale = (int8_t)fuzz_take_u8(&input) / 4;
    query.kind = choices % 2 == 0 ? PCCD_VF : PCCD_EE;
    double *coordinates = &query.x[0][0][0];
    for (size_t i = 0; i < COORDINATES; i++) {
        double value = ldexp(take_coordinate(&input, choices / 2 % 4), scale);
        coordinates[i] = fmax(-EXTREME, fmin(EXTREME, value));
    }
    fuzz_scarcity_pause(); /* nothing here allocates but the judge */
    judge(&query);
    if (choices >= FULL_FROM) {
        fuzz_run_query(&run, &query, TOLERANCE, 1);
        FUZZ_CHECK(run.failures == 0);
    }
}
