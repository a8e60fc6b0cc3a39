/* finding.c - what a thread does with what its tests find. */
#include "finding.h"

#include <assert.h>
#include <string.h>

void eng_test_keep(struct eng_worker *worker, const struct pccd_pair *name,
                   const struct eng_hit *hit)
{
    assert(hit->toi <= hit->toi_hi); /* a bracket, NaN in neither end */
    if (worker->question->mode == PCCD_MODE_ANY) {
        if (hit->flags & PCCD_PROVED) {
            worker->proved_seen++;
            worker->proof = *name;
            atomic_store_explicit(&worker->stop->stopped, true, memory_order_relaxed);
        } else {
            worker->possible_seen++;
        }
        return;
    }
    if (worker->question->mode == PCCD_MODE_FIRST && (hit->flags & PCCD_PROVED)) {
        eng_worker_tighten(worker, hit->toi_hi);
    }
    struct pccd_contact *contact = eng_found_add(&worker->found, name);
    if (!contact) {
        return;
    }
    contact->flags = hit->flags;
    contact->toi = hit->toi;
    contact->toi_hi = hit->toi_hi;
    memcpy(contact->param, hit->param, sizeof contact->param);
    memcpy(contact->normal, hit->normal, sizeof contact->normal);
    contact->reserved = 0;
}

void eng_test_count(struct eng_worker *worker, enum pccd_kind kind, uint32_t candidates)
{
    assert(kind < PCCD_KINDS_MAX);
    worker->tally.candidates[kind] += candidates;
}

void eng_test_end(struct eng_worker *worker, enum pccd_kind kind, uint32_t tested,
                  uint64_t begin_ns)
{
    assert(begin_ns > 0);
    uint64_t end_ns = common_now_ns();
    worker->record.tests_ns += end_ns - begin_ns;
    if (tested > 0) {
        eng_worker_trace_until(worker, PCCD_TRACE_TESTS, begin_ns, end_ns, kind, tested);
    }
}
