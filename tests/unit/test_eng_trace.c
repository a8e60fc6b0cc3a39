/* test_eng_trace.c - the trace of a step. */
#include "eng_crew.h"
#include "trace.h"
#include "trees.h"

#define TRACKS 16u
#define EVENTS (1u << 15)

static struct pccd_trace_event event(uint32_t thread, enum pccd_trace_kind kind,
                                     uint64_t begin_ns, uint64_t end_ns, uint32_t a,
                                     uint32_t b)
{
    return (struct pccd_trace_event){begin_ns, end_ns, kind, thread, a, b};
}

/* If it failed: a reader would get events that were overwritten, or not the last ones. */
CASE(trace__ring_keeps_the_newest)
{
    struct eng_trace trace;
    assert_ok(eng_trace_init(&trace, 2, 5, 0));
    assert_int_equal(trace.capacity, 8);
    for (uint32_t i = 0; i < 27; i++) {
        assert_int_equal(eng_trace_count(&trace, 1), i < 8 ? i : 8);
        eng_trace_add(&trace, event(1, PCCD_TRACE_UNIT, 10 * i, 10 * i + 7, i, i + 1));
    }
    assert_int_equal(eng_trace_count(&trace, 0), 0);
    for (uint32_t i = 0; i < 8; i++) {
        const struct pccd_trace_event *event = eng_trace_at(&trace, 1, i);
        assert_int_equal(event->a, 19 + i);
        assert_int_equal(event->b, 20 + i);
        assert_int_equal(event->begin_ns, 190 + 10 * i);
        assert_int_equal(event->end_ns, 197 + 10 * i);
        assert_int_equal(event->kind, PCCD_TRACE_UNIT);
        assert_int_equal(event->thread, 1);
    }
    eng_trace_deinit(&trace);
}

/* If it failed: a trace of no use would be accepted, or a thread too many would write
 * behind the tracks. */
CASE(trace__refuses_what_has_no_room)
{
    struct eng_trace trace;
    assert_int_equal(eng_trace_init(&trace, 0, 8, 0), PCCD_E_INVAL);
    assert_int_equal(eng_trace_init(&trace, 1, 0, 0), PCCD_E_INVAL);
    assert_ok(eng_trace_init(&trace, 1, 8, 100));
    eng_trace_add(&trace, event(1, PCCD_TRACE_STEP, 0, 1, 0, 0));
    eng_trace_add(NULL, event(0, PCCD_TRACE_STEP, 0, 1, 0, 0));
    eng_trace_add(&trace, event(0, PCCD_TRACE_UNIT, 0, 99, 0, 0));
    eng_trace_add(&trace, event(0, PCCD_TRACE_SUBTREE, 0, 99, 0, 0));
    eng_trace_add(&trace, event(0, PCCD_TRACE_PAIRS, 0, 99, 0, 0));
    assert_int_equal(eng_trace_count(&trace, 0), 0);
    eng_trace_add(&trace, event(0, PCCD_TRACE_UNIT, 0, 100, 0, 0));
    eng_trace_add(&trace, event(0, PCCD_TRACE_WAIT, 0, 1, 0, 0));
    assert_int_equal(eng_trace_count(&trace, 0), 2);
    eng_trace_deinit(&trace);
}

/* A traced step; the trace is empty before it. */
static struct eng_step_result traced(struct crew *crew, struct eng_question settings,
                                     struct eng_trace *trace)
{
    for (uint32_t i = 0; i < trace->track_count; i++) {
        trace->tracks[i].added = 0;
    }
    settings.trace = trace;
    struct eng_step_result result = crew_run(crew, settings);
    for (uint32_t i = 0; i < trace->track_count; i++) {
        assert_true(trace->tracks[i].added < trace->capacity);
    }
    return result;
}

struct totals {
    uint64_t count[PCCD_TRACE_REQUEST];
    uint64_t ns[PCCD_TRACE_REQUEST];
    uint64_t candidates;
    uint64_t high_units; /* a unit has a slice for each of its phases */
};

static struct totals totals_of(const struct eng_trace *trace, uint32_t track)
{
    struct totals totals;
    uint32_t high = ENG_NO_NODE;
    memset(&totals, 0, sizeof totals);
    for (uint64_t i = 0; i < eng_trace_count(trace, track); i++) {
        const struct pccd_trace_event *event = eng_trace_at(trace, track, i);
        assert_true(event->begin_ns <= event->end_ns);
        assert_int_equal(event->thread, track);
        totals.count[event->kind]++;
        totals.ns[event->kind] += event->end_ns - event->begin_ns;
        if (event->kind == PCCD_TRACE_HIGH) {
            totals.high_units += event->a != high;
            high = event->a;
        }
        totals.candidates += event->kind == PCCD_TRACE_TESTS ? event->b : 0;
    }
    return totals;
}

