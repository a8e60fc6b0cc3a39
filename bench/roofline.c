/* roofline.c - every kernel and phase of the method `wide` beside its floor. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"
#include "resident.h"
#include "sections.h"
#include "wide_cells.h"
#include "wide_join.h"
#include "workload.h"
#include "world.h"

#define REPEATS    9u
#define L1_BYTES   ((size_t)16 << 10)
#define PAIRS_MAX  1500000u /* tested in a repeat: of more, every n-th chunk */
#define TOLERANCE  1e-6
#define WITHIN_MAX 300000u

enum part {
    PART_POINTS, /* a vertex: its box */
    PART_MARKS,  /* a vertex: its mark on the grid */
    PART_EDGES,  /* an edge: its box, from two vertices, and the block's */
    PART_FACES,
    PART_FOLD,    /* a vertex: its box to the block */
    PART_JOIN,    /* a box against a block of 16 */
    PART_SIFT_VF, /* a candidate that no axis separates */
    PART_SIFT_EE,
    PART_APART_VF, /* a candidate */
    PART_APART_EE,
    PART_FILTER_VF, /* the same */
    PART_FILTER_EE,
    PART_BRACKET_VF, /* a candidate that the sieve leaves */
    PART_BRACKET_EE,
    PART_TESTS_VF, /* a candidate: sieve, its axes first; solver */
    PART_TESTS_EE,
    PART_WITHIN, /* a double */
    PART_WIDEN,  /* a float, to a double */
    PART_COUNT
};

/* Cost of one item. */
struct cost {
    double bytes;      /* read and written, each once */
    double operations; /* vector instructions; loads, stores and addresses not counted */
};

/* Times and counts of an instruction set in one repeat, and what came out. */
struct outcome {
    uint64_t ns[PART_COUNT];
    uint64_t items[PART_COUNT];
    uint64_t sum; /* of hashes: equal for all sets */
    uint64_t hits;
    uint64_t unsure;   /* pairs that took a search one by one */
    uint64_t filtered; /* pairs that the filter leaves */
    uint64_t exact;    /* answers of exact arithmetic */
    uint64_t refit_ns;
    uint64_t pairs_ns;
};

struct bench {
    const char *name;
    struct eng_scene *scene;
    struct eng_exact exact;
    struct eng_wide_join join;
    struct eng_batch batch;
    uint32_t quads[ENG_CHUNK_MAX][4];
    uint32_t pairs[ENG_CHUNK_MAX];
    struct eng_sieve sieves[PCCD_KIND_COUNT];
    struct eng_wide_chunk sifted;
    const struct eng_kernels *kernels;
    struct outcome *outcome;
    bool is_testing;
    bool is_summing; /* the first repeat, which is not timed, reads every pair */
    uint64_t chunks;
    uint64_t stride; /* of the chunks that are tested */
    double *numbers; /* [WITHIN_MAX] */
    float *floats;
};

static struct bench_samples samples[PART_COUNT][ENG_ISA_COUNT];
static struct bench_samples refit_ms[ENG_ISA_COUNT];
static struct bench_samples pairs_ms[ENG_ISA_COUNT];

/* ---- speeds of this machine ------------------------------------------------------ */

#define ROUNDS   9u
#define CHAIN    200000u
#define LEAST_NS 2000000u

/* Cycles a nanosecond: a chain of multiplications of integers, three cycles each on x86
 * processors since 2011 and on 64-bit Arm. The fastest of several. */
static double clock_ghz(void)
{
    double best = 0;
    for (unsigned round = 0; round < ROUNDS; round++) {
        uint64_t x = round + 3;
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < CHAIN; i++) {
            x *= x;
            __asm__ volatile("" : "+r"(x));
        }
        double ghz = 3.0 * CHAIN / (double)(common_now_ns() - begin_ns);
        best = ghz > best ? ghz : best;
    }
    return best;
}

/* `to` NULL: read `from`. Bytes are those of `from`. */
static double fastest_gbps(const char *from, char *to, size_t bytes)
{
    size_t times = ((size_t)8 << 20) / bytes + 1;
    double best = 0;
    uint64_t end_ns = common_now_ns() + LEAST_NS;
    for (unsigned round = 0; round < ROUNDS || common_now_ns() < end_ns; round++) {
        uint64_t begin_ns = common_now_ns();
        for (size_t i = 0; i < times; i++) {
            const void *done = to ? memcpy(to, from, bytes) : memchr(from, 2, bytes);
            __asm__ volatile("" : : "r"(done) : "memory");
        }
        double gbps = (double)(bytes * times) / (double)(common_now_ns() - begin_ns);
        best = gbps > best ? gbps : best;
    }
    return best;
}

