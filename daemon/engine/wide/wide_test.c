/* daemon/engine/wide/wide_test.c - what a worker needs to find contacts in wide trees.
 *
 * Room:     engine.
 * Does:     name pairs, gather the vertices of their features, test them.
 * Threads:  [team].
 */
#include "wide_test.h"

#include "brief.h"
#include "memory.h"
#include "test.h"
#include "wide_grid.h"

/* Left out for each that was kept, from which on looking at times pays: it costs some 40
 * cycles for a box against a block, and a pair in the filter some 25. */
#define TIMES_PAY_FROM       1u
#define CHUNKS_WITHOUT_TIMES 31u

/* The sieve takes some 20 cycles a pair, the filter 40, the solver 150. So the sieve pays
 * before the filter, and the filter behind it, where it rejects a fourth. */
#define FILTER_PAYS_FROM      4u
#define CHUNKS_WITHOUT_FILTER 15u

int eng_wide_work_reserve(struct eng_worker *worker)
{
    if (!worker->wide) {
        worker->wide = eng_alloc(1, sizeof *worker->wide);
    }
    return worker->wide ? ENG_OK : ENG_E_NOMEM;
}

/* Put two edges into the order in which records name them, that of their keys. Without a
 * branch: which way it would go cannot be foreseen. */
static void put_in_order(const eng_wide_key *keys, uint32_t *a, uint32_t *b)
{
    uint32_t change = (*a ^ *b) & (0u - (uint32_t)(keys[*a] > keys[*b]));
    *a ^= change;
    *b ^= change;
}

static struct eng_pair name_of(const struct eng_wide *wide, enum eng_kind kind,
                               uint32_t a, uint32_t b)
{
    eng_wide_key key_a;
    eng_wide_key key_b;
    if (kind == ENG_VF) {
        key_a = wide->points[a].word1;
        key_b = wide->trees[ENG_WIDE_FACES].keys[b];
    } else {
        const eng_wide_key *keys = wide->trees[ENG_WIDE_EDGES].keys;
        put_in_order(keys, &a, &b);
        key_a = keys[a];
        key_b = keys[b];
    }
    return (struct eng_pair){kind, (uint32_t)(key_a >> 32), (uint32_t)key_a,
                             (uint32_t)(key_b >> 32), (uint32_t)key_b};
}

static void make_quads(const struct eng_wide *wide, enum eng_kind kind,
                       const struct eng_wide_chunk *chunk, uint32_t (*quads)[4])
{
    if (kind == ENG_VF) {
        uint32_t *const *corner = wide->trees[ENG_WIDE_FACES].corner;
        for (uint32_t i = 0; i < chunk->count; i++) {
            uint32_t b = chunk->b[i];
            quads[i][0] = chunk->a[i];
            quads[i][1] = corner[0][b];
            quads[i][2] = corner[1][b];
            quads[i][3] = corner[2][b];
        }
        return;
    }
    uint32_t *const *corner = wide->trees[ENG_WIDE_EDGES].corner;
    const eng_wide_key *keys = wide->trees[ENG_WIDE_EDGES].keys;
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t a = chunk->a[i];
        uint32_t b = chunk->b[i];
        put_in_order(keys, &a, &b);
        quads[i][0] = corner[0][a];
        quads[i][1] = corner[1][a];
        quads[i][2] = corner[0][b];
        quads[i][3] = corner[1][b];
    }
}

/* Those pairs of a chunk that no axis separates: by the coordinates themselves, so that
 * it does not matter how boxes were rounded. */
static void keep_candidates(struct eng_worker *worker, enum eng_kind kind,
                            const struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = &worker->scene->wide;
    struct eng_wide_work *work = worker->wide;
    uint32_t *left = work->batch.left;
    make_quads(wide, kind, chunk, work->quads);
    uint32_t count = work->join.kernels->apart(
        kind, wide->points, (const uint32_t(*)[4])work->quads, chunk->count, left);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t pair = left[i];
        struct eng_pair name = name_of(wide, kind, chunk->a[pair], chunk->b[pair]);
        eng_found_add(&worker->found, &name); /* a full list says so itself */
    }
}

/* How many chunks go without what has kept so many of `count`. */
static uint32_t chunks_without(uint32_t count, uint32_t kept)
{
    return (count - kept) >= (count + FILTER_PAYS_FROM - 1) / FILTER_PAYS_FROM
               ? 0
               : CHUNKS_WITHOUT_FILTER;
}

/* The sieve on the pairs of a chunk, if it is worth it here: those that it leaves are the
 * chunk's from then on. Says where the tests begin. */
static enum eng_batch_from sift(struct eng_worker *worker, enum eng_kind kind,
                                struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = &worker->scene->wide;
    struct eng_wide_work *work = worker->wide;
    struct eng_wide_filters *filters = &work->filters[kind];
    if (!eng_wide_has_marks(wide)) {
        return ENG_FROM_FILTER;
    }
    if (filters->chunks_without_sieve > 0) {
        filters->chunks_without_sieve--;
        return ENG_FROM_FILTER;
    }
    struct eng_sieve *sieve = &work->sieves[kind];
    uint32_t count = chunk->count;
    sieve->t_end = worker->box_bound;
    chunk->count =
        work->join.kernels->sift(kind, sieve, chunk->a, chunk->b, chunk->count);
    filters->chunks_without_sieve = chunks_without(count, chunk->count);
    if (filters->chunks_without_filter > 0) {
        filters->chunks_without_filter--;
        return ENG_FROM_BRACKET;
    }
    return ENG_FROM_FILTER;
}

