/* verify_options.c - what of a recording is checked. */
#include "verify.h"

#include "ctl.h"

#define SAMPLE_MAX 1000000000u

enum { OPTION_SAMPLE = 256 + 64, OPTION_CONTACTS, OPTION_SEED, OPTION_REPEAT };

static const struct argp_option option_list[] = {
    {"sample", OPTION_SAMPLE, "N", 0,
     "Check N pairs of each step that are near each other and not in the answer "
     "(default: 1000)",
     0},
    {"contacts", OPTION_CONTACTS, "N", 0,
     "Check about N contacts of each step (default: all)", 0},
    {"seed", OPTION_SEED, "N", 0, "Seed of the random choice of pairs (default: 1)", 0},
    {"repeat", OPTION_REPEAT, NULL, 0,
     "Have a daemon repeat the steps even if the recording holds the contacts", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct verify_options *options = state->input;
    switch (key) {
    case OPTION_SAMPLE:
        options->settings.sample = ctl_option_count(state, "sample", text, 0, SAMPLE_MAX);
        return 0;
    case OPTION_CONTACTS:
        options->settings.contacts_max =
            ctl_option_count(state, "contacts", text, 1, SAMPLE_MAX);
        return 0;
    case OPTION_SEED:
        options->settings.seed = ctl_option_count(state, "seed", text, 0, UINT64_MAX);
        return 0;
    case OPTION_REPEAT:
        options->repeats = true;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp verify_options_argp = {.options = option_list, .parser = parse};
