/* test_eng_elementary.c - the elementary tests against exact arithmetic, for a moment. */
#include "cases.h"
#include "fuzz_run.h"

#define TOLERANCE 1e-6

static struct eng_exact exact;

/* A query of a family in turn and the engine's answer. */
static bool ask(struct prng *prng, uint32_t round, struct eng_query *query,
                struct eng_hit *hit)
{
    enum fuzz_family family = (enum fuzz_family)(round / 2 % FUZZ_FAMILIES);
    fuzz_query_make(prng, family, round % 2 ? PCCD_VF : PCCD_EE, query);
    return eng_solve(query, TOLERANCE, 1, &exact, hit);
}

static enum fuzz_judgement judge(const struct eng_query *query, const struct eng_hit *hit)
{
    struct fuzz_tally tally = {0};
    double early;
    return fuzz_judge(query, hit, TOLERANCE, &tally, &early);
}

/* If this failed, a contact that is missed, invented or mistimed would go unnoticed. */
CASE(judge__finds_wrong_answers)
{
    struct prng prng = {7};
    int contacts = 0;
    int misses = 0;
    for (uint32_t round = 0; round < 4000; round++) {
        struct eng_query query;
        struct eng_hit hit;
        if (!ask(&prng, round, &query, &hit)) {
            const struct eng_hit invented = {
                .flags = PCCD_PROVED, .toi = 0.25, .toi_hi = 0.25};
            assert_int_equal(judge(&query, NULL), FUZZ_RIGHT);
            assert_int_equal(judge(&query, &invented), FUZZ_INVENTED);
            misses++;
            continue;
        }
        assert_int_equal(judge(&query, &hit), FUZZ_RIGHT);
        assert_int_equal(judge(&query, NULL), FUZZ_MISSED);
        contacts++;
        struct eng_hit wrong = hit;
        wrong.toi = wrong.toi_hi = nextafter(hit.toi_hi, 2);
        assert_int_equal(judge(&query, &wrong), FUZZ_LATE);
        if (hit.toi > 0) {
            wrong.toi = wrong.toi_hi = nextafter(hit.toi, 0);
            assert_int_equal(judge(&query, &wrong), FUZZ_EARLY);
        }
    }
    assert_in_range(contacts, 1000, 3000);
    assert_in_range(misses, 1000, 3000);
}

/* If this failed, a search would end where it comes to such a pair, and say nothing of
 * it: along y the points have no extent and are far from the origin, along x they are
 * denormal. */
CASE(judge__takes_points_far_from_their_extent)
{
    const double far = -1879048192;
    const struct eng_query query = {.kind = PCCD_EE,
                                    .x = {{{-0x1p-1061, far, 0},
                                           {0x1p-1061, far, 0},
                                           {0x1p-1063, far, 0},
                                           {0x3p-1063, far, 0}},
                                          {{-0x3p-1063, far, 0},
                                           {-0x1p-1063, far, 0},
                                           {0x1p-1062, far, 0},
                                           {0x1p-1062, far, 0}}}};
    struct eng_hit hit;
    assert_true(eng_solve(&query, TOLERANCE, 1, &exact, &hit));
    assert_int_equal(judge(&query, &hit), FUZZ_RIGHT);
    assert_int_equal(judge(&query, NULL), FUZZ_MISSED);
}

/* If this failed, a contact could have no place, no direction, or a bracket as long as it
 * likes. */
CASE(judge__finds_misformed_answers)
{
    struct prng prng = {8};
    int contacts = 0;
    for (uint32_t round = 0; round < 600; round++) {
        struct eng_query query;
        struct eng_hit hit;
        if (!ask(&prng, round, &query, &hit)) {
            continue;
        }
        contacts++;
        struct eng_hit wrong = hit;
        wrong.flags = 0;
        assert_int_equal(judge(&query, &wrong), FUZZ_MISFORMED);
        wrong = hit;
        wrong.flags ^= PCCD_INITIAL;
        assert_int_equal(judge(&query, &wrong), FUZZ_MISFORMED);
        wrong = hit;
        wrong.param[1] = -0.5f;
        assert_int_equal(judge(&query, &wrong), FUZZ_MISFORMED);
        wrong = hit;
        wrong.normal[0] += 3;
        assert_int_equal(judge(&query, &wrong), FUZZ_MISFORMED);
        if (hit.toi > 2 * TOLERANCE) {
            wrong = hit;
            wrong.toi -= 2 * TOLERANCE;
            assert_int_equal(judge(&query, &wrong), FUZZ_MISFORMED);
        }
    }
    assert_true(contacts > 100);
}

