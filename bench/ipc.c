/* bench/ipc.c - what it costs to ask another process.
 *
 * Room:     bench; the public header of the client library.
 * Does:     ping, an empty step and an update of many vertices, against the bare
 *           kernel: a SOCK_SEQPACKET ping-pong of two processes, and memcpy into shared
 *           memory. Both sides of a ratio take turns.
 * Threads:  one; the daemon is a private one.
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

#include "pccd.h"
#include "report.h"

#define MESSAGE_BYTES 16  /* about a ping */
#define TURN          50u /* calls before the other side has its turn */
#define SLOTS         4u  /* of the upload ring; the baseline rotates likewise */

struct peer { /* a process that sends back what it gets */
    int fd;
    pid_t pid;
};

static unsigned turns; /* of either side; the first is not counted */

static void must(int status, const char *what, struct pccd_client *client)
{
    if (status != PCCD_OK) {
        fprintf(stderr, "ipc: %s: %s: %s\n", what, pccd_status_name(status),
                pccd_error_text(client));
        exit(2);
    }
}

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

static struct pccd_client *connect_with(uint32_t spin_us, const char *url)
{
    struct pccd_options options;
    struct pccd_client *client;
    pccd_options_init(&options);
    options.spin_us = spin_us;
    options.url = url;
    options.private_daemon = url == NULL;
    options.slot_count = SLOTS;
    must(pccd_connect(&options, &client), "connect", NULL);
    return client;
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
    uint64_t begin_ns = bench_now_ns();
    bool good = send(peer->fd, out, sizeof out, MSG_NOSIGNAL) == (ssize_t)sizeof out &&
                recv(peer->fd, in, sizeof in, 0) == (ssize_t)sizeof in;
    uint64_t end_ns = bench_now_ns();
    bench_check(good && memcmp(in, out, sizeof in) == 0, "round trip",
                "the peer sends back something else");
    return 1e-3 * (double)(end_ns - begin_ns);
}

static double ping_us(struct pccd_client *client)
{
    uint64_t ns;
    uint64_t begin_ns = bench_now_ns();
    must(pccd_ping(client, &ns), "ping", client);
    return 1e-3 * (double)(bench_now_ns() - begin_ns);
}

/* A step in which nothing moves; its answer must be the same every time. */
static double empty_step_us(struct pccd_client *client, uint32_t scene)
{
    struct pccd_answer answer;
    uint64_t step;
    uint64_t begin_ns = bench_now_ns();
    must(pccd_submit_still(client, scene, NULL, &step), "submit", client);
    must(pccd_wait(client, step, -1, &answer), "wait", client);
    uint64_t end_ns = bench_now_ns();
    bench_check(answer.total == 0 && answer.incomplete == PCCD_COMPLETE, "round trip",
                "a single triangle has contacts");
    pccd_answer_release(client, &answer);
    return 1e-3 * (double)(end_ns - begin_ns);
}

static uint32_t tiny_scene(struct pccd_client *client)
{
    static const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
    must(pccd_scene_create(client, NULL, &scene), "scene", client);
    must(pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL),
         "mesh", client);
    must(pccd_scene_add(client, scene, mesh, &object), "add", client);
    return scene;
}

static void pin(pid_t pid, int cpu) /* cpu < 0: anywhere */
{
    cpu_set_t set;
    CPU_ZERO(&set);
    for (size_t i = 0; i < CPU_SETSIZE; i++) {
        if (cpu < 0 || i == (size_t)cpu) {
            CPU_SET(i, &set);
        }
    }
    if (sched_setaffinity(pid, sizeof set, &set) != 0) {
        perror("ipc: sched_setaffinity");
    }
}

/* We on the first processor, the peers on `cpu`. Only the daemon's loop thread is pinned;
 * what computes is free, so the rows of empty steps belong to `free` alone. */
static void round_trips(const char *place, int cpu, struct pccd_client *blocking,
                        struct pccd_client *spinning)
{
    struct bench_samples samples[4] = {{0}};
    uint32_t scenes[2] = {tiny_scene(blocking), tiny_scene(spinning)};
    struct peer peer;
    peer_start(&peer);
    pin(0, cpu < 0 ? -1 : 0);
    pin(peer.pid, cpu);
    pin((pid_t)pccd_daemon_pid(blocking), cpu);
    for (unsigned turn = 0; turn < turns; turn++) {
        for (unsigned side = 0; side < (cpu < 0 ? 4u : 2u); side++) {
            for (unsigned i = 0; i < TURN; i++) {
                double us = side == 0   ? peer_round_trip_us(&peer, turn * TURN + i)
                            : side == 1 ? ping_us(blocking)
                            : side == 2 ? empty_step_us(blocking, scenes[0])
                                        : empty_step_us(spinning, scenes[1]);
                if (turn > 0) {
                    bench_add(&samples[side], us);
                }
            }
        }
    }
    pin((pid_t)pccd_daemon_pid(blocking), -1);
    pin(0, -1);
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
    must(pccd_scene_destroy(blocking, scenes[0]), "scene.destroy", blocking);
    must(pccd_scene_destroy(spinning, scenes[1]), "scene.destroy", spinning);
}

