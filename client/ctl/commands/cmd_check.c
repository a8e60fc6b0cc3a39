/* cmd_check.c - pccdctl check. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_run.h"
#include "ctl.h"
#include "meshframes.h"
#include "output.h"
#include "shown.h"
#include "terminal.h"
#include "trace_file.h"

struct command {
    struct check_options check;
    struct trace_options trace;
};

static void check_usage(struct argp_state *state, void *to)
{
    const struct trace_options *trace = &((const struct command *)to)->trace;
    if (trace->path != NULL && strcmp(trace->path, "-") == 0) {
        option_misused(state, "--trace: the standard output is the report's");
    }
    if (trace->path == NULL && (trace->min_us > 0 || trace->events > 0)) {
        option_misused(state, "--min-us and --events are of the recording, which --trace "
                              "asks for");
    }
}

#define AT(member) offsetof(struct command, member)
static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"trace", 0, "FILE",
     "Write a trace of what the daemon's threads do, for Perfetto; see pccdctl trace",
     OPTION_TEXT, .at = AT(trace.path)},
    {"min-us", 0, "U",
     "With --trace: leave out tasks that took less than U microseconds (default: 0)",
     OPTION_U64, .at = AT(trace.min_us), .min = 0, .max = TRACE_MIN_US_MAX},
    {"events", 0, "N",
     "With --trace: keep the newest N events of each thread (default: 65536, or what "
     "fits)",
     OPTION_U32, .at = AT(trace.events), .min = 1, .max = TRACE_EVENTS_MAX},
    {0}};

const struct option_table ctl_table_check = {
    .rows = rows,
    .parts = (const struct option_part[]){{&check_table, AT(check)},
                                          {&ctl_link_table, AT(check.ask.link)},
                                          {0}},
    .check = check_usage,
    .arguments = "MESH_T0 MESH_T1 [MESH_T2...]",
    .text = "Find every contact of a mesh that moves linearly from MESH_T0 to "
            "MESH_T1, then to MESH_T2 and so on. Files are PLY, OBJ, STL or glTF and "
            "have the same faces; seq%d.obj names all that are numbered, and a point "
            "cache (.pc2, .mdd) has the frames of the mesh file before it.",
    .more = "Without --url, --socket and $PCCD_URL a private daemon is started. CSV "
            "columns: kind,i0,i1,i2,i3,toi,toi_hi,proved, after a column step when "
            "there are more than two files. Exit status: 0 when nothing meets, 1 "
            "when something does, or in mode pairs may, 2 after wrong usage, 3 "
            "without a daemon, 4 after any other error, and when nothing was found "
            "in an answer that is incomplete.",
    .examples = "  pccdctl check a.obj b.obj\n"
                "  pccdctl check --mode first --json seq%d.obj\n",
};

/* Everything that lives while the frames are walked through. */
struct check {
    const struct check_options *options;
    const struct trace_options *tracing;
    struct check_run run;
    struct contacts_csv csv;
    struct ctl_frames files;
    struct objects objects;
    struct ctl_mesh frames[2]; /* before and after the step, by turns */
    struct report_step *steps; /* [files.count - 1] */
    struct progress progress;
    struct trace_file trace;
    FILE *report;
};

/* Read frame `index` beside the one before, and let both have one format. */
static int read_frame(struct check *check, uint32_t index, struct ctl_error *error)
{
    struct ctl_mesh *frame = &check->frames[index % 2];
    struct ctl_mesh *before = &check->frames[(index + 1) % 2];
    int status = ctl_frames_read(&check->files, index, frame, error);
    if (status == PCCD_OK && index > 0 && before->format != frame->format) {
        status = ctl_mesh_promote(before, error);
        if (status == PCCD_OK) {
            status = ctl_mesh_promote(frame, error);
        }
    }
    return status;
}

static int walk(struct check *check, struct ctl_error *error)
{
    const struct check_options *options = check->options;
    uint32_t step_count = check->files.count - 1;
    bool is_sequence = step_count > 1;
    int status = PCCD_OK;
    progress_begin(&check->progress, "runs",
                   (uint64_t)step_count * (check->run.repeats + 1u));
    progress_update(&check->progress, 0);
    check->run.progress = &check->progress;
    for (uint32_t i = 1; i <= step_count && status == PCCD_OK; i++) {
        struct report_step *step = &check->steps[i - 1];
        step->from = check->files.names[i - 1];
        step->to = check->files.names[i];
        if (i > 1) {
            status = read_frame(check, i, error);
        }
        if (status == PCCD_OK) {
            status = check_run_step(&check->run, &check->frames[(i + 1) % 2],
                                    &check->frames[i % 2], i, &check->csv, step, error);
        }
        if (status == PCCD_OK && is_sequence && !options->ask.is_json) {
            progress_clear(&check->progress);
            report_print_line(check->report, i, step);
            report_print_pairs(check->report, &check->run.mesh, step);
        }
    }
    progress_clear(&check->progress);
    return status;
}

