/* record_merge.c - what the merge costs, part by part. */
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "merge.h"
#include "record.h"
#include "report.h"
#include "walker.h"

enum { SURVEY, PLAN, DIVIDE, FINISH, END, PARTS };

void model_merge_keep(struct model_record *record, const struct eng_found *found)
{
    uint32_t count = 0;
    for (struct eng_block *block = found->first; block; block = block->next) {
        count++;
    }
    record->blocks = bench_alloc(count, sizeof *record->blocks);
    record->block_count = 0;
    for (struct eng_block *block = found->first; block; block = block->next) {
        record->blocks[record->block_count++] = block;
    }
    record->found = *found;
}

/* Lists as if every thread had found as much. */
static void deal_out(const struct model_record *record, struct eng_found *lists,
                     uint32_t count)
{
    for (uint32_t t = 0; t < count; t++) {
        lists[t] = record->found; /* with the range of all names */
        lists[t].first = NULL;
        lists[t].last = NULL;
        lists[t].count = 0;
    }
    for (uint32_t i = 0; i < record->block_count; i++) {
        struct eng_block *block = record->blocks[i];
        struct eng_found *list = &lists[i % count];
        block->next = NULL;
        if (list->last) {
            list->last->next = block;
        } else {
            list->first = block;
        }
        list->last = block;
        list->count += block->count;
    }
}

static void lap(struct bench_samples *samples, uint64_t *begin_ns, double clock_ns)
{
    uint64_t end_ns = common_now_ns();
    double ns = (double)(end_ns - *begin_ns) - clock_ns;
    bench_add(samples, ns > 0 ? ns : 0);
    *begin_ns = common_now_ns();
}

static void merge_once(struct eng_merge *merge, uint32_t threads, double clock_ns,
                       struct bench_samples *samples)
{
    struct eng_counts counts;
    uint64_t begin_ns = common_now_ns();
    for (uint32_t t = 0; t + 1 < threads; t++) {
        eng_merge_survey(merge, threads, t);
    }
    lap(&samples[SURVEY], &begin_ns, clock_ns);
    eng_merge_survey(merge, threads, threads - 1);
    lap(&samples[PLAN], &begin_ns, clock_ns);
    if (eng_merge_is_shared(merge)) {
        for (uint32_t t = 0; t < threads; t++) {
            eng_merge_divide(merge, t);
        }
        lap(&samples[DIVIDE], &begin_ns, clock_ns);
        eng_merge_finish(merge, 0);
        lap(&samples[FINISH], &begin_ns, clock_ns);
    }
    eng_merge_end(merge, &counts);
    lap(&samples[END], &begin_ns, clock_ns);
}

void model_merge_init(struct model_merge *out, const struct model_record *record,
                      uint32_t threads)
{
    static struct eng_found lists[MODEL_THREADS_MAX];
    static struct eng_found *pointers[MODEL_THREADS_MAX];
    struct bench_samples samples[PARTS];
    struct eng_merge merge;
    struct eng_records records = {0};
    double p50[PARTS];
    memset(samples, 0, sizeof samples);
    eng_merge_init(&merge);
    deal_out(record, lists, threads);
    for (uint32_t t = 0; t < threads; t++) {
        pointers[t] = &lists[t];
    }
    for (uint32_t pass = 0; pass <= record->passes; pass++) {
        model_must(eng_merge_begin(&merge, pointers, threads, &records) == PCCD_OK,
                   "the merge");
        if (pass == 1) { /* memory has grown */
            for (int i = 0; i < PARTS; i++) {
                bench_clear(&samples[i]);
            }
        }
        merge_once(&merge, threads, record->clock_ns, samples);
    }
    for (int i = 0; i < PARTS; i++) {
        p50[i] = bench_summarise(&samples[i]).p50;
        bench_free(&samples[i]);
    }
    *out = (struct model_merge){.shared = eng_merge_is_shared(&merge),
                                .survey_ns = p50[SURVEY] / threads,
                                .plan_ns = p50[PLAN],
                                .divide_ns = p50[DIVIDE] / threads,
                                .buckets_ns = p50[FINISH],
                                .bucket_count = merge.splitters.buckets,
                                .end_ns = p50[END]};
    eng_merge_deinit(&merge);
    eng_records_deinit(&records);
}
