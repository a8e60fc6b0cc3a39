/* fuzz_lanes.c - distances of many pairs at once against those of one at a time. */
#include "fuzz_lanes.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "distance.h"
#include "fuzz_sharp.h"
#include "kernel.h"

/* One chunk in so many is of cases that are about to be rounded otherwise. */
#define SHARP_CHUNKS 256u

#define WANTED (ENG_DISTANCE_WHOLE + 1)

/* A chunk of one kind, and what distance.h says of it. */
struct chunk {
    enum pccd_kind kind;
    uint32_t count;
    uint32_t end;
    double d;
    struct fuzz_distance_case cases[FUZZ_LANES_MAX];
    struct eng_point points[5 * FUZZ_LANES_MAX];
    uint32_t quads[FUZZ_LANES_MAX][4];
    uint32_t fives[FUZZ_LANES_MAX][5];
    struct eng_distance due[FUZZ_LANES_MAX];
    bool is_within[FUZZ_LANES_MAX];
    bool crosses[FUZZ_LANES_MAX];
};

/* Answers of the kernels of one set. */
struct said {
    uint32_t kept_count;
    uint32_t kept[FUZZ_LANES_MAX];
    struct eng_measured measured[WANTED]; /* by what is wanted */
    uint32_t index[WANTED][FUZZ_LANES_MAX];
    struct eng_distance found[WANTED][FUZZ_LANES_MAX];
    uint32_t imprecise[WANTED][FUZZ_LANES_MAX];
    uint32_t undecided[WANTED][FUZZ_LANES_MAX];
    struct eng_crossed crossed;
    uint32_t crossing[FUZZ_LANES_MAX];
    uint32_t open_crossing[FUZZ_LANES_MAX];
};

void fuzz_lanes_init(struct fuzz_lanes_run *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    if (eng_distances_init(&run->distances) != PCCD_OK) {
        abort();
    }
}

void fuzz_lanes_deinit(struct fuzz_lanes_run *run)
{
    eng_distances_deinit(&run->distances);
}

/* In half of the chunks of one family, too. */
static void make_cases(struct prng *prng, struct chunk *chunk)
{
    enum fuzz_distance_family family = fuzz_distance_family_some(prng);
    bool is_one = prng_below(prng, 2);
    for (uint32_t i = 0; i < chunk->count; i++) {
        fuzz_distance_make(prng, is_one ? family : fuzz_distance_family_some(prng),
                           chunk->kind, &chunk->cases[i]);
    }
}

static void make_sharp_cases(struct fuzz_lanes_run *run, struct chunk *chunk)
{
    for (uint32_t i = 0; i < chunk->count; i += 2) {
        struct fuzz_distance_case made[2];
        fuzz_sharp_make(&run->prng, &run->distances, chunk->kind, made);
        chunk->cases[i] = made[0];
        if (i + 1 < chunk->count) {
            chunk->cases[i + 1] = made[1];
        }
    }
}

/* Every point is somewhere else at the other end, and lies anywhere in the array. */
static void place_points(struct prng *prng, struct chunk *chunk)
{
    uint32_t total = 5 * chunk->count;
    uint32_t shift = prng_u32(prng, total);
    for (uint32_t i = 0; i < total; i++) {
        uint32_t at = (i * 7 + shift) % total; /* 7 is prime to 5 and to most counts */
        at = chunk->count % 7 == 0 ? (i + shift) % total : at;
        const double *x = chunk->cases[i / 5].x[i % 5];
        const double *other = chunk->cases[(i + 3) / 5 % chunk->count].x[i % 5];
        memcpy(chunk->points[at].x0, chunk->end == 0 ? x : other, sizeof(double[3]));
        memcpy(chunk->points[at].x1, chunk->end == 0 ? other : x, sizeof(double[3]));
        chunk->points[at].word1 = i % 5 < 4 ? chunk->cases[i / 5].rank[i % 5] : 4;
        chunk->fives[i / 5][i % 5] = at;
        if (i % 5 < 4) {
            chunk->quads[i / 5][i % 5] = at;
        }
    }
}

/* 0, the largest, the distance of one of the cases, or nearly so. */
static double some_distance(struct prng *prng, const struct chunk *chunk)
{
    const struct eng_distance *due = &chunk->due[prng_below(prng, chunk->count)];
    switch (prng_below(prng, 8)) {
    case 0:
        return 0;
    case 1:
        return 1e18;
    case 2:
        return fmin(due->lo, 1e18);
    case 3:
        return fmin(due->hi, 1e18);
    case 4:
        return fmin(due->lo * (1 + ldexp(1, -(int)prng_below(prng, 52))), 1e18);
    default:
        return fmin(due->lo * prng_between(prng, 0, 4), 1e18);
    }
}

