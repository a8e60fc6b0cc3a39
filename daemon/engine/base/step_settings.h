/* step_settings.h - the settings of one step, chosen by its caller: mode, threads,
 * method, limits.
 *
 * Threads: [any]; types only.
 */
#ifndef ENG_STEP_SETTINGS_H
#define ENG_STEP_SETTINGS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "pccd_types.h"

struct eng_kernels;
struct eng_affinity;
struct eng_near_query;
struct eng_scene;
struct eng_trace;

#define ENG_THREADS_MAX 256u /* of one step */

/* How the threads of a step share its work (paper, sections 4 to 6). */
enum eng_scheduler {
    ENG_SCHEDULER_STEAL, /* they steal task units and pairs from each other */
    ENG_SCHEDULER_PAPER, /* dynamic assignment, then high-level nodes */
    ENG_SCHEDULER_COUNT
};

/* The paper's scheduler: how all threads perform one high-level node together. */
enum eng_high_level {
    ENG_HIGH_LEVEL_ROUND_ROBIN, /* pairs dealt out; a lock where a node is rebuilt */
    ENG_HIGH_LEVEL_DISJOINT,    /* pairs without a common node at a time, no lock */
    ENG_HIGH_LEVEL_COUNT
};

/* How the threads share the refit. */
enum eng_refit_scheme {
    ENG_REFIT_EVEN,  /* many small subtrees, taken on demand */
    ENG_REFIT_PAPER, /* two subtrees a thread, the first dealt out */
    ENG_REFIT_COUNT
};

/* What becomes of the boxes and records of what stands still (scene/moving.h). */
enum eng_still {
    ENG_STILL_KEPT, /* they are those of the last step */
    ENG_STILL_ANEW, /* they are made anew, as if everything moved: to compare with */
    ENG_STILL_COUNT
};

/* All of it; zeros are the defaults. Its text is in tuning.h. */
struct eng_tuning {
    enum eng_scheduler scheduler;
    enum eng_high_level high_level;
    enum eng_refit_scheme refit;
    enum eng_still still; /* of steps by one thread, too */
};

struct eng_step_settings {
    enum pccd_mode mode;
    enum pccd_method method;
    uint32_t threads;     /* at most this many, >= 1; the answer does not depend on it */
    double tolerance;     /* of toi_hi - toi, 1e-12 .. 1; default 1e-6 */
    uint64_t deadline_ns; /* CLOCK_MONOTONIC; 0 = none */
    const atomic_bool *cancel; /* set by any thread to stop the step; may be NULL */
    /* Asked where `cancel` is looked at, by the calling thread alone: true stops the step
     * as cancelled. So the caller may look where no other thread may. Some microseconds
     * lie between two questions, as a rule. NULL: nobody is asked. */
    bool (*is_stopped)(void *asked);
    void *asked;
    /* Records kept at most: of more, the first in canonical order (mode first: of those
     * that may have been the earliest then), and the answer is incomplete. */
    uint64_t contact_max;
    struct eng_tuning tuning; /* of steps by more than one thread */
    const struct eng_affinity
        *affinity;           /* where threads belong (affinity.h); NULL: anywhere */
    struct eng_trace *trace; /* what is recorded to (trace.h); NULL: nothing */
    uint32_t lane;           /* of it, for the first thread */
    /* Instruction set of refit, traversal and tests (kernel.h); NULL: eng_kernels(). */
    const struct eng_kernels *kernels;
    bool team_always; /* by `threads` threads however small the work: for tests */
    bool brief;       /* end soon or not at all (brief.h) */
    bool no_hash;     /* nobody reads it: of records none is made */
    /* Thickness: two features meet where they come within r of each other, the exact sum
     * of their radii (scene.h) and of the separation, which is 0 .. 1e18. Of pairs that
     * begin within r, approach 0 reports each, at t = 0; 0 < approach < 1: those that
     * come within so large a part of their first distance. */
    double separation;
    double approach;
    /* Say how it begins, too (struct eng_step_result: crossings, start_inside). Not of
     * brief steps. */
    bool tells_start;
    /* Whose worker a step by one thread uses in the place of its own: so that of many
     * scenes few have workers. No step of that scene is computed meanwhile. NULL, or the
     * scene itself: its own. Only of eng_step, and not of brief ones. */
    struct eng_scene *lender;
    /* Memory, aligned to 64 bytes, that nobody else uses until the step returns, as where
     * the caller will write the answer to: for what the step finds, before that is in
     * order. NULL: it has its own for all of that. Of eng_step alone. */
    void *lent;
    uint64_t lent_bytes;
    const struct eng_near_query *near; /* looked for in the place of contacts, by eng_near
                                        * alone; NULL: this is a step */
};

#define ENG_STEP_SETTINGS_DEFAULT                                                        \
    {                                                                                    \
        PCCD_MODE_ALL, PCCD_METHOD_DEFAULT, 1, 1e-6, 0, NULL, NULL, NULL, 16u << 20,     \
            {ENG_SCHEDULER_STEAL, ENG_HIGH_LEVEL_ROUND_ROBIN, ENG_REFIT_EVEN,            \
             ENG_STILL_KEPT},                                                            \
            NULL, NULL, 0, NULL, false, false, false, 0, 0, false, NULL, NULL, 0, NULL   \
    }

/* The method that the settings lead to: PCCD_METHOD_PAPER or PCCD_METHOD_WIDE. */
static inline enum pccd_method eng_method_of(const struct eng_step_settings *settings)
{
    if (settings->method != PCCD_METHOD_DEFAULT) {
        return settings->method;
    }
    return settings->tuning.scheduler == ENG_SCHEDULER_PAPER ? PCCD_METHOD_PAPER
                                                             : PCCD_METHOD_WIDE;
}

#endif
