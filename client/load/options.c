/* options.c - what the command line of pccd-load says.
 *
 * Room:     client/load.
 * Does:     see options.h.
 * Threads:  one.
 */
#include "options.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "actor.h"

enum {
    OPT_CLIENTS = 'c',
    OPT_REQUESTS = 'n',
    OPT_PROCESSES = 'p',
    OPT_DEPTH = 'd',
    OPT_THINK = 't',
    OPT_SEED = 's',
    OPT_URL = 'u',
    OPT_DAEMON = 0x100,
    OPT_HZ,
    OPT_RATE,
    OPT_ARRIVALS,
    OPT_RAMP,
    OPT_WARM_UP,
    OPT_DEADLINE,
    OPT_P99,
    OPT_STALL,
    OPT_TRIANGLES,
    OPT_SCENE,
    OPT_KINDS,
    OPT_MODE,
    OPT_PER_PROCESS,
    OPT_MINUTES,
    OPT_SECONDS,
    OPT_VICTIMS,
    OPT_KILL_CLIENTS,
    OPT_KILL_WORKER,
    OPT_PAUSE,
    OPT_FLAT,
    OPT_JSON,
    OPT_CSV,
    OPT_PLOT
};

static const char *const kind_names[LOAD_KINDS] = {"follow", "jump", "rigid", "pairs",
                                                   "churn"};

static const char *const scene_names[LOAD_SCENE_COUNT] = {
#define LOAD_SCENE_NAME(name, text) [LOAD_SCENE_##name] = #name,
    LOAD_SCENES(LOAD_SCENE_NAME)
#undef LOAD_SCENE_NAME
};

static const struct argp_option option_table[] = {
    {NULL, 0, NULL, 0, "How many", 1},
    {"clients", OPT_CLIENTS, "N", 0, "clients at once (default 100)", 0},
    {"processes", OPT_PROCESSES, "N", 0, "processes that share the clients (default 4)",
     0},
    {"clients-per-process", OPT_PER_PROCESS, "N", 0, "instead of --processes", 0},
    {"requests", OPT_REQUESTS, "N", 0,
     "of each client, at least (default 100, or 1 with a time)", 0},
    {"seconds", OPT_SECONDS, "N", 0,
     "go on at least so long, minutes added, after ramp and warm-up", 0},
    {"minutes", OPT_MINUTES, "N", 0, "go on at least so long, seconds added", 0},
    {"depth", OPT_DEPTH, "N", 0, "requests of a client in flight (default 2)", 0},

    {NULL, 0, NULL, 0,
     "When: in the closed loop (default) a client asks again when an answer has come", 2},
    {"think-ms", OPT_THINK, "N", 0,
     "closed loop: between two requests of a client, about (default 0)", 0},
    {"hz", OPT_HZ, "F", 0,
     "open loop: each client asks F times a second, whatever the answers do; latency "
     "counts "
     "from when a request is due",
     0},
    {"rate", OPT_RATE, "F", 0, "open loop: all of them together F times a second", 0},
    {"arrivals", OPT_ARRIVALS, "KIND", 0,
     "fixed: at even distances, clients spread over them (default); poisson: at random",
     0},
    {"deadline-ms", OPT_DEADLINE, "F", 0,
     "an answer that comes later is missed (default with --hz: the period)", 0},
    {"ramp", OPT_RAMP, "S", 0, "clients join over S seconds", 0},
    {"warm-up", OPT_WARM_UP, "S", 0,
     "latencies count S seconds after the ramp (default 0)", 0},

    {NULL, 0, NULL, 0, "What", 3},
    {"triangles", OPT_TRIANGLES, "SIZES", 0,
     "of each client's scene: 1k; 200..5k, any octave as likely; 1k:3,20k:1 with weights "
     "(default 40)",
     0},
    {"scene", OPT_SCENE, "KIND", 0,
     "crumple (default): all of a sheet goes through a floor; wave: troughs of it do; "
     "apart: nothing does",
     0},
    {"kinds", OPT_KINDS, "LIST", 0,
     "clients are by turns (default all): follow, from where the last step ended; jump, "
     "with both ends, and mischief; rigid; pairs; churn, which makes things anew",
     0},
    {"mode", OPT_MODE, "MODE", 0,
     "of every step: all, first, any, pairs (default by kind)", 0},
    {"seed", OPT_SEED, "N", 0, "of the scenes (default 1)", 0},

    {NULL, 0, NULL, 0, "Trouble", 4},
    {"stall", OPT_STALL, "P,MS", 0,
     "after this share of its requests a client stops reading for MS milliseconds", 0},
    {"kill-clients", OPT_KILL_CLIENTS, "N", 0, "SIGKILL so many other clients", 0},
    {"victims", OPT_VICTIMS, "N", 0, "of the clients to kill, at a time (default 8)", 0},
    {"kill-worker", OPT_KILL_WORKER, "N", 0, "SIGKILL the daemon's worker so often", 0},
    {"pause-ms", OPT_PAUSE, "N", 0,
     "between two kills of the worker, about (default 100)", 0},

    {NULL, 0, NULL, 0, "Whom", 5},
    {"daemon", OPT_DAEMON, "PROGRAM", 0,
     "start it, supervised (default: $PCCD_DAEMON, or pccdd in $PATH)", 0},
    {"url", OPT_URL, "URL", 0,
     "unix:PATH: use that daemon instead; direct: no daemon, the engine in each process",
     0},

    {NULL, 0, NULL, 0, "What is said", 6},
    {"json", OPT_JSON, NULL, 0, "the report as one JSON object", 0},
    {"csv", OPT_CSV, "FILE", 0, "a line for each second", 0},
    {"plot", OPT_PLOT, "FILE.png", 0, "latency by percentile and by second (gnuplot)", 0},
    {"p99-ms", OPT_P99, "F", 0, "fail if that of the latency is longer", 0},
    {"flat", OPT_FLAT, NULL, 0, "fail if the daemon's memory grows", 0},
    {NULL, 0, NULL, 0, NULL, 0},
};

