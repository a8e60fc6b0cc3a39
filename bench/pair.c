/* pair.c - what one pair costs: contacts that floating point cannot decide, distances.
 *
 * Pairs of features are made by family of their coordinates' exponents and by shape. The
 * maximum is the point: nobody waits longer for a deadline or for a pair of another user.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "distance.h"
#include "exact.h"
#include "prng.h"
#include "sections.h"
#include "solve.h"

#define PAIRS       2000u
#define PAIRS_SMOKE 20u
#define TRIES_MAX   400000u
#define SLOW_NS     20000u /* who took longer is asked three times; the best counts */
#define TIME_NS     (4ull * 1000 * 1000 * 1000) /* of a family, at most */
#define MANY        4096u
#define ROUNDS      40u

/* ---- pairs by family --------------------------------------------------------------- */

/* Special positions that random points are moved to, because such pairs took longest. */
enum shape {
    AS_DRAWN,
    FLAT,      /* all in one plane, throughout: distances are 0, or on edges */
    THROUGH_0, /* half of the coordinates change their sign at the same time */
    TOUCHING,  /* two points are one, at one end */
    PARALLEL,  /* edges 0 1 and 2 3 */
};

/* Coordinates are integers -bound .. bound or all of 53 bits, times a power of two
 * between these. `mixed`: either of the two, nothing between. */
struct family {
    const char *name;
    int least;
    int most;
    uint64_t bound; /* 0: 53 bits */
    bool is_mixed;
    enum shape shape;
};

static const struct family contact_families[] = {
    {"grid", 0, 0, 4, false, AS_DRAWN},
    {"grid, through 0", 0, 0, 4, false, THROUGH_0},
    {"2^-60 .. 2^57, small", -60, 57, 4, false, AS_DRAWN},
    {"2^-60 .. 2^59", -60, 59, 0, false, AS_DRAWN},
    {"2^-300 .. 2^57, small", -300, 57, 4, false, AS_DRAWN},
    {"2^-300 .. 2^59", -300, 59, 0, false, AS_DRAWN},
    {"1e18 and denormal, small", -1074, 57, 4, true, AS_DRAWN},
    {"1e18 and denormal", -1060, 59, 0, true, AS_DRAWN},
    {"all", -1074, 59, 0, false, AS_DRAWN},
    {"all, flat", -1074, 59, 0, false, FLAT},
    {"all, through 0", -1074, 59, 0, false, THROUGH_0},
    {"all, touching", -1074, 59, 0, false, TOUCHING},
    {"1e18 and denormal, flat", -1060, 59, 0, true, FLAT},
    {"1e18 and denormal, through 0", -1060, 59, 0, true, THROUGH_0},
    {"1e18 and denormal, touching", -1060, 59, 0, true, TOUCHING},
};

static const struct family distance_families[] = {
    {"random", 0, 0, 0, false, AS_DRAWN},
    {"grid", 0, 0, 4, false, AS_DRAWN},
    {"grid, parallel", 0, 0, 4, false, PARALLEL},
    {"fine grid, parallel", 0, 0, 1 << 20, false, PARALLEL},
    {"fine grid, flat", 0, 0, 1 << 20, false, FLAT},
    {"flat", 0, 0, 0, false, FLAT},
    {"2^-60 .. 2^59", -60, 59, 0, false, AS_DRAWN},
    {"2^-300 .. 2^59", -300, 59, 0, false, AS_DRAWN},
    {"denormal", -1074, -1074, 1 << 20, false, AS_DRAWN},
    {"all", -1074, 59, 0, false, AS_DRAWN},
    {"all, flat", -1074, 59, 0, false, FLAT},
    {"all, parallel", -1074, 57, 4, false, PARALLEL},
    {"1e18 and denormal", -1060, 59, 0, true, AS_DRAWN},
    {"1e18 and denormal, small", -1074, 57, 4, true, AS_DRAWN},
    {"1e18 and denormal, flat", -1060, 59, 0, true, FLAT},
};

#define POOL 8

/* `pool` NULL: always a new one. */
static double some_coordinate(struct prng *prng, const struct family *family,
                              double *pool)
{
    if (pool && prng_below(prng, 6) == 0) {
        return 0;
    }
    if (pool && prng_below(prng, 4) == 0) {
        return pool[prng_below(prng, POOL)]; /* the same again: features touch */
    }
    uint64_t span = (uint64_t)(family->most - family->least);
    int above =
        (int)(family->is_mixed ? prng_below(prng, 2) * span : prng_below(prng, span + 1));
    double mantissa =
        family->bound > 0
            ? (double)prng_below(prng, 2 * family->bound + 1) - (double)family->bound
            : prng_between(prng, -1, 1);
    double x = ldexp(mantissa, family->least + above);
    if (pool) {
        pool[prng_below(prng, POOL)] = x;
    }
    return x;
}