static void make_chunk(struct fuzz_lanes_run *run, struct chunk *chunk)
{
    struct prng *prng = &run->prng;
    memset(chunk, 0, sizeof *chunk);
    chunk->kind = prng_below(prng, 2) ? PCCD_VF : PCCD_EE;
    chunk->count = 1 + prng_u32(prng, FUZZ_LANES_MAX);
    chunk->end = prng_u32(prng, 2);
    if (run->is_sharp || prng_below(prng, SHARP_CHUNKS) == 0) {
        make_sharp_cases(run, chunk);
    } else {
        make_cases(prng, chunk);
    }
    place_points(prng, chunk);
    for (uint32_t i = 0; i < chunk->count; i++) {
        const struct fuzz_distance_case *made = &chunk->cases[i];
        eng_distance_find(&run->distances, chunk->kind, made->x, made->rank,
                          &chunk->due[i]);
        chunk->crosses[i] = eng_distance_crosses(&run->distances, made->x);
    }
    chunk->d = some_distance(prng, chunk);
    for (uint32_t i = 0; i < chunk->count; i++) {
        chunk->is_within[i] = eng_distance_within(&run->distances, chunk->kind,
                                                  chunk->cases[i].x, chunk->d);
    }
}

static void ask(const struct eng_kernels *kernels, const struct chunk *chunk,
                struct said *said)
{
    uint32_t all[FUZZ_LANES_MAX];
    memset(said, 0, sizeof *said);
    for (uint32_t i = 0; i < chunk->count; i++) {
        all[i] = i;
    }
    said->kept_count = kernels->reject_at_end(
        (struct eng_quads){chunk->kind, chunk->points, chunk->quads}, chunk->count,
        chunk->end, chunk->d, said->kept);
    said->crossed =
        (struct eng_crossed){.index = said->crossing, .undecided = said->open_crossing};
    for (int k = 0; k < WANTED; k++) {
        said->measured[k] = (struct eng_measured){.wanted = (enum eng_distance_wanted)k,
                                                  .index = said->index[k],
                                                  .found = said->found[k],
                                                  .imprecise = said->imprecise[k],
                                                  .undecided = said->undecided[k]};
        kernels->measure((struct eng_quads){chunk->kind, chunk->points, chunk->quads},
                         all, chunk->count, chunk->end, chunk->d, &said->measured[k]);
    }
    kernels->cross_faces(chunk->points, chunk->fives, chunk->count, chunk->end,
                         &said->crossed);
}

static bool is_same(const struct eng_distance *a, const struct eng_distance *b)
{
    return a->type == b->type && a->points == b->points &&
           memcmp(&a->lo, &b->lo, sizeof a->lo) == 0 &&
           memcmp(&a->hi, &b->hi, sizeof a->hi) == 0 &&
           memcmp(a->param, b->param, sizeof a->param) == 0 &&
           memcmp(a->direction, b->direction, sizeof a->direction) == 0;
}

/* Return whether the numbers that were wanted are right. */
static bool is_right(const struct eng_distance *got, const struct eng_distance *due,
                     enum eng_distance_wanted wanted)
{
    switch (wanted) {
    case ENG_DISTANCE_WITHIN:
        return true;
    case ENG_DISTANCE_LENGTH:
        return memcmp(&got->lo, &due->lo, sizeof got->lo) == 0 &&
               memcmp(&got->hi, &due->hi, sizeof got->hi) == 0;
    default:
        return is_same(got, due);
    }
}

/* The first of the pairs index[count] that is not within d, or `count`; all are named. */
static uint32_t all_within(const struct chunk *chunk, const uint32_t *index,
                           uint32_t count, bool named[FUZZ_LANES_MAX])
{
    for (uint32_t i = 0; i < count; i++) {
        named[index[i]] = true;
        if (!chunk->is_within[index[i]]) {
            return i;
        }
    }
    return count;
}