/* Bytes a nanosecond, read and written together, of memcpy from one half of so many bytes
 * to the other: whatever cache they fit. The fastest of several. */
static double copy_gbps(size_t bytes)
{
    size_t half = bytes / 2 + 64;
    char *from = bench_alloc(half, 1);
    char *to = bench_alloc(half, 1);
    memset(from, 1, half);
    memset(to, 1, half);
    double gbps = 2 * fastest_gbps(from, to, half);
    free(from);
    free(to);
    return gbps;
}

/* The same of memchr, which only reads. */
static double read_gbps(size_t bytes)
{
    char *from = bench_alloc(bytes, 1);
    memset(from, 1, bytes);
    double gbps = fastest_gbps(from, NULL, bytes);
    free(from);
    return gbps;
}

/* ---- floors --------------------------------------------------------------------- */

static const char *const part_names[PART_COUNT] = {
    "box a vertex", "mark a vertex", "box an edge", "box a face", "block a vertex",
    "join 1 x 16",  "sift VF",       "sift EE",     "apart VF",   "apart EE",
    "filter VF",    "filter EE",     "bracket VF",  "bracket EE", "tests VF",
    "tests EE",     "check double",  "check float"};

/* Lanes of doubles and of floats. */
static double double_lanes(enum eng_isa isa)
{
    static const double lanes[ENG_ISA_COUNT] = {1, 2, 2, 4, 8, 2};
    return lanes[isa];
}

static double float_lanes(enum eng_isa isa)
{
    static const double lanes[ENG_ISA_COUNT] = {1, 4, 4, 8, 16, 4};
    return lanes[isa];
}

/* Return the cost of one item of a part.
 *
 * Bytes: what has to come from or go to where it is kept, once: a point and its box are
 * 64, its mark is 32, a box in a block is 48, a pair has 16 of indices; a vertex has some
 * 3 edges and 2 faces. Operations: those that the comments name, by all lanes at a time;
 * loads, turning points round and what is done once a group are not among them. */
static struct cost part_cost(enum part part, enum eng_isa isa)
{
    double d = double_lanes(isa);
    double f = float_lanes(isa);
    switch (part) {
    case PART_POINTS: /* 16 of 8 doubles: there and back, compare, one up or down */
        return (struct cost){64 + 64, 16 * 8 / d};
    case PART_FOLD: /* a maximum of 16 floats; 4 sides of 4 boxes turn with 7 shuffles */
        return (struct cost){64 + 48, 16 / f + 7};
    case PART_EDGES: /* a maximum more */
        return (struct cost){64.0 / 3 + 8 + 48, 2 * 16 / f + 7};
    case PART_FACES: /* two more */
        return (struct cost){64.0 / 2 + 12 + 48, 3 * 16 / f + 7};
    case PART_JOIN: /* 4 sums and 2 ands an axis, of 16 floats; the block stays near */
        return (struct cost){64, 18 * 16 / f};
    case PART_MARKS: /* of 8 doubles: minus, times, larger, plus, narrowed */
        return (struct cost){64 + 32, 5 * 8 / d};
    case PART_SIFT_VF: /* differences 24; extremes 24, to floats 24, times 66 */
        return (struct cost){4 * 32 + 32, 3 * 8 / f + (24 + 24 + 66) / f};
    case PART_SIFT_EE: /* extremes 36 */
        return (struct cost){4 * 32 + 32, 3 * 8 / f + (36 + 24 + 66) / f};
    case PART_APART_VF: /* 4 extremes and 2 compares of 8 doubles */
    case PART_APART_EE:
        return (struct cost){4 * 64 + 16, 6 * 8 / d};
    case PART_FILTER_VF: /* differences 18, times 126; the rest where a lane is left */
        return (struct cost){4 * 64 + 16, (18 + 126) / d};
    case PART_FILTER_EE: /* 30, 138 */
        return (struct cost){4 * 64 + 16, (30 + 138) / d};
    case PART_BRACKET_VF: /* 33 of differences, cubic and halves 115, a guess 12, three
                           * rounds to its root 60, bracket 54, place 102; 6 divisions or
                           * roots, each two cycles a lane */
    case PART_BRACKET_EE:
        return (struct cost){4 * 64 + 16, 376 / d + 24};
    case PART_WITHIN: /* clear the sign, compare, and */
        return (struct cost){8, 3 / d};
    default: /* PART_WIDEN: widen before */
        return (struct cost){4 + 8, 4 / d};
    }
}

