/* test_eng_quantised.c - boxes in whole numbers of 16 bits. */
#include "eng_boxes.h"
#include "wide_cells.h"
#include "world.h"

#define ROUNDS 60u
#define CELL   0x1p-10 /* of the boxes below; their bounds are whole numbers */

struct fixture {
    struct eng_extents boxes[BOXES];
    struct eng_wide_block blocks[BLOCKS];
    struct eng_extents around[BLOCKS];
    struct eng_quantised_block quantised[BLOCKS];
    struct eng_quantised_box quantised_around[BLOCKS];
    uint32_t farthest;
    uint32_t corner[3][BOXES];
};

/* Cells of `cell` around `middle`. */
static struct eng_quantising quantising_around(double cell, double middle)
{
    struct eng_quantising quantising = {{0}, {0}, {0}};
    for (int k = 0; k < 3; k++) {
        eng_wide_quantised_set(&quantising, k, 1 / cell, middle);
    }
    return quantising;
}

static void fill(struct fixture *f, struct prng *random)
{
    struct eng_quantising quantising = quantising_around(CELL, 0);
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    fill_boxes(f->boxes, f->corner, random);
    scalar->box_fold(f->boxes, BLOCKS, false, f->blocks, f->around);
    f->farthest = 0;
    assert_true(scalar->quantised_blocks(
        f->blocks, f->around, BLOCKS, &quantising,
        &(struct eng_quantised_to){f->quantised, f->quantised_around, &f->farthest}));
}

/* ---- the numbers ------------------------------------------------------------------- */

static int32_t below_of(const struct eng_quantised_block *block, uint32_t end,
                        uint32_t axis, uint32_t lane)
{
    return (int16_t)(uint16_t)(block->row[end][axis][lane] & 0xffff);
}

static int32_t above_of(const struct eng_quantised_block *block, uint32_t end,
                        uint32_t axis, uint32_t lane)
{
    return (int16_t)(uint16_t)(block->row[end][axis][lane] >> 16);
}

static void check_sums(const struct eng_wide_block *block,
                       const struct eng_quantised_block *quantised, double cell,
                       double slack)
{
    for (uint32_t i = 0; i < ENG_WIDE * ENG_WIDE * 6; i++) {
        uint32_t end = i % 2;
        uint32_t axis = i / 2 % 3;
        uint32_t a = i / 6 / ENG_WIDE;
        uint32_t b = i / 6 % ENG_WIDE;
        double below = block->row[ENG_LOW0 + end][axis][a];
        double above = block->row[ENG_HIGH0 + end][axis][b];
        double sum = (below + above) / cell;
        int32_t found =
            below_of(quantised, end, axis, a) + above_of(quantised, end, axis, b);
        assert_true(found >= sum && found <= sum + slack);
    }
}

/* If two numbers added up to less than the bounds do, boxes that meet would be taken for
 * apart; if to much more, pairs would be tested for nothing. */
