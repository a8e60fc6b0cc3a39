/* tools.c - the tools that an agent has: what each takes, does and tells. */
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "confined.h"
#include "ctl.h"
#include "kinds.h"
#include "mcp.h"
#include "output.h"
#include "pccd_types.h"
#include "shown.h"
#include "whole_file.h"

#define LENGTH_MAX   1e18
#define PAIRS_SHOWN  3u
#define WARNINGS_MAX 3u
#define UNITS                                                                            \
    "step k: frame k-1 to k, frames from 0; t 0 to 1 in a step; lengths in the files' "  \
    "unit"

/* ---- what several tools take ------------------------------------------------------- */

#define FIELD(name, form, text, ...)                                                     \
    {                                                                                    \
        name, form, .meaning = text, __VA_ARGS__                                         \
    }
#define LENGTH .min = 0, .max = LENGTH_MAX
#define FRAMES_TAKES                                                                     \
    FIELD("with", MCP_FILES,                                                             \
          "Further files, each an object of its own: it stands, or moves along if it "   \
          "has as many frames",                                                          \
          .option = "--with"),                                                           \
        FIELD("weld", MCP_TEXT,                                                          \
              "auto (default): vertices at one place in every frame are one; off; or a " \
              "length",                                                                  \
              .option = "--weld"),                                                       \
        FIELD("animation", MCP_TEXT, "Of a glTF file: name or number of the animation",  \
              .option = "--animation"),                                                  \
        FIELD("rate", MCP_REAL, "Of a glTF file: frames a second (default: keyframes)",  \
              .min = 1e-3, .max = 1e5, .option = "--rate")
#define PAIRS_TAKES                                                                      \
    FIELD("between", MCP_TEXTS,                                                          \
          "\"A,B\": ask about the pairs of these two objects alone, by their names",     \
          .option = "--between"),                                                        \
        FIELD("self_pairs", MCP_TRUTH,                                                   \
              "false: leave out pairs of an object with itself", .option = "|--no-self")
#define THICK_TAKES                                                                      \
    FIELD("thickness", MCP_REAL, "Radius of every feature: two meet when 2 of it apart", \
          LENGTH, .option = "--thickness"),                                              \
        FIELD("rest_exclusion", MCP_REAL,                                                \
              "Own pairs nearer than this in the first frame have no thickness", LENGTH, \
              .option = "--rest-exclusion"),                                             \
        FIELD("rings", MCP_WHOLE, "Own pairs that so many edges join have no thickness", \
              .min = 0, .max = 8, .option = "--rings")

/* Arguments that say where things are, for explain and its picture. */
static const struct mcp_field place_takes[] = {
    {"files", MCP_FILES, .meaning = "", .option = ""}, FRAMES_TAKES, {0}};
static const struct mcp_field picture_takes[] = {
    {"files", MCP_FILES, .meaning = "", .option = ""}, FRAMES_TAKES, PAIRS_TAKES, {0}};

/* ---- what several tools tell ------------------------------------------------------- */

#define ROWS_TELLS(type, text)                                                           \
    {"rows", MCP_ROWS, .meaning = text, .is_needed = true, .of = type},                  \
        {"row_count", MCP_WHOLE, .meaning = "How many rows there are in all",            \
         .is_needed = true},                                                             \
        {"offset", MCP_WHOLE, .meaning = "Number of the first row here, from 0",         \
         .is_needed = true},                                                             \
        {"handle", MCP_TEXT, .meaning = "For more and explain", .is_needed = true},      \
        {"next_offset", MCP_WHOLE,                                                       \
         .meaning = "Ask more with this offset for the next rows"},                      \
    {                                                                                    \
        "rows_kept", MCP_WHOLE,                                                          \
            .meaning = "Only the first so many rows can be asked for"                    \
    }
#define COMMON_TELLS                                                                     \
    {"warnings", MCP_TEXTS, .meaning = "What may not be as it was meant"},               \
    {                                                                                    \
        "next", MCP_TEXT, .meaning = "A call that tells more"                            \
    }

static const struct mcp_field no_fields[] = {{0}};

/* ---- JSON -------------------------------------------------------------------------- */

static int64_t whole_at(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

static const char *text_at(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text != NULL ? text : "";
}

/* Copy a member that is there and no null; under another name if `as` is one. */
static void copy_member(json_t *to, const char *as, const json_t *from, const char *key,
                        bool *ok)
{
    json_t *value = json_object_get(from, key);
    if (value != NULL && !json_is_null(value)) {
        json_set(to, as != NULL ? as : key, json_incref(value), ok);
    }
}

static json_t *format_text(const char *format, ...) __attribute__((format(printf, 1, 2)));
static json_t *format_text(const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return json_text(text);
}

/* ---- running a command ------------------------------------------------------------- */

/* Run a job, and read the JSON that it has printed. `status_max`: exit statuses up to it
 * are answers. NULL: it failed, as the error says. */
static json_t *run(struct mcp *mcp, struct mcp_job *job, int status_max,
                   struct ctl_error *error)
{
    if (mcp_job_run(job, mcp, error) != PCCD_OK) {
        return NULL;
    }
    json_t *report = json_loads(job->out, 0, NULL);
    if (report == NULL || job->status > status_max) {
        const char *why = mcp_job_complaint(job);
        if (job->status >= 128) {
            (void)ctl_error_set(error, PCCD_E_INVAL, "%s was ended by signal %d",
                                job->words[0], job->status - 128);
        } else {
            (void)ctl_error_set(error, PCCD_E_INVAL, "%.900s",
                                why != NULL ? why : "it has not said what is wrong");
        }
        json_decref(report);
        return NULL;
    }
    return report;
}

/* Run a job that writes a file. `status_max`: as of run. PCCD_OK, or an error that begins
 * with `what`. */
static int run_plain(struct mcp *mcp, struct mcp_job *job, int status_max,
                     const char *what, struct ctl_error *error)
{
    int status = mcp_job_run(job, mcp, error);
    if (status != PCCD_OK || job->status <= status_max) {
        return status;
    }
    const char *why = mcp_job_complaint(job);
    return ctl_error_set(error, PCCD_E_INVAL, "%s%.900s", what,
                         why != NULL ? why : "it has not said what is wrong");
}

static void begin(struct mcp_job *job, int (*command)(int argc, char **argv),
                  const char *name)
{
    job->run = command;
    mcp_job_add(job, "%s", name);
}

/* The same of a command that asks a daemon, and answers in JSON. */
static void begin_asking(struct mcp_job *job, const struct mcp *mcp,
                         int (*command)(int argc, char **argv), const char *name)
{
    begin(job, command, name);
    mcp_job_add(job, "--json");
    if (mcp->timeout_ms > 0) {
        mcp_job_add(job, "--timeout=%d", mcp->timeout_ms);
    }
}

/* Warnings of a report, and those on stderr; cut to a few. */
static void set_warnings(json_t *answer, const json_t *report, struct mcp_job *job,
                         bool *ok)
{
    json_t *list = json_array();
    const json_t *told = json_object_get(report, "warnings");
    for (size_t i = 0; i < json_array_size(told) && i < WARNINGS_MAX; i++) {
        json_append(list, json_incref(json_array_get(told, i)), ok);
    }
    char *rest = job->err;
    for (char *line; rest != NULL && (line = strsep(&rest, "\n")) != NULL;) {
        const char *warning = strstr(line, "warning: ");
        if (warning != NULL && json_array_size(list) < WARNINGS_MAX) {
            json_append(list, json_text(warning + strlen("warning: ")), ok);
        }
    }
    if (json_array_size(list) > 0) {
        json_set(answer, "warnings", list, ok);
    } else {
        json_decref(list);
    }
}

/* 0, or complain of where something is to be written. */
static int check_output(const struct mcp *mcp, const char *name, const char *ending,
                        struct ctl_error *error)
{
    if (!mcp->may_write) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "\"output\": nothing is written, as pccdctl mcp was started "
                             "without --write");
    }
    if (!tool_ends_with(name, ending)) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "\"output\": \"%.200s\" is not named "
                             "FILE%s",
                             name, ending);
    }
    int why = tool_is_outside(name, true);
    return why == 0
               ? PCCD_OK
               : ctl_error_set(error, PCCD_E_INVAL, "\"output\": \"%.700s\": %s", name,
                               why == EEXIST ? "there is a file of that name; take "
                                               "another one"
                                             : tool_why(why));
}

