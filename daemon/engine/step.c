/* daemon/engine/step.c - one step of a scene.
 *
 * Room:     engine.
 * Does:     put the phases in order, time them, and describe the answer.
 * Threads:  [compute].
 * Source:   paper sections 4 to 6.
 */
#include "step.h"

#include <math.h>
#include <string.h>

#include "build.h"
#include "clock.h"
#include "memory.h"
#include "refit.h"
#include "schedule.h"
#include "stage.h"
#include "step_memory.h"

struct eng_step_memory *eng_step_memory_new(void)
{
    struct eng_step_memory *memory = eng_alloc(1, sizeof *memory);
    if (memory) {
        memset(memory, 0, sizeof *memory);
        eng_worker_init(&memory->worker);
    }
    return memory;
}

void eng_step_memory_free(struct eng_step_memory *memory)
{
    if (memory) {
        eng_worker_deinit(&memory->worker);
        eng_sorter_deinit(&memory->sorter);
        eng_records_deinit(&memory->sorted);
        eng_free(memory);
    }
}

void eng_step_memory_forget(struct eng_step_memory *memory)
{
    memory->sorted.count = 0;
}

uint64_t eng_step_memory_bytes(const struct eng_step_memory *memory)
{
    return sizeof *memory + memory->worker.records.capacity_bytes +
           memory->sorted.capacity_bytes +
           2 * memory->sorter.capacity * sizeof *memory->sorter.items +
           memory->worker.units.capacity * sizeof *memory->worker.units.nodes;
}

static bool settings_are_valid(const struct eng_step_settings *settings)
{
    return settings->mode >= ENG_MODE_ALL && settings->mode <= ENG_MODE_PAIRS &&
           settings->method >= ENG_METHOD_DEFAULT && settings->method <= ENG_METHOD_PAPER &&
           settings->threads >= 1 && settings->tolerance >= 1e-12 &&
           settings->tolerance <= 1;
}

/* Mode first: of what was found before the bound had shrunk to its last value, keep what may
 * attain the earliest time. */
static void keep_earliest(struct eng_records *records)
{
    struct eng_contact *contacts = (void *)records->data;
    double bound = 2;
    for (uint64_t i = 0; i < records->count; i++) {
        if ((contacts[i].flags & ENG_PROVED) && contacts[i].toi_hi < bound) {
            bound = contacts[i].toi_hi;
        }
    }
    uint64_t kept = 0;
    for (uint64_t i = 0; i < records->count; i++) {
        if (contacts[i].toi <= bound) {
            contacts[kept++] = contacts[i];
        }
    }
    records->count = kept;
}

/* Counts over the sorted records. */
static void summarise(struct eng_step_result *result)
{
    if (result->mode == ENG_MODE_PAIRS) {
        const struct eng_pair *pairs = result->records;
        for (uint64_t i = 0; i < result->count; i++) {
            result->vf += pairs[i].kind == ENG_VF;
        }
    } else {
        const struct eng_contact *contacts = result->records;
        for (uint64_t i = 0; i < result->count; i++) {
            result->vf += contacts[i].kind == ENG_VF;
            result->possible += !(contacts[i].flags & ENG_PROVED);
            result->initial += (contacts[i].flags & ENG_INITIAL) != 0;
            result->toi_first = fmin(result->toi_first, contacts[i].toi);
        }
    }
    result->ee = result->count - result->vf;
}

static enum eng_verdict verdict_of(const struct eng_worker *worker)
{
    if (worker->proved_seen > 0) {
        return ENG_VERDICT_YES;
    }
    if (worker->stop->reason != ENG_COMPLETE) {
        return ENG_VERDICT_NONE;
    }
    return worker->possible_seen > 0 ? ENG_VERDICT_POSSIBLE : ENG_VERDICT_NO;
}