static void check_team(const struct eng_trace *trace, const struct eng_step_result *team)
{
    uint64_t units = 0;
    uint64_t tests = 0;
    for (uint32_t t = 0; t < team->threads; t++) {
        const struct eng_thread_record *record = &team->thread_records[t];
        struct totals totals = totals_of(trace, t);
        units += totals.count[PCCD_TRACE_UNIT];
        units += t == 0 ? totals.high_units : 0;
        tests += totals.candidates;
        assert_int_equal(totals.count[PCCD_TRACE_STEP], t == 0);
        assert_true(totals.count[PCCD_TRACE_REFIT] > 0);
        assert_true(totals.ns[PCCD_TRACE_TESTS] <= record->tests_ns);
        assert_true(totals.ns[PCCD_TRACE_HIGH] <= record->high_ns);
        assert_int_equal(totals.ns[PCCD_TRACE_WAIT], record->wait_ns);
    }
    assert_int_equal(units, team->counters.task_units);
    assert_int_equal(tests, team->counters.candidates[PCCD_VF] +
                                team->counters.candidates[PCCD_EE]);
}

/* If it failed: the picture of a step would lack task units, or show some twice. */
CASE_WITH(trace__holds_a_slice_for_each_task_unit, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_trace trace;
    assert_ok(eng_trace_init(&trace, TRACKS, EVENTS, 0));
    struct eng_step_result alone = traced(crew, crew_alone(PCCD_MODE_ALL), &trace);
    check_team(&trace, &alone);
    uint64_t hash[2] = {alone.hash[0], alone.hash[1]};
    for (size_t i = 0; i < crew_count(); i++) {
        struct eng_step_result team = traced(crew, crew_team(PCCD_MODE_ALL, i), &trace);
        check_team(&trace, &team);
        assert_int_equal(team.hash[0], hash[0]);
        assert_int_equal(team.hash[1], hash[1]);
    }
    eng_trace_deinit(&trace);
}

/* If it failed: threads that step a scene each would write to one ring at the same time,
 * and the picture of a batch would show one thread doing what all did. */
CASE_WITH(trace__of_a_step_by_one_thread_is_in_its_track, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_trace trace;
    assert_ok(eng_trace_init(&trace, 2, EVENTS, 0));
    struct eng_question question = crew_alone(PCCD_MODE_ALL);
    question.track = 1;
    traced(crew, question, &trace);
    assert_true(totals_of(&trace, 1).candidates > 0);
    assert_int_equal(eng_trace_count(&trace, 0), 0);
    eng_trace_deinit(&trace);
}

/* Events come in the order of their ends: one that began before another's begin holds it,
 * else it must have begun after its end. */
static void check_nesting(const struct eng_trace *trace, uint32_t track)
{
    uint64_t count = eng_trace_count(trace, track);
    const struct pccd_trace_event **open = test_room((count + 1) * sizeof *open);
    uint64_t open_count = 0;
    for (uint64_t i = 0; i < count; i++) {
        const struct pccd_trace_event *event = eng_trace_at(trace, track, i);
        while (open_count > 0 && open[open_count - 1]->begin_ns >= event->begin_ns) {
            open_count--;
        }
        assert_true(open_count == 0 || open[open_count - 1]->end_ns <= event->begin_ns);
        open[open_count++] = event;
    }
    free(open);
}

/* If it failed: viewers would refuse the trace or draw slices over each other. */
CASE_WITH(trace__slices_of_a_thread_nest, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_trace trace;
    assert_ok(eng_trace_init(&trace, TRACKS, EVENTS, 0));
    for (size_t i = 0; i < crew_count(); i++) {
        traced(crew, crew_team(PCCD_MODE_ALL, i), &trace);
        for (uint32_t track = 0; track < TRACKS; track++) {
            check_nesting(&trace, track);
        }
    }
    eng_trace_deinit(&trace);
}

/* If it failed: a small trace of a large step would be full of what nobody looks at. */
CASE_WITH(trace__leaves_short_tasks_out, crew_setup, crew_teardown)
{
    struct crew *crew = *state;
    struct eng_trace trace;
    assert_ok(eng_trace_init(&trace, 1, EVENTS, UINT64_MAX));
    for (size_t i = 0; i < crew_count(); i++) {
        traced(crew, crew_team(PCCD_MODE_ALL, i), &trace);
        struct totals totals = totals_of(&trace, 0);
        assert_int_equal(totals.count[PCCD_TRACE_UNIT] +
                             totals.count[PCCD_TRACE_SUBTREE] +
                             totals.count[PCCD_TRACE_PAIRS],
                         0);
        assert_true(totals.count[PCCD_TRACE_REFIT] > 0);
        assert_in_range(totals.count[PCCD_TRACE_MERGE], 1, 4);
    }
    eng_trace_deinit(&trace);
}
