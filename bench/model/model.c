/* model.c - how a step would scale on a machine with more processors (README.md). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"
#include "report.h"

#define TURNS  9 /* of measured steps */
#define PASSES 5 /* of recordings */

struct options {
    struct bench_options bench; /* with a name: part of a scene's, of `modelled` */
    bool has_sequences;         /* `sequences`, whose steps are the paper's as they are */
    bool is_wide_only;          /* not the method paper, which takes most of the time */
    const char *folder;         /* where the CSV files go */
    uint32_t validate;          /* threads that are measured beside one */
};

static const char *const modelled[] = {"cloth-ball", "breaking", "n-body", "cloth-funnel",
                                       NULL};
static const char *const tried[] = {"cloth-20k", NULL};
/* The sequences that tell the paper's scenes, frame by frame (bench/paper). */
static const char *const sequences[] = {"cloth", "breaking", "bodies", NULL};

static const struct scheme {
    const char *name, *high_level;
    enum eng_scheduler scheduler;
    enum pccd_method method;
} schemes[] = {{"paper", "round-robin", ENG_SCHEDULER_PAPER, PCCD_METHOD_PAPER},
               {"steal", "none", ENG_SCHEDULER_STEAL, PCCD_METHOD_PAPER},
               {"wide", "none", ENG_SCHEDULER_STEAL, PCCD_METHOD_WIDE}};
#define SCHEMES (sizeof schemes / sizeof schemes[0])

/* Wall time by phase; the five add up to `total`. Work is the sum over the threads. */
struct prediction {
    double total, refit, low, high, merge, serial; /* stealing: all is `low` */
    double refit_work, low_work, high_work, merge_work;
    double wait;     /* mean over the threads: time in the region without work */
    double critical; /* the longest chain of tasks that make each other */
    double largest;  /* task */
};

struct run {
    struct options options;
    struct model_costs costs;
    struct eng_affinity affinity;
    FILE *model;      /* CSV: predictions */
    FILE *validation; /* CSV: predictions beside measurements */
    char name[64];
    struct model_record record;
    struct model_way ways[MODEL_WAYS_MAX];
    uint32_t way_count;
    double alone; /* the step by one thread */
};

/* ---- the replay ------------------------------------------------------------------ */

/* One node at a time: one thread opens it, then its pairs are dealt out. */
static void replay_high(struct model_threads *threads,
                        const struct model_division *division)
{
    const struct model_task *tasks = division->tasks.items;
    for (uint32_t i = 0; i < division->high_count; i++) {
        const struct model_high *high = &division->high[i];
        model_work(threads, 0, tasks[high->expansion].ns);
        model_barrier(threads);
        for (uint32_t k = 0; k < high->pair_count; k++) {
            model_work(threads, k % threads->count, tasks[high->expansion + 1 + k].ns);
        }
        model_barrier(threads);
    }
}

static void predict(const struct run *run, const struct scheme *scheme,
                    const struct model_division *division, struct prediction *out)
{
    const struct model_record *record = &run->record;
    const struct model_costs *costs = &run->costs;
    bool is_paper = scheme->scheduler == ENG_SCHEDULER_PAPER;
    const struct model_tasks *tasks = is_paper ? &record->units : &record->steal;
    const uint32_t *roots = is_paper ? division->low : NULL;
    uint32_t root_count = is_paper ? division->low_count : record->root_count;
    struct model_threads threads = {.costs = costs, .count = division->threads};
    *out =
        (struct prediction){.high_work = is_paper ? model_tasks_sum(&division->tasks) : 0,
                            .merge_work = run->ways[0].measured.merge};
    double begin = costs->wake_each * (threads.count - 1);
    threads.now[0] = begin;
    for (uint32_t t = 1; t < threads.count; t++) { /* the team is woken one by one */
        threads.now[t] = costs->wake + costs->wake_each * (t - 1);
    }
    for (int stage = 0; stage < MODEL_STAGES; stage++) {
        const struct model_tasks *parts = &division->refit[stage];
        model_schedule(&threads, parts, NULL, parts->count, costs->barrier);
        model_barrier(&threads);
        out->refit_work += model_tasks_sum(parts);
    }
    double refitted = model_latest(&threads);
    /* Who was not asleep begins before others. */
    double first = threads.now[model_earliest(&threads)];
    /* In the paper's scheme a thread sleeps until another gives it a node. */
    model_schedule(&threads, tasks, roots, root_count,
                   is_paper ? costs->wake : costs->barrier);
    model_barrier(&threads);
    double low = model_latest(&threads);
    if (is_paper) {
        replay_high(&threads, division);
    }
    double detected = model_latest(&threads);
    for (uint32_t t = 0; t < threads.count; t++) {
        model_work(&threads, t, out->merge_work / threads.count);
    }
    for (int i = 0; i < 3; i++) { /* surveyed, divided, put in order */
        model_barrier(&threads);
    }
    double end = model_latest(&threads);
    out->serial = run->ways[0].measured.serial + begin;
    out->refit = refitted - begin;
    out->low = low - refitted;
    out->high = detected - low;
    out->merge = end - detected;
    out->total = end + run->ways[0].measured.serial;
    out->low_work = threads.busy - out->refit_work - out->high_work - out->merge_work;
    out->wait = end - threads.busy / threads.count;
    out->critical = model_tasks_chain(tasks, roots, root_count, &out->largest);
    bench_check(out->low_work <= model_tasks_sum(tasks) * (1 + 1e-6) &&
                    (is_paper || out->low_work >= model_tasks_sum(tasks) * (1 - 1e-6)),
                run->name, "every task is performed once");
    bench_check(end - begin >= threads.busy / threads.count, run->name,
                "no step is shorter than its work divided by its threads");
    bench_check(low - first >= out->critical, run->name,
                "no step is shorter than its longest chain");
}

