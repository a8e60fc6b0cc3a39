/* options.c - what the command line of pccd-load says. */
#include "load.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "actor.h"
#include "option_table.h"

/* The input that depends on more than one option. */
struct input {
    struct load_settings settings;
    double rate;
    uint32_t per_process;
    struct option_arguments daemon_options;
};

#define AT(member)  offsetof(struct input, settings.member)
#define OWN(member) offsetof(struct input, member)

/* ---- what may stand there ---------------------------------------------------------- */

static void take_arrivals(struct argp_state *state, const struct option_row *row,
                          const char *text, void *to)
{
    struct input *input = to;
    input->settings.poisson =
        option_word(state, row->name, text, strlen(text), row->arg) == 1;
}

static void take_kinds(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct input *input = to;
    input->settings.kinds = 0;
    for (;;) {
        size_t length = strcspn(text, ",");
        input->settings.kinds |=
            1u << option_word(state, row->name, text, length,
                              "follow|jump|rigid|pairs|churn|share|batch");
        if (text[length] == '\0') {
            return;
        }
        text += length + 1;
    }
}

static void take_sizes(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct input *input = to;
    if (!load_sizes_parse(&input->settings.sizes, text)) {
        option_misused(state,
                       "--%s: \"%s\" is no list of sizes, such as 200..5k or 1k:3,20k:1",
                       row->name, text);
    }
}

static void take_stall(struct argp_state *state, const struct option_row *row,
                       const char *text, void *to)
{
    struct load_settings *settings = &((struct input *)to)->settings;
    const struct option_row share_row = {.name = row->name, .max = 1};
    const struct option_row ms_row = {.name = row->name, .min = 1, .max = 60000};
    char share[32] = "";
    size_t length = strcspn(text, ",");
    if (text[length] != ',' || length >= sizeof share) {
        option_misused(state,
                       "--%s: \"%s\" is not a share and milliseconds, such as 0.01,200",
                       row->name, text);
        return;
    }
    memcpy(share, text, length);
    settings->stall_share = option_real(state, &share_row, share);
    settings->stall_ms = (uint32_t)option_number(state, &ms_row, text + length + 1);
}

/* ---- the options ------------------------------------------------------------------- */

static const struct option_row rows[] = {
#define LOAD_SCENE_TEXT(name, text) #name ": " text "; "
    {.type = OPTION_ARGUMENTS, .at = OWN(daemon_options)}, /* after --: for the daemon */
    {.help = "How many", .at = 1},
    {"clients", 'c', "N", "clients at once (default 100)", OPTION_U32, .at = AT(clients),
     .min = 1, .max = 65536},
    {"processes", 'p', "N", "processes that share the clients (default 4)", OPTION_U32,
     .at = AT(processes), .min = 1, .max = LOAD_PROCESS_MAX},
    {"clients-per-process", 0, "N", "instead of --processes", OPTION_U32,
     .at = OWN(per_process), .min = 1, .max = 65536},
    {"requests", 'n', "N", "of each client, at least (default 100, or 1 with a time)",
     OPTION_U64, .at = AT(requests), .min = 1, .max = UINT32_MAX},
    {"seconds", 0, "N", "go on at least so long, minutes added, after ramp and warm-up",
     OPTION_U32, .at = AT(seconds), .max = 1u << 20},
    {"minutes", 0, "N", "go on at least so long, seconds added", OPTION_U32,
     .at = AT(minutes), .max = 1u << 20},
    {"depth", 'd', "N", "requests of a client in flight (default 2)", OPTION_U32,
     .at = AT(depth), .min = 1, .max = LOAD_DEPTH_MAX},

    {.help = "When: in the closed loop (default) a client asks again when an answer has "
             "come",
     .at = 2},
    {"think-ms", 't', "N",
     "closed loop: between two requests of a client, about (default 0)", OPTION_U32,
     .at = AT(think_ms), .max = 60000},
    {"hz", 0, "F",
     "open loop: each client asks F times a second, whatever the answers do; latency "
     "counts from when a request is due",
     OPTION_REAL, .at = AT(hz), .min = 1e-3, .max = 1e5},
    {"rate", 0, "F", "open loop: all of them together F times a second", OPTION_REAL,
     .at = OWN(rate), .min = 1e-3, .max = 1e7},
    {"arrivals", 0, "fixed|poisson",
     "fixed: at even distances, clients spread over them (default); poisson: at random",
     OPTION_OWN, .take = take_arrivals},
    {"deadline-ms", 0, "F",
     "an answer that comes later is missed (default with --hz: the period)", OPTION_REAL,
     .at = AT(deadline_ms), .min = 1e-3, .max = 1e6},
    {"ramp", 0, "S", "clients join over S seconds", OPTION_REAL, .at = AT(ramp_s),
     .max = 1e5},
    {"warm-up", 0, "S", "latencies count S seconds after the ramp (default 0)",
     OPTION_REAL, .at = AT(warm_up_s), .max = 1e5},

    {.help = "What", .at = 3},
    {"triangles", 0, "SIZES",
     "of each client's scene: 1k; 200..5k, any octave as likely; 1k:3,20k:1 with weights "
     "(default 40)",
     OPTION_OWN, .take = take_sizes},
    {"scene", 0, "crumple|wave|apart", LOAD_SCENES(LOAD_SCENE_TEXT) "(default crumple)",
     OPTION_WORD, .at = AT(scene)},
    {"kinds", 0, "LIST",
     "clients are by turns (default all but batch): follow, from where the last step "
     "ended; jump, with both ends, and mischief; rigid; pairs; churn, which makes things "
     "anew; share, which holds its frames for a second client of its scene; batch, which "
     "steps many scenes by one request, each of which counts",
     OPTION_OWN, .take = take_kinds},
    {"batch", 0, "N", "scenes of each client of kind batch (default 8)", OPTION_U32,
     .at = AT(batch), .min = 1, .max = LOAD_BATCH_MAX},
    {"mode", 0, "all|first|any|pairs|first-per-pair",
     "of every step (default by kind)", OPTION_WORD,
     .at = AT(mode)},
    {"near", 0, NULL,
     "every second request asks what is near where it leads, instead of a step: "
     "vertices, nearest and crossings by turns; not of kind share",
     OPTION_FLAG, .at = AT(near)},
    {"seed", 's', "N", "of the scenes (default 1)", OPTION_U64, .at = AT(seed),
     .max = UINT64_MAX},

    {.help = "Trouble", .at = 4},
    {"stall", 0, "P,MS",
     "after this share of its requests a client stops reading for MS milliseconds",
     OPTION_OWN, .take = take_stall},
    {"kill-clients", 0, "N", "SIGKILL so many other clients", OPTION_U64, .at = AT(kills),
     .max = UINT32_MAX},
    {"victims", 0, "N", "of the clients to kill, at a time (default 8)", OPTION_U32,
     .at = AT(victims), .min = 1, .max = LOAD_VICTIM_MAX},
    {"kill-worker", 0, "N", "SIGKILL the daemon's worker so often", OPTION_U64,
     .at = AT(crashes), .max = UINT32_MAX},
    {"pause-ms", 0, "N", "between two kills of the worker, about (default 100)",
     OPTION_U32, .at = AT(pause_ms), .min = 1, .max = 3600000},

    {.help = "Whom", .at = 5},
    {"daemon", 0, "PROGRAM",
     "start it, supervised (default: $PCCD_DAEMON, or pccdd in $PATH)", OPTION_TEXT,
     .at = AT(daemon)},
    {"url", 'u', "URL",
     "unix:PATH: use that daemon instead; direct: no daemon, the engine in each process",
     OPTION_TEXT, .at = AT(url)},

    {.help = "What is said", .at = 6},
    {"json", 0, NULL, "the report as one JSON object", OPTION_FLAG, .at = AT(json)},
    {"csv", 0, "FILE", "a line for each second", OPTION_TEXT, .at = AT(csv)},
    {"percentiles", 0, "FILE", "latency by percentile, as CSV", OPTION_TEXT,
     .at = AT(percentiles)},
    {"p99-ms", 0, "F", "fail if that of the latency is longer", OPTION_REAL,
     .at = AT(p99_ms), .max = 1e6},
    {"flat", 0, NULL, "fail if the daemon's memory grows", OPTION_FLAG, .at = AT(flat)},
    {0}};
