/* client/ctl/commands/cmd_verify.c - pccdctl verify.
 *
 * Room:     client/ctl.
 * Does:     checks the answers of a recording by exact arithmetic, and says PASS, or
 *           shows what is wrong with all that is needed to repeat it.
 * Does not: compute contacts.
 * Threads:  one.
 * Source:   verify.h.
 */
#include "ctl.h"
#include "play_options.h"
#include "verify.h"
#include "verify_options.h"
#include "verify_report.h"

struct verification {
    struct play_options options;
    struct verify_options checks;
    struct verify_counts counts;
    struct verify_witness witness;
    bool has_failed;
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct verification *verification = state->input;
    (void)text;
    if (key != ARGP_KEY_INIT) {
        return ARGP_ERR_UNKNOWN;
    }
    state->child_inputs[0] = &verification->checks;
    state->child_inputs[1] = &verification->options;
    return 0;
}

static const struct argp_child children[] = {
    {&verify_options_argp, 0, NULL, 0}, {&play_options_argp, 0, NULL, 0}, {0}};
const struct argp ctl_argp_verify = {
    .parser = parse,
    .args_doc = "FILE",
    .doc = "Check the answers of a recording by exact rational arithmetic, which shares "
           "nothing with the engine: every contact, and a sample of pairs that are not "
           "among them.\vThe contacts are those of the recording, or a daemon's that "
           "repeats it (a private one, unless another is named). Exit status: 0 after "
           "PASS, 1 after FAIL.",
    .children = children};

static int check(void *context, const struct play_step *step, struct ctl_error *error)
{
    struct verification *verification = context;
    bool is_right = true;
    int status = verify_step(step, &verification->checks.settings, &verification->counts,
                             &verification->witness, &is_right, error);
    if (status != PCCD_OK || is_right) {
        return status;
    }
    verification->has_failed = true;
    return PCCD_E_CANCELLED;
}

static int check_near(void *context, const struct play_near *near,
                      struct ctl_error *error)
{
    struct verification *verification = context;
    bool is_right = true;
    int status = verify_distances(near, &verification->counts, &verification->witness,
                                  &is_right, error);
    if (status != PCCD_OK || is_right) {
        return status;
    }
    verification->has_failed = true;
    return PCCD_E_CANCELLED;
}

int ctl_cmd_verify(int argc, char **argv)
{
    struct verification verification = {.checks = VERIFY_OPTIONS_INIT};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    play_options_init(&verification.options, "steps");
    verification.options.play.needs_records = true;
    verification.options.play.show_near = check_near;
    if (argp_parse(&ctl_argp_verify, argc, argv, 0, NULL, &verification) != 0) {
        return CTL_USAGE;
    }
    verification.options.play.source =
        verification.checks.repeats ? PLAY_DAEMON : PLAY_RECORDS;
    int status = play_options_open(&verification.options, &error);
    if (status == PCCD_OK) {
        status = play(&verification.options.play, check, &verification, &summary, &error);
    }
    if (status == PCCD_OK && !verification.has_failed) {
        status = verify_judge_counts(&verification.counts, verification.options.play.path,
                                     &error);
    }
    if (status == PCCD_OK) {
        const struct verify_witness *witness =
            verification.has_failed ? &verification.witness : NULL;
        play_options_warn(&verification.options.play, &summary);
        if (verification.options.is_json &&
            !verify_print_json(&verification.counts, witness)) {
            status = ctl_error_set(&error, PCCD_E_SYSTEM, "the report cannot be written");
        } else if (!verification.options.is_json) {
            verify_print_text(&verification.counts, witness);
        }
    }
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&verification.options);
    return (int)ctl_exit_of(status, !verification.has_failed);
}
