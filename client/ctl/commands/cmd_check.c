/* cmd_check.c - pccdctl check. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_run.h"
#include "ctl.h"
#include "failing.h"
#include "output.h"
#include "shown.h"
#include "terminal.h"
#include "trace_file.h"

struct command {
    struct check_options check;
    struct scene_options scene;
    struct trace_options trace;
    struct failing_options failing;
    bool has_geometry;
};

static void check_usage(struct argp_state *state, void *to)
{
    const struct command *command = to;
    const struct trace_options *trace = &command->trace;
    if (command->has_geometry && command->check.ask.csv == NULL) {
        option_misused(state, "--geometry is of the contacts that --contacts writes");
    }
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
    {"geometry", 0, NULL,
     "With --contacts: add names of objects, where both features are touched, and the "
     "normal",
     OPTION_FLAG, .at = AT(has_geometry)},
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
                                          {&failing_table, AT(failing)},
                                          {&scene_table, AT(scene)},
                                          {&ctl_link_table, AT(check.ask.link)},
                                          {0}},
    .check = check_usage,
    .arguments = "MESH_T0 MESH_T1 [MESH_T2...]\nSCENE",
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
    const struct command *command;
    struct check_run run;
    struct contacts_csv csv;
    struct scene scene;
    struct objects objects;
    struct report_step *steps; /* [scene.count - 1] */
    struct progress progress;
    struct trace_file trace;
    struct failing failing;
    FILE *report;
};

static int walk(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->command->check.ask;
    uint32_t step_count = check->scene.count - 1;
    bool is_sequence = step_count > 1;
    int status = PCCD_OK;
    progress_begin(&check->progress, "runs",
                   (uint64_t)step_count * (check->run.repeats + 1u));
    progress_update(&check->progress, 0);
    check->run.progress = &check->progress;
    for (uint32_t i = 1; i <= step_count && status == PCCD_OK; i++) {
        struct report_step *step = &check->steps[i - 1];
        step->from = scene_frame_name(&check->scene, i - 1);
        step->to = scene_frame_name(&check->scene, i);
        if (i > 1) {
            status = scene_read(&check->scene, i, error);
        }
        if (status == PCCD_OK) {
            status =
                check_run_step(&check->run, &check->scene, i, &check->csv, step, error);
        }
        if (status == PCCD_OK && report_meets(step)) {
            status = failing_keep(&check->failing, &check->run, &check->scene, i, error);
        }
        if (status == PCCD_OK && is_sequence && !ask->is_json) {
            progress_clear(&check->progress);
            report_print_line(check->report, &check->run.told, i, step);
            report_print_pairs(check->report, &check->run.told, step);
        }
    }
    progress_clear(&check->progress);
    return status;
}

/* The same, between the beginning and the end of a recording if one is wanted. */
static int walk_recorded(struct check *check, struct ctl_error *error)
{
    struct pccd_client *client = check->run.client;
    const struct trace_options *options = &check->command->trace;
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

/* Return whether records are told with the names of what they are of: there are several
 * objects, or files that name their parts. */
static bool has_names(const struct scene *scene)
{
    bool has = scene->object_count > 1;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        has = has || scene->objects[i].files.mesh.object_count > 0;
    }
    return has;
}

/* Register the objects as their first frames are. */
static int begin(struct check *check, struct ctl_error *error)
{
    const struct check_options *options = &check->command->check;
    struct check_run *run = &check->run;
    struct scene *scene = &check->scene;
    bool is_named = has_names(scene), has_geometry = check->command->has_geometry;
    run->settings = check_step_settings(options);
    int status = check_run_begin(run, scene, is_named || options->ask.csv != NULL, error);
    for (uint32_t i = 0; status == PCCD_OK && i < scene->object_count; i++) {
        const struct scene_object *object = &scene->objects[i];
        status = objects_add(&check->objects, object->handle,
                             scene->object_count > 1 || !is_named ? object->name : "",
                             &object->files.mesh, object->edges, object->info.edge_count,
                             error);
    }
    run->told.names = check->objects.names;
    run->objects = is_named ? &check->objects : NULL;
    if (status == PCCD_OK) {
        status = failing_begin(&check->failing, run, error);
    }
    if (status == PCCD_OK && options->ask.csv != NULL) {
        check->csv = (struct contacts_csv){.path = options->ask.csv,
                                           .has_step = scene->count > 2,
                                           .has_names = is_named || has_geometry,
                                           .objects = &check->objects,
                                           .geometry = has_geometry ? scene : NULL};
        status = contacts_csv_open(&check->csv, error);
    }
    return status;
}

