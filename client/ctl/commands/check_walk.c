/* check_walk.c - frames, one after the other, and what is said of them. */
#include "check_walk.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "failing.h"
#include "judge.h"
#include "output.h"
#include "printable.h"
#include "shown.h"
#include "terminal.h"

/* Everything that lives while the frames are walked through. */
struct walk {
    const struct check_command *command;
    struct ctl_frames_options frames; /* the command's; what is cut off is judged, too */
    struct scene scene;
    uint32_t begin, end; /* steps begin + 1 to end are asked for */
    uint32_t at;         /* the last step that is known */
    bool has_first;      /* the first frame is known */
    bool has_verdict;    /* of all steps asked for: nothing is left to do */
    bool is_judged;      /* the ends of steps are looked at, too */
    bool has_names;
    struct check_run run;
    struct objects objects;
    struct contacts_csv csv;
    struct judge_ends ends;
    /* The step that was made last, while its end is not looked at. */
    struct judged pending;
    bool has_pending, can_wait;
    int pending_status; /* of looking meanwhile */
    struct ctl_error pending_error;
    uint32_t ahead; /* a frame that was read while a step was computed; 0: none was */
    int ahead_status;
    struct ctl_error ahead_error;
    struct judge judge;
    struct check_lines lines;
    json_t *head;              /* of the lines; NULL: there are none */
    const json_t *expected;    /* head of a certificate; NULL: there is none */
    char *path;                /* ours, of the file of results; NULL: there is none */
    struct report_step *steps; /* of --json, [scene.count - 1]; else NULL */
    struct progress progress;
    struct trace_file trace;
    struct failing failing;
    FILE *report; /* NULL: nothing is said */
};

/* ---- lines ------------------------------------------------------------------------- */

/* A line of what is known of a step, where lines are wanted. */
static int put(struct walk *walk, const struct judged *judged, struct ctl_error *error)
{
    return walk->head != NULL ? check_lines_put(&walk->lines, judged_line(judged), error)
                              : PCCD_OK;
}

/* Take what is known of a step, and say so. */
static void take(struct walk *walk, const struct judged *judged)
{
    bool is_told = walk->report != NULL && !walk->command->check.ask.is_json;
    judge_take(&walk->judge, judged);
    if (judged->number > 0) {
        walk->at = judged->number;
    } else {
        walk->has_first = true;
    }
    if (is_told && walk->scene.count > 2) {
        progress_clear(&walk->progress);
        if (judged->number > 0) {
            report_print_line(walk->report, &walk->run.told, judged->number,
                              &judged->report);
            report_print_pairs(walk->report, &walk->run.told, &judged->report);
        }
        judged_print(walk->report, judged);
        (void)fflush(walk->report);
    }
}

/* Return whether a line is the verdict of all that was taken, and nothing is left. */
static bool is_verdict(const struct walk *walk, const json_t *line)
{
    json_t *expected = judge_line(&walk->judge);
    bool is_it = walk->has_first && walk->at == walk->end && json_equal(line, expected);
    json_decref(expected);
    return is_it;
}

/* A line that is there already, or that another process has written. */
static int take_line(void *context, const json_t *line, struct ctl_error *error)
{
    struct walk *walk = context;
    struct judged judged;
    if (judge_is_line(line) && !walk->has_verdict) {
        walk->has_verdict = is_verdict(walk, line);
        return walk->has_verdict ? PCCD_OK
                                 : ctl_error_set(error, PCCD_E_FORMAT,
                                                 "it is not the verdict of the lines "
                                                 "before it");
    }
    if (walk->has_verdict || !judged_read(line, &judged) || judged.number > walk->end ||
        (judged.number > 0 && judged.number != walk->at + 1)) {
        return ctl_error_set(error, PCCD_E_FORMAT, "it is no result of this check");
    }
    judged.report.to = scene_frame_name(&walk->scene, judged.number);
    take(walk, &judged);
    return PCCD_OK;
}

