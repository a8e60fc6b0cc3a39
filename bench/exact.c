/* bench/exact.c - what one pair costs that floating point cannot decide.
 *
 * Room:     bench (engine: exact.h, solve.h).
 * Does:     make pairs of features by family of their coordinates' exponents, decide
 *           each alone, and report those that took exact arithmetic. A slow one is
 *           decided three times, and its best time counts.
 * Does not: judge the answers (tests/fuzz does).
 * Threads:  one.
 */
#include <math.h>
#include <string.h>

#include "exact.h"
#include "prng.h"
#include "report.h"
#include "solve.h"

#define PAIRS     2000u
#define TRIES_MAX 400000u
#define SLOW_NS   100000u
#define TIME_NS   (4ull * 1000 * 1000 * 1000) /* of a family, at most */

/* Coordinates are integers -4 .. 4 or all of 53 bits, times a power of two between these.
 * `mixed`: either of the two, nothing between. */
struct family {
    const char *name;
    int least;
    int most;
    bool is_small;
    bool is_mixed;
};

static const struct family families[] = {
    {"grid", 0, 0, true, false},
    {"2^-60 .. 2^57, small", -60, 57, true, false},
    {"2^-60 .. 2^59", -60, 59, false, false},
    {"2^-300 .. 2^57, small", -300, 57, true, false},
    {"2^-300 .. 2^59", -300, 59, false, false},
    {"1e18 and denormal, small", -1074, 57, true, true},
    {"1e18 and denormal", -1060, 59, false, true},
    {"all", -1074, 59, false, false},
};

static double some_coordinate(struct prng *prng, const struct family *family,
                              double pool[8])
{
    if (prng_below(prng, 6) == 0) {
        return 0;
    }
    if (prng_below(prng, 4) == 0) {
        return pool[prng_below(prng, 8)]; /* the same again: features touch */
    }
    int span = family->most - family->least;
    int above = family->is_mixed ? (int)prng_below(prng, 2) * span
                                 : (int)prng_below(prng, (uint64_t)span + 1);
    double mantissa =
        family->is_small ? (double)prng_below(prng, 9) - 4 : prng_between(prng, -1, 1);
    return pool[prng_below(prng, 8)] = ldexp(mantissa, family->least + above);
}

static double decide(const struct eng_query *query, struct eng_exact *exact)
{
    struct eng_hit hit;
    uint64_t begin_ns = bench_now_ns();
    (void)eng_search(query, 1e-6, 1, exact, &hit);
    return (double)(bench_now_ns() - begin_ns);
}

static void run(const struct family *family, struct eng_exact *exact)
{
    struct prng prng = {1};
    double pool[8] = {0};
    struct bench_samples times = {0};
    uint64_t end_ns = bench_now_ns() + TIME_NS;
    for (uint32_t i = 0; i < TRIES_MAX && times.count < PAIRS && bench_now_ns() < end_ns;
         i++) {
        struct eng_query query = {.kind = i % 2 ? ENG_EE : ENG_VF};
        for (int k = 0; k < 24; k++) {
            query.x[k / 12][k / 3 % 4][k % 3] = some_coordinate(&prng, family, pool);
        }
        uint64_t before = exact->queries;
        double ns = decide(&query, exact);
        if (exact->queries == before) {
            continue;
        }
        for (int k = 0; k < 2 && ns > SLOW_NS; k++) {
            ns = fmin(ns, decide(&query, exact));
        }
        bench_add(&times, ns * 1e-3);
    }
    if (bench_check(times.count > 0, family->name, "no pair took exact arithmetic")) {
        bench_row(&(struct bench_row){
            .scene = family->name, .what = "a pair", .unit = "us", .samples = &times});
    }
    bench_free(&times);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_exact exact;
    int status;
    if (!bench_begin("exact", argc, argv, &options, &status)) {
        return status;
    }
    eng_exact_init(&exact);
    for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
        if (bench_is_wanted(&options, families[i].name)) {
            run(&families[i], &exact);
        }
    }
    eng_exact_deinit(&exact);
    return bench_end();
}