CASE(quantised__numbers_are_no_less_than_the_bounds)
{
    struct prng random = {31};
    for (uint32_t round = 0; round < ROUNDS * ENG_ISA_COUNT; round++) {
        const struct eng_kernels *kernels =
            eng_kernels_of((enum eng_isa)(round % ENG_ISA_COUNT));
        /* Far away the origin itself is rounded, to a 16th of a cell here. */
        double cell = ldexp(1, (int)prng_u32(&random, 60) - 30);
        double middle = round % 3 == 0 ? 0x1p19 * prng_between(&random, -1, 1) : 0;
        struct eng_quantising quantising = quantising_around(cell, middle * cell);
        struct eng_extents boxes[ENG_WIDE];
        struct eng_extents around;
        struct eng_wide_block block;
        struct eng_quantised_block quantised;
        struct eng_quantised_box quantised_around;
        uint32_t before = round % 5 == 0 ? 100000 : 0;
        uint32_t farthest = before;
        int32_t growth = 0;
        if (!kernels) {
            continue;
        }
        for (uint32_t i = 0; i < ENG_WIDE; i++) {
            for (int k = 0; k < 8; k++) {
                double lo = (middle + 30000 * prng_between(&random, -1, 1)) * cell;
                boxes[i].side[ENG_LOW0 + k / 4][k % 4] = (float)-lo;
                boxes[i].side[ENG_HIGH0 + k / 4][k % 4] =
                    (float)(lo + 1000 * cell * prng_between(&random, 0, 1));
            }
        }
        kernels->box_fold(boxes, 1, false, &block, &around);
        assert_true(kernels->quantised_blocks(
            &block, &around, 1, &quantising,
            &(struct eng_quantised_to){&quantised, &quantised_around, &farthest}));
        check_sums(&block, &quantised, cell, 2.125);
        for (uint32_t i = 0; i < 6; i++) {
            int32_t above = INT16_MIN;
            int32_t below = INT16_MIN;
            for (uint32_t lane = 0; lane < ENG_WIDE; lane++) {
                int32_t a = above_of(&quantised, i / 3, i % 3, lane);
                int32_t b = below_of(&quantised, i / 3, i % 3, lane);
                int32_t a_grown = above_of(&quantised, 1, i % 3, lane) - a;
                int32_t b_grown = below_of(&quantised, 1, i % 3, lane) - b;
                growth = a_grown > growth ? a_grown : growth;
                growth = b_grown > growth ? b_grown : growth;
                above = a > above ? a : above;
                below = b > below ? b : below;
            }
            assert_int_equal(quantised_around.half[i / 3][2 * (i % 3)], above);
            assert_int_equal(quantised_around.half[i / 3][2 * (i % 3) + 1], below);
        }
        assert_true(growth > 0);
        assert_int_equal(farthest, (uint32_t)growth > before ? (uint32_t)growth : before);
    }
}

/* If a number that does not fit were used, a box would be on the other side of the
 * scene. */
CASE(quantised__says_what_is_beyond_its_reach)
{
    struct eng_quantising quantising = quantising_around(1, 0);
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        for (uint32_t i = 0; kernels && i < 12; i++) {
            struct fixture f = {0};
            bool fits;
            float *bound = &f.boxes[17].side[i % 4][i / 4];
            kernels->box_fold(f.boxes, BLOCKS, false, f.blocks, f.around);
            *bound = ENG_QUANTISED_REACH + 1;
            kernels->box_fold(f.boxes, BLOCKS, false, f.blocks, f.around);
            fits = kernels->quantised_blocks(
                f.blocks, f.around, BLOCKS, &quantising,
                &(struct eng_quantised_to){f.quantised, f.quantised_around, &f.farthest});
            assert_false(fits);
            *bound = 0x1p60f;
            kernels->box_fold(f.boxes, BLOCKS, false, f.blocks, f.around);
            fits = kernels->quantised_blocks(
                f.blocks, f.around, BLOCKS, &quantising,
                &(struct eng_quantised_to){f.quantised, f.quantised_around, &f.farthest});
            assert_false(fits);
            *bound = ENG_QUANTISED_REACH - 2;
            set_nowhere(&f.boxes[18]);
            kernels->box_fold(f.boxes, BLOCKS, false, f.blocks, f.around);
            fits = kernels->quantised_blocks(
                f.blocks, f.around, BLOCKS, &quantising,
                &(struct eng_quantised_to){f.quantised, f.quantised_around, &f.farthest});
            assert_true(fits);
            assert_int_equal(below_of(&f.quantised[1], i % 2, i / 4, 2), INT16_MIN);
            assert_int_equal(above_of(&f.quantised[1], i % 2, i / 4, 2), INT16_MIN);
        }
    }
}

/* ---- joins ------------------------------------------------------------------------- */

enum which { FACES, EDGES, NODES, WHICH_COUNT };

