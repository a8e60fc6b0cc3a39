/* report_line.c - the numbers of a step, to JSON and back. */
#include "report.h"

#include <string.h>

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
        {"first_known", .type = COLUMN_NUMBER, OF(first.is_known)},
    {"first_kind", .type = COLUMN_NUMBER, OF(first.kind)},
    {"first_part_a", .type = COLUMN_NUMBER, OF(first.part[0])},
    {"first_part_b", .type = COLUMN_NUMBER, OF(first.part[1])},
    {"first_a", .type = COLUMN_NUMBER, OF(first.feature[0])},
    {"first_b", .type = COLUMN_NUMBER, OF(first.feature[1])},
    {"first_other_a", .type = COLUMN_NUMBER, OF(first.other[0])},
    {"first_other_b", .type = COLUMN_NUMBER, OF(first.other[1])},
    {"first_alone", .type = COLUMN_NUMBER, OF(first.is_alone)},
    {"first_toi", .type = COLUMN_EXACT, OF(first.toi)},
    {"first_toi_hi", .type = COLUMN_EXACT, OF(first.toi_hi)},
    {"first_x", .type = COLUMN_EXACT, OF(first.x)},
    {"first_y", .type = COLUMN_EXACT, OF(first.y)},
    {"first_z", .type = COLUMN_EXACT, OF(first.z)},
    {"ends_known", .type = COLUMN_NUMBER, OF(ends.is_known)},
    {0}};

const struct column report_ends_columns[] = {
    {"ends_crossed", .type = COLUMN_NUMBER, OF(ends.crossings)},
    {"standing", .type = COLUMN_NUMBER, OF(ends.standing)},
    {"new", .type = COLUMN_NUMBER, OF(ends.fresh)},
    {"gone", .type = COLUMN_NUMBER, OF(ends.gone)},
    {0}};

json_t *report_line(const struct report_step *step)
{
    json_t *line = columns_json(columns, step);
    if (line != NULL && !columns_add(line, report_ends_columns, step)) {
        json_decref(line);
        line = NULL;
    }
    return line;
}

bool report_line_read(const json_t *line, struct report_step *step)
{
    memset(step, 0, sizeof *step);
    return columns_read(line, columns, step) &&
           columns_read(line, report_ends_columns, step);
}
