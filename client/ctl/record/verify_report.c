/* verify_report.c - what came of checking the answers of a recording. */
#include "verify.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "array.h"
#include "columns.h"
#include "output.h"
#include "printable.h"
#include "shown.h"

/* Return the name of a point of a pair with those points a side: "vertex", "face 2", or
 * "edge a 0" where both are of one sort. */
static const char *point_name(const uint32_t points[2], uint32_t point, char text[16])
{
    uint32_t side = point < points[0] ? 0 : 1;
    const char *feature = common_feature_names[points[side]];
    const char *of = points[0] != points[1] ? "" : side == 0 ? " a" : " b";
    if (points[side] == 1) {
        snprintf(text, 16, "%s%s", feature, of);
    } else {
        snprintf(text, 16, "%s%s %" PRIu32, feature, of, point - side * points[0]);
    }
    return text;
}

static void print_witness(const struct verify_witness *witness)
{
    const struct pccd_pair *pair = &witness->pair;
    fprintf(columns_fitted(stdout), "FAIL: step %" PRIu64 ": %s\n", witness->step,
            witness->what);
    if (!witness->has_pair) {
        return;
    }
    const uint32_t *points = common_kinds[pair->kind].points;
    const uint32_t features[2] = {pair->feature_a, pair->feature_b};
    const uint32_t objects[2] = {pair->object_a, pair->object_b};
    for (uint32_t side = 0; side < 2; side++) {
        fprintf(columns_fitted(stdout), "%s%s %" PRIu32 " of object 0x%" PRIx32,
                side == 0 ? "  " : ", ", common_feature_names[points[side]],
                features[side], objects[side]);
        if (witness->names[side][0] != '\0') {
            fprintf(columns_fitted(stdout), " (%s)", tool_shown(witness->names[side]));
        }
    }
    fputc('\n', columns_fitted(stdout));
    if (witness->has_claim) {
        fprintf(columns_fitted(stdout), "  claimed: first contact in [%a, %a]\n",
                witness->toi, witness->toi_hi);
    }
    if (witness->has_contact) {
        fprintf(columns_fitted(stdout), "  exact:   first contact in [%a, %a], t = %s\n",
                witness->lo, witness->hi, tool_shown_interval(witness->lo, witness->hi));
    } else {
        fprintf(columns_fitted(stdout), "  exact:   no contact\n");
    }
    for (uint32_t i = 0; i < 8; i++) {
        char name[16];
        if (i % 4 < points[0] + points[1]) {
            fprintf(columns_fitted(stdout), "  %-8s at t = %" PRIu32 ": %a %a %a\n",
                    point_name(points, i % 4, name), i / 4, witness->p[i][0],
                    witness->p[i][1], witness->p[i][2]);
        }
    }
}

/* ---- all of it --------------------------------------------------------------------- */

static int leave(struct verify_report *report, uint64_t step, bool is_near,
                 const char *why, struct ctl_error *error)
{
    if (!array_reserve((void **)&report->unchecked, report->unchecked_count,
                       &report->unchecked_room, sizeof *report->unchecked)) {
        return ctl_error_set(error, PCCD_E_NOMEM, "no memory for what was not checked");
    }
    struct verify_unchecked *added = &report->unchecked[report->unchecked_count++];
    *added = (struct verify_unchecked){.step = step, .is_near = is_near};
    (void)snprintf(added->why, sizeof added->why, "%s", why);
    return PCCD_OK;
}

int verify_report_add(struct verify_report *report, const struct verify_result *result,
                      struct ctl_error *error)
{
    const struct verify_counts *more = &result->counts;
    report->counts.steps += more->steps;
    report->counts.contacts += more->contacts;
    report->counts.possible += more->possible;
    report->counts.non_contacts += more->non_contacts;
    report->counts.unchecked += more->unchecked;
    report->counts.nears += more->nears;
    report->counts.near_records += more->near_records;
    report->counts.nears_unchecked += more->nears_unchecked;
    report->counts.turning += more->turning;
    if (result->is_wrong) {
        report->witness = &result->witness;
        return PCCD_OK;
    }
    return result->unchecked[0] == '\0'
               ? PCCD_OK
               : leave(report, result->step, result->is_near, result->unchecked, error);
}

