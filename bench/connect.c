/* connect.c - what it costs to begin: time and memory until the first answers.
 *
 * What is asked of each is what the ratios are to. Needs PCCDD and PCCDCTL, which make
 * sets.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crossing.h"
#include "daemon.h"
#include "grid.h"
#include "process_status.h"
#include "raw.h"
#include "sections.h"

#define SOUP       1000u
#define SIDE_LARGE 300u /* 178 802 triangles, and the floor's */
#define KIB        1024.0

/* The defaults of libpccd. */
#define SLOT_COUNT 4u
#define SLOT_BYTES 65536u

static struct test_daemon daemon_;
static unsigned repeats;

/* A row beside what was asked for. */
static void row(const char *scene, const char *what, const char *unit,
                struct bench_samples *samples, double asked)
{
    struct bench_samples base = {&asked, 1, 1};
    bench_row(scene, what, unit, samples, "asked", &base);
    bench_free(samples);
}

static struct pccd_client *connect_by_default(void)
{
    struct pccd_options options;
    struct pccd_client *client = NULL;
    memset(&options, 0, sizeof options);
    options.url = daemon_.url;
    bench_need(pccd_connect(&options, &client) == 0, "pccd_connect");
    return client;
}

/* ---- attach ------------------------------------------------------------------------ */

static void attach(void)
{
    static struct test_raw raw;
    struct bench_samples ms = {NULL, 0, 0};
    for (unsigned i = 0; i < repeats; i++) {
        bench_need(test_raw_open(&raw, daemon_.socket) && test_raw_hello(&raw) == 0,
                   "hello");
        uint64_t begin_ns = common_now_ns();
        bench_need(test_raw_attach(&raw, SLOT_COUNT, SLOT_BYTES) == 0, "shm.attach");
        bench_add(&ms, (double)(common_now_ns() - begin_ns) * 1e-6);
        test_raw_close(&raw);
    }
    row("attach", "shm.attach, mapped", "ms", &ms, 1);
}

/* ---- the first answer -------------------------------------------------------------- */

/* Triangles that share no vertex, every other one above, or below, another. */
static void make_soup(double x[3 * SOUP][3], uint32_t triangles[SOUP][3], double height)
{
    for (uint32_t i = 0; i < SOUP; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            bool is_mover = i % 2 == 1;
            x[3 * i + k][0] = i / 2 % 25 * 2 + (is_mover ? 0.3 - 0.07 * k : k == 1);
            x[3 * i + k][1] = i / 50 * 2 + (is_mover ? 0.2 + 0.05 * k * k : k == 2);
            x[3 * i + k][2] = is_mover ? height + 0.01 * k : 0.001 * i;
            triangles[i][k] = 3 * i + k;
        }
    }
}

/* Positions that move on from where the mesh was registered. */
static void first_answer(void)
{
    static double begin[3 * SOUP][3];
    static double end[3 * SOUP][3];
    static uint32_t triangles[SOUP][3];
    struct bench_samples ms = {NULL, 0, 0};
    struct bench_samples kib = {NULL, 0, 0};
    make_soup(begin, triangles, 1);
    make_soup(end, triangles, -1);
    for (unsigned i = 0; i < repeats; i++) {
        uint64_t begin_ns = common_now_ns();
        struct pccd_client *client = connect_by_default();
        uint32_t mesh = 0;
        uint32_t scene = 0;
        uint32_t object = 0;
        struct pccd_answer answer = PCCD_ANSWER_INIT;
        bool is_right = pccd_mesh_create(client, begin, PCCD_FORMAT_F64, 3 * SOUP,
                                         triangles, SOUP, &mesh, NULL) == 0 &&
                        pccd_scene_create(client, NULL, &scene) == 0 &&
                        pccd_scene_add(client, scene, mesh, &object) == 0 &&
                        pccd_step_x1(client, scene, object, end, PCCD_FORMAT_F64,
                                     3 * SOUP, NULL, &answer) == 0;
        bench_add(&ms, (double)(common_now_ns() - begin_ns) * 1e-6);
        if (!bench_check(is_right && answer.total > 0, "first answer",
                         is_right ? "no contact" : pccd_error_text(client))) {
            pccd_close(client);
            break;
        }
        bench_add(&kib, (double)test_stat(client, "shm_bytes_now") / KIB);
        pccd_answer_release(client, &answer);
        pccd_close(client);
    }
    row("first answer", "connect to 1000 triangles", "ms", &ms, 5);
    row("first answer", "shared memory", "KiB", &kib, 512);
}

/* ---- pccdctl check ----------------------------------------------------------------- */

static void write_triangles(const char *path, double height)
{
    FILE *file = fopen(path, "w");
    bench_need(file != NULL, path);
    fprintf(file,
            "v -9 -9 0\nv 9 -9 0\nv 0 9 0\nv -1 0 %g\nv 1 0 %g\nv 0 1 %g\n"
            "f 1 2 3\nf 4 5 6\n",
            height, height, height);
    bench_need(fclose(file) == 0, path);
}