/* If this failed, an answer to an elementary test would be wrong, or depend on the
 * instruction set, the batch, the scale or the order of the points. */
CASE(elementary__answers_are_exact_at_every_instruction_set)
{
    static struct fuzz_run run;
    const char *queries = getenv("FUZZ_QUERIES");
    print_message("# PCCD_SEED=%llu\n", (unsigned long long)prng_seed());
    fuzz_run_init(&run, prng_seed(), stderr);
    fuzz_run_more(&run, queries ? (uint64_t)strtod(queries, NULL) : 100000);
    assert_int_equal(run.failures, 0);
    assert_true(run.hits > run.queries / 10 && run.hits < run.queries / 10 * 9);
    assert_true(run.tally.exact > run.queries / 50 && run.tally.ranges > run.queries / 2);
    assert_true(run.sets >= 1);
    assert_true(run.sieved > run.queries / 2 && run.sieve_kept < run.sieved / 10 * 9);
    fuzz_run_deinit(&run);
}

/* If this failed, features that lie nearly in one line when they meet would be said to
 * touch in places that are far from each other: the normal, which tells the place, is
 * nothing but rounding there. */
CASE(elementary__names_one_place_where_features_are_nearly_in_a_line)
{
    static const char lines[] =
        "ee 0x1.0c6f7a0b5ed8dp-20 0x1p+0 0x1.000000dp+25 -0x1.40000000e8p+34 "
        "-0x1.fffff7p+24 0x1.fffffbap+24 -0x1.3fffffff28p+34 -0x1.0000008p+25 "
        "0x1p+25 -0x1.400000004p+34 -0x1.fffff6p+24 0x1.000002p+25 "
        "-0x1.3fffffff8p+34 -0x1.0000018p+25 0x1.0000025p+25 "
        "-0x1.4000000128p+34 -0x1.fffffep+24 0x1.000000dp+25 "
        "-0x1.4000000068p+34 -0x1.fffffep+24 0x1.000001p+25 -0x1.400000008p+34 "
        "-0x1.fffffep+24 0x1.000002p+25 -0x1.40000001p+34 -0x1.fffffep+24\n"
        "vf 0x1.0624dd2f1a9fcp-10 0x1p+0 -0x1p+0 0x1.4p+2 -0x1.4p+3 0x1.cp+2 "
        "-0x1p+2 0x1p+3 0x1p+1 0x1.8p+2 -0x1.8p+3 -0x1.cp+2 -0x1.4p+2 0x1.4p+3 "
        "-0x1.cp+2 -0x1.4p+2 0x1p+3 -0x1.cp+2 0x1.8p+2 -0x1.9p+4 -0x1.cp+2 "
        "-0x1.cp+2 0x1.cp+3 -0x1.cp+2 -0x1.8p+2 0x1.6p+3\n"
        "vf 0x1.0c6f7a0b5ed8dp-20 0x1p+0 0x1.9p+1 0x1.28p+3 0x1.3p+2 -0x1.4p+3 "
        "-0x1.4p+2 0x1p+3 0x1p+1 0x1p+2 0x1.8p+2 -0x1p+0 0x1.4p+3 0x1.ap+3 "
        "-0x1.7p+1 0x1.2p+1 0x1.fp+2 -0x1.8p+1 0x1p+1 0x1p+3 -0x1p+1 0x1p+2 "
        "0x1.8p+2 -0x1.8p+1 0x1p+1 0x1p+3\n";
    struct eng_query query;
    double tolerance;
    double t_end;
    int count = 0;
    FILE *file = fmemopen((void *)(uintptr_t)lines, sizeof lines - 1, "r");
    assert_non_null(file);
    while (fuzz_query_read(file, &query, &tolerance, &t_end)) {
        struct fuzz_tally tally = {0};
        struct eng_hit hit;
        double early;
        assert_true(eng_solve(&query, tolerance, t_end, &exact, &hit));
        assert_int_equal(fuzz_judge(&query, &hit, tolerance, &tally, &early), FUZZ_RIGHT);
        count++;
    }
    assert_int_equal(count, 3);
    fclose(file);
}

static int set_up(void **state)
{
    (void)state;
    return eng_exact_init(&exact);
}

static int tear_down(void **state)
{
    (void)state;
    eng_exact_deinit(&exact);
    return 0;
}

CASES_WITH(set_up, tear_down);
