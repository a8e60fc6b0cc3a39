/* check.c - pccd-mpi check. */
#include <inttypes.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "check_run.h"
#include "clock.h"
#include "ctl.h"
#include "judge.h"
#include "output.h"
#include "part.h"
#include "pccd_mpi.h"
#include "process_status.h"
#include "sequence.h"
#include "together.h"

struct mpi_options {
    struct check_options check;
    struct pccd_mpi_options world;
    bool tells_shares;
};

#define AT(member) offsetof(struct mpi_options, member)
const struct option_table program_table_check = {
    .rows =
        (const struct option_row[]){
            CTL_OUTPUT,
            {"shares", 0, NULL,
             "Tell on the standard error what each rank had in the last step",
             OPTION_FLAG, .at = AT(tells_shares)},
            CTL_ENGINE,
            {"timeout", 0, "MS",
             "Give up waiting for another rank after MS milliseconds (default: 60000)",
             OPTION_U32, .at = AT(world.timeout_ms), .min = 1, .max = 3600000},
            {0}},
    .parts = (const struct option_part[]){{&check_table, AT(check)},
                                          {&ctl_common_table, 0},
                                          {0}},
    .arguments = "MESH_T0 MESH_T1 [MESH_T2...]",
    .text = "Find every contact of a mesh that moves linearly from MESH_T0 to MESH_T1, "
            "then to MESH_T2 and so on, by all ranks of an MPI program. Files, options, "
            "output and exit status are those of pccdctl check; every rank has to be "
            "able to read the files.",
    .examples = "  mpirun -n 4 pccd-mpi check a.ply b.ply\n"};

/* Everything that lives while the frames are walked through. */
struct check {
    const struct mpi_options *options;
    struct pccd_mpi *world;
    struct check_run run; /* its client stays NULL */
    struct contacts_csv csv;
    struct part part;
    struct objects objects; /* on the root */
    struct report_object told;
    uint32_t object;
    struct ctl_mesh frames[2]; /* before and after the step, by turns: this rank's part */
    struct report_step *steps; /* [part.files.count - 1] */
    uint32_t number;           /* of the step, from 1 */
    struct pccd_contact first; /* this rank's earliest one of it; toi above 1: none */
    bool is_judged;            /* the ends of steps are looked at, too */
    struct judge_ends ends;
    struct judge judge;
    FILE *report;
};

static int fail(const struct check *check, int status, struct ctl_error *error)
{
    return ctl_error_set(error, status, "%s", pccd_mpi_error_text(check->world));
}

/* ---- frames ----------------------------------------------------------------------- */

/* Read frame `index` beside the one before, and let both have one format. */
static int read_frame(struct check *check, uint32_t index, struct ctl_error *error)
{
    struct ctl_mesh *frame = &check->frames[index % 2];
    struct ctl_mesh *before = &check->frames[(index + 1) % 2];
    int status = part_read(&check->part, index, frame, error);
    if (status == PCCD_OK && index > 0 && before->format != frame->format) {
        status = ctl_mesh_promote(before, error);
        if (status == PCCD_OK) {
            status = ctl_mesh_promote(frame, error);
        }
    }
    return together_agree(status, error);
}

/* Return whether the report tells which objects meet. */
static bool tells_objects(const struct check *check)
{
    return check->part.files.mesh.object_count > 0 &&
           check->options->check.settings.mode != PCCD_MODE_ANY;
}

/* On the root: names of objects, and of features those of the whole mesh. */
static int begin_names(struct check *check, struct ctl_error *error)
{
    struct part *part = &check->part;
    const struct ctl_mesh *named =
        part->named.path != NULL ? &part->named : &part->files.mesh;
    int status = PCCD_OK;
    if (tells_objects(check)) {
        check->run.objects = &check->objects;
    }
    status = objects_add(&check->objects, "",
                         &(struct objects_of){.handle = check->object,
                                              .mesh = named,
                                              .edges = part->edges,
                                              .edge_count = part->edge_count},
                         error);
    check->run.told.names = check->objects.names;
    if (status == PCCD_OK && check->options->check.ask.csv != NULL) {
        check->csv.has_step = part->files.count > 2;
        check->csv.has_names = tells_objects(check);
        check->csv.objects = &check->objects;
        check->csv.path = check->options->check.ask.csv;
        status = contacts_csv_open(&check->csv, error);
    }
    return status;
}

/* ---- steps ------------------------------------------------------------------------ */

