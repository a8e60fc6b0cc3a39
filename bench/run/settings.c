/* settings.c - what pccd-bench was asked for. */
#include "settings.h"

#include <stdlib.h>
#include <string.h>

#include "option_table.h"
#include "question.h"

#define STEPS_MAX 1000000u
#define WORDS_MAX 32 /* of --beside */

/* The command line, as far as it is not what is measured. */
struct input {
    struct run_settings settings;
    struct option_arguments arguments;
};

#define SIDE(member) offsetof(struct run_side, member)
#define AT(member)   offsetof(struct input, settings.member)

/* ---- one side ---------------------------------------------------------------------- */

static void take_tuning(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct run_side *side = to;
    struct eng_tuning tuning = {0};
    char why[ENG_TUNING_WHY_BYTES];
    if (eng_tuning_read(text, &tuning, why) != PCCD_OK) {
        option_misused(state, "--%s: %s", row->name, why);
    }
    side->step.tuning = text;
}

static void take_cpu(struct argp_state *state, const struct option_row *row,
                     const char *text, void *to)
{
    struct run_side *side = to;
    (void)option_word(state, row->name, text, strlen(text), row->arg);
    side->cpu = text;
}

/* WHAT, or WHAT:SHARE. */
static void take_moving(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    static const struct option_row share_row = {.name = "moving", .max = 1};
    struct bench_moving *moving = &((struct run_side *)to)->moving;
    size_t bytes = strcspn(text, ":");
    if (text[bytes] == ':') {
        moving->what = BENCH_MOVING_OBJECTS + option_word(state, row->name, text, bytes,
                                                          "objects|patch|vertices");
        moving->share = option_real(state, &share_row, text + bytes + 1);
        return;
    }
    uint32_t word = option_word(state, row->name, text, bytes, "told|none|all");
    moving->what = word == 0 ? BENCH_MOVING_TOLD : BENCH_MOVING_VERTICES;
    moving->share = word == 2;
}

static void check_side(struct argp_state *state, void *to)
{
    const struct run_side *side = to;
    if (side->sends != RUN_SENDS_ALL && side->via == RUN_VIA_ENGINE) {
        option_misused(state, "--sends: only with --via daemon or direct");
    }
    if (side->rebuild_ratio != 0 && side->via != RUN_VIA_ENGINE) {
        option_misused(state, "--rebuild-ratio: only with --via engine");
    }
    if (side->is_team && side->via != RUN_VIA_ENGINE) {
        option_misused(state, "--team: only with --via engine");
    }
}

static const struct option_row side_rows[] = {
    {.help = "How a step is computed", .at = 2},
    {"via", 0, "engine|daemon|direct",
     "who computes: the engine in this process (the default), a private daemon by "
     "libpccd, or libpccd's url direct:",
     OPTION_WORD, .at = SIDE(via)},
    {"mode", 0, "all|first|any|pairs",
     "every contact (the default), the earliest, yes or no, candidate pairs", OPTION_WORD,
     .at = SIDE(step.mode)},
    {"method", 0, "default|paper|wide", "how candidates are found", OPTION_WORD,
     .at = SIDE(step.method)},
    {"threads", 0, "N", "at most N threads a step (default: 1)", OPTION_U32,
     .at = SIDE(step.threads), .min = 1, .max = 1024},
    {"team", 0, NULL, "all of them also where one would be faster (engine only)",
     OPTION_FLAG, .at = SIDE(is_team)},
    {"tuning", 0, "STRING",
     "how threads share the work, such as scheduler=paper,refit=paper (pccd.h); empty: "
     "the default",
     OPTION_OWN, .take = take_tuning},
    {"rebuild-ratio", 0, "R",
     "rebuild a subtree whose box has less than R times the volume of its two halves' "
     "(method paper; default: 0.9; negative: never)",
     OPTION_REAL, .at = SIDE(rebuild_ratio), .min = -1e9L, .max = 1},
    {"fresh", 0, NULL,
     "make a scene for each step, and free it: what a function takes that keeps nothing",
     OPTION_FLAG, .at = SIDE(is_fresh)},
    {"moving", 0, "told|none|all|objects:SHARE|patch:SHARE|vertices:SHARE",
     "what moves: all as it is told (the default); or this part, such as objects:0.01, "
     "goes to and fro between the first frame that counts and the next one, and all else "
     "stands",
     OPTION_OWN, .take = take_moving},
    {"sends", 0, "all|moved|poses",
     "hand over every position (the default), only those that change, or poses of what "
     "only turns and shifts (daemon and direct only)",
     OPTION_WORD, .at = SIDE(sends)},
    {"separation", 0, "R",
     "features meet within R times the median edge of the first frame (default: 0)",
     OPTION_REAL, .at = SIDE(separation), .max = 1},
    {"approach", 0, "SHARE",
     "those that begin nearer meet at this share of the distance they begin with "
     "(default: 0, at once)",
     OPTION_REAL, .at = SIDE(step.approach), .max = 1},
    {"cpu", 0, "scalar|sse2|sse4|avx2|avx512|neon",
     "instruction set (default: $PCCD_CPU, or the best)", OPTION_OWN, .take = take_cpu},
    {0}};

static const struct option_table side_table = {
    .rows = side_rows, .check = check_side, .text = "A way to compute a step."};

