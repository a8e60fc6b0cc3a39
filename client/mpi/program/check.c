/* check.c - pccd-mpi check.
 *
 * Room:     client/mpi/program.
 * Does:     reads frames of a mesh, of which each rank keeps a slice; has each step
 *           answered by all ranks; the root reports as pccdctl check does.
 * Threads:  one.
 * Source:   client/ctl/commands/cmd_check.c.
 */
#include <inttypes.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "check_apart.h"
#include "check_options.h"
#include "check_run.h"
#include "clock.h"
#include "commands.h"
#include "ctl.h"
#include "items.h"
#include "part.h"
#include "pccd_mpi.h"
#include "process_status.h"
#include "sequence.h"
#include "shown.h"
#include "together.h"

enum { OPTION_TIMEOUT = 256 + 24, OPTION_SHARES, OPTION_DEAL };

struct mpi_options {
    struct check_options check;
    struct pccd_mpi_options world;
    bool tells_shares;
    bool is_dealt;
    const char *results;
};

static const struct argp_option option_list[] = {
    {"timeout", OPTION_TIMEOUT, "MS", 0,
     "Give up waiting for another rank after MS milliseconds (default: 60000)", 0},
    {"shares", OPTION_SHARES, NULL, 0,
     "Tell on the standard error what each rank had in the last step", 0},
    {"deal", OPTION_DEAL, NULL, 0,
     "Have each step computed by one rank alone, many steps at a time", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct mpi_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->check;
        state->child_inputs[1] = &options->results;
        return 0;
    case OPTION_TIMEOUT:
        options->world.timeout_ms =
            (int)ctl_option_count(state, "timeout", text, 1, 3600000);
        return 0;
    case OPTION_SHARES:
        options->tells_shares = true;
        return 0;
    case OPTION_DEAL:
        options->is_dealt = true;
        return 0;
    case ARGP_KEY_END:
        const struct ctl_frames_options *frames = &options->check.ask.frames;
        if (frames->wish.rate > 0 || frames->wish.animation != NULL) {
            tool_misused(state, "--rate, --animation: over ranks a file is one frame");
        }
        if (frames->weld > 0) {
            tool_misused(state, "--weld: over ranks no vertices are joined");
        }
        if (!options->is_dealt && options->results != NULL) {
            tool_misused(state, "--results wants --deal");
        }
        if (options->is_dealt &&
            (options->tells_shares || options->check.ask.csv != NULL)) {
            tool_misused(state, "--deal excludes --contacts and --shares");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&check_options_argp, 0, NULL, 0},
                                             {&items_argp, 0, NULL, 0},
                                             {&ctl_common_argp, 0, NULL, 0},
                                             {0}};
const struct argp program_argp_check = {
    .options = option_list,
    .parser = parse,
    .args_doc = "MESH_T0 MESH_T1 [MESH_T2...]",
    .doc = "Find every contact of a mesh that moves linearly from MESH_T0 to MESH_T1, "
           "then to MESH_T2 and so on, by all ranks of an MPI program. Files, options, "
           "output and exit status are those of pccdctl check; every rank has to be able "
           "to read the files. --quality and --rebuild-ratio change nothing here.",
    .children = children};

/* Everything that lives while the frames are walked through. */
struct check {
    const struct mpi_options *options;
    struct pccd_mpi *world;
    struct check_run run; /* its client stays NULL */
    struct contacts_csv csv;
    uint32_t object;
    /* This rank's parts. The shape is that of both, and kept once, while a frame comes
     * that is to have it, too. */
    struct ctl_mesh before, after;
    struct report_step *steps; /* [path_count - 1] */
    uint32_t number;           /* of the step, from 1 */
    FILE *report;
};

static int fail(const struct check *check, int status, struct ctl_error *error)
{
    return ctl_error_set(error, status, "%s", pccd_mpi_error_text(check->world));
}

/* ---- frames ----------------------------------------------------------------------- */

/* Read a frame; it has one format with the one before. */
static int read_after(struct check *check, uint32_t index, struct ctl_error *error)
{
    char **paths = check->options->check.ask.paths;
    int status = part_read(paths[index], &check->before, &check->after, error);
    if (status == PCCD_OK && check->before.format != check->after.format) {
        status = ctl_mesh_promote(&check->before, error);
        if (status == PCCD_OK) {
            status = ctl_mesh_promote(&check->after, error);
        }
    }
    ctl_mesh_drop_shape(&check->after);
    return together_agree(status, error);
}

static void keep_frame(struct check *check)
{
    free(check->before.x);
    check->before.x = check->after.x;
    check->before.format = check->after.format;
    check->before.path = check->after.path;
    check->after = (struct ctl_mesh){.x = NULL};
}

/* Names of features are those of the whole mesh, which the root reads once more. */
static int open_csv(struct check *check, struct ctl_error *error)
{
    struct ctl_mesh whole = {0};
    int status = part_read_whole(check->options->check.ask.paths[0], &whole,
                                 &check->run.edges, error);
    if (status == PCCD_OK) {
        check->csv.triangles = (const uint32_t(*)[3])whole.triangles.vertices;
        whole.triangles.vertices = NULL; /* it is the CSV's now */
        check->csv.edges = check->run.edges;
        check->csv.has_step = check->options->check.ask.path_count > 2;
        check->csv.path = check->options->check.ask.csv;
        status = contacts_csv_open(&check->csv, error);
    }
    ctl_mesh_deinit(&whole);
    return status;
}

/* ---- steps ------------------------------------------------------------------------ */

static int begin(struct check *check, struct ctl_error *error)
{
    const struct pccd_object_settings *object = &check->options->check.ask.object;
    uint32_t mesh = 0;
    uint64_t begin_ns = common_now_ns();
    int status = check_run_times(&check->run, error);
    if (status != PCCD_OK) {
        return status;
    }
    const struct pccd_mpi_part part = part_to_put(&check->before);
    status = pccd_mpi_mesh_put(check->world, &part, &mesh, &check->run.mesh.info);
    if (status == PCCD_OK) {
        status = pccd_mpi_add(check->world, mesh, &check->object);
    }
    if (status == PCCD_OK && object->what != 0) {
        status = pccd_mpi_object_set(check->world, check->object, object);
    }
    check->run.mesh.build_ms = (double)(common_now_ns() - begin_ns) / 1e6;
    return status == PCCD_OK ? PCCD_OK : fail(check, status, error);
}

/* What check_run_repeat asks for: the answer without its records, which stay here until
 * the next step. */
static int move_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct check *check = context;
    const struct pccd_motion motion = {.object = check->object,
                                       .count = check->after.vertex_count,
                                       .format = check->after.format,
                                       .x0 = is_again ? check->before.x : NULL,
                                       .x1 = check->after.x};
    int status = pccd_mpi_step(check->world, &motion, 1, &check->run.settings, answer);
    answer->contacts = NULL;
    answer->pairs = NULL;
    answer->count = 0;
    return status;
}

