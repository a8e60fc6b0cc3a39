/* death.c - from kill -9 of the daemon to each client's next answer.
 *
 * One process a client; each waits on its socket, sees the daemon go, and asks for its
 * next step at once. After each kill a bare process is killed, too, and one that has a
 * bare successor: what of the times is the machine's.
 */
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "sections.h"

#define CLIENTS_MAX    4096u
#define SCENES_MAX     64u  /* of a client */
#define SETTLE_MS      250u /* all sleep, and a spare worker stands by */
#define BARE_SETTLE_MS 50u
#define HEAP_BYTES     (16u << 20)
#define PATIENCE_S     20

/* Times of one client after one kill. */
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
    unsigned scenes; /* of each client, with two meshes each; 0: ping only */
    struct shared *shared;
    struct bench_side *sides;
    struct test_daemon daemon;
};

enum { ANSWER, TELLING, BARE_END, BARE_ANSWER, SIDES };

/* ---- the clients ------------------------------------------------------------------- */

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

/* ---- what a kill takes without pccd ------------------------------------------------ */

/* A process of one thread that has touched 16 MiB, and holds one end of a socketpair for
 * each watching process, is killed with -9, and the watchers see the end of file. In a
 * second form each watcher then connects to a standby process of one thread, sends it one
 * message, and gets one back: the least that a reconnection takes. */

/* As long as hello and the answer to it. */
#define QUESTION_BYTES 136u
#define ANSWER_BYTES   149u

struct watched {
    atomic_uint ready; /* the bare process, its successor, and who waits for its end */
    atomic_uint seen;
    _Atomic uint64_t killed_us;
    uint64_t us[CLIENTS_MAX];
};

struct bare {
    struct watched *watched;
    unsigned watchers;
    unsigned started; /* of them */
    bool asks;        /* each of them asks the successor, and that is the end */
    pid_t process;
    pid_t successor; /* if they ask */
    int lifeline[2]; /* the successor reads its end when the bare process has ended */
    int listener;    /* held by all */
    struct sockaddr_un address;
    socklen_t address_bytes;
    pid_t pids[CLIENTS_MAX];
    int ends[CLIENTS_MAX][2]; /* the watcher's, the bare process's; -1: closed */
};

static void close_side(struct bare *bare, int side)
{
    for (unsigned i = 0; i < bare->watchers; i++) {
        if (bare->ends[i][side] >= 0) {
            (void)close(bare->ends[i][side]);
        }
        bare->ends[i][side] = -1;
    }
}

/* A listening socket of a name that the system chooses. */
static bool open_listener(struct bare *bare)
{
    bare->address = (struct sockaddr_un){.sun_family = AF_UNIX};
    bare->address_bytes = sizeof bare->address;
    bare->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0);
    return bare->listener >= 0 && pipe(bare->lifeline) == 0 &&
           bind(bare->listener, (struct sockaddr *)&bare->address, sizeof(sa_family_t)) ==
               0 &&
           listen(bare->listener, CLIENTS_MAX) == 0 &&
           getsockname(bare->listener, (struct sockaddr *)&bare->address,
                       &bare->address_bytes) == 0;
}

static void close_listener(struct bare *bare)
{
    const int fds[] = {bare->listener, bare->lifeline[0], bare->lifeline[1]};

    for (unsigned i = 0; i < 3; i++) {
        if (fds[i] >= 0) {
            (void)close(fds[i]);
        }
    }
}

static bool open_pairs(struct bare *bare)
{
    struct rlimit limit;

    for (unsigned i = 0; i < bare->watchers; i++) {
        bare->ends[i][0] = bare->ends[i][1] = -1;
    }
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &limit);
    }
    for (unsigned i = 0; i < bare->watchers; i++) {
        if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, bare->ends[i]) != 0) {
            return false;
        }
    }
    return true;
}

static void be_bare(struct bare *bare)
{
    volatile unsigned char *heap = malloc(HEAP_BYTES);

    close_side(bare, 0);
    (void)close(bare->lifeline[0]);
    for (size_t i = 0; heap != NULL && i < HEAP_BYTES; i += 4096) {
        heap[i] = 1;
    }
    atomic_fetch_add(&bare->watched->ready, 1);
    for (;;) {
        (void)pause();
    }
}

/* Whoever has come: take it, or answer it. */
static void serve(const struct bare *bare, int poll, int fd)
{
    char message[ANSWER_BYTES] = {0};
    struct epoll_event event = {.events = EPOLLIN};

    if (fd != bare->listener) {
        if (recv(fd, message, sizeof message, 0) > 0) {
            (void)send(fd, message, sizeof message, MSG_NOSIGNAL);
        }
        return;
    }
    while ((event.data.fd = accept4(bare->listener, NULL, NULL, SOCK_NONBLOCK)) >= 0) {
        (void)epoll_ctl(poll, EPOLL_CTL_ADD, event.data.fd, &event);
    }
}