/* ---- rows ------------------------------------------------------------------------ */

static void print(const struct run *run, const struct scheme *scheme, uint32_t threads,
                  const struct prediction *o)
{
    const double columns[] = {o->total,    o->refit,     o->low,        o->high,
                              o->merge,    o->serial,    o->wait,       o->refit_work,
                              o->low_work, o->high_work, o->merge_work, o->critical,
                              o->largest};
    double speedup = run->alone / o->total;
    fprintf(run->model, "%s,%s,%s,%u,%.3f", run->name, scheme->name, scheme->high_level,
            threads, speedup);
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        fprintf(run->model, ",%.4f", columns[i] * 1e-6);
    }
    fputc('\n', run->model);
    printf("%-16s %-6s %3u %9.3f ms %6.2fx\n", run->name, scheme->name, threads,
           o->total * 1e-6, speedup);
}

/* Beside what was measured here with as many threads. */
static void validate(const struct run *run, const struct scheme *scheme, uint32_t threads,
                     const struct prediction *output)
{
    for (uint32_t i = 0; i < run->way_count; i++) {
        const struct model_measured *m = &run->ways[i].measured;
        if (run->ways[i].threads == threads &&
            run->ways[i].scheduler == scheme->scheduler) {
            double error = output->total / m->step - 1;
            double speedup = run->alone / output->total;
            fprintf(run->validation, "%s,%s,%u,%.4f,%.4f,%.4f,%.3f,%.3f\n", run->name,
                    scheme->name, threads, m->step * 1e-6, output->total * 1e-6, error,
                    1 / m->ratio, speedup);
            printf("%-16s %-6s %3u measured %.3f ms, %+.1f %%; speed-up %.2f\n",
                   run->name, scheme->name, threads, m->step * 1e-6, 100 * error,
                   1 / m->ratio);
        }
    }
}

static void replay(struct run *run)
{
    static struct model_division division;
    struct model_record *record = &run->record;
    const struct model_measured *one = &run->ways[0].measured;
    /* All parts add up to the fastest step by one thread, whatever caches and the clock
     * did while each task was timed: the one-thread row is no prediction. */
    double scale = one->detection / model_tasks_sum(&record->steal);
    model_tasks_scale(&record->steal, scale);
    model_tasks_scale(&record->units, scale);
    for (uint32_t count = 1; count <= MODEL_THREADS_MAX; count *= 2) {
        model_division_init(&division, record, count);
        double refit = 0;
        for (int stage = 0; stage < MODEL_STAGES; stage++) {
            refit += model_tasks_sum(&division.refit[stage]);
        }
        for (int stage = 0; stage < MODEL_STAGES; stage++) {
            model_tasks_scale(&division.refit[stage], one->refit / refit);
        }
        model_tasks_scale(&division.tasks, scale);
        bench_check(division.is_consistent, run->name, "every pass meets the same pairs");
        for (size_t s = 0; s < SCHEMES; s++) {
            struct prediction prediction;
            if (schemes[s].method == record->method) {
                predict(run, &schemes[s], &division, &prediction);
                run->alone = count == 1 ? prediction.total : run->alone;
                print(run, &schemes[s], count, &prediction);
                validate(run, &schemes[s], count, &prediction);
            }
        }
        model_division_free(&division);
        fflush(stdout);
    }
}

/* ---- scenes ---------------------------------------------------------------------- */

