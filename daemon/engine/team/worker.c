/* worker.c - what one thread of a step owns. */
#include "worker.h"

#include <assert.h>
#include <string.h>

#include "aabb.h"
#include "kernel.h"
#include "question.h"

/* By this much more than the tolerance a contact may begin after its toi. */
#define BEGINS_LATER 0x1p-48

int eng_worker_init(struct eng_worker *worker)
{
    memset(worker, 0, sizeof *worker);
    eng_deque_init(&worker->deque);
    return eng_exact_init(&worker->exact);
}

void eng_worker_deinit(struct eng_worker *worker)
{
    eng_exact_deinit(&worker->exact);
    eng_per_pair_deinit(&worker->firsts);
    for (int i = 0; i < PCCD_METHOD_COUNT; i++) {
        assert(!worker->work[i]);
    }
    assert(!worker->narrow && !worker->turning);
}

void eng_worker_begin(struct eng_worker *worker, struct eng_scene *scene,
                      const struct eng_question *question, struct eng_stop *stop,
                      struct eng_pool *pool)
{
    assert(scene && question && stop && pool);
    assert(question->tolerance > 0 && question->mode < PCCD_MODE_COUNT);
    worker->scene = scene;
    worker->question = question;
    worker->kernels = question->kernels ? question->kernels : eng_kernels();
    worker->stop = stop;
    worker->time_bound = 1;
    worker->box_bound = 1;
    worker->prunes = false;
    worker->exact.queries = 0;
    worker->low_end_ns = 0;
    worker->possible_seen = 0;
    worker->proved_seen = 0;
    memset(&worker->record, 0, sizeof worker->record);
    memset(&worker->tally, 0, sizeof worker->tally);
    eng_found_begin(&worker->found, pool,
                    question->mode == PCCD_MODE_PAIRS ? sizeof(struct pccd_pair)
                                                      : sizeof(struct pccd_contact),
                    question->contact_max);
    worker->found.folds = question->verb == PCCD_NEAR_FEATURES;
    worker->found.is_of_earliest = question->mode == PCCD_MODE_FIRST;
    eng_per_pair_begin(&worker->firsts);
}

void eng_stop_init(struct eng_stop *stop, const struct eng_question *question)
{
    const double whole_step = 1;
    uint64_t bits;
    memcpy(&bits, &whole_step, sizeof bits);
    atomic_init(&stop->barrier.arrived, 0);
    atomic_init(&stop->barrier.round, 0);
    stop->cancel = question->cancel;
    stop->is_stopped = question->is_stopped;
    stop->asked = question->asked;
    stop->deadline_ns = question->deadline_ns;
    atomic_init(&stop->reason, PCCD_COMPLETE);
    atomic_init(&stop->stopped, false);
    stop->gave_up = false;
    atomic_init(&stop->time_bound, bits);
}

static void stop_for(struct eng_stop *stop, enum pccd_incomplete reason)
{
    atomic_store_explicit(&stop->reason, reason, memory_order_relaxed);
    atomic_store_explicit(&stop->stopped, true, memory_order_relaxed);
}

double eng_stop_time_bound(const struct eng_stop *stop)
{
    uint64_t bits = atomic_load_explicit(&stop->time_bound, memory_order_relaxed);
    double bound;
    memcpy(&bound, &bits, sizeof bound);
    return bound;
}

/* Take over the bound that others have found. */
static void look_at_bound(struct eng_worker *worker)
{
    double bound = eng_stop_time_bound(worker->stop);
    if (bound < worker->time_bound) {
        const struct eng_question *question = worker->question;
        bool is_part = eng_asks_part(question);
        double part_bound = is_part ? eng_part_time(question, bound) : bound;
        double tolerance = is_part ? eng_part_tolerance(question) : question->tolerance;
        worker->time_bound = bound;
        /* A record is kept for its toi, and the contact begins later by less than the
         * length of its bracket: the tolerance, and 16 u = 2^-49 where exact arithmetic
         * has rounded outward (elementary/BOUNDS.md, the T of the bracket kernel). So
         * the boxes must let it through, however soon the bound was known; the other
         * 2^-49 is for the rounding of this sum, 2^-51 at most. */
        worker->box_bound = eng_round_up(part_bound + tolerance + BEGINS_LATER);
    }
}

/* The first thread of a team is the one that called. */
static bool is_cancelled(const struct eng_worker *worker)
{
    const struct eng_stop *stop = worker->stop;
    return (stop->cancel && atomic_load_explicit(stop->cancel, memory_order_relaxed)) ||
           (stop->is_stopped && worker->thread == 0 && stop->is_stopped(stop->asked));
}