/* ---- all of it --------------------------------------------------------------------- */

/* FIRST-LAST, how many, or from the hard one on. */
static void take_frames(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct run_settings *settings = &((struct input *)to)->settings;
    const struct option_row steps = {.name = row->name, .max = STEPS_MAX};
    struct option_row rest = steps;
    char first[16];
    size_t bytes = strcspn(text, "-");
    settings->has_frames = true;
    settings->first = 0;
    if (strcmp(text, "hard") == 0 || strncmp(text, "hard+", 5) == 0) {
        settings->is_hard = true;
        settings->last = text[4] ? (uint32_t)option_number(state, &steps, text + 5) : 0;
    } else if (text[bytes] == '\0') {
        rest.min = 1;
        settings->last = (uint32_t)option_number(state, &rest, text) - 1;
    } else {
        (void)snprintf(first, sizeof first, "%.*s", (int)bytes, text);
        settings->first = (uint32_t)option_number(state, &steps, first);
        rest.min = settings->first;
        settings->last = (uint32_t)option_number(state, &rest, text + bytes + 1);
    }
}

static void take_beside(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct run_settings *settings = &((struct input *)to)->settings;
    if (settings->side_count == RUN_SIDES_MAX) {
        option_misused(state, "--%s: at most %u times", row->name, RUN_SIDES_MAX - 1);
        return;
    }
    settings->sides[settings->side_count++].label = text;
}

static void check(struct argp_state *state, void *to)
{
    struct input *input = to;
    const struct option_arguments *arguments = &input->arguments;
    if (arguments->count > 1) {
        option_misused(state, "one scene at a time: \"%s\" or \"%s\"", arguments->list[0],
                       arguments->list[1]);
    }
    if (arguments->count == 0 && !input->settings.wants_list) {
        option_misused(state, "which scene? --list names them");
    }
    input->settings.scene = arguments->count > 0 ? arguments->list[0] : NULL;
}

static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS, .at = offsetof(struct input, arguments)},
    {.help = "Which steps, and what is told of them", .at = 1},
    {"list", 0, NULL, "print the names of the scenes", OPTION_FLAG, .at = AT(wants_list)},
    {"small", 0, NULL, "the small scene of that name, of a few thousand triangles",
     OPTION_FLAG, .at = AT(is_small)},
    {"frames", 0, "FIRST-LAST|N|hard|hard+N",
     "time these steps, from 0, or the first N (default: all); step i goes from frame i "
     "to the next. hard: the step that takes longest, and N more, as far as there are",
     OPTION_OWN, .take = take_frames},
    {"warm-up", 0, "N",
     "make N steps before those that are timed, which do not count; where there are not "
     "so many, the first one again and again (default: 2)",
     OPTION_U32, .at = AT(warm_up), .max = STEPS_MAX},
    {"repeat", 0, "N",
     "play everything N times, each time a new scene; of each step the pass that took "
     "the least is kept, with its phases (default: 1)",
     OPTION_U32, .at = AT(repeat), .min = 1, .max = 1000000},
    {"hz", 0, "N",
     "begin a step so many times a second, as a game does (default: as soon as the last "
     "one ended)",
     OPTION_U32, .at = AT(hz), .min = 1, .max = 10000},
    {"beside", 0, "OPTIONS",
     "take each step once more with these options besides the others, such as "
     "\"--threads 2\", by turns; may be given several times. Answers must agree, and "
     "times are compared",
     OPTION_OWN, .take = take_beside},
    {"format", 0, "text|csv|json",
     "a summary to read (the default), a line for each step, or one object with all of "
     "it",
     OPTION_WORD, .at = AT(format)},
    {"output", 'o', "FILE", "write there instead of to the standard output", OPTION_TEXT,
     .at = AT(path)},
    {0}};

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
    if (option_parse(&side_table, count, words, side) != 0) {
        exit(2);
    }
}

void run_settings_read(struct run_settings *settings, int argc, char **argv)
{
    static const struct option_part parts[] = {{&side_table, AT(sides[0])}, {0}};
    static const struct option_table table = {
        .rows = rows,
        .parts = parts,
        .check = check,
        .arguments = "SCENE\nkernel|pair|client [PART] [--json] [--smoke] [NAME]",
        .text =
            "Time the steps of one scene, and count their work; or measure a section, "
            "or a part of it: kernel (kernels, roofline), pair (exact, distances, "
            "slowest), client (batch, connect, death, ipc, late).",
        .more =
            "Exit status: 0; 1 when an answer was incomplete or differed from pass to "
            "pass or from one side to another; 2 when it could not be asked for; 77 "
            "when the scene's recorded frames are not in $PCCD_DATA."};
    struct input input = {
        .settings = {
            .warm_up = 2,
            .repeat = 1,
            .side_count = 1,
            .sides[0] = {.label = "",
                         .step = {.struct_bytes = sizeof(struct pccd_step_settings),
                                  .threads = 1}}}};
    argp_err_exit_status = 2;
    if (option_parse(&table, argc, argv, &input) != 0) {
        exit(2);
    }
    *settings = input.settings;
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
    static const char *const names[RUN_VIAS] = {"engine", "daemon", "direct"};
    return names[via];
}