/* Return the cost of the axes of a pair of marks, which the sieve looks at first where
 * boxes around whole motions are all that is known. */
static struct cost axes_cost(enum eng_isa isa)
{
    /* 4 extremes, 2 sums and 2 compares of 8 whole numbers; a mark is 32 bytes */
    return (struct cost){4 * 32 + 8, 8 * 8 / float_lanes(isa)};
}

/* Two operations a cycle, or the bytes at a speed: whatever is longer. */
static double cost_ns(struct cost cost, double ghz, double gbps)
{
    double compute = cost.operations / 2 / ghz;
    double memory = cost.bytes / gbps;
    return compute > memory ? compute : memory;
}

/* Bytes a nanosecond, where a part's bytes are. */
struct speeds {
    double ghz;
    double near; /* read: the first cache */
    double far;  /* copied: the trees */
    double read; /* as many numbers as are checked */
    double copy;
};

static double floor_of(enum part part, enum eng_isa isa, const struct outcome *outcome,
                       const struct speeds *speeds)
{
    if (part == PART_TESTS_VF || part == PART_TESTS_EE) {
        /* The kernels, on what reaches them. */
        static const enum part parts[2][2] = {{PART_SIFT_VF, PART_BRACKET_VF},
                                              {PART_SIFT_EE, PART_BRACKET_EE}};
        double ns = cost_ns(axes_cost(isa), speeds->ghz, speeds->near);
        for (int i = 0; i < 2 && outcome->items[part] > 0; i++) {
            enum part one = parts[part == PART_TESTS_EE][i];
            ns += (double)outcome->items[one] / (double)outcome->items[part] *
                  floor_of(one, isa, outcome, speeds);
        }
        return ns;
    }
    double gbps = part <= PART_FOLD     ? speeds->far
                  : part == PART_WITHIN ? speeds->read
                  : part == PART_WIDEN  ? speeds->copy
                                        : speeds->near;
    return cost_ns(part_cost(part, isa), speeds->ghz, gbps);
}

/* ---- kernels -------------------------------------------------------------------- */

static uint64_t mix(uint64_t sum, uint64_t value)
{
    return (sum ^ value) * 0x9e3779b97f4a7c15u;
}

static uint64_t hash_blocks(const struct eng_wide_tree *tree, uint32_t levels)
{
    uint64_t sum = 1;
    for (uint32_t level = 0; level < levels; level++) {
        const struct eng_wide_block *blocks = eng_wide_blocks(tree, level);
        for (uint32_t i = 0; i < tree->block_count[level]; i++) {
            uint64_t words[sizeof *blocks / 8];
            memcpy(words, &blocks[i], sizeof words);
            for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
                sum = mix(sum, words[k]);
            }
        }
    }
    return sum;
}

static void count_part(struct bench *bench, enum part part, uint64_t begin_ns,
                       uint64_t items)
{
    bench->outcome->ns[part] += common_now_ns() - begin_ns;
    bench->outcome->items[part] += items;
}

