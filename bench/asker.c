/* asker.c - a client of a private daemon, and what it asks. */
#include "asker.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "report.h"

void bench_must(int status, const char *what, struct pccd_client *client)
{
    if (status != PCCD_OK) {
        fprintf(stderr, "bench: %s: %s: %s\n", what, pccd_status_name(status),
                pccd_error_text(client));
        exit(2);
    }
}

struct pccd_client *bench_connect(uint32_t spin_us, const char *url)
{
    struct pccd_options options;
    struct pccd_client *client;
    pccd_options_init(&options);
    options.spin_us = spin_us;
    options.url = url;
    options.private_daemon = url == NULL;
    options.slot_count = BENCH_SLOTS;
    bench_must(pccd_connect(&options, &client), "connect", NULL);
    return client;
}

double bench_ping_us(struct pccd_client *client)
{
    uint64_t ns;
    uint64_t begin_ns = common_now_ns();
    bench_must(pccd_ping(client, &ns), "ping", client);
    return 1e-3 * (double)(common_now_ns() - begin_ns);
}

/* A step in which nothing moves; its answer must be the same every time. */
double bench_empty_step_us(struct pccd_client *client, uint32_t scene)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step;
    uint64_t begin_ns = common_now_ns();
    bench_must(pccd_submit_still(client, scene, NULL, &step), "submit", client);
    bench_must(pccd_wait(client, step, -1, &answer), "wait", client);
    uint64_t end_ns = common_now_ns();
    bench_check(answer.total == 0 && answer.incomplete == PCCD_COMPLETE, "round trip",
                "a single triangle has contacts");
    pccd_answer_release(client, &answer);
    return 1e-3 * (double)(end_ns - begin_ns);
}

uint32_t bench_tiny_scene(struct pccd_client *client)
{
    static const float x[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    static const uint32_t triangle[1][3] = {{0, 1, 2}};
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;
    bench_must(pccd_scene_create(client, NULL, &scene), "scene", client);
    bench_must(pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3, triangle, 1, &mesh, NULL),
               "mesh", client);
    bench_must(pccd_scene_add(client, scene, mesh, &object), "add", client);
    return scene;
}

void bench_pin(pid_t pid, int cpu) /* cpu < 0: anywhere */
{
    cpu_set_t set;
    CPU_ZERO(&set);
    for (size_t i = 0; i < CPU_SETSIZE; i++) {
        if (cpu < 0 || i == (size_t)cpu) {
            CPU_SET(i, &set);
        }
    }
    if (sched_setaffinity(pid, sizeof set, &set) != 0) {
        perror("bench: sched_setaffinity");
    }
}

/* ---- many vertices ----------------------------------------------------------------- */

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

void bench_soup_init(struct bench_soup *soup, struct pccd_client *client,
                     enum pccd_format format, uint32_t vertex_count)
{
    uint32_t count = vertex_count / 3 * 3;
    uint32_t(*triangles)[3] = bench_alloc(count / 3, sizeof *triangles);
    size_t value_bytes = format == PCCD_FORMAT_F64 ? 8 : 4;
    *soup = (struct bench_soup){.client = client,
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
    bench_must(pccd_scene_create(client, NULL, &soup->scene), "scene", client);
    bench_must(pccd_mesh_create(client, soup->x[0], format, count,
                                (const uint32_t(*)[3])triangles, count / 3, &soup->mesh,
                                NULL),
               "mesh", client);
    bench_must(pccd_scene_add(client, soup->scene, soup->mesh, &soup->object), "add",
               client);
    free(triangles);
}

void bench_soup_deinit(struct bench_soup *soup)
{
    bench_must(pccd_scene_destroy(soup->client, soup->scene), "scene.destroy",
               soup->client);
    bench_must(pccd_mesh_destroy(soup->client, soup->mesh), "mesh.destroy", soup->client);
    free(soup->x[0]);
    free(soup->x[1]);
}

/* Shared memory as the daemon makes it: every page is there before it is used. */
unsigned char *bench_shared_new(size_t bytes)
{
    int fd = memfd_create("bench", MFD_CLOEXEC);
    void *map = MAP_FAILED;
    if (fd >= 0 && ftruncate(fd, (off_t)bytes) == 0) {
        map = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, 0);
    }
    bench_need(map != MAP_FAILED, "memfd");
    close(fd);
    return map;
}
