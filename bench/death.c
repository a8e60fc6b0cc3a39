/* death.c - from kill -9 of the daemon to each client's next answer.
 *
 * One process a client; each waits on its socket, sees the daemon go, and asks for its
 * next step at once. The daemon is pccdd --supervise. Prints p50, p99 and the longest
 * over all clients and kills: from the kill to the answer, and of it what telling the new
 * daemon anew took. With -e nothing is registered, and the answer is that to a ping.
 * After each kill a bare process is killed, too, and one that has a bare successor
 * (bareend.h): what of the times is the machine's.
 */
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bareend.h"
#include "crossing.h"
#include "daemon.h"

#define CLIENTS_MAX 4096u
#define KILLS_MAX   1000u /* below --crashes-max */
#define SCENES_MAX  64u   /* of a client */
#define SETTLE_MS   250u  /* all sleep, and a spare worker stands by */

/* Of one client and kill. */
struct sample {
    uint64_t all_us;
    uint64_t restore_us;
};

struct shared {
    atomic_uint ready; /* clients that wait for a kill, counted once for each */
    atomic_bool is_over;
    _Atomic uint64_t killed_us;
    atomic_int worker;
    struct sample samples[]; /* [kills][clients] */
};

struct run {
    unsigned clients;
    unsigned kills;
    unsigned settle_ms; /* before each kill */
    unsigned scenes;    /* of each client, with two meshes each; 0: ping only */
    struct shared *shared;
    uint64_t *floor_us; /* [kills][clients]: a bare process's end, */
    uint64_t *bare_us;  /* and the answer of its successor */
    struct test_daemon daemon;
};

static bool make(const struct run *run, struct pccd_client *client,
                 struct test_crossing crossings[SCENES_MAX])
{
    for (unsigned i = 0; i < run->scenes; i++) {
        if (test_crossing_make(client, &crossings[i]) != 0) {
            return false;
        }
    }
    return true;
}

/* A step of the first scene, or a ping where there is none. */
static bool ask(const struct run *run, struct pccd_client *client,
                struct test_crossing crossings[SCENES_MAX])
{
    return run->scenes == 0 ? pccd_ping(client, NULL) == 0
                            : test_crossing_turn(&crossings[0]);
}

static void be_ready(const struct run *run, const struct pccd_client *client)
{
    atomic_store(&run->shared->worker, (int)pccd_daemon_pid(client));
    atomic_fetch_add(&run->shared->ready, 1);
}

/* The life of a client, in a process of its own. */
static int live(const struct run *run, unsigned number)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    struct test_crossing crossings[SCENES_MAX];

    pccd_options_init(&options);
    options.url = run->daemon.url;
    options.slot_bytes = 4096;
    options.result_bytes = 65536;
    options.spin_us = 0; /* there are more clients than processors */
    if (pccd_connect(&options, &client) != 0 || !make(run, client, crossings) ||
        !ask(run, client, crossings)) {
        fprintf(stderr, "client %u: %s\n", number, pccd_error_text(client));
        return 1;
    }
    be_ready(run, client);
    for (unsigned kill = 0; kill < run->kills; kill++) {
        struct pollfd watched = {.fd = pccd_fd(client), .events = POLLIN};
        struct sample *sample = &run->shared->samples[kill * run->clients + number];
        struct pccd_link_info info;

        if (poll(&watched, 1, -1) < 0 || !ask(run, client, crossings)) {
            fprintf(stderr, "client %u: %s\n", number, pccd_error_text(client));
            return 1;
        }
        sample->all_us = test_now_us() - atomic_load(&run->shared->killed_us);
        (void)pccd_link(client, &info);
        sample->restore_us = info.restore_ns / 1000;
        be_ready(run, client);
    }
    while (!atomic_load(&run->shared->is_over)) { /* ending takes others' time, too */
        test_sleep_ms(500);
    }
    pccd_close(client);
    return 0;
}

static int by_all(const void *a, const void *b)
{
    uint64_t x = ((const struct sample *)a)->all_us;
    uint64_t y = ((const struct sample *)b)->all_us;

    return (x > y) - (x < y);
}

static int by_us(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a;
    uint64_t y = *(const uint64_t *)b;

    return (x > y) - (x < y);
}

