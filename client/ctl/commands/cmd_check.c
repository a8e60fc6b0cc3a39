/* cmd_check.c - pccdctl check. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "check_walk.h"
#include "ctl.h"

#define JOBS_MAX 1024u

static void take_part(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct results_options *results = &((struct check_command *)to)->results;
    int length = -1;
    if (sscanf(text, "%" SCNu32 "/%" SCNu32 "%n", &results->part, &results->parts,
               &length) != 2 ||
        length != (int)strlen(text) || !results_part_is(results)) {
        option_misused(state, "--%s: \"%s\" is not I/N, I from 1 to N", row->name, text);
    }
}

static void check_results(struct argp_state *state, const struct check_command *command)
{
    const struct results_options *results = &command->results;
    const struct ask_options *ask = &command->check.ask;
    const char *name = results->parts > 0  ? "--part"
                       : results->jobs > 1 ? "--jobs"
                                           : "--results";
    bool is_stdout = results->path != NULL && strcmp(results->path, "-") == 0;
    if (results->path == NULL && results->jobs <= 1 && results->parts == 0) {
        return;
    }
    if (results->parts > 0 && (results->path == NULL || is_stdout || results->jobs > 1)) {
        option_misused(state, "--part wants a file of --results, and no --jobs");
    }
    if (ask->is_json || ask->deadline_ns > 0) {
        option_misused(state, "%s: not with %s", name,
                       ask->is_json ? "--json; lines of --results are JSON"
                                    : "--deadline; others would be told something else");
    }
    if (results->jobs > 1 &&
        (ask->csv != NULL || command->trace.path != NULL ||
         command->failing.page != NULL || command->failing.film != NULL)) {
        option_misused(state, "--jobs: not with --contacts, --trace, --page or --film");
    }
    if (is_stdout && ask->csv != NULL && strcmp(ask->csv, "-") == 0) {
        option_misused(state, "--results, --contacts: there is one standard output");
    }
}

/* Refuse what is asked of frames alone. */
static void check_screw(struct argp_state *state, const struct check_command *command)
{
    const struct pccd_step_settings *settings = &command->check.settings;
    const struct pccd_step_settings defaults = PCCD_STEP_SETTINGS_INIT;
    const struct ask_options *ask = &command->check.ask;
    const struct {
        const char *name;
        bool is_given;
    } others[] = {
        {"mode", settings->mode != defaults.mode},
        {"tolerance", settings->tolerance != defaults.tolerance},
        {"approach", settings->approach > 0},
        {"touching", settings->touching != 0},
        {"rest-exclusion", (ask->object.what & PCCD_OBJECT_REST_DISTANCE) != 0},
        {"rings", (ask->object.what & PCCD_OBJECT_REST_RINGS) != 0},
        {"rate", ask->frames.wish.rate > 0},
        {"animation", ask->frames.wish.animation != NULL},
        {"repeat", ask->has_repeats},
        {"method", ask->method != PCCD_METHOD_DEFAULT},
        {"tuning", ask->tuning != NULL},
        {"deadline", ask->deadline_ns > 0},
        {"contacts", ask->csv != NULL},
        {"results", command->results.path != NULL},
        {"part", command->results.parts > 0},
        {"jobs", command->results.jobs > 1},
        {"trace", command->trace.path != NULL},
        {"page", command->failing.page != NULL},
        {"film", command->failing.film != NULL},
    };
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (others[i].is_given) {
            option_misused(state, "--%s: not with --motion screw", others[i].name);
        }
    }
    if (ask->files.count + command->scene.with.count < 2) {
        option_misused(state, "--motion screw: two files: of what turns, and of what it "
                              "may meet");
    }
}

static void check_usage(struct argp_state *state, void *to)
{
    const struct check_command *command = to;
    const struct trace_options *trace = &command->trace;
    check_results(state, command);
    if (command->screw.motion != 0) {
        check_screw(state, command);
    }
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

#define AT(member) offsetof(struct check_command, member)
static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"geometry", 0, NULL,
     "With --contacts: add names of objects, the points of both features instead of one, "
     "and the normal",
     OPTION_FLAG, .at = AT(has_geometry)},
    {"results", 0, "FILE",
     "Write what comes of each step as a line of JSON to FILE, and go on with what is "
     "there already; the whole file is a certificate (pccdctl verify); - is the standard "
     "output, and the report then goes to the standard error",
     OPTION_TEXT, .at = AT(results.path)},
    {"part", 0, "I/N",
     "Check part I of N of the steps alone; its results go to FILE.I-of-N", OPTION_OWN,
     .take = take_part},
    {"jobs", 0, "N", "Check in N processes, each a part of the steps", OPTION_U32,
     .at = AT(results.jobs), .min = 1, .max = JOBS_MAX},
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
                                          {&check_screw_table, AT(screw)},
                                          {&failing_table, AT(failing)},
                                          {&scene_table, AT(scene)},
                                          {&ctl_link_table, AT(check.ask.link)},
                                          {0}},
    .check = check_usage,
    .arguments = "MESH_T0 MESH_T1 [MESH_T2...]\nSCENE\n--motion screw BODY OTHER...",
    .text = "Find every contact of a mesh that moves linearly from MESH_T0 to "
            "MESH_T1, then to MESH_T2 and so on. Files are PLY, OBJ, STL or glTF and "
            "have the same faces; seq%d.obj names all that are numbered, and a point "
            "cache (.pc2, .mdd) has the frames of the mesh file before it. With --motion "
            "screw: tell whether BODY meets OTHER while it turns, as pccdctl sweep does.",
    .more = "Without --url, --socket and $PCCD_URL a private daemon is started. CSV "
            "columns: kind,i0,i1,i2,i3,toi,toi_hi,proved,x,y,z, after a column step "
            "when there are more than two files. Exit status: 0 when nothing meets, 1 "
            "when something does, or in mode pairs may, 2 after wrong usage, 3 "
            "without a daemon, 4 after any other error, and when nothing was found "
            "in an answer that is incomplete, 5 when a screw meets nothing and a part "
            "of it stays undecided.",
    .examples = "  pccdctl check a.obj b.obj\n"
                "  pccdctl check --mode first --json seq%d.obj\n",
};

int ctl_cmd_check(int argc, char **argv)
{
    struct check_command command = {.check.settings = PCCD_STEP_SETTINGS_INIT};
    int status = CTL_USAGE;
    command.check.ask.link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    if (option_parse(&ctl_table_check, argc, argv, &command) == 0) {
        status = command.screw.motion == 0
                     ? check_walk(&command)
                     : sweep_screw(&command.screw, &command.check.ask, &command.scene,
                                   command.check.settings.separation);
    }
    scene_options_deinit(&command.scene);
    ctl_link_deinit(&command.check.ask.link);
    return status;
}
