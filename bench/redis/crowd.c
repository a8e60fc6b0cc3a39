/* crowd.c - fifty connections with a ping each in flight. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "asker.h"
#include "codec.h"
#include "rows.h"

#define CLIENTS 50u

struct crowd {
    const char *name;
    int epoll;
    int fds[CLIENTS];
    const void *question;
    size_t question_bytes;
    const void *answer; /* how it begins */
    size_t answer_bytes;
};

/* Say hello: who does not is closed after ten seconds. */
static void say_hello(int fd)
{
    static struct proto_encoder message;
    struct proto_HELLO_request hello = {.version_min = 1, .version_max = UINT32_MAX};
    char got[4096];
    bench_need(proto_encode_request(&message, 1, PROTO_METHOD_HELLO, &hello) == 0 &&
                   send(fd, message.data, message.bytes, MSG_NOSIGNAL) ==
                       (ssize_t)message.bytes &&
                   recv(fd, got, sizeof got, 0) > 0,
               "hello");
}

static int connect_daemon(const char *url)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    snprintf(address.sun_path, sizeof address.sun_path, "%s", url + strlen("unix:"));
    bench_need(fd >= 0 && connect(fd, (struct sockaddr *)&address, sizeof address) == 0,
               url);
    say_hello(fd);
    return fd;
}

static void watch_all(struct crowd *crowd)
{
    crowd->epoll = epoll_create1(EPOLL_CLOEXEC);
    for (uint32_t i = 0; i < CLIENTS; i++) {
        struct epoll_event event = {.events = EPOLLIN, .data.u32 = i};
        bench_need(crowd->epoll >= 0 &&
                       epoll_ctl(crowd->epoll, EPOLL_CTL_ADD, crowd->fds[i], &event) == 0,
                   "epoll");
    }
}

static void end(struct crowd *crowd)
{
    for (uint32_t i = 0; i < CLIENTS; i++) {
        close(crowd->fds[i]);
    }
    close(crowd->epoll);
}

static void ask(const struct crowd *crowd, uint32_t i)
{
    bench_need(send(crowd->fds[i], crowd->question, crowd->question_bytes,
                    MSG_NOSIGNAL) == (ssize_t)crowd->question_bytes,
               crowd->name);
}

static void take_answer(const struct crowd *crowd, uint32_t i)
{
    char got[256];
    ssize_t n = recv(crowd->fds[i], got, sizeof got, 0);
    if (n < (ssize_t)crowd->answer_bytes ||
        memcmp(got, crowd->answer, crowd->answer_bytes) != 0) {
        bench_check(false, crowd->name, "a ping has another answer");
        exit(1);
    }
}

/* Returns answers a second, in thousands. */
static double rate(const struct crowd *crowd, uint32_t count)
{
    struct epoll_event events[CLIENTS];
    uint32_t asked = CLIENTS;
    uint64_t begin_ns = common_now_ns();
    for (uint32_t i = 0; i < CLIENTS; i++) {
        ask(crowd, i);
    }
    for (uint32_t answered = 0; answered < count;) {
        int ready = epoll_wait(crowd->epoll, events, CLIENTS, -1);
        for (int i = 0; i < ready; i++, answered++) {
            take_answer(crowd, events[i].data.u32);
            if (asked < count) {
                ask(crowd, events[i].data.u32);
                asked++;
            }
        }
    }
    return 1e6 * count / (double)(common_now_ns() - begin_ns);
}

static void place(const struct rows *rows, int client, int server)
{
    bench_pin(0, client);
    bench_pin((pid_t)pccd_daemon_pid(rows->blocking), server);
    bench_pin(rows->least->pid, server);
    if (rows->redis) {
        bench_pin(rows->redis->pid, server);
    }
}

void rows_crowd(const struct rows *rows)
{
    static const unsigned char answer[] = {0x94, 1, 1, 0xc0}; /* [1, id, nil, .. */
    static struct proto_encoder message;
    struct proto_PING_request ping = {0};
    struct crowd ours = {
        .name = "pccdd", .answer = answer, .answer_bytes = sizeof answer};
    struct crowd redis = {.name = "redis",
                          .question = REDIS_PING,
                          .question_bytes = REDIS_PING_BYTES,
                          .answer = REDIS_PONG,
                          .answer_bytes = REDIS_PONG_BYTES};
    struct crowd least = {.name = "the least",
                          .question = least_ping,
                          .question_bytes = sizeof least_ping,
                          .answer = least_ping,
                          .answer_bytes = sizeof least_ping};
    struct pairs pairs[3] = {0};
    bench_need(proto_encode_request(&message, 1, PROTO_METHOD_PING, &ping) == 0,
               "encode");
    ours.question = message.data;
    ours.question_bytes = message.bytes;
    for (uint32_t i = 0; i < CLIENTS; i++) {
        ours.fds[i] = connect_daemon(pccd_url(rows->blocking));
        redis.fds[i] = rows->redis ? redis_connect(rows->redis) : -1;
        least.fds[i] = dup(rows->least->fds[i]);
    }
    watch_all(&least);
    watch_all(&ours);
    if (rows->redis) {
        watch_all(&redis);
    }
    int second = sysconf(_SC_NPROCESSORS_ONLN) > 1 ? 1 : 0;
    place(rows, 0, second); /* as the kernel places them, but always */
    uint32_t count = rows->smoke ? 500 : 20000;
    for (unsigned turn = 0, turns = rows->smoke ? 2 : 20; turn <= turns; turn++) {
        double redis_rate = rows->redis ? rate(&redis, count) : 0;
        double our_rate = rate(&ours, count);
        double least_rate = rate(&least, count);
        if (turn > 0 && rows->redis) {
            pairs_add(&pairs[0], our_rate, redis_rate);
            pairs_add(&pairs[1], least_rate, redis_rate);
        } else if (turn > 0) {
            pairs_add(&pairs[2], our_rate, least_rate);
        }
    }
    place(rows, -1, -1);
    pairs_print(&(struct pairs_row){"2", "pings of 50 clients", "PING of 50 clients",
                                    "K/s", PAIRS_AT_LEAST, 1.0},
                &pairs[0]);
    pairs_print(
        &(struct pairs_row){"", "the least", "PING of 50 clients", "K/s", PAIRS_TOLD, 0},
        &pairs[1]);
    pairs_print(&(struct pairs_row){"2", "pings of 50 clients", "the least", "K/s",
                                    PAIRS_TOLD, 0},
                &pairs[2]);
    end(&least);
    end(&ours);
    if (rows->redis) {
        end(&redis);
    }
}