/* ---- updates of many vertices ----------------------------------------------------- */

#define UPDATE_CONTACTS 3u /* the three vertices of the triangle that passes the last */

struct soup {
    struct pccd_client *client;
    enum pccd_format format;
    uint32_t vertex_count;
    size_t bytes; /* of the positions */
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
    void *x[2]; /* the positions of even and odd steps */
};

/* Small triangles far apart that all move a little; the last but one passes through the
 * last, so that an answer shows whether the positions arrived. All numbers are floats. */
static double soup_coordinate(uint32_t count, uint32_t i, int axis, unsigned odd)
{
    static const float corner[3][3] = {{0, 0, 0}, {0.25f, 0, 0}, {0, 0.25f, 0.125f}};
    uint32_t t = i / 3;
    uint32_t last = count / 3 - 1;
    if (t >= last - 1) {
        double scale = t == last ? 8 : 1; /* the last is the floor of the one before */
        double base = axis == 2   ? (t == last ? 0
                                     : odd     ? -0.5
                                               : 0.5)
                      : t == last ? 0
                                  : 0.5;
        return base + (axis == 2 ? 0 : scale * (double)corner[i % 3][axis]) - 16;
    }
    const uint32_t cell[3] = {t % 128, t / 128 % 128, t / 16384};
    return cell[axis] * 2.0 + (double)corner[i % 3][axis] + (odd ? 0.25 : 0);
}

static void soup_init(struct soup *soup, struct pccd_client *client,
                      enum pccd_format format, uint32_t vertex_count)
{
    uint32_t count = vertex_count / 3 * 3;
    uint32_t(*triangles)[3] = bench_alloc(count / 3, sizeof *triangles);
    size_t value_bytes = format == PCCD_FORMAT_F64 ? 8 : 4;
    *soup = (struct soup){.client = client,
                          .format = format,
                          .vertex_count = count,
                          .bytes = 3 * count * value_bytes};
    for (unsigned odd = 0; odd < 2; odd++) {
        unsigned char *to = soup->x[odd] = bench_alloc(soup->bytes, 1);
        for (uint32_t i = 0; i < 3 * count; i++) {
            double x = soup_coordinate(count, i / 3, (int)(i % 3), odd);
            float f = (float)x;
            memcpy(to + i * value_bytes,
                   format == PCCD_FORMAT_F64 ? (const void *)&x : (const void *)&f,
                   value_bytes);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        triangles[i / 3][i % 3] = i;
    }
    must(pccd_scene_create(client, NULL, &soup->scene), "scene", client);
    must(pccd_mesh_create(client, soup->x[0], format, count,
                          (const uint32_t(*)[3])triangles, count / 3, &soup->mesh, NULL),
         "mesh", client);
    must(pccd_scene_add(client, soup->scene, soup->mesh, &soup->object), "add", client);
    free(triangles);
}

static void soup_deinit(struct soup *soup)
{
    must(pccd_scene_destroy(soup->client, soup->scene), "scene.destroy", soup->client);
    must(pccd_mesh_destroy(soup->client, soup->mesh), "mesh.destroy", soup->client);
    free(soup->x[0]);
    free(soup->x[1]);
}

/* Shared memory as the daemon makes it: every page is there before it is used. */
static unsigned char *shared_new(size_t bytes)
{
    int fd = memfd_create("bench", MFD_CLOEXEC);
    void *map = MAP_FAILED;
    if (fd >= 0 && ftruncate(fd, (off_t)bytes) == 0) {
        map = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
    }
    if (map == MAP_FAILED) {
        perror("ipc: memfd");
        exit(2);
    }
    close(fd);
    return map;
}

/* OUTSIDE: of the whole update, what is not the step: the client's own copy, messages and
 * wake-ups. */
enum update { COPY, TOTAL, OUTSIDE, INGEST, REFIT, TRAVERSAL, UPDATE_QUANTITIES };

/* One update, and one copy of the same bytes. Returns the hash of the answer. */
static uint64_t update(struct soup *soup, unsigned i, unsigned char *shared,
                       struct bench_samples *samples)
{
    struct pccd_answer answer;
    unsigned odd = (i + 1) % 2;
    uint64_t t0 = bench_now_ns();
    memcpy(shared + i % SLOTS * soup->bytes, soup->x[odd], soup->bytes);
    uint64_t t1 = bench_now_ns();
    must(pccd_step_x1(soup->client, soup->scene, soup->object, soup->x[odd], soup->format,
                      soup->vertex_count, NULL, &answer),
         "step", soup->client);
    uint64_t t2 = bench_now_ns();
    bench_check(answer.total == UPDATE_CONTACTS && answer.vf == UPDATE_CONTACTS, "update",
                "the positions did not arrive");
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
        struct soup soup;
        bool good = true;
        soup_init(&soup, client, (enum pccd_format)format, vertex_count);
        unsigned char *shared = shared_new(SLOTS * soup.bytes);
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
        munmap(shared, SLOTS * soup.bytes);
        soup_deinit(&soup);
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
    struct pccd_client *blocking = connect_with(0, NULL);
    struct pccd_client *spinning = connect_with(50, pccd_url(blocking));
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
