/* laststep.h - what each thread did in the last step, or batch, for `pccdctl stats
 * --threads`.
 */
#ifndef SRV_LASTSTEP_H
#define SRV_LASTSTEP_H

#include <stdatomic.h>
#include <stdint.h>

#include "engine.h"
#include "messages.h"

struct srv_laststep_thread {
    struct eng_thread_record record;
    uint64_t scenes; /* of a batch, that the thread had a part in; else 0 */
};

struct srv_laststep {
    uint32_t refs;   /* [loop] session, daemon */
    uint64_t number; /* [loop] of the step in this epoch; of a batch, its last one */
    uint32_t batch;  /* [loop] scenes of the batch; 0: it was a step */
    struct proto_answer answer;
    uint32_t thread_count;
    uint32_t capacity;                    /* of threads */
    struct srv_laststep_thread threads[]; /* [thread_count] */
};

/* The memory of the one that was freed last: a warm step asks the heap for none. */
struct srv_laststep_spare {
    struct srv_laststep *_Atomic last; /* NULL: none */
};

/* Make one for so many threads, all that they did still 0, with no reference yet. NULL:
 * no memory, and then nobody can ask. [compute] */
struct srv_laststep *srv_laststep_new(struct srv_laststep_spare *spare, uint32_t threads);
/* Make one of a step, with what the engine says of its threads; NULL: no memory.
 * [compute] */
struct srv_laststep *srv_laststep_of(struct srv_laststep_spare *spare,
                                     const struct eng_step_result *step);

/* Let *slot hold `last` instead of what it holds; `last` may be NULL. [loop] */
void srv_laststep_set(struct srv_laststep_spare *spare, struct srv_laststep **slot,
                      struct srv_laststep *last);

/* Free what is spare. No slot holds any more. [loop] */
void srv_laststep_deinit(struct srv_laststep_spare *spare);

#endif