static void join(const struct eng_kernels *kernels, const struct fixture *f,
                 enum which which, bool is_quantised, uint32_t m, struct eng_join *job,
                 struct lists *out)
{
    job->a = job->b = f->blocks;
    job->b_boxes = f->around;
    job->a_quantised = job->b_quantised = is_quantised ? f->quantised : NULL;
    job->b_quantised_boxes = is_quantised ? f->quantised_around : NULL;
    job->farthest = f->farthest;
    for (int k = 0; k < 3; k++) {
        job->a_corner[k] = f->corner[k];
        job->b_corner[k] = f->corner[k];
    }
    join_two(which == NODES   ? kernels->join_nodes
             : which == EDGES ? kernels->join_features[PCCD_EE]
                              : kernels->join_features[PCCD_VF],
             job, 0, m, out);
}

/* Bounds that are whole numbers of cells, far more than the numbers are off by: if the
 * pairs were not the same as those of the boxes themselves, some would be lost, or
 * features that share a vertex would collide. */
CASE(quantised__joins_find_the_same_pairs)
{
    static struct fixture f;
    static struct lists expected;
    static struct lists found;
    struct prng random = {32};
    uint64_t pairs = 0;
    uint64_t apart = 0;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        fill(&f, &random);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            for (uint32_t way = 0; kernels && way < 2 * WHICH_COUNT; way++) {
                const enum which which = way % WHICH_COUNT;
                struct eng_join job = {.t_end = 1, .in_time = way / WHICH_COUNT == 1};
                struct eng_join quantised = job;
                join(kernels, &f, which, false, round % 3, &job, &expected);
                join(kernels, &f, which, true, round % 3, &quantised, &found);
                assert_same_lists(&found, &expected);
                assert_int_equal(quantised.tests, job.tests);
                pairs += found.count;
                apart += quantised.apart_in_time;
            }
        }
    }
    assert_true(pairs > 1000 && apart > 1000);
}

/* Boxes of up to eight cells, or as many times more, anywhere between them. */
static void fill_by_cells(struct fixture *f, struct prng *random, double cells)
{
    const struct eng_quantising quantising = quantising_around(CELL, 0);
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    for (uint32_t i = 0; i < BOXES * 6; i++) {
        double lo = 15 * cells * prng_between(random, -1, 1);
        double size = 8 * cells * prng_between(random, 0, 1);
        struct eng_extents *box = &f->boxes[i / 6];
        box->side[ENG_LOW0 + i % 2][i / 2 % 3] = (float)(CELL * -lo);
        box->side[ENG_HIGH0 + i % 2][i / 2 % 3] = (float)(CELL * (lo + size));
        f->corner[i / 2 % 3][i / 6] = i;
    }
    scalar->box_fold(f->boxes, BLOCKS, false, f->blocks, f->around);
    assert_true(scalar->quantised_blocks(
        f->blocks, f->around, BLOCKS, &quantising,
        &(struct eng_quantised_to){f->quantised, f->quantised_around, &f->farthest}));
}

/* If a pair that meets at some time were left out because its numbers are off by a cell,
 * or a sum of two does not fit 16 bits, its contact would be missed; if none were, the
 * filter would do the work. */
