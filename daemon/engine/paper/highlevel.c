/* highlevel.c - the task units of high-level nodes.
 *
 * Source: paper section 5.1.
 *
 * Above the low-level nodes there are fewer task units than threads, so all threads work
 * on the same one, unit after unit.
 *
 * Round robin ("lazy reconstruction with a locking mechanism", the default): one thread
 * refines the pair of the node's children breadth-first; when there are enough pairs they
 * are dequeued and dealt out in turn, because pairs that are close in the queue are alike
 * and take about as long. Any two pairs may lead to the same node, so a node is locked
 * while it is reconstructed, which is rare: most were looked at by low-level task units.
 *
 * Disjoint ("lazy reconstruction without a locking mechanism"): of the four pairs that
 * (n, m) is refined to, (L(n), L(m)) and (R(n), R(m)) have no node in common, nor do
 * (L(n), R(m)) and (R(n), L(m)). Two threads take the first two, wait for each other, and
 * take the other two. Each of these pairs can be divided among twice as many threads in
 * the same way: with 2^d threads d levels are refined, and the 4^d pairs found there are
 * done in 2^d phases. In phase f thread t follows at level i the child b of n and the
 * child b ^ c of m, where b is bit i of t and c bit i of f: two threads part where their
 * b differ, with different children on both sides; all (b, c) of all levels make up all
 * pairs. A node that is a leaf stands for itself; with the children of the other shared
 * by both halves of the threads, one half goes on and takes the child c. Nodes are opened
 * through their gates all the same (rebuild.h); nobody ever waits at one, but on the way
 * down to where the threads part.
 *
 * Expect twice the speed of one thread from eight (the paper's figure) rather than eight
 * times: there are eight barriers a unit, at each of which all threads wait for the
 * slowest pair of its phase, and the boxes of two siblings overlap where the siblings
 * touch: most of the work is in few of the 64 pairs, in different phases and not at the
 * same time.
 */
#include "highlevel.h"

#include <assert.h>

#include "paper.h"
#include "rebuild.h"
#include "taskunit.h"
#include "wait.h"

static void perform_pair(struct eng_worker *worker, uint32_t n, uint32_t m)
{
    uint64_t begin_ns = eng_worker_slice(worker);
    eng_taskunit_pairs(worker, n, m);
    eng_worker_trace(worker, PCCD_TRACE_PAIRS, begin_ns, n, m);
}

void eng_highlevel_expand(struct eng_team *team, struct eng_worker *worker, uint32_t node)
{
    assert(node != ENG_NO_NODE);
    struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    const struct eng_node *opened = eng_node_open(worker, node);
    uint32_t wanted = ENG_PAIRS_PER_THREAD * team->count;
    uint32_t head = 0;
    uint64_t *pairs = assignment->pairs;
    pairs[0] = (uint64_t)opened->left << 32 | opened->right;
    assignment->pair_count = 1;
    while (assignment->pair_count - head > 0 && assignment->pair_count < wanted) {
        uint32_t n_out[4];
        uint32_t m_out[4];
        uint64_t pair = pairs[head++];
        uint32_t count = eng_taskunit_refine(worker, (uint32_t)(pair >> 32),
                                             (uint32_t)pair, n_out, m_out);
        for (uint32_t i = 0; i < count; i++) {
            pairs[assignment->pair_count++] = (uint64_t)n_out[i] << 32 | m_out[i];
        }
    }
    for (uint32_t i = head; i < assignment->pair_count; i++) {
        pairs[i - head] = pairs[i];
    }
    assignment->pair_count -= head;
}

/* A part of the unit that began at `begin_ns`. */
static void end_part(struct eng_worker *worker, uint32_t node, uint64_t begin_ns,
                     uint32_t pairs)
{
    uint64_t end_ns = common_now_ns();
    worker->record.high_ns += end_ns - begin_ns;
    eng_worker_trace_until(worker, PCCD_TRACE_HIGH, begin_ns, end_ns, node, pairs);
}

