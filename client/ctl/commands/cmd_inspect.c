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

#define MIB          (1u << 20)
#define SIZE_MAX_MIB 2048u /* browsers do not open much more */
#define EVERY_MAX    (1u << 30)
#define BOXES_MAX    (1u << 20)

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
     OPTION_U64, .at = AT(settings.bytes_max), .min = 1, .max = SIZE_MAX_MIB,
     .unit = MIB},
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

/* `wanted`: the --every that was asked for. */
static void print_done(const struct command *command, const struct inspect *inspect,
                       uint64_t wanted, uint64_t bytes)
{
    if (command->options.is_json) {
        json_t *object = json_pack(
            "{s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:b}", "file", json_text(command->path),
            "steps", (json_int_t)inspect->kept, "first", (json_int_t)inspect->first,
            "last", (json_int_t)inspect->last, "every",
            (json_int_t)command->settings.every, "bytes", (json_int_t)bytes, "differ",
            (json_int_t)inspect->differ, "full", inspect->is_full);
        (void)output_json(object, true, stdout);
    } else {
        printf("%s: %" PRIu64 " %s, %" PRIu64 " to %" PRIu64 ", %.1f MiB\n",
               tool_shown(command->path), inspect->kept,
               proto_plural(inspect->kept, "step", "steps"), inspect->first,
               inspect->last, (double)bytes / MIB);
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
    if (command->settings.every > wanted) {
        ctl_complain("the page has room for one step in %" PRIu64
                     ": --max-size allows more, --steps A..B shows each of fewer",
                     command->settings.every);
    } else if (inspect->is_full) {
        ctl_complain("the page was full after step %" PRIu64, inspect->last);
    }
}

static int write_page(struct command *command, struct whole_file *file,
                      struct inspect *inspect, struct play_summary *summary,
                      struct ctl_error *error)
{
    struct play_settings *play_settings = &command->options.play;
    struct page_file page;
    int status = inspect_init(inspect, &command->settings, &page, error);
    if (status == PCCD_OK) {
        status = inspect_begin_page(&page, file->to, command->path, error);
    }
    if (status == PCCD_OK) {
        status = play(play_settings, inspect_step, inspect, summary, error);
    }
    if (status == PCCD_OK && inspect->kept == 0) {
        status = ctl_error_set(error, PCCD_E_INVAL,
                               "%s holds no such step; it has %" PRIu64 ", the last "
                               "%" PRIu64,
                               play_settings->path, summary->frames + summary->questions,
                               summary->last_step);
    }
    if (status == PCCD_OK) {
        status =
            inspect_finish(inspect, tool_base_name(play_settings->path), summary, error);
    }
    return status;
}

/* Return one in how many steps has room, when those until inspect->last had. */
static uint64_t every_with_room(const struct command *command,
                                const struct inspect *inspect,
                                const struct play_summary *summary)
{
    uint64_t every = command->settings.every;
    uint64_t last = command->options.play.last;
    uint64_t end = last != 0 && last < summary->last_step ? last : summary->last_step;
    uint64_t all = end - inspect->first + 1;
    uint64_t fitting = inspect->last - inspect->first + every;
    return every * (all > fitting ? (all + fitting - 1) / fitting : 2);
}

/* Write the page of all steps, or of so few, evenly, that they have room: a page that
 * ended early would hide what comes then. What is written straight away, is written once.
 */
static int write_all(struct command *command, struct whole_file *file,
                     struct inspect *inspect, struct play_summary *summary,
                     struct ctl_error *error)
{
    for (;;) {
        int status = output_open(file, command->path, false, error);
        if (status == PCCD_OK) {
            status = write_page(command, file, inspect, summary, error);
        }
        if (status != PCCD_OK || !inspect->is_full || file->is_direct) {
            return status;
        }
        command->settings.every = every_with_room(command, inspect, summary);
        whole_file_discard(file);
        inspect_deinit(inspect);
    }
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
    command.options.play.source = PLAY_DAEMON;
    command.options.play.needs_records = true;
    command.options.play.is_traced = true;
    command.options.play.show_near = inspect_near;
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
    const uint64_t every = command.settings.every;
    if (status == PCCD_OK) {
        command.settings.names = command.options.play.names;
        command.settings.name_count = command.options.play.name_count;
        status = write_all(&command, &file, &inspect, &summary, &error);
    }
    uint64_t page_bytes = file.bytes;
    if (status == PCCD_OK) {
        status = output_finish(&file, command.path, &error);
    }
    if (status == PCCD_OK) {
        play_options_warn(&command.options.play, &summary);
        print_done(&command, &inspect, every, page_bytes);
    }
    whole_file_discard(&file);
    inspect_deinit(&inspect);
    if (status != PCCD_OK) {
        ctl_error_tell(&error);
    }
    play_options_deinit(&command.options);
    return (int)ctl_exit_of(status, true);
}