static void report(const struct run *run)
{
    struct sample *samples = run->shared->samples;
    size_t count = (size_t)run->clients * run->kills;
    const struct {
        const char *name;
        size_t at;
    } rows[] = {{"p50", count / 2}, {"p99", count - 1 - count / 100}, {"max", count - 1}};

    qsort(samples, count, sizeof *samples, by_all);
    qsort(run->floor_us, count, sizeof *run->floor_us, by_us);
    qsort(run->bare_us, count, sizeof *run->bare_us, by_us);
    printf("kill -9 to the next answer, %u clients, %u kills, %u meshes each\n",
           run->clients, run->kills, 2 * run->scenes);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const struct sample *at = &samples[rows[i].at];
        uint64_t floor_us = run->floor_us[rows[i].at];
        uint64_t bare_us = run->bare_us[rows[i].at];

        printf("%s %10.3f ms, of it telling anew %8.3f ms; end of a bare process seen "
               "after %8.3f ms (1 : %.1f), its successor's answer after %8.3f ms "
               "(1 : %.1f)\n",
               rows[i].name, (double)at->all_us * 1e-3, (double)at->restore_us * 1e-3,
               (double)floor_us * 1e-3,
               (double)at->all_us / (double)(floor_us > 0 ? floor_us : 1),
               (double)bare_us * 1e-3,
               (double)at->all_us / (double)(bare_us > 0 ? bare_us : 1));
    }
}

/* Wait until `count` clients in all have been ready. False: one failed. */
static bool await_ready(const struct run *run, unsigned count)
{
    while (atomic_load(&run->shared->ready) < count) {
        int status;
        pid_t ended = waitpid(-1, &status, WNOHANG);

        if (ended > 0 && ended != run->daemon.pid && status != 0) {
            return false;
        }
        test_sleep_ms(20); /* looking at all children takes the clients' time */
    }
    return true;
}

/* Kill the worker whenever all clients wait for it, and a bare process afterwards. False:
 * a client failed. */
static bool kill_all(const struct run *run)
{
    for (unsigned turn = 0; turn < run->kills; turn++) {
        if (!await_ready(run, run->clients * (turn + 1))) {
            return false;
        }
        test_sleep_ms(run->settle_ms);
        atomic_store(&run->shared->killed_us, test_now_us());
        (void)kill((pid_t)atomic_load(&run->shared->worker), SIGKILL);
        if (!await_ready(run, run->clients * (turn + 2)) ||
            !bareend_turn(run->clients, false, run->floor_us + turn * run->clients) ||
            !bareend_turn(run->clients, true, run->bare_us + turn * run->clients)) {
            return false;
        }
    }
    atomic_store(&run->shared->is_over, true);
    return true;
}

static int measure(struct run *run)
{
    const char *const options[] = {
        "--supervise", "--crashes-max",     "1024",  "--clients-max",
        "8192",        "--shm-max-mib",     "4096",  "--meshes-max",
        "16384",       "--connections-max", "16384", NULL};
    pid_t children[CLIENTS_MAX];
    unsigned started = 0;
    bool good = test_daemon_start(&run->daemon, options);

    for (; good && started < run->clients; started++) {
        children[started] = fork();
        if (children[started] == 0) {
            _exit(live(run, started));
        }
        good = children[started] > 0;
    }
    good = good && kill_all(run);
    for (unsigned i = 0; i < started; i++) {
        int status = 0;

        if (!good) {
            (void)kill(children[i], SIGKILL);
        }
        good =
            waitpid(children[i], &status, 0) != children[i] ? good : good && status == 0;
    }
    if (good) {
        report(run);
    }
    (void)test_daemon_end(&run->daemon, SIGTERM, 10000);
    (void)test_daemon_finish(&run->daemon);
    return good ? 0 : 1;
}

int main(int argc, char **argv)
{
    struct run run = {.clients = 1, .kills = 20, .scenes = 1, .settle_ms = SETTLE_MS};
    int option;

    while ((option = getopt(argc, argv, "c:k:s:m:e")) != -1) {
        switch (option) {
        case 'c':
            run.clients = (unsigned)strtoul(optarg, NULL, 10);
            break;
        case 'k':
            run.kills = (unsigned)strtoul(optarg, NULL, 10);
            break;
        case 's':
            run.settle_ms = (unsigned)strtoul(optarg, NULL, 10);
            break;
        case 'm':
            run.scenes = (unsigned)strtoul(optarg, NULL, 10) / 2;
            break;
        case 'e':
            run.scenes = 0;
            break;
        default:
            run.clients = 0;
        }
    }
    if (run.clients < 1 || run.clients > CLIENTS_MAX || run.kills < 1 ||
        run.kills > KILLS_MAX || run.scenes > SCENES_MAX) {
        fprintf(stderr,
                "usage: PCCDD=PROGRAM %s [-c CLIENTS] [-k KILLS] [-s MS] [-m MESHES] "
                "[-e]\n",
                argv[0]);
        return 2;
    }
    size_t bytes = sizeof *run.shared +
                   (size_t)run.clients * run.kills * sizeof run.shared->samples[0];
    void *shared =
        mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);

    run.floor_us = calloc((size_t)run.clients * run.kills, sizeof *run.floor_us);
    run.bare_us = calloc((size_t)run.clients * run.kills, sizeof *run.bare_us);
    if (shared == MAP_FAILED || run.floor_us == NULL || run.bare_us == NULL) {
        return 1;
    }
    run.shared = shared;
    int status = measure(&run);
    free(run.floor_us);
    free(run.bare_us);
    return status;
}
