/* near_options.c - what is asked about what is near. */
#include "near_run.h"

#include <math.h>
#include <string.h>

#include "ctl.h"
#include "names.h"

#define DISTANCE_MAX 1e18

static void take_distance(struct argp_state *state, const struct option_row *row,
                          const char *text, void *to)
{
    struct near_options *options = to;
    options->settings.distance = option_real(state, row, text);
    options->has_distance = true;
}

static void take_gap(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to)
{
    struct near_options *options = to;
    options->settings.gap = option_real(state, row, text);
    options->has_gap = true;
}

static void check_usage(struct argp_state *state, void *to)
{
    struct near_options *options = to;
    enum pccd_near_what what = options->settings.what;
    if (options->ask.files.count == 0) {
        option_misused(state, "one file at least: each is an object");
    }
    if (!options->has_distance && common_near_has_all_pairs(what)) {
        option_misused(state, "--distance is missing: how near is near?");
    }
    if (options->has_distance && !common_near_has_distance(what)) {
        option_misused(state, "--distance: %s has no use for it", common_near_name(what));
    }
    if (options->has_gap && what != PCCD_NEAR_NEAREST) {
        option_misused(state, "--gap is of --what nearest");
    }
    if (options->ask.files.count == 1 && what == PCCD_NEAR_NEAREST &&
        !scene_is_named(options->ask.files.list[0])) {
        option_misused(state, "--what nearest: two files at least");
    }
    if (!options->has_distance && what == PCCD_NEAR_NEAREST) {
        options->settings.distance = INFINITY;
    }
    if (options->has_self && what == PCCD_NEAR_NEAREST) {
        option_misused(state, "--self: nearest is of two objects");
    }
}

#define AT(member) offsetof(struct near_options, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"distance", 0, "D",
     "How near: 0 (what touches) to 1e18. Needed for pairs, features and vertices; with "
     "nearest it leaves out objects that are farther apart",
     OPTION_OWN, .max = DISTANCE_MAX, .take = take_distance},
    {"what", 0, "pairs|features|vertices|nearest|crossings|depth",
     "pairs (vertex-face and edge-edge within D, of points also vertex-edge and "
     "vertex-vertex; the default), features (the closest features of these pairs, each "
     "once), vertices (for each the least distance of the pairs that it is part of, at "
     "most D), nearest (for each two objects the nearest pair), crossings (edges that "
     "pass through faces), depth (how deep the vertices of closed meshes are in others)",
     OPTION_WORD, .at = AT(settings.what)},
    {"gap", 0, "G",
     "nearest: end early, with a pair that is farther by at most G than the nearest",
     OPTION_OWN, .max = DISTANCE_MAX, .take = take_gap},
    {"self", 0, NULL,
     "pairs and features of several files: of each file with itself, too. Of one file "
     "that is the question, and what passes through what is asked of all of them",
     OPTION_FLAG, .at = AT(has_self)},
    CTL_OUTPUT,
    {"csv", 0, "FILE",
     "Write every record as CSV; - is the standard output, and the report then goes to "
     "the standard error",
     OPTION_TEXT, .at = AT(ask.csv)},
    {0}};
const struct option_table near_table = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ask_table, AT(ask)}, {0}},
    .check = check_usage};

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

void near_options_leave_out_self(const struct near_options *options, uint32_t objects,
                                 struct pccd_object_settings *settings)
{
    enum pccd_near_what what = options->settings.what;
    if (objects > 1 && !options->has_self && common_near_has_all_pairs(what) &&
        what != PCCD_NEAR_VERTICES && (settings->what & PCCD_OBJECT_SELF) == 0) {
        settings->what |= PCCD_OBJECT_SELF;
        settings->self_collision = false;
    }
}
