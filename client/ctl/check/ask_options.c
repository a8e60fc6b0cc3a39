/* ask_options.c - options of the commands that ask about files. */
#include "ask_options.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "ctl.h"
#include "names.h"
#include "shown.h"

#define REPEATS_MAX      1000000u
#define THREADS_MAX      1024u
#define DEADLINE_MS_MAX  3600000u
#define RESULT_BYTES_MIN 65536u
#define RESULT_BYTES_MAX ((uint64_t)1 << 40)
#define LENGTH_MAX       1e18
#define RINGS_MAX        8u
#define RATE_MIN         1e-6 /* frames a second */
#define RATE_MAX         1e6

enum {
    OPTION_JSON = 256 + 96,
    OPTION_THREADS,
    OPTION_METHOD,
    OPTION_TUNING,
    OPTION_REPEAT,
    OPTION_DEADLINE,
    OPTION_RESULT_BYTES,
    OPTION_THICKNESS,
    OPTION_REST_EXCLUSION,
    OPTION_RINGS,
    OPTION_WELD,
    OPTION_ANIMATION,
    OPTION_RATE
};

/* ---- mesh files -------------------------------------------------------------------- */

static const struct argp_option frames_list[] = {
    {"rate", OPTION_RATE, "N", 0,
     "Of a file that moves by itself, N frames a second (default: its keyframes)", 0},
    {"weld", OPTION_WELD, "auto|off|D", 0,
     "Vertices are one where they are at the same place in every frame (auto, the "
     "default), or at most D apart",
     0},
    {"animation", OPTION_ANIMATION, "NAME", 0,
     "Of a glTF file, the animation of that name, or number from 0 (default: all at "
     "once, or the first one where two move the same thing)",
     0},
    {0},
};

double frames_option_rate(const struct argp_state *state, const char *text)
{
    return ctl_option_real(state, "rate", text, RATE_MIN, RATE_MAX);
}

