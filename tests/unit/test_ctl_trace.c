/* test_ctl_trace.c - recordings as files for Perfetto. */
#include "cases.h"

#include <jansson.h>

#include "trace_file.h"

#define ORIGIN_NS  5000000000u
#define DAEMON_PID 4711u

/* A file in memory that events can be added to. */
static void begin(struct trace_file *trace)
{
    *trace =
        (struct trace_file){.file = tmpfile(), .origin_ns = ORIGIN_NS, .pid = DAEMON_PID};
    assert_non_null(trace->file);
    fputs("{\"traceEvents\":[\n", trace->file);
}

static json_t *end(struct trace_file *trace, uint64_t lost)
{
    json_error_t error;

    trace_file_finish(trace, lost);
    rewind(trace->file);
    json_t *root = json_loadf(trace->file, 0, &error);
    if (root == NULL) {
        fail_msg("line %d: %s", error.line, error.text);
    }
    trace_file_deinit(trace);
    assert_int_equal(json_integer_value(json_object_get(
                         json_object_get(root, "otherData"), "lost_events")),
                     lost);
    return root;
}

static const char *text_of(const json_t *event, const char *key)
{
    const char *text = json_string_value(json_object_get(event, key));
    return text != NULL ? text : "";
}

static json_int_t number_of(const json_t *event, const char *key)
{
    const json_t *value = json_object_get(event, key);
    assert_true(json_is_integer(value));
    return json_integer_value(value);
}

static uint64_t ns_of(const json_t *event, const char *key)
{
    const json_t *value = json_object_get(event, key);
    assert_true(json_is_number(value));
    assert_true(json_number_value(value) >= 0);
    return (uint64_t)(json_number_value(value) * 1000 + 0.5);
}

/* The slice of that name, or NULL. */
static const json_t *find(const json_t *root, const char *name)
{
    const json_t *events = json_object_get(root, "traceEvents");
    for (size_t i = 0; i < json_array_size(events); i++) {
        const json_t *event = json_array_get(events, i);
        if (strcmp(text_of(event, "ph"), "X") == 0 &&
            strcmp(text_of(event, "name"), name) == 0) {
            return event;
        }
    }
    return NULL;
}

static bool has_label(const json_t *root, const char *what, const char *label)
{
    const json_t *events = json_object_get(root, "traceEvents");
    for (size_t i = 0; i < json_array_size(events); i++) {
        const json_t *event = json_array_get(events, i);
        if (strcmp(text_of(event, "ph"), "M") == 0 &&
            strcmp(text_of(event, "name"), what) == 0 &&
            strcmp(text_of(json_object_get(event, "args"), "name"), label) == 0) {
            return true;
        }
    }
    return false;
}

/* If it failed: a file would not open, or show a slice at the wrong time or place. */
CASE(trace__slices_keep_time_track_and_arguments)
{
    const struct pccd_trace_event events[] = {
        {ORIGIN_NS + 1234567, ORIGIN_NS + 2345678, PCCD_TRACE_UNIT, 3, 17, 99},
        {ORIGIN_NS - 10, ORIGIN_NS + 5, PCCD_TRACE_STEP, 0, 1000, 4},
        {ORIGIN_NS + 7, ORIGIN_NS + 7, PCCD_TRACE_WAIT, 1, 0, 0},
        {ORIGIN_NS + 20, ORIGIN_NS + 21, PCCD_TRACE_RECEIVE, 8, UINT32_MAX, 6},
    };
    struct trace_file trace;
    begin(&trace);
    trace_file_add(&trace, events, 2);
    trace_file_add(&trace, events + 2, 2);
    json_t *root = end(&trace, 77);
    const json_t *unit = find(root, "unit");
    assert_non_null(unit);
    assert_int_equal(ns_of(unit, "ts"), 1234567);
    assert_int_equal(ns_of(unit, "dur"), 1111111);
    assert_int_equal(number_of(unit, "pid"), DAEMON_PID);
    assert_int_equal(number_of(json_object_get(unit, "args"), "node"), 17);
    assert_int_equal(number_of(json_object_get(unit, "args"), "triangles"), 99);
    const json_t *step = find(root, "step"); /* began before the recording: cut */
    assert_int_equal(ns_of(step, "ts"), 0);
    assert_int_equal(ns_of(step, "dur"), 5);
    assert_int_equal(number_of(unit, "tid") - number_of(step, "tid"), 3);
    assert_int_equal(ns_of(find(root, "wait"), "dur"), 0);
    assert_non_null(find(root, "receive unknown method"));
    assert_true(has_label(root, "process_name", "pccdd 4711"));
    assert_true(has_label(root, "thread_name", "loop"));
    assert_true(has_label(root, "thread_name", "team 0"));
    assert_true(has_label(root, "thread_name", "team 3"));
    assert_false(has_label(root, "thread_name", "team 4"));
    json_decref(root);
}

/* If it failed: requests in flight at a time would be drawn over each other, and those of
 * different clients be mixed up. */
CASE(trace__requests_that_overlap_get_tracks_of_their_own)
{
    struct pccd_trace_event events[40];
    struct trace_file trace;
    uint64_t ends_ns[2][5] = {{0}};
    uint32_t seen = 0;
    for (uint32_t i = 0; i < 40; i++) { /* three at a time, answered out of order */
        uint64_t at = ORIGIN_NS + 100 * (uint64_t)((i * 7) % 40);
        events[i] = (struct pccd_trace_event){
            at, at + 250 + i % 3 * 20, PCCD_TRACE_REQUEST, 5 + i % 2, 0, i};
    }
    begin(&trace);
    trace_file_add(&trace, events, 40);
    json_t *root = end(&trace, 0);
    const json_t *array = json_object_get(root, "traceEvents");
    for (size_t i = 0; i < json_array_size(array); i++) {
        const json_t *event = json_array_get(array, i);
        if (strcmp(text_of(event, "ph"), "X") != 0) {
            continue;
        }
        json_int_t client = number_of(json_object_get(event, "args"), "client");
        json_int_t tid = number_of(event, "tid");
        assert_true(number_of(event, "pid") != DAEMON_PID);
        assert_in_range(client, 5, 6);
        assert_in_range(tid, 1, 4);
        /* They come in the order of their beginnings: none begins before the last of its
         * track has ended. */
        assert_true(ns_of(event, "ts") >= ends_ns[client - 5][tid]);
        ends_ns[client - 5][tid] = ns_of(event, "ts") + ns_of(event, "dur");
        assert_string_equal(text_of(event, "name"), "hello");
        seen++;
    }
    assert_int_equal(seen, 40);
    assert_true(has_label(root, "process_name", "client 5"));
    assert_true(has_label(root, "process_name", "client 6"));
    assert_true(has_label(root, "thread_name", "requests 1"));
    json_decref(root);
}

/* If it failed: a recording without events, or of a newer daemon, would not open. */
CASE(trace__empty_and_unknown_events_are_valid_json)
{
    const struct pccd_trace_event odd[] = {
        {ORIGIN_NS + 9, ORIGIN_NS + 3, PCCD_TRACE_KIND_COUNT, 2, 1, 1},
        {0, UINT64_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX},
        {0, UINT64_MAX, PCCD_TRACE_REQUEST, UINT32_MAX, UINT32_MAX, UINT32_MAX},
    };
    struct trace_file trace;
    begin(&trace);
    json_decref(end(&trace, 0));
    begin(&trace);
    trace_file_add(&trace, odd, 3);
    json_t *root = end(&trace, UINT32_MAX);
    assert_non_null(find(root, "unknown"));
    assert_non_null(find(root, "unknown method"));
    json_decref(root);
}