static uint64_t number(const struct argp_state *state, const char *text, uint64_t low,
                       uint64_t high)
{
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end || errno || value < low || value > high) {
        argp_error(state, "\"%s\" is not a number from %llu to %llu", text,
                   (unsigned long long)low, (unsigned long long)high);
    }
    return value;
}

static uint32_t small(const struct argp_state *state, const char *text, uint32_t low,
                      uint32_t high)
{
    return (uint32_t)number(state, text, low, high);
}

static double real(const struct argp_state *state, const char *text, double low,
                   double high)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high)) {
        argp_error(state, "\"%s\" is not a number from %g to %g", text, low, high);
    }
    return value;
}

/* Which of the names; `length` of the text count. */
static int choice(const struct argp_state *state, const char *text, size_t length,
                  const char *const *names, int count)
{
    for (int i = 0; i < count; i++) {
        if (strlen(names[i]) == length && strncmp(text, names[i], length) == 0) {
            return i;
        }
    }
    argp_error(state, "\"%.*s\" is not known here", (int)length, text);
    return 0;
}

static uint32_t parse_kinds(const struct argp_state *state, const char *text)
{
    uint32_t kinds = 0;
    for (;;) {
        size_t length = strcspn(text, ",");
        kinds |= 1u << choice(state, text, length, kind_names, LOAD_KINDS);
        if (text[length] == '\0') {
            return kinds;
        }
        text += length + 1;
    }
}

static void parse_stall(const struct argp_state *state, const char *text,
                        struct load_settings *settings)
{
    char share[32] = "";
    size_t length = strcspn(text, ",");
    if (text[length] != ',' || length >= sizeof share) {
        argp_error(state, "\"%s\" is not a share and milliseconds, such as 0.01,200",
                   text);
        return;
    }
    memcpy(share, text, length);
    settings->stall_share = real(state, share, 0, 1);
    settings->stall_ms = small(state, text + length + 1, 1, 60000);
}

