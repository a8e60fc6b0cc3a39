/* fairqueue.c - whose turn it is: weighted by what each has had. */
#include "turns.h"

#include <stddef.h>

#include "invariant.h"

/* ---- the heap ---------------------------------------------------------------------- */

static bool is_before(const struct srv_fair *a, const struct srv_fair *b)
{
    return a->start_ns != b->start_ns ? a->start_ns < b->start_ns : a->number < b->number;
}

/* Two heaps become one. Neither has siblings. */
static struct srv_fair *meld(struct srv_fair *a, struct srv_fair *b)
{
    if (a == NULL || b == NULL) {
        return a == NULL ? b : a;
    }
    if (is_before(b, a)) {
        struct srv_fair *later = a;
        a = b;
        b = later;
    }
    b->next = a->child;
    if (b->next != NULL) {
        b->next->prev = b;
    }
    b->prev = a;
    a->child = b;
    return a;
}

/* The children of a node that goes become one heap: melded in pairs from the first on,
 * then the pairs from the last on. That order makes it O(log n) amortised. */
static struct srv_fair *meld_children(struct srv_fair *child)
{
    struct srv_fair *pairs = NULL; /* the last one first, linked by `next` */
    while (child != NULL) {
        struct srv_fair *a = child;
        struct srv_fair *b = child->next;
        child = b != NULL ? b->next : NULL;
        a->next = a->prev = NULL;
        if (b != NULL) {
            b->next = b->prev = NULL;
        }
        a = meld(a, b);
        a->next = pairs;
        pairs = a;
    }
    struct srv_fair *root = NULL;
    while (pairs != NULL) {
        struct srv_fair *next = pairs->next;
        pairs->next = NULL;
        root = meld(pairs, root);
        pairs = next;
    }
    return root;
}

/* Cut a node that is not the root out of the list of its parent's children. */
static void cut(struct srv_fair *entry)
{
    if (entry->prev->child == entry) {
        entry->prev->child = entry->next;
    } else {
        entry->prev->next = entry->next;
    }
    if (entry->next != NULL) {
        entry->next->prev = entry->prev;
    }
}

/* ---- the queue --------------------------------------------------------------------- */

void srv_fair_push(struct srv_fairqueue *queue, struct srv_fair *entry)
{
    PCCD_ASSERT(!entry->queued);
    /* Who comes for the first time starts from the clock on: with something kept, those
     * who come once and never again would always be first. */
    uint64_t kept_ns = entry->number > 0 ? SRV_FAIR_KEPT_NS : 0;
    uint64_t from_ns = queue->clock_ns > kept_ns ? queue->clock_ns - kept_ns : 0;
    if (entry->start_ns < from_ns) {
        entry->start_ns = from_ns;
    }
    entry->child = entry->next = entry->prev = NULL;
    entry->number = ++queue->number;
    entry->queued = true;
    queue->root = meld(queue->root, entry);
    queue->count++;
}

void srv_fair_remove(struct srv_fairqueue *queue, struct srv_fair *entry)
{
    PCCD_ASSERT(entry->queued && queue->count > 0);
    struct srv_fair *below = meld_children(entry->child);
    if (entry == queue->root) {
        queue->root = below;
    } else {
        cut(entry);
        queue->root = meld(queue->root, below);
    }
    entry->child = entry->next = entry->prev = NULL;
    entry->queued = false;
    queue->count--;
}

static void advance(struct srv_fairqueue *queue, uint64_t to_ns)
{
    queue->clock_ns = to_ns > queue->clock_ns ? to_ns : queue->clock_ns;
}

struct srv_fair *srv_fair_take(struct srv_fairqueue *queue)
{
    struct srv_fair *entry = queue->root;
    PCCD_ASSERT(entry != NULL);
    srv_fair_remove(queue, entry);
    advance(queue, entry->start_ns);
    return entry;
}

void srv_fair_charge(struct srv_fairqueue *queue, struct srv_fair *entry,
                     uint64_t cost_ns)
{
    PCCD_ASSERT(!entry->queued);
    entry->start_ns += cost_ns;
    if (queue->root == NULL) {
        advance(queue, entry->start_ns);
    } else {
        /* It goes with every service, shared by all, or newcomers without end would be
         * first for ever; but not away from those who wait. */
        uint64_t shared_ns = queue->clock_ns + cost_ns / (queue->count + 1);
        uint64_t most_ns = queue->root->start_ns + SRV_FAIR_KEPT_NS;
        advance(queue, shared_ns < most_ns ? shared_ns : most_ns);
    }
}
