/* bareend.c - how long until the end of a bare process is seen, and another answers. */
#include "bareend.h"

#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "clock.h"

#define HEAP_BYTES (16u << 20)
#define SETTLE_MS  50
#define PATIENCE_S 20

/* As long as hello and the answer to it. */
#define QUESTION_BYTES 136u
#define ANSWER_BYTES   149u

struct shared {
    atomic_uint ready; /* the bare process, its successor, and who waits for its end */
    atomic_uint seen;
    _Atomic uint64_t killed_us;
    uint64_t us[BAREEND_WATCHERS_MAX];
};

struct turn {
    struct shared *shared;
    unsigned watchers;
    unsigned started; /* of them */
    bool asks;        /* each of them asks the successor, and that is the end */
    pid_t bare;
    pid_t successor; /* if they ask */
    int lifeline[2]; /* the successor reads its end when the bare process has ended */
    int listener;    /* held by all */
    struct sockaddr_un address;
    socklen_t address_bytes;
    pid_t pids[BAREEND_WATCHERS_MAX];
    int ends[BAREEND_WATCHERS_MAX][2]; /* the watcher's, the bare process's; -1: closed */
};

static uint64_t now_us(void)
{
    return common_now_ns() / 1000;
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

/* A listening socket of a name that the system chooses. */
static bool open_listener(struct turn *turn)
{
    turn->address = (struct sockaddr_un){.sun_family = AF_UNIX};
    turn->address_bytes = sizeof turn->address;
    turn->listener = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0);
    return turn->listener >= 0 && pipe(turn->lifeline) == 0 &&
           bind(turn->listener, (struct sockaddr *)&turn->address, sizeof(sa_family_t)) ==
               0 &&
           listen(turn->listener, BAREEND_WATCHERS_MAX) == 0 &&
           getsockname(turn->listener, (struct sockaddr *)&turn->address,
                       &turn->address_bytes) == 0;
}

static void close_listener(struct turn *turn)
{
    const int fds[] = {turn->listener, turn->lifeline[0], turn->lifeline[1]};

    for (unsigned i = 0; i < 3; i++) {
        if (fds[i] >= 0) {
            (void)close(fds[i]);
        }
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
    (void)close(turn->lifeline[0]);
    for (size_t i = 0; heap != NULL && i < HEAP_BYTES; i += 4096) {
        heap[i] = 1;
    }
    atomic_fetch_add(&turn->shared->ready, 1);
    for (;;) {
        (void)pause();
    }
}

/* Whoever has come: take it, or answer it. */
static void serve(const struct turn *turn, int poll, int fd)
{
    char message[ANSWER_BYTES] = {0};
    struct epoll_event event = {.events = EPOLLIN};

    if (fd != turn->listener) {
        if (recv(fd, message, sizeof message, 0) > 0) {
            (void)send(fd, message, sizeof message, MSG_NOSIGNAL);
        }
        return;
    }
    while ((event.data.fd = accept4(turn->listener, NULL, NULL, SOCK_NONBLOCK)) >= 0) {
        (void)epoll_ctl(poll, EPOLL_CTL_ADD, event.data.fd, &event);
    }
}

/* The least that follows on from the bare process. */
static void be_successor(struct turn *turn)
{
    struct epoll_event events[64];
    struct epoll_event event = {.events = EPOLLIN, .data.fd = turn->listener};
    int poll = epoll_create1(0);
    char byte;

    close_side(turn, 0);
    close_side(turn, 1);
    (void)close(turn->lifeline[1]);
    (void)epoll_ctl(poll, EPOLL_CTL_ADD, turn->listener, &event);
    atomic_fetch_add(&turn->shared->ready, 1);
    (void)read(turn->lifeline[0], &byte, 1);
    for (;;) {
        int count = epoll_wait(poll, events, 64, -1);

        for (int i = 0; i < count; i++) {
            serve(turn, poll, events[i].data.fd);
        }
    }
}

/* Ask the successor, and have its answer. */
static void ask(const struct turn *turn)
{
    char message[ANSWER_BYTES] = {0};
    int fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);

    (void)connect(fd, (const struct sockaddr *)&turn->address, turn->address_bytes);
    (void)send(fd, message, QUESTION_BYTES, MSG_NOSIGNAL);
    (void)recv(fd, message, sizeof message, 0);
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
    if (turn->asks) {
        (void)close(watched.fd);
        ask(turn);
    }
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
    if (turn->asks) {
        turn->successor = fork();
        if (turn->successor == 0) {
            be_successor(turn);
        }
    }
    close_side(turn, 1);
    (void)close(turn->lifeline[1]);
    turn->lifeline[1] = -1;
    for (; turn->bare > 0 && turn->successor >= 0 && turn->started < turn->watchers;
         turn->started++) {
        turn->pids[turn->started] = fork();
        if (turn->pids[turn->started] == 0) {
            be_watcher(turn, turn->started);
        }
        if (turn->pids[turn->started] < 0) {
            return false;
        }
    }
    return turn->bare > 0 && turn->successor >= 0;
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
    if (turn->successor > 0) {
        (void)kill(turn->successor, SIGKILL);
        (void)waitpid(turn->successor, NULL, 0);
    }
    for (unsigned i = 0; i < turn->started; i++) {
        (void)kill(turn->pids[i], SIGKILL);
    }
    for (unsigned i = 0; i < turn->started; i++) {
        (void)waitpid(turn->pids[i], NULL, 0);
    }
    close_side(turn, 0);
    close_side(turn, 1);
    close_listener(turn);
}

bool bareend_turn(unsigned watchers, bool asks, uint64_t *us)
{
    static struct turn turn;
    void *shared = mmap(NULL, sizeof(struct shared), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bool good;

    if (shared == MAP_FAILED || watchers > BAREEND_WATCHERS_MAX) {
        return false;
    }
    memset(&turn, 0, sizeof turn);
    turn.shared = shared;
    turn.watchers = watchers;
    turn.asks = asks;
    turn.listener = turn.lifeline[0] = turn.lifeline[1] = -1;
    good = open_pairs(&turn) && open_listener(&turn) && start(&turn) &&
           await(&turn.shared->ready, watchers + 1 + asks);
    if (good) {
        sleep_ms(SETTLE_MS); /* all wait */
        atomic_store(&turn.shared->killed_us, now_us());
        (void)kill(turn.bare, SIGKILL);
        good = await(&turn.shared->seen, watchers);
    }
    memcpy(us, turn.shared->us, watchers * sizeof *us);
    stop(&turn);
    (void)munmap(shared, sizeof(struct shared));
    return good;
}
