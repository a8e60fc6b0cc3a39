/* cmd_load.c - pccdctl load. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "ask_options.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "player.h"
#include "printable.h"
#include "shown.h"
#include "statistics.h"
#include "terminal.h"

#define TIMES_MAX  1000000000u
#define FRAMES_MAX 100000u
#define STILL_MAX  64u
#define HZ_MAX     100000.0

enum {
    OPTION_HZ = 256 + 64,
    OPTION_TIMES,
    OPTION_SECONDS,
    OPTION_WITH,
    OPTION_THREADS,
    OPTION_SCENE,
    OPTION_HOLD,
    OPTION_JSON
};

struct load_options {
    struct ctl_link link;
    struct player_settings player;
    char **frames; /* argv's */
    char *still[STILL_MAX];
    bool is_json;
};

static const struct argp_option option_list[] = {
    {"hz", OPTION_HZ, "N", 0,
     "Steps a second; those that come late are counted (default: as fast as they are "
     "answered)",
     0},
    {"times", OPTION_TIMES, "N", 0,
     "Play the sequence N times, forwards and backwards by turns (default: 1)", 0},
    {"seconds", OPTION_SECONDS, "S", 0, "Play for S seconds instead", 0},
    {"with", OPTION_WITH, "FILE", 0,
     "Add another mesh that stands still; may be repeated", 0},
    {"threads", OPTION_THREADS, "N", 0,
     "Use at most N threads (default: the daemon decides)", 0},
    {"scene", OPTION_SCENE, "NAME", 0,
     "Play in the shared scene of that name, which is made unless there is one", 0},
    {"hold", OPTION_HOLD, NULL, 0,
     "With --scene: hold each frame until another client submits a step, and go along "
     "with it",
     0},
    {"json", OPTION_JSON, NULL, 0, "One JSON object at the end", 0},
    {0},
};

static error_t parse_rest(int key, char *text, struct argp_state *state)
{
    struct load_options *options = state->input;
    switch (key) {
    case OPTION_JSON:
        options->is_json = true;
        return 0;
    case ARGP_KEY_ARGS:
        options->frames = state->argv + state->next;
        options->player.file_count = (uint32_t)(state->argc - state->next);
        return 0;
    case ARGP_KEY_NO_ARGS:
        tool_misused(state, "a file at least: PLY, OBJ, STL or glTF");
        return 0;
    case OPTION_SCENE:
        options->player.scene = text;
        return 0;
    case OPTION_HOLD:
        options->player.holds = true;
        return 0;
    case ARGP_KEY_END:
        if (options->player.holds && options->player.scene == NULL) {
            tool_misused(state, "--hold: only in a shared scene, which --scene names");
        }
        if (options->player.file_count > FRAMES_MAX) {
            tool_misused(state, "at most %u files", FRAMES_MAX);
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct load_options *options = state->input;
    struct player_settings *player = &options->player;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->player.frames;
        state->child_inputs[1] = &options->link;
        return 0;
    case OPTION_HZ:
        player->hz = ctl_option_real(state, "hz", text, 0.001, HZ_MAX);
        return 0;
    case OPTION_TIMES:
        player->times = (uint32_t)ctl_option_count(state, "times", text, 1, TIMES_MAX);
        return 0;
    case OPTION_SECONDS:
        player->seconds = ctl_option_real(state, "seconds", text, 0.001, 1e9);
        return 0;
    case OPTION_WITH:
        if (player->still_count == STILL_MAX) {
            tool_misused(state, "--with: at most %u meshes", STILL_MAX);
        }
        options->still[player->still_count++] = text;
        return 0;
    case OPTION_THREADS:
        player->threads = (uint32_t)ctl_option_count(state, "threads", text, 1, 1024);
        return 0;
    default:
        return parse_rest(key, text, state);
    }
}

static const struct argp_child children[] = {
    {&frames_options_argp, 0, NULL, 0}, {&ctl_link_argp, 0, "Daemon:", 10}, {0}};
const struct argp ctl_argp_load = {
    .options = option_list,
    .parser = parse,
    .args_doc = "FRAME [FRAME...]",
    .doc =
        "Put a mesh, or the frames of one, into a new scene of a daemon, or into one "
        "that "
        "is shared there, and play it; a single frame stands still.\v"
        "Without --url and --socket the user's own daemon gets it, and is started if it "
        "does not run. All frames have the same faces. An interrupt (Ctrl-C) ends it.",
    .children = children};

static void print(const struct player *player, bool is_json)
{
    double *ms = player->times_ms;
    uint32_t kept = player->kept;
    double p50 = kept > 0 ? statistics_median(ms, kept) : 0;
    double p99 = kept > 0 ? statistics_quantile(ms, kept, 0.99) : 0;
    double most = kept > 0 ? ms[kept - 1] : 0;
    if (is_json) {
        json_t *object = json_pack(
            "{s:I, s:I, s:I, s:f, s:I, s:I, s:f, s:f, s:f, s:f}", "steps",
            (json_int_t)player->steps, "triangles", (json_int_t)player->triangles,
            "contacts", (json_int_t)player->contacts, "contacts_a_step",
            player->steps > 0 ? (double)player->contacts / (double)player->steps : 0.0,
            "incomplete", (json_int_t)player->incomplete, "late",
            (json_int_t)player->late, "seconds", player->seconds, "p50_ms", p50, "p99_ms",
            p99, "max_ms", most);
        json_dumpf(object, stdout, JSON_TEXT_FLAGS);
        putchar('\n');
        json_decref(object);
        return;
    }
    printf("steps       %" PRIu64 " in %.2f s, %.1f a second\n", player->steps,
           player->seconds,
           player->seconds > 0 ? (double)player->steps / player->seconds : 0.0);
    printf("triangles   %" PRIu64 "\n", player->triangles);
    printf("contacts    %" PRIu64 "; %" PRIu64 " %s incomplete\n", player->contacts,
           player->incomplete, proto_plural(player->incomplete, "answer", "answers"));
    printf("round trip  p50 %.3f ms, p99 %.3f ms, max %.3f ms\n", p50, p99, most);
    if (player->settings->hz > 0) {
        printf("late        %" PRIu64 " of them began after their time\n", player->late);
    }
}

int ctl_cmd_load(int argc, char **argv)
{
    struct load_options options = {.link = {.policy = CTL_LINK_USER},
                                   .player = {.times = 1}};
    struct ctl_error error = {.text = ""};
    struct player player = {.client = NULL};
    if (argp_parse(&ctl_argp_load, argc, argv, 0, NULL, &options) != 0) {
        return CTL_USAGE;
    }
    options.player.files = options.frames;
    options.player.still = options.still;
    int status = player_read(&player, &options.player, &error) == PCCD_OK
                     ? ctl_link_open(&options.link, &player.client)
                     : ctl_complain("%s", error.text);
    if (status == CTL_DONE) {
        terminal_catch_interrupts();
        if (player_play(&player, &error) == PCCD_OK) {
            statistics_sort(player.times_ms, player.kept);
            print(&player, options.is_json);
        } else {
            status = ctl_complain("%s", error.text);
        }
    }
    pccd_close(player.client);
    player_deinit(&player);
    ctl_link_deinit(&options.link);
    return status;
}