/* Records that were gathered, to the CSV. */
static int write_records(void *context, const void *records, uint64_t count)
{
    const struct check *check = context;
    struct pccd_answer page = {.count = count};
    if (check->run.settings.mode == PCCD_MODE_PAIRS) {
        page.pairs = records;
    } else {
        page.contacts = records;
    }
    contacts_csv_page(&check->csv, check->number, &page);
    return 0;
}

static int make_step(struct check *check, struct ctl_error *error)
{
    const struct check_ask ask = {
        .once = move_once, .failed = "the step failed", .context = check};
    struct report_step *step = &check->steps[check->number - 1];
    int status = check_run_repeat(&check->run, &ask, check->number, step, error);
    if (status != PCCD_OK) {
        return pccd_mpi_error_text(check->world)[0] != '\0' ? fail(check, status, error)
                                                            : status;
    }
    if (check->options->check.ask.csv != NULL) {
        status = pccd_mpi_gather(check->world, 0, write_records, check);
    }
    return status == PCCD_OK ? PCCD_OK : fail(check, status, error);
}

static int walk(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->check.ask;
    int status = PCCD_OK;
    for (uint32_t i = 1; i < ask->path_count && status == PCCD_OK; i++) {
        struct report_step *step = &check->steps[i - 1];
        step->from = ask->paths[i - 1];
        step->to = ask->paths[i];
        check->number = i;
        if (i > 1) {
            keep_frame(check);
            status = read_after(check, i, error);
        }
        if (i + 1 == ask->path_count) {
            ctl_mesh_drop_shape(&check->before);
        }
        if (status == PCCD_OK) {
            status = make_step(check, error);
        }
        if (status == PCCD_OK && ask->path_count > 2 && !ask->is_json &&
            together_is_root()) {
            report_print_line(check->report, i, step);
        }
    }
    if (status != PCCD_OK && check->number > 1) {
        struct ctl_error why = *error;
        (void)ctl_error_set(error, status, "%.900s; step %" PRIu32 " was the last one",
                            why.text, check->number - 1);
    }
    return status;
}

