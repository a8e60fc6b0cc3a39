/* cmd_config.c - pccdctl config. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "columns.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "shown.h"
#include "terminal.h"

#define NAME_COLUMNS  16u
#define VALUE_COLUMNS 12u

enum what { LIST, GET, SET };

struct config_options {
    struct ctl_link link;
    struct option_arguments arguments;
    enum what what;
    const char *name, *value;
    bool is_json;
};

static void check(struct argp_state *state, void *to)
{
    struct config_options *options = to;
    char **list = options->arguments.list;
    uint32_t count = options->arguments.count;
    if (count > 0) {
        options->what =
            (enum what)option_word(state, NULL, list[0], strlen(list[0]), "list|get|set");
        options->name = count > 1 ? list[1] : NULL;
        options->value = count > 2 ? list[2] : NULL;
    }
    if (count > 0 && count != 1 + (uint32_t)options->what) {
        option_misused(state, "it is: list, get NAME, or set NAME VALUE");
    }
}

static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = offsetof(struct config_options, arguments)},
    CTL_OUTPUT,
    {"json", 0, NULL, "JSON: an array (list), or an object (get, set)", OPTION_FLAG,
     .at = offsetof(struct config_options, is_json)},
    {0}};

const struct option_table ctl_table_config = {
    .rows = rows,
    .parts =
        (const struct option_part[]){
            {&ctl_link_table, offsetof(struct config_options, link)}, {0}},
    .check = check,
    .arguments = "[list|get|set] [NAME] [VALUE]",
    .text = "List the settings that may change while a daemon runs, print one, or "
            "change one. Only root and the daemon's own user may change one. A "
            "change holds until the daemon ends.",
    .examples = "  pccdctl config\n"
                "  pccdctl config set threads 4\n",
};

static json_t *setting_json(const struct pccd_setting *setting)
{
    return json_pack("{s:s, s:s, s:s, s:b}", "name", setting->name, "value",
                     setting->value, "text", setting->text, "changed", setting->changed);
}

static void add_setting(void *context, const struct pccd_setting *setting)
{
    json_array_append_new(context, setting_json(setting));
}

static void print_setting(void *context, const struct pccd_setting *setting)
{
    (void)context;
    printf("%s%s %s%s ", setting->changed ? terminal_begin(TERMINAL_BOLD) : "",
           tool_shown_column(setting->name, NAME_COLUMNS),
           tool_shown_column(setting->value, VALUE_COLUMNS),
           setting->changed ? terminal_end() : "");
    columns_text(stdout, NAME_COLUMNS + VALUE_COLUMNS + 2, tool_shown(setting->text));
    putchar('\n');
}

static void print_value(void *context, const struct pccd_setting *setting)
{
    const struct config_options *options = context;
    if (options->is_json) {
        json_t *object = setting_json(setting);
        (void)output_json(object, true, stdout);
    } else {
        puts(tool_shown(setting->value));
    }
}

static int run(struct pccd_client *client, void *to)
{
    struct config_options *options = to;
    int status = PCCD_OK;
    if (options->what == SET) {
        status = pccd_config_set(client, options->name, options->value);
        if (status == PCCD_OK && options->is_json) {
            status = pccd_config_get(client, options->name, print_value, options);
        }
    } else if (options->what == GET) {
        status = pccd_config_get(client, options->name, print_value, options);
    } else if (options->is_json) {
        json_t *array = json_array();
        status = pccd_config_get(client, NULL, add_setting, array);
        (void)output_json(array, status == PCCD_OK, stdout);
    } else {
        status = pccd_config_get(client, NULL, print_setting, NULL);
    }
    if (status == PCCD_OK) {
        return CTL_DONE;
    }
    return ctl_complain("config: %s%s", pccd_error_text(client),
                        status == PCCD_E_INVAL ? "; pccdctl config list tells them all"
                                               : "");
}

int ctl_cmd_config(int argc, char **argv)
{
    struct config_options options = {
        .link = {.policy = CTL_LINK_EXISTING, .observes = true}};
    return ctl_link_command(&ctl_table_config, argc, argv, &options.link, run);
}