/* The same, between the beginning and the end of a recording if one is wanted. */
static int walk_recorded(struct check *check, struct ctl_error *error)
{
    struct pccd_client *client = check->run.client;
    const struct trace_options *options = check->tracing;
    if (options->path == NULL) {
        return walk(check, error);
    }
    int status = trace_file_begin(&check->trace, options, client, error);
    if (status == PCCD_OK) {
        status = walk(check, error);
    }
    if (status == PCCD_OK) {
        status = trace_file_end(&check->trace, client, error);
    }
    trace_file_deinit(&check->trace);
    return status;
}

/* Register the mesh as its first frame is. */
static int begin(struct check *check, struct ctl_error *error)
{
    const struct check_options *options = check->options;
    struct check_run *run = &check->run;
    struct ctl_mesh first = check->files.mesh;
    first.x = check->frames[0].x;
    first.format = check->frames[0].format;
    run->settings = check_step_settings(options);
    run->ask = &options->ask;
    run->mesh.files = &check->files;
    run->mesh.welded = check->files.welded;
    run->mesh.object_what = options->ask.object.what;
    bool has_objects = first.object_count > 0;
    bool with_edges =
        options->ask.csv != NULL || (has_objects && !objects_are_one(&first));
    int status = check_run_begin(run, &first, with_edges, error);
    if (status == PCCD_OK && has_objects) {
        run->objects = &check->objects;
        check->csv.objects = &check->objects;
        status = objects_init(&check->objects, &check->files.mesh, run->edges,
                              run->mesh.info.edge_count, error);
    }
    if (status == PCCD_OK && options->ask.csv != NULL) {
        check->csv.triangles = (const uint32_t(*)[3])check->files.mesh.triangles.vertices;
        check->csv.edges = run->edges;
        check->csv.has_step = check->files.count > 2;
        check->csv.path = options->ask.csv;
        status = contacts_csv_open(&check->csv, error);
    }
    return status;
}

/* The two first frames are read before a daemon is asked for, so that a bad file costs
 * nothing else. */
static int check_all(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->ask;
    int status = ctl_frames_open(&check->files, ask->files.list, ask->files.count,
                                 &ask->frames, error);
    ctl_sequence_warn(&check->files.sequence);
    if (status == PCCD_OK && check->files.count < 2) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s is one frame: a step has two, before and after it",
                             check->files.names[0]);
    }
    if (status == PCCD_OK) {
        check->steps = calloc(check->files.count - 1, sizeof *check->steps);
        status = check->steps != NULL
                     ? read_frame(check, 0, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    if (status == PCCD_OK) {
        status = read_frame(check, 1, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t default_repeats = check->files.count == 2 ? 1 : 0;
    check->run.repeats = ask->has_repeats ? ask->repeats : default_repeats;
    if (ctl_link_open(&ask->link, &check->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    status = begin(check, error);
    if (status == PCCD_OK && !ask->is_json) {
        report_print_mesh(check->report, &check->run.mesh);
    }
    report_print_notes(ask->is_json ? stderr : check->report, &check->files);
    return status != PCCD_OK ? status : walk_recorded(check, error);
}

static int report_all(struct check *check, struct ctl_error *error)
{
    uint32_t step_count = check->files.count - 1;
    if (check->options->ask.is_json &&
        !report_json(check->report, &check->run.mesh, check->steps, step_count)) {
        return ctl_error_set(error, PCCD_E_SYSTEM,
                             "the JSON report could not be written");
    }
    if (!check->options->ask.is_json && step_count == 1) {
        report_print_step(check->report, &check->run.mesh, &check->steps[0]);
    }
    if (check->tracing->path != NULL) {
        trace_file_report(&check->trace,
                          check->options->ask.is_json ? stderr : check->report, false);
    }
    return PCCD_OK;
}

static int run_check(const struct command *command)
{
    const struct check_options *options = &command->check;
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct check check = {.options = options,
                          .tracing = &command->trace,
                          .report = ask_report_to(&options->ask)};
    bool is_free = false;
    int status = check_all(&check, &error), closed;
    if (status == PCCD_OK) {
        status = report_all(&check, &error);
    }
    closed =
        output_close(&check.csv.whole, check.csv.path, status == PCCD_OK, &close_error);
    if (status == PCCD_OK) {
        status = check_run_judge(check.steps, check.files.count - 1, &is_free, &error);
    }
    check_run_deinit(&check.run);
    pccd_close(check.run.client);
    ctl_mesh_deinit(&check.frames[0]);
    ctl_mesh_deinit(&check.frames[1]);
    for (uint32_t i = 0; check.steps != NULL && i + 1 < check.files.count; i++) {
        free(check.steps[i].pairs);
    }
    objects_deinit(&check.objects);
    ctl_frames_close(&check.files);
    free(check.steps);
    return ask_end(status, is_free, &error, closed, &close_error);
}

int ctl_cmd_check(int argc, char **argv)
{
    struct command command = {.check.settings = PCCD_STEP_SETTINGS_INIT};
    int status = CTL_USAGE;
    command.check.ask.link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    if (option_parse(&ctl_table_check, argc, argv, &command) == 0) {
        status = run_check(&command);
    }
    ctl_link_deinit(&command.check.ask.link);
    return status;
}
