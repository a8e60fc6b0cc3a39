/* floor.c - what this machine cannot do faster. */
#include "floor.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

#define ROUNDS   9u
#define CHAIN    200000u
#define LEAST_NS 2000000u

double bench_clock_ghz(void)
{
    double best = 0;
    for (unsigned round = 0; round < ROUNDS; round++) {
        uint64_t x = round + 3;
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < CHAIN; i++) {
            x *= x;
            __asm__ volatile("" : "+r"(x));
        }
        double ghz = 3.0 * CHAIN / (double)(common_now_ns() - begin_ns);
        best = ghz > best ? ghz : best;
    }
    return best;
}

/* `to` NULL: read `from`. Bytes are those of `from`. */
static double fastest_gbps(const char *from, char *to, size_t bytes)
{
    size_t times = ((size_t)8 << 20) / bytes + 1;
    double best = 0;
    uint64_t end_ns = common_now_ns() + LEAST_NS;
    for (unsigned round = 0; round < ROUNDS || common_now_ns() < end_ns; round++) {
        uint64_t begin_ns = common_now_ns();
        for (size_t i = 0; i < times; i++) {
            const void *done = to ? memcpy(to, from, bytes) : memchr(from, 2, bytes);
            __asm__ volatile("" : : "r"(done) : "memory");
        }
        double gbps = (double)(bytes * times) / (double)(common_now_ns() - begin_ns);
        best = gbps > best ? gbps : best;
    }
    return best;
}

double bench_copy_gbps(size_t bytes)
{
    size_t half = bytes / 2 + 64;
    char *from = bench_alloc(half, 1);
    char *to = bench_alloc(half, 1);
    memset(from, 1, half);
    memset(to, 1, half);
    double gbps = 2 * fastest_gbps(from, to, half);
    free(from);
    free(to);
    return gbps;
}

double bench_read_gbps(size_t bytes)
{
    char *from = bench_alloc(bytes, 1);
    memset(from, 1, bytes);
    double gbps = fastest_gbps(from, NULL, bytes);
    free(from);
    return gbps;
}

double bench_floor_ns(struct bench_cost cost, double ghz, double gbps)
{
    double compute = cost.operations / 2 / ghz;
    double memory = cost.bytes / gbps;
    return compute > memory ? compute : memory;
}

/* ---- What `roofline` measures, one by one. */

static const char *const part_names[PART_COUNT] = {
    "box a vertex", "mark a vertex", "box an edge", "box a face", "block a vertex",
    "join 1 x 16",  "sift VF",       "sift EE",     "apart VF",   "apart EE",
    "filter VF",    "filter EE",     "bracket VF",  "bracket EE", "tests VF",
    "tests EE",     "check double",  "check float"};

const char *bench_part_name(enum part part)
{
    return part_names[part];
}

/* Lanes of doubles and of floats. */
static double double_lanes(enum eng_isa isa)
{
    static const double lanes[ENG_ISA_COUNT] = {1, 2, 4, 8, 2};
    return lanes[isa];
}

static double float_lanes(enum eng_isa isa)
{
    static const double lanes[ENG_ISA_COUNT] = {1, 4, 8, 16, 4};
    return lanes[isa];
}

struct bench_cost bench_part_cost(enum part part, enum eng_isa isa)
{
    double d = double_lanes(isa);
    double f = float_lanes(isa);
    switch (part) {
    case PART_POINTS: /* 16 of 8 doubles: there and back, compare, one up or down */
        return (struct bench_cost){64 + 64, 16 * 8 / d};
    case PART_FOLD: /* a maximum of 16 floats; 4 sides of 4 boxes turn with 7 shuffles */
        return (struct bench_cost){64 + 48, 16 / f + 7};
    case PART_EDGES: /* a maximum more */
        return (struct bench_cost){64.0 / 3 + 8 + 48, 2 * 16 / f + 7};
    case PART_FACES: /* two more */
        return (struct bench_cost){64.0 / 2 + 12 + 48, 3 * 16 / f + 7};
    case PART_JOIN: /* 4 sums and 2 ands an axis, of 16 floats; the block stays near */
        return (struct bench_cost){64, 18 * 16 / f};
    case PART_MARKS: /* of 8 doubles: minus, times, larger, plus, narrowed */
        return (struct bench_cost){64 + 32, 5 * 8 / d};
    case PART_SIFT_VF: /* differences 24; extremes 24, to floats 24, times 66 */
        return (struct bench_cost){4 * 32 + 32, 3 * 8 / f + (24 + 24 + 66) / f};
    case PART_SIFT_EE: /* extremes 36 */
        return (struct bench_cost){4 * 32 + 32, 3 * 8 / f + (36 + 24 + 66) / f};
    case PART_APART_VF: /* 4 extremes and 2 compares of 8 doubles */
    case PART_APART_EE:
        return (struct bench_cost){4 * 64 + 16, 6 * 8 / d};
    case PART_FILTER_VF: /* differences 18, times 126; the rest where a lane is left */
        return (struct bench_cost){4 * 64 + 16, (18 + 126) / d};
    case PART_FILTER_EE: /* 30, 138 */
        return (struct bench_cost){4 * 64 + 16, (30 + 138) / d};
    case PART_BRACKET_VF: /* 33 of differences, cubic and halves 115, a guess 12, three
                           * rounds to its root 60, bracket 54, place 102; 6 divisions or
                           * roots, each two cycles a lane */
    case PART_BRACKET_EE:
        return (struct bench_cost){4 * 64 + 16, 376 / d + 24};
    case PART_WITHIN: /* clear the sign, compare, and */
        return (struct bench_cost){8, 3 / d};
    default: /* PART_WIDEN: widen before */
        return (struct bench_cost){4 + 8, 4 / d};
    }
}

struct bench_cost bench_axes_cost(enum eng_isa isa)
{
    /* 4 extremes, 2 sums and 2 compares of 8 whole numbers; a mark is 32 bytes */
    return (struct bench_cost){4 * 32 + 8, 8 * 8 / float_lanes(isa)};
}
