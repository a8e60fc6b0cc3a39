/* cmd_sweep.c - pccdctl sweep. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check_screw.h"
#include "columns.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "scene.h"
#include "shown.h"
#include "sweep.h"
#include "sweep_draw.h"

#define LENGTH_MAX   1e18
#define SIDES_MAX    4096u
#define MOTIONS_MAX  1000000000u
#define THREADS_MAX  1024u
#define LEAST_UNSAID (-1.0)

struct command {
    struct option_arguments files;
    struct ctl_link link;
    struct robot_options robot;
    struct option_arguments joints, fixed, apart, between, clearances;
    double clearance, bracket, least;
    uint32_t limit, threads;
    const char *edges;   /* NULL: ranges are swept */
    const char *picture; /* a file; NULL: none is drawn */
    bool is_json;
    /* Of `pccdctl check --motion screw`; NULL: a file has joints. */
    const struct check_screw *screw;
    const struct ask_options *ask;
    const struct scene_options *scene;
};

/* A distance, or "A,B=D": which of them names parts, the mechanism says. */
static void take_clearance(struct argp_state *state, const struct option_row *row,
                           const char *text, void *to)
{
    const char *equals = strrchr(text, '=');
    const char *number = equals != NULL ? equals + 1 : text;
    char *end;
    double value = strtod(number, &end);
    if (end == number || *end != '\0' || !(value >= 0 && value <= LENGTH_MAX)) {
        option_misused(state, "--%s: \"%s\" is no number from 0 to %g", row->name, number,
                       LENGTH_MAX);
    }
    if (equals != NULL) {
        scene_take_pair(state, row, text, to);
    } else {
        ((struct command *)to)->clearance = value;
    }
}

/* Return how long the name of "NAME" or "NAME=VALUES" is. */
static size_t name_bytes_of(const char *text)
{
    const char *equals = strrchr(text, '=');
    return equals != NULL ? (size_t)(equals - text) : strlen(text);
}

/* A joint of the command line, and the value or the range that it is given. */
struct named_joint {
    bool has_values, is_in_degrees;
    double values[2]; /* in radians, or the file's unit */
    uint32_t joint;
};

/* Read a number up to `end`, with "deg" behind it if it is an angle in degrees. Return
 * what is wrong with it; NULL: nothing. */
static const char *read_value(const char *text, const char *end, double *value,
                              bool *is_in_degrees)
{
    char *stop;
    *value = strtod(text, &stop);
    *is_in_degrees = end - stop == 3 && strncmp(stop, "deg", 3) == 0;
    return stop == text || stop > end       ? "is no number"
           : !isfinite(*value)              ? "is no finite number"
           : stop != end && !*is_in_degrees ? "has another unit behind it than deg"
                                            : NULL;
}

/* Read "NAME=VALUE", or with two values "NAME=LO:HI" or "NAME"; a unit behind the last
 * one is that of both. Return what is wrong, and of *whose; NULL: nothing. */
static const char *read_named(const char *text, uint32_t value_count,
                              struct named_joint *named, const char **whose)
{
    const char *equals = strrchr(text, '='), *end = text + strlen(text), *fault;
    const char *colon = equals != NULL && value_count == 2 ? strchr(equals, ':') : NULL;
    double *values = named->values;
    bool is_low_in_degrees = false, is_in_degrees = false;
    *whose = "";
    *named = (struct named_joint){.has_values = equals != NULL};
    if (value_count == 2 && colon == NULL) {
        return equals != NULL ? "not NAME=LO:HI" : NULL;
    }
    if (equals == NULL) {
        return "not NAME=VALUE";
    }
    if (value_count == 1) {
        *whose = "the value ";
        fault = read_value(equals + 1, end, values, &is_in_degrees);
    } else {
        *whose = "the low end ";
        fault = read_value(equals + 1, colon, &values[0], &is_low_in_degrees);
        if (fault == NULL) {
            *whose = "the high end ";
            fault = read_value(colon + 1, end, &values[1], &is_in_degrees);
        }
        if (fault == NULL && is_low_in_degrees && !is_in_degrees && values[1] != 0) {
            fault = "has no unit, and the low end is in degrees";
        } else if (fault == NULL && values[0] > values[1]) {
            fault = "is below the low end";
        }
    }
    named->is_in_degrees = is_low_in_degrees || is_in_degrees;
    for (uint32_t i = 0; i < value_count && named->is_in_degrees; i++) {
        values[i] *= ROBOT_PI / 180;
    }
    return fault;
}