/* The columns PREFIXx, PREFIXy and PREFIXz of a record. */
static json_t *point_of(const json_t *row, char prefix)
{
    double x[3] = {0, 0, 0};
    bool is_there = false;
    for (int k = 0; k < 3; k++) {
        const char key[3] = {prefix, "xyz"[k], '\0'};
        const json_t *value = json_object_get(row, key);
        is_there = value != NULL;
        x[k] = json_number_value(value);
    }
    return is_there ? json_pack("[f, f, f]", x[0], x[1], x[2]) : NULL;
}

static void set_point(json_t *to, const char *as, const json_t *row, char prefix,
                      bool *ok)
{
    json_t *point = point_of(row, prefix);
    if (point != NULL) {
        json_set(to, as, point, ok);
    }
}

/* ---- records ----------------------------------------------------------------------- */

/* Where the feature of a record begins and ends among its vertices i0, i1, ... */
static bool points_of(const json_t *row, int side, uint32_t *first, uint32_t *count)
{
    const char *kind = text_at(row, "kind");
    for (uint32_t i = 0; i < COMMON_KIND_COUNT; i++) {
        if (strcmp(kind, common_kinds[i].name) == 0) {
            *first = side == 0 ? 0 : common_kinds[i].points[0];
            *count = common_kinds[i].points[side];
            return true;
        }
    }
    return false;
}

static json_t *vertices_of(const json_t *row, int side, bool *ok)
{
    uint32_t first = 0, count = 0;
    json_t *list = json_array();
    *ok = points_of(row, side, &first, &count) && *ok;
    for (uint32_t i = first; i < first + count; i++) {
        char key[4];
        snprintf(key, sizeof key, "i%u", i % 10);
        json_append(list, json_integer(whole_at(row, key)), ok);
    }
    return list;
}

/* Return the object of a side: its name, or its number from 1; NULL: it is not told. */
static const json_t *object_of(const json_t *row, int side)
{
    const json_t *named = json_object_get(row, side == 0 ? "object_a" : "object_b");
    return named != NULL ? named : json_object_get(row, side == 0 ? "a" : "b");
}

/* "box face 1-5-7" */
static json_t *feature_text(const json_t *row, const json_t *names, int side, bool *ok)
{
    uint32_t first = 0, count = 0;
    char text[80];
    const json_t *object = object_of(row, side);
    const char *name = json_is_integer(object)
                           ? json_string_value(json_array_get(
                                 names, (size_t)json_integer_value(object) - 1))
                           : json_string_value(object);
    if (!points_of(row, side, &first, &count)) {
        return format_text("a kind of record that is not known");
    }
    json_t *vertices = vertices_of(row, side, ok);
    size_t used = (size_t)snprintf(text, sizeof text, "%s", common_feature_names[count]);
    for (uint32_t i = 0; i < count; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "%c%" JSON_INTEGER_FORMAT, i == 0 ? ' ' : '-',
                                 json_integer_value(json_array_get(vertices, i)));
    }
    json_decref(vertices);
    return format_text("%.200s%s%s", name != NULL ? name : "", name != NULL ? " " : "",
                       text);
}

#define SIDES_TELLS                                                                      \
    {"a", MCP_TEXT,                                                                      \
     .meaning = "A feature: its object, vertex, edge or face, and its vertices, as "     \
                "the file numbers them from 0"},                                         \
    {                                                                                    \
        "b", MCP_TEXT, .meaning = "The other one"                                        \
    }

static json_t *show_contact(const json_t *row, const json_t *names)
{
    bool ok = true;
    json_t *shown = json_object();
    json_set(
        shown, "step",
        json_integer(json_object_get(row, "step") != NULL ? whole_at(row, "step") : 1),
        &ok);
    json_set(shown, "a", feature_text(row, names, 0, &ok), &ok);
    json_set(shown, "b", feature_text(row, names, 1, &ok), &ok);
    copy_member(shown, "t", row, "toi", &ok);
    if (json_object_get(row, "toi") != NULL) {
        json_set(shown, "proved", json_boolean(whole_at(row, "proved") != 0), &ok);
    }
    return shown;
}

static const struct mcp_field near_row[] = {
    SIDES_TELLS,
    {"distance", MCP_REAL, .meaning = "How far apart they are; 0: they touch or cross"},
    {"direction", MCP_REALS, .meaning = "Of length 1, from b to a"},
    {"bound", MCP_REAL,
     .meaning = "Of a vertex (a): the least distance of what it is part of"},
    {0}};

static json_t *show_near(const json_t *row, const json_t *names)
{
    bool ok = true;
    json_t *shown = json_object();
    if (json_object_get(row, "bound") != NULL) {
        size_t object = (size_t)whole_at(row, "object") - 1;
        const char *name = json_string_value(json_array_get(names, object));
        json_set(shown, "a",
                 format_text("%.200s vertex %" PRId64, name != NULL ? name : "",
                             whole_at(row, "vertex")),
                 &ok);
        copy_member(shown, NULL, row, "bound", &ok);
        return shown;
    }
    json_set(shown, "a", feature_text(row, names, 0, &ok), &ok);
    json_set(shown, "b", feature_text(row, names, 1, &ok), &ok);
    copy_member(shown, "distance", row, "d_lo", &ok);
    if (strcmp(text_at(row, "kind"), "ef") != 0) {
        set_point(shown, "direction", row, 'n', &ok);
    }
    return shown;
}

/* ---- scene ------------------------------------------------------------------------- */

static const struct mcp_field scene_takes[] = {
    {"files", MCP_FILES,
     .meaning = "Mesh files, each an object, or seq%d.obj for all that are numbered, or "
                "one scene "
                "file (.json). None: the folder is listed",
     .option = ""},
    FRAMES_TAKES,
    {"folder", MCP_FILE, .meaning = "The folder to list (default: the one that is open)"},
    {"output", MCP_FILE,
     .meaning = "Write a scene file for these files, FILE.json, beside them"},
    {0}};
static const struct mcp_field scene_row[] = {
    {"file", MCP_TEXT, .meaning = "Its name; one that ends in / is a folder"},
    {"bytes", MCP_WHOLE, .meaning = "Size of the file"},
    {"object", MCP_TEXT, .meaning = "Name of the object, for between"},
    {"frames", MCP_WHOLE, .meaning = "1: it stands"},
    {"vertices", MCP_WHOLE, .meaning = "Of the first frame"},
    {"triangles", MCP_WHOLE, .meaning = "Of the first frame"},
    {"low", MCP_REALS, .meaning = "Least x, y, z of the first frame"},
    {"high", MCP_REALS, .meaning = "Greatest x, y, z of the first frame"},
    {0}};
static const struct mcp_field scene_tells[] = {
    {"frames", MCP_WHOLE, .meaning = "Frames of the scene; a step has two"},
    {"written", MCP_TEXT, .meaning = "The scene file that was written"},
    {"units", MCP_TEXT, .meaning = "What numbers count"},
    ROWS_TELLS(scene_row, "Objects, or files of the folder"),
    COMMON_TELLS,
    {0}};

static int write_scene(struct mcp *mcp, const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    const char *name = tool_from_folder(text_at(asked, "output"));
    int status = strchr(name, '/') != NULL
                     ? ctl_error_set(error, PCCD_E_INVAL,
                                     "\"output\": a scene file stands in the folder "
                                     "itself, from which its files count")
                     : check_output(mcp, name, ".json", error);
    if (status == PCCD_OK) {
        static const struct mcp_field files[] = {
            {"files", MCP_FILES, .meaning = "", .option = ""},
            {"with", MCP_FILES, .meaning = "", .option = ""},
            {0}};
        begin(&job, ctl_cmd_scene, "pccdctl scene");
        mcp_job_add(&job, "--output=%s", name);
        mcp_job_add(&job, "new");
        mcp_job_add_fields(&job, files, asked);
        status = run_plain(mcp, &job, 0, "", error);
    }
    mcp_job_deinit(&job);
    return status;
}

