/* batch.c - steps of many small scenes: one batch beside as many single requests. */
#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "asker.h"
#include "farm.h"
#include "pccd.h"
#include "sections.h"

#define IN_FLIGHT 16u

/* Ways to take a turn of all scenes. */
enum way { ALONE, TOGETHER, SINGLE, FLOWING, WAYS };

static const char *const way_names[WAYS] = {
    [ALONE] = "batch, 1 thread",
    [TOGETHER] = "batch, 2 threads",
    [SINGLE] = "single requests, 1 thread",
    [FLOWING] = "single requests, 16 in flight",
};

/* Columns of a measurement: the sum of the step times of the single requests, and of the
 * batch by one thread; then for each way its time, and that of the daemon's threads. */
enum { SUM_SINGLE, SUM_BATCH, WALL, PROCESSOR = WALL + WAYS, SIDES = PROCESSOR + WAYS };

struct hash {
    uint64_t sum[2];
};

static void add_hash(struct hash *hash, const uint64_t more[2])
{
    hash->sum[0] += more[0];
    hash->sum[1] += more[1];
}

static double now_ms(void)
{
    return 1e-6 * (double)common_now_ns();
}

/* Processor time that the threads of a process have had: other programs that take the
 * processors away do not count. 0: not known. */
static double cpu_ms(uint32_t pid)
{
    char path[64];
    uint64_t sum_ns = 0;
    snprintf(path, sizeof path, "/proc/%" PRIu32 "/task", pid);
    DIR *tasks = opendir(path);
    for (struct dirent *task; tasks != NULL && (task = readdir(tasks)) != NULL;) {
        uint64_t ran_ns = 0;
        snprintf(path, sizeof path, "/proc/%" PRIu32 "/task/%.16s/schedstat", pid,
                 task->d_name);
        FILE *file = fopen(path, "r");
        if (file != NULL) {
            sum_ns += fscanf(file, "%" SCNu64, &ran_ns) == 1 ? ran_ns : 0;
            fclose(file);
        }
    }
    if (tasks != NULL) {
        closedir(tasks);
    }
    return 1e-6 * (double)sum_ns;
}

static void take_batch(struct test_farm *farm, const void *const *x1, uint32_t threads,
                       struct hash *hash, double *sum_ms)
{
    const struct pccd_step_settings settings = {.struct_bytes = sizeof settings,
                                                .threads = threads};
    struct pccd_batch_answer answer = PCCD_BATCH_ANSWER_INIT;
    bench_must(pccd_batch_step(farm->batch, NULL, x1, &settings, &answer), "batch",
               farm->client);
    bench_check(answer.failed == 0 && answer.incomplete == 0, "batch", "a scene failed");
    for (uint64_t i = 0; i < answer.count; i++) {
        add_hash(hash, answer.scenes[i].hash);
    }
    *sum_ms = 1e-6 * (double)answer.steps_ns;
    pccd_batch_release(farm->client, &answer);
}

static void take_answer(struct test_farm *farm, struct pccd_answer *answer,
                        struct hash *hash, double *sum_ms)
{
    add_hash(hash, answer->hash);
    *sum_ms += 1e-6 * (double)answer->times.step;
    pccd_answer_release(farm->client, answer);
}

static void take_single(struct test_farm *farm, const void *const *x1, uint32_t in_flight,
                        struct hash *hash, double *sum_ms)
{
    const struct pccd_step_settings settings = {.struct_bytes = sizeof settings,
                                                .threads = 1};
    uint64_t steps[IN_FLIGHT] = {0};
    struct pccd_answer answer = PCCD_ANSWER_INIT;
    *sum_ms = 0;
    for (uint32_t i = 0; i < farm->count + in_flight; i++) {
        uint64_t *step = &steps[i % in_flight];
        if (i >= in_flight) {
            bench_must(pccd_wait(farm->client, *step, -1, &answer), "step", farm->client);
            take_answer(farm, &answer, hash, sum_ms);
        }
        if (i < farm->count) {
            const struct pccd_motion motion = {
                .object = farm->worlds[i].body, .count = farm->vertex_count, .x1 = x1[i]};
            bench_must(pccd_submit(farm->client, farm->worlds[i].scene, &motion, 1,
                                   &settings, step),
                       "submit", farm->client);
        }
    }
}

