/* bench/rebuild.c - what keeps a hierarchy good costs, and saves.
 *
 * Room:     bench; engine headers.
 * Does:     play scenes frame after frame in three ways: refit only; reconstruction where
 *           the hierarchy has become bad (the default); every hierarchy built anew before
 *           every step. Check that the answers agree; compare box tests and times of a
 *           step, and each step with its neighbours.
 * Threads:  one; the engine uses as many as it is told.
 * Source:   paper section 6.2; the spikes of section 7.1.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "build.h"
#include "place.h"
#include "report.h"
#include "resident.h"
#include "workload.h"
#include "world.h"

#define REPEATS    3u
#define PLAY_NS    100000000000u /* no further repeat of a scene after that */
#define NEIGHBOURS 5             /* of a step, before it and after it */

enum way { NEVER, LAZY, ALWAYS, WAYS };

static const char *const ways[WAYS] = {"refit only", "lazy", "every step"};

/* One step in one way. Of the repeats, the least times: the rest is always the same. */
struct record {
    double step_ms;    /* with building anew */
    double rebuild_ms; /* of it, or beside it by other threads */
    struct eng_step_counters counters;
    uint64_t contacts;
};

struct run {
    const struct bench_scene *source;
    struct bench_frames frames;
    struct bench_world worlds[WAYS];
    struct eng_step_settings settings;
    uint32_t steps;
    struct record (*records)[WAYS]; /* [steps] */
};

/* ---- playing -------------------------------------------------------------------- */

/* Every hierarchy anew, from where the scene stands. Returns how long it took. */
static uint64_t build_anew(struct eng_scene *scene)
{
    if (eng_plant_objects(scene) != ENG_OK) {
        exit(2);
    }
    uint64_t begin_ns = bench_now_ns();
    for (uint32_t i = 0; i < scene->object_capacity; i++) {
        if (scene->objects[i].mesh && eng_build_object(scene, i) != ENG_OK) {
            exit(2);
        }
    }
    scene->top_is_stale = true; /* the step builds it */
    return bench_now_ns() - begin_ns;
}

static void step(struct run *run, enum way way, struct record *record, bool is_first,
                 struct eng_step_result *result)
{
    struct bench_world *world = &run->worlds[way];
    uint64_t anew_ns = way == ALWAYS ? build_anew(world->scene) : 0;
    bench_world_step(world, &run->frames, &run->settings, result);
    double step_ms = 1e-6 * (double)(result->times.step + anew_ns);
    if (is_first || step_ms < record->step_ms) {
        record->step_ms = step_ms;
        record->rebuild_ms = 1e-6 * (double)(result->times.rebuild + anew_ns);
    }
    record->counters = result->counters;
    record->contacts = result->count;
}

static bool play_steps(struct run *run, bool is_first)
{
    const char *name = run->source->name;
    bool good = true;
    for (uint32_t from = 0; from < run->steps && good; from++) {
        struct eng_step_result results[WAYS];
        bench_frames_seek(&run->frames, from);
        for (unsigned i = 0; i < WAYS; i++) {
            enum way way = (enum way)((from + i) % WAYS);
            step(run, way, &run->records[from][way], is_first, &results[way]);
        }
        for (int way = 0; way < WAYS; way++) {
            good &= bench_check(results[way].incomplete == ENG_COMPLETE, name,
                                "incomplete") &&
                    bench_check(results[way].count == results[0].count &&
                                    results[way].hash_hi == results[0].hash_hi &&
                                    results[way].hash_lo == results[0].hash_lo,
                                name, "another hierarchy has another answer");
        }
    }
    return good;
}

static bool play_once(struct run *run, bool is_first)
{
    bench_frames_init(&run->frames, run->source, 0);
    for (int way = 0; way < WAYS; way++) {
        struct eng_scene_settings settings = ENG_SCENE_SETTINGS_DEFAULT;
        if (way != LAZY) {
            settings.rebuild_ratio = 0;
        }
        bench_world_init(&run->worlds[way], &run->frames, &settings);
    }
    bool good = play_steps(run, is_first);
    for (int way = 0; way < WAYS; way++) {
        bench_world_deinit(&run->worlds[way]);
    }
    bench_frames_deinit(&run->frames);
    return good;
}

/* ---- reporting ------------------------------------------------------------------ */