/* The first case of which something wrong was said, or their number; *what is it. */
static uint32_t judge_measured(const struct chunk *chunk, const struct eng_measured *out,
                               const char **what)
{
    bool named[FUZZ_LANES_MAX] = {false};
    uint32_t near = all_within(chunk, out->index, out->near_count, named);
    uint32_t imprecise = all_within(chunk, out->imprecise, out->imprecise_count, named);
    *what = "sure, but not within d";
    if (near < out->near_count || imprecise < out->imprecise_count) {
        return near < out->near_count ? out->index[near] : out->imprecise[imprecise];
    }
    *what = "numbers";
    for (uint32_t i = 0; i < out->near_count; i++) {
        if (!is_right(&out->found[i], &chunk->due[out->index[i]], out->wanted)) {
            return out->index[i];
        }
    }
    *what = "left out, but within d";
    for (uint32_t i = 0; i < out->undecided_count; i++) {
        named[out->undecided[i]] = true;
    }
    for (uint32_t i = 0; i < chunk->count; i++) {
        if (chunk->is_within[i] && !named[i]) {
            return i;
        }
    }
    return chunk->count;
}

static uint32_t judge_kept(const struct chunk *chunk, const struct said *said,
                           const char **what)
{
    uint32_t at = 0;
    *what = "beyond, but within d";
    for (uint32_t i = 0; i < chunk->count; i++) {
        bool is_kept = at < said->kept_count && said->kept[at] == i;
        at += is_kept;
        if (chunk->is_within[i] && !is_kept) {
            return i;
        }
    }
    return chunk->count;
}

static uint32_t judge_crossed(const struct chunk *chunk, const struct said *said,
                              const char **what)
{
    bool named[FUZZ_LANES_MAX] = {false};
    *what = "crosses, it was said";
    for (uint32_t i = 0; i < said->crossed.count; i++) {
        named[said->crossing[i]] = true;
        if (!chunk->crosses[said->crossing[i]]) {
            return said->crossing[i];
        }
    }
    *what = "crosses";
    for (uint32_t i = 0; i < said->crossed.undecided_count; i++) {
        named[said->open_crossing[i]] = true;
    }
    for (uint32_t i = 0; i < chunk->count; i++) {
        if (chunk->crosses[i] && !named[i]) {
            return i;
        }
    }
    return chunk->count;
}

static const char *judge_crossings(const struct chunk *chunk,
                                   const struct eng_pairs *of_chunk,
                                   struct eng_batch *batch)
{
    bool named[FUZZ_LANES_MAX] = {false};
    struct eng_pairs pairs = *of_chunk;
    pairs.kind = PCCD_EF;
    pairs.fives = chunk->fives;
    uint32_t found = eng_batch_test(batch, &pairs);
    for (uint32_t i = 0; i < found; i++) {
        uint32_t pair = batch->index[i];
        if (pair >= chunk->count || named[pair] || !chunk->crosses[pair]) {
            return "batch: an edge that does not pass through, or twice";
        }
        named[pair] = true;
    }
    return memcmp(named, chunk->crosses, sizeof named) != 0 ? "batch: not all crossings"
                                                            : NULL;
}

/* Return what is wrong with what batch.h says, or NULL. */
static const char *judge_batch(struct fuzz_lanes_run *run, const struct chunk *chunk,
                               const struct eng_kernels *kernels)
{
    /* Verbs that want of a distance what enum eng_distance_wanted says. */
    static const enum pccd_near_what verbs[WANTED] = {
        PCCD_NEAR_CROSSINGS, PCCD_NEAR_VERTICES, PCCD_NEAR_PAIRS};
    static struct eng_batch batch;
    bool named[FUZZ_LANES_MAX] = {false};
    uint32_t wanted = prng_u32(&run->prng, WANTED);
    const struct eng_question question = {.verb = verbs[wanted], .end = chunk->end};
    const struct eng_pairs pairs = {.question = &question,
                                    .kind = chunk->kind,
                                    .count = chunk->count,
                                    .points = chunk->points,
                                    .quads = chunk->quads,
                                    .reach = chunk->d};
    batch.kernels = kernels;
    batch.distances = &run->distances;
    run->distances.first =
        (enum eng_distance_stage)prng_below(&run->prng, ENG_DISTANCE_STAGES);
    uint32_t found = eng_batch_test(&batch, &pairs);
    for (uint32_t i = 0; i < found; i++) {
        uint32_t pair = batch.index[i];
        if (pair >= chunk->count || named[pair] || !chunk->is_within[pair]) {
            return "batch: a pair that is not within d, or twice";
        }
        if (!is_right(&batch.near[i], &chunk->due[pair],
                      (enum eng_distance_wanted)wanted)) {
            return "batch: numbers";
        }
        named[pair] = true;
    }
    if (memcmp(named, chunk->is_within, sizeof named) != 0) {
        return "batch: not all pairs";
    }
    const char *what = judge_crossings(chunk, &pairs, &batch);
    run->distances.first = ENG_DISTANCE_BY_DOUBLES;
    return what;
}

