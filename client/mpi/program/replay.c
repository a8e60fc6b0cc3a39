/* replay.c - pccd-mpi replay. */
#include "replay.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "answers.h"
#include "ctl.h"
#include "recordings.h"
#include "together.h"

struct replay {
    struct recordings_options options;
    bool goes_on; /* after a difference */
};

const struct option_table program_table_replay = {
    .rows =
        (const struct option_row[]){
            CTL_QUESTION,
            {"keep-going", 0, NULL, "Go on after a difference, and count the differences",
             OPTION_FLAG, .at = offsetof(struct replay, goes_on)},
            {0}},
    .parts =
        (const struct option_part[]){
            {&recordings_table, offsetof(struct replay, options)}, {0}},
    .arguments = "FILE...",
    .text = "Repeat the steps of recordings, each by one of the ranks, and compare every "
            "answer: its hash, its counts, its earliest time. Output and exit status are "
            "those of pccdctl replay; every rank has to be able to read the files.",
    .examples =
        "  mpirun -n 4 pccd-mpi replay run.rec\n"
        "  mpirun -n 4 pccd-mpi replay --keep-going --results run.jsonl a.rec b.rec\n"};

/* ---- items ------------------------------------------------------------------------- */

static int judge_step(void *context, const struct play_step *step, void *result,
                      struct ctl_error *error)
{
    (void)context;
    (void)error;
    replay_judge(step, result);
    return PCCD_OK;
}

static void skip(void *context, const struct answers_asked *asked, void *result)
{
    struct replay_item *item = result;
    (void)context;
    memset(item, 0, sizeof *item);
    item->step = asked->step;
    item->is_near = asked->is_near;
    item->outcome = REPLAY_SKIPPED;
}

static bool is_last(void *context, const void *result)
{
    const struct replay *replay = context;
    const struct replay_item *item = result;
    return item->outcome == REPLAY_DIFFERS && !replay->goes_on;
}

static json_t *settings(void *context)
{
    (void)context;
    return json_object();
}

/* ---- lines ------------------------------------------------------------------------- */

/* Hash and time as hexadecimal digits: they have to come back as they were. */
static json_t *side_json(const struct replay_side *side)
{
    char hash[40], toi[40];
    snprintf(hash, sizeof hash, "%016" PRIx64 "%016" PRIx64, side->hash[0],
             side->hash[1]);
    snprintf(toi, sizeof toi, "%a", side->toi_first);
    return json_pack("{s:i, s:I, s:s, s:s}", "status", (int)side->status, "total",
                     (json_int_t)side->total, "hash", hash, "toi_first", toi);
}

static bool side_read(const json_t *object, struct replay_side *side)
{
    int status = 0;
    json_int_t total = 0;
    const char *hash = NULL, *toi = NULL;
    char *end = NULL;
    if (json_unpack((json_t *)(uintptr_t)object, "{s:i, s:I, s:s, s:s}", "status",
                    &status, "total", &total, "hash", &hash, "toi_first", &toi) != 0 ||
        sscanf(hash, "%16" SCNx64 "%16" SCNx64, &side->hash[0], &side->hash[1]) != 2) {
        return false;
    }
    side->status = status;
    side->total = (uint64_t)total;
    side->toi_first = strtod(toi, &end);
    return *end == '\0';
}

static json_t *line(const void *result)
{
    const struct replay_item *item = result;
    return json_pack(
        "{s:I, s:b, s:s, s:s, s:o, s:o}", "step", (json_int_t)item->step, "is_near",
        item->is_near, "outcome", replay_outcome_names[item->outcome], "what",
        item->outcome == REPLAY_DIFFERS ? replay_whats[item->what] : "", "got",
        side_json(&item->got), "expected", side_json(&item->expected));
}

/* The place of a text in a table; `count`: it is not there. */
static uint32_t find(const char *text, const char *const *names, uint32_t count)
{
    uint32_t i = 0;
    while (i < count && strcmp(text, names[i]) != 0) {
        i++;
    }
    return i;
}

static bool read_line(const json_t *object, void *result)
{
    struct replay_item *item = result;
    json_int_t step = 0;
    int is_near = 0;
    const char *outcome = NULL, *what = NULL;
    const json_t *got = NULL, *expected = NULL;
    memset(item, 0, sizeof *item);
    if (json_unpack((json_t *)(uintptr_t)object, "{s:I, s:b, s:s, s:s, s:o, s:o}", "step",
                    &step, "is_near", &is_near, "outcome", &outcome, "what", &what, "got",
                    &got, "expected", &expected) != 0 ||
        !side_read(got, &item->got) || !side_read(expected, &item->expected)) {
        return false;
    }
    item->step = (uint64_t)step;
    item->is_near = is_near != 0;
    item->outcome = find(outcome, replay_outcome_names, REPLAY_OUTCOME_COUNT);
    item->what = what[0] == '\0' ? 0 : find(what, replay_whats, REPLAY_WHAT_COUNT);
    return item->outcome < REPLAY_OUTCOME_COUNT && item->what < REPLAY_WHAT_COUNT;
}

/* ---- the report -------------------------------------------------------------------- */

/* In the order of the file, up to the first difference unless it goes on. */
static int report(void *context, const struct recordings *recordings,
                  const struct recording *file, bool *is_right, struct ctl_error *error)
{
    const struct replay *replay = context;
    struct replay_counts counts = {.of = {0}};
    for (uint64_t i = 0; i < file->count; i++) {
        const struct replay_item *item = recordings_result(recordings, file, i);
        if (item == NULL) {
            continue;
        }
        replay_count(&counts, item);
        if (is_last(context, item)) {
            break;
        }
    }
    *is_right = counts.of[REPLAY_DIFFERS] == 0;
    recordings_separate(recordings, file);
    if (!replay->options.play.is_json) {
        replay_print_text(&counts, &file->summary);
    } else if (!replay_print_json(&counts, &file->summary)) {
        return ctl_error_set(error, PCCD_E_SYSTEM, "the report cannot be written");
    }
    int status =
        *is_right || replay->goes_on ? play_damage(file->reader, error) : PCCD_OK;
    return status == PCCD_OK
               ? replay_judge_counts(&counts, &file->summary, file->path, error)
               : status;
}

int program_replay(int argc, char **argv)
{
    struct replay replay = {.goes_on = false};
    const struct recordings_work work = {.name = "replay",
                                         .result_bytes = sizeof(struct replay_item),
                                         .context = &replay,
                                         .step = judge_step,
                                         .skip = skip,
                                         .is_last = is_last,
                                         .line = line,
                                         .read = read_line,
                                         .settings = settings,
                                         .report = report};
    recordings_options_init(&replay.options);
    replay.options.play.play.source = PLAY_DAEMON;
    return recordings_command(&replay.options, &program_table_replay, argc, argv, &replay,
                              &work);
}