static void take_joint(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct named_joint named;
    const char *whose;
    uint32_t value_count = strcmp(row->name, "fix") == 0 ? 1 : 2;
    const char *fault = read_named(text, value_count, &named, &whose);
    if (fault != NULL) {
        option_misused(state, "--%s %s: %s%s", row->name, text, whose, fault);
    }
    option_add_text(state, (struct option_arguments *)((char *)to + row->at), text);
}

/* Refuse a joint that is swept twice, or held and swept. */
static void check_joints(const struct argp_state *state, const struct command *command)
{
    const struct option_arguments *of[] = {&command->joints, &command->fixed};
    const uint32_t swept = of[0]->count;
    for (uint32_t i = 0; i < swept + of[1]->count; i++) {
        const char *text = of[i >= swept]->list[i < swept ? i : i - swept];
        size_t length = name_bytes_of(text);
        for (uint32_t k = 0; k < i; k++) {
            const char *before = of[k >= swept]->list[k < swept ? k : k - swept];
            if (strncmp(text, before, length) == 0 && name_bytes_of(before) == length) {
                option_misused(state, "--%s %s: --%s %s names this joint, too",
                               i < swept ? "joint" : "fix", text,
                               k < swept ? "joint" : "fix", before);
            }
        }
    }
}

static void check_usage(struct argp_state *state, void *to)
{
    const struct command *command = to;
    bool is_scene = command->files.count == 1 && scene_is_named(command->files.list[0]);
    if (command->files.count != 1) {
        option_misused(state, "one file: a URDF file or a scene file");
    }
    if (command->joints.count > SWEEP_AXES_MAX) {
        option_misused(state, "--joint: at most %u of them move at a time",
                       SWEEP_AXES_MAX);
    }
    check_joints(state, command);
    if (is_scene && (command->robot.srdf != NULL || command->robot.meshes.count > 0)) {
        option_misused(state, "--srdf and --meshes are of URDF files");
    }
    if (!is_scene && command->between.count > 0) {
        option_misused(state, "--between is of scene files; see --allow");
    }
    if (command->edges != NULL && command->joints.count > 0) {
        option_misused(state, "--edges: not with --joint; all joints move");
    }
    if (command->picture != NULL && !tool_ends_with(command->picture, ".png") &&
        !tool_ends_with(command->picture, ".svg")) {
        option_misused(state, "-o: \"%s\" ends with neither .png nor .svg",
                       command->picture);
    }
    if (command->edges != NULL && command->least >= 0) {
        option_misused(state, "--least is of ranges, not of --edges");
    }
    if (command->edges != NULL && command->picture != NULL) {
        option_misused(state, "-o: a picture is of a range, and --edges asks for none");
    }
    if (command->robot.state != NULL && command->robot.srdf == NULL) {
        option_misused(state, "--state is of the file that --srdf names");
    }
}