/* Set the stop if there is a reason, `ns` from now. */
static void look_for_reason(struct eng_worker *worker, uint64_t ns)
{
    struct eng_stop *stop = worker->stop;
    if (is_cancelled(worker)) {
        stop_for(stop, PCCD_INCOMPLETE_CANCELLED);
    } else if (stop->deadline_ns != 0 && common_now_ns() + ns >= stop->deadline_ns) {
        stop_for(stop, PCCD_INCOMPLETE_DEADLINE);
    }
}

bool eng_worker_should_stop(struct eng_worker *worker)
{
    struct eng_stop *stop = worker->stop;
    look_at_bound(worker);
    if (!eng_stop_is_set(stop)) {
        look_for_reason(worker, 0);
    }
    return eng_stop_is_set(stop);
}

bool eng_worker_is_late(struct eng_worker *worker, uint64_t ns)
{
    struct eng_stop *stop = worker->stop;
    if (!eng_stop_is_set(stop)) {
        look_for_reason(worker, ns);
    }
    return eng_stop_is_set(stop) &&
           atomic_load_explicit(&stop->reason, memory_order_relaxed) != PCCD_COMPLETE;
}

void eng_worker_ask(struct eng_worker *worker)
{
    struct eng_stop *stop = worker->stop;
    if (stop->is_stopped && !eng_stop_is_set(stop) && is_cancelled(worker)) {
        stop_for(stop, PCCD_INCOMPLETE_CANCELLED);
    }
}

void eng_worker_stop(struct eng_worker *worker, enum pccd_incomplete reason)
{
    stop_for(worker->stop, reason);
}

void eng_worker_lack(struct eng_worker *worker, enum pccd_incomplete reason)
{
    int complete = PCCD_COMPLETE;
    atomic_compare_exchange_strong_explicit(&worker->stop->reason, &complete, (int)reason,
                                            memory_order_relaxed, memory_order_relaxed);
}

void eng_worker_give_up(struct eng_worker *worker)
{
    assert(worker->question->brief);
    worker->stop->gave_up = true;
    atomic_store_explicit(&worker->stop->stopped, true, memory_order_relaxed);
}

void eng_worker_tighten(struct eng_worker *worker, double time)
{
    uint64_t mine;
    memcpy(&mine, &time, sizeof mine);
    uint64_t bound =
        atomic_load_explicit(&worker->stop->time_bound, memory_order_relaxed);
    while (mine < bound && !atomic_compare_exchange_weak_explicit(
                               &worker->stop->time_bound, &bound, mine,
                               memory_order_relaxed, memory_order_relaxed)) {
    }
    look_at_bound(worker);
}

void eng_worker_waited(struct eng_worker *worker, uint64_t begin_ns)
{
    assert(begin_ns > 0);
    uint64_t end_ns = common_now_ns();
    worker->record.wait_ns += end_ns - begin_ns;
    eng_worker_trace_until(worker, PCCD_TRACE_WAIT, begin_ns, end_ns, 0, 0);
}

/* ---- what a test found ------------------------------------------------------------- */

/* Mode first-per-pair: it may be the first of its two objects. */
static void keep_first(struct eng_worker *worker, const struct pccd_pair *name,
                       const struct eng_hit *hit)
{
    const struct pccd_contact contact = {
        .kind = name->kind,
        .flags = hit->flags,
        .object_a = name->object_a,
        .feature_a = name->feature_a,
        .object_b = name->object_b,
        .feature_b = name->feature_b,
        .toi = hit->toi,
        .toi_hi = hit->toi_hi,
        .param = {hit->param[0], hit->param[1]},
        .normal = {hit->normal[0], hit->normal[1], hit->normal[2]}};
    if (eng_per_pair_add(&worker->firsts, &contact) != PCCD_OK) {
        worker->found.overflowed = true;
    }
}

void eng_record_contact(struct eng_worker *worker, const struct pccd_pair *name,
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
    if (worker->question->mode == PCCD_MODE_FIRST_PER_PAIR) {
        keep_first(worker, name, hit);
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

void eng_count_candidates(struct eng_worker *worker, enum pccd_kind kind,
                          uint32_t candidates)
{
    assert(kind < PCCD_KINDS_MAX);
    worker->tally.candidates[kind] += candidates;
}

void eng_count_test_time(struct eng_worker *worker, enum pccd_kind kind, uint32_t tested,
                         uint64_t begin_ns)
{
    assert(begin_ns > 0);
    uint64_t end_ns = common_now_ns();
    worker->record.tests_ns += end_ns - begin_ns;
    if (tested > 0) {
        eng_worker_trace_until(worker, PCCD_TRACE_TESTS, begin_ns, end_ns, kind, tested);
    }
}