CASE(quantised__times_hold_those_of_the_boxes)
{
    static struct fixture f;
    static struct lists all;
    static struct lists kept;
    struct prng random = {34};
    uint64_t gone = 0;
    for (uint32_t round = 0; round < ROUNDS * ENG_ISA_COUNT; round++) {
        const struct eng_kernels *kernels =
            eng_kernels_of((enum eng_isa)(round % ENG_ISA_COUNT));
        struct eng_join job = {.t_end = 1};
        struct eng_join timed = {.t_end = 1, .in_time = true};
        const enum which which = round % 2 == 0 ? EDGES : NODES;
        uint32_t at = 0;
        if (!kernels) {
            continue;
        }
        fill_by_cells(&f, &random, round / ENG_ISA_COUNT % 2 == 0 ? 1 : 1400);
        join(kernels, &f, which, true, round % 3, &job, &all);
        join(kernels, &f, which, true, round % 3, &timed, &kept);
        for (uint32_t i = 0; i < all.count; i++) {
            bool is_kept =
                at < kept.count && kept.a[at] == all.a[i] && kept.b[at] == all.b[i];
            assert_true(is_kept ||
                        !meet_in_time(&f.boxes[all.a[i]], &f.boxes[all.b[i]], 0));
            at += is_kept;
        }
        assert_int_equal(at, kept.count);
        gone += timed.apart_in_time;
    }
    assert_true(gone > 1000);
}

/* The most that the boxes are apart, in cells, along an axis on which they are at both
 * ends of 0 .. t; `around`: along one on which all that they cover until then is. Of
 * whole numbers and a t of few bits: exact. */
static double gap_until(const struct eng_extents *a, const struct eng_extents *b,
                        double t, bool around)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        for (int way = 0; way < 2; way++) {
            const struct eng_extents *low = way ? b : a;
            const struct eng_extents *high = way ? a : b;
            double low0 = low->side[ENG_LOW0][k];
            double high0 = high->side[ENG_HIGH0][k];
            double low1 = (1 - t) * low0 + t * (double)low->side[ENG_LOW1][k];
            double high1 = (1 - t) * high0 + t * (double)high->side[ENG_HIGH1][k];
            double gap = around ? -(fmax(low0, low1) + fmax(high0, high1))
                                : fmin(-(low0 + high0), -(low1 + high1));
            most = fmax(most, gap / CELL);
        }
    }
    return most;
}

/* Pairs may only be gone if they are apart, and only be left if they hardly are. */
static void check_until(const struct fixture *f, const struct lists *all,
                        const struct lists *found, double t, bool around, uint64_t *gone)
{
    uint32_t at = 0;
    for (uint32_t i = 0; i < all->count; i++) {
        bool is_found =
            at < found->count && found->a[at] == all->a[i] && found->b[at] == all->b[i];
        double gap = gap_until(&f->boxes[all->a[i]], &f->boxes[all->b[i]], t, around);
        assert_true(is_found ? gap <= 2 * 8 : gap > 0);
        at += is_found;
        *gone += !is_found;
    }
    assert_int_equal(at, found->count);
}

/* All pairs that no vertex excludes, in the order of a join. */
static void all_pairs(const struct fixture *f, enum which which, uint32_t m,
                      struct lists *all)
{
    static struct fixture meet;
    struct eng_join job = {.t_end = 1};
    meet = *f;
    memset(meet.boxes, 0, sizeof meet.boxes);
    eng_kernels_of(ENG_ISA_SCALAR)
        ->box_fold(meet.boxes, BLOCKS, false, meet.blocks, meet.around);
    join(eng_kernels_of(ENG_ISA_SCALAR), &meet, which, false, m, &job, all);
}

/* If a pair that meets before the bound were left out, mode first would miss the first
 * contact; if the sets differed, so would the counters of two machines. */
