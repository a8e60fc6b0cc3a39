/* bench/wide.c - the method `wide` beside what is asked of it.
 *
 * Room:     bench; engine headers.
 * Does:     keep a world for each way to compute a step: modes `all` and `first`, one
 *           thread and several, the best instruction set and AVX2, the method `paper`,
 *           and the pairs of plain swept boxes; each takes the scene's steps some times,
 *           the last time with warm caches is kept, then the next, every round in another
 *           order; check that the answers agree; print medians beside the targets, and
 *           medians of the ratios of a round. What is held against a target is the
 *           median of the turns at whose begin and end the threads had their cores to
 *           themselves.
 * Does not: ask other libraries for the pairs: bench/peers does.
 * Threads:  one; the engine uses as many as it is told. The team is placed as the
 *           daemon's is.
 * Source:   targets: the bounds of the method's issue; paper section 7, whose 56 and
 *           138 ms are averages over five steps between two recorded frames, on 8 cores.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "floor.h"
#include "kernel.h"
#include "place.h"
#include "quiet.h"
#include "report.h"
#include "resident.h"
#include "wide_sweep.h"
#include "workload.h"

#define WARM_ROUNDS  1u
#define ROUNDS_MAX   300u
#define ROUNDS_MIN   9u
#define SMOKE_ROUNDS 2u
#define SCENE_NS     30000000000u

/* A side's steps are taken so long in a turn before those that count, at least once: so
 * that caches and branches are those of the side, as they are from step to step. */
#define WARM_NS 8000000u

/* The targets were measured on a processor of this kind that read 506 GB/s from its first
 * cache: two vectors of 64 bytes a cycle, so this many cycles a nanosecond at least. */
#define ASKED_GHZ 3.95

enum way { WAY_STEP, WAY_PAPER, WAY_SWEEP };

enum side_name {
    ALL_ONE,
    ALL_AGAIN,
    ALL_MANY,
    ALL_AVX2,
    FIRST_ONE,
    FIRST_MANY,
    FIRST_AVX2,
    PAPER_ONE,
    SWEEP_ONE,
    SWEEP_MANY,
    SWEEP_AVX2,
    SIDES
};

/* Milliseconds of one thread at the best set and ASKED_GHZ; a fifth is the average over
 * five steps. */
enum target { TARGET_NONE, TARGET_ALL, TARGET_FIRST, TARGET_SWEEP, TARGETS };

static const struct {
    const char *what;
    enum way way;
    enum eng_mode mode;
    bool by_many;
    bool by_avx2;
    enum target target;
    enum side_name base; /* of the ratio */
} sides[SIDES] = {
    [ALL_ONE] = {"all", WAY_STEP, ENG_MODE_ALL, false, false, TARGET_ALL, ALL_ONE},
    [ALL_AGAIN] = {"all, again", WAY_STEP, ENG_MODE_ALL, false, false, TARGET_NONE,
                   ALL_ONE},
    [ALL_MANY] = {"all, threads", WAY_STEP, ENG_MODE_ALL, true, false, TARGET_NONE,
                  ALL_ONE},
    [ALL_AVX2] = {"all, avx2", WAY_STEP, ENG_MODE_ALL, false, true, TARGET_NONE, ALL_ONE},
    [FIRST_ONE] = {"first", WAY_STEP, ENG_MODE_FIRST, false, false, TARGET_FIRST,
                   ALL_ONE},
    [FIRST_MANY] = {"first, threads", WAY_STEP, ENG_MODE_FIRST, true, false, TARGET_NONE,
                    FIRST_ONE},
    [FIRST_AVX2] = {"first, avx2", WAY_STEP, ENG_MODE_FIRST, false, true, TARGET_NONE,
                    FIRST_ONE},
    [PAPER_ONE] = {"all, paper", WAY_PAPER, ENG_MODE_ALL, false, false, TARGET_NONE,
                   ALL_ONE},
    [SWEEP_ONE] = {"swept pairs", WAY_SWEEP, ENG_MODE_ANY, false, false, TARGET_SWEEP,
                   SWEEP_ONE},
    [SWEEP_MANY] = {"swept pairs, threads", WAY_SWEEP, ENG_MODE_ANY, true, false,
                    TARGET_NONE, SWEEP_ONE},
    [SWEEP_AVX2] = {"swept pairs, avx2", WAY_SWEEP, ENG_MODE_ANY, false, true,
                    TARGET_NONE, SWEEP_ONE},
};

static const struct asked {
    const char *scene;
    double ms[TARGETS];
    double paper_ms; /* what the paper took on 8 cores; 0: it does not say */
} asked[] = {
    {"cloth-ball", {0, 70, 25, 16}, 0},    {"cloth-ball-fifth", {0, 24, 15, 10}, 56},
    {"n-body", {0, 40, 25, 27}, 0},        {"n-body-fifth", {0, 22, 15, 12}, 138},
    {"cloth-funnel", {0, 2, 1.5, 1.5}, 0},
};