static int begin(struct check *check, struct ctl_error *error)
{
    const struct pccd_object_settings *object = &check->options->check.ask.object;
    uint32_t mesh = 0;
    uint64_t begin_ns = common_now_ns();
    int status = together_agree(check_run_times(&check->run, error), error);
    if (status != PCCD_OK) {
        return status;
    }
    const struct pccd_mpi_part part = part_to_put(&check->part, &check->frames[0]);
    status = pccd_mpi_mesh_put(check->world, &part, &mesh, &check->told.info);
    if (status == PCCD_OK) {
        status = pccd_mpi_add(check->world, mesh, &check->object);
    }
    if (status == PCCD_OK && object->what != 0) {
        status = pccd_mpi_object_set(check->world, check->object, object);
    }
    check->run.told.build_ms = (double)(common_now_ns() - begin_ns) / 1e6;
    return status == PCCD_OK ? PCCD_OK : fail(check, status, error);
}

/* Make the step for check_run_repeat: the answer without its records, which stay here
 * until the next step. */
static int move_once(void *context, bool is_again, struct pccd_answer *answer)
{
    struct check *check = context;
    const struct ctl_mesh *after = &check->frames[check->number % 2];
    const struct ctl_mesh *before = &check->frames[(check->number + 1) % 2];
    const struct pccd_motion motion = {.object = check->object,
                                       .count = after->vertex_count,
                                       .format = after->format,
                                       .x0 = is_again ? before->x : NULL,
                                       .x1 = after->x};
    int status = pccd_mpi_step(check->world, &motion, 1, &check->run.settings, answer);
    check->first.toi = INFINITY;
    if (status == PCCD_OK) {
        check_run_find_first(answer, &check->first);
    }
    answer->contacts = NULL;
    answer->pairs = NULL;
    answer->count = 0;
    return status;
}

/* Records that were gathered. A return other than 0 ends that: there was no memory. */
static int take_records(void *context, const void *records, uint64_t count)
{
    struct check *check = context;
    struct pccd_answer page = {.count = count};
    if (check->run.settings.mode == PCCD_MODE_PAIRS) {
        page.pairs = records;
    } else {
        page.contacts = records;
    }
    if (check->options->check.ask.csv != NULL) {
        contacts_csv_page(&check->csv, check->number, &page);
    }
    return check->run.objects == NULL || objects_count(&check->objects, &page) ? 0 : -1;
}

/* All records, to the root, if it shows them or the objects that they are of. */
static int show(struct check *check, struct report_step *step, struct ctl_error *error)
{
    int status = PCCD_OK;
    if (check->options->check.ask.csv != NULL || tells_objects(check)) {
        status = pccd_mpi_gather(check->world, 0, take_records, check);
    }
    if (status != PCCD_OK) {
        return fail(check, status, error);
    }
    if (check->run.objects != NULL) {
        status = objects_take(&check->objects, step, error);
    }
    return together_agree(status, error);
}

/* ---- the ends of steps ------------------------------------------------------------- */

struct crossing_ask {
    struct check *check;
    struct crossings *to;
};

static int take_crossings(void *context, const void *records, uint64_t count)
{
    const struct pccd_answer page = {.near = records, .count = count};
    return crossings_take(context, &page) ? 0 : -1;
}

static int cross_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct crossing_ask *ask = context;
    const struct pccd_near_settings settings =
        crossings_question(&ask->check->run.settings);
    (void)is_again;
    int status = pccd_mpi_near(ask->check->world, NULL, 0, &settings, answer);
    if (status == PCCD_OK) {
        status = pccd_mpi_gather(ask->check->world, 0, take_crossings, ask->to);
    }
    answer->near = NULL;
    answer->count = 0;
    return status;
}

/* Have what crosses, which the root has, on every rank: all go on by it. */
static int share_crossings(struct crossings *to, struct ctl_error *error)
{
    uint64_t count = to->count;
    together_tell(&count, sizeof count);
    if (!together_is_root()) {
        struct crossing *of = realloc(to->of, (count + 1) * sizeof *of);
        to->of = of != NULL ? of : to->of;
        to->room = of != NULL ? count : to->room;
        to->count = of != NULL ? count : 0;
    }
    int status =
        together_agree(to->count == count ? PCCD_OK
                                          : ctl_error_set(error, PCCD_E_NOMEM,
                                                          "no memory for what crosses"),
                       error);
    if (status == PCCD_OK && count > 0) {
        together_tell(to->of, count * sizeof *to->of);
    }
    return status;
}