/* One turn in each way; the first turns, in which trees are built, are not counted. */
static void take_turn(struct test_farm farms[WAYS], const void *const *x1, uint32_t turn,
                      uint32_t warm, struct bench_side sides[SIDES])
{
    struct hash hashes[WAYS] = {{{0}}};
    for (uint32_t k = 0; k < WAYS; k++) {
        enum way way = (enum way)((k + turn) % WAYS);
        double sum_ms = 0;
        uint32_t pid = pccd_daemon_pid(farms[way].client);
        double begin_cpu_ms = cpu_ms(pid);
        double begin_ms = now_ms();
        if (way == ALONE || way == TOGETHER) {
            take_batch(&farms[way], x1, way == ALONE ? 1 : 2, &hashes[way], &sum_ms);
        } else {
            take_single(&farms[way], x1, way == SINGLE ? 1 : IN_FLIGHT, &hashes[way],
                        &sum_ms);
        }
        double took_ms = now_ms() - begin_ms;
        if (turn > warm) {
            bench_add(&sides[WALL + way].samples, took_ms);
            bench_add(&sides[PROCESSOR + way].samples, cpu_ms(pid) - begin_cpu_ms);
            if (way == SINGLE) {
                bench_add(&sides[SUM_SINGLE].samples, sum_ms);
            } else if (way == ALONE) {
                bench_add(&sides[SUM_BATCH].samples, sum_ms);
            }
        }
    }
    for (uint32_t way = 1; way < WAYS; way++) {
        bench_check(memcmp(&hashes[way], &hashes[0], sizeof hashes[0]) == 0, "batch",
                    "the same steps have another answer");
    }
}

/* Time, then the daemon's processor time; first the sums of step times. */
static void report(const char *scene, struct bench_side sides[SIDES])
{
    for (unsigned i = 0; i < SIDES; i++) {
        struct bench_side *side = &sides[i];
        enum way way = (enum way)((i - WALL) % WAYS);
        side->unit = "ms";
        side->base_name = "sum";
        side->base = SUM_SINGLE;
        if (i < WALL) {
            continue;
        }
        snprintf(side->what, sizeof side->what, "%s%s", way_names[way],
                 i >= PROCESSOR ? ", processor" : "");
        side->threads = way == TOGETHER ? 2 : 1;
        if (i == WALL + TOGETHER) {
            side->base_name = "1 thread";
            side->base = WALL + ALONE;
        }
    }
    strcpy(sides[SUM_SINGLE].what, "sum of step times, single");
    sides[SUM_SINGLE].base_name = NULL;
    strcpy(sides[SUM_BATCH].what, "sum of step times, in a batch");
    sides[SUM_BATCH].base_name = "single";
    bench_sides_end(scene, sides, SIDES, true);
}

/* Each way has scenes of its own, in a session of its own, in one daemon. */
static void measure(const char *scene, uint32_t count, uint32_t side, uint32_t turns,
                    uint32_t warm)
{
    struct pccd_client *clients[WAYS]; /* handles, which are in the hashes, are alike */
    struct test_farm farms[WAYS];
    struct bench_side sides[SIDES] = {0};
    for (uint32_t way = 0; way < WAYS; way++) {
        struct pccd_options options;
        pccd_options_init(&options);
        options.private_daemon = way == 0;
        options.url = way == 0 ? NULL : pccd_url(clients[0]);
        options.slot_count = IN_FLIGHT;
        options.timeout_ms = 600000;
        bench_must(pccd_connect(&options, &clients[way]), "connect", NULL);
        bench_must(test_farm_make(clients[way], count, side, &farms[way]), "scenes",
                   clients[way]);
    }
    size_t bytes = farms[0].vertex_count * sizeof(float[3]);
    char *x = bench_alloc(count, bytes);
    const void **x1 = bench_alloc(count, sizeof *x1);
    for (uint32_t turn = 1; turn <= warm + turns; turn++) {
        for (uint32_t i = 0; i < count; i++) {
            test_farm_positions(&farms[0], i, turn, (float(*)[3])(void *)(x + i * bytes));
            x1[i] = x + i * bytes;
        }
        take_turn(farms, x1, turn, warm, sides);
    }
    report(scene, sides);
    for (uint32_t way = 0; way < WAYS; way++) {
        test_farm_free(&farms[WAYS - 1 - way]);
        pccd_close(clients[WAYS - 1 - way]); /* the daemon's own last */
    }
    free(x1);
    free(x);
}

int section_batch(const struct section_options *section)
{
    const struct bench_options *options = &section->bench;
    static const struct {
        const char *name;
        uint32_t count, side;
    } sizes[] = {{"1000 x 1058 triangles", 1000, 24}, /* 1000 or a few more */
                 {"1000 x 32 triangles", 1000, 5},
                 {"100 x 10082 triangles", 100, 72}};
    bench_heading("batches");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        if (bench_is_wanted(options, sizes[i].name)) {
            measure(options->smoke ? "tiny" : sizes[i].name,
                    options->smoke ? 20 : sizes[i].count,
                    options->smoke ? 3 : sizes[i].side, options->smoke ? 3 : 15,
                    options->smoke ? 1 : 5);
        }
    }
    return 0;
}