/* Ratios that are asked for, in every scene unless one is named: of the base's time. */
static const struct {
    enum side_name side;
    enum side_name to;
    double least;
    const char *scene;
} speeds[] = {
    {ALL_ONE, PAPER_ONE, 5, NULL},
    {ALL_MANY, ALL_ONE, 1.85, NULL},
    {FIRST_ONE, ALL_ONE, 3, "cloth-ball"},
};

/* Of a smoke run. */
static const char *const tiny[] = {"cloth-20k", "fast-sheet", "bodies", NULL};

static const char *const usual[] = {"cloth-ball",   "cloth-ball-fifth", "n-body",
                                    "n-body-fifth", "cloth-funnel",     NULL};

struct side {
    bool is_there; /* this processor has the set */
    struct bench_world world;
    struct eng_step_settings settings;
    struct eng_step_result result;
    struct eng_wide_sweep sweep;
    double round_ms;   /* a step of the round at hand */
    double round_cpu;  /* the same of the processors' time */
    uint64_t digest;   /* of all its answers */
    double toi_first;  /* the sum over its steps */
    double round_pace; /* the lesser of before and after the turn that was kept */
    struct bench_samples ms;
    struct bench_samples cpu;
    struct bench_samples pace;
};

struct run {
    const struct bench_scene *source;
    struct bench_frames frames;
    uint32_t threads;
    double ghz;
    double best_pace;
    struct side sides[SIDES];
};

/* Milliseconds of all threads of the program. */
static double cpu_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static void take_in(struct side *side, uint64_t value)
{
    side->digest = (side->digest ^ value) * 0x9e3779b97f4a7c15u;
}

static void sweep(struct run *run, enum side_name name)
{
    struct side *side = &run->sides[name];
    uint32_t threads = sides[name].by_many ? run->threads : 1;
    double begin = cpu_ms();
    int status = eng_wide_sweep(side->world.scene, threads, NULL, NULL, &side->sweep);
    side->round_cpu += cpu_ms() - begin;
    bench_check(status == ENG_OK, run->source->name, "no memory for the swept pairs");
    side->round_ms += 1e-6 * (double)(side->sweep.refit_ns + side->sweep.pairs_ns);
    take_in(side, side->sweep.vf);
    take_in(side, side->sweep.ee);
}

static void step(struct run *run, enum side_name name)
{
    struct side *side = &run->sides[name];
    const struct eng_step_result *result = &side->result;
    double begin = cpu_ms();
    bench_world_step(&side->world, &run->frames, &side->settings, &side->result);
    double end = cpu_ms();
    bench_check(result->incomplete == ENG_COMPLETE, run->source->name, "incomplete");
    if (sides[name].way == WAY_SWEEP) {
        sweep(run, name);
        return;
    }
    side->round_ms += 1e-6 * (double)result->times.step;
    side->round_cpu += end - begin;
    side->toi_first += result->toi_first;
    take_in(side, result->count);
    take_in(side, result->hash_hi);
    take_in(side, result->hash_lo);
}

/* In a turn: of a recorded scene all, of a long one the hard step. */
static uint32_t steps_of(const struct bench_scene *source)
{
    return source->hard_frame > 0 ? 1 : source->frame_count - 1;
}

static void take_steps(struct run *run, enum side_name name)
{
    struct side *side = &run->sides[name];
    side->round_ms = 0;
    side->round_cpu = 0;
    side->digest = 0;
    side->toi_first = 0;
    for (uint32_t i = 0; i < steps_of(run->source); i++) {
        bench_frames_seek(&run->frames, run->source->hard_frame + i);
        step(run, name);
    }
}

/* All steps of the scene until the side is warm, and once more. */
static void take_turn(struct run *run, enum side_name name)
{
    struct side *side = &run->sides[name];
    uint32_t steps = steps_of(run->source);
    uint32_t threads = sides[name].by_many ? run->threads : 1;
    uint64_t begin_ns = bench_now_ns();
    do {
        take_steps(run, name);
    } while (bench_now_ns() - begin_ns < WARM_NS);
    double before = bench_pace(threads);
    take_steps(run, name);
    double after = bench_pace(threads);
    side->round_pace = before < after ? before : after;
    side->round_ms /= steps;
    side->round_cpu /= steps;
}

/* Whatever they took, all must have found the same. */
static bool agree(const struct run *run)
{
    bool good = run->sides[ALL_ONE].toi_first == run->sides[FIRST_ONE].toi_first;
    for (int i = 0; i < SIDES; i++) {
        enum side_name like = sides[i].way == WAY_SWEEP         ? SWEEP_ONE
                              : sides[i].mode == ENG_MODE_FIRST ? FIRST_ONE
                                                                : ALL_ONE;
        good &=
            !run->sides[i].is_there || run->sides[i].digest == run->sides[like].digest;
    }
    return bench_check(good, run->source->name, "answers differ");
}

