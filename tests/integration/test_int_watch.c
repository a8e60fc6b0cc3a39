/* test_int_watch.c - watching a real daemon work: its threads' records and its trace. */
#include "cases.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixture.h"
#include "grid.h"
#include "must.h"
#include "pccd.h"
#include "raw.h"

#define SIDE    40u /* of a grid that a step shares among threads */
#define THREADS 3u
#define NOBODY  65534

static struct test_grid grid;

/* A turn of the grid by so many threads; *answer has no records any more. */
static void turn(uint32_t threads, struct pccd_answer *answer)
{
    /* The method with many small task units. */
    const struct pccd_step_settings settings = {.struct_bytes =
                                                    sizeof(struct pccd_step_settings),
                                                .threads = threads,
                                                .method = PCCD_METHOD_PAPER};

    assert_ok(test_grid_turn(&grid, &settings, answer));
    assert_true(test_grid_is_right(&grid, answer));
    assert_int_equal(answer->threads, threads);
    pccd_answer_release(grid.client, answer);
}

/* ---- records of threads ------------------------------------------------------------ */

/* Number that is looked for, and sums over the threads that were asked for. */
struct sums {
    uint64_t threads, number, task_units, box_tests, tests, ns_step, low_ns;
};

static void add(void *context, const char *name, uint64_t value, const char *text)
{
    struct sums *sums = context;

    assert_true(text[0] != '\0');
#define ADD(field)                                                                       \
    if (strcmp(name, #field) == 0) {                                                     \
        sums->field += value;                                                            \
    }
    ADD(threads)
    ADD(number) ADD(task_units) ADD(box_tests) ADD(tests) ADD(ns_step) ADD(low_ns)
#undef ADD
}

/* If it failed, the records would tell of other work than the step's. */
CASE(threads__records_add_up_to_the_answer)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t number = 0;

    test_grid_open(&grid, test_shared.url, SIDE);
    for (uint32_t threads = THREADS; threads >= 1; threads--) {
        struct sums sums = {.threads = 0};

        turn(threads, &answer);
        for (uint32_t i = 0; i < threads; i++) {
            assert_ok(pccd_stats_thread(grid.client, i % 2 == 1, i, add, &sums, NULL));
        }
        assert_int_equal(sums.threads, threads * threads);
        assert_int_equal(sums.number % threads, 0);
        assert_true(sums.number / threads > number);
        number = sums.number / threads;
        assert_int_equal(sums.task_units, answer.counters.task_units);
        assert_int_equal(sums.box_tests, answer.counters.box_tests);
        assert_true(sums.task_units > 0);
        assert_true(sums.ns_step >= answer.times.low * threads);
        assert_true(sums.low_ns > 0);
        assert_int_equal(pccd_stats_thread(grid.client, false, threads, add, &sums, NULL),
                         PCCD_E_INVAL);
        assert_int_equal(
            pccd_stats_thread(grid.client, true, UINT32_MAX, add, &sums, NULL),
            PCCD_E_INVAL);
    }
    test_grid_close(&grid);
}

/* If it failed, a client would be shown somebody else's step for its own, or a record of
 * a step that never was. */
CASE(threads__records_are_of_the_session_that_asks)
{
    struct pccd_client *stranger = test_client_at(test_shared.url);
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    struct sums own = {.threads = 0};
    struct sums others = {.threads = 0};

    test_grid_open(&grid, test_shared.url, SIDE);
    turn(2, &answer);
    assert_ok(pccd_stats_thread(stranger, false, 0, add, &own, NULL));
    assert_int_equal(own.threads, 0);
    assert_int_equal(own.number, 0);
    assert_int_equal(own.ns_step, 0);
    assert_int_equal(pccd_stats_thread(stranger, false, 1, add, &own, NULL),
                     PCCD_E_INVAL);
    assert_ok(pccd_stats_thread(stranger, true, 0, add, &others, NULL));
    assert_int_equal(others.threads, 2); /* the daemon's user may see it */
    assert_int_equal(pccd_stats_thread(NULL, false, 0, add, &own, NULL), PCCD_E_INVAL);
    assert_int_equal(pccd_stats_thread(stranger, false, 0, NULL, &own, NULL),
                     PCCD_E_INVAL);
    /* It outlives the session that made it. */
    test_grid_close(&grid);
    others.threads = 0;
    assert_ok(pccd_stats_thread(stranger, true, 1, add, &others, NULL));
    assert_int_equal(others.threads, 2);
    pccd_close(stranger);
}

/* ---- recordings -------------------------------------------------------------------- */

#define EVENTS_MAX 400000u

