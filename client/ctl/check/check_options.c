/* check_options.c - options of a check. */
#include "check_run.h"

#include "ctl.h"
#include "meshfile.h"
#include "sequence.h"

#define TOLERANCE_MIN  1e-12
#define SEPARATION_MAX 1e18

static void take_approach(struct argp_state *state, const struct option_row *row,
                          const char *text, void *to)
{
    struct check_options *options = to;
    options->settings.approach = option_real(state, row, text);
    if (options->settings.approach == 0.0 || options->settings.approach == 1.0) {
        option_misused(state, "--approach: above 0 and below 1");
    }
}

static void check_usage(struct argp_state *state, void *to)
{
    const struct check_options *options = to;
    const struct ask_options *ask = &options->ask;
    if (ask->files.count == 0) {
        option_misused(state, "which frames? The files of a mesh before and after the "
                              "step, or one that has several frames");
    }
    /* Another one is refused by its reader, which knows what it is. */
    if (ask->files.count == 1 && ctl_mesh_is_named(ask->files.list[0]) &&
        !ctl_sequence_is_pattern(ask->files.list[0]) &&
        ctl_mesh_holds(ask->files.list[0]) == CTL_HOLDS_MESH) {
        option_misused(state,
                       "%s is one frame: name the file after the step, too, or a point "
                       "cache (.pc2, .mdd) behind it, or a pattern such as seq%%d.obj",
                       ask->files.list[0]);
    }
    if (options->ask.csv != NULL && options->settings.mode == PCCD_MODE_ANY) {
        option_misused(state, "--contacts: mode any gives no contacts");
    }
}

#define AT(member) offsetof(struct check_options, member)
static const struct option_row rows[] = {
    CTL_QUESTION,
    {"mode", 0, "all|first|any|pairs|first-per-pair",
     "all (every contact, the default), first (the earliest), any (yes or no), pairs "
     "(the pairs that no coordinate axis separates), first-per-pair (of each two objects "
     "the first contact)",
     OPTION_WORD, .at = AT(settings.mode)},
    {"tolerance", 0, "T", "Largest toi_hi - toi of a proved contact (default: 1e-6)",
     OPTION_REAL, .at = AT(settings.tolerance), .min = TOLERANCE_MIN, .max = 1},
    {"separation", 0, "S",
     "Two features meet when they are S farther apart than the sum of their radii "
     "(default: 0)",
     OPTION_REAL, .at = AT(settings.separation), .max = SEPARATION_MAX},
    {"approach", 0, "A",
     "What begins at its distance or nearer meets when it comes to A times the distance "
     "that it begins with, A above 0 and below 1 (default: at t = 0)",
     OPTION_OWN, .max = 1, .take = take_approach},
    {"touching", 0, "kept|told|left-out",
     "What touches at t = 0, or is within its distance, is a contact then (kept, the "
     "default); the same, and told is whether it enters, slides or leaves; or what "
     "slides or leaves is left out",
     OPTION_WORD, .at = AT(settings.touching)},
    CTL_OUTPUT,
    {"contacts", 0, "FILE",
     "Write the contacts as CSV; - is the standard output, and the report then goes to "
     "the standard error",
     OPTION_TEXT, .at = AT(ask.csv)},
    {0}};
const struct option_table check_table = {
    .rows = rows,
    .parts = (const struct option_part[]){{&ask_table, AT(ask)}, {0}},
    .check = check_usage};

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
