/* cmd_scene.c - pccdctl scene. */
#include <string.h>

#include "ctl.h"
#include "output.h"
#include "scene.h"

struct scene_command {
    const char *path;
    struct option_arguments arguments;
};

static void check(struct argp_state *state, void *to)
{
    const struct scene_command *command = to;
    const char *action = command->arguments.list[0];
    uint32_t is_schema = option_word(state, NULL, action, strlen(action), "new|schema");
    if (is_schema && command->arguments.count > 1) {
        option_misused(state, "schema takes no files");
    }
    if (!is_schema && command->arguments.count == 1) {
        option_misused(state, "new: which files? Each is an object of the scene");
    }
}

#define AT(member) offsetof(struct scene_command, member)
static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = AT(arguments), .needed = "new or schema?"},
    CTL_OUTPUT,
    {"output", 'o', "FILE", "Write there (default: to the standard output)", OPTION_TEXT,
     .at = AT(path)},
    {0}};
#undef AT

const struct option_table ctl_table_scene = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ctl_common_table, 0}, {0}},
    .check = check,
    .arguments = "[new|schema] [FILE...]",
    .text =
        "new: write a scene file, which names meshes and says what they may meet, with "
        "an object for each file or pattern. schema: write its format, as a JSON "
        "Schema.",
    .more =
        "The commands check, near, load, record, render, export and inspect take a "
        "scene file in the place of meshes. In it stand the names of files as they are "
        "given here: keep it in the folder that they count from.",
    .examples = "  pccdctl scene new -o scene.json cloth%d.obj body.glb\n"
                "  pccdctl scene schema\n",
};

int ctl_cmd_scene(int argc, char **argv)
{
    struct scene_command command = {.path = NULL};
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    if (option_parse(&ctl_table_scene, argc, argv, &command) != 0) {
        return CTL_USAGE;
    }
    char **list = command.arguments.list;
    const char *path = command.path != NULL ? command.path : "-";
    int status = output_open(&file, path, true, &error);
    if (status == PCCD_OK) {
        json_t *value = list[0][0] == 's'
                            ? scene_schema()
                            : scene_new(list + 1, command.arguments.count - 1, &error);
        bool is_there = value != NULL;
        if (!output_json(value, is_there, file.to) || !is_there) {
            status = error.text[0] != '\0' ? PCCD_E_INVAL
                                           : ctl_error_set(&error, PCCD_E_SYSTEM,
                                                           "%s: cannot be written", path);
        }
    }
    int closed = output_close(&file, path, status == PCCD_OK, &error);
    ctl_error_tell(&error);
    return (int)ctl_exit_of(status != PCCD_OK ? status : closed, true);
}
