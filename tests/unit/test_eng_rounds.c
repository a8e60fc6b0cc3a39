/* test_eng_rounds.c - joins of many pairs of blocks at a time. */
#include "eng_boxes.h"
#include "wide_cells.h"

#define ALL_BLOCKS (3 * ENG_WIDE) /* three runs; the first is not used */
#define ALL_BOXES  (ALL_BLOCKS * ENG_WIDE)
#define PAIRS_MAX  150u /* more than two rounds */
#define CELL       0x1p-10

struct fixture {
    struct eng_extents boxes[ALL_BOXES];
    struct eng_wide_block blocks[ALL_BLOCKS];
    struct eng_wide_block others[ALL_BLOCKS]; /* the same, of another tree */
    struct eng_extents around[ALL_BLOCKS];
    struct eng_quantised_block quantised[ALL_BLOCKS];
    struct eng_quantised_box quantised_around[ALL_BLOCKS];
    uint32_t farthest;
    uint32_t corner[3][ALL_BOXES];
    uint16_t moving[ALL_BLOCKS];
};

static void fill(struct fixture *f, struct prng *random)
{
    struct eng_quantising quantiseding = {{0}, {0}, {0}};
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    memset(f->boxes, 0, sizeof f->boxes);
    for (uint32_t first = ENG_JOIN_MAX; first < ALL_BOXES; first += BOXES) {
        uint32_t corner[3][BOXES];
        fill_boxes(f->boxes + first, corner, random);
        for (uint32_t i = 0; i < 3 * BOXES; i++) {
            f->corner[i / BOXES][first + i % BOXES] =
                corner[i / BOXES][i % BOXES] + ENG_JOIN_MAX;
        }
    }
    for (int k = 0; k < 3; k++) {
        eng_wide_quantised_set(&quantiseding, k, 1 / CELL, 0);
    }
    scalar->box_fold(f->boxes, ALL_BLOCKS, false, f->blocks, f->around);
    f->farthest = 0;
    assert_true(scalar->quantised_blocks(
        f->blocks, f->around, ALL_BLOCKS, &quantiseding,
        &(struct eng_quantised_to){f->quantised, f->quantised_around, &f->farthest}));
    memcpy(f->others, f->blocks, sizeof f->others);
    for (uint32_t i = 0; i < ALL_BLOCKS; i++) { /* all, none or some */
        uint32_t some = prng_u32(random, 0x10000) & prng_u32(random, 0x10000);
        uint32_t masks[] = {0xffff, 0, some};
        f->moving[i] = (uint16_t)masks[prng_u32(random, 3)];
    }
}

enum which { NODES, EDGES, FACES, WHICH_COUNT };

static join_fn *join_of(const struct eng_kernels *kernels, enum which which)
{
    return which == NODES   ? kernels->join_nodes
           : which == EDGES ? kernels->join_features[PCCD_EE]
                            : kernels->join_features[PCCD_VF];
}

/* One of the ways to compare, the same for the same `way`. */
static struct eng_join job_of(const struct fixture *f, enum which which, uint32_t way)
{
    /* Of the near ones the first leaves boxes as they begin. */
    const float t_end[2][2] = {{1, 0.4f}, {0x1p-20f, 0.05f}};
    bool is_quantised = way % 2 == 1;
    struct eng_join job = {.a = f->blocks,
                           .b = which == FACES ? f->others : f->blocks,
                           .b_boxes = f->around,
                           .a_quantised = is_quantised ? f->quantised : NULL,
                           .b_quantised = is_quantised ? f->quantised : NULL,
                           .b_quantised_boxes = is_quantised ? f->quantised_around : NULL,
                           .boxes = (enum eng_join_boxes)(way / 2 % 3),
                           .farthest = f->farthest,
                           .t_end = t_end[way / 2 % 3 == ENG_JOIN_NEAR][way / 6 % 2],
                           .in_time = way / 12 % 2 == 1};
    for (uint32_t k = 0; k < 3; k++) {
        job.a_corner[k] = which == EDGES && k < 2 ? f->corner[k] : NULL;
        job.b_corner[k] = which == FACES || k < 2 ? f->corner[k] : NULL;
    }
    return job;
}

/* Pairs of features, a in the upper half. */
struct pairs {
    uint64_t list[PAIRS_MAX * ENG_JOIN_MAX];
    uint32_t count;
    uint64_t tests;
    uint64_t apart;
    uint64_t still;
};

static void keep(struct pairs *pairs, const struct lists *lists)
{
    for (uint32_t i = 0; i < lists->count; i++) {
        pairs->list[pairs->count++] = (uint64_t)lists->a[i] << 32 | lists->b[i];
    }
}

/* All pairs of the blocks, or, if `moving` is given, those that move: two by two, or in
 * one go with so much room at a time. */
static void join_all(const struct fixture *f, const struct eng_kernels *kernels,
                     enum which which, uint32_t way, const uint32_t (*blocks)[PAIRS_MAX],
                     uint32_t count, uint32_t room, const uint16_t *moving,
                     struct pairs *out)
{
    static struct eng_join_round round;
    struct eng_join job = job_of(f, which, way);
    job.a_moving = job.b_moving = moving;
    struct lists lists;
    out->count = 0;
    for (uint32_t i = 0; room == 0 && i < count; i++) {
        join_two(join_of(kernels, which), &job, blocks[0][i], blocks[1][i], &lists);
        keep(out, &lists);
    }
    eng_join_begin(&round, blocks[0], blocks[1], room == 0 ? 0 : count);
    while (!eng_join_has_ended(&round)) {
        lists.count = join_of(kernels, which)(&job, &round, lists.a, lists.b, room);
        assert_in_range(lists.count, 0, room);
        keep(out, &lists);
    }
    out->tests = job.tests;
    out->apart = job.apart_in_time;
    out->still = job.still;
}