/* False: the answers differ. */
static bool take_round(struct run *run, uint32_t round)
{
    for (uint32_t i = 0; i < SIDES; i++) {
        enum side_name name = (enum side_name)((i + round) % SIDES);
        if (run->sides[name].is_there) {
            take_turn(run, name);
        }
    }
    return agree(run);
}

static void keep(struct run *run)
{
    for (int i = 0; i < SIDES; i++) {
        struct side *side = &run->sides[i];
        if (side->is_there) {
            bench_add(&side->ms, side->round_ms);
            bench_add(&side->cpu, side->round_cpu);
            bench_add(&side->pace, side->round_pace);
            run->best_pace =
                side->round_pace > run->best_pace ? side->round_pace : run->best_pace;
        }
    }
}

/* NULL: nothing is asked of the scene. */
static const struct asked *asked_of(const char *scene)
{
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        if (strcmp(asked[i].scene, scene) == 0) {
            return &asked[i];
        }
    }
    return NULL;
}

/* 0: none. */
static double asked_ms(const struct run *run, enum target target)
{
    const struct asked *of_scene = asked_of(run->source->name);
    return of_scene ? of_scene->ms[target] : 0;
}

/* At this processor's clock. */
static double target_ms(const struct run *run, enum target target)
{
    return asked_ms(run, target) * ASKED_GHZ / run->ghz;
}

static const char *verdict(const struct run *run, enum target target, double ms)
{
    return ms <= asked_ms(run, target)    ? "met"
           : ms <= target_ms(run, target) ? "missed, met at this clock"
                                          : "missed";
}

static double quiet_ms(const struct run *run, enum side_name side)
{
    return bench_quiet_median(&run->sides[side].ms, &run->sides[side].pace,
                              run->best_pace);
}

/* Times as fast as another side: the median over the rounds in which both were quiet. */
static double speed(const struct run *run, enum side_name side, enum side_name to)
{
    const struct side *one = &run->sides[side];
    const struct side *other = &run->sides[to];
    struct bench_samples ratio = {0};
    struct bench_samples pace = {0};
    for (size_t i = 0; i < one->ms.count; i++) {
        double a = one->pace.values[i];
        double b = other->pace.values[i];
        bench_add(&ratio, other->ms.values[i] / one->ms.values[i]);
        bench_add(&pace, a < b ? a : b);
    }
    double median = bench_quiet_median(&ratio, &pace, run->best_pace);
    bench_free(&ratio);
    bench_free(&pace);
    return median;
}

static void print_speeds(const struct run *run)
{
    const struct asked *of_scene = asked_of(run->source->name);
    if (!of_scene) {
        return;
    }
    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        if (!speeds[i].scene || strcmp(speeds[i].scene, of_scene->scene) == 0) {
            double times = speed(run, speeds[i].side, speeds[i].to);
            printf("  %-22s %8.2f times as fast as %s, asked %.2f: %s\n",
                   sides[speeds[i].side].what, times, sides[speeds[i].to].what,
                   speeds[i].least, times >= speeds[i].least ? "met" : "missed");
        }
    }
    if (of_scene->paper_ms > 0) {
        printf("  %-22s %8.3g ms; the paper's 8 cores took %.0f\n", sides[ALL_ONE].what,
               quiet_ms(run, ALL_ONE), of_scene->paper_ms);
    }
}

static void print_table(const struct run *run)
{
    printf("\n%s: %s, %u threads, %" PRIu64 " contacts, %zu rounds; %.2f GHz, targets of "
           "%.2f\n",
           run->source->name, eng_kernels()->name, run->threads,
           run->sides[ALL_ONE].result.count, run->sides[ALL_ONE].ms.count, run->ghz,
           ASKED_GHZ);
    printf("  %-22s %8s %8s %8s %8s %8s %8s %8s  %s\n", "ms a step", "median", "quiet",
           "least", "cpu", "asked", "at clock", "times", "as fast as");
    for (int i = 0; i < SIDES; i++) {
        const struct side *side = &run->sides[i];
        double asked_of_side = asked_ms(run, sides[i].target);
        if (!side->is_there) {
            continue;
        }
        struct bench_summary ms = bench_summarise(&side->ms);
        double quiet = quiet_ms(run, (enum side_name)i);
        printf("  %-22s %8.3g %8.3g %8.3g %8.3g", sides[i].what, ms.p50, quiet, ms.min,
               bench_summarise(&side->cpu).min);
        if (asked_of_side > 0) {
            printf(" %8.3g %8.3g", asked_of_side, target_ms(run, sides[i].target));
        } else {
            printf(" %8s %8s", "", "");
        }
        if ((int)sides[i].base != i) {
            printf(" %8.2f  %-12s", speed(run, (enum side_name)i, sides[i].base),
                   sides[sides[i].base].what);
        } else {
            printf(" %8s  %-12s", "", "");
        }
        if (asked_of_side > 0) {
            printf(" %s", verdict(run, sides[i].target, quiet));
        }
        putchar('\n');
    }
    print_speeds(run);
    fflush(stdout);
}

