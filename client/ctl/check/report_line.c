/* report_line.c - the numbers of a step, to JSON and back. */
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "numbers.h"

/* X(key, member of struct report_step, its type): beside those of the answer. */
#define NUMBERS(X)                                                                       \
    X(contacts, answer.total, uint64_t)                                                  \
    X(complete, is_complete, bool)                                                       \
    X(repeat, repeats, uint32_t)
/* The same of doubles. */
#define REALS(X)                                                                         \
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

/* By the type of a number (numbers.h). */
#define SET_u32                 SET_NUMBER
#define SET_u64                 SET_NUMBER
#define SET_bool                SET_NUMBER
#define SET_f64                 SET_REAL
#define SET_NUMBER(key, member) ok = ok && set_number(object, key, (uint64_t)(member));
#define SET_REAL(key, member)   ok = ok && set_real(object, key, member);
#define GET_u32                 GET_NUMBER
#define GET_u64                 GET_NUMBER
#define GET_bool                GET_NUMBER
#define GET_f64                 GET_REAL
#define GET_NUMBER(key, member)                                                          \
    ok = ok && get_number(line, key, &value);                                            \
    member = (__typeof__(member))value;
#define GET_REAL(key, member) ok = ok && get_real(line, key, &(member));

json_t *report_line(const struct report_step *step)
{
    json_t *object = json_object();
    bool ok =
        object != NULL &&
        json_object_set_new(object, "tuning", json_string(step->answer.tuning)) == 0;
#define SET(unused, type, name, of_step, of_near, member, meaning)                       \
    SET_##type(#name, step->answer.member)
    COMMON_NUMBERS(SET, )
#undef SET
#define SET(key, member, type) SET_NUMBER(#key, step->member)
    NUMBERS(SET)
#undef SET
#define SET(key, member) SET_REAL(#key, step->member)
    REALS(SET)
#undef SET
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
    const char *tuning = json_string_value(json_object_get(line, "tuning"));
    bool ok = tuning != NULL;
    uint64_t value = 0;
    memset(step, 0, sizeof *step);
    (void)snprintf(step->answer.tuning, sizeof step->answer.tuning, "%s",
                   ok ? tuning : "");
#define GET(unused, type, name, of_step, of_near, member, meaning)                       \
    GET_##type(#name, step->answer.member)
    COMMON_NUMBERS(GET, )
#undef GET
#define GET(key, member, type) GET_NUMBER(#key, step->member)
    NUMBERS(GET)
#undef GET
#define GET(key, member) GET_REAL(#key, step->member)
    REALS(GET)
#undef GET
    for (uint32_t phase = 0; phase < REPORT_PHASE_COUNT; phase++) {
        ok = ok && get_real(line, report_phase_names[phase], &step->ms[phase]);
    }
    return ok;
}
