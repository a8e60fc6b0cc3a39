/* cmd_load.c - pccdctl load. */
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>

#include "ask_options.h"
#include "ctl.h"
#include "link.h"
#include "output.h"
#include "player.h"
#include "printable.h"
#include "statistics.h"
#include "terminal.h"

#define TIMES_MAX  1000000000u
#define FRAMES_MAX 100000u
#define HZ_MAX     100000.0

struct load_options {
    struct ctl_link link;
    struct player_settings player;
    struct ctl_frames_options reading;
    struct scene_options scene;
    struct option_arguments frames;
    bool is_json;
};

static void check(struct argp_state *state, void *to)
{
    const struct load_options *options = to;
    if (options->player.holds && options->player.scene == NULL) {
        option_misused(state, "--hold: only in a shared scene, which --scene names");
    }
    if (options->frames.count > FRAMES_MAX) {
        option_misused(state, "at most %u files", FRAMES_MAX);
    }
}

#define AT(member) offsetof(struct load_options, member)
static const struct option_row rows[] = {
    {.type = OPTION_ARGUMENTS,
     .at = AT(frames),
     .needed = "a file at least: PLY, OBJ, STL or glTF"},
    CTL_QUESTION,
    {"hz", 0, "N",
     "Steps a second; those that come late are counted (default: as fast as they are "
     "answered)",
     OPTION_REAL, .at = AT(player.hz), .min = 0.001, .max = HZ_MAX},
    {"times", 0, "N",
     "Play the sequence N times, forwards and backwards by turns (default: 1)",
     OPTION_U32, .at = AT(player.times), .min = 1, .max = TIMES_MAX},
    {"seconds", 0, "S", "Play for S seconds instead", OPTION_REAL,
     .at = AT(player.seconds), .min = 0.001, .max = 1e9},
    {"scene", 0, "NAME",
     "Play in the shared scene of that name, which is made unless there is one",
     OPTION_TEXT, .at = AT(player.scene)},
    {"hold", 0, NULL,
     "With --scene: hold each frame until another client submits a step, and go along "
     "with it",
     OPTION_FLAG, .at = AT(player.holds)},
    CTL_OUTPUT,
    {"json", 0, NULL, "One JSON object at the end", OPTION_FLAG, .at = AT(is_json)},
    CTL_ENGINE,
    {"threads", 0, "N", "Use at most N threads (default: the daemon decides)", OPTION_U32,
     .at = AT(player.threads), .min = 1, .max = 1024},
    {0}};

const struct option_table ctl_table_load = {
    .rows = rows,
    .parts = (const struct option_part[]){{&frames_table, AT(reading)},
                                          {&scene_table, AT(scene)},
                                          {&ctl_link_table, AT(link)},
                                          {0}},
    .check = check,
    .arguments = "FRAME [FRAME...]\nSCENE",
    .text = "Put a mesh, or the frames of one, into a new scene of a daemon, or into "
            "one that is shared there, and play it; a single frame stands still.",
    .more = "Without --url and --socket the user's own daemon gets it, and is "
            "started if it does not run. All frames have the same faces. An "
            "interrupt (Ctrl-C) ends it.",
    .examples = "  pccdctl load --hz 60 --seconds 10 seq%d.obj\n"
                "  pccdctl load --with floor.obj ball.glb\n",
};

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
        (void)output_json(object, true, stdout);
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

/* Read all before a daemon is asked for: a bad file costs nothing else. */
static int read_scene(struct player *player, struct scene *scene,
                      const struct load_options *options, struct ctl_error *error)
{
    int status = scene_take(scene, &options->frames, false, &options->scene, error);
    if (status == PCCD_OK) {
        status = scene_open(scene, error);
    }
    return status == PCCD_OK ? player_read(player, scene, &options->player, error)
                             : status;
}

int ctl_cmd_load(int argc, char **argv)
{
    struct load_options options = {.link = {.policy = CTL_LINK_USER},
                                   .player = {.times = 1}};
    struct ctl_error error = {.text = ""};
    struct scene scene = {.frames = &options.reading};
    struct player player = {.client = NULL};
    if (option_parse(&ctl_table_load, argc, argv, &options) != 0) {
        return CTL_USAGE;
    }
    int status = read_scene(&player, &scene, &options, &error) == PCCD_OK
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
    scene_close(&scene);
    scene_options_deinit(&options.scene);
    ctl_link_deinit(&options.link);
    return status;
}
