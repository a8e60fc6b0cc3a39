/* bench/run/settings.c - what pccd-bench was asked for.
 *
 * Room:     bench/run.
 * Does:     see settings.h.
 * Threads:  one.
 */
#include "settings.h"

#include <argp.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define THREADS_MAX 1024u
#define STEPS_MAX   1000000u
#define REPEATS_MAX 1000000u

static const char *const vias[RUN_VIAS] = {"engine", "daemon", "direct"};
static const char *const formats[RUN_FORMATS] = {"text", "csv", "json"};
static const char *const modes[PCCD_MODE_COUNT] = {"all", "first", "any", "pairs"};
static const char *const methods[PCCD_METHOD_COUNT] = {"default", "paper", "wide"};
static const char *const schedulers[PCCD_SCHEDULER_COUNT] = {"default", "steal", "paper"};
static const char *const high_levels[PCCD_HIGH_LEVEL_COUNT] = {"default", "round-robin",
                                                               "disjoint"};
static const char *const refits[PCCD_REFIT_COUNT] = {"default", "even", "paper"};
static const char *const cpus[] = {"scalar", "sse4", "avx2", "avx512", "neon"};

enum {
    OPTION_THREADS = 256,
    OPTION_METHOD,
    OPTION_SCHEDULER,
    OPTION_HIGH_LEVEL,
    OPTION_REFIT,
    OPTION_CPU,
    OPTION_MODE,
    OPTION_VIA,
    OPTION_FRAMES,
    OPTION_WARM_UP,
    OPTION_REPEAT,
    OPTION_FORMAT,
    OPTION_SMALL,
    OPTION_LIST
};

static const struct argp_option option_list[] = {
    {"list", OPTION_LIST, NULL, 0, "Print the names of the scenes", 0},
    {"small", OPTION_SMALL, NULL, 0,
     "The small scene of that name, of a few thousand triangles", 0},
    {"frames", OPTION_FRAMES, "FIRST-LAST|N", 0,
     "Time these steps, from 0, or the first N (default: all); step i goes from frame i "
     "to the next",
     0},
    {"warm-up", OPTION_WARM_UP, "N", 0,
     "Make N steps before those that are timed, which do not count; where there are not "
     "so many, the first one again and again (default: 2)",
     0},
    {"repeat", OPTION_REPEAT, "N", 0,
     "Play everything N times, each time a new scene; of each step the pass that took "
     "the least is kept, with its phases (default: 1)",
     0},
    {"via", OPTION_VIA, "engine|daemon|direct", 0,
     "Who computes: the engine in this process (the default), a private daemon by "
     "libpccd, or libpccd's url direct:",
     0},
    {"mode", OPTION_MODE, "all|first|any|pairs", 0,
     "Every contact (the default), the earliest, yes or no, candidate pairs", 0},
    {"method", OPTION_METHOD, "default|paper|wide", 0, "How candidates are found", 0},
    {"threads", OPTION_THREADS, "N", 0, "At most N threads a step (default: 1)", 0},
    {"scheduler", OPTION_SCHEDULER, "default|steal|paper", 0,
     "How threads share the work", 0},
    {"high-level", OPTION_HIGH_LEVEL, "default|round-robin|disjoint", 0,
     "The paper's scheduler on high-level nodes", 0},
    {"refit", OPTION_REFIT, "default|even|paper", 0, "How threads share the refit", 0},
    {"cpu", OPTION_CPU, "scalar|sse4|avx2|avx512|neon", 0,
     "Instruction set (default: $PCCD_CPU, or the best)", 0},
    {"format", OPTION_FORMAT, "text|csv|json", 0,
     "A summary to read (the default), a line for each step, or one object with all of "
     "it",
     0},
    {"output", 'o', "FILE", 0, "Write there instead of to the standard output", 0},
    {0},
};

/* The place of `text` among `names`, of those from `from` on. */
static uint32_t place_of(const struct argp_state *state, const char *option,
                         const char *text, const char *const *names, uint32_t count)
{
    uint32_t value = 0;
    while (value < count && strcmp(names[value], text) != 0) {
        value++;
    }
    if (value == count) {
        argp_error(state, "--%s: \"%s\" is not known; see --help", option, text);
    }
    return value;
}

static uint32_t number_of(const struct argp_state *state, const char *option,
                          const char *text, uint32_t low, uint32_t high)
{
    char *stop;
    errno = 0;
    unsigned long value = strtoul(text, &stop, 10);
    if (text[0] < '0' || text[0] > '9' || *stop != '\0' || errno != 0 || value < low ||
        value > high) {
        argp_error(state,
                   "--%s: \"%s\" is not a whole number from %" PRIu32 " to %" PRIu32,
                   option, text, low, high);
    }
    return (uint32_t)value;
}

