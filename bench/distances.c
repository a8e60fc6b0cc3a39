/* distances.c - what the exact distance of one pair costs.
 *
 * Make pairs of features by family, ask of each alone whether it is within a distance and
 * what its distance is, and report the times; a slow one is asked three times, and its
 * best time counts. Then the same of many pairs in turn, of which doubles decide nearly
 * all; and of chunks of those, beside one by one.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "batch.h"
#include "distance.h"
#include "prng.h"
#include "report.h"

#define PAIRS       2000u
#define PAIRS_SMOKE 20u
#define SLOW_NS     20000u
#define MANY        4096u
#define ROUNDS      40u

/* Coordinates are integers -most .. most or all of 53 bits, times a power of two between
 * these. `mixed`: either of the two, nothing between. */
struct family {
    const char *name;
    int least;
    int most;
    uint64_t bound; /* of the integers; 0: 53 bits */
    bool is_mixed;
    bool is_flat;     /* all points in one plane: distances are 0, or on edges */
    bool is_parallel; /* edges 0 1 and 2 3 */
};

static const struct family families[] = {
    {"random", 0, 0, 0, false, false, false},
    {"grid", 0, 0, 4, false, false, false},
    {"grid, parallel", 0, 0, 4, false, false, true},
    {"fine grid, parallel", 0, 0, 1 << 20, false, false, true},
    {"fine grid, flat", 0, 0, 1 << 20, false, true, false},
    {"flat", 0, 0, 0, false, true, false},
    {"2^-60 .. 2^59", -60, 59, 0, false, false, false},
    {"2^-300 .. 2^59", -300, 59, 0, false, false, false},
    {"denormal", -1074, -1074, 1 << 20, false, false, false},
    {"all", -1074, 59, 0, false, false, false},
    {"all, flat", -1074, 59, 0, false, true, false},
    {"all, parallel", -1074, 57, 4, false, false, true},
    {"1e18 and denormal", -1060, 59, 0, true, false, false},
    {"1e18 and denormal, small", -1074, 57, 4, true, false, false},
    {"1e18 and denormal, flat", -1060, 59, 0, true, true, false},
};

struct pair {
    enum pccd_kind kind;
    double x[4][3];
    double d;
};

static const uint8_t rank[4] = {0, 1, 2, 3};

static double some_coordinate(struct prng *prng, const struct family *family)
{
    uint64_t span = (uint64_t)(family->most - family->least);
    int above =
        (int)(family->is_mixed ? prng_below(prng, 2) * span : prng_below(prng, span + 1));
    double mantissa =
        family->bound > 0
            ? (double)prng_below(prng, 2 * family->bound + 1) - (double)family->bound
            : prng_between(prng, -1, 1);
    return ldexp(mantissa, family->least + above);
}

static void make(struct prng *prng, const struct family *family, struct pair *pair)
{
    size_t axis = prng_below(prng, 3);
    pair->kind = prng_below(prng, 2) ? PCCD_VF : PCCD_EE;
    for (size_t i = 0; i < 12; i++) {
        pair->x[i / 3][i % 3] = some_coordinate(prng, family);
        if (family->is_flat && i % 3 == axis) {
            pair->x[i / 3][i % 3] = 0;
        }
    }
    for (size_t k = 0; k < 3 && family->is_parallel; k++) {
        pair->x[3][k] = pair->x[2][k] + (pair->x[1][k] - pair->x[0][k]);
    }
}

/* Of this thread: what others do meanwhile does not count, as it would in a maximum. */
static double thread_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

static double find(struct eng_distances *distances, struct pair *pair)
{
    struct eng_distance distance;
    double begin_ns = thread_ns();
    eng_distance_find(distances, pair->kind, pair->x, rank, &distance);
    double ns = thread_ns() - begin_ns;
    pair->d = fmin(distance.lo, 1e18); /* as hard to decide as any */
    return ns;
}

static double decide(struct eng_distances *distances, struct pair *pair)
{
    double begin_ns = thread_ns();
    (void)eng_distance_within(distances, pair->kind, pair->x, pair->d);
    return thread_ns() - begin_ns;
}

typedef double (*ask_fn)(struct eng_distances *distances, struct pair *pair);

static void add_best(struct bench_samples *times, ask_fn ask,
                     struct eng_distances *distances, struct pair *pair)
{
    double ns = ask(distances, pair);
    for (int k = 0; k < 2 && ns > SLOW_NS; k++) {
        ns = fmin(ns, ask(distances, pair));
    }
    bench_add(times, ns * 1e-3);
}

static void run(const struct family *family, uint32_t count,
                struct eng_distances *distances)
{
    struct prng prng = {1};
    struct bench_samples find_us = {0};
    struct bench_samples decide_us = {0};
    for (uint32_t i = 0; i < count; i++) {
        struct pair pair;
        make(&prng, family, &pair);
        add_best(&find_us, find, distances, &pair);
        add_best(&decide_us, decide, distances, &pair);
    }
    bench_row(&(struct bench_row){.scene = family->name,
                                  .what = "find a distance",
                                  .unit = "us",
                                  .samples = &find_us});
    bench_row(&(struct bench_row){.scene = family->name,
                                  .what = "within the distance",
                                  .unit = "us",
                                  .samples = &decide_us});
    bench_free(&find_us);
    bench_free(&decide_us);
}

