/* bench/paper/sequence.c - the paper's scenes from their first frame to their last.
 *
 * Room:     bench/paper; engine headers.
 * Does:     step every frame in each way, by turns: the method paper with the paper's
 *           scheduler and refit, and the method wide, by 1, 2, 4, .. threads. Check that
 *           all answers agree; write what each step took, by parts, and print what a way
 *           takes of the whole sequence.
 * Threads:  one; the engine uses as many as it is told, placed as the daemon's are.
 * Source:   paper section 7: Table 1, Figures 1 and 6 to 9.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "place.h"
#include "report.h"
#include "resident.h"
#include "workload.h"

#define WARM_STEPS  3u /* times that the first step is taken before it counts */
#define WAYS_MAX    32u
#define SMOKE_STEPS 4u

struct way {
    enum eng_method method;
    uint32_t threads;
    char name[24];
    struct bench_samples step_ms;
};

struct run {
    const struct bench_scene *source;
    const struct eng_places *places;
    struct bench_frames frames;
    struct way ways[WAYS_MAX];
    struct bench_world worlds[WAYS_MAX];
    struct eng_step_result results[WAYS_MAX];
    uint32_t way_count;
    FILE *csv;
};

/* The scenes of Table 1, in its order. */
static const char *const paper_scenes[] = {"cloth", "breaking", "bodies", NULL};

static void add_ways(struct run *run, enum eng_method method, const char *name,
                     uint32_t threads)
{
    for (uint32_t p = 1; p <= threads && run->way_count < WAYS_MAX; p *= 2) {
        struct way *way = &run->ways[run->way_count++];
        way->method = method;
        way->threads = p;
        snprintf(way->name, sizeof way->name, "%s, %u", name, p);
    }
}

static void step(struct run *run, uint32_t index)
{
    const struct way *way = &run->ways[index];
    struct eng_step_settings settings = bench_step_settings(ENG_MODE_ALL);
    settings.method = way->method;
    settings.threads = way->threads;
    settings.places = run->places;
    if (way->method == ENG_METHOD_PAPER) {
        settings.scheduler = ENG_SCHEDULER_PAPER;
        settings.refit = ENG_REFIT_PAPER;
    }
    bench_world_step(&run->worlds[index], &run->frames, &settings, &run->results[index]);
}

static bool agree(const struct run *run)
{
    const struct eng_step_result *first = &run->results[0];
    bool good = true;
    for (uint32_t i = 0; i < run->way_count; i++) {
        const struct eng_step_result *result = &run->results[i];
        good &= bench_check(result->incomplete == ENG_COMPLETE, run->source->name,
                            "incomplete") &&
                bench_check(
                    result->count == first->count && result->hash_hi == first->hash_hi &&
                        result->hash_lo == first->hash_lo,
                    run->source->name, "two ways of a step have different answers");
    }
    return good;
}

/* ---- what is written ------------------------------------------------------------ */

static void write_heading(FILE *csv)
{
    fprintf(
        csv,
        "scene,triangles,step,method,threads,step_ms,ingest_ms,refit_ms,low_ms,high_ms,"
        "merge_ms,refit_work_ms,low_work_ms,high_work_ms,merge_work_ms,wait_ms,"
        "rebuild_ms,box_tests,candidates,contacts,rebuilds,swaps\n");
}

static double ms(uint64_t ns)
{
    return 1e-6 * (double)ns;
}

static void write_line(const struct run *run, uint32_t number, uint32_t index)
{
    const struct way *way = &run->ways[index];
    const struct eng_step_result *result = &run->results[index];
    const struct eng_step_times *times = &result->times;
    const struct eng_step_counters *counters = &result->counters;
    struct eng_thread_record sum = {0};
    for (uint32_t i = 0; i < result->threads; i++) {
        const struct eng_thread_record *one = &result->thread_records[i];
        sum.refit_ns += one->refit_ns;
        sum.low_ns += one->low_ns;
        sum.high_ns += one->high_ns;
        sum.merge_ns += one->merge_ns;
        sum.wait_ns += one->wait_ns;
    }
    fprintf(
        run->csv,
        "%s,%llu,%u,%s,%u,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,"
        "%llu,%llu,%llu,%llu,%llu\n",
        run->source->name, (unsigned long long)bench_scene_triangles(run->source), number,
        way->method == ENG_METHOD_PAPER ? "paper" : "wide", way->threads, ms(times->step),
        ms(times->ingest), ms(times->refit), ms(times->low), ms(times->high),
        ms(times->merge), ms(sum.refit_ns), ms(sum.low_ns), ms(sum.high_ns),
        ms(sum.merge_ns), ms(sum.wait_ns), ms(times->rebuild),
        (unsigned long long)counters->box_tests,
        (unsigned long long)(counters->candidates_vf + counters->candidates_ee),
        (unsigned long long)result->count, (unsigned long long)counters->rebuilds,
        (unsigned long long)counters->swaps);
}

