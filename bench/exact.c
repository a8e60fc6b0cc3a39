/* exact.c - what one pair costs that floating point cannot decide.
 *
 * Make pairs of features by family of their coordinates' exponents and by shape, decide
 * each alone, and report those that took exact arithmetic. A slow one is decided three
 * times, and its best time counts. The maximum is the point: nobody waits longer for a
 * deadline or for one pair of another user. The same for thick features, of which all are
 * put to integers.
 */
#include <math.h>
#include <string.h>
#include <time.h>

#include "exact.h"
#include "prng.h"
#include "report.h"
#include "solve.h"
#include "thick.h"

#define PAIRS       2000u
#define PAIRS_SMOKE 20u
#define TRIES_MAX   400000u
#define SLOW_NS     100000u
#define TIME_NS     (4ull * 1000 * 1000 * 1000) /* of a family, at most */

/* What is done to random points, because such pairs took longest. */
enum shape {
    AS_DRAWN,
    FLAT,      /* all in one plane, throughout */
    THROUGH_0, /* half of the coordinates change their sign at the same time */
    TOUCHING,  /* two points are one, at one end */
};

/* Coordinates are integers -4 .. 4 or all of 53 bits, times a power of two between these.
 * `mixed`: either of the two, nothing between. */
struct family {
    const char *name;
    int least;
    int most;
    bool is_small;
    bool is_mixed;
    enum shape shape;
};