/* Run it once, silently; it finds something. */
static void run_check(char *const *arguments, double *ms, double *mib)
{
    struct rusage usage;
    int status = 0;
    uint64_t begin_ns = common_now_ns();
    pid_t child = fork();
    if (child == 0) {
        if (freopen("/dev/null", "w", stdout) != NULL) {
            execv(arguments[0], arguments);
        }
        _exit(127);
    }
    bench_need(child > 0 && wait4(child, &status, 0, &usage) == child, "pccdctl");
    *ms = (double)(common_now_ns() - begin_ns) * 1e-6;
    *mib = (double)usage.ru_maxrss / KIB;
    bench_check(WIFEXITED(status) && WEXITSTATUS(status) == 1, "check", "exit status");
}

static void check(const char *name, const char *way, double asked_ms)
{
    char folder[] = "/tmp/pccd-bench-XXXXXX";
    char before[64];
    char after[64];
    char program[512];
    char where[320];
    struct bench_samples ms = {NULL, 0, 0};
    struct bench_samples mib = {NULL, 0, 0};
    bench_need(getenv("PCCDCTL") != NULL, "PCCDCTL is not set");
    bench_need(mkdtemp(folder) != NULL, folder);
    snprintf(program, sizeof program, "%s", getenv("PCCDCTL"));
    snprintf(where, sizeof where, "%s", way);
    snprintf(before, sizeof before, "%s/0.obj", folder);
    snprintf(after, sizeof after, "%s/1.obj", folder);
    write_triangles(before, 1);
    write_triangles(after, -1);
    char command[] = "check";
    char *arguments[] = {program, command, where, before, after, NULL};
    for (unsigned i = 0; i < repeats; i++) {
        double one_ms = 0;
        double one_mib = 0;
        run_check(arguments, &one_ms, &one_mib);
        bench_add(&ms, one_ms);
        bench_add(&mib, one_mib);
    }
    row(name, "pccdctl check", "ms", &ms, asked_ms);
    row(name, "its memory at most", "MiB", &mib, 15);
    bench_need(unlink(before) == 0 && unlink(after) == 0 && rmdir(folder) == 0, folder);
}

/* ---- the first step ---------------------------------------------------------------- */

static double turn_ms(struct test_grid *grid)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    uint64_t step = 0;
    uint64_t begin_ns = common_now_ns();
    bench_need(test_grid_submit(grid, NULL, &step) == 0 &&
                   pccd_wait(grid->client, step, -1, &answer) == 0,
               "a step");
    double ms = (double)(common_now_ns() - begin_ns) * 1e-6;
    bench_check(test_grid_is_right(grid, &answer), "first step", "contacts");
    pccd_answer_release(grid->client, &answer);
    return ms;
}

static void first_step(uint32_t side)
{
    struct bench_side sides[] = {{"178 802 triangles, first", "ms", NULL, 0, 1, {0}},
                                 {"second", "ms", NULL, 0, 1, {0}}};
    struct bench_samples ratio = {NULL, 0, 0};
    for (unsigned i = 0; i < (repeats + 4) / 5; i++) {
        struct pccd_client *client = connect_by_default();
        struct test_grid grid;
        bench_need(test_grid_make(client, side, &grid) == 0, "test_grid_make");
        double one = turn_ms(&grid);
        double two = turn_ms(&grid);
        bench_add(&sides[0].samples, one);
        bench_add(&sides[1].samples, two);
        bench_add(&ratio, one / two);
        test_grid_free(&grid);
        pccd_close(client);
    }
    bench_sides_end("first step", sides, 2, true);
    row("first step", "first, of a second", "times", &ratio, 3);
}

int section_connect(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    char url[320];
    repeats = options->smoke ? 2 : 50;
    bench_need(test_daemon_start(&daemon_, NULL), "no daemon");
    bench_heading("to begin");
    if (bench_is_wanted(options, "attach")) {
        attach();
    }
    if (bench_is_wanted(options, "first answer")) {
        first_answer();
    }
    snprintf(url, sizeof url, "--url=%s", daemon_.url);
    if (bench_is_wanted(options, "check, it runs")) {
        check("check, it runs", url, 10);
    }
    if (bench_is_wanted(options, "check, private")) {
        check("check, private", "--private", 30);
    }
    bench_number("daemon", "its memory at most", "MiB",
                 (double)common_process_status(daemon_.pid, "VmHWM:") / KIB);
    if (bench_is_wanted(options, "first step")) {
        first_step(options->smoke ? 30 : SIDE_LARGE);
    }
    bench_need(test_daemon_finish(&daemon_), "the daemon's end");
    return 0;
}