/* ---- playing -------------------------------------------------------------------- */

static bool play_steps(struct run *run, uint32_t steps)
{
    for (uint32_t i = 0; i < WARM_STEPS * run->way_count; i++) {
        step(run, i % run->way_count);
    }
    for (uint32_t number = 0; number < steps; number++) {
        bench_frames_seek(&run->frames, number);
        for (uint32_t i = 0; i < run->way_count; i++) {
            step(run, (number + i) % run->way_count);
        }
        if (!agree(run)) {
            return false;
        }
        for (uint32_t i = 0; i < run->way_count; i++) {
            bench_add(&run->ways[i].step_ms, ms(run->results[i].times.step));
            if (run->csv) {
                write_line(run, number, i);
            }
        }
    }
    return true;
}

static void print(const struct run *run, uint64_t triangles)
{
    char text[80];
    snprintf(text, sizeof text, "%s, %llu triangles, %zu steps", run->source->name,
             (unsigned long long)triangles, run->ways[0].step_ms.count);
    bench_heading(text);
    for (uint32_t i = 0; i < run->way_count; i++) {
        const struct way *way = &run->ways[i];
        struct bench_row row = {.scene = run->source->name,
                                .what = way->name,
                                .unit = "ms",
                                .samples = &way->step_ms,
                                .base_name = run->ways[0].name,
                                .base = &run->ways[0].step_ms,
                                .threads = way->threads};
        bench_row(&row);
    }
}

static void play(const struct bench_scene *source, const struct eng_places *places,
                 uint32_t threads, bool smoke, FILE *csv)
{
    struct run *run = bench_alloc(1, sizeof *run);
    memset(run, 0, sizeof *run);
    run->source = source;
    run->places = places;
    run->csv = csv;
    add_ways(run, ENG_METHOD_PAPER, "paper", threads);
    add_ways(run, ENG_METHOD_WIDE, "wide", threads);
    bench_frames_init(&run->frames, source, 0);
    for (uint32_t i = 0; i < run->way_count; i++) {
        bench_world_init(&run->worlds[i], &run->frames, NULL);
    }
    uint32_t steps = source->frame_count - 1;
    if (play_steps(run, smoke && steps > SMOKE_STEPS ? SMOKE_STEPS : steps)) {
        print(run, bench_scene_triangles(source));
    }
    for (uint32_t i = 0; i < run->way_count; i++) {
        bench_free(&run->ways[i].step_ms);
        bench_world_deinit(&run->worlds[i]);
    }
    bench_frames_deinit(&run->frames);
    free(run);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_places places;
    int exit_status;
    bench_team_environment(argv);
    if (!bench_begin_with("sequence", BENCH_TAKES_THREADS | BENCH_TAKES_CSV, argc, argv,
                          &options, &exit_status)) {
        return exit_status;
    }
    uint32_t threads = options.threads ? options.threads : 2;
    FILE *csv = options.csv ? fopen(options.csv, "w") : NULL;
    if (options.csv && !csv) {
        perror(options.csv);
        return 2;
    }
    if (csv) {
        write_heading(csv);
    }
    eng_places_init(&places);
    eng_places_warm_up(&places, threads);
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options, paper_scenes, &i, &scene);) {
        play(&scene, &places, threads, options.smoke, csv);
        bench_scene_free(&scene);
    }
    if (csv && fclose(csv) != 0) {
        perror(options.csv);
        return 2;
    }
    return bench_end();
}
