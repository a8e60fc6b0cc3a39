/* options.c - what the command line of pccd-load says. */
#include "load.h"

#include <argp.h>
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "actor.h"
#include "names.h"
#include "shown.h"

/* What depends on more than one option. */
struct input {
    struct load_settings settings;
    double rate;
    uint32_t per_process;
};

struct row;
typedef void (*take_fn)(const struct argp_state *state, const struct row *row,
                        const char *text, void *to);

/* An option is one row: what --help says of it, what it may be, and where that goes. */
struct row {
    const char *name;
    char letter; /* 0: none */
    const char *arg, *text;
    take_fn take; /* NULL: a heading */
    size_t at;    /* in struct input */
    double low, high;
    const char *const *names; /* NULL-terminated; what it may be, if it is a word */
};

#define AT(member)  offsetof(struct input, settings.member)
#define OWN(member) offsetof(struct input, member)

/* ---- what may stand there ---------------------------------------------------------- */

static const char *const arrival_names[] = {"fixed", "poisson", NULL};
static const char *const kind_names[] = {"follow", "jump",  "rigid", "pairs",
                                         "churn",  "share", "batch", NULL};
static const char *const scene_names[] = {
#define LOAD_SCENE_NAME(name, text) [LOAD_SCENE_##name] = #name,
    LOAD_SCENES(LOAD_SCENE_NAME)
#undef LOAD_SCENE_NAME
        NULL};

static uint64_t number(const struct argp_state *state, const struct row *row,
                       const char *text, double low, double high)
{
    char *end;
    errno = 0;
    unsigned long long value = strtoull(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end || errno || (double)value < low ||
        (double)value > high) {
        tool_misused(state, "--%s: \"%s\" is not a whole number from %.0f to %.0f",
                     row->name, text, low, high);
    }
    return value;
}

static double real(const struct argp_state *state, const struct row *row,
                   const char *text, double low, double high)
{
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high)) {
        tool_misused(state, "--%s: \"%s\" is not a number from %g to %g", row->name, text,
                     low, high);
    }
    return value;
}

/* Which of the row's names; `length` of the text count. */
static uint32_t choice(const struct argp_state *state, const struct row *row,
                       const char *text, size_t length)
{
    char list[128] = "";
    size_t used = 0;
    for (uint32_t i = 0; row->names[i] != NULL; i++) {
        if (strlen(row->names[i]) == length &&
            strncmp(text, row->names[i], length) == 0) {
            return i;
        }
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s",
                                 i > 0 ? ", " : "", row->names[i]);
    }
    tool_misused(state, "--%s: \"%.*s\" is none of %s", row->name, (int)length, text,
                 list);
    return 0;
}

static void take_u32(const struct argp_state *state, const struct row *row,
                     const char *text, void *to)
{
    *(uint32_t *)to = (uint32_t)number(state, row, text, row->low, row->high);
}

static void take_u64(const struct argp_state *state, const struct row *row,
                     const char *text, void *to)
{
    *(uint64_t *)to = number(state, row, text, row->low, row->high);
}

static void take_real(const struct argp_state *state, const struct row *row,
                      const char *text, void *to)
{
    *(double *)to = real(state, row, text, row->low, row->high);
}

static void take_text(const struct argp_state *state, const struct row *row,
                      const char *text, void *to)
{
    (void)state;
    (void)row;
    *(const char **)to = text;
}

static void take_flag(const struct argp_state *state, const struct row *row,
                      const char *text, void *to)
{
    (void)state;
    (void)row;
    (void)text;
    *(bool *)to = true;
}

static void take_arrivals(const struct argp_state *state, const struct row *row,
                          const char *text, void *to)
{
    *(bool *)to = choice(state, row, text, strlen(text)) == 1;
}

static void take_scene(const struct argp_state *state, const struct row *row,
                       const char *text, void *to)
{
    *(enum load_scene *)to = (enum load_scene)choice(state, row, text, strlen(text));
}

static void take_mode(const struct argp_state *state, const struct row *row,
                      const char *text, void *to)
{
    static const enum pccd_mode values[] = {PCCD_MODE_ALL, PCCD_MODE_FIRST, PCCD_MODE_ANY,
                                            PCCD_MODE_PAIRS};
    *(int *)to = (int)values[choice(state, row, text, strlen(text))];
}

static void take_kinds(const struct argp_state *state, const struct row *row,
                       const char *text, void *to)
{
    uint32_t kinds = 0;
    for (;;) {
        size_t length = strcspn(text, ",");
        kinds |= 1u << choice(state, row, text, length);
        if (text[length] == '\0') {
            break;
        }
        text += length + 1;
    }
    *(uint32_t *)to = kinds;
}