#undef LOAD_SCENE_TEXT

static void check(struct argp_state *state, void *to)
{
    const struct input *input = to;
    const struct load_settings *settings = &input->settings;
    const char *url = settings->url != NULL ? settings->url : "unix:";
    bool is_direct = strncmp(url, "direct:", 7) == 0;
    if (!is_direct && strncmp(url, "unix:", 5) != 0) {
        option_misused(state, "--url: \"%s\" is neither unix:PATH nor direct:", url);
    }
    if (is_direct && settings->crashes > 0) {
        option_misused(state, "--kill-worker: with direct: there is no daemon to kill");
    }
    if (settings->hz > 0 && input->rate > 0) {
        option_misused(state, "--hz is of each client, --rate of all: one of the two");
    }
}

static void complete(struct input *input)
{
    struct load_settings *settings = &input->settings;
    if (input->per_process > 0) {
        settings->processes =
            (settings->clients + input->per_process - 1) / input->per_process;
    }
    if (settings->processes > settings->clients) {
        settings->processes = settings->clients;
    }
    if (settings->processes > LOAD_PROCESS_MAX) {
        settings->processes = LOAD_PROCESS_MAX;
    }
    if (input->rate > 0) {
        settings->hz = input->rate / settings->clients;
    }
    if (settings->hz > 0 && settings->deadline_ms <= 0) {
        settings->deadline_ms = 1000 / settings->hz;
    }
    if (settings->requests == 0) {
        settings->requests = settings->seconds + settings->minutes > 0 ? 1 : 100;
    }
}

void load_options_parse(int argc, char **argv, struct load_settings *settings)
{
    static const struct option_table table = {
        .rows = rows,
        .check = check,
        .arguments = "[-- DAEMON-OPTION...]",
        .text =
            "Put a pccd daemon under the load of many clients, kill some of them and "
            "the daemon itself, and compare every answer with what a lone client gets.",
        .more = "Exit status: 0 all is as it must be; 1 something is not; 2 the command "
                "line is wrong; 3 no daemon could be started; 4 any other error.",
        .examples = "  pccd-load --clients 1000\n"
                    "  pccd-load --clients 64 --triangles 1k --scene wave --hz 60 "
                    "--kinds follow --seconds 60\n"};
    const char *daemon = getenv("PCCD_DAEMON");
    struct input input = {.settings = {.seed = 1,
                                       .clients = 100,
                                       .processes = 4,
                                       .depth = 2,
                                       .victims = 8,
                                       .pause_ms = 100,
                                       .kinds = LOAD_KINDS_USUAL,
                                       .batch = 8,
                                       .mode = -1,
                                       .sizes = {1, {{40, 40, 1}}},
                                       .daemon = daemon ? daemon : "pccdd"}};
    argp_err_exit_status = LOAD_USAGE;
    if (option_parse(&table, argc, argv, &input) != 0) {
        fputs("pccd-load: out of memory\n", stderr);
        exit(LOAD_FAILED);
    }
    complete(&input);
    if (input.daemon_options.list != NULL) {
        input.settings.daemon_options = input.daemon_options.list;
    }
    *settings = input.settings;
}