static json_t *answer_scene(struct mcp *mcp, const struct mcp_tool *tool,
                            const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    bool has_files = json_object_get(asked, "files") != NULL, ok = true;
    bool writes = json_object_get(asked, "output") != NULL;
    const char *folder = text_at(asked, "folder");
    if (!has_files && (writes || json_object_get(asked, "with") != NULL)) {
        (void)ctl_error_set(error, PCCD_E_INVAL, "\"files\" is missing: of which files?");
        return NULL;
    }
    begin(&job, has_files ? mcp_look_scene : mcp_look_folder, "pccdctl mcp");
    if (has_files) {
        mcp_job_add(&job, "--each");
        mcp_job_add_fields(&job, place_takes, asked);
    } else {
        mcp_job_add(&job, "%s", folder[0] != '\0' ? tool_from_folder(folder) : ".");
    }
    json_t *report = run(mcp, &job, 0, error), *answer = NULL;
    if (report != NULL && writes && write_scene(mcp, asked, error) != PCCD_OK) {
        json_decref(report);
        report = NULL;
    }
    if (report != NULL) {
        json_t *rows = json_incref(json_object_get(report, "rows"));
        const struct mcp_table *table =
            mcp_keep(mcp, has_files ? "objects" : "files",
                     (struct mcp_table){.tool = tool,
                                        .asked = asked,
                                        .rows = rows,
                                        .count = json_array_size(rows)});
        answer = json_object();
        copy_member(answer, NULL, report, "frames", &ok);
        if (writes) {
            copy_member(answer, "written", asked, "output", &ok);
        }
        json_set(answer, "units", json_string(UNITS), &ok);
        mcp_show_rows(answer, table, 0, &ok);
        set_warnings(answer, report, &job, &ok);
        json_set(answer, "next",
                 json_string(!has_files ? "scene {files}, check {files} or near {files}"
                             : whole_at(report, "frames") > 1
                                 ? "check {files}"
                                 : "near {files, what: nearest}, or crossings {files}"),
                 &ok);
        json_decref(report);
    }
    mcp_job_deinit(&job);
    return answer;
}

/* ---- check ------------------------------------------------------------------------- */

static const struct mcp_field check_takes[] = {
    {"files", MCP_FILES,
     .meaning = "Frames of one mesh in their order, or seq%d.obj, or a mesh and a point "
                "cache (.pc2, "
                ".mdd), or one animated glTF file, or one scene file (.json)",
     .is_needed = true, .option = ""},
    FRAMES_TAKES,
    PAIRS_TAKES,
    THICK_TAKES,
    {"mode", MCP_WORD,
     .meaning = "all contacts (default), the first, any (yes or no, fastest), or pairs "
                "that no axis "
                "separates",
     .words = "all|first|any|pairs", .option = "--mode"},
    {"separation", MCP_REAL,
     .meaning = "Things meet when so far apart, on top of thickness", .min = 0,
     .max = LENGTH_MAX, .option = "--separation"},
    {"approach", MCP_REAL,
     .meaning =
         "What begins nearer than its thickness meets at this part of that distance",
     .min = 1e-9, .max = 0.999999999, .option = "--approach"},
    {"touching", MCP_WORD,
     .meaning = "What touches at t = 0 is a contact then (kept, the default); left-out: "
                "not if it slides or leaves, so that it has a safe step",
     .words = "kept|left-out", .option = "--touching"},
    {"output", MCP_FILE,
     .meaning = "Write a certificate there, FILE.jsonl: what comes of each step, which "
                "verify does again"},
    {0}};
static const struct mcp_field pair_row[] = {
    {"a", MCP_TEXT, .meaning = "Name of an object", .is_needed = true},
    {"b", MCP_TEXT, .meaning = "Name of the other, or of the same one",
     .is_needed = true},
    {"contacts", MCP_WHOLE, .meaning = "How many", .is_needed = true},
    {0}};
static const struct mcp_field check_row[] = {
    {"step", MCP_WHOLE, .meaning = "From 1: from frame step - 1 to frame step",
     .is_needed = true},
    {"contacts", MCP_WHOLE, .meaning = "What meets within the step", .is_needed = true},
    {"t", MCP_REAL, .meaning = "Of the first, 0 to 1"},
    {"safe_step", MCP_REAL, .meaning = "The part of the step that nothing meets in"},
    {"crossings", MCP_WHOLE,
     .meaning = "Edges that pass through faces where the step begins"},
    {"inside", MCP_WHOLE, .meaning = "Vertices that begin inside of something"},
    {"pairs", MCP_ROWS, .meaning = "Objects that meet, most contacts first",
     .of = pair_row},
    {0}};
static const struct mcp_field first_tells[] = {
    {"step", MCP_WHOLE, .meaning = "The first step in which something meets, from 1",
     .is_needed = true},
    {"t", MCP_REAL, .meaning = "When, 0 to 1 of that step"},
    {"from", MCP_TEXT, .meaning = "Where its first frame is from", .is_needed = true},
    {"to", MCP_TEXT, .meaning = "Where its last frame is from", .is_needed = true},
    {0}};
static const struct mcp_field check_tells[] = {
    {"verdict", MCP_WORD,
     .meaning =
         "free: nothing meets; meets; crossed: nothing more meets, but a step "
         "begins "
         "with crossings or inside; incomplete: nothing was found in what was looked at",
     .is_needed = true, .words = "free|meets|crossed|incomplete"},
    {"steps", MCP_WHOLE, .meaning = "How many were looked at", .is_needed = true},
    {"contacts", MCP_WHOLE, .meaning = "Of all steps", .is_needed = true},
    {"safe_step", MCP_REAL, .meaning = "The least of all steps: 1, nothing meets in any",
     .is_needed = true},
    {"crossings", MCP_WHOLE, .meaning = "Of all beginnings of steps", .is_needed = true},
    {"inside", MCP_WHOLE, .meaning = "Vertices that begin inside of something",
     .is_needed = true},
    {"first", MCP_OBJECT, .meaning = "The first that meets", .of = first_tells},
    {"units", MCP_TEXT, .meaning = "What numbers count"},
    ROWS_TELLS(check_row, "Steps that are not free"),
    {"certificate", MCP_TEXT, .meaning = "The certificate that was written"},
    {"standing", MCP_WHOLE,
     .meaning =
         "With output: crossings of the first frame, which are there from the start"},
    {"new", MCP_WHOLE, .meaning = "With output: crossings of later frames that are new"},
    {"contacts_handle", MCP_TEXT, .meaning = "Of all contacts, for more and explain"},
    COMMON_TELLS,
    {0}};

static json_t *check_row_of(const json_t *step, size_t number, bool *ok)
{
    json_t *row = json_object();
    const json_t *objects = json_object_get(step, "objects");
    json_set(row, "step", json_integer((json_int_t)number), ok);
    copy_member(row, NULL, step, "contacts", ok);
    copy_member(row, "t", step, "toi_first", ok);
    copy_member(row, NULL, step, "safe_step", ok);
    if (whole_at(step, "crossings") > 0) {
        copy_member(row, NULL, step, "crossings", ok);
    }
    if (whole_at(step, "start_inside") > 0) {
        copy_member(row, "inside", step, "start_inside", ok);
    }
    json_t *pairs = json_array();
    for (size_t i = 0; i < json_array_size(objects) && i < PAIRS_SHOWN; i++) {
        json_append(pairs, json_incref(json_array_get(objects, i)), ok);
    }
    if (json_array_size(pairs) > 0) {
        json_set(row, "pairs", pairs, ok);
    } else {
        json_decref(pairs);
    }
    return row;
}

/* Judge the steps of a report: rows of those that are not free. */
static json_t *judge_steps(json_t *answer, const json_t *steps, bool *ok)
{
    json_t *rows = json_array(), *first = NULL;
    int64_t crossings = 0, inside = 0, contacts = 0;
    double safe = 1;
    bool is_whole = true;
    for (size_t i = 0; i < json_array_size(steps); i++) {
        const json_t *step = json_array_get(steps, i);
        bool begins_free =
            whole_at(step, "crossings") + whole_at(step, "start_inside") == 0;
        /* What begins crossed answers yes by that alone. */
        bool meets = whole_at(step, "contacts") > 0 ||
                     strcmp(text_at(step, "verdict"), "possible") == 0 ||
                     (strcmp(text_at(step, "verdict"), "yes") == 0 && begins_free);
        double own = json_number_value(json_object_get(step, "safe_step"));
        contacts += whole_at(step, "contacts");
        crossings += whole_at(step, "crossings");
        inside += whole_at(step, "start_inside");
        safe = own < safe ? own : safe;
        is_whole = is_whole && json_is_true(json_object_get(step, "complete"));
        if (meets && first == NULL) {
            first = json_object();
            json_set(first, "step", json_integer((json_int_t)i + 1), ok);
            copy_member(first, "t", step, "toi_first", ok);
            copy_member(first, NULL, step, "from", ok);
            copy_member(first, NULL, step, "to", ok);
        }
        if (meets || !begins_free) {
            json_append(rows, check_row_of(step, i + 1, ok), ok);
        }
    }
    json_set(answer, "verdict",
             json_string(first != NULL                 ? "meets"
                         : crossings > 0 || inside > 0 ? "crossed"
                         : !is_whole                   ? "incomplete"
                                                       : "free"),
             ok);
    json_set_count(answer, "steps", json_array_size(steps), ok);
    json_set(answer, "contacts", json_integer(contacts), ok);
    json_set(answer, "safe_step", json_real(safe), ok);
    json_set(answer, "crossings", json_integer(crossings), ok);
    json_set(answer, "inside", json_integer(inside), ok);
    if (first != NULL) {
        json_set(answer, "first", first, ok);
    }
    return rows;
}