/* The same of another process: those that are there already, and the first frame that
 * each of them begins with, are passed over. */
static int take_part(void *context, const json_t *line, struct ctl_error *error)
{
    struct walk *walk = context;
    uint64_t number = (uint64_t)json_integer_value(json_object_get(line, "step"));
    if (number == 0 ? walk->has_first : number <= walk->at) {
        return PCCD_OK;
    }
    int status = take_line(walk, line, error);
    if (status == PCCD_OK) {
        status =
            check_lines_put(&walk->lines, json_incref((json_t *)(uintptr_t)line), error);
    }
    progress_update(&walk->progress, walk->at);
    return status;
}

/* Open the results, and take what they have. */
static int open_lines(struct walk *walk, struct ctl_error *error)
{
    const struct results_options *asked = &walk->command->results;
    if (asked->path == NULL && asked->jobs <= 1 && walk->expected == NULL) {
        return PCCD_OK;
    }
    walk->head = check_head(walk->command, &walk->scene, error);
    if (walk->head == NULL) {
        return PCCD_E_SYSTEM;
    }
    if (walk->expected != NULL) {
        check_lines_compare_heads(&walk->lines, walk->expected, walk->head);
    }
    if (walk->expected != NULL || asked->path == NULL) {
        return PCCD_OK;
    }
    if (strcmp(asked->path, "-") == 0) {
        walk->lines.to = stdout;
        return check_lines_put(&walk->lines, json_incref(walk->head), error);
    }
    walk->path = asked->parts > 0
                     ? check_part_path(asked->path, asked->part, asked->parts)
                     : strdup(asked->path);
    int status = walk->path != NULL
                     ? results_open(&walk->lines.results, walk->path, walk->head,
                                    take_line, walk, error)
                     : ctl_error_set(error, PCCD_E_NOMEM, "no memory for the results");
    const char *left_out = walk->command->check.ask.csv != NULL  ? "--contacts"
                           : walk->command->failing.page != NULL ? "--page"
                           : walk->command->failing.film != NULL ? "--film"
                                                                 : NULL;
    if (status == PCCD_OK && left_out != NULL &&
        (walk->at > walk->begin || walk->has_verdict)) {
        status = ctl_error_set(error, PCCD_E_STATE,
                               "%s has steps already, whose contacts %s would leave out",
                               walk->path, left_out);
    }
    return status;
}

/* ---- steps ------------------------------------------------------------------------- */

/* Ask what crosses where the step has ended. */
static int ask_crossings(void *context, struct crossings *to, struct ctl_error *error)
{
    struct walk *walk = context;
    return crossings_ask(to, &walk->run, NULL, 0, error);
}

/* Look at the end of the step that was made last, and say what is known of it. */
static int end_step(struct walk *walk, struct ctl_error *error)
{
    struct judged *judged = &walk->pending;
    struct report_step *step = &judged->report;
    if (!walk->has_pending) {
        return PCCD_OK;
    }
    walk->has_pending = false;
    int status = walk->is_judged ? judge_ends_look(&walk->ends, &walk->run,
                                                   judged->number, step, error)
                                 : PCCD_OK;
    walk->ends.follow.count = 0;
    walk->ends.follow.is_whole = true;
    if (status == PCCD_OK &&
        (judged_fails(judged) || (!step->ends.is_known && report_meets(step)))) {
        status =
            failing_keep(&walk->failing, &walk->run, &walk->scene, judged->number, error);
    }
    if (status == PCCD_OK) {
        status = put(walk, judged, error);
    }
    if (status == PCCD_OK) {
        take(walk, judged);
    }
    if (walk->csv.whole.to != NULL) {
        (void)fflush(walk->csv.whole.to);
    }
    if (walk->steps != NULL) {
        walk->steps[judged->number - 1] = *step;
    } else {
        free(step->pairs);
    }
    return status;
}

/* Return whether a file is a pipe, which may have nothing yet: what is known by then is
 * told first. */
