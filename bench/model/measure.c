/* measure.c - real steps, to take the serial parts from and to compare with. */
#include "measure.h"

#include <string.h>

#include "report.h"

enum { STEP, INGEST, REFIT, DETECTION, MERGE, REST, HAND_OVERS, RATIO, QUANTITIES };

/* What steps and questions about what is near have in common. */
struct outcome {
    struct pccd_step_times times;
    uint64_t hash[2];
    uint32_t threads;
    const struct eng_thread_record *thread_records;
};

static struct outcome step(struct bench_world *world, const struct bench_frames *frames,
                           const struct model_question *question,
                           const struct model_way *way)
{
    struct eng_step_settings settings = bench_step_settings(PCCD_MODE_ALL);
    settings.method = way->method;
    settings.threads = way->threads;
    settings.team_always = true;
    settings.tuning.scheduler = way->scheduler;
    settings.tuning.high_level = way->high_level;
    settings.tuning.refit = way->refit;
    settings.affinity = question->affinity;
    if (question->distance >= 0) {
        struct eng_near_settings asked = {.step = settings,
                                          .what = PCCD_NEAR_PAIRS,
                                          .distance = question->distance,
                                          .end = 1};
        struct eng_step_result near;
        struct eng_step_result away;
        bench_world_step(world, frames, &settings, &away); /* boxes are to be made */
        bench_world_near(world, frames, true, &asked, &near);
        return (struct outcome){
            near.times, {near.hash[0], near.hash[1]}, near.threads, near.thread_records};
    }
    struct eng_step_result result;
    bench_world_step(world, frames, &settings, &result);
    return (struct outcome){result.times,
                            {result.hash[0], result.hash[1]},
                            result.threads,
                            result.thread_records};
}

static void keep(struct bench_samples *samples, const struct outcome *result,
                 double first_step)
{
    const struct pccd_step_times *t = &result->times;
    double detection = (double)(t->traversal + t->tests);
    bench_add(&samples[STEP], (double)t->step);
    bench_add(&samples[INGEST], (double)t->ingest);
    bench_add(&samples[REFIT], (double)t->refit);
    bench_add(&samples[DETECTION], detection);
    bench_add(&samples[MERGE], (double)t->merge);
    bench_add(&samples[REST], (double)t->step - (double)t->ingest - (double)t->refit -
                                  detection - (double)t->merge);
    double hand_overs = 0;
    for (uint32_t i = 0; i < result->threads; i++) {
        hand_overs += (double)result->thread_records[i].steals;
    }
    bench_add(&samples[HAND_OVERS], hand_overs);
    bench_add(&samples[RATIO], (double)t->step / first_step);
}

bool model_measure(struct bench_world *world, const struct bench_frames *frames,
                   const struct model_question *question, const struct model_way *ways,
                   uint32_t way_count, uint32_t turns, struct model_measured *measured)
{
    struct bench_samples samples[MODEL_MEASURED_MAX][QUANTITIES];
    bool same = true;
    uint64_t hash[2] = {0, 0};
    memset(samples, 0, sizeof samples);
    for (uint32_t turn = 0; turn <= turns; turn++) {
        double first_step = 0;
        for (uint32_t i = 0; i < way_count; i++) {
            struct outcome result = step(world, frames, question, &ways[i]);
            if (turn == 0 && i == 0) {
                hash[0] = result.hash[0];
                hash[1] = result.hash[1];
            }
            same = same && hash[0] == result.hash[0] && hash[1] == result.hash[1];
            first_step = i == 0 ? (double)result.times.step : first_step;
            if (turn > 0) { /* the first one grows memory */
                keep(samples[i], &result, first_step);
            }
        }
    }
    for (uint32_t i = 0; i < way_count; i++) {
        double p50[QUANTITIES];
        double least[QUANTITIES];
        for (int q = 0; q < QUANTITIES; q++) {
            p50[q] = bench_summarise(&samples[i][q]).p50;
            least[q] = bench_summarise(&samples[i][q]).min;
            bench_free(&samples[i][q]);
        }
        measured[i] = (struct model_measured){.way = ways[i],
                                              .step = p50[STEP],
                                              .least = least[STEP],
                                              .ratio = p50[RATIO],
                                              .hand_overs = p50[HAND_OVERS],
                                              .ingest = least[INGEST],
                                              .refit = least[REFIT],
                                              .detection = least[DETECTION],
                                              .merge = least[MERGE],
                                              .rest = least[REST]};
    }
    return same;
}