/* Check again, by lines that are a certificate; tell what they say at the end. */
static int write_certificate(struct mcp *mcp, const json_t *asked, json_t *answer,
                             struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    struct whole_file file = {.to = NULL};
    const char *name = tool_from_folder(text_at(asked, "output"));
    bool ok = true;
    begin(&job, ctl_cmd_check, "pccdctl check");
    mcp_job_add(&job, "--results=-");
    mcp_job_add_fields(&job, check_takes, asked);
    int status = run_plain(mcp, &job, CTL_NEGATIVE, "no certificate: ", error);
    if (status == PCCD_OK) {
        status = output_open(&file, name, false, error);
    }
    if (status == PCCD_OK) {
        (void)fwrite(job.out, 1, job.out_bytes, file.to);
        status = output_close(&file, name, true, error);
    }
    if (status == PCCD_OK && job.out_bytes > 0) {
        job.out[job.out_bytes - 1] = '\0'; /* the last line is the verdict */
        const char *last = strrchr(job.out, '\n');
        json_t *verdict = json_loads(last != NULL ? last : job.out, 0, NULL);
        json_set(answer, "certificate", json_text(name), &ok);
        copy_member(answer, NULL, verdict, "standing", &ok);
        copy_member(answer, NULL, verdict, "new", &ok);
        json_decref(verdict);
    }
    mcp_job_deinit(&job);
    return status;
}

static json_t *answer_check(struct mcp *mcp, const struct mcp_tool *tool,
                            const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.has_records = strcmp(text_at(asked, "mode"), "any") != 0};
    json_t *answer = NULL;
    bool ok = true;
    const char *output = text_at(asked, "output");
    if (output[0] != '\0' &&
        check_output(mcp, tool_from_folder(output), ".jsonl", error) != PCCD_OK) {
        return NULL;
    }
    begin_asking(&job, mcp, ctl_cmd_check, "pccdctl check");
    mcp_job_add(&job, "--repeat=0");
    if (job.has_records) {
        mcp_job_add(&job, "--contacts=%s", MCP_RECORDS_PATH);
        mcp_job_add(&job, "--geometry");
    }
    mcp_job_add_fields(&job, check_takes, asked);
    json_t *report = run(mcp, &job, CTL_FAILED, error);
    if (report != NULL) {
        const json_t *steps = json_object_get(report, "steps");
        json_t *list = json_is_array(steps) ? json_incref((json_t *)steps)
                                            : json_pack("[O]", report);
        answer = json_object();
        json_t *rows = judge_steps(answer, list, &ok);
        json_set(answer, "units", json_string(UNITS), &ok);
        const struct mcp_table *table =
            mcp_keep(mcp, "steps",
                     (struct mcp_table){.tool = tool,
                                        .asked = asked,
                                        .rows = rows,
                                        .count = json_array_size(rows)});
        mcp_show_rows(answer, table, 0, &ok);
        if (job.row_count > 0) {
            const struct mcp_table *contacts =
                mcp_keep(mcp, "contacts",
                         (struct mcp_table){.tool = tool,
                                            .asked = asked,
                                            .rows = json_incref(job.rows),
                                            .count = job.row_count,
                                            .show = show_contact});
            json_set(answer, "contacts_handle", json_string(contacts->handle), &ok);
            json_set(answer, "next",
                     format_text("explain {handle: \"%s\", row: 0}", contacts->handle),
                     &ok);
        }
        set_warnings(answer, report, &job, &ok);
        json_decref(list);
        json_decref(report);
        if (output[0] != '\0' &&
            write_certificate(mcp, asked, answer, error) != PCCD_OK) {
            json_decref(answer);
            answer = NULL;
        }
    }
    mcp_job_deinit(&job);
    return answer;
}

/* ---- near and crossings ------------------------------------------------------------ */

static const struct mcp_field near_takes[] = {
    {"files", MCP_FILES,
     .meaning = "Mesh files, each an object where its first frame has it, or one scene "
                "file (.json)",
     .is_needed = true, .option = ""},
    FRAMES_TAKES,
    {"between", MCP_TEXTS, .meaning = "As of check", .option = "--between"},
    {"self_pairs", MCP_TRUTH,
     .meaning = "true: of several files also each one's own pairs; false: none",
     .option = "--self|--no-self"},
    THICK_TAKES,
    {"what", MCP_WORD,
     .meaning = "nearest pair of each two objects (default); pairs within the distance; "
                "features: of these the closest, each once; vertices with their bounds; "
                "depth of vertices inside of closed meshes",
     .words = "nearest|pairs|features|vertices|depth"},
    {"distance", MCP_REAL, .meaning = "How near; needed for pairs, features and vertices",
     .min = 0, .max = LENGTH_MAX, .option = "--distance"},
    {0}};
static const struct mcp_field near_tells[] = {
    {"what", MCP_TEXT, .meaning = "What was asked", .is_needed = true},
    {"found", MCP_WHOLE, .meaning = "Records in all", .is_needed = true},
    {"distance_min", MCP_REAL,
     .meaning = "The least of all records; 0 where things cross"},
    {"distance_max", MCP_REAL, .meaning = "The greatest; of depth, how deep"},
    {"crossings", MCP_WHOLE,
     .meaning = "Edges that pass through faces; not told of nearest"},
    {"complete", MCP_TRUTH, .meaning = "false: there may be more", .is_needed = true},
    {"units", MCP_TEXT, .meaning = "What numbers count"},
    ROWS_TELLS(near_row, "Records"),
    COMMON_TELLS,
    {0}};
static const struct mcp_field crossings_takes[] = {
    {"files", MCP_FILES,
     .meaning = "Mesh files, each an object where its first frame has it, or one scene "
                "file (.json)",
     .is_needed = true, .option = ""},
    FRAMES_TAKES,
    PAIRS_TAKES,
    {0}};
static const struct mcp_field crossings_tells[] = {
    {"verdict", MCP_WORD,
     .meaning =
         "yes: something touches or passes through something; no: nothing does, but "
         "it may be inside (near, what: depth); unknown: not all was looked at",
     .is_needed = true, .words = "yes|no|unknown"},
    {"found", MCP_WHOLE,
     .meaning = "Crossings: an edge (a) that passes through a face (b)",
     .is_needed = true},
    {"complete", MCP_TRUTH, .meaning = "false: there may be more", .is_needed = true},
    {"units", MCP_TEXT, .meaning = "What numbers count"},
    ROWS_TELLS(near_row, "Crossings: edge a, face b"),
    COMMON_TELLS,
    {0}};

/* Names of the objects of a report, from the first. */
static json_t *names_of(const json_t *report, bool *ok)
{
    json_t *names = json_array();
    const json_t *objects = json_object_get(report, "objects");
    for (size_t i = 0; i < json_array_size(objects); i++) {
        const json_t *object = json_array_get(objects, i);
        const char *name = text_at(object, "name");
        json_append(names, json_string(name[0] != '\0' ? name : text_at(object, "file")),
                    ok);
    }
    return names;
}