static void take_sizes(const struct argp_state *state, const struct row *row,
                       const char *text, void *to)
{
    if (!load_sizes_parse(to, text)) {
        tool_misused(state,
                     "--%s: \"%s\" is no list of sizes, such as 200..5k or 1k:3,20k:1",
                     row->name, text);
    }
}

static void take_stall(const struct argp_state *state, const struct row *row,
                       const char *text, void *to)
{
    struct load_settings *settings = to;
    char share[32] = "";
    size_t length = strcspn(text, ",");
    if (text[length] != ',' || length >= sizeof share) {
        tool_misused(state,
                     "--%s: \"%s\" is not a share and milliseconds, such as 0.01,200",
                     row->name, text);
        return;
    }
    memcpy(share, text, length);
    settings->stall_share = real(state, row, share, 0, 1);
    settings->stall_ms = (uint32_t)number(state, row, text + length + 1, 1, 60000);
}

/* ---- the options ------------------------------------------------------------------- */

static const struct row rows[] = {
#define LOAD_SCENE_TEXT(name, text) #name ": " text "; "
    {.text = "How many"},
    {"clients", 'c', "N", "clients at once (default 100)", take_u32, AT(clients), 1,
     65536, NULL},
    {"processes", 'p', "N", "processes that share the clients (default 4)", take_u32,
     AT(processes), 1, LOAD_PROCESS_MAX, NULL},
    {"clients-per-process", 0, "N", "instead of --processes", take_u32, OWN(per_process),
     1, 65536, NULL},
    {"requests", 'n', "N", "of each client, at least (default 100, or 1 with a time)",
     take_u64, AT(requests), 1, UINT32_MAX, NULL},
    {"seconds", 0, "N", "go on at least so long, minutes added, after ramp and warm-up",
     take_u32, AT(seconds), 0, 1u << 20, NULL},
    {"minutes", 0, "N", "go on at least so long, seconds added", take_u32, AT(minutes), 0,
     1u << 20, NULL},
    {"depth", 'd', "N", "requests of a client in flight (default 2)", take_u32, AT(depth),
     1, LOAD_DEPTH_MAX, NULL},

    {.text = "When: in the closed loop (default) a client asks again when an answer has "
             "come"},
    {"think-ms", 't', "N",
     "closed loop: between two requests of a client, about (default 0)", take_u32,
     AT(think_ms), 0, 60000, NULL},
    {"hz", 0, "F",
     "open loop: each client asks F times a second, whatever the answers do; latency "
     "counts from when a request is due",
     take_real, AT(hz), 1e-3, 1e5, NULL},
    {"rate", 0, "F", "open loop: all of them together F times a second", take_real,
     OWN(rate), 1e-3, 1e7, NULL},
    {"arrivals", 0, "KIND",
     "fixed: at even distances, clients spread over them (default); poisson: at random",
     take_arrivals, AT(poisson), 0, 0, arrival_names},
    {"deadline-ms", 0, "F",
     "an answer that comes later is missed (default with --hz: the period)", take_real,
     AT(deadline_ms), 1e-3, 1e6, NULL},
    {"ramp", 0, "S", "clients join over S seconds", take_real, AT(ramp_s), 0, 1e5, NULL},
    {"warm-up", 0, "S", "latencies count S seconds after the ramp (default 0)", take_real,
     AT(warm_up_s), 0, 1e5, NULL},

    {.text = "What"},
    {"triangles", 0, "SIZES",
     "of each client's scene: 1k; 200..5k, any octave as likely; 1k:3,20k:1 with weights "
     "(default 40)",
     take_sizes, AT(sizes), 0, 0, NULL},
    {"scene", 0, "KIND", LOAD_SCENES(LOAD_SCENE_TEXT) "(default crumple)", take_scene,
     AT(scene), 0, 0, scene_names},
    {"kinds", 0, "LIST",
     "clients are by turns (default all but batch): follow, from where the last step "
     "ended; jump, with both ends, and mischief; rigid; pairs; churn, which makes things "
     "anew; share, "
     "which holds its frames for a second client of its scene; batch, which steps many "
     "scenes by one request, each of which counts",
     take_kinds, AT(kinds), 0, 0, kind_names},
    {"batch", 0, "N", "scenes of each client of kind batch (default 8)", take_u32,
     AT(batch), 1, LOAD_BATCH_MAX, NULL},
    {"mode", 0, "MODE", "of every step: all, first, any, pairs (default by kind)",
     take_mode, AT(mode), 0, 0, common_mode_names},
    {"near", 0, NULL,
     "every second request asks what is near where it leads, instead of a step: "
     "vertices, "
     "nearest and crossings by turns; not of kind share",
     take_flag, AT(near), 0, 0, NULL},
    {"seed", 's', "N", "of the scenes (default 1)", take_u64, AT(seed), 0, 0x1p64, NULL},

    {.text = "Trouble"},
    {"stall", 0, "P,MS",
     "after this share of its requests a client stops reading for MS milliseconds",
     take_stall, OWN(settings), 0, 0, NULL},
    {"kill-clients", 0, "N", "SIGKILL so many other clients", take_u64, AT(kills), 0,
     UINT32_MAX, NULL},
    {"victims", 0, "N", "of the clients to kill, at a time (default 8)", take_u32,
     AT(victims), 1, LOAD_VICTIM_MAX, NULL},
    {"kill-worker", 0, "N", "SIGKILL the daemon's worker so often", take_u64, AT(crashes),
     0, UINT32_MAX, NULL},
    {"pause-ms", 0, "N", "between two kills of the worker, about (default 100)", take_u32,
     AT(pause_ms), 1, 3600000, NULL},

    {.text = "Whom"},
    {"daemon", 0, "PROGRAM",
     "start it, supervised (default: $PCCD_DAEMON, or pccdd in $PATH)", take_text,
     AT(daemon), 0, 0, NULL},
    {"url", 'u', "URL",
     "unix:PATH: use that daemon instead; direct: no daemon, the engine in each process",
     take_text, AT(url), 0, 0, NULL},

    {.text = "What is said"},
    {"json", 0, NULL, "the report as one JSON object", take_flag, AT(json), 0, 0, NULL},
    {"csv", 0, "FILE", "a line for each second", take_text, AT(csv), 0, 0, NULL},
    {"plot", 0, "FILE.png", "latency by percentile and by second (gnuplot)", take_text,
     AT(plot), 0, 0, NULL},
    {"p99-ms", 0, "F", "fail if that of the latency is longer", take_real, AT(p99_ms), 0,
     1e6, NULL},
    {"flat", 0, NULL, "fail if the daemon's memory grows", take_flag, AT(flat), 0, 0,
     NULL},
#undef LOAD_SCENE_TEXT
};
#define ROW_COUNT (sizeof rows / sizeof rows[0])
#define KEY_BASE  0x100 /* of options without a letter */

