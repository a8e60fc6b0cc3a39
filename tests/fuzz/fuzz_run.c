/* fuzz_run.c - many elementary tests at every instruction set, each answer judged. */
#include "fuzz_run.h"

#include <math.h>
#include <string.h>

#include "batch.h"
#include "fuzz_sieve.h"

#define FAILURES_MAX      20u
#define TOLERANCE_DEFAULT 1e-6

/* A chunk of one kind, with what belongs to each query. */
struct chunk {
    uint32_t count;
    enum pccd_kind kind;
    double tolerance;
    double t_end;
    enum fuzz_family family[ENG_CHUNK_MAX];
    struct eng_query queries[ENG_CHUNK_MAX];
    bool found[ENG_CHUNK_MAX]; /* by the scalar call, over the whole step */
    struct eng_hit hits[ENG_CHUNK_MAX];
    struct eng_point points[4 * ENG_CHUNK_MAX];
    uint32_t quads[ENG_CHUNK_MAX][4];
    enum eng_known known;
    uint32_t answers; /* of the batch */
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

static void count_early(struct fuzz_run *run, const struct eng_hit *hit, double early)
{
    run->bracket_max = fmax(run->bracket_max, hit->toi_hi - hit->toi);
    if (early < 0) {
        return;
    }
    double bin = 20 * (log10(fmax(early, 1e-20)) + 20);
    uint32_t i = bin < 0 ? 0 : bin >= FUZZ_BINS ? FUZZ_BINS - 1 : (uint32_t)bin;
    run->early_bins[i]++;
    run->early_count++;
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
            count_early(run, &chunk->hits[i], early);
        }
    }
}

/* Points of all queries in one array, shuffled as those of a scene are. */
static void lay_out(struct fuzz_run *run, struct chunk *chunk)
{
    uint32_t count = 4 * chunk->count;
    uint32_t order[4 * ENG_CHUNK_MAX];
    for (uint32_t i = 0; i < count; i++) {
        uint32_t j = prng_u32(&run->prng, i + 1);
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

/* Pairs that the first set that tests a chunk leaves unsure. eng_search takes them over,
 * the same code for every set and for the scalar call: so all sets must leave the same
 * pairs to it, and one of them, at some chunks, goes on to the end. The others stop at
 * the first query that needs exact arithmetic, most of the time of a batch. */
struct unsure {
    bool pair[ENG_CHUNK_MAX];
};

/* Turns of all sets of which one goes on to the end; of chunks with t_end < 1 every other
 * one does, because eng_search may stop early there. */
#define WHOLE_EACH 12u
#define PART_EACH  2u

static bool stop_at_once(void *owner)
{
    (void)owner;
    return true;
}

static void note_unsure(const struct chunk *chunk, struct unsure *unsure)
{
    memset(unsure, 0, sizeof *unsure);
    for (uint32_t i = 0; i < chunk->batch.unsure_count; i++) {
        unsure->pair[chunk->batch.unsure[i]] = true;
    }
}

/* The first pair that is unsure in one of the two alone; chunk->count: there is none. */
static uint32_t odd_one(const struct chunk *chunk, const struct unsure *unsure)
{
    bool left[ENG_CHUNK_MAX];
    uint32_t i = 0;
    memcpy(left, unsure->pair, sizeof left);
    for (uint32_t k = 0; k < chunk->batch.unsure_count; k++) {
        left[chunk->batch.unsure[k]] ^= true; /* a pair twice comes back */
    }
    while (i < chunk->count && !left[i]) {
        i++;
    }
    return i;
}

/* NULL, or what is wrong with the answer to a pair. */
static const char *wrong(const struct chunk *chunk, uint32_t pair, bool may_lack,
                         const struct eng_hit *answer)
{
    bool due = chunk->found[pair] && chunk->hits[pair].toi <= chunk->t_end;
    if (!answer) {
        return due && !may_lack ? "misses what the scalar call finds" : NULL;
    }
    return !due ? "finds what the scalar call does not"
           : !same_hit(answer, &chunk->hits[pair])
               ? "has other bytes than the scalar call"
               : NULL;
}

/* To the end, or to the first query that needs exact arithmetic. False: failed. */
static bool compare_set(struct fuzz_run *run, struct chunk *chunk,
                        const struct eng_kernels *kernels, bool to_the_end,
                        const struct unsure *unsure)
{
    char what[100];
    const struct eng_hit *answers[ENG_CHUNK_MAX] = {NULL};
    for (uint32_t i = 0; i < chunk->answers; i++) {
        uint32_t pair = chunk->batch.index[i];
        if (pair >= chunk->count || answers[pair]) {
            fail(run, chunk, &chunk->queries[0], "a batch names a pair twice, or none");
            return false;
        }
        answers[pair] = &chunk->batch.hits[i];
    }
    bool good = true;
    for (uint32_t i = 0; i < chunk->count; i++) {
        const char *how = wrong(chunk, i, !to_the_end && unsure->pair[i], answers[i]);
        if (how) {
            snprintf(what, sizeof what, "the batch of %s %s (pair %u of %u)",
                     kernels->name, how, i, chunk->count);
            fail(run, chunk, &chunk->queries[i], what);
            good = false;
        }
    }
    return good;
}

static void test_batch(struct fuzz_run *run, struct chunk *chunk,
                       const struct eng_kernels *kernels, bool to_the_end)
{
    chunk->batch.should_stop = to_the_end ? NULL : stop_at_once;
    struct eng_question question = ENG_QUESTION_DEFAULT;
    question.tolerance = chunk->tolerance;
    const struct eng_pairs pairs = {.question = &question,
                                    .kind = chunk->kind,
                                    .known = chunk->known,
                                    .count = chunk->count,
                                    .points = chunk->points,
                                    .quads = (const uint32_t(*)[4])chunk->quads,
                                    .t_end = chunk->t_end};
    chunk->batch.kernels = kernels;
    chunk->batch.contacts = &run->exact;
    chunk->answers = eng_batch_test(&chunk->batch, &pairs);
    if (kernels->isa == ENG_ISA_SCALAR && chunk->known == ENG_KNOWN_NOTHING) {
        run->filtered += chunk->count;
        run->survivors += chunk->batch.survivors;
    }
}

/* Each set in turn is the first. */
static void compare_sets(struct fuzz_run *run, struct chunk *chunk)
{
    static struct unsure unsure;
    const struct eng_kernels *sets[ENG_ISA_COUNT];
    uint32_t count = 0;
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels) {
            sets[count++] = kernels;
        }
    }
    static const enum eng_known known[] = {ENG_KNOWN_NOTHING, ENG_KNOWN_NOTHING,
                                           ENG_KNOWN_BOXES, ENG_KNOWN_SIEVED};
    chunk->known = known[prng_below(&run->prng, 4)];
    uint64_t turn = run->chunks++;
    bool to_the_end = turn / count % (chunk->t_end < 1 ? PART_EACH : WHOLE_EACH) == 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_kernels *kernels = sets[(turn + i) % count];
        test_batch(run, chunk, kernels, to_the_end && i == 0);
        if (i == 0) {
            note_unsure(chunk, &unsure);
        }
        uint32_t odd = odd_one(chunk, &unsure);
        if (odd < chunk->count) {
            fail(run, chunk, &chunk->queries[odd], "a pair is unsure to some sets alone");
            return;
        }
        if (!compare_set(run, chunk, kernels, to_the_end && i == 0, &unsure)) {
            return;
        }
    }
    run->sets = count;
}

