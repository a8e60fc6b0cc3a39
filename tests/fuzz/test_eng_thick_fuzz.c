/* test_eng_thick_fuzz.c - thick features of hard families against exact arithmetic.
 *
 * Room:     tests/fuzz. May include: engine headers, oracle, cmocka.
 * Does:     some seconds of what tests/fuzz/thick does for as long as wanted.
 * Threads:  one.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "fuzz_thick.h"

/* If it failed, a pair would come within r unseen, be said to when it does not, or be said
 * to too late; or what is said would depend on whether doubles or integers found it. */
static void thick__is_what_the_oracle_says(void **state)
{
    static struct fuzz_thick_run run;
    (void)state;
    fuzz_thick_init(&run, prng_seed(), stderr);
    fuzz_thick_more(&run, 6000);
    assert_int_equal(run.failures, 0);
    struct fuzz_thick_counts total = fuzz_thick_total(&run);
    assert_true(total.hits > total.cases / 4 && total.hits < total.cases * 9 / 10);
    assert_true(total.initial > total.cases / 20);
    assert_true(total.inside > total.cases / 40);
    assert_true(total.inseparable > total.cases / 2);
    assert_true(total.by_integers > total.cases / 20);
    assert_true(total.by_integers < total.cases / 2);
    fuzz_thick_deinit(&run);
}

/* If it failed, pairs of ordinary numbers would be left undecided. */
static void thick__is_possible_only_where_exponents_are_far_apart(void **state)
{
    static struct fuzz_thick_run run;
    (void)state;
    fuzz_thick_init(&run, 4, stderr);
    fuzz_thick_more(&run, 6000);
    for (int i = 0; i < FUZZ_THICK_FAMILIES; i++) {
        if (i != FUZZ_THICK_POWERS && i != FUZZ_THICK_ZERO) {
            assert_int_equal(run.counts[i].possible, 0);
        }
    }
    fuzz_thick_deinit(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thick__is_what_the_oracle_says),
        cmocka_unit_test(thick__is_possible_only_where_exponents_are_far_apart),
    };
    return cmocka_run_group_tests_name("eng_thick_fuzz", tests, NULL, NULL);
}