int verify_report_strays(struct verify_report *report, struct answers *answers,
                         struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint64_t step = answers_stray(answers, 0); step != 0 && status == PCCD_OK;
         step = answers_stray(answers, step)) {
        status = leave(report, step, false,
                       "an answer, or records, of a step that the recording does not "
                       "have, or that has another",
                       error);
    }
    return status;
}

void verify_report_deinit(struct verify_report *report)
{
    free(report->unchecked);
    *report = (struct verify_report){.witness = NULL};
}

/* Return whether any answer was checked. */
static bool has_checked(const struct verify_counts *counts)
{
    return counts->steps != counts->unchecked || counts->nears != counts->nears_unchecked;
}

int verify_report_judge(const struct verify_report *report, const char *path,
                        struct ctl_error *error)
{
    const struct verify_counts *counts = &report->counts;
    return report->witness != NULL || has_checked(counts)
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_STATE,
                               "%s: none of %" PRIu64 " steps has an answer to check",
                               path, counts->steps);
}

/* Print what was not checked, in runs that are one behind the other and have one
 * reason. */
static void print_unchecked(const struct verify_report *report)
{
    const struct verify_unchecked *all = report->unchecked;
    for (size_t i = 0, end; i < report->unchecked_count; i = end) {
        end = i + 1;
        while (end < report->unchecked_count && all[end].is_near == all[i].is_near &&
               strcmp(all[end].why, all[i].why) == 0) {
            end++;
        }
        fprintf(columns_fitted(stdout), "not checked: %s %" PRIu64,
                all[i].is_near ? "question" : "step", all[i].step);
        if (end > i + 1) {
            fprintf(columns_fitted(stdout), " to %" PRIu64 " (%zu)", all[end - 1].step,
                    end - i);
        }
        fprintf(columns_fitted(stdout), ": %s\n", all[i].why);
    }
}

void verify_print_text(const struct verify_report *report)
{
    const struct verify_counts *counts = &report->counts;
    print_unchecked(report);
    if (report->witness != NULL) {
        print_witness(report->witness);
    }
    if (report->witness != NULL || !has_checked(counts)) {
        return;
    }
    fprintf(
        columns_fitted(stdout),
        "PASS: %" PRIu64 " %s, %" PRIu64 " %s and %" PRIu64 " %s by exact arithmetic",
        counts->steps, proto_plural(counts->steps, "step", "steps"), counts->contacts,
        proto_plural(counts->contacts, "contact", "contacts"), counts->non_contacts,
        proto_plural(counts->non_contacts, "pair that is none", "pairs that are none"));
    if (counts->possible > 0) {
        fprintf(columns_fitted(stdout), ", %" PRIu64 " possible %s not contradicted",
                counts->possible, proto_plural(counts->possible, "one", "ones"));
    }
    if (counts->turning > 0) {
        fprintf(columns_fitted(stdout),
                ", %" PRIu64 " of bodies that turn not fully told by intervals",
                counts->turning);
    }
    if (counts->unchecked > 0) {
        fprintf(columns_fitted(stdout), ", %" PRIu64 " %s without an answer to check",
                counts->unchecked, proto_plural(counts->unchecked, "step", "steps"));
    }
    if (counts->nears > 0) {
        fprintf(columns_fitted(stdout),
                "; %" PRIu64 " %s about what is near with %" PRIu64 " %s", counts->nears,
                proto_plural(counts->nears, "question", "questions"),
                counts->near_records,
                proto_plural(counts->near_records, "record", "records"));
    }
    if (counts->nears_unchecked > 0) {
        fprintf(columns_fitted(stdout), ", %" PRIu64 " of them not checked",
                counts->nears_unchecked);
    }
    fputc('\n', columns_fitted(stdout));
}

#define OF(member) COLUMN_OF(struct verify_counts, member)
static const struct column count_columns[] = {
    {"steps", .type = COLUMN_NUMBER, OF(steps)},
    {"contacts", .type = COLUMN_NUMBER, OF(contacts)},
    {"possible", .type = COLUMN_NUMBER, OF(possible)},
    {"non_contacts", .type = COLUMN_NUMBER, OF(non_contacts)},
    {"unchecked", .type = COLUMN_NUMBER, OF(unchecked)},
    {"nears", .type = COLUMN_NUMBER, OF(nears)},
    {"near_records", .type = COLUMN_NUMBER, OF(near_records)},
    {"nears_unchecked", .type = COLUMN_NUMBER, OF(nears_unchecked)},
    {"turning", .type = COLUMN_NUMBER, OF(turning)},
    {0}};
