/* test_eng_boxes.c - the box kernels of every instruction set. */
#include "aabb.h"
#include "eng_boxes.h"

#define ROUNDS  40u
#define NOT_SET 0xdeadbeefu

/* A bound of no box here. */
#define UNTOUCHED 12345.0f

struct fixture {
    struct eng_extents boxes[BOXES];
    struct eng_wide_block blocks[BLOCKS];
    struct eng_extents around[BLOCKS];
    uint32_t corner[3][BOXES];
};

/* A box as other code keeps it. */
static struct eng_box plain(const struct eng_extents *box)
{
    struct eng_box out;
    memset(&out, 0, sizeof out);
    for (int k = 0; k < 3; k++) {
        out.lo0[k] = -box->side[ENG_LOW0][k];
        out.lo1[k] = -box->side[ENG_LOW1][k];
        out.hi0[k] = box->side[ENG_HIGH0][k];
        out.hi1[k] = box->side[ENG_HIGH1][k];
    }
    return out;
}

static void fill(struct fixture *f, struct prng *random)
{
    fill_boxes(f->boxes, f->corner, random);
    eng_kernels_of(ENG_ISA_SCALAR)
        ->box_fold(f->boxes, BLOCKS, false, f->blocks, f->around);
}

/* If a box were rounded inward by one set, it would miss contacts; outward by more, mode
 * pairs would name other pairs than the method paper; with a negative zero in it, boxes
 * that touch would be taken for ones that are apart. */
CASE(boxes__of_points_are_rounded_as_everywhere)
{
    struct prng random = {11};
    for (uint32_t round = 0; round < ROUNDS * 50; round++) {
        struct eng_point point = {.word0 = 1, .word1 = UINT64_MAX};
        double scale = ldexp(1, (int)prng_u32(&random, 160) - 100);
        for (int k = 0; k < 3; k++) {
            point.x0[k] = scale * prng_between(&random, -1, 1);
            point.x1[k] = round % 3 ? (double)(float)(scale * prng_integer(&random, 9))
                                    : 1e18 * prng_integer(&random, 1);
        }
        struct eng_box expected;
        eng_box_of_point(&expected, NULL, point.x0, point.x1);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            struct eng_extents box;
            if (!kernels) {
                continue;
            }
            kernels->box_points(&point, 1, NULL, false, &box);
            struct eng_box found = plain(&box);
            for (int k = 0; k < 3; k++) { /* as numbers: -0 is 0 */
                assert_true(found.lo0[k] == expected.lo0[k]);
                assert_true(found.hi0[k] == expected.hi0[k]);
                assert_true(found.lo1[k] == expected.lo1[k]);
                assert_true(found.hi1[k] == expected.hi1[k]);
            }
            for (int side = 0; side < ENG_SIDES; side++) {
                for (int k = 0; k < 3; k++) {
                    assert_true(box.side[side][k] != 0 || !signbit(box.side[side][k]));
                }
            }
            kernels->box_points(&point, 1, NULL, true, &box);
            found = plain(&box);
            for (int k = 0; k < 3; k++) {
                assert_true(found.lo0[k] == fminf(expected.lo0[k], expected.lo1[k]));
                assert_true(found.hi1[k] == fmaxf(expected.hi0[k], expected.hi1[k]));
                assert_true(found.lo1[k] == found.lo0[k] && found.hi0[k] == found.hi1[k]);
            }
        }
    }
}

static void leave_untouched(struct eng_wide_block *blocks)
{
    for (uint32_t i = 0; i < 12 * BOXES; i++) {
        blocks[i / 12 / ENG_WIDE].row[i % 4][i / 4 % 3][i / 12 % ENG_WIDE] = UNTOUCHED;
    }
}

