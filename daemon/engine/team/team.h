/* team.h - what the threads that compute one step share.
 *
 * Threads: filled in by [compute] before the region; each field says who writes it
 * inside.
 */
#ifndef ENG_TEAM_H
#define ENG_TEAM_H

#include "wait.h"
#include "worker.h"

/* Each counter is taken from by all threads: a pair of cache lines of its own. */
struct eng_refit_progress {
    _Alignas(128) atomic_uint next_vertices; /* chunk that nobody has taken */
    _Alignas(128) atomic_uint vertices_done; /* chunks */
    _Alignas(128) atomic_uint next_root;
    _Alignas(128) atomic_uint next_edges;
    _Alignas(128) atomic_uint rest_done; /* chunks of edges, and one for the root */
    _Alignas(128) atomic_uint released;  /* 1: everybody may look at the boxes */
};

struct eng_method_calls;

struct eng_team {
    struct eng_scene *scene;
    struct eng_worker **workers;           /* [count] */
    uint32_t count;                        /* threads, >= 1; as many as asked for, until
                                            * the refit has ended */
    uint32_t shares;                       /* as many as asked for */
    const struct eng_method_calls *method; /* method.h */
    /* Records of pairs of which neither feature moves (moving.h) are taken from the last
     * answer: no worker finds such a pair. */
    bool prunes;
    bool has_boxes; /* of this very step: there is nothing to refit */
    /* Do a thread's part when the boxes are there; NULL: the method's tasks. [team] */
    void (*search)(struct eng_team *team, struct eng_worker *worker);
    /* Do more when a thread has no task of the method any more; NULL: nothing. [team] */
    void (*after)(struct eng_team *team, struct eng_worker *worker);
    uint64_t refit_end_ns; /* written by the thread that ended the refit */
    struct eng_refit_progress refit;
    _Alignas(128) atomic_uint active; /* stealing: workers that have tasks */
};

/* Begin a refit, before the region: nothing of it is done. [compute] */
static inline void eng_refit_begin(struct eng_team *team)
{
    atomic_init(&team->refit.next_vertices, 0);
    atomic_init(&team->refit.vertices_done, 0);
    atomic_init(&team->refit.next_root, 0);
    atomic_init(&team->refit.next_edges, 0);
    atomic_init(&team->refit.rest_done, 0);
    atomic_init(&team->refit.released, 0);
}

/* Let the others go on, which wait in await: the one that ended the refit last calls it.
 * [team] */
static inline void eng_refit_release(struct eng_team *team)
{
    atomic_store_explicit(&team->refit.released, 1, memory_order_release);
}

/* Wait until the refit has ended: what it made is visible then. [team] */
static inline void eng_refit_await(struct eng_team *team, struct eng_worker *worker)
{
    eng_wait_for(worker, &team->refit.released, 1);
}

#endif
