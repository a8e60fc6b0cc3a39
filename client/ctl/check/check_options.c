/* check_options.c - options of a check. */
#include "check_run.h"

#include "ctl.h"
#include "meshfile.h"
#include "names.h"
#include "sequence.h"
#include "shown.h"

#define TOLERANCE_MIN  1e-12
#define SEPARATION_MAX 1e18

enum {
    OPTION_MODE = 256 + 64,
    OPTION_CONTACTS,
    OPTION_TOLERANCE,
    OPTION_SEPARATION,
    OPTION_APPROACH
};

static const struct argp_option option_list[] = {
    {"mode", OPTION_MODE, "all|first|any|pairs", 0,
     "all (every contact, the default), first (the earliest), any (yes or no), pairs "
     "(the pairs that no coordinate axis separates)",
     0},
    {"contacts", OPTION_CONTACTS, "FILE", 0,
     "Write the contacts as CSV; - is the standard output, and the report then goes to "
     "the "
     "standard error",
     0},
    {"tolerance", OPTION_TOLERANCE, "T", 0,
     "Largest toi_hi - toi of a proved contact (default: 1e-6)", 0},
    {"separation", OPTION_SEPARATION, "S", 0,
     "Two features meet when they are S farther apart than the sum of their radii "
     "(default: 0)",
     0},
    {"approach", OPTION_APPROACH, "A", 0,
     "What begins at its distance or nearer meets when it comes to A times the distance "
     "that it begins with, A above 0 and below 1 (default: at t = 0)",
     0},
    {0},
};

static void check_usage(const struct argp_state *state,
                        const struct check_options *options)
{
    const struct ask_options *ask = &options->ask;
    if (ask->path_count == 0) {
        tool_misused(state, "which frames? The files of a mesh before and after the "
                            "step, or one that has several frames");
    }
    /* Another one is refused by its reader, which knows what it is. */
    if (ask->path_count == 1 && ctl_mesh_is_named(ask->paths[0]) &&
        !ctl_sequence_is_pattern(ask->paths[0]) &&
        ctl_mesh_holds(ask->paths[0]) == CTL_HOLDS_MESH) {
        tool_misused(state,
                     "%s is one frame: name the file after the step, too, or a point "
                     "cache (.pc2, .mdd) behind it, or a pattern such as seq%%d.obj",
                     tool_shown(ask->paths[0]));
    }
    if (options->ask.csv != NULL && options->settings.mode == PCCD_MODE_ANY) {
        tool_misused(state, "--contacts: mode any gives no contacts");
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct check_options *options = state->input;
    struct pccd_step_settings *settings = &options->settings;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->ask;
        break;
    case OPTION_MODE:
        settings->mode = (enum pccd_mode)ctl_option_name(
            state, "mode", text, common_mode_names, PCCD_MODE_COUNT);
        break;
    case OPTION_CONTACTS:
        options->ask.csv = text;
        break;
    case OPTION_TOLERANCE:
        settings->tolerance =
            ctl_option_real(state, "tolerance", text, TOLERANCE_MIN, 1.0);
        break;
    case OPTION_SEPARATION:
        settings->separation =
            ctl_option_real(state, "separation", text, 0.0, SEPARATION_MAX);
        break;
    case OPTION_APPROACH:
        settings->approach = ctl_option_real(state, "approach", text, 0.0, 1.0);
        if (settings->approach == 0.0 || settings->approach == 1.0) {
            tool_misused(state, "--approach: above 0 and below 1");
        }
        break;
    case ARGP_KEY_END:
        check_usage(state, options);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const struct argp_child children[] = {{&ask_options_argp, 0, NULL, 0}, {0}};
const struct argp check_options_argp = {
    .options = option_list, .parser = parse, .children = children};

struct pccd_step_settings check_step_settings(const struct check_options *options)
{
    struct pccd_step_settings settings = options->settings;
    settings.threads = options->ask.threads;
    settings.method = options->ask.method;
    settings.tuning = options->ask.tuning;
    settings.deadline_ns = options->ask.deadline_ns;
    settings.tells_start = true;
    return settings;
}
