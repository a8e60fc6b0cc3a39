/* slowest.c - the slowest pair that a search by small changes finds. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "distance.h"
#include "distance_order.h"
#include "exact.h"
#include "prng.h"
#include "sections.h"
#include "solve.h"
#include "winding.h"

#define POINTS  5
#define NUMBERS (2 * POINTS * 3)
#define LEAST   (-1074)
#define MOST    59
#define STARTS  64   /* of which a search takes the slowest */
#define STALE   400u /* changes that were none the better before it ends */
#define SECONDS 20   /* of a question */
#define REPEATS 5

/* Points at both ends; a distance has the first. */
struct pair {
    enum pccd_kind kind;
    double tolerance;
    double x[2][POINTS][3];
};

struct scratch {
    struct eng_exact exact;
    struct eng_distances distances;
    struct eng_distance_order order;
    double d; /* of the pair at hand */
};

typedef void (*ask_fn)(struct scratch *scratch, const struct pair *pair);

static void ask_contact(struct scratch *scratch, const struct pair *pair)
{
    struct eng_hit hit;
    struct eng_query query = {.kind = pair->kind};
    memcpy(query.x[0], pair->x[0], sizeof query.x[0]);
    memcpy(query.x[1], pair->x[1], sizeof query.x[1]);
    (void)eng_search(&query, pair->tolerance, 1, &scratch->exact, &hit);
}

static void ask_distance(struct scratch *scratch, const struct pair *pair)
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    struct eng_distance distance;
    eng_distance_find(&scratch->distances, pair->kind, pair->x[0], rank, &distance);
}

static void ask_within(struct scratch *scratch, const struct pair *pair)
{
    (void)eng_distance_within(&scratch->distances, pair->kind, pair->x[0], scratch->d);
}

/* The pair at one end, and at the other. */
static void ask_order(struct scratch *scratch, const struct pair *pair)
{
    struct eng_features features[2];
    for (int end = 0; end < 2; end++) {
        features[end] = (struct eng_features){.kind = pair->kind};
        memcpy(features[end].x, pair->x[end], sizeof features[end].x);
    }
    (void)eng_distance_order(&scratch->order, &scratch->distances, &features[0],
                             &features[1]);
}

static void ask_crosses(struct scratch *scratch, const struct pair *pair)
{
    (void)eng_distance_crosses(&scratch->distances, pair->x[0]);
}

static void ask_winding(struct scratch *scratch, const struct pair *pair)
{
    (void)eng_winding(&scratch->distances.numbers, pair->x[0][0], pair->x[0] + 1);
}

static const struct question {
    const char *name;
    ask_fn ask;
} questions[] = {
    {"a contact", ask_contact},
    {"a distance", ask_distance},
    {"within the distance", ask_within},
    {"which is nearer", ask_order},
    {"an edge through a face", ask_crosses},
    {"a face around a point", ask_winding},
};

static double measure(const struct question *question, struct scratch *scratch,
                      const struct pair *pair, int repeats)
{
    static const uint8_t rank[4] = {0, 1, 2, 3};
    double best = INFINITY;
    if (question->ask == ask_within) { /* as hard to decide as any */
        struct eng_distance distance;
        eng_distance_find(&scratch->distances, pair->kind, pair->x[0], rank, &distance);
        scratch->d = fmin(distance.lo, 1e18);
    }
    for (int i = 0; i < repeats; i++) {
        double begin_ns = bench_thread_ns();
        scratch->exact.span.is_loaded = false; /* nothing is known from the last time */
        question->ask(scratch, pair);
        best = fmin(best, bench_thread_ns() - begin_ns);
    }
    return best;
}

static double *number(struct pair *pair, uint64_t i)
{
    return &pair->x[i / (POINTS * 3)][i / 3 % POINTS][i % 3];
}

static double clamped(double x)
{
    return fmax(-1e18, fmin(1e18, x));
}

/* Draw a number: its exponent is any, or one of a few hard ones; it has few bits, or
 * 53. */
