/* team.c - the threads of one step. */
#include "team.h"

#include <assert.h>

#include "wait.h"

void eng_refit_begin(struct eng_team *team)
{
    assert(team->count >= 1);
    atomic_init(&team->refit.next_vertices, 0);
    atomic_init(&team->refit.vertices_done, 0);
    atomic_init(&team->refit.next_root, 0);
    atomic_init(&team->refit.next_edges, 0);
    atomic_init(&team->refit.rest_done, 0);
    atomic_init(&team->refit.released, 0);
}

void eng_refit_release(struct eng_team *team)
{
    atomic_store_explicit(&team->refit.released, 1, memory_order_release);
}

void eng_refit_await(struct eng_team *team, struct eng_worker *worker)
{
    eng_wait_for(worker, &team->refit.released, 1);
}
