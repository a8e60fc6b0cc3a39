/* bench/parallel.c - steps by several threads against the same steps by one.
 *
 * Room:     bench; engine headers.
 * Does:     keep two scenes, one stepped by one thread and one by several; both take the
 *           same step one after the other, the first by turns; check that the answers
 *           agree; print medians of the ratios of such pairs for each phase, and the
 *           phases' shares of a step.
 * Threads:  one; the engine uses as many as it is told. The team is placed as the
 *           daemon's is.
 * Source:   paper section 7.2, Figures 8 and 9.
 */
#include <stdio.h>
#include <string.h>

#include "place.h"
#include "report.h"
#include "resident.h"
#include "workload.h"

#define WARM_PAIRS  3u
#define PAIRS_MAX   60u
#define PAIRS_MIN   9u
#define SMOKE_PAIRS 2u
#define CONFIG_NS   10000000000u /* about as long for each configuration of a scene */

/* How the threads of a step work together. */
struct config {
    const char *name;
    enum eng_scheduler scheduler;
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
    bool is_noise; /* one thread against one thread: how far the machine disturbs */
};

static const struct config configs[] = {
    {"one again", ENG_SCHEDULER_STEAL, ENG_HIGH_ROUND_ROBIN, ENG_REFIT_EVEN, true},
    {"steal", ENG_SCHEDULER_STEAL, ENG_HIGH_ROUND_ROBIN, ENG_REFIT_EVEN, false},
    {"steal+refit2k", ENG_SCHEDULER_STEAL, ENG_HIGH_ROUND_ROBIN, ENG_REFIT_PAPER, false},
    {"paper", ENG_SCHEDULER_PAPER, ENG_HIGH_ROUND_ROBIN, ENG_REFIT_PAPER, false},
    {"paper+disjoint", ENG_SCHEDULER_PAPER, ENG_HIGH_DISJOINT, ENG_REFIT_PAPER, false},
};
#define CONFIGS (sizeof configs / sizeof configs[0])

/* Scenes that are measured when none is named: the paper's and the nearest to them. */
static const char *const usual[] = {
    "cloth-ball",   "cloth-ball-fifth", "cloth-funnel", "n-body",
    "n-body-fifth", "breaking",         "bodies",       NULL};

enum quantity {
    STEP_ONE,
    STEP,
    SPEED_STEP,
    SPEED_REFIT,
    SPEED_DETECTION,
    SPEED_LOW,
    SPEED_HIGH,
    SPEED_MERGE,
    SPEED_REST,
    WAITING,
    SHARE_REFIT,
    SHARE_HIGH,
    SHARE_LOW,
    SHARE_MERGE,
    SHARE_REST,
    QUANTITIES
};

static const struct {
    const char *what;
    const char *unit;
    const char *column; /* of the table */
} quantities[QUANTITIES] = {
    [STEP_ONE] = {"step, one thread", "ms", "one ms"},
    [STEP] = {"step", "ms", "ms"},
    [SPEED_STEP] = {"step", "times", "step"},
    [SPEED_REFIT] = {"refit", "times", "refit"},
    [SPEED_DETECTION] = {"low + high", "times", "l + h"},
    [SPEED_LOW] = {"low", "times", "low"},
    [SPEED_HIGH] = {"high", "times", "high"},
    [SPEED_MERGE] = {"merge", "times", "merge"},
    [SPEED_REST] = {"rest", "times", "rest"},
    [WAITING] = {"waiting", "%", "wait %"},
    [SHARE_REFIT] = {"share of refit", "%", "refit"},
    [SHARE_HIGH] = {"share of high", "%", "high"},
    [SHARE_LOW] = {"share of low", "%", "low"},
    [SHARE_MERGE] = {"share of merge", "%", "merge"},
    [SHARE_REST] = {"share of rest", "%", "rest"},
};

struct side {
    struct bench_world world;
    struct eng_step_settings settings;
    struct eng_step_result result;
};

struct run {
    const struct bench_scene *source;
    const struct config *config;
    struct bench_frames frames;
    struct side one;
    struct side many;
    struct bench_samples samples[QUANTITIES];
};

