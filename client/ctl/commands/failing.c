/* failing.c - the steps of a check that fail become a page and a film. */
#include "failing.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "inspect.h"
#include "output.h"
#include "printable.h"
#include "render.h"
#include "shown.h"

struct failing_step {
    struct frames_recording recording;
    uint32_t number;
};

#define STEPS_DEFAULT 24u
#define STEPS_MAX     256u /* each has a file that is open */
#define RATE          2    /* steps a second: people look at them */

static void take_page(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct failing_options *options = to;
    (void)row;
    if (!tool_ends_with(text, ".html")) {
        option_misused(state, "--page: \"%s\" does not end with .html", text);
    }
    options->page = text;
}

static void take_film(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct failing_options *options = to;
    (void)row;
    if (!tool_ends_with(text, ".apng")) {
        option_misused(state, "--film: \"%s\" does not end with .apng", text);
    }
    options->film = text;
}

static void check(struct argp_state *state, void *to)
{
    const struct failing_options *options = to;
    if (options->most > 0 && options->page == NULL && options->film == NULL) {
        option_misused(state, "--failing is of what --page and --film show");
    }
    if (options->page_bytes > 0 && options->page == NULL) {
        option_misused(state, "--max-size is of the page that --page writes");
    }
}

#define AT(member) offsetof(struct failing_options, member)
const struct option_table failing_table = {
    .rows =
        (const struct option_row[]){
            CTL_OUTPUT,
            {"page", 0, "FILE",
             "Write the steps in which something meets as a page, FILE.html, as pccdctl "
             "inspect does",
             OPTION_OWN, .at = AT(page), .take = take_page},
            {"film", 0, "FILE",
             "Draw the steps in which something meets as a film, FILE.apng, as pccdctl "
             "render does, two a second",
             OPTION_OWN, .at = AT(film), .take = take_film},
            {"failing", 0, "N",
             "With --page and --film: show at most the first N steps in which something "
             "meets (default: 24)",
             OPTION_U32, .at = AT(most), .min = 1, .max = STEPS_MAX},
            {"max-size", 0, "MIB",
             "Let the page of --page have at most MIB mebibytes (default: 64). If not "
             "all steps fit, only one in so many is shown that they do",
             OPTION_U64, .at = AT(page_bytes), .min = 1, .max = INSPECT_MIB_MAX,
             .unit = INSPECT_MIB},
            {0}},
    .check = check};

static bool is_asked(const struct failing *failing)
{
    return failing->options->page != NULL || failing->options->film != NULL;
}

static uint32_t most_of(const struct failing *failing)
{
    return failing->options->most > 0 ? failing->options->most : STEPS_DEFAULT;
}

