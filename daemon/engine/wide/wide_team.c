/* daemon/engine/wide/wide_team.c - the boxes of wide trees by all threads of a step.
 *
 * Room:     engine.
 * Does:     chunks of vertices on demand; when all are done, which need not mean that all
 *           threads are there, chunks of edges and faces with the first level above them;
 *           whoever ends last makes the few boxes above those.
 * Threads:  [team].
 */
#include "wide_team.h"

#include "wide.h"
#include "world.h"

/* Relaxed: what is taken was made before the region. */
static uint32_t next(atomic_uint *counter)
{
    return atomic_fetch_add_explicit(counter, 1, memory_order_relaxed);
}

/* Chunks of a step that is stopped count as done: nobody searches their boxes. */
static void vertices_by_team(struct eng_team *team, struct eng_worker *worker,
                             uint32_t chunks)
{
    struct eng_refit_progress *progress = &team->refit;
    for (uint32_t i = next(&progress->next_vertices); i < chunks;
         i = next(&progress->next_vertices)) {
        if (!eng_worker_should_stop(worker)) {
            eng_wide_refit_chunk(&team->scene->wide, team->scene, ENG_WIDE_VERTICES, i,
                                 false);
        }
        /* Release: pairs with the acquire of the wait. */
        atomic_fetch_add_explicit(&progress->vertices_done, 1, memory_order_acq_rel);
    }
}

/* Chunks of edges, then of faces, that this thread has done. */
static uint32_t features_by_team(struct eng_team *team, struct eng_worker *worker,
                                 uint32_t edges, uint32_t chunks)
{
    uint32_t done = 0;
    for (uint32_t i = next(&team->refit.next_edges); i < chunks;
         i = next(&team->refit.next_edges)) {
        if (!eng_worker_should_stop(worker)) {
            eng_wide_refit_chunk(&team->scene->wide, team->scene,
                                 i < edges ? ENG_WIDE_EDGES : ENG_WIDE_FACES,
                                 i < edges ? i : i - edges, false);
        }
        done++;
    }
    return done;
}

/* A part of the refit that began at `begin_ns`. */
static void record(struct eng_worker *worker, uint64_t begin_ns)
{
    worker->record.refit_ns += eng_now_ns() - begin_ns;
    eng_worker_trace(worker, ENG_TRACE_REFIT, begin_ns, 0, 0);
}

bool eng_wide_refit_by_team(struct eng_team *team, struct eng_worker *worker)
{
    struct eng_wide *wide = &team->scene->wide;
    uint32_t vertices = eng_wide_refit_chunks(wide, ENG_WIDE_VERTICES);
    uint32_t edges = eng_wide_refit_chunks(wide, ENG_WIDE_EDGES);
    uint32_t all = edges + eng_wide_refit_chunks(wide, ENG_WIDE_FACES);
    uint64_t begin_ns = eng_now_ns();
    vertices_by_team(team, worker, vertices);
    record(worker, begin_ns);
    eng_worker_wait_for(worker, &team->refit.vertices_done, vertices);
    begin_ns = eng_now_ns();
    uint32_t done = features_by_team(team, worker, edges, all);
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