/* The least that follows on from the bare process. */
static void be_successor(struct bare *bare)
{
    struct epoll_event events[64];
    struct epoll_event event = {.events = EPOLLIN, .data.fd = bare->listener};
    int poll = epoll_create1(0);
    char byte;

    close_side(bare, 0);
    close_side(bare, 1);
    (void)close(bare->lifeline[1]);
    (void)epoll_ctl(poll, EPOLL_CTL_ADD, bare->listener, &event);
    atomic_fetch_add(&bare->watched->ready, 1);
    (void)read(bare->lifeline[0], &byte, 1);
    for (;;) {
        int count = epoll_wait(poll, events, 64, -1);

        for (int i = 0; i < count; i++) {
            serve(bare, poll, events[i].data.fd);
        }
    }
}

/* Ask the successor, and have its answer. */
static void ask_successor(const struct bare *bare)
{
    char message[ANSWER_BYTES] = {0};
    int fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);

    (void)connect(fd, (const struct sockaddr *)&bare->address, bare->address_bytes);
    (void)send(fd, message, QUESTION_BYTES, MSG_NOSIGNAL);
    (void)recv(fd, message, sizeof message, 0);
}

static void be_watcher(const struct bare *bare, unsigned number)
{
    struct pollfd watched = {.fd = bare->ends[number][0], .events = POLLIN};
    char byte;

    atomic_fetch_add(&bare->watched->ready, 1);
    while (poll(&watched, 1, -1) <= 0) {
        ;
    }
    (void)recv(watched.fd, &byte, 1, 0);
    if (bare->asks) {
        (void)close(watched.fd);
        ask_successor(bare);
    }
    bare->watched->us[number] = test_now_us() - atomic_load(&bare->watched->killed_us);
    atomic_fetch_add(&bare->watched->seen, 1);
    for (;;) { /* what ending costs is not to be measured */
        (void)pause();
    }
}

static bool start(struct bare *bare)
{
    bare->process = fork();
    if (bare->process == 0) {
        be_bare(bare);
    }
    if (bare->asks) {
        bare->successor = fork();
        if (bare->successor == 0) {
            be_successor(bare);
        }
    }
    close_side(bare, 1);
    (void)close(bare->lifeline[1]);
    bare->lifeline[1] = -1;
    for (; bare->process > 0 && bare->successor >= 0 && bare->started < bare->watchers;
         bare->started++) {
        bare->pids[bare->started] = fork();
        if (bare->pids[bare->started] == 0) {
            be_watcher(bare, bare->started);
        }
        if (bare->pids[bare->started] < 0) {
            return false;
        }
    }
    return bare->process > 0 && bare->successor >= 0;
}

static bool await(const atomic_uint *count, unsigned wanted)
{
    uint64_t until_us = test_now_us() + PATIENCE_S * 1000000ull;

    while (atomic_load(count) < wanted && test_now_us() < until_us) {
        test_sleep_ms(5);
    }
    return atomic_load(count) >= wanted;
}

static void stop(struct bare *bare)
{
    if (bare->process > 0) {
        (void)kill(bare->process, SIGKILL);
        (void)waitpid(bare->process, NULL, 0);
    }
    if (bare->successor > 0) {
        (void)kill(bare->successor, SIGKILL);
        (void)waitpid(bare->successor, NULL, 0);
    }
    for (unsigned i = 0; i < bare->started; i++) {
        (void)kill(bare->pids[i], SIGKILL);
    }
    for (unsigned i = 0; i < bare->started; i++) {
        (void)waitpid(bare->pids[i], NULL, 0);
    }
    close_side(bare, 0);
    close_side(bare, 1);
    close_listener(bare);
}

/* Do it once. us[watchers]: microseconds from the kill to each one's end of file, or with
 * `asks` to its answer. False: processes or descriptors could not be had. */