#undef OF

bool verify_counts_json(json_t *object, const struct verify_counts *counts)
{
    return columns_add(object, count_columns, counts);
}

bool verify_counts_read(const json_t *object, struct verify_counts *counts)
{
    return columns_read(object, count_columns, counts);
}

#define OF(member) COLUMN_OF(struct verify_witness, member)
static const struct column witness_columns[] = {
    {"step", .type = COLUMN_NUMBER, OF(step)},
    {"what", .type = COLUMN_CHARS, OF(what)},
    {"has_pair", .type = COLUMN_FLAG, OF(has_pair)},
    {"kind", .type = COLUMN_NUMBER, OF(pair.kind)},
    {"object_a", .type = COLUMN_NUMBER, OF(pair.object_a)},
    {"feature_a", .type = COLUMN_NUMBER, OF(pair.feature_a)},
    {"object_b", .type = COLUMN_NUMBER, OF(pair.object_b)},
    {"feature_b", .type = COLUMN_NUMBER, OF(pair.feature_b)},
    {"name_a", .type = COLUMN_CHARS, OF(names[0])},
    {"name_b", .type = COLUMN_CHARS, OF(names[1])},
    {"has_contact", .type = COLUMN_FLAG, OF(has_contact)},
    {"contact_lo", .type = COLUMN_REAL, OF(lo)},
    {"contact_hi", .type = COLUMN_REAL, OF(hi)},
    {0}};
#undef OF

/* Doubles as "%a", which is exact. */
static json_t *reals_json(const double *values, size_t count)
{
    json_t *array = json_array();
    char text[64];
    for (size_t i = 0; i < count; i++) {
        snprintf(text, sizeof text, "%a", values[i]);
        json_array_append_new(array, json_string(text));
    }
    return array;
}

static bool reals_read(const json_t *array, double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const char *text = json_string_value(json_array_get(array, i));
        char *end = NULL;
        values[i] = text != NULL ? strtod(text, &end) : 0;
        if (text == NULL || end == text || *end != '\0') {
            return false;
        }
    }
    return true;
}

json_t *verify_witness_json(const struct verify_witness *witness)
{
    const double claimed[2] = {witness->toi, witness->toi_hi};
    json_t *object = columns_json(witness_columns, witness);
    bool ok =
        json_object_set_new(object, "points", reals_json(&witness->p[0][0], 24)) == 0;
    ok = json_object_set_new(object, "claimed",
                             reals_json(claimed, witness->has_claim ? 2 : 0)) == 0 &&
         ok;
    if (!ok) {
        json_decref(object);
        return NULL;
    }
    return object;
}

bool verify_witness_read(const json_t *object, struct verify_witness *witness)
{
    const json_t *claimed = json_object_get(object, "claimed");
    double claim[2] = {0, 0};
    memset(witness, 0, sizeof *witness);
    witness->has_claim = json_array_size(claimed) == 2;
    bool ok = columns_read(object, witness_columns, witness) &&
              witness->pair.kind < PCCD_KIND_COUNT &&
              reals_read(json_object_get(object, "points"), &witness->p[0][0], 24) &&
              reals_read(claimed, claim, witness->has_claim ? 2 : 0);
    witness->toi = claim[0];
    witness->toi_hi = claim[1];
    return ok;
}

static json_t *unchecked_json(const struct verify_report *report)
{
    json_t *array = json_array();
    for (size_t i = 0; i < report->unchecked_count && array != NULL; i++) {
        const struct verify_unchecked *one = &report->unchecked[i];
        json_t *told = json_pack("{s:I, s:b, s:s}", "step", (json_int_t)one->step,
                                 "is_near", one->is_near, "why", one->why);
        if (json_array_append_new(array, told) != 0) {
            json_decref(array);
            return NULL;
        }
    }
    return array;
}

bool verify_print_json(const struct verify_report *report)
{
    json_t *all = json_pack("{s:b}", "pass",
                            report->witness == NULL && has_checked(&report->counts));
    bool ok = all != NULL && verify_counts_json(all, &report->counts);
    ok = ok && json_object_set_new(all, "not_checked", unchecked_json(report)) == 0;
    if (ok && report->witness != NULL) {
        ok = json_object_set_new(all, "witness", verify_witness_json(report->witness)) ==
             0;
    }
    return output_json(all, ok, stdout);
}