static const struct family families[] = {
    {"grid", 0, 0, true, false, AS_DRAWN},
    {"grid, through 0", 0, 0, true, false, THROUGH_0},
    {"2^-60 .. 2^57, small", -60, 57, true, false, AS_DRAWN},
    {"2^-60 .. 2^59", -60, 59, false, false, AS_DRAWN},
    {"2^-300 .. 2^57, small", -300, 57, true, false, AS_DRAWN},
    {"2^-300 .. 2^59", -300, 59, false, false, AS_DRAWN},
    {"1e18 and denormal, small", -1074, 57, true, true, AS_DRAWN},
    {"1e18 and denormal", -1060, 59, false, true, AS_DRAWN},
    {"all", -1074, 59, false, false, AS_DRAWN},
    {"all, flat", -1074, 59, false, false, FLAT},
    {"all, through 0", -1074, 59, false, false, THROUGH_0},
    {"all, touching", -1074, 59, false, false, TOUCHING},
    {"1e18 and denormal, flat", -1060, 59, false, true, FLAT},
    {"1e18 and denormal, through 0", -1060, 59, false, true, THROUGH_0},
    {"1e18 and denormal, touching", -1060, 59, false, true, TOUCHING},
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

static void give_shape(struct prng *prng, enum shape shape, double x[2][4][3])
{
    size_t axis = prng_below(prng, 3);
    size_t end = prng_below(prng, 2);
    switch (shape) {
    case AS_DRAWN:
        break;
    case FLAT:
        for (size_t i = 0; i < 8; i++) {
            x[i / 4][i % 4][axis] = x[0][0][axis];
        }
        break;
    case THROUGH_0:
        for (size_t i = 0; i < 12; i++) {
            if (prng_below(prng, 2) == 0) {
                x[1][i / 3][i % 3] = -x[0][i / 3][i % 3];
            }
        }
        break;
    case TOUCHING:
        memcpy(x[end][prng_below(prng, 2)], x[end][2 + prng_below(prng, 2)],
               sizeof x[0][0]);
        break;
    }
}

/* Of this thread: what others do meanwhile does not count, as it would in a maximum. */
static double thread_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

static double decide(const struct eng_query *query, struct eng_exact *exact)
{
    struct eng_hit hit;
    double begin_ns = thread_ns();
    (void)eng_search(query, 1e-6, 1, exact, &hit);
    return thread_ns() - begin_ns;
}

static void run(const struct family *family, uint32_t pairs, struct eng_exact *exact)
{
    struct prng prng = {1};
    double pool[8] = {0};
    struct bench_samples times = {0};
    uint64_t end_ns = common_now_ns() + TIME_NS;
    for (uint32_t i = 0; i < TRIES_MAX && times.count < pairs && common_now_ns() < end_ns;
         i++) {
        struct eng_query query = {.kind = i % 2 ? PCCD_EE : PCCD_VF};
        for (int k = 0; k < 24; k++) {
            query.x[k / 12][k / 3 % 4][k % 3] = some_coordinate(&prng, family, pool);
        }
        give_shape(&prng, family->shape, query.x);
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

/* ---- thick features ---------------------------------------------------------------- */

/* Features in planes z = 0 and z = `height`, a radius of that height: where they overlap,
 * the distance is r exactly. */
static void give_height(struct prng *prng, struct eng_thick_query *query)
{
    int first = query->query.kind == PCCD_EE ? 2 : 1;
    double height = 1 + (double)prng_below(prng, 3);
    for (int i = 0; i < 8; i++) {
        query->query.x[i / 4][i % 4][2] = i % 4 < first ? height : 0;
    }
    query->radius[0] = height;
}

struct thick_family {
    const char *name;
    int coordinates; /* index in `families` */
    bool is_tangent;
    double approach;
};

static const struct thick_family thick_families[] = {
    {"thick: grid", 0, false, 0},
    {"thick: grid, at exactly r", 0, true, 0},
    {"thick: grid, begins inside", 0, false, 0.5},
    {"thick: 2^-60 .. 2^59", 3, false, 0},
    {"thick: 2^-300 .. 2^59", 5, false, 0},
    {"thick: 1e18 and denormal", 7, false, 0},
    {"thick: all", 8, false, 0},
    {"thick: all, begins inside", 8, false, 0.7},
    {"thick: all, touching", 11, false, 0},
};

static double decide_thick(const struct eng_thick_query *query, struct eng_thick *thick,
                           struct eng_exact *exact)
{
    struct eng_hit hit;
    double begin_ns = thread_ns();
    (void)eng_thick_solve(thick, exact, query, 1e-6, 1, &hit);
    return thread_ns() - begin_ns;
}

static void run_thick(const struct thick_family *thick_family, uint32_t pairs,
                      struct eng_thick *thick, struct eng_exact *exact)
{
    const struct family *family = &families[thick_family->coordinates];
    struct prng prng = {2};
    double pool[8] = {0};
    struct bench_samples times = {0};
    uint64_t end_ns = common_now_ns() + TIME_NS;
    for (uint32_t i = 0; times.count < pairs && common_now_ns() < end_ns; i++) {
        struct eng_thick_query query = {.approach = thick_family->approach};
        query.query.kind = (enum pccd_kind)(i % 4);
        for (int k = 0; k < 24; k++) {
            query.query.x[k / 12][k / 3 % 4][k % 3] =
                some_coordinate(&prng, family, pool);
        }
        give_shape(&prng, family->shape, query.query.x);
        query.radius[0] = fabs(some_coordinate(&prng, family, pool));
        if (thick_family->is_tangent) {
            give_height(&prng, &query);
        }
        double ns = decide_thick(&query, thick, exact);
        for (int k = 0; k < 2 && ns > SLOW_NS; k++) {
            ns = fmin(ns, decide_thick(&query, thick, exact));
        }
        bench_add(&times, ns * 1e-3);
    }
    if (bench_check(times.count > 0, thick_family->name, "no pair")) {
        bench_row(&(struct bench_row){.scene = thick_family->name,
                                      .what = "a pair",
                                      .unit = "us",
                                      .samples = &times});
    }
    bench_free(&times);
}

static void run_all_thick(const struct bench_options *options, struct eng_exact *exact)
{
    struct eng_thick thick;
    if (eng_thick_init(&thick) != PCCD_OK) {
        abort();
    }
    thick.first = ENG_THICK_BY_INTEGERS;
    for (size_t i = 0; i < sizeof thick_families / sizeof *thick_families; i++) {
        if (bench_is_wanted(options, thick_families[i].name)) {
            run_thick(&thick_families[i], options->smoke ? PAIRS_SMOKE : PAIRS, &thick,
                      exact);
        }
    }
    eng_thick_deinit(&thick);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_exact exact;
    int status;
    if (!bench_begin("exact", argc, argv, &options, &status)) {
        return status;
    }
    if (eng_exact_init(&exact) != PCCD_OK) {
        abort();
    }
    for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
        if (bench_is_wanted(&options, families[i].name)) {
            run(&families[i], options.smoke ? PAIRS_SMOKE : PAIRS, &exact);
        }
    }
    run_all_thick(&options, &exact);
    eng_exact_deinit(&exact);
    return bench_end();
}