/* Many random pairs of one kind, `d` at which half of them are within. */
static void run_many(enum pccd_kind kind, uint32_t rounds,
                     struct eng_distances *distances)
{
    static struct pair pairs[MANY];
    struct prng prng = {1};
    struct bench_samples find_ns = {0};
    struct bench_samples decide_ns = {0};
    uint32_t within = 0;
    for (uint32_t i = 0; i < MANY; i++) {
        make(&prng, &families[0], &pairs[i]);
        pairs[i].kind = kind;
    }
    for (uint32_t round = 0; round < rounds; round++) {
        struct eng_distance distance;
        double begin_ns = thread_ns();
        for (uint32_t i = 0; i < MANY; i++) {
            eng_distance_find(distances, kind, pairs[i].x, rank, &distance);
        }
        bench_add(&find_ns, (thread_ns() - begin_ns) / MANY);
        begin_ns = thread_ns();
        for (uint32_t i = 0; i < MANY; i++) {
            within += eng_distance_within(distances, kind, pairs[i].x, 0.5);
        }
        bench_add(&decide_ns, (thread_ns() - begin_ns) / MANY);
    }
    const char *scene = kind == PCCD_VF ? "many random, VF" : "many random, EE";
    if (bench_check(within > 0 && within < rounds * MANY, scene, "all alike")) {
        bench_row(&(struct bench_row){.scene = scene,
                                      .what = "find a distance",
                                      .unit = "ns",
                                      .samples = &find_ns});
        bench_row(&(struct bench_row){
            .scene = scene, .what = "within 0.5", .unit = "ns", .samples = &decide_ns});
    }
    bench_free(&find_ns);
    bench_free(&decide_ns);
}

/* The same pairs as points and indices, a chunk after the other. */
struct chunks {
    struct eng_point points[4 * MANY];
    uint32_t quads[MANY][4];
    struct eng_batch batch;
    struct eng_distance found[2][MANY]; /* one by one; in chunks */
    bool is_within[2][MANY];
};

static void make_chunks(enum pccd_kind kind, struct chunks *chunks)
{
    struct prng prng = {1};
    memset(chunks, 0, sizeof *chunks);
    for (uint32_t i = 0; i < MANY; i++) {
        struct pair pair;
        make(&prng, &families[0], &pair);
        pair.kind = kind;
        for (uint32_t k = 0; k < 4; k++) {
            struct eng_point *point = &chunks->points[4 * i + k];
            memcpy(point->x0, pair.x[k], sizeof point->x0);
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
    struct bench_samples one_ns = {0};
    struct bench_samples chunk_ns = {0};
    char scene[64];
    make_chunks(kind, &chunks);
    for (uint32_t round = 0; round < rounds; round++) {
        double begin_ns = thread_ns();
        one_by_one(kind, d, distances, &chunks);
        double middle_ns = thread_ns();
        in_chunks(kind, d, distances, &chunks);
        bench_add(&one_ns, (middle_ns - begin_ns) / MANY);
        bench_add(&chunk_ns, (thread_ns() - middle_ns) / MANY);
    }
    uint32_t within = 0;
    for (uint32_t i = 0; i < MANY; i++) {
        within += chunks.is_within[0][i];
    }
    snprintf(scene, sizeof scene, "chunks, %s, %.0f %% within",
             kind == PCCD_VF ? "VF" : "EE", 100.0 * within / MANY);
    if (bench_check(
            memcmp(chunks.is_within[0], chunks.is_within[1],
                   sizeof chunks.is_within[0]) == 0 &&
                memcmp(chunks.found[0], chunks.found[1], sizeof chunks.found[0]) == 0,
            scene, "the answers differ")) {
        bench_row(&(struct bench_row){
            .scene = scene, .what = "one by one", .unit = "ns", .samples = &one_ns});
        bench_row(&(struct bench_row){.scene = scene,
                                      .what = "in chunks",
                                      .unit = "ns",
                                      .samples = &chunk_ns,
                                      .base_name = "one by one",
                                      .base = &one_ns});
    }
    bench_free(&one_ns);
    bench_free(&chunk_ns);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_distances distances;
    int status;
    if (!bench_begin("distances", argc, argv, &options, &status)) {
        return status;
    }
    if (eng_distances_init(&distances) != PCCD_OK) {
        abort();
    }
    for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
        if (bench_is_wanted(&options, families[i].name)) {
            run(&families[i], options.smoke ? PAIRS_SMOKE : PAIRS, &distances);
        }
    }
    if (bench_is_wanted(&options, "many random")) {
        run_many(PCCD_VF, options.smoke ? 1 : ROUNDS, &distances);
        run_many(PCCD_EE, options.smoke ? 1 : ROUNDS, &distances);
    }
    if (bench_is_wanted(&options, "chunks")) {
        for (int i = 0; i < 4; i++) {
            run_chunks(i % 2 ? PCCD_EE : PCCD_VF, i < 2 ? 0.5 : 0.05,
                       options.smoke ? 1 : ROUNDS, &distances);
        }
    }
    eng_distances_deinit(&distances);
    return bench_end();
}