/* A recording in memory. */
struct recording {
    struct pccd_trace_event *events; /* [EVENTS_MAX] */
    uint64_t count;
    uint64_t of_kind[PCCD_TRACE_KIND_COUNT];
    struct pccd_trace_info info;
};

static void collect(void *context, const struct pccd_trace_event *events, uint32_t count)
{
    struct recording *recording = context;

    for (uint32_t i = 0; i < count; i++) {
        assert_true(recording->count < EVENTS_MAX);
        assert_true(events[i].kind < PCCD_TRACE_KIND_COUNT);
        assert_true(events[i].begin_ns <= events[i].end_ns);
        recording->of_kind[events[i].kind]++;
        recording->events[recording->count++] = events[i];
    }
}

static void start_recording(struct recording *recording, uint32_t events)
{
    memset(recording, 0, sizeof *recording);
    recording->events = test_room(EVENTS_MAX * sizeof *recording->events);
    assert_ok(pccd_trace_start(grid.client, events, 0, &recording->info));
}

static void end_recording(struct recording *recording)
{
    assert_ok(pccd_trace_stop(grid.client, &recording->info));
    assert_ok(pccd_trace_dump(grid.client, collect, recording));
    assert_int_equal(recording->count, recording->info.events);
}

static bool is_of_team(const struct pccd_trace_event *event)
{
    return event->kind < PCCD_TRACE_REQUEST;
}

/* The track of an event: a thread, or the loop. Requests have none. */
static uint64_t track_of(const struct pccd_trace_event *event)
{
    return is_of_team(event) ? event->thread : UINT32_MAX;
}

static int by_track_and_begin(const void *left, const void *right)
{
    const struct pccd_trace_event *a = left;
    const struct pccd_trace_event *b = right;

    if (track_of(a) != track_of(b)) {
        return track_of(a) < track_of(b) ? -1 : 1;
    }
    if (a->begin_ns != b->begin_ns) {
        return a->begin_ns < b->begin_ns ? -1 : 1;
    }
    return a->end_ns > b->end_ns ? -1 : a->end_ns < b->end_ns;
}

/* Events of one track lie inside one another or apart. */
static void expect_nesting(struct recording *recording)
{
    static uint64_t ends_ns[1000];
    uint32_t depth = 0;
    uint64_t track = UINT64_MAX;

    qsort(recording->events, recording->count, sizeof *recording->events,
          by_track_and_begin);
    for (uint64_t i = 0; i < recording->count; i++) {
        const struct pccd_trace_event *event = &recording->events[i];

        if (event->kind == PCCD_TRACE_REQUEST) {
            continue;
        }
        if (track_of(event) != track) {
            track = track_of(event);
            depth = 0;
        }
        while (depth > 0 && ends_ns[depth - 1] <= event->begin_ns) {
            depth--;
        }
        assert_true(depth == 0 || event->end_ns <= ends_ns[depth - 1]);
        assert_true(depth < 1000);
        ends_ns[depth++] = event->end_ns;
    }
}

/* High-level units have a part for each thread that took part, and nothing whole. */
static uint64_t count_high_nodes(const struct recording *recording)
{
    uint64_t count = 0;

    for (uint64_t i = 0; i < recording->count; i++) {
        const struct pccd_trace_event *event = &recording->events[i];
        bool is_new = event->kind == PCCD_TRACE_HIGH;

        for (uint64_t k = 0; k < i && is_new; k++) {
            is_new = recording->events[k].kind != PCCD_TRACE_HIGH ||
                     recording->events[k].a != event->a;
        }
        count += is_new;
    }
    return count;
}

/* If it failed, the picture of a step would leave out work, or show it twice. */
CASE(trace__has_one_event_for_each_task_unit)
{
    static const char *const tunings[] = {"scheduler=steal", "scheduler=paper"};

    test_grid_open(&grid, test_shared.url, SIDE);
    for (uint32_t threads = 1; threads <= THREADS; threads++) {
        for (int i = 0; i < 2; i++) {
            const struct pccd_step_settings settings = {
                .struct_bytes = sizeof(struct pccd_step_settings),
                .threads = threads,
                .tuning = tunings[i]};
            struct recording recording;
            struct pccd_answer answer = PCCD_ANSWER_INIT;

            start_recording(&recording, 0);
            assert_int_equal(recording.info.threads, THREADS);
            assert_int_equal(recording.info.events_max, PROTO_TRACE_EVENTS);
            assert_ok(test_grid_turn(&grid, &settings, &answer));
            pccd_answer_release(grid.client, &answer);
            end_recording(&recording);
            assert_int_equal(recording.info.lost, 0);
            assert_int_equal(recording.of_kind[PCCD_TRACE_STEP], 1);
            assert_int_equal(recording.of_kind[PCCD_TRACE_UNIT] +
                                 count_high_nodes(&recording),
                             answer.counters.task_units);
            assert_true(recording.of_kind[PCCD_TRACE_REFIT] >= 1);
            assert_true(recording.of_kind[PCCD_TRACE_MERGE] >= 1);
            for (uint64_t at = 0; at < recording.count; at++) {
                assert_true(!is_of_team(&recording.events[at]) ||
                            recording.events[at].thread < threads);
            }
            expect_nesting(&recording);
            free(recording.events);
        }
    }
    test_grid_close(&grid);
}

