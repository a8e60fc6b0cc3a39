/* judge.c - from steps to a verdict. */
#include "judge.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "output.h"
#include "printable.h"
#include "shown.h"
#include "whole_file.h"

/* ---- a contact --------------------------------------------------------------------- */

static void contact_set(struct judged_contact *contact, const struct report_first *first,
                        char *const *names)
{
    *contact = (struct judged_contact){.at = *first};
    for (int side = 0; side < 2 && first->is_known; side++) {
        const char *name =
            first->part[side] != REPORT_NO_PART ? names[first->part[side]] : "";
        (void)snprintf(contact->names[side], JUDGE_NAME_BYTES, "%s", name);
    }
}

/* "vertex 4 of "box"" or "edge 3-7" */
static void print_feature(FILE *to, const struct judged_contact *contact, int side)
{
    const struct report_first *first = &contact->at;
    uint32_t points = common_kinds[first->kind].points[side];
    fprintf(to, "%s %" PRIu32, common_feature_names[points], first->feature[side]);
    if (points == 2) {
        fprintf(to, "-%" PRIu32, first->other[side]);
    }
    if (contact->names[side][0] != '\0') {
        fprintf(to, " of \"%s\"", tool_shown(contact->names[side]));
    }
}

static void print_contact(FILE *to, const struct judged_contact *contact)
{
    fprintf(to, ", at t = %s, between ",
            tool_shown_interval(contact->at.toi, contact->at.toi_hi));
    print_feature(to, contact, 0);
    fputs(" and ", to);
    print_feature(to, contact, 1);
}

/* As report_json has it, with both times and without the place, which compilers may round
 * in more than one way. */
static json_t *contact_json(const struct judged_contact *contact, bool *ok)
{
    const struct report_first *first = &contact->at;
    if (!first->is_known) {
        return json_null();
    }
    json_t *object = json_object();
    json_set(object, "kind", json_string(common_kinds[first->kind].name), ok);
    json_set(object, "toi", json_real(first->toi), ok);
    json_set(object, "toi_hi", json_real(first->toi_hi), ok);
    for (int side = 0; side < 2; side++) {
        uint32_t points = common_kinds[first->kind].points[side];
        json_t *feature = json_object();
        if (contact->names[side][0] != '\0') {
            json_set(feature, "object", json_text(contact->names[side]), ok);
        }
        json_set(feature, common_feature_names[points],
                 points == 2 ? json_pack("[I, I]", (json_int_t)first->feature[side],
                                         (json_int_t)first->other[side])
                             : json_integer((json_int_t)first->feature[side]),
                 ok);
        json_set(object, side == 0 ? "a" : "b", feature, ok);
    }
    return object;
}

static bool feature_read(const json_t *object, struct judged_contact *contact, int side)
{
    struct report_first *first = &contact->at;
    const json_t *feature = json_object_get(object, side == 0 ? "a" : "b");
    const char *name = json_string_value(json_object_get(feature, "object"));
    uint32_t points = common_kinds[first->kind].points[side];
    const json_t *number = json_object_get(feature, common_feature_names[points]);
    const json_t *low = points == 2 ? json_array_get(number, 0) : number;
    first->part[side] = REPORT_NO_PART;
    first->feature[side] = (uint32_t)json_integer_value(low);
    first->other[side] = (uint32_t)json_integer_value(json_array_get(number, 1));
    (void)snprintf(contact->names[side], JUDGE_NAME_BYTES, "%s",
                   name != NULL ? name : "");
    return json_is_integer(low);
}

static bool contact_read(const json_t *object, struct judged_contact *contact)
{
    struct report_first *first = &contact->at;
    const char *kind = json_string_value(json_object_get(object, "kind"));
    *contact = (struct judged_contact){.at.is_known = !json_is_null(object)};
    if (!first->is_known) {
        return true;
    }
    while (kind != NULL && first->kind < PCCD_KIND_COUNT &&
           strcmp(kind, common_kinds[first->kind].name) != 0) {
        first->kind++;
    }
    first->toi = json_real_value(json_object_get(object, "toi"));
    first->toi_hi = json_real_value(json_object_get(object, "toi_hi"));
    return kind != NULL && first->kind < PCCD_KIND_COUNT &&
           feature_read(object, contact, 0) && feature_read(object, contact, 1);
}

/* ---- a step ------------------------------------------------------------------------ */

void judged_set(struct judged *judged, char *const *names)
{
    const struct pccd_answer *answer = &judged->report.answer;
    /* What begins crossed answers yes by that alone. */
    judged->meets = answer->total > 0 || answer->verdict == PCCD_VERDICT_POSSIBLE ||
                    (answer->verdict == PCCD_VERDICT_YES &&
                     answer->crossings + answer->start_inside == 0);
    contact_set(&judged->first, &judged->report.first, names);
}

void judged_set_first(struct judged *judged, const char *frame,
                      const struct crossings *first)
{
    *judged = (struct judged){.report = {.to = frame,
                                         .is_complete = first->is_complete,
                                         .ends = {.is_known = true,
                                                  .crossings = first->count,
                                                  .standing = first->count}}};
}

