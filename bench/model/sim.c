/* sim.c - a step by p threads, replayed from recorded costs. */
#include "sim.h"

#include <math.h>
#include <string.h>

double sim_line_use(struct sim *sim, struct sim_line *line, uint32_t thread, double now)
{
    const struct model_machine *machine = sim->input->machine;
    double begin = line->free_at > now ? line->free_at : now;
    line->free_at = begin + (line->owner == thread ? machine->local : machine->transfer);
    line->owner = thread;
    return line->free_at;
}

double sim_perform(struct sim *sim, struct sim_thread *thread,
                   const struct model_task *task)
{
    uint32_t emitted = task->candidates[0] + task->candidates[1];
    double each_ns = emitted > 0 ? task->tests_ns / emitted : 0;
    double ns = task->walk_ns;
    for (int kind = 0; kind < MODEL_KINDS; kind++) {
        thread->waiting[kind] += task->candidates[kind];
        thread->waiting_ns[kind] += each_ns * task->candidates[kind];
        if (thread->waiting[kind] >= ENG_CHUNK_MAX) {
            /* What stays is the newest, so it is this task's. */
            uint64_t left = thread->waiting[kind] % ENG_CHUNK_MAX;
            double left_ns = each_ns * (double)left;
            ns += thread->waiting_ns[kind] - left_ns;
            thread->waiting[kind] = left;
            thread->waiting_ns[kind] = left_ns;
        }
    }
    thread->busy += ns;
    sim->output->performed += ns;
    return ns;
}

double sim_flush(struct sim *sim, struct sim_thread *thread)
{
    double ns = 0;
    for (int kind = 0; kind < MODEL_KINDS; kind++) {
        ns += thread->waiting_ns[kind];
        thread->waiting[kind] = 0;
        thread->waiting_ns[kind] = 0;
    }
    thread->busy += ns;
    sim->output->performed += ns;
    return ns;
}

/* The runtime's barrier is a counter: arrivals change one line, one after another; the
 * last one lets the others go. Two threads were measured; that this part grows with the
 * logarithm of their number is assumed. Who has waited longer than the runtime spins is
 * asleep: the last one wakes sleepers one by one, and each takes a wake-up to run. */
void sim_barrier(struct sim *sim)
{
    const struct model_machine *machine = sim->input->machine;
    struct sim_line line = {0, UINT32_MAX};
    bool arrived[MODEL_THREADS_MAX] = {false};
    double arrival[MODEL_THREADS_MAX];
    double last = 0;
    uint32_t last_thread = 0;
    if (sim->count == 1) {
        return;
    }
    for (uint32_t i = 0; i < sim->count; i++) {
        sim->threads[i].now += 2 * machine->clock; /* the engine times the wait */
    }
    for (uint32_t k = 0; k < sim->count; k++) {
        uint32_t first = UINT32_MAX;
        for (uint32_t i = 0; i < sim->count; i++) {
            if (!arrived[i] &&
                (first == UINT32_MAX || sim->threads[i].now < sim->threads[first].now)) {
                first = i;
            }
        }
        arrived[first] = true;
        arrival[first] = sim->threads[first].now;
        last = sim_line_use(sim, &line, first, arrival[first]);
        last_thread = first;
    }
    double release = machine->barrier - machine->transfer;
    release = (release > 0 ? release : 0) * log2(sim->count);
    uint32_t sleepers = 0;
    for (uint32_t i = 0; i < sim->count; i++) {
        if (i == last_thread || last - arrival[i] <= machine->spin) {
            sim->threads[i].now = last + release;
        } else {
            sim->threads[i].now =
                last + release + machine->futex_each * sleepers + machine->wake;
            sleepers++;
        }
    }
    sim->threads[last_thread].now += machine->futex_each * sleepers;
}

/* ---- the phases ------------------------------------------------------------------ */

double sim_latest(const struct sim *sim)
{
    double last = 0;
    for (uint32_t i = 0; i < sim->count; i++) {
        last = fmax(last, sim->threads[i].now);
    }
    return last;
}

double sim_largest(const struct model_tasks *tasks)
{
    double largest = 0;
    for (uint32_t i = 0; i < tasks->count; i++) {
        largest = fmax(largest, tasks->items[i].walk_ns + tasks->items[i].tests_ns);
    }
    return largest;
}

/* The compute thread wakes its team, one after another. There is no barrier. */
static void start_region(struct sim *sim)
{
    const struct model_input *input = sim->input;
    for (uint32_t i = 1; i < sim->count; i++) {
        sim->threads[i].now +=
            input->machine->region + input->machine->futex_each * (i - 1);
    }
    sim->threads[0].now += input->machine->futex_each * (sim->count - 1);
}