/* ---- the command ------------------------------------------------------------------ */

static int check_all(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->check.ask;
    int status =
        together_agree(part_read(ask->paths[0], NULL, &check->before, error), error);
    if (status == PCCD_OK) {
        status = read_after(check, 1, error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    struct pccd_mpi_options world = check->options->world;
    world.result_bytes = ask->link.result_bytes;
    status = pccd_mpi_open(MPI_COMM_WORLD, &world, &check->world);
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "%s", pccd_mpi_error_text(NULL));
    }
    check->run.settings = check_step_settings(&check->options->check);
    check->run.mesh.settings = check->options->check.scene_settings;
    check->run.mesh.object_what = ask->object.what;
    status = begin(check, error);
    if (status != PCCD_OK) {
        return status;
    }
    if (ask->csv != NULL) {
        status =
            together_agree(together_is_root() ? open_csv(check, error) : PCCD_OK, error);
    }
    if (status == PCCD_OK && !ask->is_json && together_is_root()) {
        report_print_mesh(check->report, &check->run.mesh);
    }
    return status == PCCD_OK ? walk(check, error) : status;
}

/* All steps, each by one rank. */
static int check_dealt(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->check.ask;
    int status =
        check_apart(&check->options->check, check->run.repeats, check->options->results,
                    &check->run.mesh, check->steps, error);
    if (status != PCCD_OK || ask->is_json || !together_is_root()) {
        return status;
    }
    report_print_mesh(check->report, &check->run.mesh);
    for (uint32_t i = 1; i < ask->path_count && ask->path_count > 2; i++) {
        report_print_line(check->report, i, &check->steps[i - 1]);
    }
    return PCCD_OK;
}

static int report_all(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->check.ask;
    uint32_t step_count = ask->path_count - 1;
    if (ask->is_json &&
        !report_json(check->report, &check->run.mesh, check->steps, step_count)) {
        return ctl_error_set(error, PCCD_E_SYSTEM,
                             "the JSON report could not be written");
    }
    if (!ask->is_json && step_count == 1) {
        report_print_step(check->report, &check->run.mesh, &check->steps[0]);
    }
    return PCCD_OK;
}

/* A line of each rank, in turn. */
static void tell_shares(const struct check *check)
{
    const double most_mb =
        (double)common_process_status((long)getpid(), "VmHWM:") * 1024 / 1e6;
    struct pccd_mpi_share share = {.struct_bytes = sizeof share};
    int status = pccd_mpi_get_share(check->world, &share);
    for (int r = 0; r < together_size(); r++) {
        MPI_Barrier(MPI_COMM_WORLD);
        if (r == together_rank() && status == PCCD_OK) {
            fprintf(stderr,
                    "rank %d: own %" PRIu64 ", ghosts %" PRIu64 ", own vertices %" PRIu64
                    ", ghost vertices %" PRIu64 ", sent %" PRIu64 " bytes, work %" PRIu64
                    ", imbalance %.3f, memory %.0f MB at most, cuts %" PRIu64
                    ", searches %" PRIu64 "\n",
                    r, share.own, share.ghosts, share.own_vertices, share.ghost_vertices,
                    share.sent_bytes, share.work, share.imbalance, most_mb, share.cuts,
                    share.searches);
            fflush(stderr);
        }
    }
}

