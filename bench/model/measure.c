/* measure.c - what it costs here that threads meet, and real steps. */
#include "model.h"

#include <omp.h>
#include <string.h>
#include <time.h>

#include "clock.h"
#include "deque.h"
#include "parallel.h"
#include "report.h"

#define REPEATS  101
#define LOOPS    1000
#define SLEEPERS 8

static double per(uint64_t begin_ns, uint32_t count)
{
    return (double)(common_now_ns() - begin_ns) / count;
}

/* ---- alone ----------------------------------------------------------------------- */

static void measure_alone(struct model_costs *costs)
{
    static struct eng_deque deque;
    struct bench_samples clock = {0};
    struct bench_samples take = {0};
    eng_deque_init(&deque);
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        uint64_t task;
        uint64_t begin_ns = common_now_ns();
        for (uint32_t i = 0; i < LOOPS; i++) {
            (void)common_now_ns();
        }
        bench_add(&clock, per(begin_ns, LOOPS));
        begin_ns = common_now_ns();
        for (uint32_t i = 0; i < LOOPS; i++) {
            eng_deque_push(&deque, i);
            eng_deque_pop(&deque, &task);
        }
        bench_add(&take, per(begin_ns, LOOPS));
    }
    costs->clock = bench_take_median(&clock);
    costs->take = bench_take_median(&take);
}

/* ---- the team -------------------------------------------------------------------- */

/* Start a region of sleepers: the starter's time, and when the second thread runs. */
static double start_region(int threads, double *second)
{
    uint64_t second_ns = 0;
    uint64_t starter_ns = 0;
    nanosleep(&(struct timespec){0, 1000000}, NULL); /* the team falls asleep */
    uint64_t begin_ns = common_now_ns();
#pragma omp parallel num_threads(threads)
    {
        if (omp_get_thread_num() == 0) {
            starter_ns = common_now_ns();
        } else if (omp_get_thread_num() == 1) {
            second_ns = common_now_ns();
        }
    }
    *second = second_ns > begin_ns ? (double)(second_ns - begin_ns) : 0;
    return (double)(starter_ns - begin_ns);
}

static double time_barrier(void)
{
    double ns = 0;
#pragma omp parallel num_threads(2)
    {
#pragma omp barrier
        uint64_t begin_ns = common_now_ns();
        for (int i = 0; i < LOOPS; i++) {
#pragma omp barrier
        }
        if (omp_get_thread_num() == 0) {
            ns = per(begin_ns, LOOPS);
        }
    }
    return ns;
}

static void measure_team(struct model_costs *costs)
{
    struct bench_samples barrier = {0};
    struct bench_samples wake = {0};
    struct bench_samples two = {0};
    struct bench_samples many = {0};
    double second;
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        bench_add(&two, start_region(2, &second));
        bench_add(&wake, second);
        bench_add(&barrier, time_barrier());
    }
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        bench_add(&many, start_region(SLEEPERS + 2, &second));
    }
    costs->barrier = bench_take_median(&barrier);
    costs->wake = bench_take_median(&wake);
    /* Minima: those that were woken compete with the starter for the processors. */
    double each = (bench_summarise(&many).min - bench_summarise(&two).min) / SLEEPERS;
    costs->wake_each = each > 0 ? each : 0;
    bench_free(&two);
    bench_free(&many);
}

void model_costs_measure(struct model_costs *costs, const struct eng_affinity *affinity)
{
    eng_affinity_warm_up(affinity, 2);
    measure_alone(costs);
    measure_team(costs);
}

void model_costs_print(const struct model_costs *costs, FILE *out)
{
    fprintf(out,
            "cost,ns\nreading of the clock,%.1f\ntask of one's own,%.1f\n"
            "barrier of two,%.1f\nregion to second thread,%.1f\n"
            "each thread that is woken,%.1f\n",
            costs->clock, costs->take, costs->barrier, costs->wake, costs->wake_each);
}

/* ---- steps ----------------------------------------------------------------------- */

enum { STEP, RATIO, SERIAL, REFIT, DETECTION, MERGE, QUANTITIES };

static struct eng_step_result step(struct bench_world *world,
                                   const struct bench_frames *frames,
                                   const struct eng_affinity *affinity,
                                   const struct model_way *way)
{
    struct eng_question settings = bench_step_settings(PCCD_MODE_ALL);
    struct eng_step_result result;
    settings.method = way->method;
    settings.threads = way->threads;
    settings.team_always = true;
    settings.tuning.scheduler = way->scheduler;
    settings.affinity = affinity;
    bench_world_step(world, frames, &settings, &result);
    return result;
}

bool model_measure(const struct bench_frames *frames, struct bench_world *world,
                   const struct eng_affinity *affinity, struct model_way *ways,
                   uint32_t way_count, uint32_t turns)
{
    struct bench_samples samples[MODEL_WAYS_MAX][QUANTITIES] = {0};
    uint64_t hash[2] = {0, 0};
    bool is_same = true;
    for (uint32_t turn = 0; turn <= turns; turn++) {
        double first_step = 0;
        for (uint32_t i = 0; i < way_count; i++) {
            struct eng_step_result result = step(world, frames, affinity, &ways[i]);
            const struct pccd_step_times *t = &result.times;
            uint64_t detection = t->traversal + t->tests;
            if (turn == 0 && i == 0) {
                memcpy(hash, result.hash, sizeof hash);
            }
            is_same = is_same && memcmp(hash, result.hash, sizeof hash) == 0;
            first_step = i == 0 ? (double)t->step : first_step;
            const double values[QUANTITIES] = {
                (double)t->step,
                (double)t->step / first_step,
                (double)t->step - (double)(t->refit + detection + t->merge),
                (double)t->refit,
                (double)detection,
                (double)t->merge};
            for (int q = 0; q < QUANTITIES && turn > 0;
                 q++) { /* the first grows memory */
                bench_add(&samples[i][q], values[q]);
            }
        }
    }
    for (uint32_t i = 0; i < way_count; i++) {
        struct bench_summary of[QUANTITIES];
        for (int q = 0; q < QUANTITIES; q++) {
            of[q] = bench_summarise(&samples[i][q]);
            bench_free(&samples[i][q]);
        }
        ways[i].measured =
            (struct model_measured){of[STEP].p50,  of[RATIO].p50,     of[SERIAL].min,
                                    of[REFIT].min, of[DETECTION].min, of[MERGE].min};
    }
    return is_same;
}
