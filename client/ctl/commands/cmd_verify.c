/* cmd_verify.c - pccdctl verify. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "check_walk.h"
#include "ctl.h"
#include "play_options.h"
#include "shown.h"
#include "verify.h"

#define THREADS_MAX 1024u

struct verification {
    struct play_options options;
    struct verify_settings checks;
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
    .arguments = "FILE\nCERTIFICATE FILE [FILE...]",
    .text = "Check the answers of a recording by exact rational arithmetic, which "
            "shares nothing with the engine: every contact, every number, and a "
            "sample of pairs that are not among them. Of a certificate, which pccdctl "
            "check has written as its results, do the check again and compare every "
            "line.",
    .more = "A certificate wants the files that the check had, those of further objects "
            "last; of the options, it takes those of the daemon, --threads and --method. "
            "The contacts are those of the recording, or a daemon's that repeats it "
            "(a private one, unless another is named). Exit status: 0 after PASS, 1 "
            "after FAIL.",
    .examples = "  pccdctl verify run.rec\n"
                "  pccdctl verify bake.jsonl cloth.obj cloth.pc2\n",
};

/* ---- a certificate ----------------------------------------------------------------- */

#define AT(member) offsetof(struct check_command, member)
static const struct option_row certificate_rows[] = {
    {.type = OPTION_ARGUMENTS, .at = AT(check.ask.files)},
    CTL_ENGINE,
    {"method", 0, "default|paper|wide", "Method that finds the candidates", OPTION_WORD,
     .at = AT(check.ask.method)},
    {"threads", 0, "N", "Use at most N threads", OPTION_U32, .at = AT(check.ask.threads),
     .min = 1, .max = THREADS_MAX},
    {0}};
#undef AT

static const struct option_table certificate_table = {
    .rows = certificate_rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct check_command, check.ask.link)}, {0}},
    .arguments = "CERTIFICATE FILE [FILE...]"};

/* Return which word is the first that names a certificate; argc: none does. */
static int find_certificate(int argc, char **argv)
{
    int i = 1;
    while (i < argc && (argv[i][0] == '-' || !check_is_certificate(argv[i]))) {
        i++;
    }
    return i;
}

static int verify_certificate(int argc, char **argv)
{
    struct check_command command = {.check.settings = PCCD_STEP_SETTINGS_INIT};
    struct option_arguments *files = &command.check.ask.files;
    int status = CTL_USAGE;
    command.check.ask.link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    if (option_parse(&certificate_table, argc, argv, &command) == 0) {
        const char *certificate = files->list[0];
        files->list++;
        files->count--;
        status = check_verify(certificate, &command);
    }
    scene_options_deinit(&command.scene);
    ctl_link_deinit(&command.check.ask.link);
    return status;
}

/* ---- a recording ------------------------------------------------------------------- */

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
    return add(verification,
               verify_step(step, &verification->checks, &verification->result, error),
               error);
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
        status = verify_report_strays(&verification->report, play_answers(reader), error);
    }
    play_close(reader);
    return status;
}

static int verify_recording(int argc, char **argv)
{
    struct verification verification = {.checks = VERIFY_SETTINGS_INIT};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    play_options_init(&verification.options, "steps");
    verification.options.play.needs_records = true;
    verification.options.play.shows_near = true;
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

int ctl_cmd_verify(int argc, char **argv)
{
    int at = find_certificate(argc, argv);
    if (at == argc - 1) { /* before its options are judged, which are fewer */
        return ctl_complain("a certificate wants files: name the files of %s behind it, "
                            "those of --with last",
                            argv[at]);
    }
    if (at == argc && argc > 2 && argv[1][0] != '-' && argv[2][0] != '-') {
        return ctl_complain(
            "%s, which has files behind it, is no certificate: %s", tool_shown(argv[1]),
            access(argv[1], R_OK) == 0 ? "pccdctl check --results makes one"
                                       : strerror(errno));
    }
    return at < argc ? verify_certificate(argc, argv) : verify_recording(argc, argv);
}