#define AT(member) offsetof(struct command, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"joint", 0, "NAME[=LO:HI]",
     "Sweep this joint, from LO to HI (default: its limits), in radians, in degrees (as "
     "-90:90deg) or in the file's unit; up to three at once (default: each joint by "
     "itself)",
     OPTION_OWN, .at = AT(joints), .take = take_joint},
    {"fix", 0, "NAME=VALUE",
     "Hold a joint that is not swept there (default: at 0, or where its limits are "
     "nearest to 0); may be repeated",
     OPTION_OWN, .at = AT(fixed), .take = take_joint},
    {"edges", 0, "FILE",
     "Instead of ranges: motions of all joints at once, a line {\"from\": [VALUE..], "
     "\"to\": [VALUE..]} each, in radians or the file's unit, of all joints in their "
     "order, or as {\"NAME\": VALUE..}",
     OPTION_TEXT, .at = AT(edges)},
    {"clearance", 0, "[A,B=]D",
     "Parts may not come nearer to each other than D (default: 0); or these two, in the "
     "place of that and of their thickness. At 0 these two may be as near as they like, "
     "as a pin in its hole, and may not pass through each other. May be repeated",
     OPTION_OWN, .at = AT(clearances), .take = take_clearance},
    {"allow", 0, "A,B",
     "These two parts may meet, as those do that touch by design; may be repeated",
     OPTION_OWN, .at = AT(apart), .take = scene_take_pair},
    {"between", 0, "A,B",
     "Compare the parts of a scene file only that are named so; may be repeated",
     OPTION_OWN, .at = AT(between), .take = scene_take_pair},
    {"with", 0, "FILE", "Add a mesh that stands, as another part; may be repeated",
     OPTION_TEXTS, .at = AT(robot.with)},
    {"srdf", 0, "FILE", "Leave out the pairs of links that this file disables",
     OPTION_TEXT, .at = AT(robot.srdf)},
    {"state", 0, "NAME", "Hold joints where a group_state of that file has them",
     OPTION_TEXT, .at = AT(robot.state)},
    {"meshes", 0, "DIR",
     "Look for meshes here first, by their path, what is behind the package, and their "
     "last name; may be repeated (default: beside the file, and up to three folders "
     "above for a package)",
     OPTION_TEXTS, .at = AT(robot.meshes)},
    {"sides", 0, "N",
     "Of the prism around a cylinder, which is up to 5 / N^2 of its radius thicker "
     "(default: 64)",
     OPTION_U32, .at = AT(robot.sides), .min = 3, .max = SIDES_MAX},
    {"bracket", 0, "D",
     "Find a jam to within D, in radians or the file's unit (default: 1e-6)", OPTION_REAL,
     .at = AT(bracket), .min = 1e-15, .max = 1},
    {"least", 0, "PART",
     "Find the least distance while joints move freely, to PART of the size, or as far "
     "as "
     "--motions at each distance that is tried allow; 0: do not (default: 0.001; 0 of "
     "several joints, and where two parts have a clearance of their own)",
     OPTION_REAL, .at = AT(least), .max = 1},
    {"motions", 0, "N",
     "Of several joints at once: decide by N motions, or a few more (default: 4096)",
     OPTION_U32, .at = AT(limit), .min = 1, .max = MOTIONS_MAX},
    CTL_OUTPUT,
    {"output", 'o', "FILE",
     "Draw the first jam, else where parts are nearest, to FILE.png or FILE.svg: the two "
     "parts in colour, the place, and paler the way of what moves",
     OPTION_TEXT, .at = AT(picture)},
    {"json", 0, NULL, "Print JSON", OPTION_FLAG, .at = AT(is_json)},
    CTL_ENGINE,
    {"threads", 0, "N", "Use at most N threads (default: the daemon decides)", OPTION_U32,
     .at = AT(threads), .min = 1, .max = THREADS_MAX},
    {.type = OPTION_ARGUMENTS, .at = AT(files), .needed = "a URDF or scene file"},
    {0}};

const struct option_table ctl_table_sweep = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_link_table, AT(link)}, {0}},
    .check = check_usage,
    .arguments = "ROBOT.urdf|SCENE.json",
    .text = "Tell whether parts of a robot or machine meet while its joints move over "
            "their ranges, with proof: free, or jams at a value, of which a bracket is "
            "given. Parts turn on their true arcs; nothing is sampled. Parts that no "
            "joint moves against each other are not compared.",
    .more = "Without --url, --socket and $PCCD_URL a private daemon is started. Exit "
            "status: 0 free, 1 when something jams, 2 after wrong usage, 3 without a "
            "daemon, 4 after any other error, as a mesh that is not there, 5 when "
            "nothing jams and a part of a range stays undecided.",
    .examples = "  pccdctl sweep hinge.urdf\n"
                "  pccdctl sweep --srdf arm.srdf --joint elbow=-90deg:90deg arm.urdf\n",
};

struct run {
    const struct command *command;
    struct scene scene; /* of a scene file */
    struct robot robot;
    struct sweep sweep;
    struct sweep_range range; /* of no joint: each is swept by itself */
    enum sweep_verdict verdict;
    struct sweep_scene shown; /* in the picture */
    json_t *ranges;           /* or edges; NULL: text is printed */
    bool lacks_memory;
};

/* ---- what is asked ----------------------------------------------------------------- */

/* Find the joint of "NAME=VALUE" or "NAME=LO:HI", and its values; E_INVAL: it is none, or
 * none that has a value of its own. */