static bool end_bare(unsigned watchers, bool asks, uint64_t *us)
{
    static struct bare bare;
    void *shared = mmap(NULL, sizeof(struct watched), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bool good;

    if (shared == MAP_FAILED || watchers > CLIENTS_MAX) {
        return false;
    }
    memset(&bare, 0, sizeof bare);
    bare.watched = shared;
    bare.watchers = watchers;
    bare.asks = asks;
    bare.listener = bare.lifeline[0] = bare.lifeline[1] = -1;
    good = open_pairs(&bare) && open_listener(&bare) && start(&bare) &&
           await(&bare.watched->ready, watchers + 1 + asks);
    if (good) {
        test_sleep_ms(BARE_SETTLE_MS); /* all wait */
        atomic_store(&bare.watched->killed_us, test_now_us());
        (void)kill(bare.process, SIGKILL);
        good = await(&bare.watched->seen, watchers);
    }
    memcpy(us, bare.watched->us, watchers * sizeof *us);
    stop(&bare);
    (void)munmap(shared, sizeof(struct watched));
    return good;
}

/* ---- kills ------------------------------------------------------------------------- */

/* Kill the worker once, and add what each client and each watcher saw. Return false if a
 * client failed. */
static bool kill_once(const struct run *run, unsigned turn)
{
    static uint64_t us[CLIENTS_MAX];
    const struct sample *samples = &run->shared->samples[turn * run->clients];
    struct bench_side *sides = run->sides;
    if (!await_ready(run, run->clients * (turn + 1))) {
        return false;
    }
    test_sleep_ms(SETTLE_MS);
    atomic_store(&run->shared->killed_us, test_now_us());
    (void)kill((pid_t)atomic_load(&run->shared->worker), SIGKILL);
    if (!await_ready(run, run->clients * (turn + 2))) {
        return false;
    }
    for (unsigned i = 0; i < run->clients; i++) {
        bench_add(&sides[ANSWER].samples, 1e-3 * (double)samples[i].all_us);
        bench_add(&sides[TELLING].samples, 1e-3 * (double)samples[i].restore_us);
    }
    for (unsigned asks = 0; asks < 2; asks++) {
        if (!end_bare(run->clients, asks, us)) {
            return false;
        }
        for (unsigned i = 0; i < run->clients; i++) {
            bench_add(&sides[BARE_END + asks].samples, 1e-3 * (double)us[i]);
        }
    }
    return true;
}

static bool kill_all(const struct run *run)
{
    for (unsigned turn = 0; turn < run->kills; turn++) {
        if (!kill_once(run, turn)) {
            return false;
        }
    }
    atomic_store(&run->shared->is_over, true);
    return true;
}

static bool play(struct run *run)
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
    (void)test_daemon_end(&run->daemon, SIGTERM, 10000);
    (void)test_daemon_finish(&run->daemon);
    return good;
}

static void measure(unsigned clients, unsigned kills, unsigned scenes)
{
    struct bench_side sides[SIDES] = {
        [ANSWER] = {"kill -9 to the answer", "ms", "a bare one's end", BARE_END, 1, {0}},
        [TELLING] = {"of it telling anew", "ms", NULL, 0, 1, {0}},
        [BARE_END] = {"a bare process's end", "ms", NULL, 0, 1, {0}},
        [BARE_ANSWER] = {"its successor's answer", "ms", NULL, 0, 1, {0}}};
    struct run run = {
        .clients = clients, .kills = kills, .scenes = scenes, .sides = sides};
    char name[64];
    size_t bytes =
        sizeof *run.shared + (size_t)clients * kills * sizeof run.shared->samples[0];
    void *shared =
        mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    snprintf(name, sizeof name, "%u clients, %u meshes", clients, 2 * scenes);
    if (!bench_check(shared != MAP_FAILED, name, "no shared memory")) {
        return;
    }
    run.shared = shared;
    bool good = bench_check(play(&run), name, "a client failed");
    bench_sides_end(name, sides, SIDES, good);
    (void)munmap(shared, bytes);
}

const struct option_row section_death_rows[] = {
    {"clients", 0, "N", "that wait for an answer (default 1)", OPTION_U32,
     .at = offsetof(struct section_options, clients), .min = 1, .max = CLIENTS_MAX},
    {"kills", 0, "N", "of the daemon (default 20)", OPTION_U32,
     .at = offsetof(struct section_options, kills), .min = 1, .max = 1000},
    {"meshes", 0, "N", "of each client, an even number (default 2)", OPTION_U32,
     .at = offsetof(struct section_options, meshes), .min = 2, .max = 2 * SCENES_MAX},
    {0}};

int section_death(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    unsigned clients = section->clients ? section->clients : 1;
    unsigned kills = section->kills ? section->kills : options->smoke ? 2 : 20;
    unsigned meshes = section->meshes ? section->meshes : 2;
    if (bench_is_wanted(options, "death")) {
        bench_heading("death");
        measure(clients, kills, 0);
        measure(clients, kills, meshes / 2);
    }
    return 0;
}
