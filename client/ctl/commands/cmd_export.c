/* cmd_export.c - pccdctl export. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "answers.h"
#include "ctl.h"
#include "export.h"
#include "output.h"
#include "play_options.h"
#include "printable.h"
#include "shown.h"
#include "snapshot.h"
#include "whole_file.h"

struct export
{
    struct play_options options;
    const char *path;
    double t; /* NAN: not given */
    bool is_near;
    bool is_list;
    bool is_series; /* a file for each step, and one that names them */
};

static void take_output(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct export *export = to;
    (void)row;
    export->is_series = tool_ends_with(text, ".pvd");
    if (!tool_ends_with(text, ".glb") && !tool_ends_with(text, ".vtp") &&
        !export->is_series) {
        option_misused(state, "-o: \"%s\" ends with neither .glb, .vtp nor .pvd", text);
    }
    export->path = text;
}

static void check(struct argp_state *state, void *to)
{
    const struct export *export = to;
    if (export->is_near && !isnan(export->t)) {
        option_misused(state, "--near is of one moment: no --time");
    }
    if (export->is_near && export->is_series) {
        option_misused(state, "a .pvd has a file for each step: no --near");
    }
    if (export->is_list &&
        (export->is_near || !isnan(export->t) || export->path != NULL)) {
        option_misused(state, "--list writes nothing: no -o, --time, --near");
    }
}

#define AT(member) offsetof(struct export, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"time", 0, "T", "Show the step at time T, 0 to 1 (default: 1, its end)", OPTION_REAL,
     .at = AT(t), .min = 0, .max = 1},
    {"near", 0, NULL,
     "Write the last answer about what is near instead of contacts: lines between "
     "nearest points, and edges that cross",
     OPTION_FLAG, .at = AT(is_near)},
    CTL_OUTPUT,
    {"output", 'o', "FILE",
     "Where it goes: FILE.glb is glTF 2.0, FILE.vtp VTK PolyData; FILE.pvd names a "
     "FILE_N.vtp of each step N, a time series of ParaView (default: the name of the "
     "first file, with -step.glb)",
     OPTION_OWN, .take = take_output},
    {"list", 0, NULL,
     "Write nothing, but print which steps were answered, each with what was recorded of "
     "its answer; no daemon is asked",
     OPTION_FLAG, .at = AT(is_list)},
    {0}};

const struct option_table ctl_table_export = {
    .rows = rows,
    .parts = (const struct option_part[]){{&play_frames_table, AT(options)}, {0}},
    .check = check,
    .arguments = "FILE\nFRAME [FRAME...]\nSCENE",
    .text = "Write a step of a recording, or of the frames of a mesh, with its "
            "contacts, for other programs.",
    .more = "Without --steps it is the last step that was answered, with --steps the "
            "last of the range, and with -o FILE.pvd each one of it; with --near it is "
            "the last answer about what is near "
            "instead. The contacts are those of the recording, or of a daemon that "
            "repeats the step.",
    .examples = "  pccdctl export -o step.glb --steps 7 run.rec\n"
                "  pccdctl export --list --json run.rec\n",
};

static int write_still(const char *path, const struct snapshot *snapshot,
                       struct ctl_error *error)
{
    struct whole_file file = {.to = NULL};
    int status = snapshot->object_count > 0
                     ? output_open(&file, path, false, error)
                     : ctl_error_set(error, PCCD_E_INVAL,
                                     "step %" PRIu64 " is of a scene without objects",
                                     snapshot->step);
    if (status == PCCD_OK) {
        status = tool_ends_with(path, ".glb") ? gltf_write(snapshot, file.to, path, error)
                                              : vtp_write(snapshot, file.to, path, error);
    }
    if (status == PCCD_OK) {
        status = output_finish(&file, path, error);
    }
    whole_file_discard(&file);
    return status;
}

/* ---- a file for each step ---------------------------------------------------------- */

struct series {
    const struct export *export;
    double t;
    FILE *to;
    uint64_t count;
};

/* The value of an attribute of XML. */
static void print_quoted(FILE *to, const char *text)
{
    for (; *text != '\0'; text++) {
        const char *escaped = *text == '&'   ? "&amp;"
                              : *text == '<' ? "&lt;"
                              : *text == '"' ? "&quot;"
                                             : NULL;
        if (escaped != NULL) {
            fputs(escaped, to);
        } else {
            fputc(*text, to);
        }
    }
}

/* At the number of the step, less what is left of it at the time that is shown. */
static int write_member(void *context, const struct snapshot *snapshot,
                        struct ctl_error *error)
{
    struct series *series = context;
    const char *path = series->export->path;
    char *member = NULL;
    if (asprintf(&member, "%.*s_%06" PRIu64 ".vtp", (int)(strlen(path) - strlen(".pvd")),
                 path, snapshot->step) < 0) {
        return ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", path);
    }
    int status = write_still(member, snapshot, error);
    fprintf(series->to, "<DataSet timestep=\"%.17g\" part=\"0\" file=\"",
            (double)snapshot->step - 1 + series->t);
    print_quoted(series->to, tool_base_name(member));
    fputs("\"/>\n", series->to);
    series->count++;
    free(member);
    return status;
}