/* What is neither refit nor detection nor merge: copying positions in, preparation. */
static double rest_ns(const struct eng_step_times *times)
{
    uint64_t parts = times->refit + times->low + times->high + times->merge;
    return times->step > parts ? (double)(times->step - parts) : 0;
}

static void keep_ratio(struct run *run, enum quantity quantity, double one, double many)
{
    if (one > 0 && many > 0) {
        bench_add(&run->samples[quantity], one / many);
    }
}

static void keep_share(struct run *run, enum quantity quantity, double part)
{
    double step = (double)run->many.result.times.step;
    bench_add(&run->samples[quantity], 100 * part / step);
}

/* One thread does not tell low-level nodes from high-level ones, so the work of the high
 * ones is what the threads say they spent on them; the rest of what one thread does is
 * the work of the low ones. */
static void keep(struct run *run)
{
    const struct eng_step_times *one = &run->one.result.times;
    const struct eng_step_times *many = &run->many.result.times;
    double one_ns = (double)(one->low + one->high);
    double many_ns = (double)(many->low + many->high);
    double high_ns = 0;
    double waiting_ns = 0;
    for (uint32_t i = 0; i < run->many.result.threads; i++) {
        high_ns += (double)run->many.result.thread_records[i].high_ns;
        waiting_ns += (double)run->many.result.thread_records[i].wait_ns;
    }
    bench_add(&run->samples[STEP_ONE], 1e-6 * (double)one->step);
    bench_add(&run->samples[STEP], 1e-6 * (double)many->step);
    keep_ratio(run, SPEED_STEP, (double)one->step, (double)many->step);
    keep_ratio(run, SPEED_REFIT, (double)one->refit, (double)many->refit);
    keep_ratio(run, SPEED_DETECTION, one_ns, many_ns);
    keep_ratio(run, SPEED_LOW, one_ns - high_ns, (double)many->low);
    keep_ratio(run, SPEED_HIGH, high_ns, (double)many->high);
    keep_ratio(run, SPEED_MERGE, (double)one->merge, (double)many->merge);
    keep_ratio(run, SPEED_REST, rest_ns(one), rest_ns(many));
    keep_share(run, WAITING, waiting_ns / run->many.result.threads);
    keep_share(run, SHARE_REFIT, (double)many->refit);
    keep_share(run, SHARE_HIGH, (double)many->high);
    keep_share(run, SHARE_LOW, (double)many->low);
    keep_share(run, SHARE_MERGE, (double)many->merge);
    keep_share(run, SHARE_REST, rest_ns(many));
}

static void step(struct run *run, struct side *side)
{
    bench_world_step(&side->world, &run->frames, &side->settings, &side->result);
}

/* The same step on both sides. False: the answers differ. */
static bool take_pair(struct run *run, uint32_t number)
{
    struct side *first = number % 2 ? &run->many : &run->one;
    struct side *second = number % 2 ? &run->one : &run->many;
    step(run, first);
    step(run, second);
    const struct eng_step_result *one = &run->one.result;
    const struct eng_step_result *many = &run->many.result;
    return bench_check(one->incomplete == ENG_COMPLETE &&
                           many->incomplete == ENG_COMPLETE,
                       run->source->name, "incomplete") &&
           bench_check(one->count == many->count && one->hash_hi == many->hash_hi &&
                           one->hash_lo == many->hash_lo,
                       run->source->name, "one and several threads differ");
}

/* The heading of the table and what the paper says of the shares. */
static void print_heading(const char *name)
{
    printf("\n%s\n%-16s %2s %3s", name, "medians", "p", "n");
    for (int q = 0; q < QUANTITIES; q++) {
        printf("%s %8s", q == SPEED_STEP || q == WAITING ? " |" : "",
               quantities[q].column);
    }
    printf("\n%-23s %17s | %62s | %8s %8s %8s %8s %8s %8s\n", "", "",
           "times as fast as one thread", "", "7-13", "2-10", "80-90", "", "< 2");
}

