/* wide_test.c - what a worker needs to find contacts in wide trees. */
#include "wide_test.h"

#include <assert.h>
#include <math.h>

#include "memory.h"
#include "narrow.h"
#include "solve.h"
#include "wide.h"
#include "wide_cells.h"
#include "wide_state.h"
#include "worker.h"

#define INLINE static inline __attribute__((always_inline))

/* Left out for each that was kept, from which on looking at times pays: it costs some 40
 * cycles for a box against a block, and a pair in the filter some 25. */
#define TIMES_PAY_FROM       1u
#define CHUNKS_WITHOUT_TIMES 31u

/* A sieve that leaves out less than one of so many pairs is followed by the test in
 * doubles that comes next. Of contacts: what the filter rejects the sieve rejects, too,
 * but where features are small beside the grid. */
#define NEXT_PAYS_BELOW   4u
#define FILTER_PAYS_BELOW 16u

/* Part of the reach within which a pair that bounds a vertex is asked first in the next
 * answer: one that is farther leaves out few others. */
#define LEADS_WITHIN 0.5

int eng_wide_work_reserve(struct eng_worker *worker)
{
    if (!worker->work[PCCD_METHOD_WIDE]) {
        worker->work[PCCD_METHOD_WIDE] = eng_alloc(1, sizeof(struct eng_wide_work));
    }
    return worker->work[PCCD_METHOD_WIDE] ? PCCD_OK : PCCD_E_NOMEM;
}

void eng_wide_work_free(struct eng_worker *worker)
{
    eng_free(worker->work[PCCD_METHOD_WIDE]);
    worker->work[PCCD_METHOD_WIDE] = NULL;
}

uint64_t eng_wide_work_bytes(const struct eng_worker *worker)
{
    return worker->work[PCCD_METHOD_WIDE] ? sizeof(struct eng_wide_work) : 0;
}

INLINE bool has_one_tree(enum pccd_kind kind)
{
    return eng_wide_tree_of(kind, 0) == eng_wide_tree_of(kind, 1);
}

/* Put two features of a tree into the order in which records name them, that of their
 * keys. Without a branch: which way it would go cannot be foreseen. */
INLINE void put_in_order(const struct eng_wide *wide, enum pccd_tree tree, uint32_t *a,
                         uint32_t *b)
{
    uint32_t is_turned =
        eng_wide_key_of(wide, tree, *a) > eng_wide_key_of(wide, tree, *b);
    uint32_t change = (*a ^ *b) & (0u - is_turned);
    *a ^= change;
    *b ^= change;
}

INLINE struct pccd_pair name_of(const struct eng_wide *wide, enum pccd_kind kind,
                                uint32_t a, uint32_t b)
{
    if (has_one_tree(kind)) {
        put_in_order(wide, eng_wide_tree_of(kind, 0), &a, &b);
    }
    eng_wide_key key_a = eng_wide_key_of(wide, eng_wide_tree_of(kind, 0), a);
    eng_wide_key key_b = eng_wide_key_of(wide, eng_wide_tree_of(kind, 1), b);
    return (struct pccd_pair){kind, (uint32_t)(key_a >> 32), (uint32_t)key_a,
                              (uint32_t)(key_b >> 32), (uint32_t)key_b};
}

/* The vertices of a feature to quad[..]; returns how many. */
INLINE uint32_t put_points(const struct eng_wide *wide, enum pccd_tree tree,
                           uint32_t slot, uint32_t *quad)
{
    uint32_t count = (uint32_t)tree + 1;
    for (uint32_t k = 0; k < count; k++) {
        quad[k] = tree == PCCD_TREE_VERTICES ? slot : wide->trees[tree].corner[k][slot];
    }
    return count;
}

/* Fetch their points, too, which are read in another order and lie in no near cache. */
INLINE void make_quads_of(const struct eng_wide *wide, enum pccd_kind kind,
                          const struct eng_wide_chunk *chunk, uint32_t (*quads)[4])
{
    const enum pccd_tree tree_a = eng_wide_tree_of(kind, 0);
    const enum pccd_tree tree_b = eng_wide_tree_of(kind, 1);
    const struct eng_point *points = wide->points;
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t a = chunk->a[i];
        uint32_t b = chunk->b[i];
        if (has_one_tree(kind)) {
            put_in_order(wide, tree_a, &a, &b);
        }
        uint32_t count = put_points(wide, tree_a, a, quads[i]);
        count += put_points(wide, tree_b, b, quads[i] + count);
        for (; count < 4; count++) {
            quads[i][count] = quads[i][count - 1];
        }
#pragma GCC unroll 4
        for (uint32_t k = 0; k < 4; k++) {
            __builtin_prefetch(&points[quads[i][k]]);
        }
    }
}

