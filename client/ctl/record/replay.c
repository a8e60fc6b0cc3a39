/* replay.c - compares answers, and says what came of it. */
#include "replay.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "columns.h"
#include "output.h"
#include "printable.h"
#include "shown.h"

enum replay_what {
    WHAT_STATUS,
    WHAT_TOTAL,
    WHAT_HASH,
    WHAT_TIME,
    WHAT_POSSIBLE,
    WHAT_DISTANCE,
    WHAT_CROSSINGS,
    WHAT_VERDICT,
    WHAT_NOTHING
};

const char *const replay_whats[REPLAY_WHAT_COUNT] = {
    "status",
    "number of records",
    "hash",
    "earliest time",
    "number of possible or initial contacts",
    "least or greatest distance",
    "number of crossings",
    "verdict"};

const char *const replay_outcome_names[REPLAY_OUTCOME_COUNT] = {
#define OUTCOME_NAME(name, text) text,
    REPLAY_OUTCOMES(OUTCOME_NAME)
#undef OUTCOME_NAME
};

/* ---- comparing --------------------------------------------------------------------- */

static struct replay_side side_of(int status, uint64_t total, const uint64_t hash[2],
                                  double toi_first)
{
    struct replay_side side = {.status = status};
    if (status == PCCD_OK) {
        side = (struct replay_side){
            .total = total, .hash = {hash[0], hash[1]}, .toi_first = toi_first};
    }
    return side;
}

static enum replay_what difference(const struct play_step *step)
{
    const struct record_answer *then = step->recorded;
    const struct pccd_answer *now = step->answer;
    if (then->status != now->status) {
        return WHAT_STATUS;
    }
    if (then->status != PCCD_OK) {
        return WHAT_NOTHING;
    }
    if (then->total != now->total ||
        memcmp(then->counts, now->counts, sizeof then->counts) != 0) {
        return WHAT_TOTAL;
    }
    if (memcmp(then->hash, now->hash, sizeof then->hash) != 0) {
        return WHAT_HASH;
    }
    if (step->asked == NULL) {
        if (memcmp(&then->toi_first, &now->toi_first, sizeof(double)) != 0) {
            return WHAT_TIME;
        }
        if (then->possible != now->possible || then->initial != now->initial) {
            return WHAT_POSSIBLE;
        }
    } else {
        if (memcmp(&then->distance_min, &now->distance_min, sizeof(double)) != 0 ||
            memcmp(&then->distance_max, &now->distance_max, sizeof(double)) != 0) {
            return WHAT_DISTANCE;
        }
        if (then->crossings != now->crossings) {
            return WHAT_CROSSINGS;
        }
    }
    return then->verdict != (uint32_t)now->verdict ? WHAT_VERDICT : WHAT_NOTHING;
}

static void judge(struct replay_item *item, enum replay_what what)
{
    item->outcome = what == WHAT_NOTHING ? REPLAY_SAME : REPLAY_DIFFERS;
    item->what = what == WHAT_NOTHING ? 0 : (uint32_t)what;
}

void replay_judge(const struct play_step *step, struct replay_item *item)
{
    const struct record_answer *then = step->recorded;
    const struct pccd_answer *now = step->answer;
    bool is_near = step->asked != NULL;
    memset(item, 0, sizeof *item); /* all of it goes to other processes */
    item->step = step->number;
    item->is_near = is_near;
    item->got = side_of(now->status, now->total, now->hash, is_near ? 0 : now->toi_first);
    if (then == NULL) {
        item->outcome = REPLAY_UNANSWERED;
        return;
    }
    item->expected = side_of(then->status, then->total, then->hash, then->toi_first);
    /* With a gap any pair within it is right. */
    if (!play_is_complete(then->incomplete) ||
        !play_is_complete((uint32_t)now->incomplete) ||
        (is_near && play_has_gap(step->asked))) {
        item->outcome = REPLAY_INCOMPLETE;
    } else {
        judge(item, difference(step));
    }
}

void replay_count(struct replay_counts *counts, const struct replay_item *item)
{
    if (item->outcome == REPLAY_DIFFERS && counts->of[REPLAY_DIFFERS] == 0) {
        counts->first = *item;
    }
    counts->of[item->outcome]++;
}

/* ---- telling ----------------------------------------------------------------------- */

static uint64_t compared(const struct replay_counts *counts)
{
    return counts->of[REPLAY_SAME] + counts->of[REPLAY_DIFFERS];
}

