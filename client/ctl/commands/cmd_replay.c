/* client/ctl/commands/cmd_replay.c - pccdctl replay.
 *
 * Room:     client/ctl.
 * Does:     has a daemon repeat the steps of a recording, and compares every answer.
 * Does not: check that the answers are right: see cmd_verify.c.
 * Threads:  one.
 * Source:   play.h.
 */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "ctl.h"
#include "hash_text.h"
#include "json_text.h"
#include "play_options.h"
#include "plural.h"
#include "report.h"
#include "shown.h"

enum { OPTION_PACE = 256 + 64, OPTION_KEEP_GOING };

struct replay {
    struct play_options options;
    bool goes_on; /* after a difference */
    uint64_t compared, same, differ, unanswered, incomplete, other_pairs;
    uint64_t step; /* of the first difference */
    const char *what;
    struct record_answer expected;
    struct pccd_answer got; /* its hash by the recording's version */
    bool is_near;           /* the first difference is about what is near */
    uint32_t hash_version;
};

static const struct argp_option option_list[] = {
    {"pace", OPTION_PACE, "fast|recorded", 0,
     "fast (the default): submit one step after the other; recorded: at the times of the "
     "recording",
     0},
    {"keep-going", OPTION_KEEP_GOING, NULL, 0,
     "Go on after a difference, and count the differences", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct replay *replay = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &replay->options;
        return 0;
    case OPTION_PACE:
        if (strcmp(text, "fast") != 0 && strcmp(text, "recorded") != 0) {
            tool_misused(state, "--pace: \"%s\" is not fast or recorded", text);
        }
        replay->options.play.at_recorded_pace = strcmp(text, "recorded") == 0;
        return 0;
    case OPTION_KEEP_GOING:
        replay->goes_on = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&play_options_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_replay = {
    .options = option_list,
    .parser = parse,
    .args_doc = "FILE",
    .doc = "Repeat the steps of a recording with a daemon, and compare every answer: its "
           "hash, its counts, its earliest time.\vWithout --url and --socket a private "
           "daemon is started. Exit status: 0 when all answers are the same, 1 when one "
           "is not.",
    .children = children};

/* ---- comparing --------------------------------------------------------------------- */

/* Only answers that were and are complete must be equal. */
static bool is_complete(uint32_t incomplete)
{
    return incomplete == PCCD_COMPLETE || incomplete == PCCD_INCOMPLETE_RESULT_FULL;
}

/* What differs; NULL: nothing. */
static const char *difference(const struct play_step *step)
{
    const struct record_answer *then = step->recorded;
    const struct pccd_answer *now = step->answer;
    uint64_t hash[2];
    if (then->status != now->status) {
        return "status";
    }
    if (then->status != PCCD_OK) {
        return NULL;
    }
    if (then->total != now->total || then->vf != now->counts[PCCD_VF] ||
        then->ee != now->counts[PCCD_EE]) {
        return "number of records";
    }
    play_hash(step, hash);
    if (memcmp(then->hash, hash, sizeof hash) != 0) {
        return "hash";
    }
    if (memcmp(&then->toi_first, &now->toi_first, sizeof(double)) != 0) {
        return "earliest time";
    }
    if (then->possible != now->possible || then->initial != now->initial) {
        return "number of possible or initial contacts";
    }
    return then->verdict != (uint32_t)now->verdict ? "verdict" : NULL;
}

static int compare(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct replay *replay = context;
    (void)error;
    if (step->recorded == NULL) {
        replay->unanswered++;
        return PCCD_OK;
    }
    if (!is_complete(step->recorded->incomplete) ||
        !is_complete((uint32_t)step->answer->incomplete)) {
        replay->incomplete++;
        return PCCD_OK;
    }
    if (step->has_other_pairs) {
        replay->other_pairs++;
        return PCCD_OK;
    }
    const char *what = difference(step);
    replay->compared++;
    if (what == NULL) {
        replay->same++;
        return PCCD_OK;
    }
    if (replay->differ++ == 0) {
        replay->step = step->number;
        replay->what = what;
        replay->expected = *step->recorded;
        replay->got = *step->answer;
        replay->hash_version = step->hash_version;
        play_hash(step, replay->got.hash);
    }
    return replay->goes_on ? PCCD_OK : PCCD_E_CANCELLED;
}

/* What differs in what is near; NULL: nothing. */
static const char *near_difference(const struct record_near_answer *then,
                                   const struct pccd_answer *now)
{
    if (then->status != now->status) {
        return "status";
    }
    if (then->status != PCCD_OK) {
        return NULL;
    }
    if (then->total != now->total ||
        memcmp(then->counts, now->counts, sizeof then->counts) != 0) {
        return "number of records";
    }
    if (memcmp(then->hash, now->hash, sizeof then->hash) != 0) {
        return "hash";
    }
    if (memcmp(&then->distance_min, &now->distance_min, sizeof(double)) != 0 ||
        memcmp(&then->distance_max, &now->distance_max, sizeof(double)) != 0) {
        return "least or greatest distance";
    }
    if (then->crossings != now->crossings) {
        return "number of crossings";
    }
    return then->verdict != (uint32_t)now->verdict ? "verdict" : NULL;
}

static int compare_near(void *context, const struct play_near *near,
                        struct ctl_error *error)
{
    struct replay *replay = context;
    const struct record_near_answer *then = near->recorded;
    (void)error;
    if (then == NULL) {
        replay->unanswered++;
        return PCCD_OK;
    }
    /* With a gap any pair within it is right. */
    if (!is_complete(then->incomplete) ||
        !is_complete((uint32_t)near->answer->incomplete) || play_has_gap(near->asked)) {
        replay->incomplete++;
        return PCCD_OK;
    }
    const char *what = near_difference(then, near->answer);
    replay->compared++;
    if (what == NULL) {
        replay->same++;
        return PCCD_OK;
    }
    if (replay->differ++ == 0) {
        replay->step = near->number;
        replay->what = what;
        replay->is_near = true;
        replay->expected = (struct record_answer){.status = then->status,
                                                  .total = then->total,
                                                  .hash = {then->hash[0], then->hash[1]}};
        replay->got = *near->answer;
        replay->hash_version = PCCD_HASH_VERSION;
    }
    return replay->goes_on ? PCCD_OK : PCCD_E_CANCELLED;
}

/* ---- telling ----------------------------------------------------------------------- */

static void print_side(const struct replay *replay, const char *side, int status,
                       uint64_t total, const uint64_t hash[2], double toi)
{
    char text[PROTO_HASH_BYTES];
    proto_hash_text(replay->hash_version, hash, text);
    if (status != PCCD_OK) {
        printf("  %s  %s\n", side, pccd_status_name(status));
    } else if (replay->is_near) {
        printf("  %s  %s, %" PRIu64 " records\n", side, text, total);
    } else {
        printf("  %s  %s, %" PRIu64 " records, the first at t = %.17g\n", side, text,
               total, toi);
    }
}

static void print_text(const struct replay *replay, const struct play_summary *summary)
{
    const struct record_begin *begin = &summary->begin;
    printf("recording   %" PRIu64 " %s", summary->frames,
           proto_plural(summary->frames, "step", "steps"));
    if (summary->questions > 0) {
        printf(", %" PRIu64 " %s about what is near", summary->questions,
               proto_plural(summary->questions, "question", "questions"));
    }
    printf(" by process %" PRIu32 ", libpccd %s, %s\n", begin->pid,
           tool_shown_field(begin->library, sizeof begin->library),
           tool_shown_field(begin->cpu, sizeof begin->cpu));
    printf("compared    %" PRIu64 " %s in %.2f s: %" PRIu64 " the same, %" PRIu64
           " not\n",
           replay->compared, proto_plural(replay->compared, "answer", "answers"),
           summary->seconds, replay->same, replay->differ);
    if (replay->unanswered + replay->incomplete + summary->skipped > 0) {
        printf("not         %" PRIu64 " without an answer, %" PRIu64
               " incomplete, %" PRIu64 " that had failed by chance\n",
               replay->unanswered, replay->incomplete, summary->skipped);
    }
    if (replay->other_pairs > 0) {
        printf("not         %" PRIu64
               " in mode pairs, recorded when it compared boxes in "
               "single precision\n",
               replay->other_pairs);
    }
    if (replay->differ > 0) {
        printf("%s %" PRIu64 " has another %s\n",
               replay->is_near ? "what is near, question" : "step", replay->step,
               replay->what);
        print_side(replay, "expected", replay->expected.status, replay->expected.total,
                   replay->expected.hash, replay->expected.toi_first);
        print_side(replay, "got     ", replay->got.status, replay->got.total,
                   replay->got.hash, replay->got.toi_first);
    }
}

static json_t *side_json(const struct replay *replay, int status, uint64_t total,
                         const uint64_t hash[2])
{
    char text[PROTO_HASH_BYTES];
    proto_hash_text(replay->hash_version, hash, text);
    return json_pack("{s:s, s:I, s:s}", "status", pccd_status_name(status), "total",
                     (json_int_t)total, "hash", text);
}

static bool print_json(const struct replay *replay, const struct play_summary *summary)
{
    json_t *all = json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:b}", "steps",
        (json_int_t)summary->frames, "nears", (json_int_t)summary->questions, "compared",
        (json_int_t)replay->compared, "same", (json_int_t)replay->same, "differ",
        (json_int_t)replay->differ, "unanswered", (json_int_t)replay->unanswered,
        "incomplete", (json_int_t)replay->incomplete, "other_pairs",
        (json_int_t)replay->other_pairs, "skipped", (json_int_t)summary->skipped,
        "seconds", summary->seconds, "is_whole", summary->ending == RECORD_ENDING_WHOLE);
    bool ok = all != NULL;
    if (ok && replay->differ > 0) {
        json_t *first = json_pack(
            "{s:I, s:s, s:o, s:o}", "step", (json_int_t)replay->step, "what",
            replay->what, "expected",
            side_json(replay, replay->expected.status, replay->expected.total,
                      replay->expected.hash),
            "got",
            side_json(replay, replay->got.status, replay->got.total, replay->got.hash));
        ok = json_object_set_new(all, "first_difference", first) == 0;
    }
    ok = ok && json_dumpf(all, stdout, JSON_TEXT_FLAGS) == 0 && putchar('\n') == '\n';
    json_decref(all);
    return ok;
}

int ctl_cmd_replay(int argc, char **argv)
{
    struct replay replay = {.compared = 0};
    struct play_summary summary = {.frames = 0};
    struct ctl_error error = {.text = ""};
    int status;
    play_options_init(&replay.options, "steps");
    replay.options.play.source = PLAY_DAEMON;
    replay.options.play.show_near = compare_near;
    if (argp_parse(&ctl_argp_replay, argc, argv, 0, NULL, &replay) != 0) {
        return CTL_USAGE;
    }
    status = play_options_open(&replay.options, &error);
    if (status == PCCD_OK) {
        status = play(&replay.options.play, compare, &replay, &summary, &error);
    }
    if (summary.frames + summary.questions > 0 || status == PCCD_OK) {
        if (status == PCCD_OK || summary.ending != RECORD_ENDING_UNKNOWN) {
            play_options_warn(&replay.options.play,
                              &summary); /* else the error says it */
        }
        if (replay.options.is_json && !print_json(&replay, &summary)) {
            status = ctl_error_set(&error, PCCD_E_SYSTEM, "the report cannot be written");
        } else if (!replay.options.is_json) {
            print_text(&replay, &summary);
        }
    }
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&replay.options);
    return (int)ctl_exit_of(status, replay.differ == 0);
}
