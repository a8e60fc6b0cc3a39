/* verify.c - pccd-mpi verify. */
#include "verify.h"

#include <stdio.h>
#include <string.h>

#include "answers.h"
#include "ctl.h"
#include "recordings.h"
#include "together.h"

struct verification {
    struct recordings_options options;
    struct verify_settings checks;
};

static void choose_source(struct argp_state *state, void *to)
{
    struct verification *verification = to;
    (void)state;
    verification->options.play.play.source =
        verification->checks.repeats ? PLAY_DAEMON : PLAY_RECORDS;
}

const struct option_table program_table_verify = {
    .parts =
        (const struct option_part[]){
            {&verify_table, offsetof(struct verification, checks)},
            {&recordings_table, offsetof(struct verification, options)},
            {0}},
    .check = choose_source,
    .arguments = "FILE...",
    .text =
        "Check the answers of recordings by exact rational arithmetic, each step by one "
        "of the ranks: every contact, and a sample of pairs that are not among them. "
        "Output and exit status are those of pccdctl verify; every rank has to be able "
        "to read the files.",
    .examples =
        "  mpirun -n 4 pccd-mpi verify run.rec\n"
        "  mpirun -n 4 pccd-mpi verify --sample 100000 --results run.jsonl run.rec\n"};

/* ---- items ------------------------------------------------------------------------- */

static int check(void *context, const struct play_step *step, void *result,
                 struct ctl_error *error)
{
    const struct verification *verification = context;
    return verify_step(step, &verification->checks, result, error);
}

static void skip(void *context, const struct answers_asked *asked, void *result)
{
    (void)context;
    verify_skip(asked->step, asked->is_near, result);
}

static bool is_last(void *context, const void *result)
{
    (void)context;
    return ((const struct verify_result *)result)->is_wrong;
}

static json_t *settings(void *context)
{
    const struct verify_settings *checks =
        &((const struct verification *)context)->checks;
    return json_pack("{s:I, s:I, s:I, s:b}", "sample", (json_int_t)checks->sample,
                     "contacts", (json_int_t)checks->contacts_max, "seed",
                     (json_int_t)checks->seed, "repeat", checks->repeats);
}

static json_t *line(const void *result)
{
    const struct verify_result *item = result;
    json_t *object =
        json_pack("{s:I, s:b, s:b, s:s}", "step", (json_int_t)item->step, "is_near",
                  item->is_near, "pass", !item->is_wrong, "not_checked", item->unchecked);
    json_t *counts = json_object();
    bool ok = object != NULL && counts != NULL;
    ok = ok && verify_counts_json(counts, &item->counts);
    if (json_object_set_new(object, "counts", counts) != 0) { /* it takes counts */
        ok = false;
    }
    if (ok && item->is_wrong) {
        ok = json_object_set_new(object, "witness",
                                 verify_witness_json(&item->witness)) == 0;
    }
    if (!ok) {
        json_decref(object);
        object = NULL;
    }
    return object;
}

static bool read_line(const json_t *object, void *result)
{
    struct verify_result *item = result;
    const char *unchecked = json_string_value(json_object_get(object, "not_checked"));
    const json_t *pass = json_object_get(object, "pass");
    const json_t *witness = json_object_get(object, "witness");
    memset(item, 0, sizeof *item);
    item->step = (uint64_t)json_integer_value(json_object_get(object, "step"));
    item->is_near = json_is_true(json_object_get(object, "is_near"));
    item->is_wrong = json_is_false(pass);
    (void)snprintf(item->unchecked, sizeof item->unchecked, "%s",
                   unchecked != NULL ? unchecked : "");
    return json_is_boolean(pass) &&
           verify_counts_read(json_object_get(object, "counts"), &item->counts) &&
           (!item->is_wrong || verify_witness_read(witness, &item->witness));
}

/* ---- the report -------------------------------------------------------------------- */

/* In the order of the file, up to the first that is wrong. */
static int report(void *context, const struct recordings *recordings,
                  const struct recording *file, bool *is_right, struct ctl_error *error)
{
    const struct verification *verification = context;
    struct verify_report all = {.witness = NULL};
    int status = PCCD_OK;
    for (uint64_t i = 0; i < file->count && all.witness == NULL && status == PCCD_OK;
         i++) {
        const struct verify_result *item = recordings_result(recordings, file, i);
        if (item != NULL) {
            status = verify_report_add(&all, item, error);
        }
    }
    *is_right = all.witness == NULL;
    if (*is_right) {
        status = status == PCCD_OK ? play_damage(file->reader, error) : status;
        status = status == PCCD_OK
                     ? verify_report_strays(&all, play_answers(file->reader), error)
                     : status;
    }
    if (status == PCCD_OK) {
        recordings_separate(recordings, file);
    }
    if (status == PCCD_OK && !verification->options.play.is_json) {
        verify_print_text(&all);
    } else if (status == PCCD_OK && !verify_print_json(&all)) {
        status = ctl_error_set(error, PCCD_E_SYSTEM, "the report cannot be written");
    }
    status = status == PCCD_OK ? verify_report_judge(&all, file->path, error) : status;
    verify_report_deinit(&all);
    return status;
}

int program_verify(int argc, char **argv)
{
    struct verification verification = {.checks = VERIFY_SETTINGS_INIT};
    const struct recordings_work work = {.name = "verify",
                                         .result_bytes = sizeof(struct verify_result),
                                         .context = &verification,
                                         .step = check,
                                         .skip = skip,
                                         .is_last = is_last,
                                         .line = line,
                                         .read = read_line,
                                         .settings = settings,
                                         .report = report};
    recordings_options_init(&verification.options);
    verification.options.play.play.needs_records = true;
    return recordings_command(&verification.options, &program_table_verify, argc, argv,
                              &verification, &work);
}