static bool has_pipe(const struct scene *scene)
{
    bool has = false;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const struct ctl_sequence *files = &scene->objects[i].files.sequence;
        for (uint32_t k = 0; k < files->count && !has; k++) {
            has = ctl_mesh_is_pipe(files->paths[k]);
        }
    }
    return has;
}

/* Return whether the end of a step may be looked at while the next one is computed. Not
 * where a frame comes through a pipe, which may keep its line waiting; nor where direct:
 * computes, in this thread; nor where a step that fails is made again to be shown. */
static bool may_wait(const struct walk *walk)
{
    return walk->is_judged && !has_pipe(&walk->scene) &&
           !ctl_link_is_direct(&walk->command->check.ask.link) &&
           walk->command->failing.page == NULL && walk->command->failing.film == NULL;
}

/* Make a step. Its end is looked at while the next one is computed, if it can be without
 * asking the daemon. */
static int make_step(struct walk *walk, uint32_t number, struct ctl_error *error)
{
    struct judged judged = {.number = number};
    struct report_step *step = &judged.report;
    step->from = scene_frame_name(&walk->scene, number - 1);
    step->to = scene_frame_name(&walk->scene, number);
    int status =
        check_run_step(&walk->run, &walk->scene, number, &walk->csv, step, error);
    if (walk->pending_status != PCCD_OK) {
        *error = walk->pending_error;
        status = walk->pending_status;
    }
    if (status != PCCD_OK) {
        return status;
    }
    judged_set(&judged, walk->run.told.names);
    walk->pending = judged;
    walk->has_pending = true;
    return walk->can_wait && judge_ends_follow(&walk->ends, walk->run.settings.mode, step)
               ? PCCD_OK
               : end_step(walk, error);
}

/* While a step is computed: read the frame after it. Return whether the step to that may
 * begin: what crosses where this one ends will be found without asking, if its answer is
 * no exception. */
static bool goes_on(void *context)
{
    struct walk *walk = context;
    const struct report_step step = {.is_complete = true};
    const uint32_t next = walk->at + 2; /* the step before was ended meanwhile */
    if (next > walk->end || walk->pending_status != PCCD_OK) {
        return false;
    }
    walk->ahead = next;
    walk->ahead_status = scene_read(&walk->scene, next, &walk->ahead_error);
    return walk->can_wait && walk->ahead_status == PCCD_OK &&
           walk->run.settings.mode == PCCD_MODE_ALL &&
           judge_ends_follow(&walk->ends, PCCD_MODE_ALL, &step);
}

/* Return whether that was right. If not, nothing is done early any more. */
static bool may_stay(void *context, const struct pccd_answer *answer)
{
    struct walk *walk = context;
    const struct report_step step = {.answer = *answer,
                                     .is_complete = answer->incomplete == PCCD_COMPLETE};
    walk->can_wait = judge_ends_follow(&walk->ends, PCCD_MODE_ALL, &step);
    return walk->can_wait;
}

/* While a step is computed: end the one before. */
static void end_before(void *context)
{
    struct walk *walk = context;
    walk->pending_status = end_step(walk, &walk->pending_error);
}

static void note_page(void *context, const struct pccd_answer *page)
{
    struct walk *walk = context;
    if (walk->is_judged && walk->run.settings.mode == PCCD_MODE_ALL) {
        follow_note(&walk->ends.follow, page);
    }
}

static int read_frame(struct walk *walk, uint32_t number, struct ctl_error *error)
{
    if (walk->ahead != number) {
        return scene_read(&walk->scene, number, error);
    }
    if (walk->ahead_status != PCCD_OK) {
        *error = walk->ahead_error;
    }
    return walk->ahead_status;
}