int replay_judge_counts(const struct replay_counts *counts,
                        const struct play_summary *summary, const char *path,
                        struct ctl_error *error)
{
    uint64_t asked = summary->frames + summary->questions;
    if (compared(counts) > 0) {
        return PCCD_OK;
    }
    return asked == 0
               ? ctl_error_set(error, PCCD_E_STATE, "%s: it holds no step", path)
               : ctl_error_set(error, PCCD_E_STATE,
                               "%s: no answer could be compared; it holds %" PRIu64 " %s",
                               path, asked, proto_plural(asked, "step", "steps"));
}

static void print_side(const struct replay_item *item, const char *name,
                       const struct replay_side *side)
{
    char text[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, side->hash, text);
    if (side->status != PCCD_OK) {
        fprintf(columns_fitted(stdout), "  %s  %s\n", name,
                pccd_status_name(side->status));
    } else if (item->is_near) {
        fprintf(columns_fitted(stdout), "  %s  %s, %" PRIu64 " records\n", name, text,
                side->total);
    } else {
        fprintf(columns_fitted(stdout),
                "  %s  %s, %" PRIu64 " records, the first at t = %s\n", name, text,
                side->total, tool_shown_number(side->toi_first));
    }
}

void replay_print_text(const struct replay_counts *counts,
                       const struct play_summary *summary)
{
    const struct record_begin *begin = &summary->begin;
    const struct replay_item *first = &counts->first;
    const uint64_t *of = counts->of, all = compared(counts);
    fprintf(columns_fitted(stdout), "recording   %" PRIu64 " %s", summary->frames,
            proto_plural(summary->frames, "step", "steps"));
    if (summary->questions > 0) {
        fprintf(columns_fitted(stdout), ", %" PRIu64 " %s about what is near",
                summary->questions,
                proto_plural(summary->questions, "question", "questions"));
    }
    fprintf(columns_fitted(stdout), " by process %" PRIu32 ", libpccd %s, %s\n",
            begin->pid, tool_shown_field(begin->library, sizeof begin->library),
            tool_shown_field(begin->cpu, sizeof begin->cpu));
    fprintf(columns_fitted(stdout),
            "compared    %" PRIu64 " %s in %.2f s: %" PRIu64 " the same, %" PRIu64
            " not\n",
            all, proto_plural(all, "answer", "answers"), summary->seconds,
            of[REPLAY_SAME], of[REPLAY_DIFFERS]);
    if (of[REPLAY_UNANSWERED] + of[REPLAY_INCOMPLETE] + of[REPLAY_SKIPPED] > 0) {
        fprintf(columns_fitted(stdout),
                "not         %" PRIu64 " without an answer, %" PRIu64
                " incomplete, %" PRIu64 " that had failed by chance\n",
                of[REPLAY_UNANSWERED], of[REPLAY_INCOMPLETE], of[REPLAY_SKIPPED]);
    }
    if (of[REPLAY_DIFFERS] > 0) {
        fprintf(columns_fitted(stdout), "%s %" PRIu64 " has another %s\n",
                first->is_near ? "what is near, question" : "step", first->step,
                replay_whats[first->what]);
        print_side(first, "expected", &first->expected);
        print_side(first, "got     ", &first->got);
    }
}

static json_t *side_json(const struct replay_side *side)
{
    char text[PROTO_HASH_BYTES];
    proto_hash_text(PCCD_HASH_VERSION, side->hash, text);
    return json_pack("{s:s, s:I, s:s}", "status", pccd_status_name(side->status), "total",
                     (json_int_t)side->total, "hash", text);
}

bool replay_print_json(const struct replay_counts *counts,
                       const struct play_summary *summary)
{
    const uint64_t *of = counts->of;
    json_t *all = json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:b}", "steps",
        (json_int_t)summary->frames, "nears", (json_int_t)summary->questions, "compared",
        (json_int_t)compared(counts), "same", (json_int_t)of[REPLAY_SAME], "differ",
        (json_int_t)of[REPLAY_DIFFERS], "unanswered", (json_int_t)of[REPLAY_UNANSWERED],
        "incomplete", (json_int_t)of[REPLAY_INCOMPLETE], "skipped",
        (json_int_t)of[REPLAY_SKIPPED], "seconds", summary->seconds, "is_whole",
        summary->ending == RECORD_ENDING_WHOLE);
    bool ok = all != NULL;
    if (ok && of[REPLAY_DIFFERS] > 0) {
        const struct replay_item *first = &counts->first;
        json_t *told =
            json_pack("{s:I, s:s, s:o, s:o}", "step", (json_int_t)first->step, "what",
                      replay_whats[first->what], "expected", side_json(&first->expected),
                      "got", side_json(&first->got));
        ok = json_object_set_new(all, "first_difference", told) == 0;
    }
    return output_json(all, ok, stdout);
}
