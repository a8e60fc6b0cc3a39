/* sim_refit.c - eng_refit_by_team, replayed. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report.h"
#include "sim.h"

enum stage { VERTICES, ROOTS, CLIMBING, EDGES, DONE };

struct refitting {
    struct sim *sim;
    const struct model_refit *refit;
    enum stage stage[MODEL_THREADS_MAX];
    uint32_t turn[MODEL_THREADS_MAX]; /* roots that were dealt to it, done */
    uint32_t root[MODEL_THREADS_MAX]; /* CLIMBING: its subtree ends now */
    uint32_t next_vertices;
    uint32_t next_root;
    uint32_t next_edges;
    double vertices_end; /* of the last chunk that was taken */
    struct sim_line vertices_line, done_line, root_line, edges_line, rest_line;
    uint32_t *unfinished;
    struct sim_line *unfinished_lines;
};

static double use(struct refitting *r, struct sim_line *line, uint32_t thread)
{
    struct sim_thread *at = &r->sim->threads[thread];
    at->now = sim_line_use(r->sim, line, thread, at->now);
    return at->now;
}

static void vertices(struct refitting *r, uint32_t thread)
{
    struct sim_thread *at = &r->sim->threads[thread];
    const struct eng_refit_plan *plan = &r->refit->plan;
    use(r, &r->vertices_line, thread);
    if (r->next_vertices < plan->vertices.count) {
        r->next_vertices++;
        sim_work(at, r->sim->input->record->vertices_ns / plan->vertices.count);
        r->vertices_end = fmax(r->vertices_end, use(r, &r->done_line, thread));
        return;
    }
    if (r->vertices_end > at->now) { /* it sees the last one end */
        at->now = r->vertices_end + r->sim->input->machine->transfer;
    }
    r->stage[thread] = ROOTS;
}

static void take_root(struct refitting *r, uint32_t thread)
{
    const struct eng_refit_plan *plan = &r->refit->plan;
    uint32_t root = thread + r->turn[thread] * r->sim->count;
    if (root < plan->dealt) {
        r->turn[thread]++;
    } else {
        use(r, &r->root_line, thread);
        root = plan->dealt + r->next_root++;
    }
    if (root >= plan->root_count) {
        r->stage[thread] = EDGES;
        return;
    }
    sim_work(&r->sim->threads[thread], r->refit->root_ns[root]);
    r->root[thread] = root;
    r->stage[thread] = CLIMBING;
}

static void climb(struct refitting *r, uint32_t thread)
{
    const struct eng_refit_plan *plan = &r->refit->plan;
    uint32_t up = plan->root_parent[r->root[thread]];
    r->stage[thread] = ROOTS;
    while (up != ENG_NO_NODE) {
        use(r, &r->unfinished_lines[up], thread);
        if (--r->unfinished[up] > 0) {
            return;
        }
        sim_work(&r->sim->threads[thread], r->refit->node_ns);
        up = plan->opened_parent[up];
    }
}

static void edges(struct refitting *r, uint32_t thread)
{
    const struct eng_refit_plan *plan = &r->refit->plan;
    use(r, &r->edges_line, thread);
    if (r->next_edges < plan->edges.count) {
        r->next_edges++;
        sim_work(&r->sim->threads[thread],
                 r->sim->input->record->edges_ns / plan->edges.count);
        return;
    }
    use(r, &r->rest_line, thread);
    r->stage[thread] = DONE;
}

static bool next_event(struct refitting *r)
{
    uint32_t first = UINT32_MAX;
    for (uint32_t i = 0; i < r->sim->count; i++) {
        if (r->stage[i] != DONE &&
            (first == UINT32_MAX ||
             r->sim->threads[i].now < r->sim->threads[first].now)) {
            first = i;
        }
    }
    if (first == UINT32_MAX) {
        return false;
    }
    switch (r->stage[first]) {
    case VERTICES:
        vertices(r, first);
        break;
    case ROOTS:
        take_root(r, first);
        break;
    case CLIMBING:
        climb(r, first);
        break;
    default:
        edges(r, first);
        break;
    }
    return true;
}

void sim_refit(struct sim *sim)
{
    const struct model_division *division = sim->input->division;
    const struct sim_line fresh = {0, UINT32_MAX};
    struct refitting r = {.sim = sim,
                          .refit = &division->refit[sim->input->refit],
                          .vertices_line = fresh,
                          .done_line = fresh,
                          .root_line = fresh,
                          .edges_line = fresh,
                          .rest_line = fresh};
    uint32_t opened = r.refit->plan.opened_count;
    r.unfinished = bench_alloc(opened, sizeof *r.unfinished);
    r.unfinished_lines = bench_alloc(opened, sizeof *r.unfinished_lines);
    for (uint32_t i = 0; i < opened; i++) {
        r.unfinished[i] = 2;
        r.unfinished_lines[i] = fresh;
    }
    while (next_event(&r)) {
    }
    free(r.unfinished);
    free(r.unfinished_lines);
    double end = sim_latest(sim);
    for (uint32_t i = 0; i < sim->count; i++) {
        if (sim->threads[i].now >= end) {
            sim->refit_thread = i;
        }
    }
    if (sim->input->scheduler == ENG_SCHEDULER_PAPER) {
        end += division->begin_ns;
    }
    for (uint32_t i = 0; i < sim->count; i++) {
        sim->threads[i].now = end + sim->input->machine->transfer;
    }
}