static void refuse_contradictions(const struct argp_state *state,
                                  const struct input *input)
{
    const struct load_settings *settings = &input->settings;
    const char *url = settings->url != NULL ? settings->url : "unix:";
    bool is_direct = strncmp(url, "direct:", 7) == 0;
    if (!is_direct && strncmp(url, "unix:", 5) != 0) {
        tool_misused(state, "--url: \"%s\" is neither unix:PATH nor direct:", url);
    }
    if (is_direct && settings->crashes > 0) {
        tool_misused(state, "--kill-worker: with direct: there is no daemon to kill");
    }
    if (settings->hz > 0 && input->rate > 0) {
        tool_misused(state, "--hz is of each client, --rate of all: one of the two");
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct input *input = state->input;
    if (key == ARGP_KEY_ARGS) { /* after --: for the daemon */
        input->settings.daemon_options = state->argv + state->next;
        return 0;
    }
    if (key == ARGP_KEY_END) {
        refuse_contradictions(state, input);
        return 0;
    }
    for (int i = 0; i < (int)ROW_COUNT; i++) {
        const struct row *row = &rows[i];
        if (row->take != NULL && key == (row->letter != 0 ? row->letter : KEY_BASE + i)) {
            row->take(state, row, text, (char *)input + row->at);
            return 0;
        }
    }
    return ARGP_ERR_UNKNOWN;
}

/* As argp wants them. */
static void list_options(struct argp_option options[ROW_COUNT + 1])
{
    int group = 0;
    for (int i = 0; i < (int)ROW_COUNT; i++) {
        const struct row *row = &rows[i];
        int key = row->letter != 0 ? row->letter : KEY_BASE + i;
        bool is_heading = row->take == NULL;
        group += is_heading;
        options[i] = (struct argp_option){.name = row->name,
                                          .key = is_heading ? 0 : key,
                                          .arg = row->arg,
                                          .doc = row->text,
                                          .group = is_heading ? group : 0};
    }
    options[ROW_COUNT] = (struct argp_option){.name = NULL};
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
    struct argp_option options[ROW_COUNT + 1];
    const struct argp argp = {
        .options = options,
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
                                       .kinds = LOAD_KINDS_USUAL,
                                       .batch = 8,
                                       .mode = -1,
                                       .sizes = {1, {{40, 40, 1}}},
                                       .daemon = daemon ? daemon : "pccdd"}};
    list_options(options);
    argp_err_exit_status = LOAD_USAGE;
    argp_parse(&argp, argc, argv, 0, NULL, &input);
    complete(&input);
    *settings = input.settings;
}
