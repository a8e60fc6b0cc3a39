/* client/ctl/commands/cmd_near.c - pccdctl near.
 *
 * Room:     client/ctl.
 * Does:     reads meshes, each an object, has a daemon tell what is near, reports.
 * Does not: move anything.
 * Threads:  one.
 * Source:   near_run.h, near_report.h, near_csv.h.
 */
#include <math.h>
#include <string.h>

#include "ask_options.h"
#include "ctl.h"
#include "names.h"
#include "near_csv.h"
#include "near_report.h"
#include "near_run.h"
#include "shown.h"

#define DISTANCE_MAX 1e18

enum { OPTION_DISTANCE = 256 + 64, OPTION_WHAT, OPTION_GAP, OPTION_CSV };

struct near_options {
    struct ask_options ask;
    struct pccd_near_settings settings;
    bool has_distance, has_gap;
};

static const struct argp_option option_list[] = {
    {"distance", OPTION_DISTANCE, "D", 0,
     "How near: 0 (what touches) to 1e18. Needed for pairs, features and vertices; with "
     "nearest it leaves out objects that are farther apart",
     0},
    {"what", OPTION_WHAT, "pairs|features|vertices|nearest|crossings|depth", 0,
     "pairs (vertex-face and edge-edge within D, the default), features (the closest "
     "features of these pairs, each once), vertices (for each the least distance of the "
     "pairs that it is part of, at most D), nearest (for each two objects the nearest "
     "pair), crossings (edges that pass through faces), depth (how deep the vertices of "
     "closed meshes are in others)",
     0},
    {"gap", OPTION_GAP, "G", 0,
     "nearest: end early, with a pair that is farther by at most G than the nearest", 0},
    {"csv", OPTION_CSV, "FILE", 0,
     "Write every record as CSV; - is the standard output, and the report then goes to "
     "the "
     "standard error",
     0},
    {0},
};

static void check_usage(const struct argp_state *state, struct near_options *options)
{
    enum pccd_near_what what = options->settings.what;
    if (options->ask.path_count == 0) {
        tool_misused(state, "one file at least: each is an object");
    }
    if (!options->has_distance && what <= PCCD_NEAR_VERTICES) {
        tool_misused(state, "--distance is missing: how near is near?");
    }
    if (options->has_distance && what > PCCD_NEAR_NEAREST) {
        tool_misused(state, "--distance: %s has no use for it", common_near_name(what));
    }
    if (options->has_gap && what != PCCD_NEAR_NEAREST) {
        tool_misused(state, "--gap is of --what nearest");
    }
    if (options->ask.path_count == 1 && what == PCCD_NEAR_NEAREST) {
        tool_misused(state, "--what nearest: two files at least");
    }
    if (!options->has_distance && what == PCCD_NEAR_NEAREST) {
        options->settings.distance = INFINITY;
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct near_options *options = state->input;
    struct pccd_near_settings *settings = &options->settings;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->ask;
        state->child_inputs[1] = &options->ask.link;
        break;
    case OPTION_DISTANCE:
        settings->distance = ctl_option_real(state, "distance", text, 0.0, DISTANCE_MAX);
        options->has_distance = true;
        break;
    case OPTION_GAP:
        settings->gap = ctl_option_real(state, "gap", text, 0.0, DISTANCE_MAX);
        options->has_gap = true;
        break;
    case OPTION_WHAT:
        settings->what = (enum pccd_near_what)ctl_option_name(
            state, "what", text, common_near_names, PCCD_NEAR_COUNT);
        break;
    case OPTION_CSV:
        options->ask.csv = text;
        break;
    case ARGP_KEY_END:
        check_usage(state, options);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const struct argp_child children[] = {
    {&ask_options_argp, 0, NULL, 0}, {&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_near = {
    .options = option_list,
    .parser = parse,
    .args_doc = "MESH [MESH...]",
    .doc =
        "Tell what is near where meshes stand: pairs within a distance, the nearest pair "
        "of each two, edges that pass through faces, or how deep one mesh is in another. "
        "Each file, PLY, OBJ, STL or glTF, is an object of its own. Objects are compared "
        "with each other, and each with itself except for features that share a vertex.\v"
        "Without --url, --socket and $PCCD_URL a private daemon is started. CSV columns: "
        "kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz; of vertices "
        "object,vertex,bound. "
        "Exit status: 0 when done (the report says what was found, and whether the "
        "answer "
        "is complete), 2 after wrong usage, 3 without a daemon, 4 after any other error.",
    .children = children};

static int ask(struct near_run *near, const struct near_options *options,
               struct near_csv *csv, struct ctl_error *error)
{
    const struct ask_options *asked = &options->ask;
    int status = near_run_read(near, asked->paths, asked->path_count, error);
    if (status != PCCD_OK) {
        return status; /* before a daemon is asked for: a bad file costs nothing else */
    }
    if (ctl_link_open(&asked->link, &near->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    status = near_csv_open(csv, error);
    if (status == PCCD_OK) {
        status = near_run_begin(near, asked->csv != NULL, error);
    }
    return status == PCCD_OK
               ? near_run_ask(near, asked->csv != NULL ? near_csv_page : NULL, csv, error)
               : status;
}

static int run_near(const struct near_options *options)
{
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct near_run near = {
        .run = {.ask = &options->ask,
                .repeats = options->ask.has_repeats ? options->ask.repeats : 1},
        .settings = options->settings};
    struct near_csv csv = {.path = options->ask.csv, .near = &near};
    FILE *to = ask_report_to(&options->ask);
    near.settings.threads = options->ask.threads;
    near.settings.method = options->ask.method;
    near.settings.deadline_ns = options->ask.deadline_ns;
    if (options->ask.tuning != NULL) {
        strcpy(near.settings.tuning, options->ask.tuning);
    }
    int status = ask(&near, options, &csv, &error);
    if (status == PCCD_OK && !options->ask.is_json) {
        near_report_print(to, &near);
    } else if (status == PCCD_OK && !near_report_json(to, &near)) {
        status =
            ctl_error_set(&error, PCCD_E_SYSTEM, "the JSON report could not be written");
    }
    int closed = near_csv_close(&csv, status == PCCD_OK, &close_error);
    pccd_close(near.run.client);
    near_run_deinit(&near);
    return ask_end(status, &error, closed, &close_error);
}

int ctl_cmd_near(int argc, char **argv)
{
    struct near_options options = {.settings = PCCD_NEAR_SETTINGS_INIT};
    int status = ask_options_read(&options.ask, &ctl_argp_near, argc, argv, &options);
    if (status == CTL_DONE) {
        status = run_near(&options);
    }
    ask_options_deinit(&options.ask);
    return status;
}