/* Ask what crosses where the step has ended. */
static int ask_crossings(void *context, struct crossings *to, struct ctl_error *error)
{
    struct check *check = context;
    struct check_run once = check->run;
    struct report_step step = {.repeats = 0};
    struct crossing_ask asking = {check, to};
    const struct check_ask ask = {
        .once = cross_once, .failed = "what crosses was not told", .context = &asking};
    once.repeats = 0;
    to->count = 0;
    int status = check_run_repeat(&once, &ask, 1, &step, error);
    if (status != PCCD_OK) {
        return pccd_mpi_error_text(check->world)[0] != '\0' ? fail(check, status, error)
                                                            : status;
    }
    crossings_sort(to);
    to->is_complete = step.is_complete;
    to->ms = step.ms[REPORT_step];
    return share_crossings(to, error);
}

/* Return whether lines are told of each step, by this rank. */
static bool is_told(const struct check *check)
{
    return check->part.files.count > 2 && !check->options->check.ask.is_json &&
           together_is_root();
}

static void take_first(struct check *check)
{
    struct judged judged;
    judged_set_first(&judged, check->part.files.names[0], &check->ends.first);
    judge_take(&check->judge, &judged);
    if (is_told(check)) {
        judged_print(check->report, &judged);
    }
}

/* Find what crosses in the first frame. */
static int look_at_first(struct check *check, struct ctl_error *error)
{
    int status = ask_crossings(check, &check->ends.first, error);
    if (status == PCCD_OK) {
        status = together_agree(
            crossings_copy(&check->ends.end, &check->ends.first, error), error);
    }
    if (status == PCCD_OK) {
        take_first(check);
    }
    return status;
}

/* Take what is known of a step, and say so. */
static void take(struct check *check, const struct judged *judged)
{
    judge_take(&check->judge, judged);
    if (is_told(check)) {
        report_print_line(check->report, &check->run.told, judged->number,
                          &judged->report);
        report_print_pairs(check->report, &check->run.told, &judged->report);
        judged_print(check->report, judged);
        (void)fflush(check->report);
    }
}

/* ---- all steps --------------------------------------------------------------------- */

static int make_step(struct check *check, struct judged *judged, struct ctl_error *error)
{
    struct report_step *step = &judged->report;
    const struct check_ask ask = {
        .once = move_once, .failed = "the step failed", .context = check};
    int status = check_run_repeat(&check->run, &ask, check->number, step, error);
    if (status != PCCD_OK) {
        return pccd_mpi_error_text(check->world)[0] != '\0' ? fail(check, status, error)
                                                            : status;
    }
    status = show(check, step, error);
    if (status == PCCD_OK) {
        const struct ctl_mesh *const frames[2] = {&check->frames[(check->number + 1) % 2],
                                                  &check->frames[check->number % 2]};
        status = first_find(check->world, &check->first, frames, check->run.objects,
                            &step->first, error);
    }
    judged_set(judged, check->run.told.names);
    return status == PCCD_OK && check->is_judged
               ? judge_ends_look(&check->ends, &check->run, check->number, step, error)
               : status;
}