/* If a row were in another lane, or a union too small, a pair would be lost. */
CASE(boxes__go_into_blocks_and_unions)
{
    static struct fixture f;
    static struct eng_wide_block blocks[BLOCKS];
    struct eng_extents around[BLOCKS];
    struct prng random = {12};
    fill(&f, &random);
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        for (uint32_t way = 0; kernels && way < 6; way++) {
            const uint32_t arity = 1 + way % 3;
            const bool swept = way >= 3;
            const uint32_t *const corner[3] = {f.corner[0], f.corner[1],
                                               arity == 3 ? f.corner[2] : NULL};
            leave_untouched(blocks);
            if (arity == 1) {
                kernels->box_fold(f.boxes, BLOCKS, swept, blocks, around);
            } else {
                kernels->box_unite(f.boxes, corner, BLOCKS, swept, blocks, around);
            }
            for (uint32_t i = 0; i < 12 * BOXES; i++) {
                uint32_t box = i / 12;
                uint32_t side = i % 4;
                uint32_t axis = i / 4 % 3;
                float most = -INFINITY;
                for (uint32_t k = 0; k < arity; k++) {
                    uint32_t from = arity == 1 ? box : f.corner[k][box];
                    most = fmaxf(most, f.boxes[from].side[side][axis]);
                }
                float found = blocks[box / ENG_WIDE].row[side][axis][box % ENG_WIDE];
                bool is_left = swept && (side == ENG_LOW1 || side == ENG_HIGH1);
                assert_true(found == (is_left ? UNTOUCHED : most));
                assert_true(around[box / ENG_WIDE].side[side][axis] >= most);
            }
            for (uint32_t i = 0; i < BLOCKS; i++) { /* no larger than need be */
                for (int axis = 0; axis < 3; axis++) {
                    const float *row = blocks[i].row[ENG_HIGH0][axis];
                    float most = row[0];
                    for (uint32_t lane = 1; lane < ENG_WIDE; lane++) {
                        most = fmaxf(most, row[lane]);
                    }
                    assert_true(around[i].side[ENG_HIGH0][axis] == most);
                }
            }
        }
    }
}

enum which { NODES, EDGES, FACES };

/* Returns how many pairs were left out for their times. */
static uint64_t run_job(const struct eng_kernels *kernels, struct fixture *f,
                        enum which which, uint32_t n, uint32_t m,
                        enum eng_join_boxes boxes, float t_end, bool in_time,
                        struct lists *out)
{
    struct eng_join job = {.a = f->blocks,
                           .b = f->blocks,
                           .b_boxes = f->around,
                           .b_corner = {f->corner[0], f->corner[1], f->corner[2]},
                           .boxes = boxes,
                           .t_end = t_end,
                           .in_time = in_time};
    for (uint32_t i = 0; i < ENG_JOIN_MAX; i++) {
        out->a[i] = out->b[i] = NOT_SET;
    }
    if (which == NODES) {
        join_two(kernels->join_nodes, &job, n, m, out);
    } else if (which == EDGES) {
        job.a_corner[0] = f->corner[0];
        job.a_corner[1] = f->corner[1];
        join_two(kernels->join_features[PCCD_EE], &job, n, m, out);
    } else {
        join_two(kernels->join_features[PCCD_VF], &job, n, m, out);
    }
    assert_in_range(job.tests, 1, 1 + ENG_WIDE);
    return job.apart_in_time;
}

static void run(const struct eng_kernels *kernels, struct fixture *f, enum which which,
                uint32_t n, uint32_t m, float t_end, struct lists *out)
{
    run_job(kernels, f, which, n, m, ENG_JOIN_MOVING, t_end, false, out);
}

/* Return whether the pair is wanted, whatever the boxes. */
static bool is_wanted(const struct fixture *f, enum which which, bool self, uint32_t a,
                      uint32_t b)
{
    if (which == NODES) {
        return !self || a <= b;
    }
    bool shares = false;
    for (int k = 0; k < (which == FACES ? 3 : 2); k++) {
        shares |= which == FACES ? f->corner[k][b] == a
                                 : f->corner[0][a] == f->corner[k][b] ||
                                       f->corner[1][a] == f->corner[k][b];
    }
    return !shares && (which == FACES || !self || a < b);
}

/* If a pair of touching boxes were missing a contact would be; if one were there twice,
 * or shared a vertex, the answer would be another. */
CASE(boxes__of_two_blocks_are_joined_as_one_by_one)
{
    static struct fixture f;
    static struct lists out;
    struct prng random = {13};
    uint64_t pairs = 0;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        fill(&f, &random);
        uint32_t n = prng_u32(&random, BLOCKS);
        uint32_t m = round % 2 ? n : prng_u32(&random, BLOCKS);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            for (enum which which = NODES; kernels && which <= FACES; which++) {
                uint32_t count = 0;
                run(kernels, &f, which, n, m, 1, &out);
                for (uint32_t i = 0; i < ENG_JOIN_MAX; i++) {
                    uint32_t a = n * ENG_WIDE + i / ENG_WIDE;
                    uint32_t b = m * ENG_WIDE + i % ENG_WIDE;
                    struct eng_box box_a = plain(&f.boxes[a]);
                    struct eng_box box_b = plain(&f.boxes[b]);
                    if (is_wanted(&f, which, n == m, a, b) &&
                        eng_box_overlap(&box_a, &box_b)) {
                        assert_int_equal(out.a[count], a);
                        assert_int_equal(out.b[count], b);
                        count++;
                    }
                }
                assert_int_equal(out.count, count);
                pairs += count;
            }
        }
    }
    assert_true(pairs > 1000);
}