static error_t parse_trouble(int key, char *text, struct argp_state *state)
{
    struct load_settings *settings = state->input;
    switch (key) {
    case OPT_STALL:
        parse_stall(state, text, settings);
        return 0;
    case OPT_VICTIMS:
        settings->victims = small(state, text, 1, LOAD_VICTIM_MAX);
        return 0;
    case OPT_KILL_CLIENTS:
        settings->kills = number(state, text, 0, UINT32_MAX);
        return 0;
    case OPT_KILL_WORKER:
        settings->crashes = number(state, text, 0, UINT32_MAX);
        return 0;
    case OPT_PAUSE:
        settings->pause_ms = small(state, text, 1, 3600000);
        return 0;
    case OPT_FLAT:
        settings->flat = true;
        return 0;
    case ARGP_KEY_ARGS: /* after --: for the daemon */
        settings->daemon_options = state->argv + state->next;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse_work(int key, char *text, struct argp_state *state)
{
    static const char *const modes[] = {"all", "first", "any", "pairs"};
    static const enum pccd_mode mode_values[] = {PCCD_MODE_ALL, PCCD_MODE_FIRST,
                                                 PCCD_MODE_ANY, PCCD_MODE_PAIRS};
    struct load_settings *settings = state->input;
    switch (key) {
    case OPT_TRIANGLES:
        if (!load_sizes_parse(&settings->sizes, text)) {
            argp_error(state, "\"%s\" is no list of sizes, such as 200..5k or 1k:3,20k:1",
                       text);
        }
        return 0;
    case OPT_SCENE:
        settings->scene = (enum load_scene)choice(state, text, strlen(text), scene_names,
                                                  LOAD_SCENE_COUNT);
        return 0;
    case OPT_KINDS:
        settings->kinds = parse_kinds(state, text);
        return 0;
    case OPT_MODE:
        settings->mode = (int)mode_values[choice(state, text, strlen(text), modes, 4)];
        return 0;
    case OPT_JSON:
        settings->json = true;
        return 0;
    case OPT_CSV:
        settings->csv = text;
        return 0;
    case OPT_PLOT:
        settings->plot = text;
        return 0;
    case OPT_P99:
        settings->p99_ms = real(state, text, 0, 1e6);
        return 0;
    case OPT_DAEMON:
        settings->daemon = text;
        return 0;
    case OPT_URL:
        settings->url = text;
        return 0;
    default:
        return parse_trouble(key, text, state);
    }
}

/* What depends on more than one option. */
struct input {
    struct load_settings settings; /* first: the others parse into it */
    double rate;
    uint32_t per_process;
};

static error_t parse_time(int key, char *text, struct argp_state *state)
{
    static const char *const arrivals[] = {"fixed", "poisson"};
    struct input *input = state->input;
    struct load_settings *settings = &input->settings;
    switch (key) {
    case OPT_THINK:
        settings->think_ms = small(state, text, 0, 60000);
        return 0;
    case OPT_HZ:
        settings->hz = real(state, text, 1e-3, 1e5);
        return 0;
    case OPT_RATE:
        input->rate = real(state, text, 1e-3, 1e7);
        return 0;
    case OPT_ARRIVALS:
        settings->poisson = choice(state, text, strlen(text), arrivals, 2) == 1;
        return 0;
    case OPT_DEADLINE:
        settings->deadline_ms = real(state, text, 1e-3, 1e6);
        return 0;
    case OPT_RAMP:
        settings->ramp_s = real(state, text, 0, 1e5);
        return 0;
    case OPT_WARM_UP:
        settings->warm_up_s = real(state, text, 0, 1e5);
        return 0;
    case OPT_MINUTES:
        settings->minutes = small(state, text, 0, 1u << 20);
        return 0;
    case OPT_SECONDS:
        settings->seconds = small(state, text, 0, 1u << 20);
        return 0;
    default:
        return parse_work(key, text, state);
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct input *input = state->input;
    struct load_settings *settings = &input->settings;
    switch (key) {
    case OPT_CLIENTS:
        settings->clients = small(state, text, 1, 65536);
        return 0;
    case OPT_REQUESTS:
        settings->requests = number(state, text, 1, UINT32_MAX);
        return 0;
    case OPT_PROCESSES:
        settings->processes = small(state, text, 1, LOAD_PROCESS_MAX);
        return 0;
    case OPT_PER_PROCESS:
        input->per_process = small(state, text, 1, 65536);
        return 0;
    case OPT_DEPTH:
        settings->depth = small(state, text, 1, LOAD_DEPTH_MAX);
        return 0;
    case OPT_SEED:
        settings->seed = number(state, text, 0, UINT64_MAX);
        return 0;
    default:
        return parse_time(key, text, state);
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
    static const struct argp argp = {
        .options = option_table,
        .parser = parse,
        .args_doc = "[-- DAEMON-OPTION...]",
        .doc =
            "Put a pccd daemon under the load of many clients, kill some of them and "
            "the daemon itself, and compare every answer with what a lone client "
            "gets.\v"
            "Games, 64 of them: --clients 64 --triangles 1k --scene wave --hz 60 "
            "--kinds follow --seconds 60. As much as it can take: --clients 1000.\n\n"
            "Exit status: 0 all is as it must be; 1 something is not; 2 the command line "
            "is wrong; 3 no daemon could be started; 4 any other error.",
    };
    const char *daemon = getenv("PCCD_DAEMON");
    struct input input = {.settings = {.seed = 1,
                                       .clients = 100,
                                       .processes = 4,
                                       .depth = 2,
                                       .victims = 8,
                                       .pause_ms = 100,
                                       .kinds = LOAD_KINDS_ALL,
                                       .mode = -1,
                                       .sizes = {1, {{40, 40, 1}}},
                                       .daemon = daemon ? daemon : "pccdd"}};
    argp_err_exit_status = LOAD_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &input);
    complete(&input);
    *settings = input.settings;
}
