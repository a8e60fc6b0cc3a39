/* play_options.c - options of the commands that read a recording. */
#include "play_options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ask_options.h"
#include "ctl.h"
#include "meshfile.h"
#include "names.h"
#include "report.h"
#include "shown.h"

#define STEP_MAX    (1ull << 62)
#define THREADS_MAX 1024u

enum { OPTION_STEPS = 256 + 96, OPTION_METHOD, OPTION_THREADS, OPTION_JSON };

static const struct argp_option option_list[] = {
    {"steps", OPTION_STEPS, "A..B", 0,
     "From step A to step B, as the recorded program numbered them; A.. and ..B and A "
     "alone are ranges too. Steps before A are not repeated: the daemon is told where "
     "everything was",
     0},
    {"method", OPTION_METHOD, "paper|wide", 0,
     "Compute the steps by the method paper or wide (default: as recorded)", 0},
    {"threads", OPTION_THREADS, "N", 0, "Use at most N threads (default: as recorded)",
     0},
    {"json", OPTION_JSON, NULL, 0, "One JSON object instead of text", 0},
    {0},
};

/* A, A.., ..B or A..B */
static void parse_steps(const struct argp_state *state, const char *text,
                        struct play_settings *play)
{
    char *stop;
    play->first = text[0] == '.' ? 1 : strtoull(text, &stop, 10);
    stop = text[0] == '.' ? (char *)text : stop;
    bool is_ok = stop != text || text[0] == '.';
    if (*stop == '\0') {
        play->last = play->first;
    } else if (strncmp(stop, "..", 2) == 0) {
        const char *rest = stop + 2;
        play->last = *rest == '\0' ? 0 : strtoull(rest, &stop, 10);
        is_ok = is_ok && (*rest == '\0' || (*stop == '\0' && play->last >= play->first));
    } else {
        is_ok = false;
    }
    if (!is_ok || play->first == 0 || play->first > STEP_MAX || play->last > STEP_MAX) {
        tool_misused(state, "--steps: \"%s\" is not A..B with 1 <= A <= B", text);
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct play_options *options = state->input;
    switch (key) {
    case OPTION_STEPS:
        parse_steps(state, text, &options->play);
        return 0;
    case OPTION_METHOD:
        for (uint32_t i = 0; i < PCCD_METHOD_COUNT; i++) {
            if (strcmp(common_method_name((enum pccd_method)i), text) == 0) {
                options->play.method = (enum pccd_method)i;
                return 0;
            }
        }
        tool_misused(state, "--method: \"%s\" is not paper or wide", text);
        return EINVAL;
    case OPTION_THREADS:
        options->play.threads =
            (uint32_t)ctl_option_count(state, "threads", text, 1, THREADS_MAX);
        return 0;
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    case ARGP_KEY_ARGS:
        options->files = state->argv + state->next;
        options->file_count = (uint32_t)(state->argc - state->next);
        if (options->file_count > 1 && !options->takes_frames && !options->takes_files) {
            tool_misused(state, "one recording at a time");
        }
        return 0;
    case ARGP_KEY_NO_ARGS:
        tool_misused(state, "which recording? pccdctl record makes one");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp play_files_argp = {.options = option_list, .parser = parse};

static error_t parse_all(int key, char *text, struct argp_state *state)
{
    struct play_options *options = state->input;
    (void)text;
    if (key != ARGP_KEY_INIT) {
        return ARGP_ERR_UNKNOWN;
    }
    state->child_inputs[0] = options;
    state->child_inputs[1] = &options->link;
    return 0;
}

static const struct argp_child children[] = {
    {&play_files_argp, 0, NULL, 0}, {&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp play_options_argp = {.parser = parse_all, .children = children};

bool play_options_are_frames(const struct play_options *options)
{
    return options->takes_frames &&
           (options->file_count != 1 || ctl_mesh_is_named(options->files[0]));
}

static error_t parse_frames(int key, char *text, struct argp_state *state)
{
    struct play_options *options = state->input;
    (void)text;
    if (key == ARGP_KEY_INIT) {
        options->takes_frames = true;
        state->child_inputs[0] = options;
        state->child_inputs[1] = &options->how;
        return 0;
    }
    if (key == ARGP_KEY_END && options->file_count > 0 &&
        !play_options_are_frames(options) && frames_options_are_given(&options->how)) {
        tool_misused(state, "--weld, --rate, --animation: %s is a recording",
                     tool_shown(options->files[0]));
    }
    return key == ARGP_KEY_END ? 0 : ARGP_ERR_UNKNOWN;
}

static const struct argp_child frames_children[] = {
    {&play_options_argp, 0, NULL, 0}, {&frames_options_argp, 0, NULL, 0}, {0}};
const struct argp play_frames_argp = {.parser = parse_frames,
                                      .children = frames_children};
static const struct argp_child film_children[] = {
    {&play_options_argp, 0, NULL, 0}, {&frames_without_rate_argp, 0, NULL, 0}, {0}};
const struct argp play_film_argp = {.parser = parse_frames, .children = film_children};

void play_options_init(struct play_options *options, const char *label)
{
    memset(options, 0, sizeof *options);
    options->link.policy = CTL_LINK_PRIVATE_UNLESS_ENV;
    options->play.link = &options->link;
    options->play.label = label;
    options->play.first = 1;
}

int play_options_open(struct play_options *options, struct ctl_error *error)
{
    options->play.path = options->files[0];
    if (!play_options_are_frames(options)) {
        return PCCD_OK;
    }
    options->play.path = options->frames.name;
    options->play.from = options->frames.from;
    return frames_record(&options->frames, options->files, options->file_count,
                         &options->how, &options->link, error);
}

void play_options_deinit(struct play_options *options)
{
    frames_forget(&options->frames);
    ctl_link_deinit(&options->link);
}

void play_options_warn(const struct play_settings *settings,
                       const struct play_summary *summary)
{
    if (summary->ending == RECORD_ENDING_CUT) {
        ctl_complain("%s is cut off after byte %" PRIu64
                     ": what was being written then is lost",
                     settings->path, summary->ending_offset);
    } else if (summary->ending == RECORD_ENDING_UNKNOWN) {
        ctl_complain("%s is damaged after byte %" PRIu64 ": what comes then is lost",
                     settings->path, summary->ending_offset);
    } else if (summary->ending == RECORD_ENDING_OPEN) {
        ctl_complain("%s has no end: its program was killed, or still runs",
                     settings->path);
    } else if (summary->end_reason == RECORD_FULL) {
        ctl_complain("%s ends because it was full, or could not be written",
                     settings->path);
    } else if (summary->end_reason == RECORD_UNWRITTEN) {
        ctl_complain("%s ends because it could not be written", settings->path);
    } else if (summary->end_reason == RECORD_APART) {
        ctl_complain("%s ends where what came next could not be repeated: a mesh became "
                     "a part of one over ranks, or what others did was not known",
                     settings->path);
    }
}