int failing_begin(struct failing *failing, const struct ctl_link *link,
                  struct check_run *run, struct ctl_error *error)
{
    struct frames_recording tried = {.name = "the steps that fail"};
    if (!is_asked(failing)) {
        return PCCD_OK;
    }
    if (ctl_link_is_direct(link)) {
        return ctl_error_set(error, PCCD_E_STATE,
                             "--page and --film want a daemon, which records the steps "
                             "that fail: not with direct:");
    }
    int status = failing->options->page != NULL ? inspect_has_page(error) : PCCD_OK;
    if (status == PCCD_OK) {
        failing->steps = calloc(most_of(failing), sizeof *failing->steps);
        status = failing->steps != NULL
                     ? frames_begin(&tried, run->client, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    if (status == PCCD_OK) {
        (void)pccd_record_stop(run->client, NULL);
    }
    frames_forget(&tried);
    return status;
}

int failing_keep(struct failing *failing, struct check_run *run,
                 const struct scene *files, uint32_t number, struct ctl_error *error)
{
    if (!is_asked(failing)) {
        return PCCD_OK;
    }
    if (failing->count == most_of(failing)) {
        failing->left_out++;
        return PCCD_OK;
    }
    struct failing_step *step = &failing->steps[failing->count++];
    step->number = number;
    snprintf(step->recording.name, sizeof step->recording.name, "step %" PRIu32, number);
    int status = frames_begin(&step->recording, run->client, error);
    if (status != PCCD_OK) {
        return status;
    }
    status = check_run_again(run, files, number, error);
    int stopped = pccd_record_stop(run->client, NULL);
    return status != PCCD_OK || stopped == PCCD_OK
               ? status
               : check_run_fail(run, stopped, step->recording.name, error);
}

/* ---- what is written --------------------------------------------------------------- */

static struct play_settings play_of(const struct failing_step *step,
                                    const struct ctl_link *link)
{
    return (struct play_settings){.path = step->recording.name,
                                  .from = step->recording.from,
                                  .link = link,
                                  .source = PLAY_DAEMON,
                                  .needs_records = true,
                                  .first = 1,
                                  .number = step->number,
                                  .label = "steps"};
}

/* Return how to play all of them, one after the other, and then one without a path: the
 * caller's to free. NULL: no memory, as the error says. */
static struct play_settings *parts_of(const struct failing *failing,
                                      const struct ctl_link *link,
                                      struct ctl_error *error)
{
    struct play_settings *parts = calloc(failing->count + 1, sizeof *parts);
    if (parts == NULL) {
        (void)ctl_error_set(error, PCCD_E_NOMEM, "no memory for the steps that fail");
    }
    for (uint32_t i = 0; parts != NULL && i < failing->count; i++) {
        parts[i] = play_of(&failing->steps[i], link);
    }
    return parts;
}

/* Steps that fail, and the daemon that answers them again. */
struct showing {
    const struct failing *failing;
    const struct ctl_link *link;
};

/* An inspect_fill_fn whose context is the showing. */
static int fill(void *context, struct inspect *inspect, struct play_summary *summary,
                uint64_t *all, struct ctl_error *error)
{
    const struct showing *showing = context;
    const struct failing *failing = showing->failing;
    int status = PCCD_OK;
    for (uint32_t i = 0; status == PCCD_OK && i < failing->count && !inspect->is_full;
         i++) {
        struct play_settings settings = play_of(&failing->steps[i], showing->link);
        settings.is_traced = true;
        status = play(&settings, inspect_step, inspect, summary, error);
    }
    summary->frames = failing->count + failing->left_out;
    *all = failing->count;
    return status;
}

/* *every: one in so many steps has room. */
static int write_page(const struct failing *failing, const struct ctl_link *link,
                      struct whole_file *file, uint64_t *shown, uint64_t *every,
                      struct ctl_error *error)
{
    const struct failing_options *options = failing->options;
    const uint64_t most = options->page_bytes;
    struct play_settings *parts = parts_of(failing, link, error);
    if (parts == NULL) {
        return PCCD_E_NOMEM;
    }
    const struct inspect_settings settings = {
        .every = 1,
        .boxes_max = INSPECT_BOXES_DEFAULT,
        .bytes_max = most > 0 ? most : INSPECT_BYTES_DEFAULT,
        .up = play_up(parts),
        .is_of_files = true,
        .between = failing->scene->between,
        .has_no_self = failing->scene->has_no_self};
    struct showing showing = {failing, link};
    struct inspect inspect = {.kept = 0};
    struct play_summary summary = {.frames = 0};
    const struct inspect_source source = {options->page, "steps that fail", fill,
                                          &showing};
    int status = inspect_write(&inspect, &settings, &source, file, &summary, error);
    *shown = inspect.kept;
    *every = inspect.settings.every;
    inspect_deinit(&inspect);
    free(parts);
    return status;
}

static int draw_film(const struct failing *failing, const struct ctl_link *link, FILE *to,
                     uint64_t *shown, struct ctl_error *error)
{
    const struct render render = {.path = failing->options->film,
                                  .t = NAN,
                                  .azimuth = NAN,
                                  .rate = RATE,
                                  .marks_first = true};
    struct play_summary summary;
    uint32_t drawn = 0;
    struct play_settings *parts = parts_of(failing, link, error);
    if (parts == NULL) {
        return PCCD_E_NOMEM;
    }
    for (uint32_t i = 0; i < failing->count; i++) {
        parts[i].source = PLAY_RECORDS;
    }
    int status = render_film(&render, parts, to, &drawn, &summary, error);
    *shown = drawn;
    free(parts);
    return status;
}

static int write_one(const struct failing *failing, const struct ctl_link *link,
                     bool is_page, FILE *report, struct ctl_error *error)
{
    const char *path = is_page ? failing->options->page : failing->options->film;
    const char *what = is_page ? "page" : "film";
    uint64_t all = failing->count + failing->left_out, shown = 0, every = 1;
    char room[64] = "";
    struct whole_file file = {.to = NULL};
    if (path == NULL) {
        return PCCD_OK;
    }
    if (all == 0) {
        fprintf(report, "%-10s none: no step fails, %s is as it was\n", what,
                tool_shown(path));
        return PCCD_OK;
    }
    int status = PCCD_OK;
    if (is_page) {
        status = write_page(failing, link, &file, &shown, &every, error);
    } else {
        status = output_open(&file, path, false, error);
        if (status == PCCD_OK) {
            status = draw_film(failing, link, file.to, &shown, error);
        }
    }
    if (status == PCCD_OK) {
        status = output_finish(&file, path, error);
    }
    if (status == PCCD_OK) {
        if (every > 1) {
            snprintf(room, sizeof room, "; --max-size has room for one in %" PRIu64,
                     every);
        } else if (shown < failing->count) {
            snprintf(room, sizeof room, "; it is full");
        }
        fprintf(report, "%-10s %s: %" PRIu64 " of %" PRIu64 " %s%s%s\n", what,
                tool_shown(path), shown, all,
                proto_plural(all, "step that fails", "steps that fail"), room,
                failing->left_out > 0 ? "; --failing has more" : "");
    }
    whole_file_discard(&file);
    return status;
}

int failing_write(const struct failing *failing, const struct ctl_link *link,
                  FILE *report, struct ctl_error *error)
{
    int status = write_one(failing, link, true, report, error);
    return status == PCCD_OK ? write_one(failing, link, false, report, error) : status;
}

void failing_deinit(struct failing *failing)
{
    for (uint32_t i = 0; i < failing->count; i++) {
        frames_forget(&failing->steps[i].recording);
    }
    free(failing->steps);
}
