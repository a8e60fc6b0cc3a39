/* ipc.c - what it costs to ask another process.
 *
 * Ping, an empty step and an update of many vertices, against the bare kernel: a
 * SOCK_SEQPACKET ping-pong of two processes, and memcpy into shared memory. Both sides of
 * a ratio take turns.
 */
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "asker.h"
#include "pccd.h"
#include "report.h"

#define MESSAGE_BYTES 16  /* about a ping */
#define TURN          50u /* calls before the other side has its turn */

struct peer { /* a process that sends back what it gets */
    int fd;
    pid_t pid;
};

static unsigned turns; /* of either side; the first is not counted */

static void print(const char *scene, const char *what, const char *unit,
                  const struct bench_samples *samples, const char *base_name,
                  const struct bench_samples *base)
{
    bench_row(&(struct bench_row){.scene = scene,
                                  .what = what,
                                  .unit = unit,
                                  .samples = samples,
                                  .base_name = base_name,
                                  .base = base});
}

/* ---- round trips ------------------------------------------------------------------ */

static void echo(int fd)
{
    char message[MESSAGE_BYTES];
    for (;;) {
        ssize_t n = recv(fd, message, sizeof message, 0);
        if (n <= 0 && !(n < 0 && errno == EINTR)) {
            _exit(0);
        }
        if (n > 0 && send(fd, message, (size_t)n, MSG_NOSIGNAL) != n) {
            _exit(1);
        }
    }
}

static void peer_start(struct peer *peer)
{
    int fds[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, fds) != 0 ||
        (peer->pid = fork()) < 0) {
        perror("ipc: socketpair, fork");
        exit(2);
    }
    if (peer->pid == 0) {
        close(fds[0]);
        echo(fds[1]);
    }
    close(fds[1]);
    peer->fd = fds[0];
}

static void peer_stop(struct peer *peer)
{
    close(peer->fd);
    waitpid(peer->pid, NULL, 0);
}

static double peer_round_trip_us(const struct peer *peer, uint64_t number)
{
    unsigned char out[MESSAGE_BYTES] = {0};
    unsigned char in[MESSAGE_BYTES] = {0};
    memcpy(out, &number, sizeof number);
    uint64_t begin_ns = common_now_ns();
    bool good = send(peer->fd, out, sizeof out, MSG_NOSIGNAL) == (ssize_t)sizeof out &&
                recv(peer->fd, in, sizeof in, 0) == (ssize_t)sizeof in;
    uint64_t end_ns = common_now_ns();
    bench_check(good && memcmp(in, out, sizeof in) == 0, "round trip",
                "the peer sends back something else");
    return 1e-3 * (double)(end_ns - begin_ns);
}

/* We on the first processor, the peers on `cpu`. Only the daemon's loop thread is pinned;
 * what computes is free, so the rows of empty steps belong to `free` alone. */
static void round_trips(const char *place, int cpu, struct pccd_client *blocking,
                        struct pccd_client *spinning)
{
    struct bench_samples samples[4] = {{0}};
    uint32_t scenes[2] = {bench_tiny_scene(blocking), bench_tiny_scene(spinning)};
    struct peer peer;
    peer_start(&peer);
    bench_pin(0, cpu < 0 ? -1 : 0);
    bench_pin(peer.pid, cpu);
    bench_pin((pid_t)pccd_daemon_pid(blocking), cpu);
    for (unsigned turn = 0; turn < turns; turn++) {
        for (unsigned side = 0; side < (cpu < 0 ? 4u : 2u); side++) {
            for (unsigned i = 0; i < TURN; i++) {
                double us = side == 0   ? peer_round_trip_us(&peer, turn * TURN + i)
                            : side == 1 ? bench_ping_us(blocking)
                            : side == 2 ? bench_empty_step_us(blocking, scenes[0])
                                        : bench_empty_step_us(spinning, scenes[1]);
                if (turn > 0) {
                    bench_add(&samples[side], us);
                }
            }
        }
    }
    bench_pin((pid_t)pccd_daemon_pid(blocking), -1);
    bench_pin(0, -1);
    peer_stop(&peer);
    print(place, "kernel round trip", "us", &samples[0], NULL, NULL);
    print(place, "ping", "us", &samples[1], "kernel", &samples[0]);
    if (cpu < 0) {
        print(place, "empty step, blocking", "us", &samples[2], "kernel", &samples[0]);
        print(place, "empty step, 50 us spin", "us", &samples[3], "kernel", &samples[0]);
    }
    for (int side = 0; side < 4; side++) {
        bench_free(&samples[side]);
    }
    bench_must(pccd_scene_destroy(blocking, scenes[0]), "scene.destroy", blocking);
    bench_must(pccd_scene_destroy(spinning, scenes[1]), "scene.destroy", spinning);
}

/* ---- updates of many vertices ----------------------------------------------------- */

/* OUTSIDE: of the whole update, what is not the step: the client's own copy, messages and
 * wake-ups. */
