/* fuzz_run.c - many elementary tests at every instruction set, each answer judged.
 *
 * Room:     tests/fuzz.
 * Does:     see fuzz_run.h.
 * Threads:  one.
 */
#include "fuzz_run.h"

#include <math.h>
#include <string.h>

#include "batch.h"

#define FAILURES_MAX      20u
#define TOLERANCE_DEFAULT 1e-6

/* A chunk of one kind, with what belongs to each query. */
struct chunk {
    uint32_t count;
    enum eng_kind kind;
    double tolerance;
    double t_end;
    enum fuzz_family family[ENG_CHUNK_MAX];
    struct eng_query queries[ENG_CHUNK_MAX];
    bool found[ENG_CHUNK_MAX]; /* by the scalar call, over the whole step */
    struct eng_hit hits[ENG_CHUNK_MAX];
    struct eng_point points[4 * ENG_CHUNK_MAX];
    uint32_t quads[ENG_CHUNK_MAX][4];
    struct eng_batch batch;
};

static void fail(struct fuzz_run *run, const struct chunk *chunk,
                 const struct eng_query *query, const char *what)
{
    if (run->failures > 0 && query->kind == run->failed.kind &&
        memcmp(query->x, run->failed.x, sizeof query->x) == 0) {
        return; /* the same query in another lane */
    }
    run->failed = *query;
    if (run->failures++ < FAILURES_MAX) {
        fprintf(run->log, "%s:\n", what);
        fuzz_query_write(run->log, query, chunk->tolerance, chunk->t_end);
    }
}

static bool same_hit(const struct eng_hit *a, const struct eng_hit *b)
{
    return a->flags == b->flags && memcmp(&a->toi, &b->toi, sizeof a->toi) == 0 &&
           memcmp(&a->toi_hi, &b->toi_hi, sizeof a->toi_hi) == 0 &&
           memcmp(a->param, b->param, sizeof a->param) == 0 &&
           memcmp(a->normal, b->normal, sizeof a->normal) == 0;
}

static void count_early(struct fuzz_run *run, double early)
{
    double bin = 20 * (log10(fmax(early, 1e-20)) + 20);
    uint32_t i = bin < 0 ? 0 : bin >= FUZZ_BINS ? FUZZ_BINS - 1 : (uint32_t)bin;
    run->early_bins[i]++;
    run->early_count++;
    run->early_max = fmax(run->early_max, early);
}

/* The scalar call's answers over the whole step, against the truth. */
static void judge_scalar(struct fuzz_run *run, struct chunk *chunk)
{
    for (uint32_t i = 0; i < chunk->count; i++) {
        const struct eng_query *query = &chunk->queries[i];
        double early;
        uint64_t exact_queries = run->exact.queries;
        chunk->found[i] =
            eng_solve(query, chunk->tolerance, 1, &run->exact, &chunk->hits[i]);
        run->exact_queries += run->exact.queries - exact_queries;
        enum fuzz_judgement judgement =
            fuzz_judge(query, chunk->found[i] ? &chunk->hits[i] : NULL, chunk->tolerance,
                       &run->tally, &early);
        if (judgement != FUZZ_RIGHT) {
            fail(run, chunk, query, fuzz_judgement_text(judgement));
        }
        run->queries++;
        run->hits += chunk->found[i];
        run->family_queries[chunk->family[i]]++;
        run->family_hits[chunk->family[i]] += chunk->found[i];
        if (chunk->found[i] && chunk->tolerance == TOLERANCE_DEFAULT) {
            count_early(run, early);
        }
    }
}

/* Points of all queries in one array, shuffled as those of a scene are. */
static void lay_out(struct fuzz_run *run, struct chunk *chunk)
{
    uint32_t count = 4 * chunk->count;
    uint32_t order[4 * ENG_CHUNK_MAX];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t j = (uint32_t)prng_below(&run->prng, i + 1);
        order[i] = order[j];
        order[j] = i;
    }
    for (uint32_t i = 0; i < count; i++) {
        struct eng_point *point = &chunk->points[order[i]];
        const struct eng_query *query = &chunk->queries[i / 4];
        memcpy(point->x0, query->x[0][i % 4], sizeof point->x0);
        memcpy(point->x1, query->x[1][i % 4], sizeof point->x1);
        point->word0 = prng_next(&run->prng); /* nobody's business */
        point->word1 = prng_next(&run->prng);
        chunk->quads[i / 4][i % 4] = order[i];
    }
}

