/* daemon/engine/schedule/team.h - the threads of one step.
 *
 * Room:     engine. May include: assignment.h, worker.h.
 * Does:     name what the threads of a parallel region share: the workers, the roots of
 *           the subtrees to refit, the count of unfinished tasks.
 * Threads:  filled in by [compute] before the region; each field says who writes it
 *           inside.
 */
#ifndef ENG_TEAM_H
#define ENG_TEAM_H

#include "assignment.h"
#include "worker.h"

struct eng_team {
    struct eng_scene *scene;
    struct eng_worker **workers; /* [count] */
    uint32_t count;              /* threads, >= 1 */
    struct eng_refit_plan *plan;
    struct eng_assignment *assignment; /* the paper's scheduler */
    uint64_t low_end_ns; /* when the low-level nodes were done; written by thread 0 */
    _Alignas(128) atomic_uint next_subtree;       /* refit: the next one to be taken */
    _Alignas(128) atomic_int_fast64_t open_tasks; /* stealing: pushed and not finished */
};

#endif
