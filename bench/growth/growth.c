/* growth.c - time and memory against the size of a scene, and its contacts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "affinity.h"
#include "families.h"
#include "memory.h"
#include "report.h"
#include "resident.h"
#include "step_memory.h"

#define LAYERS       8u
#define HALF_DECADES 8   /* 10^3 .. 10^7 triangles */
#define PAPER_MOST   4e5 /* triangles, for the method paper */
#define REGISTERED   2u  /* times, for the least */
#define WARM_UP      2u
#define STEPS        5u
#define NEAR         0.05 /* of a square's side: what is nearer than that is asked for */
#define CROSSING     361u /* vertices on a side: 518 400 triangles in two sheets */

struct options {
    struct bench_options bench;
    const char *into;
    uint32_t threads;
    double only; /* triangles: this size alone, nothing of contacts; 0: all */
};

/* Time and memory of one scene; times are the least of its steps, in ms. */
struct growth {
    double triangles;
    double register_ms;
    double register_kernel_ms; /* of that: pages that the kernel clears, above all */
    double step_ms, refit_ms, traversal_ms, tests_ms, merge_ms;
    double box_tests, candidates, contacts;
    /* Bytes that the engine holds: after the scene was made, after its steps; of these,
     * what the steps leave for the next, records above all. What the process has grown
     * by. */
    double registered_bytes, scene_bytes, records_bytes, process_bytes;
    /* The closest features of what is near at new positions: time; how many; what the
     * engine holds for that beside all the above. */
    double near_ms, near_features, near_bytes;
};

static double process_bytes(void)
{
    unsigned long pages[2] = {0, 0};
    FILE *file = fopen("/proc/self/statm", "r");
    bench_need(file && fscanf(file, "%lu %lu", &pages[0], &pages[1]) == 2,
               "/proc/self/statm");
    fclose(file);
    return (double)pages[1] * (double)sysconf(_SC_PAGESIZE);
}

/* Return the time that the kernel has spent for this process. */
static double kernel_ms(void)
{
    struct rusage usage;
    bench_need(getrusage(RUSAGE_SELF, &usage) == 0, "getrusage");
    return 1e3 * (double)usage.ru_stime.tv_sec + 1e-3 * (double)usage.ru_stime.tv_usec;
}

static void keep_least(double *least, uint64_t ns)
{
    double ms = (double)ns * 1e-6;
    *least = *least > 0 && *least < ms ? *least : ms;
}

static void keep_step(struct growth *growth, const struct eng_step_result *result)
{
    const struct pccd_step_times *times = &result->times;
    const struct pccd_step_counters *counters = &result->counters;
    keep_least(&growth->step_ms, times->step);
    keep_least(&growth->refit_ms, times->refit);
    keep_least(&growth->traversal_ms, times->traversal);
    keep_least(&growth->tests_ms, times->tests);
    keep_least(&growth->merge_ms, times->merge);
    growth->box_tests = (double)counters->box_tests;
    growth->candidates =
        (double)(counters->candidates[PCCD_VF] + counters->candidates[PCCD_EE]);
    growth->contacts = (double)result->count;
}

/* The scene goes to and fro between two frames. */
static void measure_near(struct growth *growth, struct bench_world *world,
                         const struct bench_frames *frames,
                         const struct eng_question *step, uint32_t turns)
{
    struct eng_question settings = *step;
    settings.verb = PCCD_NEAR_FEATURES;
    settings.distance = NEAR;
    settings.end = 1;
    struct eng_step_result near;
    struct eng_step_result result;
    double bytes_before = (double)eng_alloc_bytes();
    for (uint32_t i = 0; i < turns; i++) {
        uint64_t begin_ns = common_now_ns();
        bench_world_near(world, frames, true, &settings, &near);
        if (i > 0 || turns == 1) {
            keep_least(&growth->near_ms, common_now_ns() - begin_ns);
        }
        bench_check(near.incomplete == PCCD_COMPLETE, frames->scene->name, "incomplete");
        if (i + 1 < turns) {
            bench_world_step(world, frames, step, &result);
        }
    }
    growth->near_features = (double)near.count;
    growth->near_bytes = (double)eng_alloc_bytes() - bytes_before;
}

static struct growth measure(const struct bench_scene *scene, enum pccd_method method,
                             const struct options *options)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    struct growth growth = {.triangles = (double)bench_scene_triangles(scene)};
    struct eng_affinity affinity;
    struct eng_step_result result;
    struct bench_frames frames;
    struct bench_world world;
    uint32_t steps = options->bench.smoke ? 2 : STEPS;
    settings.method = method;
    settings.threads = options->threads;
    settings.affinity = &affinity;
    eng_affinity_init(&affinity);
    bench_frames_init(&frames, scene, 0);
    double process_before = process_bytes();
    double bytes_before = (double)eng_alloc_bytes();
    for (uint32_t i = 0; i < REGISTERED; i++) {
        if (i > 0) {
            bench_world_deinit(&world);
        }
        uint64_t begin_ns = common_now_ns();
        double begin_kernel = kernel_ms();
        bench_world_init(&world, &frames, NULL);
        double ms = 1e-6 * (double)(common_now_ns() - begin_ns);
        if (i == 0 || ms < growth.register_ms) {
            growth.register_ms = ms;
            growth.register_kernel_ms = kernel_ms() - begin_kernel;
        }
    }
    growth.registered_bytes = (double)eng_alloc_bytes() - bytes_before;
    for (uint32_t i = 0; i < WARM_UP + steps; i++) {
        bench_frames_seek(&frames, i);
        bench_world_step(&world, &frames, &settings, &result);
        bench_check(result.incomplete == PCCD_COMPLETE, scene->name, "incomplete");
        if (i >= WARM_UP) {
            keep_step(&growth, &result);
        }
    }
    growth.records_bytes = (double)eng_step_memory_bytes(world.scene);
    growth.scene_bytes = (double)eng_alloc_bytes() - bytes_before - growth.records_bytes;
    growth.process_bytes = process_bytes() - process_before;
    measure_near(&growth, &world, &frames, &settings, steps);
    bench_world_deinit(&world);
    bench_frames_deinit(&frames);
    return growth;
}