/* The leaves of the trees, kernel by kernel over whole arrays. */
static void box_all(struct bench *bench)
{
    struct eng_wide *wide = eng_wide_of(bench->scene);
    const struct eng_kernels *kernels = bench->kernels;
    struct eng_wide_tree *tree = &wide->trees[PCCD_TREE_VERTICES];
    uint64_t begin_ns = common_now_ns();
    for (uint32_t slot = 0; slot < tree->slot_count;) {
        uint32_t run = slot;
        while (slot < tree->slot_count && wide->points[slot].word0 != ENG_WIDE_NOBODY) {
            slot++;
        }
        kernels->box_points(wide->points + run, slot - run, NULL, true,
                            wide->point_boxes + run);
        bench->outcome->items[PART_POINTS] += slot - run;
        while (slot < tree->slot_count && wide->points[slot].word0 == ENG_WIDE_NOBODY) {
            slot++;
        }
    }
    count_part(bench, PART_POINTS, begin_ns, 0);
    /* The last slot is nobody's, and 0 is on the grid. */
    begin_ns = common_now_ns();
    bool on_grid = kernels->place_points(wide->points, tree->slot_count, NULL,
                                         &wide->grid, wide->marks);
    count_part(bench, PART_MARKS, begin_ns, tree->slot_count);
    bench->outcome->sum += on_grid;
    begin_ns = common_now_ns();
    kernels->box_fold(wide->point_boxes, tree->slot_count / ENG_WIDE, false, tree->floats,
                      tree->float_boxes);
    count_part(bench, PART_FOLD, begin_ns, tree->slot_count);
    for (enum pccd_tree kind = PCCD_TREE_EDGES; kind <= PCCD_TREE_FACES; kind++) {
        tree = &wide->trees[kind];
        const uint32_t *const corner[3] = {tree->corner[0], tree->corner[1],
                                           kind == PCCD_TREE_FACES ? tree->corner[2]
                                                                   : NULL};
        begin_ns = common_now_ns();
        kernels->box_unite(wide->point_boxes, corner, tree->slot_count / ENG_WIDE, false,
                           tree->floats, tree->float_boxes);
        count_part(bench, kind == PCCD_TREE_EDGES ? PART_EDGES : PART_FACES, begin_ns,
                   tree->slot_count);
    }
}

static void make_quads(struct bench *bench, enum pccd_kind kind,
                       const struct eng_wide_chunk *chunk)
{
    const struct eng_wide_tree *trees = eng_wide_of(bench->scene)->trees;
    for (uint32_t i = 0; i < chunk->count; i++) {
        uint32_t a = chunk->a[i];
        uint32_t b = chunk->b[i];
        uint32_t *quad = bench->quads[i];
        if (kind == PCCD_VF) {
            quad[0] = a;
            for (int k = 0; k < 3; k++) {
                quad[1 + k] = trees[PCCD_TREE_FACES].corner[k][b];
            }
            continue;
        }
        for (int k = 0; k < 2; k++) {
            quad[k] = trees[PCCD_TREE_EDGES].corner[k][a < b ? a : b];
            quad[2 + k] = trees[PCCD_TREE_EDGES].corner[k][a < b ? b : a];
        }
    }
}

static void sum_hits(struct bench *bench, uint32_t hits)
{
    for (uint32_t i = 0; i < hits; i++) {
        const struct eng_hit *hit = &bench->batch.hits[i];
        const uint32_t *quad = bench->quads[bench->batch.index[i]];
        uint64_t words[2];
        memcpy(&words[0], &hit->toi, 8);
        memcpy(&words[1], hit->param, 8);
        bench->outcome->sum += mix(mix(mix(quad[0], quad[2]), words[0]), words[1]);
    }
}

/* Have the sieve drop what it can of the first `count` pairs of bench->sifted. */
static void sift(struct bench *bench, enum pccd_kind kind, bool swept, uint32_t count)
{
    struct eng_wide_chunk *sifted = &bench->sifted;
    struct eng_sieve *sieve = &bench->sieves[kind];
    sieve->swept = swept;
    sifted->count = bench->kernels->sift(kind, sieve, sifted->a, sifted->b, count);
}

/* Sieve and solver on the pairs of a chunk, which are those of plain swept boxes. (In a
 * step the moving boxes of the join stand for the sieve's axes.) */
static void test_pairs(struct bench *bench, enum pccd_kind kind,
                       const struct eng_wide_chunk *chunk)
{
    const struct eng_point *points = eng_wide_of(bench->scene)->points;
    const uint32_t(*quads)[4] = (const uint32_t(*)[4])bench->quads;
    struct eng_batch *batch = &bench->batch;
    struct outcome *outcome = bench->outcome;
    uint64_t exact = bench->exact.queries;
    memcpy(bench->sifted.a, chunk->a, chunk->count * sizeof *chunk->a);
    memcpy(bench->sifted.b, chunk->b, chunk->count * sizeof *chunk->b);
    uint64_t begin_ns = common_now_ns();
    sift(bench, kind, true, chunk->count);
    make_quads(bench, kind, &bench->sifted);
    const struct eng_question question = ENG_QUESTION_DEFAULT; /* of TOLERANCE */
    const struct eng_pairs pairs = {.question = &question,
                                    .kind = kind,
                                    .known = ENG_KNOWN_SIEVED,
                                    .count = bench->sifted.count,
                                    .points = points,
                                    .quads = quads,
                                    .t_end = 1};
    batch->kernels = bench->kernels;
    batch->contacts = &bench->exact;
    uint32_t hits = eng_batch_test(batch, &pairs);
    count_part(bench, kind == PCCD_VF ? PART_TESTS_VF : PART_TESTS_EE, begin_ns,
               chunk->count);
    outcome->hits += hits;
    outcome->unsure += batch->unsure_count;
    outcome->exact += bench->exact.queries - exact;
    sum_hits(bench, hits);
}

