/* least.c - the least that a process can do that sleeps until it is asked. */
#include "rows.h"

#include <errno.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef HAVE_SECCOMP
#include <seccomp.h>
#endif

#define BUFFER_BYTES  65536u
#define CONTROL_BYTES 1048u /* for as many descriptors as can come */

const char least_ping[LEAST_MESSAGE_BYTES] = {0};

/* ---- the server -------------------------------------------------------------------- */

/* As the daemon's; without libseccomp that has none either. */
static void enter_filter(void)
{
#ifdef HAVE_SECCOMP
    static const int allowed[] = {SCMP_SYS(recvmsg), SCMP_SYS(sendto),
                                  SCMP_SYS(epoll_wait), SCMP_SYS(epoll_pwait),
                                  SCMP_SYS(exit_group)};
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    int status = filter == NULL ? -1 : 0;
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0] && status == 0; i++) {
        status = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed[i], 0);
    }
    if (status != 0 || seccomp_load(filter) != 0) {
        _exit(2);
    }
    seccomp_release(filter);
#endif
}

static ssize_t receive(int fd, char buffer[BUFFER_BYTES])
{
    union {
        struct cmsghdr align;
        char bytes[CONTROL_BYTES];
    } control;
    struct iovec iov = {.iov_base = buffer, .iov_len = BUFFER_BYTES};
    struct msghdr header = {.msg_iov = &iov,
                            .msg_iovlen = 1,
                            .msg_control = control.bytes,
                            .msg_controllen = sizeof control.bytes};
    return recvmsg(fd, &header, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
}

/* The first eight bytes of a message say how many to copy. */
static void serve_one(const struct least *least, int fd, unsigned char *private)
{
    static char buffer[BUFFER_BYTES];
    uint64_t bytes = 0;
    ssize_t got = receive(fd, buffer);
    if (got <= 0) {
        _exit(0);
    }
    memcpy(&bytes, buffer, sizeof bytes);
    if (bytes > 0 && bytes <= least->shared_bytes) {
        memcpy(private, least->shared, bytes);
        __asm__ volatile("" : : "r"(private) : "memory");
        *least->copied_ns = common_now_ns(); /* the message that follows orders it */
    }
    if (sendto(fd, buffer, (size_t)got, MSG_NOSIGNAL | MSG_DONTWAIT, NULL, 0) != got) {
        _exit(1);
    }
}

static void serve(const struct least *least, const int fds[LEAST_CLIENTS])
{
    struct epoll_event events[LEAST_CLIENTS];
    int epoll = epoll_create1(EPOLL_CLOEXEC);
    unsigned char *private = malloc(least->shared_bytes);
    if (epoll < 0 || private == NULL || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) {
        _exit(2);
    }
    memset(private, 1, least->shared_bytes);
    for (uint32_t i = 0; i < LEAST_CLIENTS; i++) {
        struct epoll_event event = {.events = EPOLLIN | EPOLLRDHUP, .data.fd = fds[i]};
        if (epoll_ctl(epoll, EPOLL_CTL_ADD, fds[i], &event) != 0) {
            _exit(2);
        }
    }
    enter_filter();
    for (;;) { /* until a client's end, or ours */
        int ready = epoll_wait(epoll, events, LEAST_CLIENTS, -1);
        if (ready < 0 && errno != EINTR) {
            _exit(2);
        }
        for (int i = 0; i < ready; i++) {
            serve_one(least, events[i].data.fd, private);
        }
    }
}

/* ---- its client -------------------------------------------------------------------- */

static size_t mapped_bytes(const struct least *least)
{
    return least->shared_bytes + sizeof *least->copied_ns;
}

void least_start(struct least *least, size_t shared_bytes)
{
    int theirs[LEAST_CLIENTS];
    *least = (struct least){.shared_bytes = (shared_bytes + 63) & ~(size_t)63};
    least->shared = mmap(NULL, mapped_bytes(least), PROT_READ | PROT_WRITE,
                         MAP_SHARED | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
    bench_need(least->shared != MAP_FAILED, "mmap");
    least->copied_ns = (uint64_t *)(void *)(least->shared + least->shared_bytes);
    for (uint32_t i = 0; i < LEAST_CLIENTS; i++) {
        int pair[2];
        bench_need(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) == 0,
                   "socketpair");
        least->fds[i] = pair[0];
        theirs[i] = pair[1];
    }
    least->pid = fork();
    bench_need(least->pid >= 0, "fork");
    if (least->pid == 0) {
        for (uint32_t i = 0; i < LEAST_CLIENTS; i++) {
            close(least->fds[i]);
        }
        serve(least, theirs);
    }
    for (uint32_t i = 0; i < LEAST_CLIENTS; i++) {
        close(theirs[i]);
    }
    (void)least_ask(least, 0); /* it serves from here on */
}

void least_stop(struct least *least)
{
    for (uint32_t i = 0; i < LEAST_CLIENTS; i++) {
        close(least->fds[i]);
    }
    waitpid(least->pid, NULL, 0);
    munmap(least->shared, mapped_bytes(least));
}

uint64_t least_ask(const struct least *least, size_t copy_bytes)
{
    int fd = least->fds[LEAST_CLIENTS - 1];
    uint64_t message = copy_bytes;
    uint64_t answer = 1;
    bench_need(send(fd, &message, sizeof message, MSG_NOSIGNAL) ==
                       (ssize_t)sizeof message &&
                   recv(fd, &answer, sizeof answer, 0) == (ssize_t)sizeof answer &&
                   answer == message,
               "the least server does not answer");
    return *least->copied_ns;
}
