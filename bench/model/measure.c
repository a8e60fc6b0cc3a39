/* measure.c - real steps, to take the serial parts from and to compare with. */
#include "measure.h"

#include <string.h>

#include "report.h"

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
                   const struct eng_affinity *affinity, const struct model_way *ways,
                   uint32_t way_count, uint32_t turns, struct model_measured *measured)
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
        measured[i] =
            (struct model_measured){of[STEP].p50,  of[RATIO].p50,     of[SERIAL].min,
                                    of[REFIT].min, of[DETECTION].min, of[MERGE].min};
    }
    return is_same;
}