static void print_line(const struct run *run)
{
    printf("%-16s %2u %3zu", run->config->name, run->many.result.threads,
           run->samples[STEP].count);
    for (int q = 0; q < QUANTITIES; q++) {
        const char *bar = q == SPEED_STEP || q == WAITING ? " |" : "";
        struct bench_summary summary = bench_summarise(&run->samples[q]);
        if (run->samples[q].count == 0) {
            printf("%s %8s", bar, "-");
        } else {
            printf("%s %8.*f", bar, q < SPEED_STEP || q >= WAITING ? 1 : 2, summary.p50);
        }
    }
    putchar('\n');
    fflush(stdout);
}

static void print_rows(const struct run *run)
{
    const uint64_t hash[2] = {run->many.result.hash_hi, run->many.result.hash_lo};
    for (int q = 0; q < QUANTITIES; q++) {
        char what[64];
        snprintf(what, sizeof what, "%s: %s", run->config->name, quantities[q].what);
        if (run->samples[q].count > 0) {
            bench_row(&(struct bench_row){.scene = run->source->name,
                                          .what = what,
                                          .unit = quantities[q].unit,
                                          .samples = &run->samples[q],
                                          .threads = run->many.result.threads,
                                          .hash = hash});
        }
    }
}

static void side_init(struct run *run, struct side *side, const struct config *config,
                      uint32_t threads, const struct eng_places *places)
{
    bench_world_init(&side->world, &run->frames, NULL);
    side->settings = bench_step_settings(ENG_MODE_ALL);
    side->settings.threads = threads;
    side->settings.scheduler = config->scheduler;
    side->settings.high_level = config->high_level;
    side->settings.refit = config->refit;
    side->settings.places = places;
}

static void measure(const struct bench_scene *source, const struct config *config,
                    uint32_t threads, const struct eng_places *places,
                    const struct bench_options *options)
{
    static struct run run; /* too large for a stack */
    uint64_t begin_ns = bench_now_ns();
    uint32_t least = WARM_PAIRS + (options->smoke ? SMOKE_PAIRS : PAIRS_MIN);
    bool good = true;
    memset(&run, 0, sizeof run);
    run.source = source;
    run.config = config;
    bench_frames_init(&run.frames, source, source->hard_frame);
    side_init(&run, &run.one, config, 1, places);
    side_init(&run, &run.many, config, threads, places);
    for (uint32_t i = 0; i < WARM_PAIRS + PAIRS_MAX && good; i++) {
        if (i >= least && (options->smoke || bench_now_ns() - begin_ns > CONFIG_NS)) {
            break;
        }
        bench_frames_seek(&run.frames, bench_hard_step(source, i));
        good = take_pair(&run, i);
        if (good && i >= WARM_PAIRS) {
            keep(&run);
        }
    }
    if (good && options->json) {
        print_rows(&run);
    } else if (good) {
        print_line(&run);
    }
    for (int q = 0; q < QUANTITIES; q++) {
        bench_free(&run.samples[q]);
    }
    bench_world_deinit(&run.one.world);
    bench_world_deinit(&run.many.world);
    bench_frames_deinit(&run.frames);
}

/* With 2, 4, 8 .. threads, and with as many as asked for. */
static void measure_all(const struct bench_scene *source, uint32_t threads_max,
                        const struct eng_places *places,
                        const struct bench_options *options)
{
    if (!options->json) {
        print_heading(source->name);
    }
    for (unsigned c = 0; c < CONFIGS; c++) {
        if (configs[c].is_noise) {
            measure(source, &configs[c], 1, places, options);
            continue;
        }
        for (uint32_t p = 2; p < threads_max; p *= 2) {
            measure(source, &configs[c], p, places, options);
        }
        measure(source, &configs[c], threads_max, places, options);
    }
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_places places;
    int exit_status;
    bench_team_environment(argv);
    if (!bench_begin_with("parallel", BENCH_TAKES_THREADS, argc, argv, &options,
                          &exit_status)) {
        return exit_status;
    }
    uint32_t threads = options.threads ? options.threads : 2;
    eng_places_init(&places);
    eng_places_warm_up(&places, threads);
    const char *const *names = options.wanted || options.smoke ? NULL : usual;
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options, names, &i, &scene);) {
        measure_all(&scene, threads, &places, &options);
        bench_scene_free(&scene);
    }
    return bench_end();
}
