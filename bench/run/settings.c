/* settings.c - what pccd-bench was asked for. */
#include "settings.h"

#include <argp.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "names.h"
#include "question.h"

#define THREADS_MAX 1024u
#define STEPS_MAX   1000000u
#define REPEATS_MAX 1000000u
#define HZ_MAX      10000u
#define WORDS_MAX   32 /* of --beside */

static const char *const vias[RUN_VIAS] = {"engine", "daemon", "direct"};
static const char *const formats[RUN_FORMATS] = {"text", "csv", "json"};
static const char *const sends[RUN_SENDS] = {"all", "moved", "poses"};
static const char *const movings[BENCH_MOVINGS] = {"told", "objects", "patch",
                                                   "vertices"};
static const char *const cpus[] = {"scalar", "sse4", "avx2", "avx512", "neon"};

enum {
    OPTION_THREADS = 256,
    OPTION_METHOD,
    OPTION_TUNING,
    OPTION_CPU,
    OPTION_MODE,
    OPTION_VIA,
    OPTION_FRAMES,
    OPTION_WARM_UP,
    OPTION_REPEAT,
    OPTION_FORMAT,
    OPTION_SMALL,
    OPTION_LIST,
    OPTION_BESIDE,
    OPTION_FRESH,
    OPTION_TEAM,
    OPTION_REBUILD_RATIO,
    OPTION_MOVING,
    OPTION_SENDS,
    OPTION_SEPARATION,
    OPTION_APPROACH,
    OPTION_HZ
};

/* What a side may differ in. */
static const struct argp_option side_options[] = {
    {"via", OPTION_VIA, "engine|daemon|direct", 0,
     "Who computes: the engine in this process (the default), a private daemon by "
     "libpccd, or libpccd's url direct:",
     2},
    {"mode", OPTION_MODE, "all|first|any|pairs", 0,
     "Every contact (the default), the earliest, yes or no, candidate pairs", 2},
    {"method", OPTION_METHOD, "default|paper|wide", 0, "How candidates are found", 2},
    {"threads", OPTION_THREADS, "N", 0, "At most N threads a step (default: 1)", 2},
    {"team", OPTION_TEAM, NULL, 0,
     "All of them also where one would be faster (engine only)", 2},
    {"tuning", OPTION_TUNING, "STRING", 0,
     "How threads share the work, such as scheduler=paper,refit=paper (pccd.h); empty: "
     "the default",
     2},
    {"rebuild-ratio", OPTION_REBUILD_RATIO, "R", 0,
     "Rebuild a subtree whose box has less than R times the volume of its two halves' "
     "(method paper; default: 0.9; negative: never)",
     2},
    {"fresh", OPTION_FRESH, NULL, 0,
     "Make a scene for each step, and free it: what a function takes that keeps nothing",
     2},
    {"moving", OPTION_MOVING, "told|none|all|objects:SHARE|patch:SHARE|vertices:SHARE", 0,
     "What moves: all as it is told (the default); or this part, such as objects:0.01, "
     "goes to and fro between the first frame that counts and the next one, and all else "
     "stands",
     2},
    {"sends", OPTION_SENDS, "all|moved|poses", 0,
     "Hand over every position (the default), only those that change, or poses of what "
     "only turns and shifts (daemon and direct only)",
     2},
    {"separation", OPTION_SEPARATION, "R", 0,
     "Features meet within R times the median edge of the first frame (default: 0)", 2},
    {"approach", OPTION_APPROACH, "SHARE", 0,
     "Those that begin nearer meet at this share of the distance they begin with "
     "(default: 0, at once)",
     2},
    {"cpu", OPTION_CPU, "scalar|sse4|avx2|avx512|neon", 0,
     "Instruction set (default: $PCCD_CPU, or the best)", 2},
    {0},
};