bool judged_fails(const struct judged *judged)
{
    return judged->meets || judged->report.ends.fresh > 0 ||
           judged->report.answer.start_inside > 0;
}

void judged_print(FILE *to, const struct judged *judged)
{
    const struct report_ends *ends = &judged->report.ends;
    if (judged->number == 0 && ends->crossings > 0) {
        fprintf(to,
                "standing   %" PRIu64 " %s in the first frame: from here on, what is new "
                "and what is gone\n",
                ends->crossings, proto_plural(ends->crossings, "crossing", "crossings"));
    }
    if (ends->fresh + ends->gone > 0) {
        fprintf(to,
                "           ends crossed %" PRIu64 " %s: %" PRIu64 " new, %" PRIu64
                " of the first frame's; %" PRIu64 " gone\n",
                ends->crossings, proto_plural(ends->crossings, "time", "times"),
                ends->fresh, ends->standing, ends->gone);
    }
}

#define OF(member) COLUMN_OF(struct judged, member)
#define COUNT(name)                                                                      \
    {                                                                                    \
#name, .type = COLUMN_NUMBER, OF(report.answer.name)                             \
    }

static const struct column numbers[] = {
    {"step", .type = COLUMN_NUMBER, OF(number)},
    {"complete", .type = COLUMN_FLAG, OF(report.is_complete)},
    {"meets", .type = COLUMN_FLAG, OF(meets)},
    {"contacts", .type = COLUMN_NUMBER, OF(report.answer.total)},
    COUNT(possible),
    COUNT(initial),
    COUNT(inside),
    COUNT(start_inside),
    COUNT(entering),
    COUNT(sliding),
    COUNT(leaving),
    {"begins_crossed", .type = COLUMN_NUMBER, OF(report.answer.crossings)},
    {0}};

json_t *judged_line(const struct judged *judged)
{
    const struct pccd_answer *answer = &judged->report.answer;
    char hash[PROTO_HASH_BYTES];
    bool ok = true;
    json_t *object = json_object();
    if (judged->number == 0) {
        json_set(object, "frame", json_text(tool_base_name(judged->report.to)), &ok);
        json_set_count(object, "crossings", judged->report.ends.crossings, &ok);
        json_set(object, "complete", json_boolean(judged->report.is_complete), &ok);
    } else {
        json_set(object, "to", json_text(tool_base_name(judged->report.to)), &ok);
        ok = ok && columns_add(object, numbers, judged) &&
             columns_add(object, report_ends_columns, &judged->report);
        json_set(object, "fails", json_boolean(judged_fails(judged)), &ok);
        report_kinds(object, answer->counts, &ok);
        json_set(object, "first", contact_json(&judged->first, &ok), &ok);
        proto_hash_text(PCCD_HASH_VERSION, answer->hash, hash);
        json_set(object, "hash", json_string(hash), &ok);
    }
    if (!ok) {
        json_decref(object);
        object = NULL;
    }
    return object;
}

bool judged_read(const json_t *line, struct judged *judged)
{
    struct pccd_answer *answer = &judged->report.answer;
    struct report_ends *ends = &judged->report.ends;
    memset(judged, 0, sizeof *judged);
    ends->is_known = true;
    if (json_object_get(line, "frame") != NULL) {
        ends->crossings =
            (uint64_t)json_integer_value(json_object_get(line, "crossings"));
        ends->standing = ends->crossings;
        judged->report.is_complete = json_is_true(json_object_get(line, "complete"));
        return json_is_integer(json_object_get(line, "crossings"));
    }
    for (uint32_t kind = 0; kind < PCCD_KIND_COUNT; kind++) {
        answer->counts[kind] =
            (uint64_t)json_integer_value(json_object_get(line, common_kinds[kind].name));
    }
    bool is_read = columns_read(line, numbers, judged) && judged->number > 0 &&
                   columns_read(line, report_ends_columns, &judged->report) &&
                   contact_read(json_object_get(line, "first"), &judged->first);
    answer->toi_first = judged->first.at.is_known ? judged->first.at.toi : 2;
    return is_read;
}

/* ---- all of them ------------------------------------------------------------------- */

void judge_take(struct judge *judge, const struct judged *judged)
{
    const struct report_step *report = &judged->report;
    judge->incomplete += !report->is_complete;
    if (judged->number == 0) {
        judge->knows_standing = true;
        judge->crossings = report->ends.crossings;
        judge->standing = report->ends.crossings;
        judge->begins_crossed = report->ends.crossings > 0;
        return;
    }
    judge->steps++;
    judge->left_out += report->answer.sliding + report->answer.leaving;
    judge->begins_crossed = judge->begins_crossed || report->answer.crossings > 0;
    if (judged->meets || report->answer.start_inside > 0) {
        judge->meeting++;
        if (judge->meets_at == 0) {
            judge->meets_at = judged->number;
            judge->meets = judged->first;
        }
    }
    if (report->ends.is_known) {
        judge->standing = report->ends.standing;
        judge->fresh += report->ends.fresh;
        if (judge->fresh_at == 0 && report->ends.fresh > 0) {
            judge->fresh_at = judged->number;
        }
    }
}

