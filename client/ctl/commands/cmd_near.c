/* client/ctl/commands/cmd_near.c - pccdctl near.
 *
 * Room:     client/ctl.
 * Does:     reads meshes, each an object, has a daemon tell what is near, reports.
 * Does not: move anything.
 * Threads:  one.
 * Source:   near_run.h, near_report.h, near_csv.h.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "link.h"
#include "names.h"
#include "near_csv.h"
#include "near_report.h"
#include "near_run.h"
#include "shown.h"

#define DISTANCE_MAX    1e18
#define REPEATS_MAX     1000000u
#define THREADS_MAX     1024u
#define DEADLINE_MS_MAX 3600000u

enum {
    OPTION_DISTANCE = 256 + 64,
    OPTION_WHAT,
    OPTION_GAP,
    OPTION_JSON,
    OPTION_CSV,
    OPTION_THREADS,
    OPTION_METHOD,
    OPTION_TUNING,
    OPTION_REPEAT,
    OPTION_DEADLINE,
    OPTION_RESULT_BYTES
};

struct near_options {
    struct ctl_link link;
    struct pccd_near_settings settings;
    bool has_distance, has_gap, is_json;
    uint32_t repeats;
    const char *csv; /* NULL: none wanted */
    char **paths;    /* ours */
    uint32_t path_count;
};

static const struct argp_option option_list[] = {
    {"distance", OPTION_DISTANCE, "D", 0,
     "How near: 0 (what touches) to 1e18. For pairs, features and vertices; nearest: "
     "leave "
     "out what is farther apart",
     0},
    {"what", OPTION_WHAT, "pairs|features|vertices|nearest|crossings|depth", 0,
     "pairs (vertex-face and edge-edge within D, the default), features (the same, "
     "merged "
     "to the closest features), vertices (how near other features are to each), nearest "
     "(for each two objects the nearest pair), crossings (edges that pass through "
     "faces), "
     "depth (how deep the vertices of closed meshes are in others)",
     0},
    {"gap", OPTION_GAP, "G", 0,
     "nearest: end early, with a pair that is farther by at most G than the nearest", 0},
    {"json", OPTION_JSON, NULL, 0, "One JSON object instead of text", 0},
    {"csv", OPTION_CSV, "FILE", 0,
     "Write every record as CSV; - is the standard output, and the report then goes to "
     "the "
     "standard error",
     0},
    {"threads", OPTION_THREADS, "N", 0,
     "Use at most N threads (default: the daemon decides)", 0},
    {"method", OPTION_METHOD, "default|paper|wide", 0,
     "Method that finds the candidates: default, paper or wide; the answer is the same",
     0},
    {"tuning", OPTION_TUNING, "STRING", 0,
     "How threads share the work, such as scheduler=paper (default: the daemon decides)",
     0},
    {"repeat", OPTION_REPEAT, "N", 0,
     "Time N more runs after the first and report medians (default: 1)", 0},
    {"deadline", OPTION_DEADLINE, "MS", 0,
     "End after MS milliseconds; the answer may then be incomplete", 0},
    {"result-bytes", OPTION_RESULT_BYTES, "N", 0,
     "Size of the shared memory for answers; longer ones come in pages (default: 64 MiB)",
     0},
    {0},
};