static void model_method(struct run *run, const struct bench_frames *frames,
                         enum pccd_method method)
{
    const struct options *options = &run->options;
    struct bench_world world;
    run->way_count = 0;
    run->ways[run->way_count++] = (struct model_way){
        .threads = 1, .scheduler = ENG_SCHEDULER_STEAL, .method = method};
    for (size_t s = 0; s < SCHEMES; s++) {
        if (schemes[s].method == method) {
            run->ways[run->way_count++] =
                (struct model_way){.threads = options->validate,
                                   .scheduler = schemes[s].scheduler,
                                   .method = method};
        }
    }
    bench_world_init(&world, frames, NULL);
    bench_check(model_measure(frames, &world, &run->affinity, run->ways, run->way_count,
                              options->bench.smoke ? 3 : TURNS),
                run->name, "all ways give the same answer");
    run->record = (struct model_record){.scene = world.scene,
                                        .method = method,
                                        .passes = options->bench.smoke ? 3 : PASSES,
                                        .clock_ns = run->costs.clock};
    model_record_init(&run->record);
    bench_check(run->record.is_consistent, run->name, "every pass meets the same tasks");
    replay(run);
    model_record_free(&run->record);
    bench_world_deinit(&world);
}

/* The first fifth of the way to the next frame: the paper ran five steps a frame. */
static void take_fifth(struct bench_frames *frames)
{
    for (uint32_t v = 0; v < frames->scene->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            double *x1 = &frames->x[1][v][k];
            double x0 = frames->x[0][v][k];
            *x1 = x0 + (*x1 - x0) / 5;
        }
    }
}

static void model_scene(struct run *run, const struct bench_scene *scene, bool is_fifth)
{
    struct bench_frames frames;
    snprintf(run->name, sizeof run->name, "%s%s", scene->name, is_fifth ? "/5" : "");
    bench_frames_init(&frames, scene, scene->hard_frame);
    if (is_fifth) {
        take_fifth(&frames);
    }
    model_method(run, &frames, PCCD_METHOD_WIDE);
    if (!run->options.is_wide_only) {
        model_method(run, &frames, PCCD_METHOD_PAPER);
    }
    bench_frames_deinit(&frames);
}

static void model_all(struct run *run)
{
    const struct options *options = &run->options;
    const char *const *names = options->bench.smoke     ? tried
                               : options->has_sequences ? sequences
                                                        : modelled;
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options->bench, names, &i, &scene);) {
        model_scene(run, &scene, false);
        if (names == modelled) {
            model_scene(run, &scene, true);
        }
        bench_scene_free(&scene);
    }
}

/* ---- options --------------------------------------------------------------------- */

static const struct option_row option_rows[] = {
    {"sequences", 'q', NULL, "the sequences that tell the paper's scenes", OPTION_FLAG,
     .at = offsetof(struct options, has_sequences)},
    {"wide", 'w', NULL, "only the method wide: seconds", OPTION_FLAG,
     .at = offsetof(struct options, is_wide_only)},
    {"into", 'i', "FOLDER", "where the CSV files go (default: .)", OPTION_TEXT,
     .at = offsetof(struct options, folder)},
    {"validate-threads", 'v', "N", "threads of the steps to compare with (default 2)",
     OPTION_U32, .at = offsetof(struct options, validate), .min = 2,
     .max = MODEL_THREADS_MAX},
    {0}};

int main(int argc, char **argv)
{
    static struct run run;
    bench_team_environment(argv);
    run.options = (struct options){.folder = ".", .validate = 2};
    bench_begin("model", option_rows, argc, argv, &run.options.bench);
    eng_affinity_init(&run.affinity);
    model_costs_measure(&run.costs, &run.affinity);
    model_costs_print(&run.costs, stdout);
    FILE *costs = bench_create(run.options.folder, "machine.csv");
    model_costs_print(&run.costs, costs);
    fclose(costs);
    run.model = bench_create(run.options.folder, "model.csv");
    run.validation = bench_create(run.options.folder, "validation.csv");
    fprintf(run.model,
            "scene,scheduler,high_level,p,speedup,ms,refit_ms,low_ms,high_ms,merge_ms,"
            "serial_ms,wait_ms,refit_work_ms,low_work_ms,high_work_ms,merge_work_ms,"
            "critical_ms,largest_ms\n");
    fprintf(run.validation, "scene,scheduler,p,measured_ms,predicted_ms,error,"
                            "measured_speedup,predicted_speedup\n");
    model_all(&run);
    fclose(run.model);
    fclose(run.validation);
    return bench_end();
}
