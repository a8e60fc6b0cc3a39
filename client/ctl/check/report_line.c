/* report_line.c - the numbers of a step, to JSON and back. */
#include "report.h"

#include <string.h>

#include "columns.h"
#include "numbers.h"

#define OF(member) COLUMN_OF(struct report_step, member)

/* By the type of a number (numbers.h). */
#define TYPE_u32  COLUMN_NUMBER
#define TYPE_u64  COLUMN_NUMBER
#define TYPE_bool COLUMN_NUMBER
#define TYPE_f64  COLUMN_EXACT

static const struct column columns[] = {
    {"tuning", .type = COLUMN_CHARS, OF(answer.tuning)},
#define NUMBER(unused, form, name, of_step, of_near, member, meaning)                    \
    {#name, .type = TYPE_##form, OF(answer.member)},
    COMMON_NUMBERS(NUMBER, )
#undef NUMBER
        {"contacts", .type = COLUMN_NUMBER, OF(answer.total)},
    {"complete", .type = COLUMN_NUMBER, OF(is_complete)},
    {"repeat", .type = COLUMN_NUMBER, OF(repeats)},
    {"first_ms", .type = COLUMN_EXACT, OF(first_ms)},
    {"round_trip_ms", .type = COLUMN_EXACT, OF(round_trip_ms)},
#define PHASE(name) {#name, .type = COLUMN_EXACT, OF(ms[REPORT_##name])},
    REPORT_PHASES(PHASE)
#undef PHASE
        {0}};

json_t *report_line(const struct report_step *step)
{
    return columns_json(columns, step);
}

bool report_line_read(const json_t *line, struct report_step *step)
{
    memset(step, 0, sizeof *step);
    return columns_read(line, columns, step);
}
