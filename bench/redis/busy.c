/* busy.c - ping while a step computes for a second. */
#include <stdlib.h>

#include "asker.h"
#include "rows.h"

#define JOB_NS 1000000000u

/* Between two pings, so that who pings needs a small share of a processor. Without a
 * pause it and the loop want a whole one, of which fair shares leave them two thirds:
 * the rest is waited for in slices, now and then. That is told, too. */
#define PAUSE_NS 1000000

/* A step that takes a while: triangles that are slivers along a diagonal, side by side in
 * one box, so that every pair is a candidate and none meets. */
static uint32_t diagonal_scene(struct pccd_client *client, uint32_t count, uint32_t *mesh)
{
    float(*x)[3] = bench_alloc(3 * count, sizeof *x);
    uint32_t(*triangles)[3] = bench_alloc(count, sizeof *triangles);
    uint32_t scene;
    uint32_t object;
    for (uint32_t i = 0; i < 3 * count; i++) {
        float along = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : 0.5f;
        float aside = 0.25f * (float)(i / 3) / (float)count;
        x[i][0] = along + aside;
        x[i][1] = along - aside;
        x[i][2] = i % 3 == 2 ? 1 : 0;
        triangles[i / 3][i % 3] = i;
    }
    bench_must(pccd_scene_create(client, NULL, &scene), "scene", client);
    bench_must(pccd_mesh_create(client, x, PCCD_FORMAT_F32, 3 * count,
                                (const uint32_t(*)[3])(const void *)triangles, count,
                                mesh, NULL),
               "mesh", client);
    bench_must(pccd_scene_add(client, scene, *mesh, &object), "add", client);
    free(x);
    free(triangles);
    return scene;
}

/* Nothing moves, but all of it is computed anew. */
static uint64_t begin_job(struct pccd_client *client, uint32_t scene)
{
    struct pccd_step_settings settings = PCCD_STEP_SETTINGS_INIT;
    settings.tuning = "still=anew";
    uint64_t step;
    bench_must(pccd_submit_still(client, scene, &settings, &step), "submit", client);
    return step;
}

static uint64_t finish_job(struct pccd_client *client, uint64_t step)
{
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    bench_must(pccd_wait(client, step, -1, &answer), "wait", client);
    bench_check(answer.total == 0, "busy", "triangles side by side touch");
    uint64_t step_ns = answer.times.step;
    pccd_answer_release(client, &answer);
    return step_ns;
}

/* So large that a step takes job_ns. */
static uint32_t job_scene(struct pccd_client *client, uint64_t job_ns)
{
    for (uint32_t count = 400;; count += count / 2) {
        uint32_t mesh;
        uint32_t scene = diagonal_scene(client, count, &mesh);
        finish_job(client, begin_job(client, scene));
        if (finish_job(client, begin_job(client, scene)) >= job_ns) {
            return scene;
        }
        bench_must(pccd_scene_destroy(client, scene), "scene", client);
        bench_must(pccd_mesh_destroy(client, mesh), "mesh", client);
    }
}

/* With a pause before each. */
static struct bench_summary ping_until(struct pccd_client *client, uint64_t end_ns,
                                       long pause_ns)
{
    struct bench_samples samples = {0};
    while (common_now_ns() < end_ns) {
        if (pause_ns > 0) {
            nanosleep(&(struct timespec){0, pause_ns}, NULL);
        }
        bench_add(&samples, bench_ping_us(client));
    }
    struct bench_summary summary = bench_summarise(&samples);
    bench_free(&samples);
    return summary;
}

struct load {
    struct pccd_client *worker;
    uint32_t scene;
    uint64_t job_ns;
    unsigned turns;
};

static void measure(const struct rows *rows, const struct load *load, long pause_ns,
                    struct pairs *p99, struct pairs *p50)
{
    for (unsigned turn = 0; turn <= load->turns; turn++) {
        uint64_t most_ns = load->job_ns * 9 / 10;
        struct bench_summary idle =
            ping_until(rows->blocking, common_now_ns() + most_ns, pause_ns);
        uint64_t step = begin_job(load->worker, load->scene);
        struct bench_summary busy =
            ping_until(rows->blocking, common_now_ns() + most_ns, pause_ns);
        finish_job(load->worker, step);
        if (turn > 0) {
            pairs_add(p99, busy.p99, idle.p99);
            pairs_add(p50, busy.p50, idle.p50);
        }
    }
}

void rows_busy(const struct rows *rows)
{
    uint64_t job_ns = rows->smoke ? JOB_NS / 100 : JOB_NS;
    struct load load = {.worker = bench_connect(0, pccd_url(rows->blocking)),
                        .job_ns = job_ns,
                        .turns = rows->smoke ? 2 : 4};
    load.scene = job_scene(load.worker, job_ns);
    struct pairs p99 = {0};
    struct pairs p50 = {0};
    struct pairs hasty_p99 = {0};
    struct pairs hasty_p50 = {0};
    measure(rows, &load, PAUSE_NS, &p99, &p50);
    measure(rows, &load, 0, &hasty_p99, &hasty_p50);
    pairs_print(&(struct pairs_row){"11", "ping p99 during a step of 1 s", "p99, idle",
                                    "us", PAIRS_AT_MOST, 2.0},
                &p99);
    pairs_print(&(struct pairs_row){"", "its p50", "p50, idle", "us", PAIRS_TOLD, 0},
                &p50);
    pairs_print(
        &(struct pairs_row){"", "p99 without a pause", "p99, idle", "us", PAIRS_TOLD, 0},
        &hasty_p99);
    pairs_print(&(struct pairs_row){"", "its p50", "p50, idle", "us", PAIRS_TOLD, 0},
                &hasty_p50);
    pccd_close(load.worker);
}
