/* cmd_near.c - pccdctl near. */
#include "ctl.h"
#include "near_run.h"

const struct option_table ctl_table_near = {
    .parts = (const struct option_part[]){{&near_table, 0},
                                          {&ctl_link_table,
                                           offsetof(struct near_options, ask.link)},
                                          {0}},
    .arguments = "MESH [MESH...]",
    .text = "Tell what is near where meshes stand: pairs within a distance, the "
            "nearest pair of each two, edges that pass through faces, or how deep "
            "one mesh is in another. Each file, PLY, OBJ, STL or glTF, is an object "
            "of its own. Objects are compared with each other, and each with itself "
            "except for features that share a vertex.",
    .more = "Without --url, --socket and $PCCD_URL a private daemon is started. CSV "
            "columns: kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz; of "
            "vertices object,vertex,bound. Exit status: 0 when done (the report says "
            "what was found, and whether the answer is complete), 2 after wrong "
            "usage, 3 without a daemon, 4 after any other error.",
    .examples = "  pccdctl near --distance 0.01 a.obj b.obj\n"
                "  pccdctl near --what depth a.stl b.stl\n",
};

static int ask(struct near_run *near, const struct near_options *options,
               struct near_csv *csv, struct ctl_error *error)
{
    const struct ask_options *asked = &options->ask;
    int status = near_run_read(near, asked->files.list, asked->files.count, error);
    if (status != PCCD_OK) {
        return status; /* before a daemon is asked for: a bad file costs nothing else */
    }
    near_report_warn(near);
    if (ctl_link_open(&asked->link, &near->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    status = near_csv_open(csv, error);
    if (status == PCCD_OK) {
        status = near_run_begin(near, asked->csv != NULL, error);
    }
    return status == PCCD_OK
               ? near_run_ask(near, asked->csv != NULL ? near_csv_page : NULL, csv, error)
               : status;
}

static int run_near(const struct near_options *options)
{
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct near_run near = {
        .run = {.ask = &options->ask,
                .repeats = options->ask.has_repeats ? options->ask.repeats : 1},
        .settings = near_options_settings(options)};
    struct near_csv csv = {.path = options->ask.csv, .near = &near};
    FILE *to = ask_report_to(&options->ask);
    int status = ask(&near, options, &csv, &error);
    if (status == PCCD_OK && !options->ask.is_json) {
        near_report_print(to, &near);
    } else if (status == PCCD_OK && !near_report_json(to, &near)) {
        status =
            ctl_error_set(&error, PCCD_E_SYSTEM, "the JSON report could not be written");
    }
    int closed = near_csv_close(&csv, status == PCCD_OK, &close_error);
    pccd_close(near.run.client);
    near_run_deinit(&near);
    return ask_end(status, true, &error, closed, &close_error);
}

int ctl_cmd_near(int argc, char **argv)
{
    struct near_options options = {.settings = PCCD_NEAR_SETTINGS_INIT};
    int status = CTL_USAGE;
    options.ask.link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    if (option_parse(&ctl_table_near, argc, argv, &options) == 0) {
        status = run_near(&options);
    }
    ctl_link_deinit(&options.ask.link);
    return status;
}
