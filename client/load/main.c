/* main.c - pccd-load: many clients at once, and whether each gets its own answers.
 *
 * Room:     client/load; the program.
 * Does:     options; the order of a run: truth, load with kills, baseline, report.
 * Threads:  one, and the processes that it starts.
 */
#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include "assault.h"
#include "crowd.h"
#include "pccd.h"
#include "report.h"
#include "target.h"
#include "watch.h"

/* How long the daemon may take to let go of what killed clients held: a session outlives
 * its connection for some seconds. */
#define BASELINE_MS 20000u
#define IDLE_MS     500u /* for the end of its last connection */

/* ---- options ----------------------------------------------------------------------- */

enum {
    OPT_CLIENTS = 'c',
    OPT_REQUESTS = 'n',
    OPT_PROCESSES = 'p',
    OPT_DEPTH = 'd',
    OPT_THINK = 't',
    OPT_SEED = 's',
    OPT_URL = 'u',
    OPT_DAEMON = 0x100,
    OPT_MINUTES,
    OPT_SECONDS,
    OPT_VICTIMS,
    OPT_KILL_CLIENTS,
    OPT_KILL_WORKER,
    OPT_PAUSE,
    OPT_FLAT
};

static const struct argp_option option_table[] = {
    {"clients", OPT_CLIENTS, "N", 0, "clients at once (default 100)", 0},
    {"requests", OPT_REQUESTS, "N", 0, "of each client, at least (default 100)", 0},
    {"processes", OPT_PROCESSES, "N", 0, "that share the clients (default 4)", 0},
    {"depth", OPT_DEPTH, "N", 0, "requests of a client in flight (default 2)", 0},
    {"think-ms", OPT_THINK, "N", 0, "between two of them, about (default 0)", 0},
    {"seed", OPT_SEED, "N", 0, "of the scenes (default 1)", 0},
    {"minutes", OPT_MINUTES, "N", 0, "go on at least so long", 0},
    {"seconds", OPT_SECONDS, "N", 0, "and so long", 0},
    {"kill-clients", OPT_KILL_CLIENTS, "N", 0, "SIGKILL so many other clients", 0},
    {"victims", OPT_VICTIMS, "N", 0, "of these at a time (default 8)", 0},
    {"kill-worker", OPT_KILL_WORKER, "N", 0, "SIGKILL the daemon's worker so often", 0},
    {"pause-ms", OPT_PAUSE, "N", 0, "between two of these, about (default 100)", 0},
    {"flat", OPT_FLAT, NULL, 0, "fail if the daemon's memory grows", 0},
    {"daemon", OPT_DAEMON, "PROGRAM", 0,
     "start it, supervised (default: $PCCD_DAEMON, or pccdd in $PATH)", 0},
    {"url", OPT_URL, "unix:PATH", 0, "use that daemon instead", 0},
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

static error_t parse_kills(int key, char *text, struct argp_state *state)
{
    struct load_settings *settings = state->input;
    switch (key) {
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
    case ARGP_KEY_ARGS: /* after --: for the daemon */
        settings->daemon_options = state->argv + state->next;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static error_t parse(int key, char *text, struct argp_state *state)
{
    struct load_settings *settings = state->input;
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
    case OPT_DEPTH:
        settings->depth = small(state, text, 1, LOAD_DEPTH_MAX);
        return 0;
    case OPT_THINK:
        settings->think_ms = small(state, text, 0, 60000);
        return 0;
    case OPT_SEED:
        settings->seed = number(state, text, 0, UINT64_MAX);
        return 0;
    case OPT_MINUTES:
        settings->minutes = small(state, text, 0, 1u << 20);
        return 0;
    case OPT_SECONDS:
        settings->seconds = small(state, text, 0, 1u << 20);
        return 0;
    case OPT_FLAT:
        settings->flat = true;
        return 0;
    case OPT_DAEMON:
        settings->daemon = text;
        return 0;
    case OPT_URL:
        settings->url = text;
        return 0;
    default:
        return parse_kills(key, text, state);
    }
}

/* ---- a run ------------------------------------------------------------------------- */

static bool share_memory(struct load *load)
{
    size_t bytes = sizeof *load->shared +
                   load_truth_count(&load->settings) * sizeof *load->shared->truth;
    void *shared =
        mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    load->shared = shared;
    if (shared == MAP_FAILED) {
        load_say("%zu bytes: %s", bytes, strerror(errno));
    }
    return shared != MAP_FAILED;
}

/* Start the crowd and wait until all of it is connected. Returns how many processes. */
static uint32_t gather(struct load *load, pid_t *crowd)
{
    uint32_t count = 0;
    while (count < load->settings.processes) {
        crowd[count] = load_crowd_start(load, count);
        if (crowd[count] < 0) {
            load_say("fork: %s", strerror(errno));
            atomic_store(&load->shared->failed, true);
            break;
        }
        count++;
    }
    while (atomic_load(&load->shared->ready) < count &&
           !atomic_load(&load->shared->failed)) {
        load_sleep_ms(1);
    }
    return count;
}

/* Kill and watch until the crowd has ended. Returns how many of it ended badly. */
static uint32_t oversee(struct load *load, pid_t *crowd, uint32_t count,
                        struct load_assault *assault, struct load_watch *watch)
{
    uint64_t end_ns = load_now_ns() + (uint64_t)load_settings_ns(&load->settings);
    uint32_t running = count;
    uint32_t bad = 0;
    while (running > 0) {
        bool more = load_assault_turn(assault);
        load_watch_turn(watch, load);
        if (!more && load_now_ns() >= end_ns) {
            atomic_store(&load->shared->enough, true);
        }
        for (uint32_t i = 0; i < count; i++) {
            int status;
            if (crowd[i] > 0 && waitpid(crowd[i], &status, WNOHANG) == crowd[i]) {
                crowd[i] = 0;
                running--;
                bad += status != 0;
                if (status != 0) {
                    atomic_store(&load->shared->failed, true);
                }
            }
        }
        load_sleep_ms(1);
    }
    return bad;
}

/* Until the daemon holds what it held before, or time is up. */
static void settle(const struct load *load, struct load_outcome *outcome)
{
    for (uint32_t ms = 0; ms < BASELINE_MS; ms += 100) {
        if (load_target_holdings(load, &outcome->after) &&
            load_holdings_equal(&outcome->before, &outcome->after)) {
            return;
        }
        load_sleep_ms(100);
    }
}

/* Of the process that serves, when no client is there: it gives free pages back then. */
static int64_t idle_memory(const struct load *load)
{
    pid_t pid = load_target_pid(load);
    load_sleep_ms(IDLE_MS);
    return pid > 0 ? load_target_memory(pid) : -1;
}

static bool run(struct load *load, struct load_target *target)
{
    struct load_outcome outcome = {.ended = true};
    struct load_assault assault;
    struct load_watch watch;
    pid_t crowd[LOAD_PROCESS_MAX];
    load_watch_begin(&watch);
    if (!load_target_holdings(load, &outcome.before) ||
        load_crowd_find_truth(load, &outcome.truth_records) != 0) {
        atomic_store(&load->shared->failed, true);
    }
    outcome.idle_before_kib = idle_memory(load);
    uint32_t count = atomic_load(&load->shared->failed) ? 0 : gather(load, crowd);
    uint64_t begin_ns = load_now_ns();
    atomic_store(&load->shared->go, true);
    load_assault_begin(&assault, load);
    outcome.bad_processes = oversee(load, crowd, count, &assault, &watch);
    outcome.seconds = (double)(load_now_ns() - begin_ns) * 1e-9;
    load_assault_end(&assault);
    settle(load, &outcome);
    outcome.idle_after_kib = idle_memory(load);
    if (target->supervisor > 0) {
        outcome.ended = load_target_stop(target);
    }
    bool is_good = load_report(load, &outcome, &assault, &watch);
    load_watch_deinit(&watch);
    return is_good;
}

int main(int argc, char **argv)
{
    static const struct argp argp = {
        .options = option_table,
        .parser = parse,
        .args_doc = "[-- DAEMON-OPTION...]",
        .doc = "Put a pccd daemon under the load of many clients, kill some of them and "
               "the daemon itself, and compare every answer with what a lone client "
               "gets.",
    };
    const char *daemon = getenv("PCCD_DAEMON");
    struct load load = {.settings = {.seed = 1,
                                     .clients = 100,
                                     .requests = 100,
                                     .processes = 4,
                                     .depth = 2,
                                     .victims = 8,
                                     .pause_ms = 100,
                                     .daemon = daemon ? daemon : "pccdd"}};
    struct load_target target = {0};
    argp_parse(&argp, argc, argv, 0, NULL, &load.settings);
    if (load.settings.processes > load.settings.clients) {
        load.settings.processes = load.settings.clients;
    }
    if (!share_memory(&load)) {
        return 1;
    }
    if (load.settings.url) {
        snprintf(load.url, sizeof load.url, "%s", load.settings.url);
    } else if (!load_target_start(&target, &load)) {
        return 1;
    }
    return run(&load, &target) ? 0 : 1;
}