static int read_joint(const struct robot *robot, const char *option, const char *text,
                      uint32_t value_count, struct named_joint *named,
                      struct ctl_error *error)
{
    const char *whose;
    (void)read_named(text, value_count, named, &whose); /* take_joint knows it is right */
    char *name = strndup(text, name_bytes_of(text));
    named->joint = name != NULL ? robot_find_joint(robot, name) : ROBOT_NONE;
    free(name);
    if (named->joint == ROBOT_NONE) {
        return ctl_error_set(error, PCCD_E_INVAL, "--%s %s: %s has no such joint", option,
                             tool_shown(text), tool_shown(robot->path));
    }
    const struct robot_joint *at = &robot->joints[named->joint];
    if (!robot_is_free(robot, named->joint)) {
        return ctl_error_set(
            error, PCCD_E_INVAL, "--%s %s: the joint %s%s", option, tool_shown(text),
            at->leader != ROBOT_NONE ? "follows " : "does not move",
            at->leader != ROBOT_NONE ? tool_shown(robot->joints[at->leader].name) : "");
    }
    if (named->is_in_degrees && at->kind != PCCD_JOINT_TURN) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "--%s %s: in degrees, and this joint slides", option,
                             tool_shown(text));
    }
    if (!named->has_values) {
        memcpy(named->values, at->range, sizeof named->values);
    }
    return PCCD_OK;
}

static int fix_joints(const struct command *command, struct robot *robot,
                      struct ctl_error *error)
{
    int status = PCCD_OK;
    for (size_t i = 0; i < command->fixed.count && status == PCCD_OK; i++) {
        struct named_joint named;
        status = read_joint(robot, "fix", command->fixed.list[i], 1, &named, error);
        if (status == PCCD_OK) {
            robot->start[named.joint] = named.values[0];
        }
    }
    robot_follow(robot, robot->start);
    return status;
}

/* Find the parts of "A,B", whose names may have commas, too, up to `end`, and let them
 * keep that clearance, or be apart. */
static int set_pair(struct robot *robot, const char *option, const char *text,
                    const char *end, double clearance, struct ctl_error *error)
{
    for (uint32_t a = 0; a < robot->part_count; a++) {
        size_t length = strlen(robot->parts[a].name);
        bool begins = strncmp(text, robot->parts[a].name, length) == 0;
        char *other = begins && text[length] == ','
                          ? strndup(text + length + 1, (size_t)(end - text) - length - 1)
                          : NULL;
        uint32_t b = other != NULL ? robot_find_part(robot, other) : ROBOT_NONE;
        free(other);
        if (b != ROBOT_NONE && b != a) {
            return robot_set_pair(robot, a, b, clearance, error);
        }
    }
    return ctl_error_set(error, PCCD_E_INVAL, "--%s: \"%s\" does not name two parts",
                         option, tool_shown(text));
}

static int set_pairs(const struct command *command, struct robot *robot,
                     struct ctl_error *error)
{
    int status = PCCD_OK;
    for (size_t i = 0; i < command->clearances.count && status == PCCD_OK; i++) {
        const char *text = command->clearances.list[i];
        const char *equals = strrchr(text, '=');
        status =
            set_pair(robot, "clearance", text, equals, strtod(equals + 1, NULL), error);
    }
    for (size_t i = 0; i < command->apart.count && status == PCCD_OK; i++) {
        const char *text = command->apart.list[i];
        status = set_pair(robot, "allow", text, text + strlen(text), ROBOT_APART, error);
    }
    return status;
}

static int read_range(const struct command *command, const struct robot *robot,
                      struct sweep_range *range, struct ctl_error *error)
{
    int status = PCCD_OK;
    range->count = command->joints.count;
    for (uint32_t k = 0; k < range->count && status == PCCD_OK; k++) {
        struct named_joint named;
        status = read_joint(robot, "joint", command->joints.list[k], 2, &named, error);
        range->joints[k] = named.joint;
        memcpy(range->ends[k], named.values, sizeof named.values);
    }
    return status;
}

static int read_scene(const struct command *command, struct run *run,
                      struct ctl_error *error)
{
    static const struct ctl_frames_options frames = {.weld = 0};
    run->scene = (struct scene){
        .frames = &frames, .first_alone = true, .takes_joints = true, .last = UINT32_MAX};
    const struct scene_options options = {.with = command->robot.with,
                                          .between = command->between};
    int status = scene_take(&run->scene, &command->files, true, &options, error);
    if (status == PCCD_OK) {
        status = scene_open(&run->scene, error);
    }
    return status == PCCD_OK ? robot_take_scene(&run->robot, &run->scene, error) : status;
}

