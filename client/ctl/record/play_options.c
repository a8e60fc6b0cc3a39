/* play_options.c - options of the commands that read a recording. */
#include "play_options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ask_options.h"
#include "ctl.h"
#include "meshfile.h"
#include "output.h"

#define STEP_MAX    (1ull << 62)
#define THREADS_MAX 1024u

/* A, A.., ..B or A..B */
static void take_steps(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct play_settings *play = &((struct play_options *)to)->play;
    (void)row;
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
        option_misused(state, "--steps: \"%s\" is not A..B with 1 <= A <= B", text);
    }
}

static void check_files(struct argp_state *state, void *to)
{
    const struct play_options *options = to;
    if (options->files.count > 1 && !options->takes_frames && !options->takes_files) {
        option_misused(state, "one recording at a time");
    }
}

#define AT(member) offsetof(struct play_options, member)
static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS,
     .at = AT(files),
     .needed = "which recording? pccdctl record makes one"},
    CTL_QUESTION,
    {"steps", 0, "A..B",
     "From step A to step B, as the recorded program numbered them; A.. and ..B and A "
     "alone are ranges too. Steps before A are not repeated: the daemon is told where "
     "everything was",
     OPTION_OWN, .take = take_steps},
    CTL_OUTPUT,
    {"json", 0, NULL, "One JSON object instead of text", OPTION_FLAG, .at = AT(is_json)},
    CTL_ENGINE,
    {"method", 0, "paper|wide",
     "Compute the steps by the method paper or wide (default: as recorded)", OPTION_WORD,
     .at = AT(play.method), .min = PCCD_METHOD_PAPER},
    {"threads", 0, "N", "Use at most N threads (default: as recorded)", OPTION_U32,
     .at = AT(play.threads), .min = 1, .max = THREADS_MAX},
    {0}};
const struct option_table play_files_table = {
    .name = "REPLAY", .rows = rows, .check = check_files};
const struct option_table play_table = {
    .parts = (const struct option_part[]){
        {&play_files_table, 0}, {&ctl_link_table, AT(link)}, {0}}};

bool play_options_are_frames(const struct play_options *options)
{
    return options->takes_frames &&
           (options->files.count != 1 || ctl_mesh_is_named(options->files.list[0]) ||
            scene_is_named(options->files.list[0]));
}

static void check_frames(struct argp_state *state, void *to)
{
    const struct play_options *options = to;
    const struct scene_options *scene = &options->scene;
    if (!play_options_are_frames(options) && frames_options_are_given(&options->how)) {
        option_misused(state, "--weld, --rate, --animation: %s is a recording",
                       options->files.list[0]);
    }
    if (!play_options_are_frames(options) &&
        (scene->with.count + scene->between.count > 0 || scene->has_no_self)) {
        option_misused(state, "--with, --between, --no-self: %s is a recording",
                       options->files.list[0]);
    }
}

const struct option_table play_frames_table = {
    .parts =
        (const struct option_part[]){
            {&play_table, 0}, {&frames_table, AT(how)}, {&scene_table, AT(scene)}, {0}},
    .check = check_frames};
const struct option_table play_film_table = {
    .parts = (const struct option_part[]){{&play_table, 0},
                                          {&frames_without_rate_table, AT(how)},
                                          {&scene_table, AT(scene)},
                                          {0}},
    .check = check_frames};

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
    options->play.path = options->files.list[0];
    if (!play_options_are_frames(options)) {
        return PCCD_OK;
    }
    options->play.path = options->frames.name;
    options->play.from = options->frames.from;
    struct scene scene = {.frames = &options->how};
    int status = scene_take(&scene, &options->files, false, &options->scene, error);
    if (status == PCCD_OK) {
        status = frames_record(&options->frames, &scene, &options->files, &options->link,
                               error);
    }
    scene_close(&scene);
    return status;
}

void play_options_deinit(struct play_options *options)
{
    frames_forget(&options->frames);
    scene_options_deinit(&options->scene);
    ctl_link_deinit(&options->link);
    free(options->output);
}

const char *play_options_output(struct play_options *options, const char *ending)
{
    free(options->output);
    options->output = output_name(options->files.list[0], ending);
    return options->output;
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
