/* daemon/engine/step_memory.h - what one step leaves for the next.
 *
 * Room:     engine. May include: worker.h.
 * Does:     keep worker, queues, records and sort scratch of a scene, so that a warm step
 *           allocates nothing.
 * Threads:  [compute].
 */
#ifndef ENG_STEP_MEMORY_H
#define ENG_STEP_MEMORY_H

#include "worker.h"

struct eng_step_memory {
    struct eng_worker worker;
    struct eng_sorter sorter;
    struct eng_records sorted; /* the last answer */
};

struct eng_step_memory *eng_step_memory_new(void); /* NULL: no memory */
void eng_step_memory_free(struct eng_step_memory *memory);

/* Drop the last answer: its names may no longer mean the same. */
void eng_step_memory_forget(struct eng_step_memory *memory);

uint64_t eng_step_memory_bytes(const struct eng_step_memory *memory);

#endif