static bool is_free(const struct judge *judge)
{
    return judge->meeting + judge->fresh == 0 && !judge->begins_crossed;
}

int judge_end(const struct judge *judge, bool *is_right, struct ctl_error *error)
{
    *is_right = is_free(judge);
    return judge->incomplete == 0 || !*is_right
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_TIMEOUT,
                               "nothing was found, but %" PRIu32 " of %" PRIu32
                               " %s incomplete",
                               judge->incomplete, judge->steps,
                               proto_plural(judge->steps, "answer is", "answers are"));
}

void judge_print_part(FILE *to, const struct judge_part *part, const char *before)
{
    if (part->count > 0 && part->first > part->last) {
        fprintf(to, "%sno step (part %" PRIu32 " of %" PRIu32 ")", before, part->number,
                part->count);
    } else if (part->count > 0) {
        fprintf(to,
                "%ssteps %" PRIu32 " to %" PRIu32 " (part %" PRIu32 " of %" PRIu32 ")",
                before, part->first, part->last, part->number, part->count);
    }
}

static void print_verdict(FILE *to, const struct judge *judge)
{
    const struct judge_part *part = &judge->part;
    if (judge->meeting > 0) {
        fprintf(to, "%s first in step %" PRIu32, judge->is_thick ? "too near" : "meets",
                judge->meets_at);
        if (judge->meets.at.is_known) {
            print_contact(to, &judge->meets);
        }
        fprintf(to, "; in %" PRIu32 " of %" PRIu32 " %s", judge->meeting, judge->steps,
                proto_plural(judge->steps, "step", "steps"));
    } else if (part->count > 0 && part->first > part->last) {
        fputs("no step is in this part", to);
    } else if (judge->begins_crossed || judge->fresh > 0) {
        fputs("crossed, and nothing else meets", to);
        judge_print_part(to, part, " in ");
    } else if (judge->incomplete > 0) {
        fputs("not known: an answer is incomplete", to);
    } else {
        fprintf(to, "free: nothing %s",
                judge->leaves_out ? "enters what it touches, or meets" : "meets");
        judge_print_part(to, part, " in ");
        fputs(", at frames or between them", to);
    }
}

void judge_print(FILE *to, const struct judge *judge, const char *label)
{
    fprintf(to, "%-10s ", label);
    print_verdict(to, judge);
    if (judge->knows_standing && judge->crossings > 0) {
        fprintf(to, "; standing %" PRIu64 " %s, in the last frame %" PRIu64,
                judge->crossings, proto_plural(judge->crossings, "crossing", "crossings"),
                judge->standing);
    }
    if (judge->fresh > 0) {
        fprintf(to, "; new %" PRIu64 " %s, the first at the end of step %" PRIu32,
                judge->fresh, proto_plural(judge->fresh, "crossing", "crossings"),
                judge->fresh_at);
    } else if (judge->knows_standing && judge->crossings > 0) {
        fputs("; no new crossings", to);
    }
    if (judge->is_thick && judge->steps > 0) {
        fprintf(to, "; thickness %s",
                !is_free(judge)         ? "not kept"
                : judge->left_out > 0   ? "not kept by what slides or leaves"
                : judge->incomplete > 0 ? "not known"
                                        : "kept");
    }
    fputs("\n           frames are samples: between them each vertex is taken to go "
          "straight\n",
          to);
}

json_t *judge_line(const struct judge *judge)
{
    bool ok = true;
    json_t *object = json_object();
    const char *verdict = judge->meeting > 0                          ? "meets"
                          : judge->begins_crossed || judge->fresh > 0 ? "crossed"
                          : judge->incomplete > 0                     ? "unknown"
                                                                      : "free";
    json_set(object, "verdict", json_string(verdict), &ok);
    json_set_count(object, "steps", judge->steps, &ok);
    json_set_count(object, "meeting", judge->meeting, &ok);
    json_set(object, "first_step",
             judge->meeting > 0 ? json_integer(judge->meets_at) : json_null(), &ok);
    json_set(object, "first", contact_json(&judge->meets, &ok), &ok);
    json_set_count(object, "standing", judge->crossings, &ok);
    json_set_count(object, "standing_last", judge->standing, &ok);
    json_set_count(object, "new", judge->fresh, &ok);
    json_set(object, "new_first_step",
             judge->fresh > 0 ? json_integer(judge->fresh_at) : json_null(), &ok);
    json_set(object, "thickness_kept",
             judge->is_thick ? json_boolean(is_free(judge) && judge->left_out == 0)
                             : json_null(),
             &ok);
    json_set_count(object, "incomplete", judge->incomplete, &ok);
    if (!ok) {
        json_decref(object);
        object = NULL;
    }
    return object;
}

bool judge_is_line(const json_t *line)
{
    return json_object_get(line, "verdict") != NULL;
}