/* If it failed, nobody could tell how long a client waited for what. */
CASE(trace__has_every_request_of_every_client)
{
    struct pccd_client *other = test_client_at(test_shared.url);
    struct test_crossing crossing;
    struct recording recording;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint32_t submits = 0;
    uint32_t pings = 0;

    assert_ok(test_crossing_make(other, &crossing));
    test_grid_open(&grid, test_shared.url, SIDE);
    start_recording(&recording, 0);
    for (int i = 0; i < 5; i++) {
        turn(2, &answer);
        assert_true(test_crossing_turn(&crossing));
        assert_ok(pccd_ping(other, NULL));
    }
    end_recording(&recording);
    assert_int_equal(recording.info.lost, 0);
    assert_int_equal(recording.of_kind[PCCD_TRACE_STEP], 10);
    for (uint64_t i = 0; i < recording.count; i++) {
        const struct pccd_trace_event *event = &recording.events[i];

        if (event->kind == PCCD_TRACE_REQUEST) {
            const char *name = pccd_method_name(event->a);

            assert_non_null(name);
            submits += strcmp(name, "frame.submit") == 0;
            pings += strcmp(name, "ping") == 0;
        }
    }
    assert_int_equal(submits, 10);
    assert_int_equal(pings, 5);
    /* trace.start was received before it was on, trace.stop answered after. */
    assert_int_equal(recording.of_kind[PCCD_TRACE_ANSWER],
                     recording.of_kind[PCCD_TRACE_REQUEST]);
    assert_true(recording.of_kind[PCCD_TRACE_RECEIVE] >= 15);
    expect_nesting(&recording);
    free(recording.events);
    assert_null(pccd_method_name(UINT32_MAX));
    test_grid_close(&grid);
    pccd_close(other);
}

/* If it failed, a recording would grow without bound, or pretend to be whole. */
CASE(trace__ring_that_overflows_keeps_the_newest_and_counts_the_lost)
{
    struct recording whole;
    struct recording cut;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t newest = 0;

    test_grid_open(&grid, test_shared.url, SIDE);
    start_recording(&whole, 0);
    turn(1, &answer);
    end_recording(&whole);
    start_recording(&cut, 13);
    assert_int_equal(cut.info.events_max, 16);
    turn(1, &answer);
    end_recording(&cut);
    assert_int_equal(cut.of_kind[PCCD_TRACE_STEP], 1); /* it ends last */
    assert_int_equal(cut.count - cut.of_kind[PCCD_TRACE_REQUEST] -
                         cut.of_kind[PCCD_TRACE_RECEIVE] - cut.of_kind[PCCD_TRACE_ANSWER],
                     16);
    assert_true(cut.info.lost > 1000);
    /* The same step but for the loop's few events. */
    assert_true(cut.info.lost + cut.count >= whole.count - 16 &&
                cut.info.lost + cut.count <= whole.count + 16);
    for (uint64_t i = 0; i < cut.count; i++) { /* each thread's in the order of ends */
        if (is_of_team(&cut.events[i])) {
            assert_true(cut.events[i].end_ns >= newest);
            newest = cut.events[i].end_ns;
        }
    }
    free(whole.events);
    free(cut.events);
    test_grid_close(&grid);
}