enum update { COPY, TOTAL, OUTSIDE, INGEST, REFIT, TRAVERSAL, UPDATE_QUANTITIES };

/* One update, and one copy of the same bytes. Returns the hash of the answer. */
static uint64_t update(struct bench_soup *soup, unsigned i, unsigned char *shared,
                       struct bench_samples *samples)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    unsigned odd = (i + 1) % 2;
    uint64_t t0 = common_now_ns();
    memcpy(shared + i % BENCH_SLOTS * soup->bytes, soup->x[odd], soup->bytes);
    uint64_t t1 = common_now_ns();
    bench_must(pccd_step_x1(soup->client, soup->scene, soup->object, soup->x[odd],
                            soup->format, soup->vertex_count, NULL, &answer),
               "step", soup->client);
    uint64_t t2 = common_now_ns();
    bench_check(answer.total == BENCH_SOUP_CONTACTS &&
                    answer.counts[PCCD_VF] == BENCH_SOUP_CONTACTS,
                "update", "the positions did not arrive");
    if (i >= 3) {
        const double us[UPDATE_QUANTITIES] = {
            [COPY] = (double)(t1 - t0),
            [TOTAL] = (double)(t2 - t1),
            [INGEST] = (double)answer.times.ingest,
            [REFIT] = (double)answer.times.refit,
            [OUTSIDE] = (double)(t2 - t1) - (double)answer.times.step,
            [TRAVERSAL] = (double)answer.times.traversal,
        };
        for (int q = 0; q < UPDATE_QUANTITIES; q++) {
            bench_add(&samples[q], 1e-3 * us[q]);
        }
    }
    uint64_t hash = answer.hash[0] ^ answer.hash[1];
    pccd_answer_release(soup->client, &answer);
    return hash;
}

static void updates(struct pccd_client *client, const char *name, uint32_t vertex_count,
                    unsigned repeats)
{
    static const char *const names[2][UPDATE_QUANTITIES] = {
        {"float: memcpy", "float: update", "float: update less step", "float: ingest",
         "float: refit", "float: traversal"},
        {"double: memcpy", "double: update", "double: update less step", "double: ingest",
         "double: refit", "double: traversal"}};
    uint64_t hashes[2][2] = {{0}}; /* [format][odd] */
    for (int format = PCCD_FORMAT_F32; format < PCCD_FORMAT_COUNT; format++) {
        struct bench_samples samples[UPDATE_QUANTITIES] = {{0}};
        struct bench_soup soup;
        bool good = true;
        bench_soup_init(&soup, client, (enum pccd_format)format, vertex_count);
        unsigned char *shared = bench_shared_new(BENCH_SLOTS * soup.bytes);
        for (unsigned i = 0; i < repeats + 3 && good; i++) {
            uint64_t hash = update(&soup, i, shared, samples);
            good = i < 2 || bench_check(hash == hashes[format][i % 2], name,
                                        "the same step has another answer");
            hashes[format][i % 2] = hash;
        }
        for (int q = 0; q < UPDATE_QUANTITIES && good; q++) {
            print(name, names[format][q], "us", &samples[q],
                  q == TOTAL || q == OUTSIDE || q == INGEST ? "memcpy" : NULL,
                  &samples[COPY]);
        }
        for (int q = 0; q < UPDATE_QUANTITIES; q++) {
            bench_free(&samples[q]);
        }
        munmap(shared, BENCH_SLOTS * soup.bytes);
        bench_soup_deinit(&soup);
    }
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        uint32_t vertex_count;
        unsigned repeats;
    } sizes[] = {{"46 K vertices", 46000, 100},
                 {"250 K vertices", 250000, 40},
                 {"1 M vertices", 1000000, 15}};
    struct bench_options options;
    int exit_status;
    if (!bench_begin("ipc", argc, argv, &options, &exit_status)) {
        return exit_status;
    }
    turns = options.smoke ? 3 : 60;
    struct pccd_client *blocking = bench_connect(0, NULL);
    struct pccd_client *spinning = bench_connect(50, pccd_url(blocking));
    bench_heading("round trips");
    if (bench_is_wanted(&options, "free")) {
        round_trips("free", -1, blocking, spinning);
    }
    if (bench_is_wanted(&options, "one processor")) {
        round_trips("one processor", 0, blocking, spinning);
    }
    if (bench_is_wanted(&options, "two processors") &&
        sysconf(_SC_NPROCESSORS_ONLN) > 1) {
        round_trips("two processors", 1, blocking, spinning);
    }
    bench_heading("updates");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        if (bench_is_wanted(&options, sizes[i].name)) {
            updates(blocking, options.smoke ? "tiny" : sizes[i].name,
                    options.smoke ? 300 * (uint32_t)(i + 1) : sizes[i].vertex_count,
                    options.smoke ? 3 : sizes[i].repeats);
        }
    }
    pccd_close(spinning);
    pccd_close(blocking);
    return bench_end();
}