/* Sort and hash what the worker found. */
static int merge(struct eng_step_memory *memory, struct eng_step_result *result)
{
    uint64_t hash[2];
    struct eng_records *found = &memory->worker.records;
    if (result->mode == ENG_MODE_ANY) {
        uint32_t verdict = verdict_of(&memory->worker);
        result->verdict = verdict;
        if (verdict == ENG_VERDICT_YES) {
            result->incomplete = ENG_COMPLETE; /* decided, whatever came after */
        }
        memory->sorted.count = 0;
        eng_hash(&verdict, sizeof verdict, hash);
    } else {
        if (result->mode == ENG_MODE_FIRST) {
            keep_earliest(found);
        }
        int status = eng_records_sort(&memory->sorter, found, &memory->sorted);
        if (status != ENG_OK) {
            return status;
        }
        result->records = memory->sorted.data;
        result->count = memory->sorted.count;
        eng_hash(memory->sorted.data, result->count * result->record_bytes, hash);
        summarise(result);
    }
    result->hash_hi = hash[0];
    result->hash_lo = hash[1];
    return ENG_OK;
}

static void detect(struct eng_worker *worker, struct eng_step_result *result)
{
    uint64_t begin_ns = eng_now_ns();
    eng_schedule_serial(worker);
    result->times.tests = worker->tests_ns;
    result->times.traversal = eng_now_ns() - begin_ns - worker->tests_ns;
    result->counters = worker->counters;
    result->counters.exact = worker->exact.queries;
    if (worker->stop->reason != ENG_COMPLETE) {
        result->incomplete = worker->stop->reason;
    } else if (worker->records.overflowed) {
        result->incomplete = ENG_INCOMPLETE_CONTACT_LIMIT;
    }
}

/* Everything that can fail for want of memory, before anything moves. */
static int prepare(struct eng_scene *scene, const struct eng_step_settings *settings,
                   struct eng_stop *stop)
{
    if (scene->top_is_stale) {
        int status = eng_build_top(scene);
        if (status != ENG_OK) {
            return status;
        }
    }
    return eng_worker_begin(&scene->memory->worker, scene, settings, stop);
}

int eng_step(struct eng_scene *scene, const struct eng_step_settings *settings,
             struct eng_step_result *result)
{
    uint64_t begin_ns = eng_now_ns();
    uint64_t allocs = eng_alloc_count();
    uint64_t builds = scene->builds;
    struct eng_step_memory *memory = scene->memory;
    struct eng_stop stop = {settings->cancel, settings->deadline_ns, ENG_COMPLETE, false};
    int status = settings_are_valid(settings) ? prepare(scene, settings, &stop) : ENG_E_INVAL;
    if (status != ENG_OK) {
        eng_stage_abort(scene);
        return status;
    }
    status = eng_stage_commit(scene);
    if (status != ENG_OK) {
        return status;
    }
    struct eng_step_result r = {.mode = settings->mode,
                                .method = ENG_METHOD_PAPER,
                                .verdict = ENG_VERDICT_NONE,
                                .record_bytes = memory->worker.records.record_bytes,
                                .toi_first = 2,
                                .threads = 1};
    r.times.ingest = scene->stage_ns;
    uint64_t refit_ns = eng_now_ns();
    eng_refit(scene);
    r.times.refit = eng_now_ns() - refit_ns;
#ifdef PCCD_VALIDATE
    assert(eng_tree_validate(scene));
#endif
    detect(&memory->worker, &r);
    uint64_t merge_ns = eng_now_ns();
    if (merge(memory, &r) != ENG_OK) {
        /* No memory to sort: an empty page that says it is not the whole answer. */
        eng_step_memory_forget(memory);
        r.incomplete = ENG_INCOMPLETE_CONTACT_LIMIT;
    }
    r.times.merge = eng_now_ns() - merge_ns;
    r.times.step = eng_now_ns() - begin_ns + scene->stage_ns;
    r.counters.builds = scene->builds - builds;
    r.counters.allocs = eng_alloc_count() - allocs;
    *result = r;
    return ENG_OK;
}
