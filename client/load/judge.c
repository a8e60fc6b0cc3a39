/* judge.c - judges whether it is the answer. */
#include "actor.h"

#include <string.h>

#include "printable.h"

#define LATE_NS 1000000u

static uint64_t add_bytes(uint64_t sum, const void *record, size_t bytes)
{
    for (size_t i = 0; i < bytes; i += sizeof sum) {
        uint64_t word = 0;
        size_t left = bytes - i;
        memcpy(&word, (const char *)record + i, left < sizeof word ? left : sizeof word);
        sum = load_mix(sum, word);
    }
    return sum;
}

_Static_assert(sizeof(struct pccd_near) == sizeof(struct pccd_contact) &&
                   offsetof(struct pccd_near, object_b) ==
                       offsetof(struct pccd_contact, object_b),
               "records name objects in the same places");

/* Over all records. Objects by whether they are the sheet: one that is made anew has
 * another number. Bounds name none. */
static uint64_t sum_of(const struct load_actor *actor, const struct pccd_answer *answer)
{
    uint64_t sum = answer->count;
    for (uint64_t i = 0; i < answer->count; i++) {
        struct pccd_contact record;
        if (answer->is_near && answer->what == PCCD_NEAR_VERTICES) {
            sum = add_bytes(sum, &answer->vertex_bounds[i], sizeof(double));
        } else if (!answer->is_near && answer->mode == PCCD_MODE_PAIRS) {
            sum = add_bytes(sum, &answer->pairs[i], sizeof answer->pairs[i]);
        } else {
            memcpy(&record,
                   answer->is_near ? (const void *)&answer->near[i]
                                   : &answer->contacts[i],
                   sizeof record);
            record.object_a = record.object_a == actor->sheet;
            record.object_b = record.object_b == actor->sheet;
            sum = add_bytes(sum, &record, sizeof record);
        }
    }
    return sum;
}

static bool is_same(const struct load_truth *a, const struct load_truth *b)
{
    return a->hash[0] == b->hash[0] && a->hash[1] == b->hash[1] && a->sum == b->sum;
}

/* Return whether it is the answer to some other request of the run. */
static bool is_known(const struct load *load, const struct load_truth *found)
{
    uint64_t count = load_truth_count(&load->settings);
    for (uint64_t i = 0; i < count; i++) {
        if (is_same(&load->shared->truth[i], found)) {
            return true;
        }
    }
    return false;
}

/* In the open loop a request that could not be submitted when it was due has waited since
 * then: else a client that is held up would ask less, and all would seem well. */
static void measure(struct load_actor *actor, const struct load_pending *pending,
                    const struct pccd_answer *answer)
{
    const struct load_settings *settings = &actor->load->settings;
    bool is_open = settings->hz > 0;
    uint64_t begin_ns = is_open ? pending->due_ns : pending->sent_ns;
    if (begin_ns < load_measured_from_ns(actor->load)) {
        return;
    }
    uint64_t latency_ns = common_now_ns() - begin_ns;
    actor->tally->measured++;
    actor->tally->late += is_open && pending->sent_ns - pending->due_ns >= LATE_NS;
    actor->tally->missed +=
        settings->deadline_ms > 0 && (double)latency_ns > 1e6 * settings->deadline_ms;
    load_hist_add(&actor->tally->latency, latency_ns);
    load_hist_add(&actor->tally->inside, answer->times.queue + answer->times.step);
}

/* The answer to a frame that was held, alone: its step's records are another client's. */
static bool is_without_records(const struct load_actor *actor,
                               const struct pccd_answer *answer)
{
    return actor->kind == LOAD_SHARE && answer->count == 0 &&
           answer->incomplete == PCCD_INCOMPLETE_RESULT_FULL;
}

/* Expect nothing of what may meet nothing. */
static void expect_nothing(struct load_actor *actor, const struct load_pending *pending,
                           const struct pccd_answer *answer)
{
    actor->tally->answered++;
    measure(actor, pending, answer);
    if (answer->total > 0) {
        actor->tally->wrong++;
        load_say("client %u: step %llu has %llu records of what may meet nothing",
                 actor->number, (unsigned long long)answer->step,
                 (unsigned long long)answer->total);
    }
}

/* It began while the daemon was lost: what it added then has got a place aside. */
static bool is_renumbered(const struct load_actor *actor)
{
    const uint32_t place = (1u << 20) - 1;
    return actor->kind == LOAD_SHARE && ((actor->floor & place) >= LOAD_ORDERS ||
                                         (actor->sheet & place) >= LOAD_ORDERS);
}

