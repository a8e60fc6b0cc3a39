/* main.c - pccd-load: many clients at once, and whether each gets its own answers. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "load.h"
#include "pccd.h"
#include "report.h"
#include "rounding.h"
#include "target.h"
#include "watch.h"

/* The time that the daemon may take to let go of what killed clients held: a session
 * outlives its connection for some seconds. */
#define BASELINE_MS 20000u
#define IDLE_MS     500u /* for the end of its last connection */

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

/* The work that goes on beside the crowd. */
struct overseer {
    struct load_assault assault;
    struct load_watch watch;
    struct load_series series;
};

/* Kill and watch until the crowd has ended. Returns how many of it ended badly. */
static uint32_t oversee(struct load *load, pid_t *crowd, uint32_t count,
                        struct overseer *overseer)
{
    uint64_t end_ns = common_now_ns() + (uint64_t)load_settings_ns(&load->settings);
    uint32_t running = count;
    uint32_t bad = 0;
    while (running > 0) {
        bool more = load_assault_turn(&overseer->assault);
        if (!load_is_direct(load)) {
            load_watch_turn(&overseer->watch, load);
        }
        load_series_turn(&overseer->series, load, false);
        if (!more && common_now_ns() >= end_ns) {
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
    load_series_turn(&overseer->series, load, true);
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

/* Return the memory of the process that serves, when no client is there: it gives free
 * pages back then. */
static int64_t idle_memory(const struct load *load)
{
    pid_t pid = load_target_pid(load);
    load_sleep_ms(IDLE_MS);
    return pid > 0 ? load_target_memory(pid) : -1;
}

/* Return whether libpccd-direct can be had; it is told why not. In a process of its own:
 * what it loads and starts is not to be there when the crowd is made. */
static bool has_direct(const struct load *load)
{
    int status = -1;
    pid_t pid = fork();
    if (pid == 0) {
        const struct pccd_options options = {.url = load->url};
        struct pccd_client *client = NULL;
        if (pccd_connect(&options, &client) != PCCD_OK) {
            load_say("%s", pccd_error_text(NULL));
            _exit(1);
        }
        pccd_close(client);
        _exit(0);
    }
    return pid > 0 && waitpid(pid, &status, 0) == pid && status == 0;
}

/* Note what the daemon holds, and what its clients get when they are alone. */
static void prepare(struct load *load, struct load_outcome *outcome)
{
    if ((!load_is_direct(load) && !load_target_holdings(load, &outcome->before)) ||
        !load_crowd_find_truth(load)) {
        atomic_store(&load->shared->failed, true);
    }
    outcome->idle_before_kib = load_is_direct(load) ? -1 : idle_memory(load);
}

/* Let a file that was asked for appear. */
static bool finish(struct whole_file *file, const char *path)
{
    int cause = path ? whole_file_finish(file) : 0;
    if (cause != 0) {
        load_say("%s: %s", path, strerror(cause));
    }
    return cause == 0;
}

static enum load_exit report(struct load *load, const struct load_outcome *outcome,
                             struct overseer *overseer)
{
    struct load_findings *findings = malloc(sizeof *findings);
    if (!findings) {
        load_say("no memory for a report");
        return LOAD_FAILED;
    }
    load_find(findings, load, outcome, &overseer->assault, &overseer->watch);
    bool is_good = findings->is_good;
    if (load->percentiles.to) {
        load_write_percentiles(load->percentiles.to, &findings->crowd.latency);
    }
    load_series_end(&overseer->series);
    bool is_written = finish(&load->csv, load->settings.csv);
    is_written = finish(&load->percentiles, load->settings.percentiles) && is_written;
    if (load->settings.json) {
        load_report_json(findings);
    } else {
        load_report_text(findings);
    }
    free(findings);
    return !is_good ? LOAD_NEGATIVE : !is_written ? LOAD_FAILED : LOAD_DONE;
}

static enum load_exit run(struct load *load, struct load_target *target)
{
    struct load_outcome outcome = {.ended = true};
    struct overseer overseer;
    pid_t crowd[LOAD_PROCESS_MAX];
    load_watch_begin(&overseer.watch);
    prepare(load, &outcome);
    uint32_t count = atomic_load(&load->shared->failed) ? 0 : gather(load, crowd);
    uint64_t begin_ns = common_now_ns();
    if (!load_series_begin(&overseer.series, load)) {
        atomic_store(&load->shared->failed, true);
    }
    atomic_store(&load->shared->go_ns, begin_ns);
    atomic_store(&load->shared->go, true);
    load_assault_begin(&overseer.assault, load);
    outcome.bad_processes = oversee(load, crowd, count, &overseer);
    outcome.seconds = (double)(common_now_ns() - begin_ns) * 1e-9;
    load_assault_end(&overseer.assault);
    if (!load_is_direct(load)) {
        settle(load, &outcome);
        outcome.idle_after_kib = idle_memory(load);
    }
    if (target->supervisor > 0) {
        outcome.ended = load_target_stop(target);
    }
    enum load_exit result = report(load, &outcome, &overseer);
    load_watch_deinit(&overseer.watch);
    return result;
}

/* Before the load, not after it. */
static bool open_file(struct whole_file *file, const char *path)
{
    int cause = path ? whole_file_open(file, path) : 0;
    if (cause != 0) {
        load_say("%s: %s", path, strerror(cause));
    }
    return cause == 0;
}

/* The daemon that was named, or one of our own. False: it has been told why not. */
static bool find_target(struct load *load, struct load_target *target)
{
    if (!load->settings.url) {
        return load_target_start(target, load);
    }
    snprintf(load->url, sizeof load->url, "%s", load->settings.url);
    return load_is_direct(load) ? has_direct(load) : load_target_pid(load) != 0;
}

int main(int argc, char **argv)
{
    struct load load = {0};
    struct load_target target = {0};
    COMMON_ROUNDING_HERE;
    load_options_parse(argc, argv, &load.settings);
    enum load_exit result = LOAD_FAILED;
    if (open_file(&load.percentiles, load.settings.percentiles) &&
        open_file(&load.csv, load.settings.csv) && share_memory(&load)) {
        result = find_target(&load, &target) ? run(&load, &target) : LOAD_NO_DAEMON;
    }
    whole_file_discard(&load.percentiles);
    whole_file_discard(&load.csv);
    return (int)result;
}
