/* cmd_near.c - pccdctl near. */
#include "ctl.h"
#include "near_run.h"
#include "shown.h"

struct command {
    struct near_options near;
    struct scene_options scene;
};

#define AT(member) offsetof(struct command, member)
const struct option_table ctl_table_near = {
    .parts = (const struct option_part[]){{&near_table, AT(near)},
                                          {&scene_table, AT(scene)},
                                          {&ctl_link_table, AT(near.ask.link)},
                                          {0}},
    .arguments = "MESH [MESH...]\nSCENE",
    .text = "Tell what is near where meshes stand: pairs within a distance, the "
            "nearest pair of each two, edges that pass through faces, or how deep "
            "one mesh is in another. Each file, PLY, OBJ, STL or glTF, is an object "
            "of its own. Objects are compared with each other, and each with itself "
            "except for features that share a vertex.",
    .more =
        "Without --url, --socket and $PCCD_URL a private daemon is started. CSV "
        "columns: kind,type,a,b,i0,i1,i2,i3,i4,d_lo,d_hi,count,u,v,nx,ny,nz,x,y,z; of "
        "vertices object,vertex,bound. Exit status: 0 when done (the report says "
        "what was found, and whether the answer is complete), 2 after wrong "
        "usage, 3 without a daemon, 4 after any other error.",
    .examples = "  pccdctl near --distance 0.01 a.obj b.obj\n"
                "  pccdctl near --what depth a.stl b.stl\n",
};

/* Return E_INVAL where no two objects are asked about, or one and itself are. */
static int need_two(const struct scene *scene, const struct option_arguments *between,
                    struct ctl_error *error)
{
    if (scene->object_count < 2) {
        return ctl_error_set(error, PCCD_E_INVAL,
                             "--what nearest: two objects at least, and this is one");
    }
    for (uint32_t i = 0; i < scene->object_count && between->count > 0; i++) {
        if (scene->objects[i].settings.self_collision) {
            return ctl_error_set(error, PCCD_E_INVAL,
                                 "--between: nearest is of two objects, and \"%s\" is "
                                 "one",
                                 tool_shown(scene->objects[i].name));
        }
    }
    return PCCD_OK;
}

/* Read before a daemon is asked for: a bad file costs nothing else. */
static int read_scene(struct near_run *near, const struct command *command,
                      struct ctl_error *error)
{
    const struct ask_options *asked = &command->near.ask;
    struct scene *scene = &near->scene;
    int status = scene_take(scene, &asked->files, true, &command->scene, error);
    if (status == PCCD_OK && command->near.settings.what == PCCD_NEAR_NEAREST) {
        status = need_two(scene, &command->scene.between, error);
    }
    for (uint32_t i = 0; i < scene->object_count; i++) {
        near_options_leave_out_self(&command->near, scene->object_count,
                                    &scene->objects[i].settings);
    }
    if (status == PCCD_OK) {
        status = scene_open(scene, error);
    }
    return status == PCCD_OK ? scene_read(scene, 0, error) : status;
}

static int ask(struct near_run *near, const struct command *command, struct near_csv *csv,
               struct ctl_error *error)
{
    const struct ask_options *asked = &command->near.ask;
    int status = read_scene(near, command, error);
    if (status != PCCD_OK) {
        return status;
    }
    near_report_warn(near);
    if (ctl_link_open(&asked->link, &near->run.client) != CTL_DONE) {
        return ctl_error_set(error, PCCD_E_NODAEMON, "%s", "");
    }
    status = near_csv_open(csv, error);
    if (status == PCCD_OK) {
        status = check_run_begin(&near->run, &near->scene, asked->csv != NULL, error);
    }
    return status == PCCD_OK
               ? near_run_ask(near, asked->csv != NULL ? near_csv_page : NULL, csv, error)
               : status;
}

static int run_near(const struct command *command)
{
    const struct ask_options *asked = &command->near.ask;
    struct ctl_error error = {.text = ""};
    struct ctl_error close_error = {.text = ""};
    struct near_run near = {.run = {.repeats = asked->has_repeats ? asked->repeats : 1},
                            .settings = near_options_settings(&command->near),
                            .scene = {.settings = &asked->object,
                                      .frames = &asked->frames,
                                      .first_alone = true}};
    struct near_csv csv = {.path = asked->csv, .near = &near, .has_place = true};
    FILE *to = ask_report_to(asked);
    int status = ask(&near, command, &csv, &error);
    if (status == PCCD_OK && !asked->is_json) {
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
    struct command command = {.near.settings = PCCD_NEAR_SETTINGS_INIT};
    int status = CTL_USAGE;
    command.near.ask.link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    if (option_parse(&ctl_table_near, argc, argv, &command) == 0) {
        status = run_near(&command);
    }
    scene_options_deinit(&command.scene);
    ctl_link_deinit(&command.near.ask.link);
    return status;
}