/* The tests come first, as in a step: the points are where the join has left them. The
 * kernels by themselves find them in the first caches. */
static void test_chunk(struct bench *bench, enum pccd_kind kind,
                       const struct eng_wide_chunk *chunk)
{
    const struct eng_point *points = eng_wide_of(bench->scene)->points;
    const uint32_t(*quads)[4] = (const uint32_t(*)[4])bench->quads;
    const struct eng_kernels *kernels = bench->kernels;
    struct outcome *outcome = bench->outcome;
    bool is_vf = kind == PCCD_VF;
    test_pairs(bench, kind, chunk);
    make_quads(bench, kind, chunk);
    uint64_t begin_ns = common_now_ns();
    uint32_t kept = kernels->reject_axes((struct eng_quads){kind, points, quads},
                                         chunk->count, bench->pairs);
    count_part(bench, is_vf ? PART_APART_VF : PART_APART_EE, begin_ns, chunk->count);
    for (uint32_t i = 0; i < kept; i++) {
        bench->sifted.a[i] = chunk->a[bench->pairs[i]];
        bench->sifted.b[i] = chunk->b[bench->pairs[i]];
    }
    begin_ns = common_now_ns();
    uint32_t left = kernels->filter((struct eng_quads){kind, points, quads}, bench->pairs,
                                    kept, bench->pairs);
    count_part(bench, is_vf ? PART_FILTER_VF : PART_FILTER_EE, begin_ns, kept);
    outcome->filtered += left;
    outcome->sum += mix(left, kept);
    begin_ns = common_now_ns();
    sift(bench, kind, false, kept);
    count_part(bench, is_vf ? PART_SIFT_VF : PART_SIFT_EE, begin_ns, kept);
    make_quads(bench, kind, &bench->sifted);
    left = bench->sifted.count;
    for (uint32_t i = 0; i < left; i++) {
        bench->pairs[i] = i;
    }
    struct eng_bracketed out = {.index = bench->batch.index,
                                .hits = bench->batch.hits,
                                .unsure = bench->batch.unsure};
    begin_ns = common_now_ns();
    kernels->bracket((struct eng_quads){kind, points, quads}, bench->pairs, left,
                     TOLERANCE, 1, &out);
    count_part(bench, is_vf ? PART_BRACKET_VF : PART_BRACKET_EE, begin_ns, left);
    outcome->sum += mix(out.hit_count, out.unsure_count) + left;
}

static void on_chunk(void *owner, enum pccd_kind kind, struct eng_wide_chunk *chunk)
{
    struct bench *bench = owner;
    uint64_t sum = 0;
    if (bench->is_testing && bench->chunks % bench->stride == 0) {
        test_chunk(bench, kind, chunk);
    } else if (bench->is_summing) {
        for (uint32_t i = 0; i < chunk->count; i++) {
            sum += (uint64_t)(chunk->a[i] + 1) * (chunk->b[i] + 1);
        }
    }
    bench->outcome->sum += sum + chunk->count;
    bench->chunks++;
    chunk->count = 0;
}

static void on_look(void *owner)
{
    (void)owner;
}

/* All pairs of plain swept boxes. */
static void join_all(struct bench *bench, bool is_testing)
{
    const struct eng_wide *wide = eng_wide_of(bench->scene);
    struct eng_wide_join *join = &bench->join;
    uint32_t top = wide->level_count - 1;
    join->owner = bench;
    join->flush = on_chunk;
    join->look = on_look;
    bench->is_testing = is_testing;
    bench->chunks = 0;
    eng_wide_join_begin(join, wide, ENG_JOIN_MOVING);
    bench->sieves[PCCD_VF] = eng_wide_sieve(wide, PCCD_VF);
    bench->sieves[PCCD_EE] = eng_wide_sieve(wide, PCCD_EE);
    uint64_t begin_ns = common_now_ns();
    eng_wide_join_nodes(join, PCCD_VF, top, 0, 0);
    eng_wide_join_nodes(join, PCCD_EE, top, 0, 0);
    eng_wide_join_flush(join);
    if (!is_testing) {
        count_part(bench, PART_JOIN, begin_ns, eng_wide_join_test_count(join));
        bench->outcome->pairs_ns = common_now_ns() - begin_ns;
    }
}