static const struct argp_option option_list[] = {
    {"list", OPTION_LIST, NULL, 0, "Print the names of the scenes", 1},
    {"small", OPTION_SMALL, NULL, 0,
     "The small scene of that name, of a few thousand triangles", 1},
    {"frames", OPTION_FRAMES, "FIRST-LAST|N|hard|hard+N", 0,
     "Time these steps, from 0, or the first N (default: all); step i goes from frame i "
     "to the next. hard: the step that takes longest, and N more, as far as there are",
     1},
    {"warm-up", OPTION_WARM_UP, "N", 0,
     "Make N steps before those that are timed, which do not count; where there are not "
     "so many, the first one again and again (default: 2)",
     1},
    {"repeat", OPTION_REPEAT, "N", 0,
     "Play everything N times, each time a new scene; of each step the pass that took "
     "the least is kept, with its phases (default: 1)",
     1},
    {"hz", OPTION_HZ, "N", 0,
     "Begin a step so many times a second, as a game does (default: as soon as the last "
     "one ended)",
     1},
    {"beside", OPTION_BESIDE, "OPTIONS", 0,
     "Take each step once more with these options besides the others, such as "
     "\"--threads 2\", by turns; may be given several times. Answers must agree, and "
     "times are compared",
     1},
    {"format", OPTION_FORMAT, "text|csv|json", 0,
     "A summary to read (the default), a line for each step, or one object with all of "
     "it",
     1},
    {"output", 'o', "FILE", 0, "Write there instead of to the standard output", 1},
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

/* FIRST-LAST, how many, or from the hard one on. */
static void read_frames(struct run_settings *settings, const struct argp_state *state,
                        char *text)
{
    char *dash = strchr(text, '-');
    settings->has_frames = true;
    settings->first = 0;
    if (strcmp(text, "hard") == 0 || strncmp(text, "hard+", 5) == 0) {
        settings->is_hard = true;
        settings->last = text[4] ? number_of(state, "frames", text + 5, 0, STEPS_MAX) : 0;
        return;
    }
    if (!dash) {
        settings->last = number_of(state, "frames", text, 1, STEPS_MAX) - 1;
        return;
    }
    *dash = '\0';
    settings->first = number_of(state, "frames", text, 0, STEPS_MAX);
    settings->last = number_of(state, "frames", dash + 1, settings->first, STEPS_MAX);
}

static double ratio_of(const struct argp_state *state, const char *option,
                       const char *text, double least)
{
    char *stop;
    double value = strtod(text, &stop);
    if (stop == text || *stop != '\0' || !(value >= least && value <= 1)) {
        argp_error(state, "--%s: \"%s\" is not a number up to 1", option, text);
    }
    return value;
}

static void read_tuning(struct pccd_step_settings *step, const struct argp_state *state,
                        const char *text)
{
    struct eng_tuning tuning = {0};
    char why[ENG_TUNING_WHY_BYTES];
    if (eng_tuning_read(text, &tuning, why) != PCCD_OK) {
        argp_error(state, "--tuning: %s", why);
    }
    step->tuning = text;
}

static struct bench_moving moving_of(const struct argp_state *state, const char *text)
{
    const char *share = strchr(text, ':');
    struct bench_moving moving = {BENCH_MOVING_VERTICES, 0};
    char *stop = NULL;
    if (strcmp(text, "none") == 0) {
        return moving;
    }
    if (strcmp(text, "all") == 0) {
        moving.share = 1;
        return moving;
    }
    for (moving.what = 0; moving.what < BENCH_MOVINGS; moving.what++) {
        size_t length = strlen(movings[moving.what]);
        if (strncmp(text, movings[moving.what], length) == 0 &&
            (share ? text + length == share : text[length] == '\0')) {
            break;
        }
    }
    if (share) {
        moving.share = strtod(share + 1, &stop);
    }
    if (moving.what == BENCH_MOVINGS || (moving.what == BENCH_MOVING_TOLD) == !!share ||
        (share && (stop == share + 1 || *stop != '\0' || !(moving.share >= 0) ||
                   moving.share > 1))) {
        argp_error(state, "--moving: \"%s\" is not known; see --help", text);
    }
    return moving;
}

/* Those that choose a way to compute a step. */
static error_t parse_side(int key, char *text, struct argp_state *state)
{
    struct run_side *side = state->input;
    struct pccd_step_settings *step = &side->step;
    switch (key) {
    case OPTION_MODE:
        step->mode = (enum pccd_mode)place_of(state, "mode", text, common_mode_names,
                                              PCCD_MODE_COUNT);
        break;
    case OPTION_METHOD:
        step->method = (enum pccd_method)place_of(state, "method", text,
                                                  common_method_names, PCCD_METHOD_COUNT);
        break;
    case OPTION_THREADS:
        step->threads = number_of(state, "threads", text, 1, THREADS_MAX);
        break;
    case OPTION_TUNING:
        read_tuning(step, state, text);
        break;
    case OPTION_REBUILD_RATIO:
        side->rebuild_ratio = ratio_of(state, "rebuild-ratio", text, -INFINITY);
        break;
    case OPTION_SEPARATION:
        side->separation = ratio_of(state, "separation", text, 0);
        break;
    case OPTION_APPROACH:
        step->approach = ratio_of(state, "approach", text, 0);
        break;
    case OPTION_TEAM:
        side->is_team = true;
        break;
    case OPTION_FRESH:
        side->is_fresh = true;
        break;
    case OPTION_CPU:
        (void)place_of(state, "cpu", text, cpus, sizeof cpus / sizeof cpus[0]);
        side->cpu = text;
        break;
    case OPTION_VIA:
        side->via = (enum run_via)place_of(state, "via", text, vias, RUN_VIAS);
        break;
    case OPTION_MOVING:
        side->moving = moving_of(state, text);
        break;
    case OPTION_SENDS:
        side->sends = (enum run_sends)place_of(state, "sends", text, sends, RUN_SENDS);
        break;
    case ARGP_KEY_END:
        if (side->sends != RUN_SENDS_ALL && side->via == RUN_VIA_ENGINE) {
            argp_error(state, "--sends: only with --via daemon or direct");
        }
        if (side->rebuild_ratio != 0 && side->via != RUN_VIA_ENGINE) {
            argp_error(state, "--rebuild-ratio: only with --via engine");
        }
        if (side->is_team && side->via != RUN_VIA_ENGINE) {
            argp_error(state, "--team: only with --via engine");
        }
        break;
    default:
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

static const struct argp side_argp = {.options = side_options, .parser = parse_side};

/* The first side with the words of its label as further options. */
static void read_beside(struct run_settings *settings, struct run_side *side)
{
    const char *label = side->label;
    char *words[WORDS_MAX + 1] = {program_invocation_short_name};
    int count = 1;
    char *rest = NULL;
    *side = settings->sides[0];
    side->label = label;
    side->words = strdup(label);
    for (char *word = side->words ? strtok_r(side->words, " ", &rest) : NULL;
         word && count <= WORDS_MAX - 1; word = strtok_r(NULL, " ", &rest)) {
        words[count++] = word;
    }
    (void)argp_parse(&side_argp, count, words, 0, NULL, side);
}

static void add_beside(struct run_settings *settings, const struct argp_state *state,
                       const char *text)
{
    if (settings->side_count == RUN_SIDES_MAX) {
        argp_error(state, "--beside: at most %u times", RUN_SIDES_MAX - 1);
    }
    settings->sides[settings->side_count++].label = text;
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct run_settings *settings = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &settings->sides[0];
        break;
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
    case OPTION_HZ:
        settings->hz = number_of(state, "hz", text, 1, HZ_MAX);
        break;
    case OPTION_BESIDE:
        add_beside(settings, state, text);
        break;
    case OPTION_FORMAT:
        settings->format =
            (enum run_format)place_of(state, "format", text, formats, RUN_FORMATS);
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
        return ARGP_ERR_UNKNOWN;
    }
    return 0;
}

void run_settings_read(struct run_settings *settings, int argc, char **argv)
{
    static const struct argp_child children[] = {
        {&side_argp, 0, "How a step is computed:", 2}, {0}};
    static const struct argp argp = {
        .options = option_list,
        .parser = parse,
        .children = children,
        .args_doc = "SCENE\nkernel|pair|client [PART] [--json] [--smoke] [NAME]",
        .doc = "Time the steps of one scene, and count their work; or measure a section, "
               "or a part of it: kernel (kernels, roofline), pair (exact, distances, "
               "slowest), client (batch, connect, death, ipc).\v"
               "Exit status: 0; 1 when an answer was incomplete or differed from pass to "
               "pass or from one side to another; 2 when it could not be asked for; 77 "
               "when the scene's recorded "
               "frames are not in $PCCD_DATA."};
    *settings = (struct run_settings){
        .warm_up = 2,
        .repeat = 1,
        .side_count = 1,
        .sides[0] = {
            .label = "",
            .step = {.struct_bytes = sizeof(struct pccd_step_settings), .threads = 1}}};
    argp_err_exit_status = 2;
    (void)argp_parse(&argp, argc, argv, 0, NULL, settings);
    for (uint32_t i = 1; i < settings->side_count; i++) {
        read_beside(settings, &settings->sides[i]);
    }
}

static bool is_endless(const struct run_settings *settings)
{
    for (uint32_t i = 0; i < settings->side_count; i++) {
        if (settings->sides[i].moving.what == BENCH_MOVING_TOLD) {
            return false;
        }
    }
    return true;
}

bool run_settings_fit(struct run_settings *settings, uint32_t step_count,
                      uint32_t hard_step)
{
    if (!settings->has_frames) {
        settings->first = 0;
        settings->last = step_count - 1;
    }
    if (settings->is_hard) {
        settings->first = hard_step;
        settings->last += hard_step;
    }
    if (is_endless(settings)) {
        return settings->first < step_count;
    }
    if (settings->is_hard && settings->last >= step_count) {
        settings->last = step_count - 1;
    }
    return settings->last < step_count;
}

const char *run_via_name(enum run_via via)
{
    return vias[via];
}
