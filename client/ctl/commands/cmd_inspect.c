/* cmd_inspect.c - pccdctl inspect. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>

#include "ctl.h"
#include "inspect.h"
#include "output.h"
#include "play_options.h"
#include "printable.h"
#include "shown.h"
#include "whole_file.h"

#define EVERY_MAX (1u << 30)
#define BOXES_MAX (1u << 20)

struct command {
    struct play_options options;
    struct inspect_settings settings;
    const char *path;
};

static void take_output(struct argp_state *state, const struct option_row *row,
                        const char *text, void *to)
{
    struct command *command = to;
    (void)row;
    if (!tool_ends_with(text, ".html")) {
        option_misused(state, "-o: \"%s\" does not end with .html", text);
    }
    command->path = text;
}

static void take_no_lanes(struct argp_state *state, const struct option_row *row,
                          const char *text, void *to)
{
    struct command *command = to;
    (void)state;
    (void)row;
    (void)text;
    command->options.play.is_traced = false;
}

#define AT(member) offsetof(struct command, member)
static const struct option_row rows[] = {
    CTL_OUTPUT,
    {"output", 'o', "FILE",
     "Where the page goes: FILE.html (default: the name of the first file, with .html)",
     OPTION_OWN, .at = AT(path), .take = take_output},
    {"every", 0, "N", "Show one in N steps (default: each)", OPTION_U64,
     .at = AT(settings.every), .min = 1, .max = EVERY_MAX},
    {"max-size", 0, "MIB",
     "Let the page have at most MIB mebibytes (default: 64). If not all steps fit, only "
     "one in so many is shown that they do, and a line on standard error says so",
     OPTION_U64, .at = AT(settings.bytes_max), .min = 1, .max = INSPECT_MIB_MAX,
     .unit = INSPECT_MIB},
    {"up", 0, "x|y|z",
     "The axis that points up (default: as recorded; else the one along which things "
     "fall, if the motion is plain, or y)",
     OPTION_WORD, .at = AT(settings.up), .min = 1},
    {"round", 0, NULL,
     "Store coordinates in 16 bits each, which halves the page; they are then rounded to "
     "a 65535th of their object's size",
     OPTION_FLAG, .at = AT(settings.is_rounded)},
    {"boxes", 0, "N",
     "Show the levels of the hierarchies that have at most N boxes (default: 512; 0: "
     "none)",
     OPTION_U32, .at = AT(settings.boxes_max), .min = 0, .max = BOXES_MAX},
    {"no-lanes", 0, NULL, "Leave out what the daemon's threads do at each step",
     OPTION_OWN, .take = take_no_lanes},
    {0}};

const struct option_table ctl_table_inspect = {
    .rows = rows,
    .parts = (const struct option_part[]){{&play_frames_table, AT(options)}, {0}},
    .arguments = "FILE\nFRAME [FRAME...]\nSCENE",
    .text = "Repeat the steps of a recording, or of the frames of a mesh, with a "
            "daemon, and write them as a page that any browser opens: the objects in "
            "motion, the contacts by kind and time, the boxes of the hierarchies, "
            "and what each phase and each thread took.",
    .more = "The page is one file, which asks for nothing over a network. Without "
            "--url and --socket a private daemon is started.",
    .examples = "  pccdctl inspect -o run.html run.rec\n"
                "  pccdctl inspect -o run.html --every 10 --round --up z seq%d.obj\n",
};

/* ---- the page ---------------------------------------------------------------------- */