static void compare(struct load_actor *actor, const struct load_pending *pending,
                    const struct pccd_answer *answer)
{
    struct load_truth *truth = load_truth_of(actor->load, actor->number,
                                             actor->sheet < actor->floor, pending->from);
    struct load_truth found = {{answer->hash[0], answer->hash[1]}, sum_of(actor, answer)};
    if (is_without_records(actor, answer)) {
        found.sum = truth->sum;
    }
    actor->tally->answered++;
    actor->tally->records += answer->count;
    actor->tally->nears += answer->is_near;
    if (actor->is_alone) {
        *truth = found;
        return;
    }
    measure(actor, pending, answer);
    if (actor->kind == LOAD_CHURN || is_renumbered(actor)) {
        /* the hash knows the objects' numbers */
        memcpy(found.hash, truth->hash, sizeof found.hash);
    }
    if (is_same(truth, &found)) {
        return;
    }
    if (is_known(actor->load, &found)) {
        actor->tally->crossed++;
    } else {
        actor->tally->wrong++;
    }
    char texts[2][PROTO_HASH_BYTES];
    load_say("client %u: step %llu from position %u has %llu records of hash %s, not %s; "
             "objects %u and %u",
             actor->number, (unsigned long long)answer->step, pending->from,
             (unsigned long long)answer->total,
             proto_hash_text(PCCD_HASH_VERSION, found.hash, texts[0]),
             proto_hash_text(PCCD_HASH_VERSION, truth->hash, texts[1]), actor->floor,
             actor->sheet);
}

static void judge_of(struct load_actor *actor, const struct load_pending *pending,
                     const struct pccd_answer *answer)
{
    bool may_end_early =
        (pending->mischief == LOAD_CANCELLED &&
         (answer->status == PCCD_E_CANCELLED ||
          answer->incomplete == PCCD_INCOMPLETE_CANCELLED)) ||
        (pending->mischief == LOAD_DUE && answer->incomplete == PCCD_INCOMPLETE_DEADLINE);
    if (pending->mischief == LOAD_NOT_FINITE && answer->status == PCCD_E_NOTFINITE) {
        actor->tally->refused++;
    } else if (may_end_early) {
        actor->tally->cancelled++;
    } else if (answer->status != 0 || (!is_without_records(actor, answer) &&
                                       (answer->incomplete != PCCD_COMPLETE ||
                                        answer->count != answer->total))) {
        actor->tally->failed++;
        load_say("client %u: step %llu: status %d, incomplete %d: %s", actor->number,
                 (unsigned long long)answer->step, answer->status, answer->incomplete,
                 pccd_error_text(actor->client));
    } else if (pending->mischief == LOAD_MASKED) {
        expect_nothing(actor, pending, answer);
    } else {
        compare(actor, pending, answer);
    }
}

/* Take the request with that number out of those that wait. */
static bool find_pending(struct load_actor *actor, uint64_t step,
                         struct load_pending *found)
{
    for (uint32_t i = 0; i < actor->pending_count; i++) {
        if (actor->pending[i].step == step) {
            *found = actor->pending[i];
            actor->pending_count--;
            memmove(&actor->pending[i], &actor->pending[i + 1],
                    (actor->pending_count - i) * sizeof *found);
            return true;
        }
    }
    if (step <= actor->last_step) {
        actor->tally->doubled++;
    } else {
        actor->tally->crossed++;
    }
    load_say("client %u: an answer to step %llu, which does not wait for one",
             actor->number, (unsigned long long)step);
    return false;
}

void load_judge(struct load_actor *actor, const struct pccd_answer *answer)
{
    struct load_pending pending;
    if (find_pending(actor, answer->step, &pending)) {
        judge_of(actor, &pending, answer);
    }
}

/* Return what a batch says of one scene, as an answer to a step of it. */
static struct pccd_answer answer_of(const struct pccd_batch_answer *all, uint64_t i)
{
    const struct pccd_scene_answer *scene = &all->scenes[i];
    struct pccd_answer answer = {
        .step = all->step + i,
        .status = scene->status,
        .mode = all->mode,
        .incomplete = (enum pccd_incomplete)scene->incomplete,
        .contacts = pccd_batch_contacts(all, i),
        .pairs = pccd_batch_pairs(all, i),
        .count = scene->count,
        .total = scene->total,
        .times = {.queue = all->queue_ns, .step = all->batch_ns}};
    memcpy(answer.hash, scene->hash, sizeof answer.hash);
    return answer;
}

void load_judge_batch(struct load_actor *actor, const struct pccd_batch_answer *all)
{
    uint32_t count = actor->load->settings.batch;
    struct load_pending pending;
    if (!find_pending(actor, all->step, &pending)) {
        return;
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct pccd_answer refused = {.step = all->step + i, .status = all->status};
        const struct pccd_answer answer = all->status == 0 ? answer_of(all, i) : refused;
        struct load_pending own = pending;
        if (pending.mischief == LOAD_NOT_FINITE && i + 1 < count) {
            own.mischief = LOAD_PLAIN; /* written to the last one only */
        }
        judge_of(actor, &own, &answer);
    }
}