static int write_series(const struct export *export, double t,
                        struct play_summary *summary, struct ctl_error *error)
{
    struct play_settings settings = export->options.play;
    struct whole_file file = {.to = NULL};
    struct series series = {.export = export, .t = t};
    settings.only_last = false;
    int status = output_open(&file, export->path, false, error);
    if (status == PCCD_OK) {
        series.to = file.to;
        fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
              "<Collection>\n",
              file.to);
        status = snapshot_each(&settings, t, write_member, &series, summary, error);
    }
    if (status == PCCD_OK) {
        fputs("</Collection>\n</VTKFile>\n", file.to);
        status = output_finish(&file, export->path, error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&settings, summary);
        snapshot_report_steps(export->path, series.count, export->options.is_json);
    }
    whole_file_discard(&file);
    return status;
}

/* ---- which steps there are --------------------------------------------------------- */

static bool list_step(const struct record_answer *answer, json_t *steps)
{
    bool is_met = answer->toi_first <= 1;
    if (steps == NULL) {
        printf("step %" PRIu64 ": %" PRIu64 " %s", answer->step, answer->total,
               proto_plural(answer->total, "record", "records"));
        if (is_met) {
            printf(", first at t = %s", tool_shown_number(answer->toi_first));
        }
        putchar('\n');
        return true;
    }
    return json_array_append_new(
               steps, json_pack("{s:I, s:I, s:o}", "step", (json_int_t)answer->step,
                                "contacts", (json_int_t)answer->total, "toi_first",
                                is_met ? json_real(answer->toi_first) : json_null())) ==
           0;
}

static bool is_listed(const struct play_settings *play,
                      const struct record_answer *answer)
{
    return answer->is_near == 0 && answer->status == PCCD_OK &&
           answer->step >= play->first && (play->last == 0 || answer->step <= play->last);
}

/* Up to where the file is damaged, as it would be played. */
static int list_steps(const struct play_options *options, struct ctl_error *error)
{
    const struct play_settings *play = &options->play;
    struct record_reader reader = {.fd = -1};
    struct answers answers = {.count = 0};
    struct ctl_error damage = {.text = ""};
    json_t *steps = options->is_json ? json_array() : NULL;
    bool is_ok = steps != NULL || !options->is_json;
    int status = record_reader_open(&reader, play->path);
    if (status == PCCD_OK) {
        status = answers_read(&answers, &reader, &damage);
        if (status != PCCD_OK && status != PCCD_E_NOMEM) {
            ctl_complain("%s: %s", play->path, damage.text);
            status = PCCD_OK;
        }
    }
    for (size_t i = 0; status == PCCD_OK && i < answers.count; i++) {
        if (is_listed(play, &answers.items[i])) {
            is_ok = is_ok && list_step(&answers.items[i], steps);
        }
    }
    if (status != PCCD_OK) {
        ctl_error_set(error, status, "%s: %s", play->path, reader.text);
    } else if (!is_ok) {
        status = ctl_error_set(error, PCCD_E_NOMEM, "%s: no memory", play->path);
    }
    (void)output_json(steps, status == PCCD_OK, stdout);
    answers_deinit(&answers);
    record_reader_deinit(&reader);
    return status;
}

int ctl_cmd_export(int argc, char **argv)
{
    struct export export = {.t = NAN};
    struct snapshot snapshot = {.object_count = 0};
    struct play_summary summary;
    struct ctl_error error = {.text = ""};
    play_options_init(&export.options, "steps");
    export.options.takes_frames = true;
    export.options.play.source = PLAY_RECORDS;
    export.options.play.needs_records = true;
    export.options.play.only_last = true;
    if (option_parse(&ctl_table_export, argc, argv, &export) != 0) {
        return CTL_USAGE;
    }
    if (export.path == NULL) {
        /* not .glb alone: the files that are read may be glTF of that name */
        export.path = play_options_output(&export.options, "-step.glb");
    }
    const struct snapshot_at at = {.t = isnan(export.t) ? 1 : export.t};
    int status = export.path != NULL
                     ? play_options_open(&export.options, &error)
                     : ctl_error_set(&error, PCCD_E_NOMEM, "out of memory");
    if (status == PCCD_OK && export.is_list) {
        status = list_steps(&export.options, &error);
    } else if (status == PCCD_OK && export.is_series) {
        status = write_series(&export, at.t, &summary, &error);
    } else if (status == PCCD_OK) {
        status =
            export.is_near
                ? snapshot_take_near(&export.options.play, &snapshot, &summary, &error)
                : snapshot_take(&export.options.play, &at, &snapshot, &summary, &error);
    }
    bool is_still = !export.is_list && !export.is_series;
    if (status == PCCD_OK && is_still) {
        status = write_still(export.path, &snapshot, &error);
    }
    if (status == PCCD_OK && is_still) {
        play_options_warn(&export.options.play, &summary);
        snapshot_report(&snapshot, export.path, export.options.is_json);
    } else {
        ctl_error_tell(&error);
    }
    snapshot_deinit(&snapshot);
    play_options_deinit(&export.options);
    return (int)ctl_exit_of(status, true);
}