static void print_done(const struct command *command, const struct inspect *inspect,
                       uint64_t bytes)
{
    const uint64_t every = inspect->settings.every;
    if (command->options.is_json) {
        json_t *object = json_pack(
            "{s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:b}", "file", json_text(command->path),
            "steps", (json_int_t)inspect->kept, "first", (json_int_t)inspect->first,
            "last", (json_int_t)inspect->last, "every", (json_int_t)every, "bytes",
            (json_int_t)bytes, "differ", (json_int_t)inspect->differ, "full",
            inspect->is_full);
        (void)output_json(object, true, stdout);
    } else {
        printf("%s: %" PRIu64 " %s, %" PRIu64 " to %" PRIu64 ", %.1f MiB\n",
               tool_shown(command->path), inspect->kept,
               proto_plural(inspect->kept, "step", "steps"), inspect->first,
               inspect->last, (double)bytes / INSPECT_MIB);
    }
    if (inspect->differ > 0) {
        ctl_complain("%" PRIu64 " %s", inspect->differ,
                     proto_plural(inspect->differ,
                                  "answer is another than the recorded one",
                                  "answers are others than the recorded ones"));
    }
    if (inspect->no_lanes[0] != '\0') {
        ctl_complain("without what threads did: %s", inspect->no_lanes);
    }
    if (every > command->settings.every) {
        ctl_complain("the page has room for one step in %" PRIu64
                     ": --max-size allows more, --steps A..B shows each of fewer",
                     every);
    } else if (inspect->is_full) {
        ctl_complain("the page was full after step %" PRIu64, inspect->last);
    }
}

/* The steps that were asked for, as an inspect_fill_fn whose context is their
 * play_settings. */
static int fill(void *context, struct inspect *inspect, struct play_summary *summary,
                uint64_t *all, struct ctl_error *error)
{
    const struct play_settings *settings = context;
    int status = play(settings, inspect_step, inspect, summary, error);
    if (status == PCCD_OK && inspect->kept == 0) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s holds no such step; it has %" PRIu64 ", the last "
                               "%" PRIu64,
                               settings->path, summary->frames + summary->questions,
                               summary->last_step);
    }
    uint64_t last = settings->last;
    last = last != 0 && last < summary->last_step ? last : summary->last_step;
    *all = last - inspect->first + 1;
    return status;
}

int ctl_cmd_inspect(int argc, char **argv)
{
    struct command command = {.settings = {.every = 1,
                                           .boxes_max = INSPECT_BOXES_DEFAULT,
                                           .bytes_max = INSPECT_BYTES_DEFAULT}};
    struct ctl_error error = {.text = ""};
    struct whole_file file = {.to = NULL};
    struct inspect inspect = {.kept = 0};
    struct play_summary summary;
    play_options_init(&command.options, "steps");
    command.options.takes_frames = true;
    command.options.frames.tells_start = true;
    command.options.play.source = PLAY_DAEMON;
    command.options.play.needs_records = true;
    command.options.play.is_traced = true;
    command.options.play.shows_near = true;
    if (option_parse(&ctl_table_inspect, argc, argv, &command) != 0) {
        return CTL_USAGE;
    }
    if (command.path == NULL) {
        command.path = play_options_output(&command.options, ".html");
    }
    int status = command.path != NULL
                     ? inspect_has_page(&error)
                     : ctl_error_set(&error, PCCD_E_NOMEM, "out of memory");
    if (status == PCCD_OK) {
        status = play_options_open(&command.options, &error);
    }
    if (status == PCCD_OK) {
        const struct play_settings parts[2] = {command.options.play};
        command.settings.up =
            command.settings.up != 0 ? command.settings.up : play_up(parts);
        command.settings.between = command.options.scene.between;
        command.settings.has_no_self = command.options.scene.has_no_self;
        command.settings.is_of_files = play_options_are_frames(&command.options);
        const struct inspect_source source = {command.path,
                                              tool_base_name(command.options.play.path),
                                              fill, &command.options.play};
        status =
            inspect_write(&inspect, &command.settings, &source, &file, &summary, &error);
    }
    uint64_t page_bytes = file.bytes;
    if (status == PCCD_OK) {
        status = output_finish(&file, command.path, &error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&command.options.play, &summary);
        print_done(&command, &inspect, page_bytes);
    }
    whole_file_discard(&file);
    inspect_deinit(&inspect);
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&command.options);
    return (int)ctl_exit_of(status, true);
}