CASE(quantised__joins_go_up_to_a_time)
{
    static struct fixture f;
    static struct lists all;
    static struct lists expected;
    static struct lists found;
    struct prng random = {33};
    enum { UNTIL, AROUND, FROM_BEGIN, WAYS };
    uint64_t gone[WAYS] = {0};
    for (uint32_t round = 0; round < 10 * ROUNDS; round++) {
        bool around = round % 2 == 1;
        /* Every other near time is so near that boxes of t = 0 are compared. */
        int exponent = round / 4 % 2 == 1 && around ? -20 : -8;
        double t = ldexp((double)prng_u32(&random, around ? 17 : 256), exponent);
        const enum which which = round / 2 % WHICH_COUNT;
        uint32_t m = round % 3;
        fill(&f, &random);
        all_pairs(&f, which, m, &all);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            struct eng_join job = {.t_end = (float)t,
                                   .boxes = around ? ENG_JOIN_NEAR : ENG_JOIN_MOVING};
            if (!kernels) {
                continue;
            }
            join(kernels, &f, which, true, m, &job, isa == 0 ? &expected : &found);
            if (isa > 0) {
                assert_same_lists(&found, &expected);
            }
        }
        bool from_begin = around && 2 * t * f.farthest < 6; /* ENG_QUANTISED_GROWTH_MAX */
        check_until(&f, &all, &expected, t, around,
                    &gone[!around      ? UNTIL
                          : from_begin ? FROM_BEGIN
                                       : AROUND]);
    }
    assert_true(gone[UNTIL] > 10000 && gone[AROUND] > 10000 && gone[FROM_BEGIN] > 5000);
}

/* Two boxes of one cell's side, `gap` cells apart along an axis at t = 0, which move at
 * each other by `way` cells each. */
static void set_approaching(struct fixture *f, int axis, double gap, double way)
{
    for (uint32_t i = 0; i < BOXES; i++) {
        set_nowhere(&f->boxes[i]);
        f->corner[0][i] = 2 * i;
        f->corner[1][i] = 2 * i + 1;
    }
    for (uint32_t i = 0; i < 2; i++) {
        struct eng_extents *box = &f->boxes[i * ENG_WIDE + 3 * i];
        memset(box, 0, sizeof *box);
        for (int side = 0; side < ENG_SIDES; side++) {
            double low = i == 0 ? 0 : gap + 1;
            low += side % 2 == 0 ? 0 : i == 0 ? way : -way;
            box->side[side][axis] = (float)(CELL * (side < ENG_HIGH0 ? -low : low + 1));
        }
    }
    eng_kernels_of(ENG_ISA_SCALAR)
        ->box_fold(f->boxes, BLOCKS, false, f->blocks, f->around);
}

/* If what boxes grow by were left out of the comparison of those of t = 0, mode first
 * would miss what comes within the next cells. */
CASE(quantised__boxes_as_they_begin_reach_the_near_time)
{
    static struct fixture f;
    static struct lists found;
    const struct eng_quantising quantising = quantising_around(CELL, 0);
    const double t = 0x1p-11;
    for (uint32_t i = 0; i < ENG_ISA_COUNT * 3 * 2; i++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)(i / 6));
        bool do_meet = i % 2 == 0;
        double way = 2.5 / t; /* 5 cells together until then */
        struct eng_join job = {.t_end = (float)t, .boxes = ENG_JOIN_NEAR};
        if (!kernels) {
            continue;
        }
        set_approaching(&f, (int)(i / 2 % 3), do_meet ? 5 : 20, way);
        f.farthest = 0;
        assert_true(kernels->quantised_blocks(
            f.blocks, f.around, BLOCKS, &quantising,
            &(struct eng_quantised_to){f.quantised, f.quantised_around, &f.farthest}));
        assert_int_equal(f.farthest, way);
        join(kernels, &f, EDGES, true, 1, &job, &found);
        assert_int_equal(found.count, do_meet);
    }
}

/* ---- a scene ----------------------------------------------------------------------- */

#define SIDE     12u
#define VERTICES ((SIDE + 1) * (SIDE + 1))

#define SMALL          1u
#define SMALL_VERTICES ((SMALL + 1) * (SMALL + 1))

#define FINE          60u
#define FINE_VERTICES ((FINE + 1) * (FINE + 1))

