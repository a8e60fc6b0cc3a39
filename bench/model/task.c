/* task.c - what the tasks of a step cost, one by one. */
#include "task.h"

#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "paper_work.h"
#include "report.h"
#include "taskunit.h"

#define CLOCK_READINGS 4001

/* A task that took this long may have lost the processor meanwhile. Asking takes 600 ns,
 * too much for short tasks, which hardly ever do. */
#define LONG_NS 30000

uint32_t model_tasks_add(struct model_tasks *tasks, uint32_t count)
{
    if (tasks->count + count > tasks->capacity) {
        uint32_t capacity = 2 * tasks->capacity + count + 64;
        struct model_task *items = bench_alloc(capacity, sizeof *items);
        if (tasks->count > 0) {
            memcpy(items, tasks->items, tasks->count * sizeof *items);
        }
        free(tasks->items);
        tasks->items = items;
        tasks->capacity = capacity;
    }
    uint32_t first = tasks->count;
    memset(tasks->items + first, 0, count * sizeof *tasks->items);
    tasks->count += count;
    return first;
}

void model_tasks_deinit(struct model_tasks *tasks)
{
    free(tasks->items);
    memset(tasks, 0, sizeof *tasks);
}

static bool are_same(const struct model_tasks *a, const struct model_tasks *b)
{
    bool same = a->count == b->count;
    for (uint32_t i = 0; i < a->count && same; i++) {
        const struct model_task *s = &a->items[i];
        const struct model_task *t = &b->items[i];
        same = s->candidates[0] == t->candidates[0] &&
               s->candidates[1] == t->candidates[1] && s->child_count == t->child_count &&
               s->first_child == t->first_child;
    }
    return same;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool take_median(struct model_tasks *passes, uint32_t pass_count)
{
    double *walk = bench_alloc(pass_count, sizeof *walk);
    double *tests = bench_alloc(pass_count, sizeof *tests);
    bool same = true;
    for (uint32_t k = 1; k < pass_count && same; k++) {
        same = are_same(&passes[0], &passes[k]);
    }
    for (uint32_t i = 0; i < passes[0].count && same; i++) {
        for (uint32_t k = 0; k < pass_count; k++) {
            walk[k] = passes[k].items[i].walk_ns;
            tests[k] = passes[k].items[i].tests_ns;
        }
        qsort(walk, pass_count, sizeof *walk, compare);
        qsort(tests, pass_count, sizeof *tests, compare);
        passes[0].items[i].walk_ns = walk[pass_count / 2];
        passes[0].items[i].tests_ns = tests[pass_count / 2];
    }
    free(walk);
    free(tests);
    return same;
}

struct model_tasks *model_tasks_passes(uint32_t count)
{
    struct model_tasks *passes = bench_alloc(count, sizeof *passes);
    memset(passes, 0, count * sizeof *passes);
    return passes;
}

bool model_tasks_take_medians(struct model_tasks *tasks, struct model_tasks *passes,
                              uint32_t count)
{
    bool consistent = take_median(passes, count);
    *tasks = passes[0];
    for (uint32_t pass = 1; pass < count; pass++) {
        model_tasks_deinit(&passes[pass]);
    }
    free(passes);
    return consistent;
}

double model_tasks_ns(const struct model_tasks *tasks)
{
    double sum = 0;
    for (uint32_t i = 0; i < tasks->count; i++) {
        sum += tasks->items[i].walk_ns + tasks->items[i].tests_ns;
    }
    return sum;
}

double model_clock_ns(void)
{
    static double between[CLOCK_READINGS];
    for (int i = 0; i < CLOCK_READINGS; i++) {
        uint64_t begin_ns = common_now_ns();
        between[i] = (double)(common_now_ns() - begin_ns);
    }
    qsort(between, CLOCK_READINGS, sizeof *between, compare);
    /* The clock counts whole nanoseconds, so the middle half is averaged. */
    double sum = 0;
    for (int i = CLOCK_READINGS / 4; i < CLOCK_READINGS * 3 / 4; i++) {
        sum += between[i];
    }
    return sum / (CLOCK_READINGS * 3 / 4 - CLOCK_READINGS / 4);
}

/* The processor's time of this thread. */
static uint64_t used_ns(void)
{
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return (uint64_t)used.tv_sec * 1000000000u + (uint64_t)used.tv_nsec;
}

static uint32_t waiting_of(const struct model_recorder *recorder, int kind)
{
    const struct eng_worker *worker = recorder->worker;
    if (recorder->is_wide) {
        return eng_wide_work_of(worker)->join.chunks[kind].count;
    }
    return eng_paper_work_of(worker)->chunks[kind].count;
}

static uint64_t tested_of(const struct model_recorder *recorder, int kind)
{
    const struct eng_tally *tally = &recorder->worker->tally;
    if (recorder->is_wide) { /* the tally also counts what the join left out in time */
        return recorder->flushed[kind];
    }
    return tally->candidates[kind];
}

void model_record_begin(struct model_recorder *recorder, struct eng_worker *worker,
                        struct model_tasks *tasks, double clock_ns)
{
    memset(recorder, 0, sizeof *recorder);
    recorder->worker = worker;
    recorder->tasks = tasks;
    recorder->clock_ns = clock_ns;
    recorder->used_ns = used_ns();
    recorder->looked_ns = common_now_ns();
    recorder->begin_ns = common_now_ns();
}

/* Who counts the chunks of the method wide, and what a chunk goes through. */
static struct model_recorder *counting;
static void (*flush_really)(void *owner, enum pccd_kind kind,
                            struct eng_wide_chunk *chunk);

static void count_and_flush(void *owner, enum pccd_kind kind,
                            struct eng_wide_chunk *chunk)
{
    counting->flushed[kind] += chunk->count;
    flush_really(owner, kind, chunk);
}

void model_record_begin_wide(struct model_recorder *recorder, struct eng_worker *worker,
                             struct model_tasks *tasks, double clock_ns)
{
    model_record_begin(recorder, worker, tasks, clock_ns);
    recorder->is_wide = true;
    counting = recorder;
    flush_really = eng_wide_work_of(worker)->join.flush;
    eng_wide_work_of(worker)->join.flush = count_and_flush;
}

/* `count` candidates of a kind, the oldest, were tested at `each_ns`. */
static void charge(struct model_recorder *recorder, int kind, uint64_t count,
                   double each_ns)
{
    struct model_waiting *waiting = recorder->waiting[kind];
    uint32_t done = 0;
    while (count > 0) {
        struct model_waiting *oldest = &waiting[done];
        uint32_t taken = oldest->count < count ? oldest->count : (uint32_t)count;
        recorder->tasks->items[oldest->task].tests_ns += each_ns * taken;
        oldest->count -= taken;
        count -= taken;
        done += oldest->count == 0;
    }
    recorder->waiting_count[kind] -= done;
    memmove(waiting, waiting + done, recorder->waiting_count[kind] * sizeof *waiting);
}

/* Divide what tests took since the last time, `share` of which was theirs. Returns it. */
static double charge_tests(struct model_recorder *recorder, double share)
{
    const struct eng_worker *worker = recorder->worker;
    double tests_ns = share * (double)(worker->record.tests_ns - recorder->tests_ns);
    uint64_t count[MODEL_KINDS];
    for (int kind = 0; kind < MODEL_KINDS; kind++) {
        count[kind] = tested_of(recorder, kind) - recorder->tested[kind];
        recorder->tested[kind] += count[kind];
    }
    if (count[0] + count[1] > 0) {
        double each_ns = tests_ns / (double)(count[0] + count[1]);
        charge(recorder, PCCD_VF, count[PCCD_VF], each_ns);
        charge(recorder, PCCD_EE, count[PCCD_EE], each_ns);
    }
    recorder->tests_ns = worker->record.tests_ns;
    return tests_ns;
}

/* The share of `elapsed_ns` in which this thread had the processor. */
static double share_used(struct model_recorder *recorder, double elapsed_ns)
{
    if (elapsed_ns < LONG_NS) {
        return 1;
    }
    uint64_t used = used_ns();
    uint64_t now = common_now_ns();
    double lost_ns =
        (double)(now - recorder->looked_ns) - (double)(used - recorder->used_ns);
    recorder->used_ns = used;
    recorder->looked_ns = now;
    /* The two clocks are not read at once. */
    return lost_ns < 1000 || lost_ns > elapsed_ns ? 1 : 1 - lost_ns / elapsed_ns;
}

void model_record_close(struct model_recorder *recorder, uint32_t task)
{
    double elapsed_ns = (double)(common_now_ns() - recorder->begin_ns);
    double share = share_used(recorder, elapsed_ns);
    for (int kind = 0; kind < MODEL_KINDS; kind++) {
        uint64_t emitted = tested_of(recorder, kind) + waiting_of(recorder, kind);
        uint32_t added = (uint32_t)(emitted - recorder->emitted[kind]);
        recorder->emitted[kind] = emitted;
        recorder->tasks->items[task].candidates[kind] = added;
        if (added > 0) {
            uint32_t at = recorder->waiting_count[kind]++;
            recorder->waiting[kind][at] = (struct model_waiting){task, added};
        }
    }
    double walk_ns =
        share * elapsed_ns - recorder->clock_ns - charge_tests(recorder, share);
    recorder->tasks->items[task].walk_ns = walk_ns > 0 ? walk_ns : 0;
    recorder->begin_ns = common_now_ns();
}

void model_record_end(struct model_recorder *recorder)
{
    if (recorder->is_wide) {
        eng_wide_join_flush(&eng_wide_work_of(recorder->worker)->join);
    } else {
        eng_taskunit_flush(recorder->worker);
    }
    double elapsed_ns = (double)(common_now_ns() - recorder->begin_ns);
    charge_tests(recorder, share_used(recorder, elapsed_ns));
}