static int walk_steps(struct walk *walk, struct ctl_error *error)
{
    int status = PCCD_OK;
    for (uint32_t i = walk->at + 1; i <= walk->end && status == PCCD_OK; i++) {
        if (i > 1) {
            status = read_frame(walk, i, error);
        }
        if (status == PCCD_OK) {
            status = make_step(walk, i, error);
        }
    }
    struct ctl_error end_error = {.text = ""};
    int ended = end_step(walk, &end_error);
    if (status == PCCD_OK && ended != PCCD_OK) {
        *error = end_error;
        status = ended;
    }
    progress_clear(&walk->progress);
    return status;
}

/* The same, between the beginning and the end of a recording if one is wanted. */
static int walk_traced(struct walk *walk, struct ctl_error *error)
{
    const struct trace_options *options = &walk->command->trace;
    struct pccd_client *client = walk->run.client;
    if (options->path == NULL) {
        return walk_steps(walk, error);
    }
    int status = trace_file_begin(&walk->trace, options, client, error);
    if (status == PCCD_OK) {
        status = walk_steps(walk, error);
    }
    if (status == PCCD_OK) {
        status = trace_file_end(&walk->trace, client, error);
    }
    trace_file_deinit(&walk->trace);
    return status;
}

/* ---- beginning --------------------------------------------------------------------- */

/* Open the files, and read the first frame, and the second where it is the next one, so
 * that a bad file costs nothing else. */
static int read_scene(struct walk *walk, struct ctl_error *error)
{
    const struct check_command *command = walk->command;
    const struct results_options *asked = &command->results;
    struct scene *scene = &walk->scene;
    int status =
        scene_take(scene, &command->check.ask.files, false, &command->scene, error);
    if (status == PCCD_OK) {
        status = scene_open(scene, error);
    }
    if (status == PCCD_OK && scene->count < 2) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s is one frame: a step has two, before and after it",
                             scene_frame_name(scene, 0));
    }
    if (status != PCCD_OK) {
        return status;
    }
    uint64_t steps = scene->count - 1;
    walk->end = (uint32_t)steps;
    if (asked->parts > 0) {
        walk->begin = (uint32_t)(steps * (asked->part - 1) / asked->parts);
        walk->end = (uint32_t)(steps * asked->part / asked->parts);
    }
    walk->at = walk->begin;
    walk->judge.part =
        (struct judge_part){asked->part, asked->parts, walk->begin + 1, walk->end};
    if (asked->jobs <= 1) {
        status = scene_read(scene, 0, error);
    }
    return status == PCCD_OK && asked->jobs <= 1 && walk->begin == 0
               ? scene_read(scene, 1, error)
               : status;
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
static int place(struct walk *walk, struct ctl_error *error)
{
    const struct check_options *options = &walk->command->check;
    struct check_run *run = &walk->run;
    struct scene *scene = &walk->scene;
    const bool has_geometry = walk->command->has_geometry;
    run->settings = check_step_settings(options);
    run->settings.tells_start = !walk->is_judged || run->settings.approach > 0;
    int status =
        check_run_begin(run, scene, walk->has_names || options->ask.csv != NULL, error);
    for (uint32_t i = 0; status == PCCD_OK && i < scene->object_count; i++) {
        const struct scene_object *object = &scene->objects[i];
        status =
            objects_add(&walk->objects,
                        scene->object_count > 1 || !walk->has_names ? object->name : "",
                        &(struct objects_of){.handle = object->handle,
                                             .mesh = &object->files.mesh,
                                             .edges = object->edges,
                                             .edge_count = object->info.edge_count},
                        error);
    }
    run->told.names = walk->objects.names;
    run->objects = walk->has_names ? &walk->objects : NULL;
    if (status == PCCD_OK) {
        status = failing_begin(&walk->failing, &options->ask.link, run, error);
    }
    if (status == PCCD_OK && options->ask.csv != NULL) {
        walk->csv = (struct contacts_csv){.path = options->ask.csv,
                                          .has_step = scene->count > 2,
                                          .has_names = walk->has_names || has_geometry,
                                          .has_touching = options->settings.touching !=
                                                          PCCD_TOUCHING_KEPT,
                                          .objects = &walk->objects,
                                          .scene = scene,
                                          .has_geometry = has_geometry};
        status = contacts_csv_open(&walk->csv, error);
    }
    return status;
}