/* Give a scene the joints of a screw, on which its first object hangs: one turns about
 * the axis, one goes along it, one leads back from the axis to where the object is. */
static int add_screw(struct scene *scene, const struct check_screw *screw,
                     struct ctl_error *error)
{
    static const char *const names[] = {"screw", "shift", "body"};
    struct scene_joint *joints = calloc(3, sizeof *joints), *shift = &joints[1];
    scene->joints = joints;
    scene->joint_count = joints != NULL ? 3 : 0;
    scene->objects[0].joint = strdup(names[2]);
    bool ok = joints != NULL && scene->objects[0].joint != NULL;
    for (uint32_t i = 0; i < scene->joint_count; i++) {
        joints[i].name = strdup(names[i]);
        joints[i].parent = i > 0 ? strdup(names[i - 1]) : NULL;
        ok = ok && joints[i].name != NULL && (i == 0 || joints[i].parent != NULL);
        memcpy(joints[i].axis, screw->axis, sizeof screw->axis);
    }
    if (ok) {
        joints[0].type = SCENE_REVOLUTE;
        joints[0].range[1] = screw->angle;
        shift->type = SCENE_PRISMATIC;
        shift->range[0] = -LENGTH_MAX;
        shift->range[1] = LENGTH_MAX;
        shift->multiplier = screw->pitch / (2 * ROBOT_PI);
        shift->follows = strdup(names[0]);
        ok = shift->follows != NULL;
        joints[2].type = SCENE_FIXED;
        for (int k = 0; k < 3; k++) {
            joints[0].position[k] = screw->through[k];
            joints[2].position[k] = -screw->through[k];
        }
    }
    return ok ? PCCD_OK : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
}

/* Take files as bodies of which the first one is on a screw. */
static int read_screw(const struct command *command, struct run *run,
                      struct ctl_error *error)
{
    const struct ask_options *ask = command->ask;
    run->scene = (struct scene){.settings = &ask->object, .frames = &ask->frames};
    int status = scene_take(&run->scene, &command->files, true, command->scene, error);
    if (status == PCCD_OK && run->scene.path != NULL) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s: --motion screw takes meshes; pccdctl sweep takes "
                               "scene files with joints",
                               tool_shown(command->files.list[0]));
    }
    status = status == PCCD_OK ? scene_open(&run->scene, error) : status;
    status = status == PCCD_OK ? add_screw(&run->scene, command->screw, error) : status;
    if (status == PCCD_OK) {
        run->scene.path = strdup(command->files.list[0]);
        status = run->scene.path != NULL
                     ? robot_take_scene(&run->robot, &run->scene, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    }
    return status;
}

static int read_robot(const struct command *command, struct run *run,
                      struct ctl_error *error)
{
    const char *path = command->files.list[0];
    struct robot *robot = &run->robot;
    int status = command->screw != NULL ? read_screw(command, run, error)
                 : scene_is_named(path)
                     ? read_scene(command, run, error)
                     : robot_read_urdf(robot, path, &command->robot, error);
    status = status == PCCD_OK ? set_pairs(command, robot, error) : status;
    if (status == PCCD_OK && robot->shape_count == 0) {
        status = ctl_error_set(error, PCCD_E_FORMAT, "%s: nothing has a shape",
                               tool_shown(path));
    }
    if (status == PCCD_OK) {
        status = fix_joints(command, robot, error);
    }
    return status == PCCD_OK ? read_range(command, robot, &run->range, error) : status;
}

/* ---- what comes of it -------------------------------------------------------------- */

static void note_verdict(struct run *run, enum sweep_verdict verdict)
{
    if (run->verdict != SWEEP_JAMS && verdict != SWEEP_FREE) {
        run->verdict = verdict;
    }
}

static int try_range(struct run *run, const struct sweep_range *range)
{
    struct sweep_answer answer;
    const double *values = run->robot.start;
    int status = sweep_try(&run->sweep, range, values, &answer);
    if (status == PCCD_OK) {
        note_verdict(run, answer.verdict);
        sweep_scene_take(&run->shown, range, &answer);
    }
    if (status == PCCD_OK && run->ranges == NULL) {
        sweep_report_range(columns_fitted(stdout), &run->sweep, range, values, &answer);
    } else if (status == PCCD_OK &&
               json_array_append_new(
                   run->ranges, sweep_report_json(&run->sweep, range, values, &answer)) !=
                   0) {
        run->lacks_memory = true;
    }
    sweep_answer_deinit(&answer);
    return status;
}