/* If it failed, recordings would get into each other's way, or be read half-made. */
CASE(trace__is_one_at_a_time_and_of_its_session)
{
    struct pccd_client *other = test_client_at(test_shared.url);
    struct recording recording;
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status = PCCD_E_BUSY;

    /* What the sessions before had may still be on its way out. */
    assert_int_equal(test_stat_await(other, "engine_bytes_now", 0), 0);
    test_grid_open(&grid, test_shared.url, SIDE);
    assert_int_equal(pccd_trace_stop(grid.client, NULL), PCCD_E_STATE);
    assert_int_equal(pccd_trace_dump(grid.client, collect, &recording), PCCD_E_STATE);
    assert_int_equal(pccd_trace_start(grid.client, PROTO_TRACE_EVENTS_MAX + 1, 0, NULL),
                     PCCD_E_LIMIT);
    assert_int_equal(pccd_trace_start(grid.client, UINT32_MAX, 0, NULL), PCCD_E_LIMIT);
    start_recording(&recording, 0);
    assert_int_equal(pccd_trace_start(grid.client, 0, 0, NULL), PCCD_E_STATE);
    assert_int_equal(pccd_trace_dump(grid.client, collect, &recording), PCCD_E_STATE);
    assert_int_equal(pccd_trace_start(other, 0, 0, NULL), PCCD_E_BUSY);
    assert_non_null(strstr(pccd_error_text(other), "is recording"));
    assert_int_equal(pccd_trace_stop(other, NULL), PCCD_E_STATE);
    assert_int_equal(pccd_trace_dump(other, collect, &recording), PCCD_E_STATE);
    turn(2, &answer);
    end_recording(&recording);
    turn(2, &answer); /* is not recorded any more */
    recording.count = 0;
    end_recording(&recording);
    assert_int_equal(pccd_trace_start(other, 0, 0, NULL), PCCD_E_BUSY);
    /* It goes with the next one, and with its session, also while it is on. */
    free(recording.events);
    start_recording(&recording, 1000);
    turn(2, &answer);
    free(recording.events);
    test_grid_close(&grid);
    for (int i = 0; i < 1000 && status == PCCD_E_BUSY; i++) {
        status = pccd_trace_start(other, 0, 0, NULL);
        test_sleep_ms(2);
    }
    assert_int_equal(status, 0);
    pccd_close(other);
    other = test_client_at(test_shared.url);
    assert_int_equal(test_stat_await(other, "engine_bytes_now", 0), 0);
    pccd_close(other);
}

static int dump(struct test_raw *raw, uint64_t cursor,
                struct proto_TRACE_DUMP_result *page)
{
    return RAW_CALL(raw, TRACE_DUMP, page, .cursor = cursor, .count = UINT32_MAX);
}

/* If it failed, a page could be asked for that is not there, or lead to nothing. */
CASE(trace__pages_beyond_the_end_are_refused)
{
    static struct test_raw raw;
    struct proto_TRACE_STOP_result ended;
    struct proto_TRACE_DUMP_result page;

    assert_ok(test_raw_session(&raw, test_shared.socket, 0, 0));
    assert_ok(RAW_CALL(&raw, TRACE_START, NULL, .events = 1024));
    assert_ok(RAW_CALL(&raw, TRACE_STOP, &ended, .reserved = 0));
    assert_true(ended.events > 0);                        /* the answer to trace.start */
    assert_int_equal(dump(&raw, 0, &page), PCCD_E_STATE); /* nowhere to write to */
    assert_ok(test_raw_attach(&raw, 2, 65536));
    assert_ok(dump(&raw, 0, &page));
    assert_int_equal(page.count, ended.events);
    assert_int_equal(page.events, ended.events);
    assert_ok(dump(&raw, ended.events, &page));
    assert_int_equal(page.count, 0);
    assert_int_equal(dump(&raw, ended.events + 1, &page), PCCD_E_INVAL);
    assert_int_equal(dump(&raw, UINT64_MAX, &page), PCCD_E_INVAL);
    test_raw_close(&raw);
}

/* ---- other users ------------------------------------------------------------------- */

/* In a child of another user: the exit status is 0 when the daemon refuses. */
static int ask_as_nobody(void)
{
    static struct test_raw raw;
    int status = 0;

    if (setgid(NOBODY) != 0 || setuid(NOBODY) != 0 ||
        test_raw_session(&raw, test_shared.socket, 0, 0) != 0) {
        return 1;
    }
    if (RAW_CALL(&raw, STATS_THREAD, NULL, .any = true) != PCCD_E_ACCESS) {
        status |= 2;
    }
    if (RAW_CALL(&raw, STATS_THREAD, NULL, .any = false) != 0) {
        status |= 4;
    }
    if (RAW_CALL(&raw, TRACE_START, NULL, .events = 16) != PCCD_E_ACCESS) {
        status |= 8;
    }
    test_raw_close(&raw);
    return status;
}

/* If it failed, a user could watch what another one computes. */
CASE(watch__other_users_are_refused)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    int status = 0;
    pid_t child;

    if (test_is_direct()) {
        test_skip("with direct: there are no observers");
    }
    if (geteuid() != 0) {
        test_skip(TEST_ONLY_ROOT);
    }
    test_grid_open(&grid, test_shared.url, SIDE);
    turn(2, &answer);
    assert_int_equal(chmod(test_shared.directory, 0755), 0);
    assert_int_equal(chmod(test_shared.socket, 0666), 0);
    child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(ask_as_nobody());
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(chmod(test_shared.directory, 0700), 0);
    assert_int_equal(chmod(test_shared.socket, 0600), 0);
    test_grid_close(&grid);
}

CASES_WITH_DAEMON("--threads", "3");
