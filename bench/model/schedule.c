/* schedule.c - a list scheduler. */
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"

uint32_t model_tasks_add(struct model_tasks *tasks, uint32_t count)
{
    if (tasks->count + count > tasks->capacity) {
        tasks->capacity = 2 * tasks->capacity + count + 64;
        tasks->items = realloc(tasks->items, tasks->capacity * sizeof *tasks->items);
        bench_need(tasks->items != NULL, "no memory for tasks");
    }
    uint32_t first = tasks->count;
    memset(tasks->items + first, 0, count * sizeof *tasks->items);
    tasks->count += count;
    return first;
}

void model_tasks_free(struct model_tasks *tasks)
{
    free(tasks->items);
    memset(tasks, 0, sizeof *tasks);
}

double model_tasks_sum(const struct model_tasks *tasks)
{
    double sum = 0;
    for (uint32_t i = 0; i < tasks->count; i++) {
        sum += tasks->items[i].ns;
    }
    return sum;
}

double model_tasks_chain(const struct model_tasks *tasks, const uint32_t *roots,
                         uint32_t count, double *largest)
{
    double *chain = bench_alloc(tasks->count, sizeof *chain);
    double longest = *largest = 0;
    for (uint32_t i = tasks->count; i-- > 0;) {
        const struct model_task *task = &tasks->items[i];
        chain[i] = 0;
        for (uint32_t k = 0; k < task->child_count; k++) {
            chain[i] = fmax(chain[i], chain[task->first_child + k]);
        }
        chain[i] += task->ns;
        *largest = fmax(*largest, task->ns);
    }
    for (uint32_t k = 0; k < count; k++) {
        longest = fmax(longest, chain[roots ? roots[k] : k]);
    }
    free(chain);
    return longest;
}

void model_tasks_scale(struct model_tasks *tasks, double factor)
{
    for (uint32_t i = 0; i < tasks->count; i++) {
        tasks->items[i].ns *= factor;
    }
}

double model_latest(const struct model_threads *threads)
{
    double latest = 0;
    for (uint32_t t = 0; t < threads->count; t++) {
        latest = fmax(latest, threads->now[t]);
    }
    return latest;
}

void model_work(struct model_threads *threads, uint32_t thread, double ns)
{
    threads->now[thread] += ns;
    threads->busy += ns;
}

/* When a thread that waits from `arrival` on sees what happened at `end`: as in the
 * engine's wait.c it spins for a while, then sleeps longer and longer. */
static double seen(double arrival, double end)
{
    double sleep = 20000;
    double now = arrival + 200000;
    if (now >= end) {
        return end;
    }
    while (now < end) {
        now += sleep;
        sleep = fmin(2 * sleep, 160000);
    }
    return now;
}

/* Two threads were measured; that it grows with the logarithm of their number is
 * assumed. */
void model_barrier(struct model_threads *threads)
{
    double end = model_latest(threads) + threads->costs->barrier * log2(threads->count);
    for (uint32_t t = 0; t < threads->count; t++) {
        threads->now[t] = seen(threads->now[t], end);
    }
}

/* ---- the list scheduler ---------------------------------------------------------- */

struct entry {
    uint32_t task;
    double made; /* others see it from then on */
};

/* A thread's tasks, the oldest first. */
struct list {
    struct entry *entries;
    uint32_t first, count, capacity;
};

static void push(struct list *list, uint32_t task, double made)
{
    if (list->first + list->count == list->capacity) {
        list->capacity = 2 * list->capacity + 64;
        list->entries = realloc(list->entries, list->capacity * sizeof *list->entries);
        bench_need(list->entries != NULL, "no memory for tasks");
    }
    list->entries[list->first + list->count++] = (struct entry){task, made};
}

/* The thread's own newest task; else the one that was made first of all. */
static struct list *next_of(struct list *lists, uint32_t count, uint32_t thread)
{
    struct list *next = &lists[thread];
    if (next->count > 0) {
        return next;
    }
    next = NULL;
    for (uint32_t t = 0; t < count; t++) {
        struct list *list = &lists[t];
        if (list->count > 0 && (next == NULL || list->entries[list->first].made <
                                                    next->entries[next->first].made)) {
            next = list;
        }
    }
    return next;
}

uint32_t model_earliest(const struct model_threads *threads)
{
    uint32_t first = 0;
    for (uint32_t t = 1; t < threads->count; t++) {
        if (threads->now[t] < threads->now[first]) {
            first = t;
        }
    }
    return first;
}

void model_schedule(struct model_threads *threads, const struct model_tasks *tasks,
                    const uint32_t *roots, uint32_t count, double hand_over)
{
    struct list lists[MODEL_THREADS_MAX] = {0};
    for (uint32_t k = 0; k < count; k++) {
        uint64_t owner = (uint64_t)k * threads->count / count;
        push(&lists[owner], roots ? roots[k] : k, 0);
    }
    for (uint32_t left = count; left > 0; left--) {
        uint32_t thread = model_earliest(threads);
        struct list *list = next_of(lists, threads->count, thread);
        struct entry *entry = &list->entries[list->first];
        threads->now[thread] += threads->costs->take;
        if (list == &lists[thread]) {
            entry += list->count - 1;
        } else {
            threads->now[thread] = fmax(threads->now[thread], entry->made) + hand_over;
            list->first++;
        }
        list->count--;
        const struct model_task *task = &tasks->items[entry->task];
        model_work(threads, thread, task->ns);
        for (uint32_t k = 0; k < task->child_count; k++) {
            push(&lists[thread], task->first_child + k, threads->now[thread]);
        }
        left += task->child_count;
    }
    for (uint32_t t = 0; t < threads->count; t++) {
        free(lists[t].entries);
    }
}
