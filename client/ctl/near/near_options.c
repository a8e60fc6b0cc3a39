/* near_options.c - what is asked about what is near. */
#include "near_run.h"

#include <math.h>
#include <string.h>

#include "ctl.h"
#include "names.h"
#include "shown.h"

#define DISTANCE_MAX 1e18

enum { OPTION_DISTANCE = 256 + 64, OPTION_WHAT, OPTION_GAP, OPTION_SELF, OPTION_CSV };

static const struct argp_option option_list[] = {
    {"distance", OPTION_DISTANCE, "D", 0,
     "How near: 0 (what touches) to 1e18. Needed for pairs, features and vertices; with "
     "nearest it leaves out objects that are farther apart",
     0},
    {"what", OPTION_WHAT, "pairs|features|vertices|nearest|crossings|depth", 0,
     "pairs (vertex-face and edge-edge within D, the default), features (the closest "
     "features of these pairs, each once), vertices (for each the least distance of the "
     "pairs that it is part of, at most D), nearest (for each two objects the nearest "
     "pair), crossings (edges that pass through faces), depth (how deep the vertices of "
     "closed meshes are in others)",
     0},
    {"gap", OPTION_GAP, "G", 0,
     "nearest: end early, with a pair that is farther by at most G than the nearest", 0},
    {"self", OPTION_SELF, 0, 0,
     "pairs and features of several files: of each file with itself, too. Of one file "
     "that "
     "is the question, and what passes through what is asked of all of them",
     0},
    {"csv", OPTION_CSV, "FILE", 0,
     "Write every record as CSV; - is the standard output, and the report then goes to "
     "the "
     "standard error",
     0},
    {0},
};

static void check_usage(const struct argp_state *state, struct near_options *options)
{
    enum pccd_near_what what = options->settings.what;
    if (options->ask.path_count == 0) {
        tool_misused(state, "one file at least: each is an object");
    }
    if (!options->has_distance && common_near_has_all_pairs(what)) {
        tool_misused(state, "--distance is missing: how near is near?");
    }
    if (options->has_distance && !common_near_has_distance(what)) {
        tool_misused(state, "--distance: %s has no use for it", common_near_name(what));
    }
    if (options->has_gap && what != PCCD_NEAR_NEAREST) {
        tool_misused(state, "--gap is of --what nearest");
    }
    if (options->ask.path_count == 1 && what == PCCD_NEAR_NEAREST) {
        tool_misused(state, "--what nearest: two files at least");
    }
    if (!options->has_distance && what == PCCD_NEAR_NEAREST) {
        options->settings.distance = INFINITY;
    }
    if (options->has_self && what == PCCD_NEAR_NEAREST) {
        tool_misused(state, "--self: nearest is of two objects");
    }
    if (options->ask.path_count > 1 && !options->has_self &&
        (what == PCCD_NEAR_PAIRS || what == PCCD_NEAR_FEATURES)) {
        options->ask.object.what |= PCCD_OBJECT_SELF;
        options->ask.object.self_collision = false;
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct near_options *options = state->input;
    struct pccd_near_settings *settings = &options->settings;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->ask;
        break;
    case OPTION_DISTANCE:
        settings->distance = ctl_option_real(state, "distance", text, 0.0, DISTANCE_MAX);
        options->has_distance = true;
        break;
    case OPTION_GAP:
        settings->gap = ctl_option_real(state, "gap", text, 0.0, DISTANCE_MAX);
        options->has_gap = true;
        break;
    case OPTION_SELF:
        options->has_self = true;
        break;
    case OPTION_WHAT:
        settings->what = (enum pccd_near_what)ctl_option_name(
            state, "what", text, common_near_names, PCCD_NEAR_COUNT);
        break;
    case OPTION_CSV:
        options->ask.csv = text;
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
const struct argp near_options_argp = {
    .options = option_list, .parser = parse, .children = children};

struct pccd_near_settings near_options_settings(const struct near_options *options)
{
    struct pccd_near_settings settings = options->settings;
    settings.threads = options->ask.threads;
    settings.method = options->ask.method;
    settings.deadline_ns = options->ask.deadline_ns;
    settings.tells_crossings = common_near_has_all_pairs(settings.what);
    if (options->ask.tuning != NULL) {
        strcpy(settings.tuning, options->ask.tuning);
    }
    return settings;
}