/* Who is free first. */
uint32_t sim_earliest(const struct sim *sim)
{
    uint32_t first = 0;
    for (uint32_t i = 1; i < sim->count; i++) {
        if (sim->threads[i].now < sim->threads[first].now) {
            first = i;
        }
    }
    return first;
}

void sim_work(struct sim_thread *thread, double ns)
{
    thread->now += ns;
    thread->busy += ns;
}

/* As eng_answer_by_team and eng_answer_end. */
static void merge(struct sim *sim)
{
    const struct model_merge *merge = &sim->input->division->merge;
    struct sim_line line = {0, UINT32_MAX};
    double plan_from = 0;
    for (uint32_t i = 0; i < sim->count; i++) {
        struct sim_thread *at = &sim->threads[i];
        sim_work(at, merge->survey_ns);
        at->now = sim_line_use(sim, &line, i, at->now);
        plan_from = fmax(plan_from, at->now);
    }
    for (uint32_t i = 0; i < sim->count; i++) {
        if (sim->threads[i].now >= plan_from) { /* the last one to come */
            sim_work(&sim->threads[i], merge->plan_ns);
        }
    }
    sim_barrier(sim);
    if (merge->shared) {
        for (uint32_t i = 0; i < sim->count; i++) {
            sim_work(&sim->threads[i], merge->divide_ns);
        }
        sim_barrier(sim);
        line = (struct sim_line){0, UINT32_MAX};
        for (uint32_t k = 0; k < merge->bucket_count; k++) {
            uint32_t taker = sim_earliest(sim);
            sim->threads[taker].now =
                sim_line_use(sim, &line, taker, sim->threads[taker].now);
            sim_work(&sim->threads[taker], merge->buckets_ns / merge->bucket_count);
        }
        sim_barrier(sim);
    }
    sim_work(&sim->threads[0], merge->end_ns);
}

static double merge_work(const struct model_input *input)
{
    const struct model_merge *merge = &input->division->merge;
    return merge->plan_ns + merge->buckets_ns + merge->end_ns +
           input->division->threads * (merge->survey_ns + merge->divide_ns);
}

static bool is_wide(const struct model_input *input)
{
    return input->method == PCCD_METHOD_WIDE;
}

static double refit_work(const struct model_input *input)
{
    return is_wide(input)
               ? model_wide_refit_ns(&input->record->wide)
               : model_refit_ns(&input->division->refit[input->refit], input->record);
}

/* The first tasks are those below the roots, which one thread looks at too. */
static double detection_work(const struct model_input *input)
{
    const struct model_record *record = input->record;
    return is_wide(input) ? model_tasks_ns(&record->wide.tasks) + record->wide.deal_ns
                          : model_tasks_ns(&record->units);
}

void model_alone(const struct model_input *input, struct model_output *output)
{
    memset(output, 0, sizeof *output);
    output->refit = output->refit_work = refit_work(input);
    output->low = output->low_work = detection_work(input);
    output->merge = output->merge_work = input->merge_alone;
    output->serial = input->serial;
    output->total = output->refit + output->low + output->merge + output->serial;
    output->critical = output->total;
}

void model_simulate(const struct model_input *input, struct model_output *output)
{
    static struct sim sim;
    memset(&sim, 0, sizeof sim);
    memset(output, 0, sizeof *output);
    sim.input = input;
    sim.output = output;
    sim.count = input->division->threads;
    start_region(&sim);
    double begin = sim.threads[0].now; /* the others may come later */
    if (is_wide(input)) {
        sim_refit_wide(&sim);
    } else {
        sim_refit(&sim);
    }
    double refitted = sim_latest(&sim);
    double first = sim.threads[sim_earliest(&sim)].now; /* need not wait for the others */
    if (input->scheduler == ENG_SCHEDULER_STEAL) {
        sim_steal(&sim);
    } else {
        sim_paper(&sim);
    }
    double detected = sim_latest(&sim);
    merge(&sim);
    double end = sim_latest(&sim);
    double busy = 0;
    for (uint32_t i = 0; i < sim.count; i++) {
        busy += sim.threads[i].busy;
    }
    output->wait = end - busy / sim.count;
    output->serial = input->serial + begin;
    output->refit = refitted - begin;
    /* The schedulers leave in `low` when they began with high-level nodes. */
    double low_end = output->low > 0 ? output->low : detected;
    output->low = low_end - refitted;
    output->high = detected - low_end;
    output->detection = detected - first;
    output->merge = end - detected;
    output->total = end + input->serial;
    output->refit_work = refit_work(input);
    output->merge_work = merge_work(input);
}