static uint32_t judge(const struct chunk *chunk, const struct said *said,
                      const char **what)
{
    uint32_t wrong = judge_kept(chunk, said, what);
    if (wrong == chunk->count) {
        wrong = judge_crossed(chunk, said, what);
    }
    for (int k = 0; k < WANTED && wrong == chunk->count; k++) {
        wrong = judge_measured(chunk, &said->measured[k], what);
    }
    return wrong;
}

static void fail(struct fuzz_lanes_run *run, const struct chunk *chunk, uint32_t pair,
                 const struct eng_kernels *kernels, const char *what)
{
    const struct fuzz_distance_case *made = &chunk->cases[pair];
    run->failures++;
    fprintf(run->log, "# wrong: %s, pair %" PRIu32 " of %" PRIu32 ", set %s, family %s\n",
            what, pair, chunk->count, eng_kernels_name(kernels),
            fuzz_distance_name(made->family));
    fprintf(run->log, "%s d %a\n", chunk->kind == PCCD_VF ? "vf" : "ee", chunk->d);
    for (int i = 0; i < 5; i++) {
        fprintf(run->log, "    {%a, %a, %a},\n", made->x[i][0], made->x[i][1],
                made->x[i][2]);
    }
}

static bool are_same(const uint32_t *a, const uint32_t *b, uint32_t count)
{
    return memcmp(a, b, count * sizeof *a) == 0;
}

/* `found` was compared with distance.h's numbers, bit for bit. */
static bool measured_the_same(const struct eng_measured *a, const struct eng_measured *b)
{
    return a->near_count == b->near_count && a->imprecise_count == b->imprecise_count &&
           a->undecided_count == b->undecided_count &&
           are_same(a->index, b->index, a->near_count) &&
           are_same(a->imprecise, b->imprecise, a->imprecise_count) &&
           are_same(a->undecided, b->undecided, a->undecided_count);
}

static bool said_the_same(const struct said *a, const struct said *b)
{
    return a->kept_count == b->kept_count && are_same(a->kept, b->kept, a->kept_count) &&
           measured_the_same(&a->measured[0], &b->measured[0]) &&
           measured_the_same(&a->measured[1], &b->measured[1]) &&
           measured_the_same(&a->measured[2], &b->measured[2]) &&
           a->crossed.count == b->crossed.count &&
           a->crossed.undecided_count == b->crossed.undecided_count &&
           are_same(a->crossing, b->crossing, a->crossed.count) &&
           are_same(a->open_crossing, b->open_crossing, a->crossed.undecided_count);
}

static void count(struct fuzz_lanes_run *run, const struct chunk *chunk,
                  const struct said *said)
{
    const struct eng_measured *out = &said->measured[ENG_DISTANCE_WHOLE];
    uint32_t named = out->near_count + out->imprecise_count + out->undecided_count;
    run->chunks++;
    run->cases += chunk->count;
    run->beyond += chunk->count - said->kept_count;
    run->measured += chunk->count - named;
    run->sure += out->near_count;
    run->vague += out->imprecise_count;
    run->open += out->undecided_count;
    for (uint32_t i = 0; i < out->near_count; i++) {
        run->types[out->found[i].type]++;
    }
    run->crossings += said->crossed.count;
    run->open_crossings += said->crossed.undecided_count;
    run->past += chunk->count - said->crossed.count - said->crossed.undecided_count;
}

void fuzz_lanes_more(struct fuzz_lanes_run *run, uint64_t chunks)
{
    static struct chunk chunk;
    static struct said said[ENG_ISA_COUNT];
    for (uint64_t n = 0; n < chunks && run->failures == 0; n++) {
        make_chunk(run, &chunk);
        int batch_isa = (int)prng_below(&run->prng, ENG_ISA_COUNT);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (kernels == NULL) {
                continue;
            }
            const char *what;
            ask(kernels, &chunk, &said[isa]);
            uint32_t wrong = judge(&chunk, &said[isa], &what);
            if (wrong < chunk.count) {
                fail(run, &chunk, wrong, kernels, what);
            } else if (!said_the_same(&said[ENG_ISA_SCALAR], &said[isa])) {
                fail(run, &chunk, 0, kernels, "not what the set `scalar` says");
            } else if (isa == batch_isa &&
                       (what = judge_batch(run, &chunk, kernels)) != NULL) {
                fail(run, &chunk, 0, kernels, what);
            }
        }
        count(run, &chunk, &said[ENG_ISA_SCALAR]);
    }
}