static void check_numbers(struct bench *bench)
{
    uint64_t begin_ns = common_now_ns();
    bool good = bench->kernels->all_within(bench->numbers, WITHIN_MAX, 1e18);
    count_part(bench, PART_WITHIN, begin_ns, WITHIN_MAX);
    begin_ns = common_now_ns();
    good &= bench->kernels->widen_within(bench->numbers, bench->floats, WITHIN_MAX, 1e18);
    count_part(bench, PART_WIDEN, begin_ns, WITHIN_MAX);
    bench->outcome->sum += good;
}

/* All boxes, each around both ends. */
static void refit(struct eng_wide *wide, const struct eng_scene *scene)
{
    eng_wide_still_begin(wide, scene, false, false);
    wide->is_swept = true;
    for (enum pccd_tree kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t i = 0; i < eng_wide_refit_chunks(wide, kind); i++) {
            eng_wide_refit_chunk(wide, scene, kind, i);
        }
    }
    eng_wide_refit_above(wide);
    wide->is_swept = false;
}

static void run(struct bench *bench, const struct eng_kernels *kernels,
                struct outcome *outcome)
{
    struct eng_wide *wide = eng_wide_of(bench->scene);
    *outcome = (struct outcome){.sum = 0};
    bench->kernels = kernels;
    bench->outcome = outcome;
    wide->kernels = kernels;
    box_all(bench);
    uint64_t begin_ns = common_now_ns();
    refit(wide, bench->scene);
    outcome->refit_ns = common_now_ns() - begin_ns;
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        outcome->sum += hash_blocks(&wide->trees[kind], wide->level_count);
    }
    join_all(bench, false);
    join_all(bench, true);
    check_numbers(bench);
}

/* ---- report --------------------------------------------------------------------- */

static void keep(enum eng_isa isa, const struct outcome *outcome)
{
    for (int part = 0; part < PART_COUNT; part++) {
        if (outcome->items[part] > 0) {
            bench_add(&samples[part][isa],
                      (double)outcome->ns[part] / (double)outcome->items[part]);
        }
    }
    bench_add(&refit_ms[isa], 1e-6 * (double)outcome->refit_ns);
    bench_add(&pairs_ms[isa], 1e-6 * (double)outcome->pairs_ns);
}

/* A row of an instruction set, if it was measured. */
static void print_beside(const struct bench *bench, const char *what, const char *unit,
                         enum eng_isa isa, const struct bench_samples *of, double floor)
{
    char text[64];
    struct bench_samples base = {&floor, 1, 1};
    if (of->count == 0) {
        return;
    }
    snprintf(text, sizeof text, "%s, %s", what, eng_kernels_of(isa)->name);
    bench_row(bench->name, text, unit, of, "floor", &base);
}

/* Refit: the kernels' floors, and the positions that are copied. */
static double refit_floor_ms(const struct outcome *outcome, enum eng_isa isa,
                             const struct speeds *speeds)
{
    double ns = (double)outcome->items[PART_POINTS] * 2 * 48 / speeds->far;
    for (enum part part = PART_POINTS; part <= PART_FOLD; part++) {
        ns += (double)outcome->items[part] * floor_of(part, isa, outcome, speeds);
    }
    return 1e-6 * ns;
}

/* Print how many of the candidates get how far. */
static void print_shares(const struct bench *bench, const struct outcome *outcome)
{
    const uint64_t *items = outcome->items;
    double tested = (double)(items[PART_TESTS_VF] + items[PART_TESTS_EE]);
    const struct {
        const char *what;
        uint64_t count;
    } rows[] = {{"not apart", items[PART_FILTER_VF] + items[PART_FILTER_EE]},
                {"not filtered", outcome->filtered},
                {"not sifted", items[PART_BRACKET_VF] + items[PART_BRACKET_EE]},
                {"searched", outcome->unsure},
                {"exact answers", outcome->exact},
                {"contacts", outcome->hits}};
    bench_number(bench->name, "candidates tested", "", tested);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0] && tested > 0; i++) {
        bench_number(bench->name, rows[i].what, "share", (double)rows[i].count / tested);
    }
}

