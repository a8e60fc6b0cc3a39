/* test_eng_distance.c - exact distances of the engine against the oracle, for a moment.
 */
#include "cases.h"
#include "fuzz_distance.h"
#include "fuzz_lanes.h"
#include "oracle_distance.h"

/* If it failed, a wrong number would go unnoticed, and all that is below could pass. */
CASE(comparison__finds_a_wrong_number)
{
    static const double x[4][3] = {{1, 1, 2}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    static const uint8_t rank[4] = {0, 1, 2, 3};
    static struct fuzz_distance_run run;
    struct eng_distance right;
    struct oracle_distance due;
    fuzz_distance_init(&run, 1, stderr);
    eng_distance_find(&run.distances, PCCD_VF, x, rank, &right);
    oracle_distance_find(ORACLE_VF, x, rank, &due);
    assert_null(fuzz_distance_differ(&right, &due));
    struct eng_distance wrong = right;
    wrong.type = ENG_NEAREST_VE;
    assert_non_null(fuzz_distance_differ(&wrong, &due));
    wrong = right;
    wrong.points ^= 4;
    assert_non_null(fuzz_distance_differ(&wrong, &due));
    double *numbers[] = {&wrong.lo,          &wrong.hi,           &wrong.param[0],
                         &wrong.param[1],    &wrong.direction[0], &wrong.direction[1],
                         &wrong.direction[2]};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        wrong = right;
        *numbers[i] = nextafter(*numbers[i], 9);
        assert_non_null(fuzz_distance_differ(&wrong, &due));
    }
    wrong = right;
    wrong.direction[0] = -0.0;
    assert_non_null(fuzz_distance_differ(&wrong, &due));
    fuzz_distance_deinit(&run);
}

/* If it failed, an error that is too small to be a double would count as none, and a
 * distance would be called exact that is not. */
CASE(distance__is_exact_where_errors_are_below_the_least_double)
{
    static const struct fuzz_distance_case made = {
        .kind = PCCD_VF,
        .x = {{-0x1.8p-551, 0x1p-490, -0x1.8p-201},
              {-0x1.8p-162, 0x1p-414, 0},
              {0x1p-72, -0x1.8p-543, 0},
              {0x1p-910, 0, -0x1p-871}},
        .rank = {2, 3, 0, 1},
        .d = -1};
    static struct fuzz_distance_run run;
    fuzz_distance_init(&run, 1, stderr);
    for (int first = 0; first < ENG_DISTANCE_STAGES; first++) {
        assert_null(fuzz_distance_judge(&run, &made, (enum eng_distance_stage)first));
    }
    fuzz_distance_deinit(&run);
}

/* If it failed, a distance, a crossing or what is inside would be wrong, or depend on the
 * stage that has found it. */
CASE(distance__is_exact_from_every_stage_on)
{
    static struct fuzz_distance_run run;
    const char *queries = getenv("FUZZ_QUERIES");
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)prng_seed());
    fuzz_distance_init(&run, prng_seed(), stderr);
    run.all_stages = true;
    fuzz_distance_more(&run, queries ? (uint64_t)strtod(queries, NULL) : 20000);
    assert_int_equal(run.failures, 0);
    for (int i = 0; i < 4; i++) {
        assert_true(run.types[i] > run.cases / 50);
    }
    assert_true(run.within > run.cases / 20 && run.within < run.cases / 2);
    assert_true(run.crossings > run.cases / 100);
    assert_true(run.inside > run.cases / 100 && run.on_surface > run.cases / 100);
    fuzz_distance_deinit(&run);
}

/* If it failed, a stage would never be tried by the cases above, and what it does could
 * be wrong. */
CASE(distance__is_decided_by_every_stage)
{
    static struct fuzz_distance_run run;
    uint64_t stages[ENG_DISTANCE_STAGES] = {0};
    fuzz_distance_init(&run, 3, stderr);
    fuzz_distance_more(&run, 2000);
    for (int i = 0; i < FUZZ_DISTANCE_FAMILIES * ENG_DISTANCE_STAGES; i++) {
        stages[i % ENG_DISTANCE_STAGES] +=
            run.stages[i / ENG_DISTANCE_STAGES][i % ENG_DISTANCE_STAGES];
    }
    for (int i = 0; i < ENG_DISTANCE_STAGES; i++) {
        assert_true(stages[i] > run.cases / 50);
    }
    fuzz_distance_deinit(&run);
}

/* If it failed, what is near would depend on the processor, or on which pairs are asked
 * about together; or a pair would be left out. The counts say that each kernel decides
 * something, and leaves something. */
CASE(distance__is_the_same_in_lanes)
{
    static struct fuzz_lanes_run run;
    fuzz_lanes_init(&run, prng_seed(), stderr);
    fuzz_lanes_more(&run, 800);
    assert_int_equal(run.failures, 0);
    assert_true(run.beyond > run.cases / 10 && run.beyond < run.cases);
    assert_true(run.measured > run.cases / 10);
    assert_true(run.sure > run.cases / 20);
    assert_true(run.vague > 0 && run.open > 0);
    for (int i = 0; i < 4; i++) {
        assert_true(run.types[i] > run.cases / 200);
    }
    assert_true(run.crossings > run.cases / 100 && run.past > run.cases / 10);
    fuzz_lanes_deinit(&run);
}

/* If it failed, a margin of the lanes would be too small: a number of theirs, or whether
 * a pair is within d, would not be that of exact arithmetic, beside the places where
 * rounding changes. */
CASE(distance__is_the_same_in_lanes_where_rounding_changes)
{
    static struct fuzz_lanes_run run;
    fuzz_lanes_init(&run, prng_seed(), stderr);
    run.is_sharp = true;
    fuzz_lanes_more(&run, 400);
    assert_int_equal(run.failures, 0);
    assert_true(run.sure > 0 && run.vague > run.cases / 10);
    fuzz_lanes_deinit(&run);
}