/* ---- output ------------------------------------------------------------------------ */

static FILE *begin(const struct options *options, const char *name)
{
    FILE *csv = bench_create(options->into, name);
    fputs("method,threads,triangles,contacts,candidates,box_tests,register_ms,"
          "register_kernel_ms,step_ms,refit_ms,traversal_ms,tests_ms,merge_ms,"
          "registered_bytes,scene_bytes,records_bytes,process_bytes,near_ms,"
          "near_features,near_bytes\n",
          csv);
    return csv;
}

static void write_row(FILE *csv, const char *method, const struct growth *growth,
                      const struct options *options)
{
    const struct growth *g = growth;
    fprintf(csv,
            "%s,%u,%.0f,%.0f,%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.0f,%.0f,%.0f,"
            "%.0f,%.4f,%.0f,%.0f\n",
            method, options->threads, g->triangles, g->contacts, g->candidates,
            g->box_tests, g->register_ms, g->register_kernel_ms, g->step_ms, g->refit_ms,
            g->traversal_ms, g->tests_ms, g->merge_ms, g->registered_bytes,
            g->scene_bytes, g->records_bytes, g->process_bytes, g->near_ms,
            g->near_features, g->near_bytes);
    fflush(csv);
    printf("%-6s %9.0f triangles %8.0f contacts: register %9.2f ms, step %9.3f ms; "
           "bytes a triangle: %4.0f registered, %4.0f resident, and %4.0f of answers; "
           "%8.0f features near: %9.3f ms, %4.0f bytes a triangle\n",
           method, g->triangles, g->contacts, g->register_ms, g->step_ms,
           g->registered_bytes / g->triangles, g->scene_bytes / g->triangles,
           g->records_bytes / g->triangles, g->near_features, g->near_ms,
           g->near_bytes / g->triangles);
    fflush(stdout);
}

/* ---- sizes ------------------------------------------------------------------------- */

static void grow_size(const struct options *options)
{
    FILE *csv = begin(options, "size.csv");
    for (int i = 0; i <= (options->bench.smoke ? 2 : HALF_DECADES); i++) {
        double triangles = options->only > 0 ? options->only : 1000 * pow(10, 0.5 * i);
        struct bench_scene scene;
        memset(&scene, 0, sizeof scene);
        scene.name = "layers";
        bench_make_layers(&scene, LAYERS,
                          (uint32_t)(sqrt(triangles / (2 * LAYERS)) + 1.5));
        struct growth growth = measure(&scene, PCCD_METHOD_WIDE, options);
        write_row(csv, "wide", &growth, options);
        if (triangles < PAPER_MOST) {
            growth = measure(&scene, PCCD_METHOD_PAPER, options);
            write_row(csv, "paper", &growth, options);
        }
        bench_scene_free(&scene);
        if (options->only > 0) {
            break;
        }
    }
    bench_need(fclose(csv) == 0, "a CSV file");
}

/* ---- contacts ---------------------------------------------------------------------- */

static void grow_contacts(const struct options *options)
{
    uint32_t side = options->bench.smoke ? 13 : CROSSING;
    uint32_t all = side * side;
    FILE *csv = begin(options, "contacts.csv");
    for (int i = -1; i <= 20; i++) {
        /* None; then of all vertices a share that grows by half a decade each time. */
        double share = i < 0 ? 0 : pow(10, 0.5 * (i - 10));
        uint32_t crossing = (uint32_t)(share * all);
        if ((i >= 0 && crossing == 0) || share > 1) {
            continue;
        }
        struct bench_scene scene;
        memset(&scene, 0, sizeof scene);
        scene.name = "crossing";
        bench_make_crossing(&scene, side, crossing);
        struct growth growth = measure(&scene, PCCD_METHOD_WIDE, options);
        write_row(csv, "wide", &growth, options);
        bench_scene_free(&scene);
    }
    bench_need(fclose(csv) == 0, "a CSV file");
}

/* ---- options ----------------------------------------------------------------------- */

static const struct option_row option_rows[] = {
    {"into", 'i', "FOLDER", "where size.csv and contacts.csv go (default: .)",
     OPTION_TEXT, .at = offsetof(struct options, into)},
    {"threads", 't', "N", "at most N threads a step (default: 1)", OPTION_U32,
     .at = offsetof(struct options, threads), .min = 1, .max = 256},
    {"triangles", 'n', "N", "this size alone, for a profiler", OPTION_REAL,
     .at = offsetof(struct options, only), .min = 1000, .max = 2e7},
    {0}};

int main(int argc, char **argv)
{
    struct options options = {.into = ".", .threads = 1};
    bench_team_environment(argv);
    bench_begin("growth", option_rows, argc, argv, &options.bench);
    grow_size(&options);
    if (options.only <= 0) {
        grow_contacts(&options);
    }
    return bench_end();
}
