/* ask_options.c - options of the commands that ask about files. */
#include "ask_options.h"

#include <float.h>
#include <string.h>

#include "columns.h"
#include "ctl.h"

#define REPEATS_MAX      1000000u
#define THREADS_MAX      1024u
#define DEADLINE_MS_MAX  3600000u
#define RESULT_BYTES_MIN 65536u
#define RESULT_BYTES_MAX ((uint64_t)1 << 40)
#define LENGTH_MAX       1e18
#define RINGS_MAX        8u
/* ---- mesh files -------------------------------------------------------------------- */

static void take_weld(struct argp_state *state, const struct option_row *row,
                      const char *text, void *to)
{
    struct ctl_frames_options *options = to;
    options->weld = strcmp(text, "auto") == 0  ? 0
                    : strcmp(text, "off") == 0 ? -1
                                               : option_real(state, row, text);
}

#define AT(member) offsetof(struct ctl_frames_options, member)
static const struct option_row frames_rows[] = {
    CTL_QUESTION,
    {"weld", 0, "auto|off|D",
     "Vertices are one where they are at the same place in every frame (auto, the "
     "default), or at most D apart",
     OPTION_OWN, .min = DBL_MIN, .max = LENGTH_MAX, .take = take_weld},
    {"animation", 0, "NAME",
     "Of a glTF file, the animation of that name, or number from 0 (default: all at "
     "once, or the first one where two move the same thing)",
     OPTION_TEXT, .at = AT(wish.animation)},
    {0}};
static const struct option_row rate_rows[] = {
    CTL_QUESTION,
    {"rate", 0, "N",
     "Of a file that moves by itself, N frames a second (default: its keyframes)",
     OPTION_REAL, .at = AT(wish.rate), .min = FRAMES_RATE_MIN, .max = FRAMES_RATE_MAX},
    {0}};
#undef AT

const struct option_table frames_without_rate_table = {.name = "FRAMES",
                                                       .rows = frames_rows};
const struct option_table frames_table = {
    .name = "FRAMES",
    .rows = rate_rows,
    .parts = (const struct option_part[]){{&frames_without_rate_table, 0}, {0}}};

bool frames_options_are_given(const struct ctl_frames_options *options)
{
    return options->weld != 0 || options->wish.rate > 0 ||
           options->wish.animation != NULL;
}

/* ---- questions about them ---------------------------------------------------------- */

static void take_tuning(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct ask_options *options = to;
    (void)row;
    if (strlen(text) >= PCCD_TUNING_BYTES) {
        option_misused(state, "--tuning: longer than %d bytes", PCCD_TUNING_BYTES - 1);
    }
    options->tuning = text;
}

static void take_repeat(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct ask_options *options = to;
    options->repeats = (uint32_t)option_number(state, row, text);
    options->has_repeats = true;
}

/* Take the radius of each object. */
static void take_thickness(struct argp_state *state, const struct option_row *row,
                           const char *text, void *to)
{
    struct pccd_object_settings *object = &((struct ask_options *)to)->object;
    object->radius = option_real(state, row, text);
    object->what |= PCCD_OBJECT_RADIUS;
}

static void take_rest_exclusion(struct argp_state *state, const struct option_row *row,
                                const char *text, void *to)
{
    struct pccd_object_settings *object = &((struct ask_options *)to)->object;
    object->rest_distance = option_real(state, row, text);
    object->what |= PCCD_OBJECT_REST_DISTANCE;
}

static void take_rings(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct pccd_object_settings *object = &((struct ask_options *)to)->object;
    object->rest_rings = (uint32_t)option_number(state, row, text);
    object->what |= PCCD_OBJECT_REST_RINGS;
}

#define AT(member) offsetof(struct ask_options, member)
static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = AT(files)},
    CTL_QUESTION,
    {"thickness", 0, "R",
     "Radius of every feature, in the unit of the files: two features of radius R meet "
     "when they are 2 R apart (default: 0)",
     OPTION_OWN, .max = LENGTH_MAX, .take = take_thickness},
    {"rest-exclusion", 0, "D",
     "Of a mesh's own pairs, those that are nearer than D in the first file have no "
     "thickness (default: 0)",
     OPTION_OWN, .max = LENGTH_MAX, .take = take_rest_exclusion},
    {"rings", 0, "N",
     "Of a mesh's own pairs, those that N edges or fewer join have no thickness, 0 to 8 "
     "(default: 0)",
     OPTION_OWN, .max = RINGS_MAX, .take = take_rings},
    CTL_OUTPUT,
    {"json", 0, NULL, "One JSON object instead of text", OPTION_FLAG, .at = AT(is_json)},
    {"repeat", 0, "N",
     "Time N more runs after the first and report medians (default: 1; 0 for each step "
     "of several)",
     OPTION_OWN, .max = REPEATS_MAX, .take = take_repeat},
    CTL_ENGINE,
    {"threads", 0, "N", "Use at most N threads (default: the daemon decides)", OPTION_U32,
     .at = AT(threads), .min = 1, .max = THREADS_MAX},
    {"method", 0, "default|paper|wide",
     "Method that finds the candidates: default, paper or wide; the answer is the same",
     OPTION_WORD, .at = AT(method)},
    {"tuning", 0, "STRING",
     "How threads share the work, such as scheduler=paper,refit=paper (default: the "
     "daemon decides)",
     OPTION_OWN, .take = take_tuning},
    {"deadline", 0, "MS", "End after MS milliseconds; the answer may then be incomplete",
     OPTION_U64, .at = AT(deadline_ns), .min = 1, .max = DEADLINE_MS_MAX,
     .unit = 1000000},
    {"result-bytes", 0, "N",
     "Size of the shared memory for answers; longer ones come in pages (default: 64 MiB)",
     OPTION_U64, .at = AT(link.result_bytes), .min = RESULT_BYTES_MIN,
     .max = RESULT_BYTES_MAX},
    {0}};
const struct option_table ask_table = {
    .rows = rows,
    .parts = (const struct option_part[]){{&frames_table, AT(frames)}, {0}}};

FILE *ask_report_to(const struct ask_options *options)
{
    FILE *to = options->csv != NULL && strcmp(options->csv, "-") == 0 ? stderr : stdout;
    return options->is_json ? to : columns_fitted(to);
}

int ask_end(int status, bool is_right, const struct ctl_error *error, int closed,
            const struct ctl_error *close_error)
{
    if (status != PCCD_OK || closed != PCCD_OK) {
        ctl_error_tell(status != PCCD_OK ? error : close_error);
    }
    return (int)ctl_exit_of(status != PCCD_OK ? status : closed, is_right);
}
