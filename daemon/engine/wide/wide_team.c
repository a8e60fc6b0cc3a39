/* wide_team.c - the boxes of wide trees by all threads of a step.
 *
 * Chunks of vertices, each thread its share and then what others have left; when all are
 * done, which need not mean that all threads are there, chunks of edges and of faces with
 * the first level above them; whoever ends last makes the few boxes above those.
 */
#include "wide_state.h"

#include <assert.h>

#include "moving.h"
#include "wait.h"
#include "wide_test.h"

/* Chunks of a kind, one's own first, that this thread has made. Those of a step that is
 * stopped count as made: nobody searches their boxes. */
static uint32_t make_chunks(struct eng_team *team, struct eng_worker *worker,
                            enum pccd_tree kind)
{
    uint32_t made = 0;
    for (uint32_t i = 0; i < team->shares; i++) {
        uint32_t owner = (worker->thread + i) % team->shares;
        uint32_t chunk;
        while (eng_partition_take(&eng_wide_work_of(team->workers[owner])->shares[kind],
                                  &chunk)) {
            if (!eng_worker_should_stop(worker)) {
                eng_wide_refit_chunk(eng_wide_of(team->scene), team->scene, kind, chunk);
            }
            made++;
        }
    }
    return made;
}

/* A part of the refit that began at `begin_ns`. */
static void record(struct eng_worker *worker, uint64_t begin_ns)
{
    worker->record.refit_ns += common_now_ns() - begin_ns;
    eng_worker_trace(worker, PCCD_TRACE_REFIT, begin_ns, eng_moving_count(worker->scene),
                     0);
}

bool eng_wide_refit_by_team(struct eng_team *team, struct eng_worker *worker)
{
    assert(team->shares >= 1 && worker->thread < team->shares);
    struct eng_wide *wide = eng_wide_of(team->scene);
    uint32_t vertices = eng_wide_refit_chunks(wide, PCCD_TREE_VERTICES);
    uint32_t all = eng_wide_refit_chunks(wide, PCCD_TREE_EDGES) +
                   eng_wide_refit_chunks(wide, PCCD_TREE_FACES);
    uint64_t begin_ns = common_now_ns();
    uint32_t made = make_chunks(team, worker, PCCD_TREE_VERTICES);
    /* Release: pairs with the acquire of the wait. */
    atomic_fetch_add_explicit(&team->refit.vertices_done, made, memory_order_acq_rel);
    record(worker, begin_ns);
    eng_wait_for(worker, &team->refit.vertices_done, vertices);
    begin_ns = common_now_ns();
    uint32_t done = make_chunks(team, worker, PCCD_TREE_EDGES);
    done += make_chunks(team, worker, PCCD_TREE_FACES);
    bool is_last = false;
    if (done > 0) {
        /* Release what we did; the last one acquires what all did. */
        uint32_t before =
            atomic_fetch_add_explicit(&team->refit.rest_done, done, memory_order_acq_rel);
        is_last = before + done == all;
    }
    if (is_last && !eng_stop_is_set(worker->stop)) {
        eng_wide_refit_above(wide);
    }
    record(worker, begin_ns);
    return is_last;
}