/* With the kind as a constant of the code. */
static void make_quads(const struct eng_wide *wide, enum pccd_kind kind,
                       const struct eng_wide_chunk *chunk, uint32_t (*quads)[4])
{
    switch (kind) {
#define MAKE_QUADS(NAME, ...)                                                            \
    case PCCD_##NAME:                                                                    \
        make_quads_of(wide, PCCD_##NAME, chunk, quads);                                  \
        break;
        PCCD_KIND_LIST(MAKE_QUADS)
#undef MAKE_QUADS
    case PCCD_KIND_COUNT:
        assert(false);
    }
}

INLINE void name_kind(const struct eng_wide *wide, enum pccd_kind kind,
                      const struct eng_wide_chunk *chunk, const uint32_t *index,
                      uint32_t count, struct pccd_pair *names)
{
    for (uint32_t i = 0; i < count; i++) {
        names[i] = name_of(wide, kind, chunk->a[index[i]], chunk->b[index[i]]);
    }
}

/* With what there is most of as constants of the code. */
static void name_pairs(const struct eng_worker *worker, enum pccd_kind kind,
                       const uint32_t *index, uint32_t count, struct pccd_pair *names)
{
    const struct eng_wide *wide = eng_wide_of(worker->scene);
    const struct eng_wide_chunk *chunk = &eng_wide_work_of(worker)->join.chunks[kind];
    switch (kind) {
    case PCCD_VF:
        name_kind(wide, PCCD_VF, chunk, index, count, names);
        break;
    case PCCD_EE:
        name_kind(wide, PCCD_EE, chunk, index, count, names);
        break;
    default:
        name_kind(wide, kind, chunk, index, count, names);
    }
}

/* ---- sieves: what is certainly not asked for goes, by the marks of points ---------- */

/* Return what is known after a test: whether it has left out one of `part` pairs. */
static enum eng_known known_of(uint32_t count, uint32_t left, uint32_t part)
{
    return count - left >= count / part ? ENG_KNOWN_SIEVED : ENG_KNOWN_BOXES;
}

/* Contacts. */
static enum eng_known sift(struct eng_worker *worker, enum pccd_kind kind,
                           struct eng_wide_chunk *chunk)
{
    struct eng_wide_work *work = eng_wide_work_of(worker);
    struct eng_sieve *sieve = &work->sieves[kind];
    uint32_t count = chunk->count;
    sieve->t_end = worker->box_bound;
    chunk->count = work->join.kernels->sift(kind, sieve, chunk->a, chunk->b, count);
    return known_of(count, chunk->count, FILTER_PAYS_BELOW);
}

/* Contacts at a distance: what is farther apart, all over the step, than any two features
 * meet. */
static enum eng_known sift_thick(struct eng_worker *worker, enum pccd_kind kind,
                                 struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = eng_wide_of(worker->scene);
    struct eng_wide_work *work = eng_wide_work_of(worker);
    double reach = eng_thickness_reach_growth(worker->scene) * wide->grid.scale;
    uint32_t count = chunk->count;
    if (reach > ENG_GRID_REACH) {
        return ENG_KNOWN_BOXES;
    }
    float cells = nextafterf((float)reach, INFINITY);
    chunk->count = work->join.kernels->sift_thick(kind, &work->sieves[kind], cells,
                                                  chunk->a, chunk->b, count);
    eng_narrow_of(worker)->thick->candidates += count - chunk->count;
    return known_of(count, chunk->count, NEXT_PAYS_BELOW);
}

/* The reach of a question for a kind in cells of the grid, rounded up; 0: there is no
 * grid. */
static float reach_of(const struct eng_worker *worker, uint32_t kind)
{
    const struct eng_wide *wide = eng_wide_of(worker->scene);
    float growth = kind == PCCD_EF ? 0 : worker->question->sought.reach_growth;
    double reach = growth * wide->grid.scale;
    return eng_wide_has_marks(wide) && reach <= ENG_GRID_REACH ? eng_wide_cells_of(reach)
                                                               : 0;
}

/* Sift pairs for what is near. */
static enum eng_known sift_near(struct eng_worker *worker, uint32_t kind,
                                struct eng_wide_chunk *chunk)
{
    struct eng_wide_work *work = eng_wide_work_of(worker);
    uint32_t count = chunk->count;
    float reach = reach_of(worker, kind);
    if (reach == 0) {
        return ENG_KNOWN_BOXES;
    }
    chunk->count = work->join.kernels->sift_near(kind, &work->sieves[kind], reach,
                                                 chunk->a, chunk->b, count);
    return known_of(count, chunk->count, NEXT_PAYS_BELOW);
}

/* Those pairs that the sieve of the question leaves are the chunk's from then on. */
static enum eng_known sieve(struct eng_worker *worker, uint32_t kind,
                            struct eng_wide_chunk *chunk)
{
    uint32_t count = chunk->count;
    if (!eng_wide_has_marks(eng_wide_of(worker->scene)) ||
        eng_wide_is_of_free((enum pccd_kind)kind)) {
        return ENG_KNOWN_BOXES;
    }
    if (eng_asks_near(worker->question)) {
        return sift_near(worker, kind, chunk);
    }
    if (worker->question->mode == PCCD_MODE_PAIRS) {
        return ENG_KNOWN_BOXES;
    }
    enum eng_known known = worker->scene->thickness.is_on
                               ? sift_thick(worker, (enum pccd_kind)kind, chunk)
                               : sift(worker, (enum pccd_kind)kind, chunk);
    worker->record.tests += count - chunk->count;
    return known;
}

/* Tell the points of the pairs of a chunk, of work->quads, what was found: a pair that is
 * farther apart than the bound of each of its own and any radii is not looked for any
 * more. */
static void tell_marks(struct eng_worker *worker, enum pccd_kind kind,
                       const struct eng_wide_chunk *chunk)
{
    struct eng_wide_leads *leads = &eng_wide_state_of(worker->scene)->leads;
    struct eng_wide *wide = eng_wide_of(worker->scene);
    const struct eng_batch *batch = &eng_narrow_of(worker)->batch;
    const struct eng_wide_work *work = eng_wide_work_of(worker);
    const struct eng_question *question = worker->question;
    double scale = wide->frame_scale * wide->grid.scale;
    double radii = question->sought.reach - question->distance;
    float reach = reach_of(worker, kind);
    for (uint32_t i = 0; i < batch->found && reach > 0; i++) {
        double known = batch->near[i].lo;
        if (radii > 0) { /* they are taken off lengths that are rounded down to 33 bits */
            known = (known + radii) * (1 + 0x1p-30);
        }
        const uint32_t pair = batch->index[i];
        const uint32_t *quad = work->quads[pair];
        uint32_t is_new = eng_wide_mark_near(wide->marks, quad, question->end, reach,
                                             eng_wide_cells_of(known * scale));
        is_new = known < LEADS_WITHIN * question->sought.reach ? is_new : 0;
        for (; is_new != 0; is_new &= is_new - 1) {
            eng_wide_leads_learn(leads, quad[__builtin_ctz(is_new)], kind, chunk->a[pair],
                                 chunk->b[pair]);
        }
    }
}

/* ---- the pairs of a chunk ---------------------------------------------------------- */

static void make_fives(const struct eng_wide *wide, const struct eng_wide_chunk *chunk,
                       uint32_t (*fives)[5])
{
    for (uint32_t i = 0; i < chunk->count; i++) {
        put_points(wide, PCCD_TREE_EDGES, chunk->a[i], fives[i]);
        put_points(wide, PCCD_TREE_FACES, chunk->b[i], fives[i] + 2);
    }
}

static void test(struct eng_worker *worker, uint32_t kind, struct eng_wide_chunk *chunk)
{
    const struct eng_wide *wide = eng_wide_of(worker->scene);
    struct eng_wide_work *work = eng_wide_work_of(worker);
    struct eng_pairs pairs = {.kind = kind, .points = wide->points};
    pairs.known = sieve(worker, kind, chunk);
    pairs.count = chunk->count;
    if (kind == PCCD_EF) {
        make_fives(wide, chunk, work->fives);
        pairs.fives = (const uint32_t(*)[5])work->fives;
    } else {
        make_quads(wide, (enum pccd_kind)kind, chunk, work->quads);
        pairs.quads = (const uint32_t(*)[4])work->quads;
    }
    eng_narrow_test(worker, &pairs, name_pairs);
    if (work->sieves[kind].prunes) {
        tell_marks(worker, (enum pccd_kind)kind, chunk);
    }
}

/* ---- chunks ------------------------------------------------------------------------ */

/* Return whether to stop. Else go on with the bound on time as it is by now. */
static void look(void *owner)
{
    struct eng_worker *worker = owner;
    struct eng_wide_join *join = &eng_wide_work_of(worker)->join;
    join->stopped = eng_worker_should_stop(worker);
    if (worker->box_bound < 1) {
        eng_wide_join_until(join, worker->box_bound);
    }
}

/* Pairs that the join has left out in time since the last chunk. To look at a block's
 * times pays when it saves the filter enough pairs: when a chunk's share of them was
 * small, the next ones go without. */
static uint32_t left_out_in_time(struct eng_wide_work *work, enum pccd_kind kind,
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

/* Return whether so many tests more are too many for a brief step. */
static bool takes_long(const struct eng_worker *worker, uint32_t count)
{
    const struct eng_question *question = worker->question;
    return question->brief &&
           worker->record.tests + count >
               (question->alone ? ENG_BRIEF_TESTS_ALONE : ENG_BRIEF_TESTS);
}

static void flush(void *owner, enum pccd_kind kind, struct eng_wide_chunk *chunk)
{
    struct eng_worker *worker = owner;
    uint64_t begin_ns = common_now_ns();
    struct eng_wide_work *work = eng_wide_work_of(worker);
    const uint32_t count = chunk->count;
    work->sieves[kind].in_time = work->join.jobs[kind][0].in_time;
    eng_count_candidates(worker, kind, count + left_out_in_time(work, kind, count));
    if (takes_long(worker, count)) {
        eng_worker_give_up(worker);
    }
    if (!eng_near_leaves_out(worker->question, kind) && !eng_stop_is_set(worker->stop)) {
        test(worker, kind, chunk);
    }
    chunk->count = 0;
    look(worker);
    eng_count_test_time(worker, kind, count, begin_ns);
}

void eng_wide_work_leads(struct eng_worker *worker)
{
    struct eng_wide_leads *leads = &eng_wide_state_of(worker->scene)->leads;
    struct eng_wide_work *work = eng_wide_work_of(worker);
    struct eng_wide_chunk *chunks = work->join.chunks;
    bool has_leads = work->has_leads;
    work->has_leads = false;
    while (has_leads && !eng_worker_should_stop(worker) &&
           eng_wide_leads_take(leads, eng_wide_of(worker->scene), chunks)) {
        for (uint32_t kind = 0; kind < COMMON_KIND_COUNT; kind++) {
            if (chunks[kind].count > 0) {
                test(worker, kind, &chunks[kind]);
                chunks[kind].count = 0;
            }
        }
    }
}

void eng_wide_work_begin(struct eng_worker *worker)
{
    assert(eng_wide_work_of(worker)); /* reserved */
    struct eng_wide_work *work = eng_wide_work_of(worker);
    const struct eng_wide_owners *owners = &eng_wide_state_of(worker->scene)->owners;
    work->join.owner = worker;
    work->join.flush = flush;
    work->join.look = look;
    eng_wide_join_begin(&work->join, eng_wide_of(worker->scene),
                        eng_asks_near(worker->question) ? ENG_JOIN_AT : ENG_JOIN_MOVING);
    if (eng_asks_near(worker->question)) {
        eng_wide_join_at(&work->join, eng_wide_of(worker->scene), worker->question);
    }
    if (!eng_asks_near(worker->question) && worker->scene->thickness.is_on) {
        work->join.kinds = eng_wide_asked_kinds(eng_wide_of(worker->scene), true);
    }
    work->join.owners = eng_wide_owners_are_on(owners) ? owners : NULL;
    if (worker->prunes) {
        eng_wide_join_prune(&work->join, eng_wide_of(worker->scene));
    }
    for (uint32_t kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        work->sieves[kind] = eng_wide_sieve(eng_wide_of(worker->scene), kind);
        work->sieves[kind].prunes = kind != PCCD_EF && eng_near_prunes(worker->question);
        work->sieves[kind].end = worker->question->end;
    }
    for (uint32_t kind = 0; kind < COMMON_KIND_COUNT; kind++) {
        bool in_time = kind < PCCD_KIND_COUNT &&
                       worker->question->mode != PCCD_MODE_PAIRS &&
                       !eng_asks_near(worker->question);
        work->join.jobs[kind][0].in_time = in_time;
        for (uint32_t level = 1; level < ENG_WIDE_LEVELS_MAX; level++) {
            work->join.jobs[kind][level].in_time =
                in_time && eng_wide_of(worker->scene)->steps_without_times[kind] == 0;
        }
        work->times[kind] = (struct eng_wide_times){0, 0};
    }
    look(worker);
    work->has_leads = eng_near_prunes(worker->question);
}

void eng_wide_work_end(struct eng_worker *worker)
{
    const struct eng_wide_join *join = &eng_wide_work_of(worker)->join;
    worker->record.box_tests = eng_wide_join_test_count(join);
    worker->record.pairs = join->pairs;
    worker->tally.still_pairs = eng_wide_join_still_count(join);
}
