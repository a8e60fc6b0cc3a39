/* daemon/engine/step_memory.h - what one step leaves for the next.
 *
 * Room:     engine. May include: aside.h, effort.h, merge.h, refit.h, worker.h.
 * Does:     keep worker, queues, records and sort scratch of a scene, so that a warm step
 *           allocates nothing.
 * Threads:  [compute].
 */
#ifndef ENG_STEP_MEMORY_H
#define ENG_STEP_MEMORY_H

#include "aside.h"
#include "effort.h"
#include "merge.h"
#include "refit.h"
#include "worker.h"

struct eng_step_memory {
    struct eng_worker *workers[ENG_THREADS_MAX]; /* made when first needed */
    uint32_t worker_count;
    uint32_t most_threads; /* of the last turn_count steps */
    uint32_t turn_count;
    struct eng_thread_record *records; /* [worker_count] of the last step */
    struct eng_refit_plan plan;
    struct eng_assignment assignment;
    struct eng_aside aside;
    struct eng_effort effort[ENG_METHOD_WIDE + 1]; /* by method */
    struct eng_pool pool;                          /* of the workers' records */
    struct eng_merge merge;
    struct eng_records sorted; /* the last answer */
};

struct eng_step_memory *eng_step_memory_new(void); /* NULL: no memory */
void eng_step_memory_free(struct eng_step_memory *memory);

/* Workers for that many threads of the next step, 1 .. ENG_THREADS_MAX. Those that no
 * step has wanted for long are freed. ENG_E_NOMEM: those at hand stay. */
int eng_step_memory_reserve(struct eng_step_memory *memory, uint32_t threads);

/* Drop the last answer: its names may no longer mean the same. */
void eng_step_memory_forget(struct eng_step_memory *memory);

uint64_t eng_step_memory_bytes(const struct eng_step_memory *memory);

#endif