/* FIRST-LAST, or how many. */
static void read_frames(struct run_settings *settings, const struct argp_state *state,
                        char *text)
{
    char *dash = strchr(text, '-');
    settings->has_frames = true;
    if (!dash) {
        settings->first = 0;
        settings->last = number_of(state, "frames", text, 1, STEPS_MAX) - 1;
        return;
    }
    *dash = '\0';
    settings->first = number_of(state, "frames", text, 0, STEPS_MAX);
    settings->last = number_of(state, "frames", dash + 1, settings->first, STEPS_MAX);
}

/* Those that choose one of several ways to compute the same answer, and --mode. */
static error_t parse_choice(int key, const char *text, const struct argp_state *state)
{
    struct run_settings *settings = state->input;
    struct pccd_step_settings *step = &settings->step;
    switch (key) {
    case OPTION_MODE:
        step->mode =
            (enum pccd_mode)place_of(state, "mode", text, modes, PCCD_MODE_COUNT);
        break;
    case OPTION_METHOD:
        step->method =
            (enum pccd_method)place_of(state, "method", text, methods, PCCD_METHOD_COUNT);
        break;
    case OPTION_SCHEDULER:
        step->scheduler = (enum pccd_scheduler)place_of(state, "scheduler", text,
                                                        schedulers, PCCD_SCHEDULER_COUNT);
        break;
    case OPTION_HIGH_LEVEL:
        step->high_level = (enum pccd_high_level)place_of(
            state, "high-level", text, high_levels, PCCD_HIGH_LEVEL_COUNT);
        break;
    case OPTION_REFIT:
        step->refit =
            (enum pccd_refit)place_of(state, "refit", text, refits, PCCD_REFIT_COUNT);
        break;
    case OPTION_CPU:
        (void)place_of(state, "cpu", text, cpus, sizeof cpus / sizeof cpus[0]);
        settings->cpu = text;
        break;
    case OPTION_VIA:
        settings->via = (enum run_via)place_of(state, "via", text, vias, RUN_VIAS);
        break;
    case OPTION_FORMAT:
        settings->format =
            (enum run_format)place_of(state, "format", text, formats, RUN_FORMATS);
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct run_settings *settings = state->input;
    switch (key) {
    case OPTION_LIST:
        settings->wants_list = true;
        break;
    case OPTION_SMALL:
        settings->is_small = true;
        break;
    case OPTION_FRAMES:
        read_frames(settings, state, text);
        break;
    case OPTION_WARM_UP:
        settings->warm_up = number_of(state, "warm-up", text, 0, STEPS_MAX);
        break;
    case OPTION_REPEAT:
        settings->repeat = number_of(state, "repeat", text, 1, REPEATS_MAX);
        break;
    case OPTION_THREADS:
        settings->step.threads = number_of(state, "threads", text, 1, THREADS_MAX);
        break;
    case 'o':
        settings->path = text;
        break;
    case ARGP_KEY_ARG:
        if (settings->scene) {
            argp_error(state, "one scene at a time: \"%s\" or \"%s\"", settings->scene,
                       text);
        }
        settings->scene = text;
        break;
    case ARGP_KEY_END:
        if (!settings->scene && !settings->wants_list) {
            argp_error(state, "which scene? --list names them");
        }
        break;
    default:
        return parse_choice(key, text, state);
    }
    return 0;
}

void run_settings_read(struct run_settings *settings, int argc, char **argv)
{
    static const struct argp argp = {
        .options = option_list,
        .parser = parse,
        .args_doc = "SCENE",
        .doc = "Time the steps of one scene, and count their work.\v"
               "Exit status: 0; 1 when an answer was incomplete or differed from pass to "
               "pass; 2 when it could not be asked for; 77 when the scene's recorded "
               "frames are not in $PCCD_DATA."};
    *settings = (struct run_settings){.warm_up = 2, .repeat = 1, .step = {.threads = 1}};
    argp_err_exit_status = 2;
    (void)argp_parse(&argp, argc, argv, 0, NULL, settings);
}

bool run_settings_fit(struct run_settings *settings, uint32_t step_count)
{
    if (!settings->has_frames) {
        settings->first = 0;
        settings->last = step_count - 1;
    }
    return settings->last < step_count;
}

const char *run_via_name(enum run_via via)
{
    return vias[via];
}

const char *run_mode_name(enum pccd_mode mode)
{
    return modes[mode];
}

const char *run_method_name(enum pccd_method method)
{
    return methods[method];
}

const char *run_scheduler_name(enum pccd_scheduler scheduler)
{
    return schedulers[scheduler];
}

const char *run_high_level_name(enum pccd_high_level high_level)
{
    return high_levels[high_level];
}

const char *run_refit_name(enum pccd_refit refit)
{
    return refits[refit];
}