static void print(const struct bench *bench, const struct outcome *outcome)
{
    const struct eng_wide *wide = eng_wide_of(bench->scene);
    size_t bytes = 0;
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        bytes += (size_t)wide->trees[kind].slot_count * 48;
    }
    const struct speeds speeds = {clock_ghz(), read_gbps(L1_BYTES), copy_gbps(bytes),
                                  read_gbps(WITHIN_MAX * 8), copy_gbps(WITHIN_MAX * 12)};
    bench_number(bench->name, "clock", "GHz", speeds.ghz);
    bench_number(bench->name, "read the first cache", "GB/s", speeds.near);
    bench_number(bench->name, "copy the trees", "GB/s", speeds.far);
    bench_number(bench->name, "tests 1 x 16", "", (double)outcome->items[PART_JOIN]);
    print_shares(bench, outcome);
    for (enum part part = 0; part < PART_COUNT; part++) {
        for (enum eng_isa isa = 0; isa < ENG_ISA_COUNT; isa++) {
            print_beside(bench, part_names[part], "ns", isa, &samples[part][isa],
                         floor_of(part, isa, outcome, &speeds));
        }
    }
    for (enum eng_isa isa = 0; isa < ENG_ISA_COUNT; isa++) {
        print_beside(bench, "refit", "ms", isa, &refit_ms[isa],
                     refit_floor_ms(outcome, isa, &speeds));
        print_beside(bench, "pairs", "ms", isa, &pairs_ms[isa],
                     1e-6 * (double)outcome->items[PART_JOIN] *
                         floor_of(PART_JOIN, isa, outcome, &speeds));
    }
}

static void clear_samples(void)
{
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        for (int part = 0; part < PART_COUNT; part++) {
            bench_free(&samples[part][isa]);
        }
        bench_free(&refit_ms[isa]);
        bench_free(&pairs_ms[isa]);
    }
}

static void measure(struct bench *bench, unsigned repeats)
{
    struct outcome outcome;
    uint64_t expected = 0;
    bool good = true;
    bench->stride = 1;
    for (unsigned r = 0; r < repeats && good; r++) {
        bench->is_summing = r == 0;
        for (int isa = 0; isa < ENG_ISA_COUNT && good; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (!kernels) {
                continue;
            }
            run(bench, kernels, &outcome);
            if (isa == ENG_ISA_SCALAR) {
                expected = outcome.sum;
            }
            good = bench_check(outcome.sum == expected, bench->name,
                               "an instruction set differs from scalar");
            if (r > 0) {
                keep((enum eng_isa)isa, &outcome);
            }
        }
        if (r == 0) { /* how many chunks there are is known now */
            bench->stride = bench->chunks * ENG_CHUNK_MAX / PAIRS_MAX + 1;
        }
    }
    if (good) {
        print(bench, &outcome);
    }
    clear_samples();
}

static void measure_scene(const struct bench_scene *source, unsigned repeats)
{
    static struct bench bench; /* chunks and queues, a few hundred KiB */
    struct eng_question settings = bench_step_settings(PCCD_MODE_PAIRS);
    struct eng_step_result result;
    struct bench_frames frames;
    struct bench_world world;
    bench_heading(source->name);
    bench_frames_init(&frames, source, source->hard_frame);
    bench_world_init(&world, &frames, NULL);
    settings.method = PCCD_METHOD_WIDE;
    bench_world_step(&world, &frames, &settings, &result);
    bench_frames_deinit(&frames);
    memset(&bench, 0, sizeof bench);
    bench.name = source->name;
    bench.scene = world.scene;
    bench.numbers = bench_alloc(WITHIN_MAX, sizeof *bench.numbers);
    bench.floats = bench_alloc(WITHIN_MAX, sizeof *bench.floats);
    for (uint32_t i = 0; i < WITHIN_MAX; i++) {
        bench.floats[i] = (float)i;
        bench.numbers[i] = i;
    }
    if (eng_exact_init(&bench.exact) != PCCD_OK) {
        abort();
    }
    measure(&bench, repeats);
    eng_exact_deinit(&bench.exact);
    free(bench.numbers);
    free(bench.floats);
    bench_world_deinit(&world);
}

int section_roofline(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(options, NULL, &i, &scene);) {
        measure_scene(&scene, options->smoke ? 2 : REPEATS);
        bench_scene_free(&scene);
    }
    return 0;
}