static double some_number(struct prng *prng)
{
    static const int exponents[] = {LEAST, -1022, -600, -300, -60, 0, 30, MOST - 2};
    int exponent = prng_below(prng, 2)
                       ? exponents[prng_below(prng, 8)]
                       : LEAST + (int)prng_below(prng, (uint64_t)(MOST - LEAST));
    switch (prng_below(prng, 4)) {
    case 0:
        return 0;
    case 1:
        return ldexp((double)prng_below(prng, 9) - 4, exponent);
    default:
        return clamped(ldexp(prng_between(prng, -2, 2), exponent));
    }
}

static void change_number(struct prng *prng, struct pair *pair, uint64_t i)
{
    double *x = number(pair, i);
    double other = *number(pair, prng_below(prng, NUMBERS));
    switch (prng_below(prng, 9)) {
    case 0:
        *x = some_number(prng);
        break;
    case 1:
        *x = clamped(ldexp(*x, (int)prng_below(prng, 121) - 60));
        break;
    case 2:
        *x = clamped(ldexp(*x, (int)prng_below(prng, 3) - 1));
        break;
    case 3:
        *x = clamped(nextafter(*x, prng_below(prng, 2) ? INFINITY : -INFINITY));
        break;
    case 4:
        *x = -*x;
        break;
    case 5:
        *x = other;
        break;
    case 6:
        *x = *number(pair, (i + POINTS * 3) % NUMBERS); /* at the other end */
        break;
    case 7:
        *x = clamped(*x + other);
        break;
    default:
        *x = clamped(*x * prng_between(prng, 0.5, 2));
        break;
    }
}

static void change_points(struct prng *prng, struct pair *pair)
{
    uint64_t end = prng_below(prng, 2);
    double *a = pair->x[end][prng_below(prng, 4)];
    const double *b = pair->x[prng_below(prng, 2)][prng_below(prng, 4)];
    const double *c = pair->x[end][prng_below(prng, 4)];
    uint64_t how = prng_below(prng, 4);
    int by = (int)prng_below(prng, 41) - 20;
    for (int k = 0; k < 3; k++) {
        double was = a[k];
        a[k] = how == 0   ? b[k]
               : how == 1 ? clamped(b[k] + (c[k] - was))
               : how == 2 ? clamped(b[k] / 2 + c[k] / 2)
                          : clamped(ldexp(was, by));
    }
}

/* One coordinate of all points. */
static void change_axis(struct prng *prng, struct pair *pair)
{
    uint64_t axis = prng_below(prng, 3);
    uint64_t ends = 1 + prng_below(prng, 3);
    uint64_t how = prng_below(prng, 3);
    int by = (int)prng_below(prng, 201) - 100;
    double value = some_number(prng);
    for (uint64_t i = axis; i < NUMBERS; i += 3) {
        double *x = number(pair, i);
        if (ends >> (i / (POINTS * 3)) & 1) {
            *x = how == 0 ? clamped(ldexp(*x, by)) : how == 1 ? value : -*x;
        }
    }
}

static void change(struct prng *prng, struct pair *pair)
{
    static const double tolerances[] = {1e-12, 1e-6, 1};
    for (uint64_t n = 1 + prng_below(prng, 3); n > 0; n--) {
        switch (prng_below(prng, 8)) {
        case 0:
            change_points(prng, pair);
            break;
        case 1:
            change_axis(prng, pair);
            break;
        case 2:
            pair->tolerance = tolerances[prng_below(prng, 3)];
            break;
        default:
            change_number(prng, pair, prng_below(prng, NUMBERS));
        }
    }
}

/* Special forms that the first numbers are given, because such pairs take long. */
enum shape {
    AS_DRAWN,
    EXTREMES,  /* 1e18 and denormal, nothing between */
    FLAT,      /* one coordinate is the same throughout */
    THROUGH_0, /* half of them change their sign at the same time: repeated roots */
    PARALLEL,  /* edges, or an edge and the way to the vertex, at both ends */
    SHAPES
};

static void give_shape(struct prng *prng, enum shape shape, struct pair *pair)
{
    uint64_t axis = prng_below(prng, 3);
    double value = some_number(prng);
    for (uint64_t i = 0; i < NUMBERS; i++) {
        double *x = number(pair, i);
        if (shape == EXTREMES) {
            *x =
                ldexp(prng_between(prng, -1, 1), prng_below(prng, 2) ? MOST : LEAST + 30);
        } else if (shape == FLAT && i % 3 == axis) {
            *x = value;
        } else if (shape == THROUGH_0 && i < NUMBERS / 2 && prng_below(prng, 2)) {
            *number(pair, i + NUMBERS / 2) = -*x;
        }
    }
    for (uint64_t i = 0; i < 6 && shape == PARALLEL; i++) {
        double(*x)[3] = pair->x[i / 3];
        x[3][i % 3] = clamped(x[2][i % 3] + (x[1][i % 3] - x[0][i % 3]));
    }
}

