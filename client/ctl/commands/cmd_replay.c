/* cmd_replay.c - pccdctl replay. */
#include <string.h>

#include "ctl.h"
#include "play_options.h"
#include "replay.h"

struct replay {
    struct play_options options;
    bool goes_on; /* after a difference */
    struct replay_counts counts;
};

static void take_pace(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct replay *replay = to;
    replay->options.play.at_recorded_pace =
        option_word(state, row->name, text, strlen(text), row->arg) == 1;
}

static const struct option_row rows[] = {
    CTL_QUESTION,
    {"pace", 0, "fast|recorded",
     "fast (the default): submit one step after the other; recorded: at the times of the "
     "recording",
     OPTION_OWN, .take = take_pace},
    {"keep-going", 0, NULL, "Go on after a difference, and count the differences",
     OPTION_FLAG, .at = offsetof(struct replay, goes_on)},
    {0}};

const struct option_table ctl_table_replay = {
    .rows = rows,
    .parts = (const struct option_part[]){{&play_table, offsetof(struct replay, options)},
                                          {0}},
    .arguments = "FILE",
    .text = "Repeat the steps of a recording with a daemon, and compare every "
            "answer: its hash, its counts, its earliest time.",
    .more = "Without --url and --socket a private daemon is started. Exit status: 0 "
            "when all answers are the same, 1 when one is not, 4 when there is none "
            "to compare.",
    .examples = "  pccdctl replay run.rec\n"
                "  pccdctl replay --keep-going --steps 100.. run.rec\n",
};

static int compare(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct replay *replay = context;
    struct replay_item item;
    (void)error;
    replay_judge(step, &item);
    replay_count(&replay->counts, &item);
    return item.outcome != REPLAY_DIFFERS || replay->goes_on ? PCCD_OK : PCCD_E_CANCELLED;
}

int ctl_cmd_replay(int argc, char **argv)
{
    struct replay replay = {.goes_on = false};
    struct play_summary summary = {.frames = 0};
    struct ctl_error error = {.text = ""};
    int status;
    play_options_init(&replay.options, "steps");
    replay.options.play.source = PLAY_DAEMON;
    replay.options.play.shows_near = true;
    if (option_parse(&ctl_table_replay, argc, argv, &replay) != 0) {
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
        replay.counts.of[REPLAY_SKIPPED] = summary.skipped;
        if (replay.options.is_json && !replay_print_json(&replay.counts, &summary)) {
            status = ctl_error_set(&error, PCCD_E_SYSTEM, "the report cannot be written");
        } else if (!replay.options.is_json) {
            replay_print_text(&replay.counts, &summary);
        }
    }
    if (status == PCCD_OK) {
        status = replay_judge_counts(&replay.counts, &summary, replay.options.play.path,
                                     &error);
    }
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&replay.options);
    return (int)ctl_exit_of(status, replay.counts.of[REPLAY_DIFFERS] == 0);
}