static int run_check(const struct mpi_options *options)
{
    const struct ask_options *ask = &options->check.ask;
    struct ctl_error error = {.text = ""};
    struct check check = {.options = options, .report = ask_report_to(ask)};
    bool is_free = true;
    uint32_t default_repeats = ask->path_count == 2 ? 1 : 0;
    check.run.repeats = ask->has_repeats ? ask->repeats : default_repeats;
    check.steps = calloc(ask->path_count - 1, sizeof *check.steps);
    int status = check.steps == NULL
                     ? ctl_error_set(&error, PCCD_E_NOMEM, "out of memory")
                     : PCCD_OK;
    status = together_agree(status, &error);
    if (status == PCCD_OK) {
        status =
            options->is_dealt ? check_dealt(&check, &error) : check_all(&check, &error);
    }
    if (status == PCCD_OK && options->tells_shares) {
        tell_shares(&check);
    }
    if (status == PCCD_OK && together_is_root()) {
        status = report_all(&check, &error);
    }
    int closed = contacts_csv_close(&check.csv, status == PCCD_OK, &error);
    status = status == PCCD_OK ? closed : status;
    if (status == PCCD_OK && together_is_root()) {
        status = check_run_judge(check.steps, ask->path_count - 1, &is_free, &error);
    }
    together_complain(&error);
    status = (int)ctl_exit_of(status, is_free);
    together_tell(&status, sizeof status);
    check_run_deinit(&check.run);
    pccd_mpi_close(check.world);
    ctl_mesh_deinit(&check.before);
    ctl_mesh_deinit(&check.after);
    free((void *)(uintptr_t)check.csv.triangles);
    free(check.steps);
    return status;
}

/* Whether a file is one frame: parts of others are not read. */
static int judge_file(const char *path, struct ctl_error *error)
{
    enum ctl_mesh_holds holds = ctl_mesh_holds(path);
    struct ctl_motion motion = {.frame_count = 1};
    int status = holds == CTL_HOLDS_BOTH
                     ? ctl_mesh_open_motion(path, NULL, &motion, error)
                     : PCCD_OK;
    bool has_more = holds == CTL_HOLDS_POSITIONS || motion.frame_count > 1;
    if (motion.close != NULL) {
        motion.close(&motion);
    }
    return status != PCCD_OK || !has_more
               ? status
               : ctl_error_set(error, PCCD_E_FORMAT,
                               "%s has several frames: ranks read a file for each; "
                               "pccdctl check reads it",
                               path);
}

/* The files of the frames. Every rank looks for itself, and has as many. */
static int list_files(const struct ask_options *ask, struct ctl_sequence *files,
                      struct ctl_error *error)
{
    int status = ctl_sequence_expand(files, ask->paths, ask->path_count, error);
    for (uint32_t i = 0; i < files->count && status == PCCD_OK; i++) {
        status = judge_file(files->paths[i], error);
    }
    if (status == PCCD_OK && files->count < 2) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s is one frame: a step has two, before and after it",
                               files->paths[0]);
    }
    status = together_agree(status, error);
    uint32_t count = files->count;
    together_tell(&count, sizeof count);
    if (status == PCCD_OK && count != files->count) {
        status = ctl_error_set(error, PCCD_E_STATE,
                               "%" PRIu32 " files, and %" PRIu32 " on rank 0",
                               files->count, count);
    }
    if (together_is_root()) {
        ctl_sequence_warn(files);
    }
    return together_agree(status, error);
}

static int run_files(struct mpi_options *options)
{
    struct ask_options *ask = &options->check.ask;
    char **given = ask->paths;
    struct ctl_sequence files;
    struct ctl_error error = {.text = ""};
    int status = list_files(ask, &files, &error);
    together_complain(&error);
    if (status == PCCD_OK) {
        ask->paths = files.paths;
        ask->path_count = files.count;
        status = run_check(options);
        ask->paths = given;
    } else {
        status = (int)ctl_exit_of(status, true);
    }
    ctl_sequence_deinit(&files);
    return status;
}

int program_check(int argc, char **argv)
{
    struct mpi_options options = {.check.settings = PCCD_STEP_SETTINGS_INIT,
                                  .world.struct_bytes = sizeof options.world};
    struct ask_options *ask = &options.check.ask;
#ifdef __GLIBC__ /* as the daemon does: what is freed goes back */
    (void)mallopt(M_MMAP_THRESHOLD, 256 << 10);
#endif
    ask->paths = malloc((size_t)argc * sizeof *ask->paths);
    if (ask->paths == NULL) {
        return CTL_FAILED;
    }
    int status = together_parse(&program_argp_check, argc, argv, &options);
    if (status == CTL_DONE) {
        status = run_files(&options);
    }
    ask_options_deinit(ask);
    return status;
}