static error_t parse_frames(int key, char *text, struct argp_state *state)
{
    struct ctl_frames_options *options = state->input;
    switch (key) {
    case OPTION_WELD:
        options->weld = strcmp(text, "auto") == 0 ? 0
                        : strcmp(text, "off") == 0
                            ? -1
                            : ctl_option_real(state, "weld", text, DBL_MIN, LENGTH_MAX);
        return 0;
    case OPTION_ANIMATION:
        options->wish.animation = text;
        return 0;
    case OPTION_RATE:
        options->wish.rate = frames_option_rate(state, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp frames_options_argp = {.options = frames_list, .parser = parse_frames};
const struct argp frames_without_rate_argp = {.options = &frames_list[1],
                                              .parser = parse_frames};

bool frames_options_are_given(const struct ctl_frames_options *options)
{
    return options->weld != 0 || options->wish.rate > 0 ||
           options->wish.animation != NULL;
}

/* ---- questions about them ---------------------------------------------------------- */

static const struct argp_option option_list[] = {
    {"json", OPTION_JSON, NULL, 0, "One JSON object instead of text", 0},
    {"threads", OPTION_THREADS, "N", 0,
     "Use at most N threads (default: the daemon decides)", 0},
    {"method", OPTION_METHOD, "default|paper|wide", 0,
     "Method that finds the candidates: default, paper or wide; the answer is the same",
     0},
    {"tuning", OPTION_TUNING, "STRING", 0,
     "How threads share the work, such as scheduler=paper,refit=paper (default: the "
     "daemon decides)",
     0},
    {"repeat", OPTION_REPEAT, "N", 0,
     "Time N more runs after the first and report medians (default: 1; 0 for each step "
     "of several)",
     0},
    {"deadline", OPTION_DEADLINE, "MS", 0,
     "End after MS milliseconds; the answer may then be incomplete", 0},
    {"result-bytes", OPTION_RESULT_BYTES, "N", 0,
     "Size of the shared memory for answers; longer ones come in pages (default: 64 MiB)",
     0},
    {"thickness", OPTION_THICKNESS, "R", 0,
     "Radius of every feature, in the unit of the files: two features of radius R meet "
     "when they are 2 R apart (default: 0)",
     0},
    {"rest-exclusion", OPTION_REST_EXCLUSION, "D", 0,
     "Of a mesh's own pairs, those that are nearer than D in the first file have no "
     "thickness (default: 0)",
     0},
    {"rings", OPTION_RINGS, "N", 0,
     "Of a mesh's own pairs, those that N edges or fewer join have no thickness, 0 to 8 "
     "(default: 0)",
     0},
    {0},
};

/* How it is computed; none of that changes the answer but the deadline. */
static error_t parse_how(int key, char *text, const struct argp_state *state)
{
    struct ask_options *options = state->input;
    switch (key) {
    case OPTION_THREADS:
        options->threads =
            (uint32_t)ctl_option_count(state, "threads", text, 1, THREADS_MAX);
        return 0;
    case OPTION_METHOD:
        options->method = (enum pccd_method)ctl_option_name(
            state, "method", text, common_method_names, PCCD_METHOD_COUNT);
        return 0;
    case OPTION_TUNING:
        if (strlen(text) >= PCCD_TUNING_BYTES) {
            tool_misused(state, "--tuning: longer than %d bytes", PCCD_TUNING_BYTES - 1);
        }
        options->tuning = text;
        return 0;
    case OPTION_DEADLINE:
        options->deadline_ns =
            ctl_option_count(state, "deadline", text, 1, DEADLINE_MS_MAX) * 1000000u;
        return 0;
    case OPTION_RESULT_BYTES:
        options->link.result_bytes = ctl_option_count(state, "result-bytes", text,
                                                      RESULT_BYTES_MIN, RESULT_BYTES_MAX);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* How thick each object is. */
static error_t parse_object(int key, char *text, const struct argp_state *state)
{
    struct pccd_object_settings *object = &((struct ask_options *)state->input)->object;
    switch (key) {
    case OPTION_THICKNESS:
        object->radius = ctl_option_real(state, "thickness", text, 0.0, LENGTH_MAX);
        object->what |= PCCD_OBJECT_RADIUS;
        return 0;
    case OPTION_REST_EXCLUSION:
        object->rest_distance =
            ctl_option_real(state, "rest-exclusion", text, 0.0, LENGTH_MAX);
        object->what |= PCCD_OBJECT_REST_DISTANCE;
        return 0;
    case OPTION_RINGS:
        object->rest_rings =
            (uint32_t)ctl_option_count(state, "rings", text, 0, RINGS_MAX);
        object->what |= PCCD_OBJECT_REST_RINGS;
        return 0;
    default:
        return parse_how(key, text, state);
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct ask_options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->frames;
        return 0;
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    case OPTION_REPEAT:
        options->repeats =
            (uint32_t)ctl_option_count(state, "repeat", text, 0, REPEATS_MAX);
        options->has_repeats = true;
        return 0;
    case ARGP_KEY_ARG:
        options->paths[options->path_count++] = text;
        return 0;
    default:
        return parse_object(key, text, state);
    }
}

static const struct argp_child children[] = {{&frames_options_argp, 0, NULL, 0}, {0}};
const struct argp ask_options_argp = {
    .options = option_list, .parser = parse, .children = children};

int ask_options_read(struct ask_options *options, const struct argp *argp, int argc,
                     char **argv, void *input)
{
    options->link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    options->paths = malloc((size_t)argc * sizeof *options->paths);
    if (options->paths == NULL) {
        return ctl_complain("out of memory");
    }
    return argp_parse(argp, argc, argv, 0, NULL, input) == 0 ? CTL_DONE : CTL_FAILED;
}

void ask_options_deinit(struct ask_options *options)
{
    free(options->paths);
    ctl_link_deinit(&options->link);
}

int ask_set_object(const struct ask_options *options, struct pccd_client *client,
                   uint32_t scene, uint32_t object)
{
    return options->object.what == 0
               ? PCCD_OK
               : pccd_object_set(client, scene, object, &options->object);
}

FILE *ask_report_to(const struct ask_options *options)
{
    return options->csv != NULL && strcmp(options->csv, "-") == 0 ? stderr : stdout;
}

int ask_end(int status, bool is_right, const struct ctl_error *error, int closed,
            const struct ctl_error *close_error)
{
    if (status != PCCD_OK || closed != PCCD_OK) {
        ctl_error_tell(status != PCCD_OK ? error : close_error);
    }
    return (int)ctl_exit_of(status != PCCD_OK ? status : closed, is_right);
}