static void test(struct eng_worker *worker, enum eng_kind kind,
                 struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = &worker->scene->wide;
    struct eng_wide_work *work = worker->wide;
    struct eng_batch *batch = &work->batch;
    worker->record.tests += chunk->count;
    batch->from = sift(worker, kind, chunk);
    make_quads(wide, kind, chunk, work->quads);
    uint32_t hits = eng_batch_test(
        work->join.kernels, kind, wide->points, (const uint32_t(*)[4])work->quads,
        chunk->count, worker->settings->tolerance, worker->time_bound,
        worker->settings->brief ? NULL : &worker->exact, batch);
    if (worker->settings->brief && batch->unsure_count > 0) {
        eng_worker_give_up(worker);
    }
    if (batch->from == ENG_FROM_FILTER) {
        work->filters[kind].chunks_without_filter =
            chunks_without(chunk->count, batch->survivors);
    }
    worker->tally.survivors += batch->survivors;
    for (uint32_t i = 0; i < hits && !eng_stop_is_set(worker->stop); i++) {
        uint32_t pair = batch->index[i];
        struct eng_pair name = name_of(wide, kind, chunk->a[pair], chunk->b[pair]);
        eng_test_keep(worker, &name, &batch->hits[i]);
    }
}

/* Stop? Else go on with the bound on time as it is by now. */
static void look(void *owner)
{
    struct eng_worker *worker = owner;
    struct eng_wide_join *join = &worker->wide->join;
    join->stopped = eng_worker_should_stop(worker);
    if (worker->box_bound < 1) {
        eng_wide_join_until(join, worker->box_bound);
    }
}

static bool should_stop(void *owner)
{
    return eng_worker_should_stop(owner);
}

/* Pairs that the join has left out in time since the last chunk. To look at a block's
 * times pays when it saves the filter enough pairs: when a chunk's share of them was
 * small, the next ones go without. */
static uint32_t left_out_in_time(struct eng_wide_work *work, enum eng_kind kind,
                                 uint32_t kept)
{
    struct eng_join *job = &work->join.jobs[kind][0];
    struct eng_wide_times *times = &work->times[kind];
    uint32_t apart = (uint32_t)(job->apart_in_time - times->apart);
    times->apart = job->apart_in_time;
    if (job->in_time && kept > 0 && apart < kept * TIMES_PAY_FROM) {
        job->in_time = false;
        times->chunks_without = CHUNKS_WITHOUT_TIMES;
    } else if (times->chunks_without > 0 && --times->chunks_without == 0) {
        job->in_time = true;
    }
    return apart;
}

static void flush(void *owner, enum eng_kind kind, struct eng_wide_chunk *chunk)
{
    struct eng_worker *worker = owner;
    uint64_t begin_ns = eng_now_ns();
    uint32_t count = chunk->count;
    worker->wide->sieves[kind].in_time = worker->wide->join.jobs[kind][0].in_time;
    eng_test_count(worker, kind, count + left_out_in_time(worker->wide, kind, count));
    if (worker->settings->brief && worker->record.tests + count > ENG_BRIEF_TESTS) {
        eng_worker_give_up(worker);
    }
    if (worker->settings->mode == ENG_MODE_PAIRS) {
        keep_candidates(worker, kind, chunk);
    } else if (!eng_stop_is_set(worker->stop)) {
        test(worker, kind, chunk);
    }
    chunk->count = 0;
    look(worker);
    eng_test_end(worker, kind, count, begin_ns);
}

void eng_wide_work_begin(struct eng_worker *worker)
{
    struct eng_wide_work *work = worker->wide;
    work->join.owner = worker;
    work->join.flush = flush;
    work->join.look = look;
    work->batch.should_stop = should_stop;
    work->batch.owner = worker;
    eng_wide_join_begin(&work->join, &worker->scene->wide, ENG_JOIN_MOVING);
    work->join.filtered = worker->scene->wide.owners.masks ? &worker->scene->wide : NULL;
    for (enum eng_kind kind = 0; kind < ENG_KINDS; kind++) {
        bool in_time = worker->settings->mode != ENG_MODE_PAIRS;
        work->join.jobs[kind][0].in_time = in_time;
        for (uint32_t level = 1; level < ENG_WIDE_LEVELS_MAX; level++) {
            work->join.jobs[kind][level].in_time =
                in_time && worker->scene->wide.steps_without_times[kind] == 0;
        }
        work->times[kind] = (struct eng_wide_times){0, 0};
        work->filters[kind] = (struct eng_wide_filters){0, 0};
        work->sieves[kind] = eng_wide_sieve(&worker->scene->wide, kind);
    }
    look(worker);
}

void eng_wide_work_end(struct eng_worker *worker)
{
    const struct eng_wide_join *join = &worker->wide->join;
    worker->record.box_tests = eng_wide_join_tests(join);
    worker->record.pairs = join->pairs;
}