static int walk(struct check *check, struct ctl_error *error)
{
    const uint32_t step_count = check->part.files.count - 1;
    int status = check->is_judged ? look_at_first(check, error) : PCCD_OK;
    for (uint32_t i = 1; i <= step_count && status == PCCD_OK; i++) {
        struct judged judged = {.number = i};
        judged.report.from = check->part.files.names[i - 1];
        judged.report.to = check->part.files.names[i];
        check->number = i;
        if (i > 1) {
            status = read_frame(check, i, error);
        }
        if (i == step_count) {
            part_drop_rows(&check->part);
        }
        if (status == PCCD_OK) {
            status = make_step(check, &judged, error);
        }
        check->steps[i - 1] = judged.report;
        if (status == PCCD_OK) {
            take(check, &judged);
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

static void print_mesh(const struct check *check)
{
    const bool is_json = check->options->check.ask.is_json;
    if (together_is_root() && !is_json) {
        report_print_scene(check->report, &check->run.told);
    }
    if (together_is_root()) {
        report_print_notes(is_json ? stderr : check->report, &check->part.files);
    }
}

static int check_together(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->check.ask;
    int status = read_frame(check, 0, error);
    if (status == PCCD_OK) {
        status = read_frame(check, 1, error);
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
    status = begin(check, error);
    if (status == PCCD_OK) {
        status = together_agree(together_is_root() ? begin_names(check, error) : PCCD_OK,
                                error);
    }
    if (status != PCCD_OK) {
        return status;
    }
    print_mesh(check);
    return walk(check, error);
}

/* The files, and a place for each step. */
static int open_files(struct check *check, struct ctl_error *error)
{
    const struct ask_options *ask = &check->options->check.ask;
    const struct ctl_frames *files = &check->part.files;
    const struct part_options options = {
        .frames = ask->frames,
        .names_features = ask->csv != NULL,
        .names_objects = check->options->check.settings.mode != PCCD_MODE_ANY};
    int status =
        part_open(&check->part, ask->files.list, ask->files.count, &options, error);
    if (together_is_root()) {
        ctl_sequence_warn(&files->sequence);
    }
    if (status == PCCD_OK && files->count < 2) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "%s is one frame: a step has two, before and after it",
                             files->names[0]);
    }
    if (status != PCCD_OK) {
        return status;
    }
    uint32_t default_repeats = files->count == 2 ? 1 : 0;
    check->run.repeats = ask->has_repeats ? ask->repeats : default_repeats;
    check->steps = calloc(files->count - 1, sizeof *check->steps);
    status = check->steps == NULL ? ctl_error_set(error, PCCD_E_NOMEM, "out of memory")
                                  : PCCD_OK;
    return together_agree(status, error);
}

static int check_all(struct check *check, struct ctl_error *error)
{
    int status = open_files(check, error);
    if (status != PCCD_OK) {
        return status;
    }
    const struct check_options *options = &check->options->check;
    check->run.settings = check_step_settings(options);
    check->judge.is_thick =
        options->settings.separation > 0 || options->ask.object.radius > 0;
    check->ends.ask = ask_crossings;
    check->ends.context = check;
    check->is_judged = check->part.files.count > 2;
    check->run.settings.tells_start =
        !check->is_judged || check->run.settings.approach > 0;
    check->told = (struct report_object){.path = options->ask.files.list[0],
                                         .files = &check->part.files,
                                         .welded = check->part.files.welded};
    check->run.told = (struct report_scene){.objects = &check->told,
                                            .object_count = 1,
                                            .object_what = options->ask.object.what};
    return check_together(check, error);
}

static int report_all(struct check *check, struct ctl_error *error)
{
    const bool is_json = check->options->check.ask.is_json;
    uint32_t step_count = check->part.files.count - 1;
    if (is_json && !report_json(check->report, &check->run.told, check->steps, step_count,
                                step_count > 1 ? judge_line(&check->judge) : NULL)) {
        return ctl_error_set(error, PCCD_E_SYSTEM,
                             "the JSON report could not be written");
    }
    if (!is_json && step_count == 1) {
        report_print_step(check->report, &check->run.told, &check->steps[0]);
    }
    if (!is_json) {
        judge_print(check->report, &check->judge, "verdict");
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
    struct ctl_error error = {.text = ""};
    struct check check = {.options = options,
                          .report = ask_report_to(&options->check.ask)};
    bool is_free = true;
    int status = check_all(&check, &error);
    const uint32_t step_count = check.steps != NULL ? check.part.files.count - 1 : 0;
    if (status == PCCD_OK && options->tells_shares) {
        tell_shares(&check);
    }
    if (status == PCCD_OK && together_is_root()) {
        status = report_all(&check, &error);
    }
    int closed =
        output_close(&check.csv.whole, check.csv.path, status == PCCD_OK, &error);
    status = status == PCCD_OK ? closed : status;
    if (status == PCCD_OK && together_is_root()) {
        status = judge_end(&check.judge, &is_free, &error);
    }
    together_complain(&error);
    status = (int)ctl_exit_of(status, is_free);
    together_tell(&status, sizeof status);
    check.run.told.objects = NULL; /* check.told */
    check_run_deinit(&check.run);
    pccd_mpi_close(check.world);
    ctl_mesh_deinit(&check.frames[0]);
    ctl_mesh_deinit(&check.frames[1]);
    for (uint32_t i = 0; i < step_count; i++) {
        free(check.steps[i].pairs);
    }
    free(check.steps);
    objects_deinit(&check.objects);
    judge_ends_deinit(&check.ends);
    part_close(&check.part);
    return status;
}

int program_check(int argc, char **argv)
{
    struct mpi_options options = {.check.settings = PCCD_STEP_SETTINGS_INIT,
                                  .world.struct_bytes = sizeof options.world};
#ifdef __GLIBC__ /* as the daemon does: what is freed goes back */
    (void)mallopt(M_MMAP_THRESHOLD, 256 << 10);
#endif
    int status = together_parse(&program_table_check, argc, argv, &options);
    return status == CTL_DONE ? run_check(&options) : status;
}