static int by_number(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a;
    uint64_t y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Different pairs of blocks of two runs, or of one with itself. */
static uint32_t make_blocks(struct prng *random, enum which which,
                            uint32_t (*blocks)[PAIRS_MAX])
{
    uint32_t first_a = ENG_WIDE * (1 + prng_u32(random, 2));
    uint32_t first_b = ENG_WIDE * (1 + prng_u32(random, 2));
    uint32_t most = 1 + prng_u32(random, PAIRS_MAX);
    uint32_t count = 0;
    for (uint32_t i = prng_u32(random, 100); i < ENG_JOIN_MAX && count < most; i++) {
        uint32_t n = first_a + i / ENG_WIDE;
        uint32_t m = first_b + i % ENG_WIDE;
        if (which == FACES || first_a != first_b || n <= m) {
            blocks[0][count] = n;
            blocks[1][count++] = m;
        }
    }
    return count;
}

static bool moves(const struct fixture *f, uint64_t box)
{
    return f->moving[box / ENG_WIDE] >> box % ENG_WIDE & 1;
}

/* Leave out the pairs of which neither moves. */
static void leave_out(const struct fixture *f, struct pairs *pairs)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pairs->count; i++) {
        uint64_t pair = pairs->list[i];
        pairs->list[kept] = pair;
        kept += moves(f, pair >> 32) || moves(f, pair & UINT32_MAX);
    }
    pairs->count = kept;
}

/* If a pair that stands were found, its contact would be there twice, as the last answer
 * has it, too; if one were left out that moves, it would be missed. */
CASE(rounds__leave_out_what_stands)
{
    static struct fixture f;
    static uint32_t blocks[2][PAIRS_MAX];
    static struct pairs all;
    static struct pairs expected;
    static struct pairs found;
    struct prng random = {18};
    uint64_t pairs = 0;
    uint64_t still = 0;
    for (uint32_t way = 0; way < 24 * WHICH_COUNT; way++) {
        enum which which = (enum which)(way % WHICH_COUNT);
        fill(&f, &random);
        uint32_t count = make_blocks(&random, which, blocks);
        const uint32_t(*both)[PAIRS_MAX] = (const uint32_t(*)[PAIRS_MAX])blocks;
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (!kernels ||
                job_of(&f, which, way / WHICH_COUNT).boxes == ENG_JOIN_SWEPT) {
                continue;
            }
            join_all(&f, kernels, which, way / WHICH_COUNT, both, count, 100, NULL, &all);
            expected = all;
            leave_out(&f, &expected);
            join_all(&f, kernels, which, way / WHICH_COUNT, both, count, 100, f.moving,
                     &found);
            assert_int_equal(found.count, expected.count);
            assert_memory_equal(found.list, expected.list,
                                expected.count * sizeof *expected.list);
            assert_true(found.tests <= all.tests && found.apart <= all.apart);
            assert_true((found.still > 0) || found.count == all.count);
            if (isa == ENG_ISA_SCALAR) { /* which every processor has */
                pairs += found.count;
                still += all.count - found.count;
            }
        }
    }
    assert_true(pairs > 30000 && still > 30000);
}

/* If a pair were lost where a round ends, or where there is no room for it, its contact
 * would be missed; if it were there twice, so would be what is answered. */
CASE(rounds__find_what_two_blocks_have)
{
    static struct fixture f;
    static uint32_t blocks[2][PAIRS_MAX];
    static struct pairs expected;
    static struct pairs first;
    static struct pairs found;
    struct prng random = {17};
    uint64_t pairs = 0;
    for (uint32_t way = 0; way < 24 * WHICH_COUNT; way++) {
        enum which which = (enum which)(way % WHICH_COUNT);
        uint32_t room = ENG_WIDE + prng_u32(&random, ENG_JOIN_MAX - ENG_WIDE + 1);
        fill(&f, &random);
        uint32_t count = make_blocks(&random, which, blocks);
        const uint32_t(*both)[PAIRS_MAX] = (const uint32_t(*)[PAIRS_MAX])blocks;
        join_all(&f, eng_kernels_of(ENG_ISA_SCALAR), which, way / WHICH_COUNT, both,
                 count, 0, NULL, &expected);
        qsort(expected.list, expected.count, sizeof *expected.list, by_number);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            struct pairs *out = isa == ENG_ISA_SCALAR ? &first : &found;
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (!kernels) {
                continue;
            }
            join_all(&f, kernels, which, way / WHICH_COUNT, both, count, room, NULL, out);
            assert_int_equal(out->count, expected.count);
            assert_int_equal(out->tests, expected.tests);
            assert_int_equal(out->apart, expected.apart);
            if (isa != ENG_ISA_SCALAR) { /* in the same order, too */
                assert_memory_equal(out->list, first.list,
                                    first.count * sizeof *first.list);
            }
        }
        qsort(first.list, first.count, sizeof *first.list, by_number);
        assert_memory_equal(first.list, expected.list,
                            expected.count * sizeof *expected.list);
        pairs += expected.count;
    }
    assert_true(pairs > 100000);
    assert_true(2 * 0.05f * (float)f.farthest > 6);
}