static int try_each(struct run *run)
{
    const struct robot *robot = &run->robot;
    int status = PCCD_OK;
    for (uint32_t i = 0; i < robot->joint_count && status == PCCD_OK; i++) {
        const double *ends = robot->joints[i].range;
        const struct sweep_range range = {
            .count = 1, .joints = {i}, .ends = {{ends[0], ends[1]}}};
        if (robot_is_free(robot, i) && ends[0] < ends[1]) {
            status = try_range(run, &range);
        }
    }
    if (status == PCCD_OK && run->sweep.asked == 0) {
        status = ctl_error_set(run->sweep.error, PCCD_E_INVAL,
                               "%s: no joint has a range to move over: nothing is swept",
                               tool_shown(robot->path));
    }
    return status;
}

static void take_edge(void *context, uint64_t line, double *const ends[2],
                      const struct sweep_hit *hit)
{
    struct run *run = context;
    enum sweep_verdict verdict = sweep_hit_verdict(hit);
    note_verdict(run, verdict);
    if (run->ranges == NULL) {
        sweep_report_edge(columns_fitted(stdout), &run->robot, line, ends, hit);
    } else if (json_array_append_new(
                   run->ranges, sweep_report_edge_json(&run->robot, line, ends, hit)) !=
               0) {
        run->lacks_memory = true;
    }
}

static int sweep_all(struct run *run)
{
    int status = sweep_begin(&run->sweep);
    if (status != PCCD_OK) {
        return status;
    }
    if (run->ranges == NULL) {
        sweep_report_begin(columns_fitted(stdout), &run->sweep);
        sweep_report_still(columns_fitted(stdout), &run->robot);
    }
    if (run->sweep.pair_count == 0) {
        return ctl_error_set(run->sweep.error, PCCD_E_INVAL,
                             "%s: no two shapes may meet: nothing is compared",
                             tool_shown(run->robot.path));
    }
    if (run->command->edges != NULL) {
        return sweep_edges(&run->sweep, run->command->edges, take_edge, run);
    }
    return run->range.count > 0 ? try_range(run, &run->range) : try_each(run);
}

/* Those that two parts have of their own. */
static json_t *clearances_json(const struct robot *robot)
{
    json_t *list = json_array();
    bool ok = true;
    for (size_t i = 0; i < robot->pair_count; i++) {
        const struct robot_pair *pair = &robot->pairs[i];
        if (pair->clearance != ROBOT_APART) {
            json_t *item = json_object();
            json_set(item, "a", json_text(robot->parts[pair->parts[0]].name), &ok);
            json_set(item, "b", json_text(robot->parts[pair->parts[1]].name), &ok);
            json_set(item, "clearance", json_real(pair->clearance), &ok);
            json_append(list, item, &ok);
        }
    }
    return list;
}

/* Links that would be seen and are not compared. */
static json_t *unseen_json(const struct robot *robot)
{
    json_t *list = json_array();
    bool ok = true;
    for (uint32_t i = 0; i < robot->part_count; i++) {
        if (robot->parts[i].is_visual_alone) {
            json_append(list, json_text(robot->parts[i].name), &ok);
        }
    }
    return list;
}

static bool print_end(struct run *run)
{
    bool ok = !run->lacks_memory;
    if (run->ranges == NULL) {
        if (run->sweep.is_open) {
            fputs("note       not all shapes are closed meshes: where such a one begins "
                  "wholly within another, or around it, is not seen\n",
                  columns_fitted(stdout));
        }
        printf("answer     %s\n", sweep_verdict_name(run->verdict));
        return true;
    }
    json_t *value = json_object();
    json_set(value, "file", json_text(run->robot.path), &ok);
    json_set_count(value, "joints", run->robot.joint_count, &ok);
    json_set_count(value, "parts", run->robot.part_count, &ok);
    json_set_count(value, "shapes", run->robot.shape_count, &ok);
    json_set_count(value, "pairs", run->sweep.pair_count, &ok);
    json_set_count(value, "motions", run->sweep.asked, &ok);
    json_set(value, "without_collision", unseen_json(&run->robot), &ok);
    json_set(value, "looked_within", json_boolean(!run->sweep.is_open), &ok);
    json_set(value, "clearance", json_real(run->sweep.clearance), &ok);
    json_set(value, "clearances", clearances_json(&run->robot), &ok);
    json_set(value, run->command->edges != NULL ? "edges" : "ranges",
             json_incref(run->ranges), &ok);
    json_set(value, "verdict", json_string(sweep_verdict_name(run->verdict)), &ok);
    return output_json(value, ok, stdout);
}

