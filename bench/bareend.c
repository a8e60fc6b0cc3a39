/* bareend.c - how long until the end of a bare process is seen.
 *
 * Room:     bench. See bareend.h.
 * Does:     all processes anew for each turn, so that nothing is left of the last one.
 * Threads:  one a process.
 */
#include "bareend.h"

#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define HEAP_BYTES (16u << 20)
#define SETTLE_MS  50
#define PATIENCE_S 20

struct shared {
    atomic_uint ready; /* the bare process, and who waits for its end */
    atomic_uint seen;
    _Atomic uint64_t killed_us;
    uint64_t us[BAREEND_WATCHERS_MAX];
};

struct turn {
    struct shared *shared;
    unsigned watchers;
    unsigned started; /* of them */
    pid_t bare;
    pid_t pids[BAREEND_WATCHERS_MAX];
    int ends[BAREEND_WATCHERS_MAX][2]; /* the watcher's, the bare process's; -1: closed */
};

static uint64_t now_us(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static void sleep_ms(long ms)
{
    (void)nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

static void close_side(struct turn *turn, int side)
{
    for (unsigned i = 0; i < turn->watchers; i++) {
        if (turn->ends[i][side] >= 0) {
            (void)close(turn->ends[i][side]);
        }
        turn->ends[i][side] = -1;
    }
}

static bool open_pairs(struct turn *turn)
{
    struct rlimit limit;

    for (unsigned i = 0; i < turn->watchers; i++) {
        turn->ends[i][0] = turn->ends[i][1] = -1;
    }
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &limit);
    }
    for (unsigned i = 0; i < turn->watchers; i++) {
        if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, turn->ends[i]) != 0) {
            return false;
        }
    }
    return true;
}

static void be_bare(struct turn *turn)
{
    volatile unsigned char *heap = malloc(HEAP_BYTES);

    close_side(turn, 0);
    for (size_t i = 0; heap != NULL && i < HEAP_BYTES; i += 4096) {
        heap[i] = 1;
    }
    atomic_fetch_add(&turn->shared->ready, 1);
    for (;;) {
        (void)pause();
    }
}

static void be_watcher(const struct turn *turn, unsigned number)
{
    struct pollfd watched = {.fd = turn->ends[number][0], .events = POLLIN};
    char byte;

    atomic_fetch_add(&turn->shared->ready, 1);
    while (poll(&watched, 1, -1) <= 0) {
        ;
    }
    (void)recv(watched.fd, &byte, 1, 0);
    turn->shared->us[number] = now_us() - atomic_load(&turn->shared->killed_us);
    atomic_fetch_add(&turn->shared->seen, 1);
    for (;;) { /* what ending costs is not to be measured */
        (void)pause();
    }
}

static bool start(struct turn *turn)
{
    turn->bare = fork();
    if (turn->bare == 0) {
        be_bare(turn);
    }
    close_side(turn, 1);
    for (; turn->bare > 0 && turn->started < turn->watchers; turn->started++) {
        turn->pids[turn->started] = fork();
        if (turn->pids[turn->started] == 0) {
            be_watcher(turn, turn->started);
        }
        if (turn->pids[turn->started] < 0) {
            return false;
        }
    }
    return turn->bare > 0;
}

static bool await(const atomic_uint *count, unsigned wanted)
{
    uint64_t until_us = now_us() + PATIENCE_S * 1000000ull;

    while (atomic_load(count) < wanted && now_us() < until_us) {
        sleep_ms(5);
    }
    return atomic_load(count) >= wanted;
}

static void stop(struct turn *turn)
{
    if (turn->bare > 0) {
        (void)kill(turn->bare, SIGKILL);
        (void)waitpid(turn->bare, NULL, 0);
    }
    for (unsigned i = 0; i < turn->started; i++) {
        (void)kill(turn->pids[i], SIGKILL);
    }
    for (unsigned i = 0; i < turn->started; i++) {
        (void)waitpid(turn->pids[i], NULL, 0);
    }
    close_side(turn, 0);
    close_side(turn, 1);
}

bool bareend_turn(unsigned watchers, uint64_t *us)
{
    static struct turn turn;
    void *shared = mmap(NULL, sizeof(struct shared), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bool good;

    if (shared == MAP_FAILED || watchers > BAREEND_WATCHERS_MAX) {
        return false;
    }
    memset(&turn, 0, sizeof(turn));
    turn.shared = shared;
    turn.watchers = watchers;
    good = open_pairs(&turn) && start(&turn) && await(&turn.shared->ready, watchers + 1);
    if (good) {
        sleep_ms(SETTLE_MS); /* all wait */
        atomic_store(&turn.shared->killed_us, now_us());
        (void)kill(turn.bare, SIGKILL);
        good = await(&turn.shared->seen, watchers);
    }
    memcpy(us, turn.shared->us, watchers * sizeof(*us));
    stop(&turn);
    (void)munmap(shared, sizeof(struct shared));
    return good;
}