/* A sheet by its numbers: shaken, and moved along x at the end. */
static void stage(struct eng_scene *scene, const uint32_t objects[2], struct prng *random,
                  double moved)
{
    static double x1[VERTICES][3];
    eng_stage_begin(scene);
    for (uint32_t i = 0; i < 2; i++) {
        const struct eng_object *object = eng_scene_object(scene, objects[i]);
        for (uint32_t k = 0; k < 3 * VERTICES; k++) {
            x1[k / 3][k % 3] = object->mesh->x[k / 3][k % 3] +
                               prng_between(random, -0.1, 0.1) + (k % 3 == 0 ? moved : 0);
        }
        assert_ok(eng_stage_x1(scene, objects[i], PCCD_FORMAT_F64, 0, VERTICES, x1));
    }
}

static struct eng_step_result step(struct eng_scene *scene, enum pccd_method method,
                                   uint32_t threads)
{
    struct eng_question settings = ENG_QUESTION_DEFAULT;
    settings.threads = threads;
    settings.team_always = true;
    settings.mode = PCCD_MODE_ALL;
    settings.method = method;
    struct eng_step_result result = kit_step(scene, &settings);
    return result;
}

/* Take steps of two sheets that jump ahead; returns how many used them. */
static uint32_t go(uint32_t threads, const double *moved, uint32_t steps)
{
    struct eng_scene *scenes[2];
    uint32_t objects[2][2];
    uint32_t uses = 0;
    for (uint32_t i = 0; i < 2; i++) {
        scenes[i] = kit_scene();
        for (uint32_t k = 0; k < 2; k++) {
            objects[i][k] = kit_add(scenes[i], kit_sheet(SIDE, 0.05 * k), k + 1);
        }
    }
    for (uint32_t i = 0; i < steps; i++) {
        struct prng random[2] = {{i}, {i}};
        const struct eng_wide *wide = eng_wide_of(scenes[0]);
        stage(scenes[0], objects[0], &random[0], moved[i]);
        stage(scenes[1], objects[1], &random[1], moved[i]);
        struct eng_step_result found = step(scenes[0], PCCD_METHOD_WIDE, threads);
        struct eng_step_result expected = step(scenes[1], PCCD_METHOD_PAPER, 1);
        assert_true(found.count > 100);
        assert_int_equal(found.count, expected.count);
        assert_int_equal(found.hash[0], expected.hash[0]);
        assert_int_equal(found.hash[1], expected.hash[1]);
        uses += wide->has_quantised;
    }
    eng_scene_free(scenes[0]);
    eng_scene_free(scenes[1]);
    return uses;
}

/* If a scene never took to them, or left them where it goes farther than before, they
 * would be of no use; if their cells were not laid by where it goes, contacts would be
 * missed. */
CASE(quantised__are_laid_by_where_a_step_goes)
{
    static const double moved[] = {0, 0, 40, 40, 0, 4e4, 4e4, 0, 0};
    const uint32_t steps = sizeof moved / sizeof moved[0];
    for (uint32_t threads = 1; threads <= 4; threads++) {
        assert_int_equal(go(threads, moved, steps), steps);
    }
}

/* Two small sheets of a size, at a place along x and y, shaken by their numbers; both or,
 * where `little`, a vertex of one. */
static void stage_small(struct eng_scene *scene, double size, double place, bool little,
                        struct prng *random)
{
    double x1[SMALL_VERTICES][3];
    eng_stage_begin(scene);
    for (uint32_t i = 0; i < (little ? 1 : 2); i++) {
        const struct eng_object *object = eng_scene_object(scene, i);
        for (uint32_t k = 0; k < 3 * SMALL_VERTICES; k++) {
            double x = object->mesh->x[k / 3][k % 3] + prng_between(random, -0.1, 0.1);
            x = x * size + (k % 3 < 2 ? place : 0);
            x1[k / 3][k % 3] = fmax(fmin(x, 1e18), -1e18);
        }
        assert_ok(
            eng_stage_x1(scene, i, PCCD_FORMAT_F64, 0, little ? 1 : SMALL_VERTICES, x1));
    }
}

/* Steps there, to the other side of the origin, and of hardly anything; returns how many
 * used quantised boxes. */