static void print_rows(const struct run *run)
{
    const char *scene = run->source->name;
    for (int i = 0; i < SIDES; i++) {
        const struct side *side = &run->sides[i];
        if (!side->is_there) {
            continue;
        }
        const uint64_t hash[2] = {side->result.hash_hi, side->result.hash_lo};
        bench_row(&(struct bench_row){.scene = scene,
                                      .what = sides[i].what,
                                      .unit = "ms",
                                      .samples = &side->ms,
                                      .base_name = sides[sides[i].base].what,
                                      .base = &run->sides[sides[i].base].ms,
                                      .threads = sides[i].by_many ? run->threads : 1,
                                      .hash = hash});
        char what[64];
        snprintf(what, sizeof what, "%s: quiet", sides[i].what);
        bench_number(scene, what, "ms", quiet_ms(run, (enum side_name)i));
        double asked_of_side = asked_ms(run, sides[i].target);
        if (asked_of_side > 0) {
            snprintf(what, sizeof what, "%s: asked", sides[i].what);
            bench_number(scene, what, "ms", asked_of_side);
            snprintf(what, sizeof what, "%s: at this clock", sides[i].what);
            bench_number(scene, what, "ms", target_ms(run, sides[i].target));
        }
    }
}

static void side_init(struct run *run, enum side_name name,
                      const struct eng_places *places)
{
    struct side *side = &run->sides[name];
    const struct eng_kernels *avx2 = eng_kernels_of(ENG_ISA_AVX2);
    side->is_there = !sides[name].by_avx2 || avx2;
    if (!side->is_there) {
        return;
    }
    bench_world_init(&side->world, &run->frames, NULL);
    side->settings = bench_step_settings(sides[name].mode);
    side->settings.method =
        sides[name].way == WAY_PAPER ? ENG_METHOD_PAPER : ENG_METHOD_WIDE;
    side->settings.threads = sides[name].by_many ? run->threads : 1;
    side->settings.kernels = sides[name].by_avx2 ? avx2 : eng_kernels();
    side->settings.places = places;
}

static void measure(const struct bench_scene *source, uint32_t threads,
                    const struct eng_places *places, const struct bench_options *options)
{
    static struct run run;
    uint64_t begin_ns = bench_now_ns();
    uint32_t least = WARM_ROUNDS + (options->smoke ? SMOKE_ROUNDS : ROUNDS_MIN);
    bool good = true;
    memset(&run, 0, sizeof run);
    run.source = source;
    run.threads = threads;
    bench_frames_init(&run.frames, source, source->hard_frame);
    for (int i = 0; i < SIDES; i++) {
        side_init(&run, (enum side_name)i, places);
    }
    for (uint32_t i = 0; i < WARM_ROUNDS + ROUNDS_MAX && good; i++) {
        if (i >= least && (options->smoke || bench_now_ns() - begin_ns > SCENE_NS)) {
            break;
        }
        double ghz = bench_clock_ghz();
        run.ghz = ghz > run.ghz ? ghz : run.ghz;
        good = take_round(&run, i);
        if (good && i >= WARM_ROUNDS) {
            keep(&run);
        }
    }
    if (good && options->json) {
        print_rows(&run);
    } else if (good) {
        print_table(&run);
    }
    for (int i = 0; i < SIDES; i++) {
        bench_free(&run.sides[i].ms);
        bench_free(&run.sides[i].cpu);
        bench_free(&run.sides[i].pace);
        if (run.sides[i].is_there) {
            bench_world_deinit(&run.sides[i].world);
        }
    }
    bench_frames_deinit(&run.frames);
}

int main(int argc, char **argv)
{
    struct bench_options options;
    struct eng_places places;
    int exit_status;
    bench_team_environment(argv);
    if (!bench_begin_with("wide", BENCH_TAKES_THREADS, argc, argv, &options,
                          &exit_status)) {
        return exit_status;
    }
    uint32_t threads = options.threads ? options.threads : 2;
    eng_places_init(&places);
    eng_places_warm_up(&places, threads);
    const char *const *names = options.smoke ? tiny : options.wanted ? NULL : usual;
    struct bench_scene scene;
    for (unsigned i = 0; bench_next_scene(&options, names, &i, &scene);) {
        measure(&scene, threads, &places, &options);
        bench_scene_free(&scene);
    }
    return bench_end();
}