static void begin(struct prng *prng, struct pair *pair)
{
    pair->kind = prng_below(prng, 2) ? PCCD_VF : PCCD_EE;
    pair->tolerance = 1e-6;
    for (uint64_t i = 0; i < NUMBERS; i++) {
        *number(pair, i) = some_number(prng);
    }
    give_shape(prng, (enum shape)prng_below(prng, SHAPES), pair);
    for (uint64_t n = prng_below(prng, 4); n > 0; n--) {
        change_points(prng, pair);
        change_axis(prng, pair);
    }
}

/* The best of some starts, then changed as long as that helps. */
static double climb(struct prng *prng, const struct question *question,
                    struct scratch *scratch, struct pair *slowest, uint64_t *tries,
                    uint64_t end_ns)
{
    double most = 0;
    for (int i = 0; i < STARTS; i++) {
        struct pair pair;
        begin(prng, &pair);
        double ns = measure(question, scratch, &pair, 1);
        if (ns > most) {
            most = ns;
            *slowest = pair;
        }
    }
    for (uint32_t stale = 0; stale < STALE && common_now_ns() < end_ns; stale++) {
        struct pair pair = *slowest;
        change(prng, &pair);
        double ns = measure(question, scratch, &pair, 1);
        ++*tries;
        if (ns > most && (ns = measure(question, scratch, &pair, REPEATS)) > most) {
            most = ns;
            *slowest = pair;
            stale = 0;
        }
    }
    return measure(question, scratch, slowest, 5 * REPEATS);
}

static void print(const struct pair *pair)
{
    printf("%s, tolerance %g\n", pair->kind == PCCD_VF ? "VF" : "EE", pair->tolerance);
    for (int i = 0; i < 2 * POINTS; i++) {
        const double *x = pair->x[i / POINTS][i % POINTS];
        printf("    {%a, %a, %a},\n", x[0], x[1], x[2]);
    }
}

static void run(const struct question *question, const struct bench_options *options,
                uint64_t seconds, struct scratch *scratch)
{
    struct prng prng = {prng_seed()};
    struct bench_samples longest_us = {0};
    struct pair slowest;
    double most = 0;
    uint64_t tries = 0;
    uint64_t end_ns = common_now_ns() + seconds * UINT64_C(1000000000);
    do {
        struct pair pair;
        double ns = climb(&prng, question, scratch, &pair, &tries, end_ns);
        bench_add(&longest_us, ns * 1e-3);
        if (ns > most) {
            most = ns;
            slowest = pair;
        }
    } while (common_now_ns() < end_ns);
    bench_row(question->name, "slowest found", "us", &longest_us, NULL, NULL);
    bench_number(question->name, "changes tried", "", (double)tries);
    if (!options->json) {
        print(&slowest);
    }
    bench_free(&longest_us);
}

const struct option_row section_slowest_rows[] = {
    {"seconds", 0, "N", "search so long for each question (default 20)", OPTION_U32,
     .at = offsetof(struct section_options, seconds), .min = 1, .max = 86400},
    {0}};

int section_slowest(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    static struct scratch scratch;
    uint64_t seconds = section->seconds ? section->seconds : options->smoke ? 0 : SECONDS;
    if (eng_exact_init(&scratch.exact) != PCCD_OK ||
        eng_distances_init(&scratch.distances) != PCCD_OK ||
        eng_distance_order_init(&scratch.order) != PCCD_OK) {
        abort();
    }
    for (size_t i = 0; i < sizeof questions / sizeof *questions; i++) {
        if (bench_is_wanted(options, questions[i].name)) {
            run(&questions[i], options, seconds, &scratch);
        }
    }
    eng_exact_deinit(&scratch.exact);
    eng_distances_deinit(&scratch.distances);
    eng_distance_order_deinit(&scratch.order);
    return 0;
}