/* Open the files, and read the two first frames. */
static int read_scene(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->command->check.ask;
    struct scene *scene = &check->scene;
    int status = scene_take(scene, &ask->files, false, &check->command->scene, error);
    if (status == PCCD_OK) {
        status = scene_open(scene, error);
    }
    if (status == PCCD_OK && scene->count < 2) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s is one frame: a step has two, before and after it",
                             scene_frame_name(scene, 0));
    }
    if (status == PCCD_OK) {
        check->steps = calloc(scene->count - 1, sizeof *check->steps);
        status = check->steps != NULL
                     ? scene_read(scene, 0, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    return status == PCCD_OK ? scene_read(scene, 1, error) : status;
}

/* Read before a daemon is asked for, so that a bad file costs nothing else. */
static int check_all(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->command->check.ask;
    int status = read_scene(check, error);
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t default_repeats = check->scene.count == 2 ? 1 : 0;
    check->run.repeats = ask->has_repeats ? ask->repeats : default_repeats;
    if (ctl_link_open(&ask->link, &check->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    status = begin(check, error);
    if (status == PCCD_OK && !ask->is_json) {
        report_print_scene(check->report, &check->run.told);
    }
    for (uint32_t i = 0; i < check->scene.object_count; i++) {
        report_print_notes(ask->is_json ? stderr : check->report,
                           &check->scene.objects[i].files);
    }
    return status != PCCD_OK ? status : walk_recorded(check, error);
}

static int report_all(struct check *check, struct ctl_error *error)
{
    bool is_json = check->command->check.ask.is_json;
    uint32_t step_count = check->scene.count - 1;
    if (is_json &&
        !report_json(check->report, &check->run.told, check->steps, step_count)) {
        return ctl_error_set(error, PCCD_E_SYSTEM,
                             "the JSON report could not be written");
    }
    if (!is_json && step_count == 1) {
        report_print_step(check->report, &check->run.told, &check->steps[0]);
    }
    if (check->command->trace.path != NULL) {
        trace_file_report(&check->trace, is_json ? stderr : check->report, false);
    }
    return failing_write(&check->failing, &check->command->check.ask.link,
                         is_json ? stderr : check->report, error);
}

static int run_check(const struct command *command)
{
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct check check = {.command = command,
                          .scene = {.settings = &command->check.ask.object,
                                    .frames = &command->check.ask.frames},
                          .failing = {.options = &command->failing},
                          .report = ask_report_to(&command->check.ask)};
    bool is_free = false;
    int status = check_all(&check, &error), closed;
    if (status == PCCD_OK) {
        status = report_all(&check, &error);
    }
    closed =
        output_close(&check.csv.whole, check.csv.path, status == PCCD_OK, &close_error);
    uint32_t step_count = check.steps != NULL ? check.scene.count - 1 : 0;
    if (status == PCCD_OK) {
        status = check_run_judge(check.steps, step_count, &is_free, &error);
    }
    for (uint32_t i = 0; i < step_count; i++) {
        free(check.steps[i].pairs);
    }
    check_run_deinit(&check.run);
    pccd_close(check.run.client);
    failing_deinit(&check.failing);
    objects_deinit(&check.objects);
    scene_close(&check.scene);
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
    scene_options_deinit(&command.scene);
    ctl_link_deinit(&command.check.ask.link);
    return status;
}
