/* near.c - pccd-mpi near. */
#include <stdlib.h>

#include "clock.h"
#include "ctl.h"
#include "near_run.h"
#include "part.h"
#include "pccd_mpi.h"
#include "together.h"

struct mpi_near_options {
    struct near_options near;
    struct pccd_mpi_options world;
};

const struct option_table program_table_near = {
    .rows =
        (const struct option_row[]){
            CTL_ENGINE,
            {"timeout", 0, "MS",
             "Give up waiting for another rank after MS milliseconds (default: 60000)",
             OPTION_U32, .at = offsetof(struct mpi_near_options, world.timeout_ms),
             .min = 1, .max = 3600000},
            {0}},
    .parts = (const struct option_part[]){{&near_table,
                                           offsetof(struct mpi_near_options, near)},
                                          {&ctl_common_table, 0},
                                          {0}},
    .arguments = "MESH [MESH...]",
    .text =
        "Tell what is near where meshes stand, by all ranks of an MPI program. Files, "
        "options, output and exit status are those of pccdctl near, without places "
        "of records; every rank has to be able to read the files.",
    .examples = "  mpirun -n 4 pccd-mpi near --distance 0.01 a.obj b.obj\n"
                "  mpirun -n 4 pccd-mpi near --what nearest --json a.ply b.ply\n"};

struct asking {
    const struct near_options *options;
    struct near_run near; /* its client stays NULL */
    struct part *parts;   /* of its objects */
    struct pccd_mpi *world;
    struct near_csv csv;
    uint64_t written; /* records that are in the CSV */
};

static int fail(const struct asking *asking, int status, struct ctl_error *error)
{
    status = ctl_error_set(error, status, "%s", pccd_mpi_error_text(asking->world));
    scene_name_objects(&asking->near.scene, error);
    return status;
}

/* The first frame of a file, with vertices joined that are at one place there. */
static int read_object(struct asking *asking, uint32_t i, struct ctl_error *error)
{
    const struct ask_options *asked = &asking->options->ask;
    struct part_options options = {.frames = asked->frames,
                                   .names_features = asked->csv != NULL};
    struct scene_object *object = &asking->near.scene.objects[i];
    struct part *part = &asking->parts[i];
    options.frames.first_alone = true;
    int status = part_open(part, object->paths, 1, &options, error);
    if (status == PCCD_OK) {
        status = together_agree(part_read(part, 0, &object->at[0], error), error);
    }
    object->files = part->files; /* the part's to close */
    near_options_leave_out_self(asking->options, asking->near.scene.object_count,
                                &object->settings);
    return status;
}

static int read_objects(struct asking *asking, struct ctl_error *error)
{
    const struct ask_options *asked = &asking->options->ask;
    const struct scene_options none = {.has_no_self = false};
    const uint32_t count = asked->files.count;
    struct near_run *near = &asking->near;
    int status = PCCD_OK;
    if (count == 1 && scene_is_named(asked->files.list[0])) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s is a scene file, which pccdctl near reads",
                               asked->files.list[0]);
    } else {
        asking->parts = calloc(count, sizeof *asking->parts);
        status = asking->parts == NULL
                     ? ctl_error_set(error, PCCD_E_NOMEM, "out of memory")
                     : scene_take(&near->scene, &asked->files, true, &none, error);
    }
    status = together_agree(status, error);
    if (status != PCCD_OK) {
        return status;
    }
    for (uint32_t i = 0; i < count && status == PCCD_OK; i++) {
        status = read_object(asking, i, error);
    }
    if (status == PCCD_OK && together_is_root()) {
        near_report_warn(near);
    }
    return status;
}

static int add_object(struct asking *asking, uint32_t i, struct ctl_error *error)
{
    struct scene_object *object = &asking->near.scene.objects[i];
    const struct pccd_object_settings *settings = &object->settings;
    const struct pccd_mpi_part part = part_to_put(&asking->parts[i], &object->at[0]);
    uint32_t mesh = 0;
    int status = pccd_mpi_mesh_put(asking->world, &part, &mesh, &object->info);
    ctl_mesh_deinit(&object->at[0]);
    part_drop_rows(&asking->parts[i]);
    if (status == PCCD_OK) {
        status = pccd_mpi_add(asking->world, mesh, &object->handle);
    }
    if (status == PCCD_OK && settings->what != 0) {
        status = pccd_mpi_object_set(asking->world, object->handle, settings);
    }
    return status == PCCD_OK ? PCCD_OK : fail(asking, status, error);
}

static int add_objects(struct asking *asking, struct ctl_error *error)
{
    struct near_run *near = &asking->near;
    uint64_t begin_ns = common_now_ns();
    int status = check_run_times(&near->run, error);
    for (uint32_t i = 0; i < near->scene.object_count && status == PCCD_OK; i++) {
        status = add_object(asking, i, error);
    }
    near->scene.build_ms = (double)(common_now_ns() - begin_ns) / 1e6;
    return status == PCCD_OK ? check_run_tell(&near->run, &near->scene, error) : status;
}

/* On the root: the CSV has vertices of edges and faces, which are those of the parts. */
static int open_csv(struct asking *asking, struct ctl_error *error)
{
    struct near_run *near = &asking->near;
    for (uint32_t i = 0; i < near->scene.object_count; i++) {
        near->scene.objects[i].files.mesh.triangles = asking->parts[i].named.triangles;
        near->scene.objects[i].edges = asking->parts[i].edges;
    }
    return near_csv_open(&asking->csv, error);
}

