/* fairqueue.h - a queue that gives every user an equal share of computing time, however
 * long each request takes.
 *
 * Order entries by virtual time. Entries that always have work get equal shares, whatever
 * a single piece of it costs; an entry that asks for little is next when it asks.
 *
 * Threads: [any], one at a time; the caller's lock.
 * Source: start-time fair queueing (Goyal, Vin, Cheng, SIGCOMM 1996), where a service is
 * charged when it has ended, with what it took: there is no estimate that could be wrong,
 * or lied about.
 *
 * Compared with deficit round robin, the shares are the same. But there an entry that has
 * just got work waits for the rest of a round; here it usually waits only for the one
 * that is being served. Adding and taking are O(log n) amortised.
 */
#ifndef SRV_FAIRQUEUE_H
#define SRV_FAIRQUEUE_H

#include <stdbool.h>
#include <stdint.h>

/* All zero: has had nothing and is not queued. */
struct srv_fair {
    struct srv_fair *child; /* pairing heap; links are NULL while not queued */
    struct srv_fair *next;
    struct srv_fair *prev; /* the sibling before, or the parent of a first child */
    uint64_t start_ns;     /* virtual time up to which it has been served: the order */
    uint64_t number;       /* of its arrival: the order of equal ones; 0: never came */
    bool queued;
};

struct srv_fairqueue {
    struct srv_fair *root;
    uint32_t count;
    uint64_t clock_ns; /* virtual time: where those start who come for the first time */
    uint64_t number;
};

/* What is kept for an entry that it has not asked for while others waited. With it, one
 * that asks for little is before those who take all they can get, also when these are
 * close to each other. */
#define SRV_FAIR_KEPT_NS 100000000u

/* `entry`, not queued, has work. */
void srv_fair_push(struct srv_fairqueue *queue, struct srv_fair *entry);

/* Take out the one that is next; the queue is not empty. */
struct srv_fair *srv_fair_take(struct srv_fairqueue *queue);

/* Take a queued entry out, wherever it is: it has no work any more. */
void srv_fair_remove(struct srv_fairqueue *queue, struct srv_fair *entry);

/* The service of `entry`, which is not queued, took cost_ns. Before it is pushed again.
 * When nobody waits, all accounts are settled. */
void srv_fair_charge(struct srv_fairqueue *queue, struct srv_fair *entry,
                     uint64_t cost_ns);

#endif