/* Compare with what is known of the answer to a changed query. */
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

static void check_sieve(struct fuzz_run *run, struct chunk *chunk)
{
    static struct fuzz_sieve sieve;
    const struct fuzz_answered answered = {.kind = chunk->kind,
                                           .count = chunk->count,
                                           .queries = chunk->queries,
                                           .found = chunk->found,
                                           .hits = chunk->hits,
                                           .t_end = chunk->t_end};
    uint32_t wrong = 0;
    sieve.looked_at = sieve.kept = 0;
    const char *what = fuzz_sieve_check(&sieve, &run->prng, &answered, &wrong);
    if (what) {
        fail(run, chunk, &chunk->queries[wrong], what);
    }
    run->sieved += sieve.looked_at;
    run->sieve_kept += sieve.kept;
}

static void run_chunk(struct fuzz_run *run, struct chunk *chunk)
{
    lay_out(run, chunk);
    judge_scalar(run, chunk);
    compare_sets(run, chunk);
    check_sieve(run, chunk);
    for (uint32_t i = 0; i < chunk->count; i++) {
        if (prng_below(&run->prng, 8) == 0) {
            compare_changed(run, chunk, i);
        }
    }
}

void fuzz_run_init(struct fuzz_run *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    if (eng_exact_init(&run->exact) != PCCD_OK) {
        abort();
    }
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
        chunk.kind = prng_below(prng, 2) ? PCCD_VF : PCCD_EE;
        chunk.count =
            prng_below(prng, 4) ? ENG_CHUNK_MAX : 1 + prng_u32(prng, ENG_CHUNK_MAX);
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
    for (run->chunks = 0; run->chunks < ENG_ISA_COUNT;) { /* each set to the end */
        run_chunk(run, &chunk);
    }
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
    return 0;
}