/* The median time of the steps around one. */
static double around_ms(const struct run *run, enum way way, uint32_t at)
{
    struct bench_samples around = {NULL, 0, 0};
    for (int64_t i = (int64_t)at - NEIGHBOURS; i <= (int64_t)at + NEIGHBOURS; i++) {
        if (i >= 0 && i < run->steps && i != at) {
            bench_add(&around, run->records[i][way].step_ms);
        }
    }
    double median = bench_summarise(&around).p50;
    bench_free(&around);
    return median;
}

enum column {
    TESTS,
    TESTS_MEDIAN,
    TESTS_MAX,
    TESTS_SUM,
    TIME,
    TIME_SUM,
    REBUILDING,
    REBUILDS,
    REBUILT,
    SWAPS,
    SWAPPED,
    SPIKE,
    SPIKE_AT,
    ADDED,
    COLUMNS
};

static const struct {
    const char *column; /* of the table */
    const char *what;
    const char *unit;
    int decimals;
} columns[COLUMNS] = {
    [TESTS] = {"tests", "box tests, median", "pairs", 0},
    [TESTS_MEDIAN] = {"median", "box tests to every step, median", "times", 2},
    [TESTS_MAX] = {"most", "box tests to every step, most", "times", 2},
    [TESTS_SUM] = {"sum", "box tests to every step, of sums", "times", 2},
    [TIME] = {"ms", "step, median", "ms", 1},
    [TIME_SUM] = {"sum", "step to every step, of sums", "times", 2},
    [REBUILDING] = {"anew %", "building, of the time", "%", 1},
    [REBUILDS] = {"rebuilds", "subtrees rebuilt", "", 0},
    [REBUILT] = {"triangles", "triangles rebuilt, a step", "", 0},
    [SWAPS] = {"swaps", "subtrees swapped", "", 0},
    [SWAPPED] = {"triangles", "triangles swapped, a step", "", 0},
    [SPIKE] = {"spike", "step to its neighbours, most", "times", 2},
    [SPIKE_AT] = {"at", "the step of it", "", 0},
    [ADDED] = {"added", "building to the neighbours' steps, most", "times", 2},
};

/* Steps `first` to `end` in one way, against hierarchies anew at every step. */
static void summarise(const struct run *run, enum way way, uint32_t first, uint32_t end,
                      double values[COLUMNS])
{
    struct bench_samples tests = {NULL, 0, 0};
    struct bench_samples ratio = {NULL, 0, 0};
    struct bench_samples time = {NULL, 0, 0};
    double tests_sum[2] = {0, 0};
    double time_sum[2] = {0, 0};
    memset(values, 0, COLUMNS * sizeof *values);
    for (uint32_t i = first; i < end; i++) {
        const struct record *record = &run->records[i][way];
        const struct record *base = &run->records[i][ALWAYS];
        double box_tests = (double)record->counters.box_tests;
        double base_tests = (double)base->counters.box_tests;
        bench_add(&tests, box_tests);
        bench_add(&ratio, base_tests > 0 ? box_tests / base_tests : 1);
        bench_add(&time, record->step_ms);
        tests_sum[0] += box_tests;
        tests_sum[1] += base_tests;
        time_sum[0] += record->step_ms;
        time_sum[1] += base->step_ms;
        values[REBUILDING] += record->rebuild_ms;
        values[REBUILDS] += (double)record->counters.rebuilds;
        values[REBUILT] += (double)record->counters.rebuilt_triangles / (end - first);
        values[SWAPS] += (double)record->counters.swaps;
        values[SWAPPED] += (double)record->counters.swapped_triangles / (end - first);
        double around = around_ms(run, way, i);
        if (record->step_ms > values[SPIKE] * around) {
            values[SPIKE] = record->step_ms / around;
            values[SPIKE_AT] = i;
        }
        if (record->rebuild_ms > values[ADDED] * around) {
            values[ADDED] = record->rebuild_ms / around;
        }
    }
    values[TESTS] = bench_summarise(&tests).p50;
    values[TESTS_MEDIAN] = bench_summarise(&ratio).p50;
    values[TESTS_MAX] = bench_summarise(&ratio).max;
    values[TESTS_SUM] = tests_sum[1] > 0 ? tests_sum[0] / tests_sum[1] : 1;
    values[TIME] = bench_summarise(&time).p50;
    values[TIME_SUM] = time_sum[0] / time_sum[1];
    values[REBUILDING] *= 100 / time_sum[0];
    bench_free(&tests);
    bench_free(&ratio);
    bench_free(&time);
}