static uint32_t go_far(double size, double place, double separation)
{
    static const double sides[] = {1, 1, 1, -1, -1, -1};
    uint32_t uses = 0;
    struct eng_scene *scenes[2] = {kit_scene(), kit_scene()};
    for (uint32_t i = 0; i < 4; i++) {
        assert_int_equal(
            kit_add(scenes[i / 2], kit_sheet(SMALL, 0.05 * (i % 2)), i % 2 + 1), i % 2);
    }
    for (uint32_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        struct eng_step_result results[2];
        for (uint32_t k = 0; k < 2; k++) {
            struct prng random = {i};
            struct eng_question settings = ENG_QUESTION_DEFAULT;
            settings.distance = separation;
            settings.method = k == 0 ? PCCD_METHOD_WIDE : PCCD_METHOD_PAPER;
            stage_small(scenes[k], size, sides[i] * place, i % 3 == 2, &random);
            results[k] = kit_step(scenes[k], &settings);
        }
        assert_int_equal(results[0].count, results[1].count);
        assert_int_equal(results[0].hash[0], results[1].hash[0]);
        uses += eng_wide_of(scenes[0])->has_quantised;
    }
    eng_scene_free(scenes[0]);
    eng_scene_free(scenes[1]);
    return uses;
}

/* If what any step reaches were not within their numbers, it would end the daemon. */
CASE(quantised__hold_whatever_a_scene_may_be)
{
    static const double sizes[] = {0x1p-1000, 1, 5e17};
    static const double places[] = {0, 1, 1e18};
    uint32_t uses = 0;
    for (uint32_t i = 0; i < 3 * 3 * 3; i++) {
        double size = sizes[i / 9];
        double separations[] = {0, 0.04 * size, 1e18};
        uses += go_far(size, places[i / 3 % 3], separations[i % 3]);
    }
    assert_true(uses >= 50);
}

/* Above a ground of two large triangles a fine sheet of many small ones rises. */
static struct eng_step_result rise(enum pccd_method method)
{
    static const double corners[4][3] = {
        {-999, -999, -1}, {999, -999, -1}, {999, 999, -1}, {-999, 999, -1}};
    static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};
    static double x1[FINE_VERTICES][3];
    struct eng_step_result result;
    uint32_t object;
    struct eng_mesh *ground = kit_mesh(corners, 4, halves, 2);
    struct eng_mesh *sheet = kit_sheet(FINE, 0);
    struct eng_scene *scene = kit_scene();
    assert_ok(eng_scene_add(scene, ground, 1, &object));
    assert_ok(eng_scene_add(scene, sheet, 2, &object));
    for (uint32_t i = 1; i <= 3; i++) {
        for (uint32_t k = 0; k < 3 * FINE_VERTICES; k++) {
            x1[k / 3][k % 3] = sheet->x[k / 3][k % 3] + (k % 3 == 2 ? 0.01 * i : 0);
        }
        eng_stage_begin(scene);
        assert_ok(eng_stage_x1(scene, object, PCCD_FORMAT_F64, 0, FINE_VERTICES, x1));
        result = step(scene, method, 1);
    }
    eng_scene_free(scene);
    eng_mesh_release(ground);
    eng_mesh_release(sheet);
    return result;
}

/* If it failed, a large triangle would make the cells of the whole scene large, and in
 * them each feature of what is fine would meet hundreds of others. */
CASE(quantised__is_left_where_only_little_is_large)
{
    struct eng_step_result found = rise(PCCD_METHOD_WIDE);
    struct eng_step_result expected = rise(PCCD_METHOD_PAPER);
    for (int kind = PCCD_VF; kind <= PCCD_EE; kind++) {
        assert_true(expected.counters.candidates[kind] > FINE_VERTICES);
        assert_true((double)found.counters.candidates[kind] <=
                    1.02 * (double)expected.counters.candidates[kind]);
    }
}
