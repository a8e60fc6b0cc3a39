/* cmd_verify.c - pccdctl verify. */
#include "ctl.h"
#include "play_options.h"
#include "verify.h"

struct verification {
    struct play_options options;
    struct verify_options checks;
    struct verify_report report;
    struct verify_result result; /* of the last step or question */
    struct ctl_error error;      /* of a step that was not shown */
    int status;
};

const struct option_table ctl_table_verify = {
    .parts =
        (const struct option_part[]){
            {&verify_table, offsetof(struct verification, checks)},
            {&play_table, offsetof(struct verification, options)},
            {0}},
    .arguments = "FILE",
    .text = "Check the answers of a recording by exact rational arithmetic, which "
            "shares nothing with the engine: every contact, every number, and a "
            "sample of pairs that are not among them.",
    .more = "The contacts are those of the recording, or a daemon's that repeats it "
            "(a private one, unless another is named). Exit status: 0 after PASS, 1 "
            "after FAIL.",
    .examples = "  pccdctl verify run.rec\n"
                "  pccdctl verify --steps 7 --sample 100000 run.rec\n",
};

static int add(struct verification *verification, int status, struct ctl_error *error)
{
    if (status == PCCD_OK) {
        status = verify_report_add(&verification->report, &verification->result, error);
    }
    return status == PCCD_OK && verification->result.is_wrong ? PCCD_E_CANCELLED : status;
}

static int check(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct verification *verification = context;
    return add(
        verification,
        verify_step(step, &verification->checks.settings, &verification->result, error),
        error);
}

static int check_near(void *context, const struct play_near *near,
                      struct ctl_error *error)
{
    struct verification *verification = context;
    return add(verification, verify_distances(near, &verification->result, error), error);
}

static void skip(void *context, uint64_t step, bool is_near)
{
    struct verification *verification = context;
    verify_skip(step, is_near, &verification->result);
    if (verification->status == PCCD_OK) {
        verification->status = add(verification, PCCD_OK, &verification->error);
    }
}

/* All of the recording. */
static int run(struct verification *verification, struct play_summary *summary,
               struct ctl_error *error)
{
    struct play_reader *reader = NULL;
    int status = play_open(&verification->options.play, summary, &reader, error);
    if (status == PCCD_OK) {
        status = play_run(reader, check, verification, error);
    }
    if (status == PCCD_OK && verification->status != PCCD_OK) {
        *error = verification->error;
        status = verification->status;
    }
    if (status == PCCD_OK && verification->report.witness == NULL) {
        status =
            verify_report_strays(&verification->report, play_answers(reader), error);
    }
    play_close(reader);
    return status;
}

int ctl_cmd_verify(int argc, char **argv)
{
    struct verification verification = {.checks = VERIFY_OPTIONS_INIT};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    play_options_init(&verification.options, "steps");
    verification.options.play.needs_records = true;
    verification.options.play.show_near = check_near;
    verification.options.play.show_skipped = skip;
    if (option_parse(&ctl_table_verify, argc, argv, &verification) != 0) {
        return CTL_USAGE;
    }
    verification.options.play.source =
        verification.checks.repeats ? PLAY_DAEMON : PLAY_RECORDS;
    int status = play_options_open(&verification.options, &error);
    if (status == PCCD_OK) {
        status = run(&verification, &summary, &error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&verification.options.play, &summary);
        if (verification.options.is_json && !verify_print_json(&verification.report)) {
            status = ctl_error_set(&error, PCCD_E_SYSTEM, "the report cannot be written");
        } else if (!verification.options.is_json) {
            verify_print_text(&verification.report);
        }
    }
    if (status == PCCD_OK) {
        status = verify_report_judge(&verification.report, verification.options.play.path,
                                     &error);
    }
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    bool is_right = verification.report.witness == NULL;
    verify_report_deinit(&verification.report);
    play_options_deinit(&verification.options);
    return (int)ctl_exit_of(status, is_right);
}