static int draw(struct run *run, struct whole_file *file)
{
    const char *path = run->command->picture;
    struct ctl_error *error = run->sweep.error;
    int status = sweep_draw(&run->sweep, &run->shown, run->robot.start, file->to, path);
    status = status == PCCD_OK ? output_finish(file, path, error) : status;
    if (status == PCCD_OK && run->ranges == NULL) {
        printf("picture    %s\n", tool_shown(path));
    }
    return status;
}

static double least_of(const struct command *command, const struct robot *robot)
{
    if (command->least >= 0) {
        return command->least;
    }
    return robot_has_clearances(robot) || command->joints.count > 1 ? 0 : 1e-3;
}

/* Have a recording keep that z is up, as in URDF, unless it was told another axis. */
static void tell_up(void)
{
    const char *name = "PCCD_RECORD_OPTIONS";
    const char *given = getenv(name) != NULL ? getenv(name) : "";
    const char *up = strstr(given, "up=");
    char *text = NULL;
    if ((up == NULL || up[3] == '0') &&
        asprintf(&text, "%s%sup=3", given, *given != '\0' ? "," : "") >= 0) {
        (void)setenv(name, text, 1);
        free(text);
    }
}

static int run_sweep(const struct command *command)
{
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    struct run run = {.command = command,
                      .ranges = command->is_json ? json_array() : NULL};
    int status = read_robot(command, &run, &error);
    run.sweep = (struct sweep){.robot = &run.robot,
                               .clearance = command->clearance,
                               .bracket = command->bracket,
                               .error = &error,
                               .least = least_of(command, &run.robot),
                               .limit = command->limit,
                               .threads = command->threads};
    if (status == PCCD_OK && command->picture != NULL) {
        status = output_open(&file, command->picture, false, &error);
    }
    tell_up();
    if (status == PCCD_OK &&
        ctl_link_open(&command->link, &run.sweep.client) != CTL_DONE) {
        status = ctl_error_set(&error, PCCD_E_NODAEMON, "%s", "");
    }
    if (status == PCCD_OK) {
        status = sweep_all(&run);
    }
    if (status == PCCD_OK && command->picture != NULL) {
        status = draw(&run, &file);
    }
    if (status == PCCD_OK && !print_end(&run)) {
        status = ctl_error_set(&error, PCCD_E_SYSTEM, "the report could not be written");
    }
    whole_file_discard(&file);
    ctl_error_tell(&error);
    sweep_end(&run.sweep);
    pccd_close(run.sweep.client);
    robot_close(&run.robot);
    scene_close(&run.scene);
    json_decref(run.ranges);
    return status == PCCD_OK && run.verdict == SWEEP_UNDECIDED
               ? CTL_UNDECIDED
               : (int)ctl_exit_of(status, run.verdict == SWEEP_FREE);
}

#define DEFAULTS .robot.sides = 64, .bracket = 1e-6, .least = LEAST_UNSAID, .limit = 4096

int sweep_screw(const struct check_screw *screw, const struct ask_options *ask,
                const struct scene_options *options, double clearance)
{
    const struct command command = {DEFAULTS,
                                    .files = ask->files,
                                    .link = ask->link,
                                    .clearance = clearance,
                                    .threads = ask->threads,
                                    .is_json = ask->is_json,
                                    .screw = screw,
                                    .ask = ask,
                                    .scene = options};
    return run_sweep(&command);
}

int ctl_cmd_sweep(int argc, char **argv)
{
    struct command command = {DEFAULTS, .link.policy = CTL_LINK_PRIVATE_UNLESS_ENV};
    int status = CTL_USAGE;
    if (option_parse(&ctl_table_sweep, argc, argv, &command) == 0) {
        status = run_sweep(&command);
    }
    free(command.joints.list);
    free(command.fixed.list);
    free(command.apart.list);
    free(command.between.list);
    free(command.clearances.list);
    free(command.robot.meshes.list);
    free(command.robot.with.list);
    ctl_link_deinit(&command.link);
    return status;
}