static void print_scene(struct walk *walk, bool has_meshes)
{
    const bool is_json = walk->command->check.ask.is_json;
    walk->run.told.warning = scene_idle(&walk->scene, true);
    if (walk->report != NULL && !is_json && has_meshes) {
        report_print_scene(walk->report, &walk->run.told);
    }
    for (uint32_t i = 0; walk->report != NULL && i < walk->scene.object_count; i++) {
        report_print_notes(is_json ? stderr : walk->report,
                           &walk->scene.objects[i].files);
    }
    if (walk->report != NULL && walk->run.told.warning != NULL) {
        (void)ctl_complain("warning: %s", walk->run.told.warning);
    }
}

/* Find what crosses in the first frame, and in the one that the next step begins at. */
static int look_at_first(struct walk *walk, struct ctl_error *error)
{
    struct scene *scene = &walk->scene;
    struct judged judged = {.number = 0};
    int status = crossings_ask(&walk->ends.first, &walk->run, NULL, 0, error);
    judged_set_first(&judged, scene_frame_name(scene, 0), &walk->ends.first);
    if (status == PCCD_OK && !walk->has_first) {
        status = put(walk, &judged, error);
        if (status == PCCD_OK) {
            take(walk, &judged);
        }
    }
    if (status == PCCD_OK && walk->at > 0) {
        status = scene_read(scene, walk->at, error);
    }
    if (status != PCCD_OK || walk->at == 0) {
        return status == PCCD_OK
                   ? crossings_copy(&walk->ends.end, &walk->ends.first, error)
                   : status;
    }
    struct pccd_motion *motions = calloc(scene->object_count, sizeof *motions);
    status = motions != NULL
                 ? crossings_ask(&walk->ends.end, &walk->run, motions,
                                 scene_motions(scene, walk->at, false, motions), error)
                 : ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
    free(motions);
    return status;
}

/* ---- all of it --------------------------------------------------------------------- */