/* Run near, and keep its records; answer: what is told beside them. */
static json_t *ask_near(struct mcp *mcp, const struct mcp_tool *tool, const json_t *asked,
                        const char *what, struct ctl_error *error)
{
    struct mcp_job job = {.has_records = true};
    bool is_crossings = strcmp(what, "crossings") == 0, ok = true;
    json_t *answer = NULL;
    begin_asking(&job, mcp, ctl_cmd_near, "pccdctl near");
    mcp_job_add(&job, "--repeat=0");
    mcp_job_add(&job, "--what=%s", what);
    mcp_job_add(&job, "--csv=%s", MCP_RECORDS_PATH);
    mcp_job_add_fields(&job, tool->takes, asked);
    json_t *report = run(mcp, &job, CTL_DONE, error);
    if (report != NULL) {
        answer = json_object();
        if (is_crossings) {
            const char *verdict = text_at(report, "verdict");
            json_set(answer, "verdict",
                     json_string(strcmp(verdict, "none") == 0 ? "no" : verdict), &ok);
        } else {
            copy_member(answer, NULL, report, "what", &ok);
            copy_member(answer, NULL, report, "distance_min", &ok);
            copy_member(answer, NULL, report, "distance_max", &ok);
            copy_member(answer, NULL, report, "crossings", &ok);
        }
        copy_member(answer, "found", report, "total", &ok);
        copy_member(answer, NULL, report, "complete", &ok);
        json_set(answer, "units", json_string(UNITS), &ok);
        struct mcp_table *table =
            mcp_keep(mcp, is_crossings ? "crossings" : "near",
                     (struct mcp_table){.tool = tool,
                                        .asked = asked,
                                        .rows = json_incref(job.rows),
                                        .count = job.row_count,
                                        .show = show_near,
                                        .names = names_of(report, &ok)});
        mcp_show_rows(answer, table, 0, &ok);
        set_warnings(answer, report, &job, &ok);
        if (job.row_count > 0) {
            json_set(answer, "next",
                     format_text("explain {handle: \"%s\", row: 0}", table->handle), &ok);
        }
        json_decref(report);
    }
    mcp_job_deinit(&job);
    return answer;
}

static json_t *answer_near(struct mcp *mcp, const struct mcp_tool *tool,
                           const json_t *asked, struct ctl_error *error)
{
    const char *what = text_at(asked, "what");
    return ask_near(mcp, tool, asked, what[0] != '\0' ? what : "nearest", error);
}

static json_t *answer_crossings(struct mcp *mcp, const struct mcp_tool *tool,
                                const json_t *asked, struct ctl_error *error)
{
    return ask_near(mcp, tool, asked, "crossings", error);
}

/* ---- sweep ------------------------------------------------------------------------- */

static const struct mcp_field sweep_takes[] = {
    {"file", MCP_FILE, .meaning = "A robot (.urdf), or a scene file with joints (.json)",
     .is_needed = true, .option = ""},
    {"joints", MCP_TEXTS,
     .meaning = "\"NAME=LO:HI\", or \"NAME\" over its limits; up to three, which move at "
                "once, in every combination of their values (default: each joint by "
                "itself). Values are in radians, degrees (\"elbow=-90deg:90deg\") or the "
                "file's unit",
     .option = "--joint"},
    {"fix", MCP_TEXTS, .meaning = "\"NAME=VALUE\": hold a joint that is not swept there",
     .option = "--fix"},
    {"clearance", MCP_TEXTS,
     .meaning = "\"D\": parts may not come nearer than that (default: 0); \"A,B=D\": "
                "these two, in the place of that; at 0 they may be as near as they like, "
                "as a pin in its hole",
     .option = "--clearance"},
    {"allow", MCP_TEXTS, .meaning = "\"A,B\": these two parts may meet",
     .option = "--allow"},
    {"between", MCP_TEXTS,
     .meaning = "Of a scene file, \"A,B\": compare these two parts alone",
     .option = "--between"},
    {"with", MCP_FILES, .meaning = "Further meshes, which stand", .option = "--with"},
    {"srdf", MCP_FILE, .meaning = "Of a robot: leave out the pairs that it disables",
     .option = "--srdf"},
    {"state", MCP_TEXT, .meaning = "Hold joints where this group_state of the SRDF does",
     .option = "--state"},
    {"meshes", MCP_FILES, .meaning = "Of a robot: folders to look for its meshes",
     .option = "--meshes"},
    {"bracket", MCP_REAL,
     .meaning = "Find a jam to within so much, in radians or the file's unit (default: "
                "1e-6)",
     .min = 1e-15, .max = 1, .option = "--bracket"},
    {"least", MCP_REAL,
     .meaning = "Find the least distance of what is free, too, to this part of its size, "
                "as 0.001 (default: 0, do not)",
     .min = 0, .max = 1, .option = "--least"},
    {"motions", MCP_WHOLE,
     .meaning = "Of several joints at once: decide by so many motions (default: 4096)",
     .min = 1, .max = 1e9, .option = "--motions"},
    {0}};
/* Two parts, and values of the joints of the row. */
#define PARTS_TELLS                                                                      \
    {"a", MCP_TEXT, .meaning = "A part", .is_needed = true},                             \
        {"b", MCP_TEXT, .meaning = "The other one", .is_needed = true},                  \
    {                                                                                    \
        "value", MCP_REALS, .meaning = "Of each of the joints, there", .is_needed = true \
    }
#define JAM_TELLS                                                                        \
    PARTS_TELLS,                                                                         \
        {"bracket", MCP_TEXT,                                                            \
         .meaning = "Values of the first joint between which they come to meet",         \
         .is_needed = true},                                                             \
        {"within_bracket", MCP_TRUTH,                                                    \
         .meaning = "false: these are farther apart than was asked for",                 \
         .is_needed = true},                                                             \
    {                                                                                    \
        "initial", MCP_TRUTH,                                                            \
            .meaning = "true: they meet already where the motion begins",                \
            .is_needed = true                                                            \
    }
static const struct mcp_field jam_tells[] = {
    JAM_TELLS,
    {"from", MCP_WORD, .meaning = "Of one joint: the end of the range that it comes from",
     .words = "begin|end"},
    {0}};
static const struct mcp_field first_jam_tells[] = {
    {"joints", MCP_TEXTS, .meaning = "Which joints move", .is_needed = true},
    JAM_TELLS,
    {0}};
static const struct mcp_field nearest_tells[] = {PARTS_TELLS, {0}};
static const struct mcp_field gap_tells[] = {
    {"low", MCP_REALS, .meaning = "Least value of each joint", .is_needed = true},
    {"high", MCP_REALS, .meaning = "Greatest value", .is_needed = true},
    {0}};
#define SWEEP_VERDICT                                                                    \
    {                                                                                    \
        "verdict", MCP_WORD,                                                             \
            .meaning = "free: no two parts meet at any value, proved; jams; undecided: " \
                       "nothing is proved to meet, but not all is proved free",          \
            .is_needed = true, .words = "free|jams|undecided"                            \
    }
static const struct mcp_field sweep_row[] = {
    {"joints", MCP_TEXTS, .meaning = "Which joints move", .is_needed = true},
    {"low", MCP_REALS, .meaning = "Where the range of each begins", .is_needed = true},
    {"high", MCP_REALS, .meaning = "Where it ends", .is_needed = true},
    SWEEP_VERDICT,
    {"beyond_limits", MCP_TEXTS, .meaning = "Joints that go beyond their limits"},
    {"initial_pairs", MCP_TEXTS,
     .meaning = "\"A,B\": all parts that meet where the range begins"},
    {"jams", MCP_ROWS,
     .meaning = "Of one joint the first jam from each end; of several the one found",
     .of = jam_tells},
    {"undecided", MCP_REAL, .meaning = "The part of the range that is, 0 to 1"},
    {"gap", MCP_OBJECT, .meaning = "Where, the first of several", .of = gap_tells},
    {"least_distance", MCP_REALS, .meaning = "Two numbers between which it is"},
    {"least_above_clearance", MCP_REALS,
     .meaning = "The same above what two parts keep, where they have a clearance"},
    {"nearest", MCP_OBJECT, .meaning = "Where that is", .of = nearest_tells},
    {0}};
static const struct mcp_field sweep_tells[] = {
    SWEEP_VERDICT,
    {"first", MCP_OBJECT, .meaning = "The first jam of the first range that has one",
     .of = first_jam_tells},
    {"looked_within", MCP_TRUTH,
     .meaning = "false: not all shapes are closed meshes, so that a part that begins "
                "wholly within another one is not seen",
     .is_needed = true},
    {"without_collision", MCP_TEXTS,
     .meaning = "Links that have a <visual> alone: they are not compared"},
    {"units", MCP_TEXT, .meaning = "What numbers count"},
    ROWS_TELLS(sweep_row, "Ranges that were swept"),
    COMMON_TELLS,
    {0}};

