/* test_eng_record.c - what each thread of a step did. */
#include "eng_crew.h"

static struct eng_thread_record sum_of(const struct eng_step_result *result)
{
    struct eng_thread_record sum;
    memset(&sum, 0, sizeof sum);
    for (uint32_t i = 0; i < result->threads; i++) {
        const struct eng_thread_record *record = &result->thread_records[i];
        sum.task_units += record->task_units;
        sum.pairs += record->pairs;
        sum.box_tests += record->box_tests;
        sum.tests += record->tests;
        sum.steals += record->steals;
        sum.requests += record->requests;
        sum.given += record->given;
        sum.sleeps += record->sleeps;
        sum.low_ns += record->low_ns;
        sum.high_ns += record->high_ns;
        sum.wait_ns += record->wait_ns;
    }
    return sum;
}

/* If it failed: somebody who adds the threads up would get another step. */
CASE_WITH(record__counts_add_up_to_those_of_the_step, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_step_result alone = crew_run(crew, crew_alone(PCCD_MODE_ALL));
    uint64_t pairs = alone.thread_records[0].pairs;
    assert_true(pairs > 0);
    for (size_t i = 0; i < crew_count(); i++) {
        struct eng_question settings = crew_team(PCCD_MODE_ALL, i);
        struct eng_step_result team = crew_run(crew, settings);
        struct eng_thread_record sum = sum_of(&team);
        assert_int_equal(team.threads, settings.threads);
        assert_int_equal(sum.task_units, team.counters.task_units);
        assert_int_equal(sum.box_tests, team.counters.box_tests);
        assert_int_equal(sum.tests, team.counters.candidates[PCCD_VF] +
                                        team.counters.candidates[PCCD_EE]);
        assert_int_equal(sum.pairs, pairs);
    }
}

/* If it failed: a record would count candidates that were only listed. */
CASE_WITH(record__listed_candidates_are_not_tests, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (size_t i = 0; i < crew_count(); i++) {
        struct eng_step_result team = crew_run(crew, crew_team(PCCD_MODE_PAIRS, i));
        assert_true(team.count > 0);
        assert_int_equal(sum_of(&team).tests, 0);
    }
}

/* If it failed: shares of the time, such as those of a figure, would pass the whole. */
CASE_WITH(record__times_lie_within_the_step, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (size_t i = 0; i < crew_count(); i++) {
        struct eng_question settings = crew_team(PCCD_MODE_ALL, i);
        struct eng_step_result team = crew_run(crew, settings);
        assert_int_equal(team.times.low + team.times.high,
                         team.times.traversal + team.times.tests);
        assert_true(team.times.low > 0);
        assert_true(team.times.refit + team.times.low + team.times.high +
                        team.times.merge <=
                    team.times.step);
        for (uint32_t t = 0; t < team.threads; t++) {
            const struct eng_thread_record *record = &team.thread_records[t];
            assert_true(record->refit_ns + record->low_ns + record->high_ns +
                            record->wait_ns + record->merge_ns <=
                        team.times.step);
            assert_true(record->low_ns <= team.times.low);
            assert_true(record->high_ns <= team.times.high);
            assert_true(record->tests_ns + record->rebuild_ns <=
                        record->low_ns + record->high_ns);
            assert_true(record->wait_ns > 0);
        }
        bool has_high = settings.tuning.scheduler == ENG_SCHEDULER_PAPER;
        assert_int_equal(team.times.high > 0, has_high);
        assert_int_equal(sum_of(&team).high_ns > 0, has_high);
    }
}

/* If it failed: a node would be lost on its way between two threads, or the record of who
 * helped whom would not be believed. */
CASE_WITH(record__what_is_given_is_received, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    for (size_t i = 0; i < crew_count(); i++) {
        struct eng_question settings = crew_team(PCCD_MODE_ALL, i);
        struct eng_step_result team = crew_run(crew, settings);
        struct eng_thread_record sum = sum_of(&team);
        assert_true(sum.requests >= sum.steals);
        if (settings.tuning.scheduler == ENG_SCHEDULER_PAPER) {
            assert_int_equal(sum.given, sum.steals);
            assert_true(sum.sleeps >= sum.steals);
        } else {
            assert_int_equal(sum.given, 0);
        }
    }
}

/* If it failed: a step by one thread would look as if it had waited for itself. */
CASE_WITH(record__one_thread_never_waits, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_step_result alone = crew_run(crew, crew_alone(PCCD_MODE_ALL));
    const struct eng_thread_record *record = alone.thread_records;
    assert_int_equal(alone.threads, 1);
    assert_int_equal(alone.times.high, 0);
    assert_int_equal(record->low_ns, alone.times.low);
    assert_int_equal(record->refit_ns, alone.times.refit);
    assert_int_equal(record->high_ns, 0);
    assert_int_equal(record->wait_ns, 0);
    assert_int_equal(record->steals + record->requests + record->given + record->sleeps,
                     0);
}