static void check_usage(const struct argp_state *state, struct near_options *options)
{
    enum pccd_near_what what = options->settings.what;
    if (options->path_count == 0) {
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
    if (options->path_count == 1 && what == PCCD_NEAR_NEAREST) {
        tool_misused(state, "--what nearest: two files at least");
    }
    if (!options->has_distance && what == PCCD_NEAR_NEAREST) {
        options->settings.distance = INFINITY;
    }
}

/* What is asked. */
static error_t parse_question(int key, char *text, const struct argp_state *state)
{
    struct near_options *options = state->input;
    struct pccd_near_settings *settings = &options->settings;
    switch (key) {
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
    case OPTION_METHOD:
        settings->method = (enum pccd_method)ctl_option_name(
            state, "method", text, common_method_names, PCCD_METHOD_COUNT);
        break;
    case OPTION_TUNING:
        if (strlen(text) >= sizeof settings->tuning) {
            tool_misused(state, "--tuning: longer than %d bytes", PCCD_TUNING_BYTES - 1);
        }
        strcpy(settings->tuning, text);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct near_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->link;
        break;
    case OPTION_JSON:
        options->is_json = true;
        break;
    case OPTION_CSV:
        options->csv = text;
        break;
    case OPTION_THREADS:
        options->settings.threads =
            (uint32_t)ctl_option_count(state, "threads", text, 1, THREADS_MAX);
        break;
    case OPTION_REPEAT:
        options->repeats =
            (uint32_t)ctl_option_count(state, "repeat", text, 0, REPEATS_MAX);
        break;
    case OPTION_DEADLINE:
        options->settings.deadline_ns =
            ctl_option_count(state, "deadline", text, 1, DEADLINE_MS_MAX) * 1000000u;
        break;
    case OPTION_RESULT_BYTES:
        options->link.result_bytes =
            ctl_option_count(state, "result-bytes", text, 65536, (uint64_t)1 << 40);
        break;
    case ARGP_KEY_ARG:
        options->paths[options->path_count++] = text;
        break;
    case ARGP_KEY_END:
        check_usage(state, options);
        break;
    default:
        return parse_question(key, text, state);
    }
    return 0;
}

static const struct argp_child children[] = {{&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_near = {
    .options = option_list,
    .parser = parse,
    .args_doc = "MESH [MESH...]",
    .doc =
        "Tell what is near where meshes stand: pairs within a distance, the nearest pair "
        "of each two, edges that pass through faces, or how deep one mesh is in another. "
        "Each file, PLY or OBJ, is an object of its own; of one object, what shares no "
        "vertex is compared, too.\v"
        "Without --url, --socket and $PCCD_URL a private daemon is started. CSV columns: "
        "kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count; of vertices object,vertex,bound. "
        "Exit status: 0 when done (the report says what was found, and whether the "
        "answer "
        "is complete), 2 after wrong usage, 3 without a daemon, 4 after any other error.",
    .children = children};

static int ask(struct near_run *near, const struct near_options *options,
               struct near_csv *csv, struct ctl_error *error)
{
    int status = near_run_read(near, options->paths, options->path_count, error);
    if (status != PCCD_OK) {
        return status; /* before a daemon is asked for: a bad file costs nothing else */
    }
    if (ctl_link_open(&options->link, &near->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    status = near_csv_open(csv, error);
    if (status == PCCD_OK) {
        status = near_run_begin(near, options->csv != NULL, error);
    }
    return status == PCCD_OK
               ? near_run_ask(near, options->csv != NULL ? near_csv_page : NULL, csv,
                              error)
               : status;
}

static int run_near(const struct near_options *options)
{
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct near_run near = {.run = {.repeats = options->repeats},
                            .settings = options->settings};
    struct near_csv csv = {.path = options->csv, .near = &near};
    FILE *to = options->csv != NULL && strcmp(options->csv, "-") == 0 ? stderr : stdout;
    int status = ask(&near, options, &csv, &error);
    if (status == PCCD_OK && !options->is_json) {
        near_report_print(to, &near);
    } else if (status == PCCD_OK && !near_report_json(to, &near)) {
        status =
            ctl_error_set(&error, PCCD_E_SYSTEM, "the JSON report could not be written");
    }
    int closed = near_csv_close(&csv, status == PCCD_OK, &close_error);
    /* An empty text: the fault was told where it was found. */
    if (status != PCCD_OK && error.text[0] != '\0') {
        ctl_complain("%s", error.text);
    } else if (status == PCCD_OK && closed != PCCD_OK) {
        ctl_complain("%s", close_error.text);
    }
    pccd_close(near.run.client);
    near_run_deinit(&near);
    if (status == PCCD_E_NODAEMON) {
        return CTL_NO_DAEMON;
    }
    return status == PCCD_OK && closed == PCCD_OK ? CTL_DONE : CTL_FAILED;
}

int ctl_cmd_near(int argc, char **argv)
{
    struct near_options options = {.link = {.policy = CTL_LINK_PRIVATE_UNLESS_ENV},
                                   .settings = PCCD_NEAR_SETTINGS_INIT,
                                   .repeats = 1};
    int status = CTL_FAILED;
    options.paths = malloc((size_t)argc * sizeof *options.paths);
    if (options.paths == NULL) {
        status = ctl_complain("out of memory");
    } else if (argp_parse(&ctl_argp_near, argc, argv, 0, NULL, &options) == 0) {
        status = run_near(&options);
    }
    free(options.paths);
    ctl_link_deinit(&options.link);
    return status;
}