/* Set one end of the intervals that joints have by name: 0, the low one. */
static void set_ends(json_t *to, const char *as, json_t *intervals, size_t end, bool *ok)
{
    json_t *list = json_array(), *interval;
    const char *joint;
    json_object_foreach(intervals, joint, interval)
    {
        json_append(list, json_incref(json_array_get(interval, end)), ok);
    }
    json_set(to, as, list, ok);
}

static json_t *joints_of(json_t *intervals, bool *ok)
{
    json_t *list = json_array(), *interval;
    const char *joint;
    json_object_foreach(intervals, joint, interval)
    {
        json_append(list, json_text(joint), ok);
    }
    return list;
}

/* Tell of a jam; of the least distance (`is_jam` false) where it is. */
static json_t *jam_of(const json_t *jam, bool is_jam, bool *ok)
{
    json_t *told = json_object(), *at = json_object_get(jam, "at");
    const json_t *parts = json_object_get(jam, "parts");
    const json_t *first = json_object_iter_value(json_object_iter(at));
    /* They meet at the far end of the interval, as the motion goes. */
    bool goes_up = strcmp(text_at(jam, "from"), "end") != 0;
    json_set(told, "a", json_incref(json_array_get(parts, 0)), ok);
    json_set(told, "b", json_incref(json_array_get(parts, 1)), ok);
    set_ends(told, "value", at, goes_up ? 1 : 0, ok);
    if (is_jam) {
        json_set(told, "bracket",
                 format_text("%.17g to %.17g",
                             json_number_value(json_array_get(first, goes_up ? 0 : 1)),
                             json_number_value(json_array_get(first, goes_up ? 1 : 0))),
                 ok);
        copy_member(told, NULL, jam, "within_bracket", ok);
        copy_member(told, NULL, jam, "initial", ok);
        copy_member(told, NULL, jam, "from", ok);
    }
    return told;
}

static json_t *sweep_row_of(const json_t *range, bool *ok)
{
    json_t *row = json_object(), *swept = json_object_get(range, "range");
    const json_t *jams = json_object_get(range, "jams");
    json_t *first_gap = json_array_get(json_object_get(range, "undecided_boxes"), 0);
    const json_t *nearest = json_object_get(range, "nearest");
    json_set(row, "joints", joints_of(swept, ok), ok);
    set_ends(row, "low", swept, 0, ok);
    set_ends(row, "high", swept, 1, ok);
    copy_member(row, NULL, range, "verdict", ok);
    copy_member(row, NULL, range, "beyond_limits", ok);
    copy_member(row, NULL, range, "initial_pairs", ok);
    if (json_array_size(jams) > 0) {
        json_t *list = json_array();
        for (size_t i = 0; i < json_array_size(jams); i++) {
            json_append(list, jam_of(json_array_get(jams, i), true, ok), ok);
        }
        json_set(row, "jams", list, ok);
    }
    if (json_is_object(first_gap)) {
        json_t *gap = json_object();
        set_ends(gap, "low", first_gap, 0, ok);
        set_ends(gap, "high", first_gap, 1, ok);
        copy_member(row, NULL, range, "undecided", ok);
        json_set(row, "gap", gap, ok);
    }
    copy_member(row, NULL, range, "least_distance", ok);
    copy_member(row, NULL, range, "least_above_clearance", ok);
    if (json_is_object(nearest)) {
        json_set(row, "nearest", jam_of(nearest, false, ok), ok);
    }
    return row;
}

/* Tell of the first row that jams, and what to ask if its parts meet from the start. */
static void set_first_jam(json_t *answer, const json_t *rows, bool *ok)
{
    const json_t *row = NULL, *jam = NULL;
    for (size_t i = 0; i < json_array_size(rows) && jam == NULL; i++) {
        row = json_array_get(rows, i);
        jam = json_array_get(json_object_get(row, "jams"), 0);
    }
    if (jam == NULL) {
        return;
    }
    json_t *first = json_deep_copy(jam);
    (void)json_object_del(first, "from");
    json_set(first, "joints", json_deep_copy(json_object_get(row, "joints")), ok);
    json_set(answer, "first", first, ok);
    if (json_is_true(json_object_get(jam, "initial"))) {
        json_set(answer, "next",
                 json_string("if initial_pairs touch by design: the same with them in "
                             "allow"),
                 ok);
    }
}

static json_t *answer_sweep(struct mcp *mcp, const struct mcp_tool *tool,
                            const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    json_t *answer = NULL;
    begin_asking(&job, mcp, ctl_cmd_sweep, "pccdctl sweep");
    mcp_job_add(&job, "--least=0"); /* unless the fields say more */
    mcp_job_add_fields(&job, tool->takes, asked);
    json_t *report = run(mcp, &job, CTL_UNDECIDED, error);
    if (report != NULL) {
        const json_t *ranges = json_object_get(report, "ranges");
        json_t *rows = json_array();
        bool ok = true;
        for (size_t i = 0; i < json_array_size(ranges); i++) {
            json_append(rows, sweep_row_of(json_array_get(ranges, i), &ok), &ok);
        }
        answer = json_object();
        copy_member(answer, NULL, report, "verdict", &ok);
        copy_member(answer, NULL, report, "looked_within", &ok);
        copy_member(answer, NULL, report, "without_collision", &ok);
        set_first_jam(answer, rows, &ok);
        json_set(answer, "units",
                 json_string("angles in radians, lengths in the file's unit"), &ok);
        const struct mcp_table *table =
            mcp_keep(mcp, "ranges",
                     (struct mcp_table){.tool = tool,
                                        .asked = asked,
                                        .rows = rows,
                                        .count = json_array_size(rows)});
        mcp_show_rows(answer, table, 0, &ok);
        set_warnings(answer, report, &job, &ok);
        json_decref(report);
    }
    mcp_job_deinit(&job);
    return answer;
}

/* ---- explain ----------------------------------------------------------------------- */

static const struct mcp_field explain_takes[] = {
    {"handle", MCP_TEXT,
     .meaning = "contacts_handle of check, or handle of near or crossings",
     .is_needed = true},
    {"row", MCP_WHOLE, .meaning = "Number of the record, from 0", .is_needed = true,
     .min = 0, .max = 1e9},
    {"picture", MCP_TRUTH,
     .meaning = "true: draw a contact close, as a resource of this server"},
    {"output", MCP_FILE, .meaning = "Write the picture there, FILE.png"},
    {0}};
static const struct mcp_field side_tells[] = {
    {"object", MCP_TEXT, .meaning = "Name of the object", .is_needed = true},
    {"vertices", MCP_REALS,
     .meaning = "Vertices of the feature, as the file numbers them from 0",
     .is_needed = true},
    {"start", MCP_POINTS, .meaning = "Where they are at the begin of the step",
     .is_needed = true},
    {"end", MCP_POINTS,
     .meaning = "Where they are at its end; not told where nothing moves"},
    {0}};
static const struct mcp_field explain_tells[] = {
    {"kind", MCP_TEXT,
     .meaning = "Which features: vertex-face, edge-edge, edge-face, ...",
     .is_needed = true},
    {"step", MCP_WHOLE, .meaning = "The step, from 1; none where nothing moves"},
    {"from", MCP_TEXT, .meaning = "Where the first frame of the step is from",
     .is_needed = true},
    {"to", MCP_TEXT, .meaning = "Where its last frame is from"},
    {"t", MCP_REAL, .meaning = "When they meet, 0 to 1 of the step"},
    {"t_bracket", MCP_TEXT, .meaning = "The interval in which they meet, exactly"},
    {"proved", MCP_TRUTH,
     .meaning = "Whether exact arithmetic has proved that they meet"},
    {"distance", MCP_REAL, .meaning = "How far apart they are where nothing moves"},
    {"point", MCP_REALS, .meaning = "Where they meet"},
    {"normal", MCP_REALS, .meaning = "Of length 1, from b to a where they meet"},
    {"a", MCP_OBJECT, .meaning = "A feature", .is_needed = true, .of = side_tells},
    {"b", MCP_OBJECT, .meaning = "The other one", .is_needed = true, .of = side_tells},
    {"picture", MCP_TEXT, .meaning = "URI of the picture, for resources/read"},
    {"written", MCP_TEXT, .meaning = "The picture that was written"},
    {"units", MCP_TEXT, .meaning = "What numbers count"},
    COMMON_TELLS,
    {0}};