/* Certainly apart up to t_end along some axis: decided without rounding, for the bounds
 * are small integers and t_end is a multiple of 2^-8. */
static bool is_apart_until(const struct eng_box *a, const struct eng_box *b, double t)
{
    for (int k = 0; k < 3; k++) {
        double up0 = (double)a->lo0[k] - (double)b->hi0[k];
        double up1 = (double)a->lo1[k] - (double)b->hi1[k];
        double down0 = (double)b->lo0[k] - (double)a->hi0[k];
        double down1 = (double)b->lo1[k] - (double)a->hi1[k];
        if ((up0 > 0 && (1 - t) * up0 + t * up1 > 0) ||
            (down0 > 0 && (1 - t) * down0 + t * down1 > 0)) {
            return true;
        }
    }
    return false;
}

/* If a pair that meets before the bound were left out, mode first would miss the first
 * contact; if the sets differed, so would the counters of two machines. */
CASE(boxes__are_joined_up_to_a_time)
{
    static struct fixture f;
    static struct lists whole;
    static struct lists expected;
    static struct lists out;
    struct prng random = {14};
    uint64_t left_out = 0;
    uint64_t apart = 0;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        fill(&f, &random);
        double t = ldexp((double)prng_u32(&random, 256), -8);
        enum which which = (enum which)(round % 3);
        run(eng_kernels_of(ENG_ISA_SCALAR), &f, which, 0, round % 2, 1, &whole);
        run(eng_kernels_of(ENG_ISA_SCALAR), &f, which, 0, round % 2, (float)t, &expected);
        uint32_t kept = 0;
        for (uint32_t i = 0; i < whole.count; i++) {
            struct eng_box a = plain(&f.boxes[whole.a[i]]);
            struct eng_box b = plain(&f.boxes[whole.b[i]]);
            bool is_kept = kept < expected.count && expected.a[kept] == whole.a[i] &&
                           expected.b[kept] == whole.b[i];
            kept += is_kept;
            left_out += !is_kept;
            apart += is_apart_until(&a, &b, t);
            assert_true(is_kept || is_apart_until(&a, &b, t));
        }
        assert_int_equal(kept, expected.count);
        for (int isa = 1; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            if (kernels) {
                run(kernels, &f, which, 0, round % 2, (float)t, &out);
                assert_same_lists(&out, &expected);
            }
        }
    }
    assert_true(left_out > 100 && left_out >= apart * 9 / 10);
}

/* Counts of pairs whose boxes meet in the step: those that are certainly apart up to t,
 * and those that the join leaves out, which must be some of them. */
struct left_out {
    uint64_t apart;
    uint64_t near;
};

static void compare_near(struct fixture *f, enum which which, uint32_t m, double t,
                         struct left_out *left_out)
{
    static struct lists whole;
    static struct lists moving;
    static struct lists expected;
    static struct lists out;
    const struct eng_kernels *scalar = eng_kernels_of(ENG_ISA_SCALAR);
    uint32_t at_moving = 0;
    uint32_t at = 0;
    run(scalar, f, which, 0, m, 1, &whole);
    run(scalar, f, which, 0, m, (float)t, &moving);
    run_job(scalar, f, which, 0, m, ENG_JOIN_NEAR, (float)t, false, &expected);
    for (uint32_t i = 0; i < whole.count; i++) {
        struct eng_box a = plain(&f->boxes[whole.a[i]]);
        struct eng_box b = plain(&f->boxes[whole.b[i]]);
        bool is_moving = at_moving < moving.count && moving.a[at_moving] == whole.a[i] &&
                         moving.b[at_moving] == whole.b[i];
        while (at < expected.count &&
               (expected.a[at] < whole.a[i] ||
                (expected.a[at] == whole.a[i] && expected.b[at] < whole.b[i]))) {
            at++; /* apart in the step, but what they cover is not */
        }
        bool is_kept = at < expected.count && expected.a[at] == whole.a[i] &&
                       expected.b[at] == whole.b[i];
        assert_true(is_kept || (is_apart_until(&a, &b, t) && !is_moving));
        at_moving += is_moving;
        left_out->apart += is_apart_until(&a, &b, t);
        left_out->near += !is_kept;
    }
    for (int isa = 1; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels) {
            run_job(kernels, f, which, 0, m, ENG_JOIN_NEAR, (float)t, false, &out);
            assert_same_lists(&out, &expected);
        }
    }
}