static void compare_set(struct fuzz_run *run, struct chunk *chunk,
                        const struct eng_kernels *kernels)
{
    char what[100];
    const struct eng_hit *answers[ENG_CHUNK_MAX] = {NULL};
    uint32_t count = eng_batch_test(
        kernels, chunk->kind, chunk->points, (const uint32_t(*)[4])chunk->quads,
        chunk->count, chunk->tolerance, chunk->t_end, &run->exact, &chunk->batch);
    run->survivors += kernels->isa == ENG_ISA_SCALAR ? chunk->batch.survivors : 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t pair = chunk->batch.index[i];
        if (pair >= chunk->count || answers[pair]) {
            fail(run, chunk, &chunk->queries[0], "a batch names a pair twice, or none");
            return;
        }
        answers[pair] = &chunk->batch.hits[i];
    }
    for (uint32_t i = 0; i < chunk->count; i++) {
        bool due = chunk->found[i] && chunk->hits[i].toi <= chunk->t_end;
        const char *how = due && !answers[i]   ? "misses what the scalar call finds"
                          : !due && answers[i] ? "finds what the scalar call does not"
                          : due && !same_hit(answers[i], &chunk->hits[i])
                              ? "has other bytes than the scalar call"
                              : NULL;
        if (how) {
            snprintf(what, sizeof what, "the batch of %s %s (pair %u of %u)",
                     kernels->name, how, i, chunk->count);
            fail(run, chunk, &chunk->queries[i], what);
        }
    }
}

static void compare_sets(struct fuzz_run *run, struct chunk *chunk)
{
    run->sets = 0;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels) {
            compare_set(run, chunk, kernels);
            run->sets++;
        }
    }
}

/* What is known of the answer to a changed query. */
static void compare_changed(struct fuzz_run *run, const struct chunk *chunk, uint32_t i)
{
    static const char *const changes[] = {"scaled by a power of two", "in another order",
                                          "backwards"};
    struct eng_query query = chunk->queries[i];
    struct eng_hit hit;
    char what[100];
    uint64_t change = prng_below(&run->prng, 3);
    if (change == 0) {
        fuzz_query_scale(&run->prng, &query);
    } else if (change == 1) {
        fuzz_query_reorder(&run->prng, &query);
    } else {
        fuzz_query_reverse(&query);
    }
    bool found = eng_solve(&query, chunk->tolerance, 1, &run->exact, &hit);
    const char *how = NULL;
    if (found != chunk->found[i]) {
        how = "is decided otherwise";
    } else if (found && change < 2 &&
               (hit.toi > chunk->hits[i].toi_hi || chunk->hits[i].toi > hit.toi_hi)) {
        how = "is at another time";
    }
    if (how) {
        snprintf(what, sizeof what, "the query %s %s; it, then the original",
                 changes[change], how);
        fail(run, chunk, &query, what);
        fail(run, chunk, &chunk->queries[i], "the original");
    }
}

static void run_chunk(struct fuzz_run *run, struct chunk *chunk)
{
    lay_out(run, chunk);
    judge_scalar(run, chunk);
    compare_sets(run, chunk);
    for (uint32_t i = 0; i < chunk->count; i++) {
        if (prng_below(&run->prng, 4) == 0) {
            compare_changed(run, chunk, i);
        }
    }
}

void fuzz_run_init(struct fuzz_run *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    eng_exact_init(&run->exact);
}

void fuzz_run_deinit(struct fuzz_run *run)
{
    eng_exact_deinit(&run->exact);
}

void fuzz_run_more(struct fuzz_run *run, uint64_t count)
{
    static struct chunk chunk; /* half a megabyte */
    static const double tolerances[] = {1e-12, 1e-9, 1e-3, 1};
    uint64_t end = run->queries + count;
    while (run->queries < end && run->failures < FAILURES_MAX) {
        struct prng *prng = &run->prng;
        chunk.kind = prng_below(prng, 2) ? ENG_VF : ENG_EE;
        chunk.count = prng_below(prng, 4) ? ENG_CHUNK_MAX
                                          : 1 + (uint32_t)prng_below(prng, ENG_CHUNK_MAX);
        chunk.tolerance =
            prng_below(prng, 4) ? TOLERANCE_DEFAULT : tolerances[prng_below(prng, 4)];
        chunk.t_end = prng_below(prng, 4)   ? 1
                      : prng_below(prng, 4) ? prng_between(prng, 0, 1)
                                            : 0.125 * (double)prng_below(prng, 9);
        for (uint32_t i = 0; i < chunk.count; i++) {
            chunk.family[i] = fuzz_family_some(prng);
            fuzz_query_make(prng, chunk.family[i], chunk.kind, &chunk.queries[i]);
        }
        run_chunk(run, &chunk);
    }
}

void fuzz_run_query(struct fuzz_run *run, const struct eng_query *query, double tolerance,
                    double t_end)
{
    static struct chunk chunk;
    chunk.kind = query->kind;
    chunk.tolerance = tolerance;
    chunk.t_end = t_end;
    chunk.count = 33; /* in every lane, beside others and alone */
    for (uint32_t i = 0; i < chunk.count; i++) {
        chunk.queries[i] = *query;
        chunk.family[i] = FUZZ_RANDOM;
    }
    run_chunk(run, &chunk);
}

double fuzz_run_early(const struct fuzz_run *run, double share)
{
    uint64_t wanted = (uint64_t)(share * (double)run->early_count);
    uint64_t seen = 0;
    for (uint32_t i = 0; i < FUZZ_BINS; i++) {
        seen += run->early_bins[i];
        if (seen > wanted) {
            return pow(10, (i + 1) / 20.0 - 20);
        }
    }
    return run->early_max;
}
