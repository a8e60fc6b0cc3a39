/* sim_wide.c - eng_wide_refit_by_team, replayed.
 *
 * Chunks of vertices, then of edges and faces, one's own share first, then what is left
 * of others'; the last thread to end makes the boxes above them, deals out the first
 * tasks and lets the others go.
 */
#include <math.h>
#include <string.h>

#include "sim.h"

enum stage { VERTICES, WAITING, EDGES, FACES, DONE };

struct refitting {
    struct sim *sim;
    const struct model_wide *wide;
    enum stage stage[MODEL_THREADS_MAX];
    uint32_t looked[MODEL_THREADS_MAX]; /* shares that it found empty in this stage */
    uint32_t made[MODEL_THREADS_MAX];   /* chunks, since it said so last */
    struct eng_range share[ENG_WIDE_TREES][MODEL_THREADS_MAX];
    struct sim_line line[ENG_WIDE_TREES][MODEL_THREADS_MAX];
    struct sim_line done_line;
    uint32_t vertices_left; /* chunks that nobody has said to be done */
    uint32_t rest_left;
    double vertices_end;
    double end; /* of the refit */
};

static enum pccd_tree kind_of(enum stage stage)
{
    return stage == VERTICES ? PCCD_TREE_VERTICES
           : stage == EDGES  ? PCCD_TREE_EDGES
                             : PCCD_TREE_FACES;
}

/* Nothing is left to take in this stage. */
static void end_stage(struct refitting *r, uint32_t thread)
{
    struct sim_thread *at = &r->sim->threads[thread];
    enum stage stage = r->stage[thread];
    r->looked[thread] = 0;
    r->stage[thread] = stage + 1;
    if (stage == EDGES) {
        return;
    }
    uint32_t made = r->made[thread];
    r->made[thread] = 0;
    at->now = sim_line_use(r->sim, &r->done_line, thread, at->now);
    if (stage == VERTICES) {
        r->vertices_left -= made;
        r->vertices_end = fmax(r->vertices_end, made > 0 ? at->now : 0);
        return;
    }
    r->rest_left -= made;
    if (made > 0 && r->rest_left == 0) {
        sim_work(at, r->wide->above_ns);
        r->end = at->now;
        r->sim->refit_thread = thread;
    }
}

static void take_chunk(struct refitting *r, uint32_t thread)
{
    struct sim_thread *at = &r->sim->threads[thread];
    enum pccd_tree kind = kind_of(r->stage[thread]);
    uint32_t owner = (thread + r->looked[thread]) % r->sim->count;
    struct eng_range *share = &r->share[kind][owner];
    if (share->count == 0) {
        at->now += owner == thread ? 0 : r->sim->input->machine->probe;
        if (++r->looked[thread] == r->sim->count) {
            end_stage(r, thread);
        }
        return;
    }
    at->now = sim_line_use(r->sim, &r->line[kind][owner], thread, at->now);
    sim_work(at, r->wide->chunk_ns[kind][share->first]);
    share->first++;
    share->count--;
    r->made[thread]++;
}

static bool next_event(struct refitting *r)
{
    uint32_t first = UINT32_MAX;
    for (uint32_t i = 0; i < r->sim->count; i++) {
        bool waits = r->stage[i] == WAITING && r->vertices_left > 0;
        if (r->stage[i] != DONE && !waits &&
            (first == UINT32_MAX ||
             r->sim->threads[i].now < r->sim->threads[first].now)) {
            first = i;
        }
    }
    if (first == UINT32_MAX) {
        return false;
    }
    if (r->stage[first] == WAITING) { /* it sees the last one end */
        struct sim_thread *at = &r->sim->threads[first];
        if (at->now < r->vertices_end) {
            at->now = r->vertices_end + r->sim->input->machine->transfer;
        }
        r->stage[first] = EDGES;
    } else {
        take_chunk(r, first);
    }
    return true;
}

void sim_refit_wide(struct sim *sim)
{
    static struct refitting r;
    const struct model_wide *wide = &sim->input->record->wide;
    memset(&r, 0, sizeof r);
    r.sim = sim;
    r.wide = wide;
    r.vertices_left = wide->chunk_count[PCCD_TREE_VERTICES];
    r.rest_left = wide->chunk_count[PCCD_TREE_EDGES] + wide->chunk_count[PCCD_TREE_FACES];
    for (int kind = 0; kind < ENG_WIDE_TREES; kind++) {
        for (uint32_t i = 0; i < sim->count; i++) {
            uint32_t count = wide->chunk_count[kind];
            uint32_t begin = eng_share_begin(count, i, sim->count);
            uint32_t end = eng_share_begin(count, i + 1, sim->count);
            r.share[kind][i] = (struct eng_range){begin, end - begin};
            r.line[kind][i].owner = UINT32_MAX;
        }
    }
    r.done_line.owner = UINT32_MAX;
    while (next_event(&r)) {
    }
    double released = r.end + wide->enter_ns + wide->deal_ns;
    for (uint32_t i = 0; i < sim->count; i++) {
        struct sim_thread *at = &sim->threads[i];
        double seen = fmax(at->now, released + sim->input->machine->transfer);
        at->now = i == sim->refit_thread ? released : seen + wide->enter_ns;
    }
}