/* The steps that are left, in this process. */
static int walk_alone(struct walk *walk, struct ctl_error *error)
{
    const struct ask_options *ask = &walk->command->check.ask;
    uint32_t default_repeats = walk->scene.count == 2 ? 1 : 0;
    walk->run.repeats = ask->has_repeats ? ask->repeats : default_repeats;
    if (ctl_link_open(&ask->link, &walk->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    int status = place(walk, error);
    if (status == PCCD_OK) {
        print_scene(walk, true);
        status = open_lines(walk, error);
    }
    if (status != PCCD_OK || walk->has_verdict) {
        return status;
    }
    if (walk->is_judged) {
        status = follow_begin(&walk->ends.follow, &walk->scene, error);
        status = status == PCCD_OK ? look_at_first(walk, error) : status;
    }
    walk->can_wait = may_wait(walk);
    walk->run.note = note_page;
    walk->run.goes_on = has_pipe(&walk->scene) ? NULL : goes_on;
    walk->run.may_stay = may_stay;
    walk->run.meanwhile = end_before;
    walk->run.owner = walk;
    progress_begin(&walk->progress, "runs",
                   walk->command->results.is_job
                       ? 0
                       : (uint64_t)walk->end * (walk->run.repeats + 1u));
    progress_update(&walk->progress, (uint64_t)walk->at * (walk->run.repeats + 1u));
    walk->run.progress = &walk->progress;
    return status == PCCD_OK ? walk_traced(walk, error) : status;
}

/* The same, in other processes. */
static int walk_jobs(struct walk *walk, struct ctl_error *error)
{
    struct check_jobs jobs = {.count = 0};
    print_scene(walk, false);
    int status = open_lines(walk, error);
    if (status != PCCD_OK || walk->has_verdict) {
        return status;
    }
    progress_begin(&walk->progress, "steps", walk->end);
    progress_update(&walk->progress, walk->at);
    status = check_jobs_start(&jobs, walk->command, walk->head, error);
    if (status == PCCD_OK) {
        status = check_jobs_follow(&jobs, take_part, walk, error);
    }
    if (status == PCCD_OK && walk->at != walk->end) {
        status = ctl_error_set(error, PCCD_E_FORMAT,
                               "the results of a job have a verdict before their end");
    }
    progress_clear(&walk->progress);
    check_jobs_end(&jobs, status == PCCD_OK);
    return status;
}

/* Fail where a file is no longer what its hash in the results says. */
static int look_at_files(const struct walk *walk, struct ctl_error *error)
{
    const char *path = NULL;
    for (uint32_t i = 0; i < walk->scene.object_count && path == NULL; i++) {
        path = ctl_sequence_changed(&walk->scene.objects[i].files.sequence);
    }
    return path == NULL ? PCCD_OK
                        : ctl_error_set(error, PCCD_E_STATE,
                                        "%s has changed since the check began: what was "
                                        "found is no result of it",
                                        tool_shown(path));
}

static int report_all(struct walk *walk, struct ctl_error *error)
{
    const bool is_json = walk->command->check.ask.is_json;
    const uint32_t step_count = walk->scene.count - 1;
    if (!walk->has_verdict && walk->head != NULL) {
        int status = look_at_files(walk, error);
        if (status == PCCD_OK) {
            status = check_lines_put(&walk->lines, judge_line(&walk->judge), error);
        }
        if (status != PCCD_OK) {
            return status;
        }
    }
    if (is_json && !report_json(walk->report, &walk->run.told, walk->steps, step_count,
                                step_count > 1 ? judge_line(&walk->judge) : NULL)) {
        return ctl_error_set(error, PCCD_E_SYSTEM,
                             "the JSON report could not be written");
    }
    if (!is_json && walk->report != NULL) {
        judge_print(walk->report, &walk->judge, "verdict");
    }
    if (walk->command->trace.path != NULL) {
        trace_file_report(&walk->trace, is_json ? stderr : walk->report, false);
    }
    return failing_write(&walk->failing, &walk->command->check.ask.link,
                         is_json ? stderr : walk->report, error);
}

static void walk_deinit(struct walk *walk)
{
    for (uint32_t i = 0; walk->steps != NULL && i < walk->scene.count - 1; i++) {
        free(walk->steps[i].pairs);
    }
    free(walk->steps);
    check_lines_close(&walk->lines);
    json_decref(walk->head);
    free(walk->path);
    judge_ends_deinit(&walk->ends);
    check_run_deinit(&walk->run);
    pccd_close(walk->run.client);
    failing_deinit(&walk->failing);
    objects_deinit(&walk->objects);
    scene_close(&walk->scene);
}

static void walk_init(struct walk *walk, const struct check_command *command)
{
    const struct ask_options *ask = &command->check.ask;
    *walk = (struct walk){.command = command,
                          .frames = ask->frames,
                          .scene = {.settings = &ask->object, .frames = &walk->frames},
                          .lines = CHECK_LINES_INIT,
                          .failing = {.options = &command->failing,
                                      .scene = &command->scene},
                          .report = ask_report_to(ask)};
    walk->frames.wish.takes_cut = true;
    if (command->results.path != NULL && strcmp(command->results.path, "-") == 0) {
        walk->report = stderr;
    }
    if (command->results.is_job) {
        walk->report = NULL;
    }
}

/* Everything up to the verdict. */
static int walk_all(struct walk *walk, struct ctl_error *error)
{
    const struct check_command *command = walk->command;
    const struct results_options *asked = &command->results;
    int status = read_scene(walk, error);
    if (status != PCCD_OK) {
        return status;
    }
    walk->has_names = has_names(&walk->scene);
    walk->judge.leaves_out = command->check.settings.touching == PCCD_TOUCHING_LEFT_OUT;
    walk->ends.leaves_out = walk->judge.leaves_out;
    walk->ends.ask = ask_crossings;
    walk->ends.context = walk;
    walk->is_judged = walk->scene.count > 2 || asked->path != NULL || asked->jobs > 1 ||
                      walk->expected != NULL || walk->judge.leaves_out;
    walk->judge.is_thick = command->check.settings.separation > 0;
    for (uint32_t i = 0; i < walk->scene.object_count; i++) {
        walk->judge.is_thick =
            walk->judge.is_thick || walk->scene.objects[i].settings.radius > 0;
    }
    if (command->check.ask.is_json || walk->scene.count == 2) {
        walk->steps = calloc(walk->scene.count - 1, sizeof *walk->steps);
        if (walk->steps == NULL) {
            return ctl_error_set(error, PCCD_E_NOMEM, "out of memory");
        }
    }
    return asked->jobs > 1 ? walk_jobs(walk, error) : walk_alone(walk, error);
}

int check_walk(const struct check_command *command)
{
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct walk walk;
    bool is_free = false;
    walk_init(&walk, command);
    int status = walk_all(&walk, &error);
    if (status == PCCD_OK && walk.report != NULL && walk.scene.count == 2 &&
        !command->check.ask.is_json && walk.steps[0].to != NULL) {
        report_print_step(walk.report, &walk.run.told, &walk.steps[0]);
    }
    if (status == PCCD_OK) {
        status = report_all(&walk, &error);
    } else if (walk.judge.steps > 0 && walk.report != NULL &&
               !command->check.ask.is_json) {
        judge_print(walk.report, &walk.judge, "so far");
    }
    int closed =
        output_close(&walk.csv.whole, walk.csv.path, status == PCCD_OK, &close_error);
    if (status == PCCD_OK) {
        status = judge_end(&walk.judge, &is_free, &error);
    }
    walk_deinit(&walk);
    return ask_end(status, is_free, &error, closed, &close_error);
}

int check_verify(const char *certificate, struct check_command *command)
{
    struct ctl_error error = {.text = ""};
    struct walk walk;
    struct option_arguments *files = &command->check.ask.files;
    json_t *expected = NULL;
    walk_init(&walk, command);
    walk.report = NULL;
    int status = check_lines_expect(&walk.lines, certificate, &expected, &error);
    uint64_t with = (uint64_t)json_integer_value(
        json_object_get(json_object_get(expected, "settings"), "with"));
    if (status == PCCD_OK && !check_head_read(expected, command)) {
        status =
            ctl_error_set(&error, PCCD_E_FORMAT, "%s: its head is none", certificate);
    } else if (status == PCCD_OK && with >= files->count) {
        status = ctl_error_set(&error, PCCD_E_INVAL,
                               "name the files of %s behind it, those of --with last",
                               certificate);
    }
    walk.expected = expected;
    if (status == PCCD_OK) {
        walk.frames = command->check.ask.frames;
        walk.frames.wish.takes_cut = true;
        files->count -= (uint32_t)with;
        command->scene.with = (struct option_arguments){
            .list = files->list + files->count, .count = (uint32_t)with};
        status = walk_all(&walk, &error);
    }
    if (status == PCCD_OK) {
        status = report_all(&walk, &error);
    }
    if (status == PCCD_OK) {
        status = check_lines_end(&walk.lines, &error);
    }
    uint32_t different = walk.lines.different;
    if (status == PCCD_OK && different == 0) {
        printf("PASS       all %" PRIu32 " lines are the same", walk.lines.number);
        judge_print_part(stdout, &walk.judge.part, "; they are of ");
        putchar('\n');
    } else if (status == PCCD_OK) {
        printf("FAIL       %" PRIu32 " %s, the first of which are told above\n",
               different, proto_plural(different, "difference", "differences"));
    }
    walk_deinit(&walk);
    json_decref(expected);
    command->scene.with = (struct option_arguments){.list = NULL};
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    return (int)ctl_exit_of(status, different == 0);
}