static void add_side(struct mcp_job *job, const json_t *row, int side, bool *ok)
{
    json_t *feature = json_pack("{s:O?, s:o}", "object", object_of(row, side), "vertices",
                                vertices_of(row, side, ok));
    char *text = mcp_dump(feature);
    mcp_job_add(job, "--%c=%s", side == 0 ? 'a' : 'b', text != NULL ? text : "");
    free(text);
    json_decref(feature);
}

/* Where the features of a record are. */
static json_t *look_at_place(struct mcp *mcp, const struct mcp_table *table,
                             const json_t *row, int64_t step, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    bool ok = true;
    begin(&job, mcp_look_place, "pccdctl mcp");
    if (step == 0) {
        mcp_job_add(&job, "--each");
    }
    mcp_job_add(&job, "--step=%" PRId64, step);
    add_side(&job, row, 0, &ok);
    add_side(&job, row, 1, &ok);
    mcp_job_add_fields(&job, place_takes, table->asked);
    json_t *place = ok ? run(mcp, &job, 0, error) : NULL;
    mcp_job_deinit(&job);
    return place;
}

/* Return which contact of its step a row is, from 1. */
static uint64_t number_in_step(const struct mcp_table *table, size_t at, int64_t step)
{
    uint64_t number = 1;
    for (size_t i = 0; i < at; i++) {
        number += whole_at(json_array_get(table->rows, i), "step") == step;
    }
    return number;
}

/* Why a contact of this question cannot be drawn: render does not ask it; or NULL. */
static const char *not_drawn(const json_t *asked)
{
    static const char *const unknown[] = {"thickness",  "rest_exclusion", "rings",
                                          "separation", "approach",       "mode"};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        if (json_object_get(asked, unknown[i]) != NULL &&
            strcmp(text_at(asked, unknown[i]), "all") != 0) {
            return unknown[i];
        }
    }
    return NULL;
}

/* Draw contact `number` of a step; set its picture in `answer`, unless that names a file
 * to write. */
static int draw(struct mcp *mcp, const struct mcp_table *table, int64_t step,
                uint64_t number, json_t *answer, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    const char *output = text_at(answer, "written");
    const char *unknown = not_drawn(table->asked);
    bool ok = true;
    if (unknown != NULL || table->show != show_contact) {
        return ctl_error_set(
            error, PCCD_E_INVAL,
            "\"picture\": what was asked with %s is not drawn; a contact "
            "of check without it is, also of a scene file that says it",
            unknown != NULL ? unknown : "near or crossings");
    }
    if (output[0] != '\0' && check_output(mcp, output, ".png", error) != PCCD_OK) {
        return PCCD_E_INVAL;
    }
    begin_asking(&job, mcp, ctl_cmd_render, "pccdctl render");
    mcp_job_add(&job, "--output=%s", output[0] != '\0' ? output : "-");
    mcp_job_add(&job, "--size=640x480");
    mcp_job_add(&job, "--steps=%" PRId64, step);
    mcp_job_add(&job, "--at=contact %" PRIu64, number);
    mcp_job_add_fields(&job, picture_takes, table->asked);
    int status = run_plain(mcp, &job, 0, "no picture: ", error);
    if (status == PCCD_OK && output[0] == '\0') {
        const char *uri = mcp_keep_picture(mcp, job.out, job.out_bytes);
        job.out = NULL;
        json_set(answer, "picture", json_string(uri), &ok);
        status =
            ok ? PCCD_OK : ctl_error_set(error, PCCD_E_NOMEM, "no picture was drawn");
    }
    mcp_job_deinit(&job);
    return status;
}

/* A side of the record as it is told. */
static void set_side(json_t *answer, const json_t *place, const json_t *row, int side,
                     bool has_step, bool *ok)
{
    const char *key = side == 0 ? "a" : "b";
    json_t *feature = json_deep_copy(json_object_get(place, key));
    json_set(feature, "vertices", vertices_of(row, side, ok), ok);
    if (!has_step) {
        (void)json_object_del(feature, "end");
    }
    json_set(answer, key, feature, ok);
}

static json_t *tell_record(const json_t *row, const json_t *place, int64_t step, bool *ok)
{
    json_t *answer = json_object();
    uint32_t first = 0, points[2] = {0, 0};
    (void)points_of(row, 0, &first, &points[0]);
    (void)points_of(row, 1, &first, &points[1]);
    json_set(answer, "kind",
             format_text("%s-%s", common_feature_names[points[0]],
                         common_feature_names[points[1]]),
             ok);
    if (step > 0) {
        json_set(answer, "step", json_integer(step), ok);
        copy_member(answer, NULL, place, "to", ok);
    }
    copy_member(answer, NULL, place, "from", ok);
    copy_member(answer, "t", row, "toi", ok);
    if (json_object_get(row, "toi") != NULL) {
        json_set(answer, "t_bracket",
                 format_text("%.17g to %.17g",
                             json_number_value(json_object_get(row, "toi")),
                             json_number_value(json_object_get(row, "toi_hi"))),
                 ok);
        json_set(answer, "proved", json_boolean(whole_at(row, "proved") != 0), ok);
    }
    copy_member(answer, "distance", row, "d_lo", ok);
    set_point(answer, "point", row, 'a', ok);
    set_point(answer, "normal", row, 'n', ok);
    set_side(answer, place, row, 0, step > 0, ok);
    set_side(answer, place, row, 1, step > 0, ok);
    json_set(answer, "units", json_string(UNITS), ok);
    return answer;
}

static json_t *answer_explain(struct mcp *mcp, const struct mcp_tool *tool,
                              const json_t *asked, struct ctl_error *error)
{
    struct mcp_table *table;
    size_t at = (size_t)whole_at(asked, "row");
    bool draws = json_is_true(json_object_get(asked, "picture")) ||
                 json_object_get(asked, "output") != NULL;
    (void)tool;
    if (mcp_find(mcp, text_at(asked, "handle"), &table, error) != PCCD_OK) {
        return NULL;
    }
    const json_t *row = json_array_get(table->rows, at);
    if (row == NULL || json_object_get(row, "kind") == NULL) {
        (void)ctl_error_set(error, PCCD_E_INVAL,
                            row == NULL ? "\"row\": %s has rows 0 to %zu"
                                        : "\"handle\": %s has no records of two features "
                                          "(of its %zu rows); contacts_handle has",
                            table->handle, json_array_size(table->rows) - (row == NULL));
        return NULL;
    }
    bool has_step = table->show == show_contact;
    bool is_told = json_object_get(row, "step") != NULL;
    int64_t step = !has_step ? 0 : is_told ? whole_at(row, "step") : 1;
    json_t *place = look_at_place(mcp, table, row, step, error), *answer = NULL;
    if (place != NULL) {
        bool ok = true;
        answer = tell_record(row, place, step, &ok);
        if (json_object_get(asked, "output") != NULL) {
            json_set(answer, "written",
                     json_text(tool_from_folder(text_at(asked, "output"))), &ok);
        }
        if (draws && draw(mcp, table, step, number_in_step(table, at, step), answer,
                          error) != PCCD_OK) {
            json_decref(answer);
            answer = NULL;
        } else if (!draws && has_step && not_drawn(table->asked) == NULL) {
            json_set(answer, "next", json_string("the same with picture: true"), &ok);
        }
        json_decref(place);
    }
    return answer;
}

/* ---- record and verify ------------------------------------------------------------- */

static const struct mcp_field record_takes[] = {
    {"files", MCP_FILES, .meaning = "As check takes them", .is_needed = true,
     .option = ""},
    FRAMES_TAKES,
    {"between", MCP_TEXTS, .meaning = "As of check", .option = "--between"},
    {"self_pairs", MCP_TRUTH, .meaning = "As of check", .option = "|--no-self"},
    {"output", MCP_FILE, .meaning = "Where the recording goes, FILE.rec",
     .is_needed = true, .option = "--output"},
    {0}};
static const struct mcp_field record_tells[] = {
    {"file", MCP_TEXT, .meaning = "The recording", .is_needed = true},
    {"bytes", MCP_WHOLE, .meaning = "Its size", .is_needed = true},
    {"steps", MCP_WHOLE, .meaning = "How many steps are in it", .is_needed = true},
    COMMON_TELLS,
    {0}};