/* If a pair that meets before a bound that is near were left out, mode first would miss
 * the first contact; if few were left out, it would test the rest for nothing. */
CASE(boxes__are_joined_up_to_a_time_that_is_near)
{
    static struct fixture f;
    struct prng random = {15};
    struct left_out left_out[2] = {{0}};
    for (uint32_t round = 0; round < 10 * ROUNDS; round++) {
        fill(&f, &random);
        bool is_near = round % 4 != 0;
        double t = ldexp((double)prng_u32(&random, is_near ? 16 : 256), -8);
        compare_near(&f, (enum which)(round % 3), round % 2, t, &left_out[is_near]);
    }
    for (int i = 0; i < 2; i++) {
        assert_true(left_out[i].near > 100);
    }
    assert_true(left_out[1].near >= left_out[1].apart / 2);
}

/* If they were compared otherwise, the pairs beside other libraries' would be others. */
CASE(boxes__that_stand_still_are_joined_as_those_that_move)
{
    static struct fixture f;
    static struct lists moving;
    static struct lists swept;
    struct prng random = {16};
    uint64_t pairs = 0;
    for (uint32_t round = 0; round < ROUNDS; round++) {
        fill(&f, &random);
        for (uint32_t i = 0; i < BOXES; i++) {
            memcpy(f.boxes[i].side[ENG_LOW1], f.boxes[i].side[ENG_LOW0],
                   sizeof f.boxes[i].side[0]);
            memcpy(f.boxes[i].side[ENG_HIGH1], f.boxes[i].side[ENG_HIGH0],
                   sizeof f.boxes[i].side[0]);
        }
        eng_kernels()->box_fold(f.boxes, BLOCKS, false, f.blocks, f.around);
        for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
            const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
            for (enum which which = NODES; kernels && which <= FACES; which++) {
                run(kernels, &f, which, round % 3, round % 2, 1, &moving);
                run_job(kernels, &f, which, round % 3, round % 2, ENG_JOIN_SWEPT, 1,
                        false, &swept);
                assert_same_lists(&swept, &moving);
                pairs += swept.count;
            }
        }
    }
    assert_true(pairs > 1000);
}

/* One join of blocks with a look at times and one without: the pairs that are gone are
 * those that no time brings together. Returns how many, and those that are left. */
static uint64_t compare_in_time(const struct eng_kernels *kernels, struct fixture *f,
                                enum which which, uint32_t n, uint32_t m, uint64_t *met)
{
    static struct lists all;
    static struct lists kept;
    uint64_t apart;
    uint32_t at = 0;
    run(kernels, f, which, n, m, 1, &all);
    apart = run_job(kernels, f, which, n, m, ENG_JOIN_MOVING, 1, true, &kept);
    for (uint32_t i = 0; i < all.count; i++) {
        const struct eng_extents *a = &f->boxes[all.a[i]];
        const struct eng_extents *b = &f->boxes[all.b[i]];
        bool is_kept =
            at < kept.count && kept.a[at] == all.a[i] && kept.b[at] == all.b[i];
        assert_true(is_kept ? meet_in_time(a, b, 1e-5) : !meet_in_time(a, b, 0));
        at += is_kept;
    }
    assert_int_equal(at, kept.count);
    assert_int_equal(apart, all.count - kept.count);
    *met += kept.count;
    return apart;
}

/* If a pair that meets at some time were left out, its contact would be missed; if hardly
 * any were left out, the filter would do the work again. */
CASE(boxes__that_no_time_brings_together_are_left_out)
{
    static struct fixture f;
    struct prng random = {91};
    uint64_t left_out[FACES + 1] = {0};
    uint64_t met[FACES + 1] = {0};
    for (uint32_t round = 0; round < ROUNDS * BLOCKS * ENG_ISA_COUNT; round++) {
        uint32_t n = round % BLOCKS;
        uint32_t m = round / 7 % BLOCKS;
        const struct eng_kernels *kernels =
            eng_kernels_of((enum eng_isa)(round / BLOCKS % ENG_ISA_COUNT));
        if (!kernels) {
            continue;
        }
        fill(&f, &random);
        for (enum which which = NODES; which <= FACES; which++) {
            left_out[which] += compare_in_time(kernels, &f, which, n, m, &met[which]);
        }
    }
    for (enum which which = NODES; which <= FACES; which++) {
        assert_true(left_out[which] > 1000 && met[which] > 1000);
    }
}
