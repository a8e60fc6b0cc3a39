/* fuzz_thick_lanes.c - thick features in chunks against one at a time. */
#include "fuzz_thick_lanes.h"

#include <stdlib.h>
#include <string.h>

#define FAILURES_MAX 10

/* A chunk of one kind, and what thick.h says of it. */
struct chunk {
    struct eng_question question;
    uint32_t kind;
    double t_end;
    uint32_t count;
    struct fuzz_thick_case cases[FUZZ_THICK_CHUNK];
    struct eng_point points[4 * FUZZ_THICK_CHUNK];
    uint32_t quads[FUZZ_THICK_CHUNK][4];
    double radius[FUZZ_THICK_CHUNK][3];
    bool is_found[FUZZ_THICK_CHUNK];
    struct eng_hit hits[FUZZ_THICK_CHUNK];
};

void fuzz_thick_lanes_init(struct fuzz_thick_lanes *run, uint64_t seed, FILE *log)
{
    memset(run, 0, sizeof *run);
    run->prng.state = seed;
    run->log = log;
    if (eng_thick_init(&run->thick) != PCCD_OK ||
        eng_exact_init(&run->contacts) != PCCD_OK) {
        abort();
    }
}

void fuzz_thick_lanes_deinit(struct fuzz_thick_lanes *run)
{
    eng_thick_deinit(&run->thick);
    eng_exact_deinit(&run->contacts);
}

/* Make a chunk of one kind, with one approach for all. */
static void make_chunk(struct fuzz_thick_lanes *run, struct chunk *chunk)
{
    memset(chunk, 0, sizeof *chunk);
    chunk->question = (struct eng_question)ENG_QUESTION_DEFAULT;
    chunk->kind = prng_u32(&run->prng, 4);
    chunk->question.tolerance = 1e-6;
    chunk->t_end = prng_below(&run->prng, 3) ? 1 : 0.4;
    chunk->question.approach = prng_below(&run->prng, 3) ? 0 : 0.6;
    uint32_t wanted = 1 + prng_u32(&run->prng, FUZZ_THICK_CHUNK);
    while (chunk->count < wanted) {
        struct fuzz_thick_case *made = &chunk->cases[chunk->count];
        fuzz_thick_make(&run->prng, 0, made);
        if ((uint32_t)made->query.query.kind != chunk->kind ||
            eng_thick_is_thin(chunk->kind, made->query.radius)) {
            continue;
        }
        made->query.approach = chunk->question.approach;
        uint32_t pair = chunk->count++;
        memcpy(chunk->radius[pair], made->query.radius, sizeof chunk->radius[pair]);
        for (uint32_t k = 0; k < 4; k++) {
            struct eng_point *point = &chunk->points[4 * pair + k];
            memcpy(point->x0, made->query.query.x[0][k], sizeof point->x0);
            memcpy(point->x1, made->query.query.x[1][k], sizeof point->x1);
            point->word0 = prng_next(&run->prng); /* nobody looks at these */
            point->word1 = prng_next(&run->prng);
            chunk->quads[pair][k] = 4 * pair + k;
        }
        chunk->is_found[pair] =
            eng_thick_solve(&run->thick, &run->contacts, &made->query,
                            chunk->question.tolerance, chunk->t_end, &chunk->hits[pair]);
    }
}

static void fail(struct fuzz_thick_lanes *run, const struct eng_kernels *kernels,
                 const struct fuzz_thick_case *made, const char *what)
{
    run->failures++;
    fprintf(run->log, "%s: ", kernels->name);
    fuzz_thick_print(run->log, made, &(struct eng_hit){0}, what);
}

/* Compare what the kernels of a set, and what follows, say of the chunk. */
static void compare(struct fuzz_thick_lanes *run, const struct chunk *chunk,
                    const struct eng_kernels *kernels, struct eng_batch *batch)
{
    static struct eng_thick_lanes lanes;
    const struct eng_hit *found[FUZZ_THICK_CHUNK] = {NULL};
    const struct eng_pairs pairs = {.question = &chunk->question,
                                    .kind = chunk->kind,
                                    .count = chunk->count,
                                    .points = chunk->points,
                                    .quads = (const uint32_t(*)[4])chunk->quads,
                                    .radius = (const double(*)[3])chunk->radius,
                                    .t_end = chunk->t_end};
    batch->kernels = kernels;
    batch->thick = &run->thick;
    batch->lanes = &lanes;
    uint32_t count = eng_batch_test(batch, &pairs);
    for (uint32_t i = 0; i < count; i++) {
        if (batch->index[i] >= chunk->count || found[batch->index[i]]) {
            fail(run, kernels, &chunk->cases[0], "a pair twice, or none");
            return;
        }
        found[batch->index[i]] = &batch->hits[i];
    }
    for (uint32_t i = 0; i < chunk->count; i++) {
        if ((found[i] != NULL) != chunk->is_found[i]) {
            fail(run, kernels, &chunk->cases[i], "found, or not, in lanes alone");
            return;
        }
        if (found[i] && !fuzz_thick_same_hit(found[i], &chunk->hits[i])) {
            fail(run, kernels, &chunk->cases[i], "other bytes in lanes");
        }
    }
    run->hits += count;
}

static void run_chunk(struct fuzz_thick_lanes *run, struct chunk *chunk)
{
    static struct eng_batch batches[2];
    uint32_t sets = 0;
    make_chunk(run, chunk);
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (!kernels) {
            continue;
        }
        struct eng_batch *batch = &batches[sets > 0];
        batch->integers = 0;
        compare(run, chunk, kernels, batch);
        run->survivors += batch->survivors;
        run->cases += chunk->count;
        if (batch->survivors != batches[0].survivors ||
            batch->integers != batches[0].integers) {
            fail(run, kernels, &chunk->cases[0], "other survivors than the first set");
        }
        sets++;
    }
    run->sets = sets;
}

void fuzz_thick_lanes_more(struct fuzz_thick_lanes *run, uint64_t chunks)
{
    static struct chunk chunk;
    for (uint64_t i = 0; i < chunks && run->failures < FAILURES_MAX; i++) {
        run_chunk(run, &chunk);
    }
}