static json_t *answer_record(struct mcp *mcp, const struct mcp_tool *tool,
                             const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    const char *output = tool_from_folder(text_at(asked, "output"));
    bool ok = true;
    if (check_output(mcp, output, ".rec", error) != PCCD_OK) {
        return NULL;
    }
    begin(&job, mcp_look_record, "pccdctl mcp");
    mcp_job_add_fields(&job, tool->takes, asked);
    json_t *answer = run(mcp, &job, 0, error);
    if (answer != NULL) {
        set_warnings(answer, NULL, &job, &ok);
        json_set(answer, "next", format_text("verify {recording: \"%.200s\"}", output),
                 &ok);
    }
    mcp_job_deinit(&job);
    return answer;
}

static const struct mcp_field verify_takes[] = {
    {"recording", MCP_FILE, .meaning = "A recording of record, or a certificate of check",
     .is_needed = true, .option = ""},
    {"files", MCP_FILES, .meaning = "Of a certificate: the files that were checked",
     .option = ""},
    {"with", MCP_FILES, .meaning = "Of a certificate: the further files", .option = ""},
    {"steps", MCP_TEXT, .meaning = "A, A..B, A.. or ..B: these steps alone",
     .option = "--steps"},
    {"contacts", MCP_WHOLE,
     .meaning = "Check about so many contacts of each step (default: all)", .min = 1,
     .max = 1e15, .option = "--contacts"},
    {"sample", MCP_WHOLE,
     .meaning = "Pairs near each other, and no contacts, to check a step "
                "(default: 1000)",
     .min = 0, .max = 1e9, .option = "--sample"},
    {0}};
static const struct mcp_field verify_tells[] = {
    {"verdict", MCP_WORD,
     .meaning = "pass: every answer that was checked is right, every line of a "
                "certificate the same; fail",
     .is_needed = true, .words = "pass|fail"},
    {"steps", MCP_WHOLE, .meaning = "Steps that were checked"},
    {"contacts", MCP_WHOLE, .meaning = "Contacts that were checked"},
    {"non_contacts", MCP_WHOLE, .meaning = "Pairs that were checked not to meet"},
    {"unchecked", MCP_WHOLE, .meaning = "What could not be checked"},
    {"questions", MCP_WHOLE, .meaning = "Answers about what is near that were checked"},
    {"witness", MCP_TEXT, .meaning = "What is wrong"},
    COMMON_TELLS,
    {0}};

/* Do the check of a certificate again. It compares lines, and has no JSON. */
static json_t *verify_certificate(struct mcp *mcp, const struct mcp_tool *tool,
                                  const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    json_t *answer = NULL;
    begin(&job, ctl_cmd_verify, "pccdctl verify");
    mcp_job_add_fields(&job, tool->takes, asked);
    if (mcp_job_run(&job, mcp, error) == PCCD_OK) {
        bool is_right = job.status == CTL_DONE;
        const char *why = is_right ? NULL : mcp_job_complaint(&job);
        why = why != NULL ? why : job.out;
        if (job.status > CTL_NEGATIVE) {
            (void)ctl_error_set(error, PCCD_E_INVAL, "%.900s", why);
        } else if (is_right) {
            answer = json_pack("{s:s}", "verdict", "pass");
        } else {
            answer = json_pack("{s:s, s:o}", "verdict", "fail", "witness",
                               format_text("%.600s", why));
        }
    }
    mcp_job_deinit(&job);
    return answer;
}

static json_t *answer_verify(struct mcp *mcp, const struct mcp_tool *tool,
                             const json_t *asked, struct ctl_error *error)
{
    struct mcp_job job = {.word_count = 0};
    json_t *answer = NULL;
    bool ok = true;
    if (json_object_get(asked, "files") != NULL) {
        return verify_certificate(mcp, tool, asked, error);
    }
    begin_asking(&job, mcp, ctl_cmd_verify, "pccdctl verify");
    mcp_job_add_fields(&job, tool->takes, asked);
    json_t *report = run(mcp, &job, CTL_NEGATIVE, error);
    if (report != NULL) {
        bool is_right = json_is_true(json_object_get(report, "pass"));
        answer = json_object();
        json_set(answer, "verdict", json_string(is_right ? "pass" : "fail"), &ok);
        copy_member(answer, NULL, report, "steps", &ok);
        copy_member(answer, NULL, report, "contacts", &ok);
        copy_member(answer, NULL, report, "non_contacts", &ok);
        copy_member(answer, NULL, report, "unchecked", &ok);
        copy_member(answer, "questions", report, "nears", &ok);
        if (!is_right) {
            const char *why = mcp_job_complaint(&job);
            char *text = why != NULL ? NULL : mcp_dump(report);
            json_set(answer, "witness",
                     format_text("%.600s", why != NULL    ? why
                                           : text != NULL ? text
                                                          : ""),
                     &ok);
            free(text);
        }
        set_warnings(answer, NULL, &job, &ok);
        json_decref(report);
    }
    mcp_job_deinit(&job);
    return answer;
}

/* ---- more -------------------------------------------------------------------------- */

static const struct mcp_field more_takes[] = {
    {"handle", MCP_TEXT, .meaning = "handle or contacts_handle of an answer",
     .is_needed = true},
    {"offset", MCP_WHOLE, .meaning = "Number of the first row wanted, from 0 (default)",
     .min = 0, .max = 1e9},
    {0}};
static const struct mcp_field more_tells[] = {
    {"tool", MCP_TEXT, .meaning = "Whose rows these are", .is_needed = true},
    ROWS_TELLS(
        NULL, "As of that tool; contacts: step, features a and b with object and "
              "vertices, t when they meet, 0 to 1 of the step, proved (false: they may)"),
    {0}};

static json_t *answer_more(struct mcp *mcp, const struct mcp_tool *tool,
                           const json_t *asked, struct ctl_error *error)
{
    struct mcp_table *table;
    uint64_t offset = (uint64_t)whole_at(asked, "offset");
    bool ok = true;
    (void)tool;
    if (mcp_find(mcp, text_at(asked, "handle"), &table, error) != PCCD_OK) {
        return NULL;
    }
    if (offset > json_array_size(table->rows)) {
        (void)ctl_error_set(error, PCCD_E_INVAL, "\"offset\": %s has rows 0 to %zu",
                            table->handle, json_array_size(table->rows));
        return NULL;
    }
    json_t *answer = json_pack("{s:s}", "tool", table->tool->name);
    mcp_show_rows(answer, table, offset, &ok);
    return answer;
}

/* ---- the table --------------------------------------------------------------------- */

const struct mcp_tool mcp_tools[] = {
    {"scene", "What is there",
     "List the folder, or tell what mesh files hold: objects, frames, triangles, boxes. "
     "With output, write a scene file.",
     scene_takes, scene_tells, true, answer_scene},
    {"check", "Does anything meet, and when",
     "Find every contact of meshes in motion, at frames and between them, by exact "
     "arithmetic: vertices move on straight lines from each frame to the next. Verdict, "
     "first contact, steps that are not free.",
     check_takes, check_tells, true, answer_check},
    {"near", "How far apart",
     "Measure distances between meshes that stand: nearest pair of each two objects, all "
     "pairs within a distance, or depth inside.",
     near_takes, near_tells, false, answer_near},
    {"crossings", "Does anything pass through anything",
     "List edges that pass through faces where meshes stand, between objects and within "
     "each.",
     crossings_takes, crossings_tells, false, answer_crossings},
    {"sweep", "Does a mechanism jam",
     "Move the joints of a robot or machine over their ranges, on true arcs, and tell "
     "with "
     "proof whether two parts meet: verdict, first jam with its parts and joint value, "
     "in "
     "a bracket; least distance.",
     sweep_takes, sweep_tells, false, answer_sweep},
    {"explain", "One record in full",
     "Tell of one record which features meet, when and where, with their vertices at "
     "both "
     "ends of the step; draw it if wanted.",
     explain_takes, explain_tells, true, answer_explain},
    {"more", "Further rows of an answer",
     "Give the rows of an earlier answer from an offset on: steps, contacts, pairs, "
     "ranges, files.",
     more_takes, more_tells, false, answer_more},
    {"record", "Keep a computation",
     "Compute the steps of files and write all that was asked and answered to a "
     "recording, which verify, or pccdctl replay, render and inspect read.",
     record_takes, record_tells, true, answer_record},
    {"verify", "Prove a recording",
     "Check every answer of a recording by exact rational arithmetic that shares nothing "
     "with the engine; or, with files, do the check of a certificate again and compare "
     "every line.",
     verify_takes, verify_tells, false, answer_verify},
    {.takes = no_fields}};
