/* wait.h - what a thread without work does until the others are done: spin, then look
 * after them, then sleep.
 *
 * Spend the time between two looks at what is waited for. First it spins, because the
 * others usually end within microseconds; then it also looks whether they run at all
 * (affinity.h); then it sleeps, longer each time.
 *
 * Threads: [team]; a wait belongs to one thread.
 */
#ifndef ENG_WAIT_H
#define ENG_WAIT_H

#include "affinity.h"
#include "worker.h"

struct eng_wait {
    struct eng_worker *worker; /* that it is accounted to; NULL: none */
    const struct eng_affinity *affinity;
    uint32_t thread;
    uint32_t team_count;
    uint32_t moments;
    uint64_t begin_ns;
    uint64_t next_ns; /* when to look at another */
    uint64_t spin_end_ns;
    uint64_t sleep_ns; /* the next one's length; 0: not slept yet */
    struct eng_processor_look look;
};

/* Begin to wait, inside a region. */
void eng_wait_begin(struct eng_wait *wait, struct eng_worker *worker);

/* Let a moment go by. True: a long one, asleep. */
bool eng_wait_moment(struct eng_wait *wait);

/* End the wait, and account for its time. */
void eng_wait_end(struct eng_wait *wait);

/* Wait until the counter has that value: what was released with it is visible then. */
void eng_wait_for(struct eng_worker *worker, const atomic_uint *counter, uint32_t value);

/* Wait in the same way, as a thread that is no worker of a step. */
void eng_wait_plainly(const struct eng_affinity *affinity, uint32_t thread,
                      const atomic_uint *counter, uint32_t value);

/* Wait until all threads of the region are here; every one of them calls it, and what one
 * did before is visible to all after it. */
void eng_wait_for_all(struct eng_worker *worker);

/* Go back to the worker's own processor, if it was lent another: others no longer wait
 * for it. Not in a step that is stopped, of which nothing is left but to come to its
 * end. */
static inline void eng_wait_return(struct eng_worker *worker, uint32_t team_count)
{
    if (!eng_stop_is_set(worker->stop)) {
        eng_affinity_return(worker->question->affinity, worker->thread, team_count);
    }
}

/* Execute the pause instruction, for a loop that waits for another thread. */
static inline void eng_relax(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

#endif