static void give_shape(struct prng *prng, enum shape shape, double (*x)[4][3],
                       size_t ends)
{
    size_t axis = prng_below(prng, 3);
    size_t end = prng_below(prng, ends);
    switch (shape) {
    case AS_DRAWN:
        break;
    case FLAT:
        for (size_t i = 0; i < 4 * ends; i++) {
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
    case PARALLEL:
        for (size_t k = 0; k < 3; k++) {
            x[0][3][k] = x[0][2][k] + (x[0][1][k] - x[0][0][k]);
        }
        break;
    }
}

/* Four points, at one end or both. */
static void draw(struct prng *prng, const struct family *family, double *pool,
                 double (*x)[4][3], size_t ends)
{
    for (size_t i = 0; i < 12 * ends; i++) {
        x[i / 12][i / 3 % 4][i % 3] = some_coordinate(prng, family, pool);
    }
    give_shape(prng, family->shape, x, ends);
}

/* ---- asking ------------------------------------------------------------------------ */

/* A pair, and what decides it. */
struct pair {
    struct eng_query query;
    double d; /* distances: that it is asked for */
    struct eng_exact *exact;
    struct eng_distances *distances;
};

typedef void (*ask_fn)(struct pair *pair);

static const uint8_t rank[4] = {0, 1, 2, 3};

static void decide(struct pair *pair)
{
    struct eng_hit hit;
    (void)eng_search(&pair->query, 1e-6, 1, pair->exact, &hit);
}

static void find(struct pair *pair)
{
    struct eng_distance distance;
    eng_distance_find(pair->distances, pair->query.kind,
                      (const double(*)[3])pair->query.x[0], rank, &distance);
    pair->d = fmin(distance.lo, 1e18); /* as hard to decide as any */
}

static void is_within(struct pair *pair)
{
    (void)eng_distance_within(pair->distances, pair->query.kind,
                              (const double(*)[3])pair->query.x[0], pair->d);
}

/* Microseconds of this thread: what others do meanwhile does not count, as it would in a
 * maximum. */
static double ask_us(ask_fn ask, struct pair *pair)
{
    double best = INFINITY;
    for (int k = 0; k < 3 && best > SLOW_NS; k++) {
        double begin_ns = bench_thread_ns();
        ask(pair);
        best = fmin(best, bench_thread_ns() - begin_ns);
    }
    return best * 1e-3;
}

static void row_us(const char *scene, const char *what, struct bench_samples *us)
{
    if (bench_check(us->count > 0, scene, "no pair took exact arithmetic")) {
        bench_row(scene, what, "us", us, NULL, NULL);
    }
    bench_free(us);
}

/* ---- contacts ---------------------------------------------------------------------- */

/* Those that took exact arithmetic count. */
static void run_contacts(const struct family *family, uint32_t pairs, struct pair *pair)
{
    struct prng prng = {1};
    double pool[POOL] = {0};
    struct bench_samples us = {0};
    uint64_t end_ns = common_now_ns() + TIME_NS;
    for (uint32_t i = 0; i < TRIES_MAX && us.count < pairs && common_now_ns() < end_ns;
         i++) {
        pair->query.kind = i % 2 ? PCCD_EE : PCCD_VF;
        draw(&prng, family, pool, pair->query.x, 2);
        uint64_t before = pair->exact->queries;
        double one_us = ask_us(decide, pair);
        if (pair->exact->queries != before) {
            bench_add(&us, one_us);
        }
    }
    row_us(family->name, "a pair", &us);
}

int section_exact(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    struct eng_exact exact;
    struct pair pair = {.exact = &exact};
    uint32_t pairs = options->smoke ? PAIRS_SMOKE : PAIRS;
    if (eng_exact_init(&exact) != PCCD_OK) {
        abort();
    }
    for (size_t i = 0; i < sizeof contact_families / sizeof *contact_families; i++) {
        if (bench_is_wanted(options, contact_families[i].name)) {
            run_contacts(&contact_families[i], pairs, &pair);
        }
    }
    eng_exact_deinit(&exact);
    return 0;
}

/* ---- distances --------------------------------------------------------------------- */

static void run_distances(const struct family *family, uint32_t count, struct pair *pair)
{
    struct prng prng = {1};
    struct bench_samples find_us = {0};
    struct bench_samples decide_us = {0};
    for (uint32_t i = 0; i < count; i++) {
        pair->query.kind = prng_below(&prng, 2) ? PCCD_VF : PCCD_EE;
        draw(&prng, family, NULL, pair->query.x, 1);
        bench_add(&find_us, ask_us(find, pair));
        bench_add(&decide_us, ask_us(is_within, pair));
    }
    row_us(family->name, "find a distance", &find_us);
    row_us(family->name, "within the distance", &decide_us);
}

/* The same pairs as points and indices, a chunk after the other. */
struct chunks {
    struct eng_point points[4 * MANY];
    uint32_t quads[MANY][4];
    struct eng_batch batch;
    struct eng_distance found[2][MANY]; /* one by one; in chunks */
    bool is_within[2][MANY];
};

static void make_chunks(struct chunks *chunks)
{
    struct prng prng = {1};
    memset(chunks, 0, sizeof *chunks);
    for (uint32_t i = 0; i < MANY; i++) {
        double x[4][3];
        draw(&prng, &distance_families[0], NULL, &x, 1);
        for (uint32_t k = 0; k < 4; k++) {
            struct eng_point *point = &chunks->points[4 * i + k];
            memcpy(point->x0, x[k], sizeof point->x0);
            point->word1 = k;
            chunks->quads[i][k] = 4 * i + k;
        }
    }
}

static void one_by_one(enum pccd_kind kind, double d, struct eng_distances *distances,
                       struct chunks *chunks)
{
    for (uint32_t i = 0; i < MANY; i++) {
        double x[4][3];
        for (uint32_t k = 0; k < 4; k++) {
            memcpy(x[k], chunks->points[chunks->quads[i][k]].x0, sizeof x[k]);
        }
        chunks->is_within[0][i] =
            eng_distance_within(distances, kind, (const double(*)[3])x, d);
        if (chunks->is_within[0][i]) {
            eng_distance_find(distances, kind, (const double(*)[3])x, rank,
                              &chunks->found[0][i]);
        }
    }
}

static void in_chunks(enum pccd_kind kind, double d, struct eng_distances *distances,
                      struct chunks *chunks)
{
    const struct eng_question question = {.verb = PCCD_NEAR_PAIRS};
    chunks->batch.kernels = eng_kernels();
    chunks->batch.distances = distances;
    memset(chunks->is_within[1], 0, sizeof chunks->is_within[1]);
    for (uint32_t i = 0; i < MANY; i += ENG_CHUNK_MAX) {
        const struct eng_pairs pairs = {.question = &question,
                                        .kind = kind,
                                        .count = ENG_CHUNK_MAX,
                                        .points = chunks->points,
                                        .quads =
                                            (const uint32_t(*)[4]) & chunks->quads[i],
                                        .reach = d};
        uint32_t found = eng_batch_test(&chunks->batch, &pairs);
        for (uint32_t k = 0; k < found; k++) {
            chunks->is_within[1][i + chunks->batch.index[k]] = true;
            chunks->found[1][i + chunks->batch.index[k]] = chunks->batch.near[k];
        }
    }
}

/* Random pairs of one kind, asked whether they are within d and, if so, for all numbers:
 * one by one and in chunks. */
static void run_chunks(enum pccd_kind kind, double d, uint32_t rounds,
                       struct eng_distances *distances)
{
    static struct chunks chunks;
    struct bench_side sides[] = {{"one by one", "ns", NULL, 0, 1, {0}},
                                 {"in chunks", "ns", "one by one", 0, 1, {0}}};
    char scene[64];
    make_chunks(&chunks);
    for (uint32_t round = 0; round < rounds; round++) {
        double begin_ns = bench_thread_ns();
        one_by_one(kind, d, distances, &chunks);
        double middle_ns = bench_thread_ns();
        in_chunks(kind, d, distances, &chunks);
        bench_add(&sides[0].samples, (middle_ns - begin_ns) / MANY);
        bench_add(&sides[1].samples, (bench_thread_ns() - middle_ns) / MANY);
    }
    uint32_t within = 0;
    for (uint32_t i = 0; i < MANY; i++) {
        within += chunks.is_within[0][i];
    }
    snprintf(scene, sizeof scene, "chunks, %s, %.0f %% within",
             kind == PCCD_VF ? "VF" : "EE", 100.0 * within / MANY);
    bool good = bench_check(
        memcmp(chunks.is_within[0], chunks.is_within[1], sizeof chunks.is_within[0]) ==
                0 &&
            memcmp(chunks.found[0], chunks.found[1], sizeof chunks.found[0]) == 0,
        scene, "the answers differ");
    bench_sides_end(scene, sides, 2, good);
}

int section_distances(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    struct eng_distances distances;
    struct pair pair = {.distances = &distances};
    if (eng_distances_init(&distances) != PCCD_OK) {
        abort();
    }
    for (size_t i = 0; i < sizeof distance_families / sizeof *distance_families; i++) {
        if (bench_is_wanted(options, distance_families[i].name)) {
            run_distances(&distance_families[i], options->smoke ? PAIRS_SMOKE : PAIRS,
                          &pair);
        }
    }
    for (int i = 0; i < 4 && bench_is_wanted(options, "chunks"); i++) {
        run_chunks(i % 2 ? PCCD_EE : PCCD_VF, i < 2 ? 0.5 : 0.05,
                   options->smoke ? 1 : ROUNDS, &distances);
    }
    eng_distances_deinit(&distances);
    return 0;
}
