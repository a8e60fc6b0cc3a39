/* cmd_config.c - pccdctl config. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "link.h"
#include "output.h"
#include "shown.h"
#include "terminal.h"

enum { OPTION_JSON = 256 + 64 };

enum what { LIST, GET, SET, WHAT_COUNT };
static const char *const what_names[] = {"list", "get", "set"};
static const unsigned argument_counts[] = {[LIST] = 1, [GET] = 2, [SET] = 3};

struct config_options {
    struct ctl_link link;
    enum what what;
    const char *name, *value;
    bool is_json;
};

static const struct argp_option option_list[] = {
    {"json", OPTION_JSON, NULL, 0, "JSON: an array (list), or an object (get, set)", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct config_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->link;
        return 0;
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num == 0) {
            options->what =
                (enum what)ctl_argument_name(state, text, what_names, WHAT_COUNT);
        } else if (state->arg_num == 1) {
            options->name = text;
        } else {
            options->value = text;
        }
        return 0;
    case ARGP_KEY_END:
        if (state->arg_num > 0 && state->arg_num != argument_counts[options->what]) {
            tool_misused(state, "it is: list, get NAME, or set NAME VALUE");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_child children[] = {{&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_config = {
    .options = option_list,
    .parser = parse,
    .args_doc = "[list|get|set] [NAME] [VALUE]",
    .doc = "List the settings that may change while a daemon runs, print one, or change "
           "one. Only root and the daemon's own user may change one. A change holds "
           "until the daemon ends.",
    .children = children};

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
    printf("%s%s %s%s %s\n", setting->changed ? terminal_begin(TERMINAL_BOLD) : "",
           tool_shown_column(setting->name, 16), tool_shown_column(setting->value, 12),
           setting->changed ? terminal_end() : "", tool_shown(setting->text));
}

static void print_value(void *context, const struct pccd_setting *setting)
{
    const struct config_options *options = context;
    if (options->is_json) {
        json_t *object = setting_json(setting);
        json_dumpf(object, stdout, JSON_TEXT_FLAGS);
        json_decref(object);
        putchar('\n');
    } else {
        puts(tool_shown(setting->value));
    }
}

static int run(struct pccd_client *client, struct config_options *options)
{
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
        if (status == PCCD_OK) {
            json_dumpf(array, stdout, JSON_TEXT_FLAGS);
            putchar('\n');
        }
        json_decref(array);
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
    struct pccd_client *client = NULL;
    if (argp_parse(&ctl_argp_config, argc, argv, 0, NULL, &options) != 0) {
        return CTL_USAGE;
    }
    int status = ctl_link_open(&options.link, &client);
    if (status == CTL_DONE) {
        status = run(client, &options);
    }
    pccd_close(client);
    ctl_link_deinit(&options.link);
    return status;
}
