/* test_eng_thick_fuzz.c - thick features of hard families against exact arithmetic. */
#include "cases.h"
#include "fuzz_thick_lanes.h"

/* If it failed, a pair would come within r unseen, be said to when it does not, or be
 * said to too late; or that would depend on whether doubles or integers found it. Or it
 * would be said to approach at t = 0, to stay or to go away, and does not. */
CASE(thick__is_what_the_oracle_says)
{
    static struct fuzz_thick_run run;
    fuzz_thick_init(&run, prng_seed(), stderr);
    fuzz_thick_more(&run, 3000);
    assert_int_equal(run.failures, 0);
    struct fuzz_thick_counts total = fuzz_thick_total(&run);
    assert_true(total.hits > total.cases / 4 && total.hits < total.cases * 9 / 10);
    assert_true(total.initial > total.cases / 20);
    assert_true(total.inside > total.cases / 40);
    assert_true(total.inseparable > total.cases / 2);
    assert_true(total.by_integers > total.cases / 20);
    assert_true(total.by_integers < total.cases / 2);
    for (int i = 0; i < 3; i++) {
        assert_true(run.trends[i] > total.cases / 20);
    }
    assert_true(run.touching > total.cases / 40);
    fuzz_thick_deinit(&run);
}

/* If it failed, pairs of points that meet, or nearly do, would be left undecided: with
 * noise of 1e-6 to 1e-16 and of 2^-1000, or whose exponents are as far apart as doubles
 * allow. */
CASE(thick__is_proved_whatever_the_exponents)
{
    static struct fuzz_thick_run run;
    fuzz_thick_init(&run, 4, stderr);
    run.oracle_each = 1000;
    fuzz_thick_more(&run, 20000);
    assert_int_equal(run.failures, 0);
    fuzz_thick_deinit(&run);
}

/* If it failed, an answer would depend on the processor, or on which pairs are asked
 * about together; or the kernel would reject a pair that comes within r. */
CASE(thick__is_the_same_in_lanes)
{
    static struct fuzz_thick_lanes run;
    fuzz_thick_lanes_init(&run, prng_seed(), stderr);
    fuzz_thick_lanes_more(&run, 150);
    assert_int_equal(run.failures, 0);
    assert_true(run.cases > 2000 && run.hits > run.cases / 5);
    assert_true(run.survivors > run.hits && run.survivors < run.hits * 5 / 4);
    fuzz_thick_lanes_deinit(&run);
}