/* This thread's share of the pairs. */
static uint32_t perform_share(const struct eng_team *team, struct eng_worker *worker)
{
    const struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    uint32_t performed = 0;
    for (uint32_t k = worker->thread;
         k < assignment->pair_count && !eng_worker_should_stop(worker);
         k += team->count) {
        uint64_t pair = assignment->pairs[k];
        perform_pair(worker, (uint32_t)(pair >> 32), (uint32_t)pair);
        performed++;
    }
    return performed;
}

static void perform_round_robin(struct eng_team *team, struct eng_worker *worker,
                                uint32_t node)
{
    if (worker->thread == 0) {
        uint64_t begin_ns = common_now_ns();
        eng_highlevel_expand(team, worker, node);
        worker->record.high_ns += common_now_ns() - begin_ns;
    }
    eng_wait_for_all(worker);
    uint64_t begin_ns = common_now_ns();
    uint32_t performed = perform_share(team, worker);
    end_part(worker, node, begin_ns, performed);
    eng_wait_for_all(worker); /* the pairs make room for the next node's */
}

/* Follow the pair (n, m) of `level` one level down; false: there is nothing there for
 * this thread in this phase. A pair that several meet, in this phase or another, is
 * counted, or dealt with if it is two leaves, by the first thread in the first phase of
 * them. */
static bool descend(struct eng_worker *worker, uint32_t phase, uint32_t level,
                    uint32_t *n, uint32_t *m)
{
    uint32_t n_out[4];
    uint32_t m_out[4];
    uint32_t b = worker->thread >> level & 1u;
    uint32_t c = phase >> level & 1u;
    bool is_first = (worker->thread | phase) >> level == 0;
    uint32_t count = is_first ? eng_taskunit_refine(worker, *n, *m, n_out, m_out)
                              : eng_taskunit_peek(worker, *n, *m, n_out, m_out);
    if (count == 0 || (count == 2 && b == 1)) {
        return false;
    }
    uint32_t pick = count == 2 ? c : 2 * b + (b ^ c);
    *n = n_out[pick];
    *m = m_out[pick];
    return true;
}

uint32_t eng_highlevel_phase(struct eng_worker *worker, uint32_t node, uint32_t phase,
                             uint32_t levels)
{
    assert(phase < 1u << levels);
    const struct eng_node *opened = eng_node_open(worker, node);
    uint32_t n = opened->left;
    uint32_t m = opened->right;
    for (uint32_t level = 0; level < levels; level++) {
        if (!descend(worker, phase, level, &n, &m)) {
            return 0;
        }
    }
    perform_pair(worker, n, m);
    return 1;
}

uint32_t eng_highlevel_levels(uint32_t threads)
{
    assert(threads >= 1);
    uint32_t levels = 0;
    while (2u << levels <= threads) {
        levels++;
    }
    return levels;
}

static void perform_disjoint(struct eng_team *team, struct eng_worker *worker,
                             uint32_t node)
{
    uint32_t levels = eng_highlevel_levels(team->count);
    for (uint32_t phase = 0; phase < 1u << levels; phase++) {
        uint64_t begin_ns = common_now_ns();
        uint32_t performed = 0;
        if (worker->thread < 1u << levels && !eng_worker_should_stop(worker)) {
            performed = eng_highlevel_phase(worker, node, phase, levels);
        }
        end_part(worker, node, begin_ns, performed);
        eng_wait_for_all(worker); /* what comes next has nodes of all of these */
    }
}

void eng_highlevel_perform(struct eng_team *team, struct eng_worker *worker)
{
    const struct eng_assignment *assignment = &eng_paper_of(team->scene)->assignment;
    bool is_disjoint = worker->question->tuning.high_level == ENG_HIGH_LEVEL_DISJOINT;
    for (uint32_t i = assignment->high_count; i-- > 0;) {
        worker->record.task_units += worker->thread == 0;
        if (is_disjoint) {
            perform_disjoint(team, worker, assignment->high[i]);
        } else {
            perform_round_robin(team, worker, assignment->high[i]);
        }
    }
    uint64_t begin_ns = common_now_ns();
    eng_taskunit_flush(worker);
    worker->record.high_ns += common_now_ns() - begin_ns;
}