static void report_part(const struct run *run, const char *part, uint32_t first,
                        uint32_t end, bool json)
{
    if (!json) {
        printf("\n%s, steps %u to %u, %u threads\n%-12s", part, first, end - 1,
               run->settings.threads, "");
        for (int c = 0; c < COLUMNS; c++) {
            printf(" %*s", c == TESTS ? 12 : 9, columns[c].column);
        }
        putchar('\n');
    }
    for (int way = 0; way < WAYS; way++) {
        double values[COLUMNS];
        summarise(run, (enum way)way, first, end, values);
        if (!json) {
            printf("%-12s", ways[way]);
        }
        for (int c = 0; c < COLUMNS; c++) {
            char what[64];
            if (!json) {
                printf(" %*.*f", c == TESTS ? 12 : 9, columns[c].decimals, values[c]);
                continue;
            }
            snprintf(what, sizeof what, "%s: %s", ways[way], columns[c].what);
            bench_number(part, what, columns[c].unit, values[c]);
        }
        if (!json) {
            putchar('\n');
        }
    }
    fflush(stdout);
}

/* Before the break there is hardly anything to rebuild: the parts are told apart. */
static void report(const struct run *run, bool json)
{
    uint32_t at = run->source->break_frame;
    if (at == 0) {
        report_part(run, run->source->name, 0, run->steps, json);
        return;
    }
    char part[64];
    snprintf(part, sizeof part, "%s, whole", run->source->name);
    report_part(run, part, 0, at, json);
    snprintf(part, sizeof part, "%s, in pieces", run->source->name);
    report_part(run, part, at, run->steps, json);
}

/* One line a step and way. */
static void write_csv(const struct run *run, FILE *csv)
{
    for (uint32_t i = 0; i < run->steps; i++) {
        for (int way = 0; way < WAYS; way++) {
            const struct record *record = &run->records[i][way];
            const struct eng_step_counters *counters = &record->counters;
            fprintf(
                csv, "%s,%u,%s,%u,%.6f,%.6f,%llu,%llu,%llu,%llu,%llu,%llu,%llu\n",
                run->source->name, i, ways[way], run->settings.threads, record->step_ms,
                record->rebuild_ms, (unsigned long long)counters->box_tests,
                (unsigned long long)(counters->candidates_vf + counters->candidates_ee),
                (unsigned long long)record->contacts,
                (unsigned long long)counters->rebuilds,
                (unsigned long long)counters->rebuilt_triangles,
                (unsigned long long)counters->swaps,
                (unsigned long long)counters->swapped_triangles);
        }
    }
    fflush(csv);
}

/* ---- scenes --------------------------------------------------------------------- */

static void measure(const struct bench_scene *source, const struct eng_places *places,
                    uint32_t threads, const struct bench_options *options, FILE *csv)
{
    struct run run;
    uint64_t begin_ns = bench_now_ns();
    memset(&run, 0, sizeof run);
    run.source = source;
    run.settings = bench_step_settings(ENG_MODE_ALL);
    run.settings.threads = threads;
    run.settings.places = places;
    run.steps = source->frame_count - 1;
    run.records = bench_alloc(run.steps, sizeof *run.records);
    bool good = play_once(&run, true);
    for (uint32_t i = 1; i < REPEATS && good && !options->smoke; i++) {
        if (bench_now_ns() - begin_ns < PLAY_NS) {
            good = play_once(&run, false);
        }
    }
    if (good) {
        report(&run, options->json);
    }
    if (good && csv) {
        write_csv(&run, csv);
    }
    free(run.records);
}

/* Sequences in which things change. */
static const char *const usual[] = {"exploding",        "breaking",     "bodies",
                                    "cloth-ball-fifth", "n-body-fifth", NULL};

static FILE *open_csv(const char *path)
{
    FILE *csv = fopen(path, "w");
    if (!csv) {
        perror(path);
        exit(2);
    }
    fprintf(csv, "scene,step,way,threads,step_ms,rebuild_ms,box_tests,candidates,"
                 "contacts,rebuilds,rebuilt_triangles,swaps,swapped_triangles\n");
    return csv;
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_places places;
    int exit_status;
    bench_team_environment(argv);
    if (!bench_begin_with("rebuild", BENCH_TAKES_THREADS | BENCH_TAKES_CSV, argc, argv,
                          &options, &exit_status)) {
        return exit_status;
    }
    uint32_t threads = options.threads ? options.threads : 1;
    FILE *csv = options.csv ? open_csv(options.csv) : NULL;
    eng_places_init(&places);
    eng_places_warm_up(&places, threads);
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options, usual, &i, &scene);) {
        measure(&scene, &places, threads, &options, csv);
        bench_scene_free(&scene);
    }
    if (csv) {
        fclose(csv);
    }
    return bench_end();
}