static void close_all(struct asking *asking)
{
    struct near_run *near = &asking->near;
    for (uint32_t i = 0; i < near->scene.object_count; i++) {
        near->scene.objects[i].files = (struct ctl_frames){.count = 0};
        near->scene.objects[i].edges = NULL;
        if (asking->parts != NULL) {
            part_close(&asking->parts[i]);
        }
    }
    free(asking->parts);
    pccd_mpi_close(asking->world);
    near_run_deinit(near);
}

/* Ask the question for check_run_repeat: the answer without its records, which stay here
 * until the next question. */
static int ask_once(void *context, bool is_again, struct pccd_answer *answer)
{
    const struct asking *asking = context;
    (void)is_again;
    int status = pccd_mpi_near(asking->world, NULL, 0, &asking->near.settings, answer);
    answer->near = NULL;
    answer->vertex_bounds = NULL;
    answer->count = 0;
    return status;
}

static int write_records(void *context, const void *records, uint64_t count)
{
    struct asking *asking = context;
    struct pccd_answer page = {.count = count, .first = asking->written};
    if (asking->near.settings.what == PCCD_NEAR_VERTICES) {
        page.vertex_bounds = records;
    } else {
        page.near = records;
    }
    near_csv_page(&asking->csv, &page);
    asking->written += count;
    return 0;
}

static int ask(struct asking *asking, struct ctl_error *error)
{
    const struct check_ask question = {
        .once = ask_once, .failed = "it was not answered", .context = asking};
    int status =
        check_run_repeat(&asking->near.run, &question, 1, &asking->near.step, error);
    if (status != PCCD_OK) {
        return pccd_mpi_error_text(asking->world)[0] != '\0' ? fail(asking, status, error)
                                                             : status;
    }
    if (asking->options->ask.csv != NULL) {
        status = pccd_mpi_gather(asking->world, 0, write_records, asking);
    }
    return status == PCCD_OK ? PCCD_OK : fail(asking, status, error);
}

/* Ask for what touches as pccdctl near does (near_run.h). */
static int ask_touching(struct asking *asking, struct ctl_error *error)
{
    struct near_run *near = &asking->near;
    const struct pccd_near_settings asked = near->settings;
    const struct report_step step = near->step;
    const uint32_t repeats = near->run.repeats;
    struct pccd_near_settings touching;
    if (!near_asks_touching(near, &touching)) {
        return PCCD_OK;
    }
    for (uint32_t i = 0; i < near->scene.object_count; i++) {
        int status = pccd_mpi_object_set(asking->world, near->scene.objects[i].handle,
                                         &near_without_thickness);
        if (status != PCCD_OK) {
            return fail(asking, status, error);
        }
    }
    near->settings = touching;
    near->run.repeats = 0;
    int status = ask(asking, error);
    near->touching = near->step;
    near->has_touching = true;
    near->step = step;
    near->run.repeats = repeats;
    near->settings = asked;
    return status;
}

static int ask_all(struct asking *asking, const struct mpi_near_options *options,
                   struct ctl_error *error)
{
    const struct ask_options *asked = &options->near.ask;
    struct pccd_mpi_options world = options->world;
    int status = read_objects(asking, error);
    if (status != PCCD_OK) {
        return status;
    }
    world.result_bytes = asked->link.result_bytes;
    status = pccd_mpi_open(MPI_COMM_WORLD, &world, &asking->world);
    if (status != PCCD_OK) {
        return ctl_error_set(error, status, "%s", pccd_mpi_error_text(NULL));
    }
    status = add_objects(asking, error);
    if (status == PCCD_OK && asked->csv != NULL) {
        status =
            together_agree(together_is_root() ? open_csv(asking, error) : PCCD_OK, error);
    }
    status = status == PCCD_OK ? ask(asking, error) : status;
    return status == PCCD_OK ? ask_touching(asking, error) : status;
}

static int run_near(const struct mpi_near_options *options)
{
    const struct ask_options *asked = &options->near.ask;
    struct ctl_error error = {.text = ""};
    struct asking asking = {
        .options = &options->near,
        .near = {.run = {.repeats = asked->has_repeats ? asked->repeats : 1},
                 .settings = near_options_settings(&options->near),
                 .scene = {.settings = &asked->object, .frames = &asked->frames}},
        .csv = {.path = asked->csv}};
    FILE *to = ask_report_to(asked);
    asking.csv.near = &asking.near;
    int status = ask_all(&asking, options, &error);
    if (status == PCCD_OK && together_is_root() && !asked->is_json) {
        near_report_print(to, &asking.near);
    } else if (status == PCCD_OK && together_is_root() &&
               !near_report_json(to, &asking.near)) {
        status =
            ctl_error_set(&error, PCCD_E_SYSTEM, "the JSON report could not be written");
    }
    int closed = near_csv_close(&asking.csv, status == PCCD_OK, &error);
    status = status == PCCD_OK ? closed : status;
    together_complain(&error);
    close_all(&asking);
    return (int)ctl_exit_of(status, true);
}

int program_near(int argc, char **argv)
{
    struct mpi_near_options options = {.near.settings = PCCD_NEAR_SETTINGS_INIT,
                                       .world.struct_bytes = sizeof options.world};
    int status = together_parse(&program_table_near, argc, argv, &options);
    return status == CTL_DONE ? run_near(&options) : status;
}
