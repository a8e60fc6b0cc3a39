/* client/ctl/check/report_line.c - the numbers of a step, to JSON and back.
 *
 * Room:     client/ctl.
 * Does:     name each number once, in a list that both directions go through.
 * Threads:  one.
 * Source:   report_line.h; numbers.h.
 */
#include "report_line.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kinds.h"
#include "numbers.h"

/* X(key, member of struct report_step, its type). */
#define NUMBERS(X)                                                                       \
    X(mode, answer.mode, enum pccd_mode)                                                 \
    X(method, answer.method, enum pccd_method)                                           \
    X(incomplete, answer.incomplete, enum pccd_incomplete)                               \
    X(verdict, answer.verdict, enum pccd_verdict)                                        \
    X(threads, answer.threads, uint32_t)                                                 \
    X(contacts, answer.total, uint64_t)                                                  \
    X(possible, answer.possible, uint64_t)                                               \
    X(initial, answer.initial, uint64_t)                                                 \
    X(inside, answer.inside, uint64_t)                                                   \
    X(crowded, answer.crowded, bool)                                                     \
    X(complete, is_complete, bool)                                                       \
    X(repeat, repeats, uint32_t)
/* The same of doubles. */
#define REALS(X)                                                                         \
    X(toi_first, answer.toi_first)                                                       \
    X(safe_step, answer.safe_step)                                                       \
    X(first_ms, first_ms)                                                                \
    X(round_trip_ms, round_trip_ms)

static bool set_number(json_t *object, const char *key, uint64_t value)
{
    return json_object_set_new(object, key, json_integer((json_int_t)value)) == 0;
}

static bool get_number(const json_t *object, const char *key, uint64_t *value)
{
    const json_t *got = json_object_get(object, key);
    *value = (uint64_t)json_integer_value(got);
    return json_is_integer(got);
}

/* As "%a", which is exact, and can be infinite. */
static bool set_real(json_t *object, const char *key, double value)
{
    char text[40];
    (void)snprintf(text, sizeof text, "%a", value);
    return json_object_set_new(object, key, json_string(text)) == 0;
}

static bool get_real(const json_t *object, const char *key, double *value)
{
    const char *text = json_string_value(json_object_get(object, key));
    char *end = NULL;
    *value = text != NULL ? strtod(text, &end) : 0;
    return text != NULL && end != text && *end == '\0';
}

static bool set_texts(json_t *object, const struct report_step *step)
{
    char hash[40];
    (void)snprintf(hash, sizeof hash, "%016" PRIx64 "%016" PRIx64, step->answer.hash[0],
                   step->answer.hash[1]);
    return json_object_set_new(object, "hash", json_string(hash)) == 0 &&
           json_object_set_new(object, "tuning", json_string(step->answer.tuning)) == 0;
}

static bool get_texts(const json_t *object, struct report_step *step)
{
    const char *hash = json_string_value(json_object_get(object, "hash"));
    const char *tuning = json_string_value(json_object_get(object, "tuning"));
    uint64_t *to = step->answer.hash;
    if (hash == NULL || tuning == NULL ||
        sscanf(hash, "%16" SCNx64 "%16" SCNx64, &to[0], &to[1]) != 2) {
        return false;
    }
    (void)snprintf(step->answer.tuning, sizeof step->answer.tuning, "%s", tuning);
    return true;
}

json_t *report_line(const struct report_step *step)
{
    json_t *object = json_object();
    bool ok = object != NULL && set_texts(object, step);
#define SET(key, member, type)                                                           \
    ok = ok && set_number(object, #key, (uint64_t)step->member);
    NUMBERS(SET)
#undef SET
#define SET(key, member) ok = ok && set_real(object, #key, step->member);
    REALS(SET)
#undef SET
#define SET(unused, type, name, of_step, of_near, member, meaning)                       \
    ok = ok && set_number(object, #name, step->answer.member);
    COMMON_COUNTERS(SET, )
#undef SET
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        ok = ok && set_number(object, common_kinds[kind].name, step->answer.counts[kind]);
    }
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        ok = ok && set_real(object, report_phase_names[phase], step->ms[phase]);
    }
    if (!ok) {
        json_decref(object);
        object = NULL;
    }
    return object;
}

bool report_line_read(const json_t *line, struct report_step *step)
{
    uint64_t value = 0;
    memset(step, 0, sizeof *step);
    bool ok = get_texts(line, step);
#define GET(key, member, type)                                                           \
    ok = ok && get_number(line, #key, &value);                                           \
    step->member = (type)value;
    NUMBERS(GET)
#undef GET
#define GET(key, member) ok = ok && get_real(line, #key, &step->member);
    REALS(GET)
#undef GET
#define GET(unused, type, name, of_step, of_near, member, meaning)                       \
    ok = ok && get_number(line, #name, &step->answer.member);
    COMMON_COUNTERS(GET, )
#undef GET
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        ok = ok && get_number(line, common_kinds[kind].name, &step->answer.counts[kind]);
    }
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        ok = ok && get_real(line, report_phase_names[phase], &step->ms[phase]);
    }
    return ok;
}
