/* turns.h - whose job runs next: users by turns, and the sessions of each.
 *
 * Threads: [any], one at a time; the compute queue's lock.
 */
#ifndef SRV_TURNS_H
#define SRV_TURNS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* ---- A queue that gives every user an equal share of computing time, however
 * long each request takes.
 *
 * Order entries by virtual time. Entries that always have work get equal shares, whatever
 * a single piece of it costs; an entry that asks for little is next when it asks.
 *
 * Compared with deficit round robin, the shares are the same. But there an entry that has
 * just got work waits for the rest of a round; here it usually waits only for the one
 * that is being served. Adding and taking are O(log n) amortised. */

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

/* The time that is kept for an entry that did not ask for it while others waited. With
 * it, one that asks for little is before those who take all they can get, also when these
 * are close to each other. */
#define SRV_FAIR_KEPT_NS 100000000u

/* Queue `entry`, which is not queued and has work. */
void srv_fair_push(struct srv_fairqueue *queue, struct srv_fair *entry);

/* Take out the one that is next; the queue is not empty. */
struct srv_fair *srv_fair_take(struct srv_fairqueue *queue);

/* Take a queued entry out, wherever it is: it has no work any more. */
void srv_fair_remove(struct srv_fairqueue *queue, struct srv_fair *entry);

/* Charge `entry`, which is not queued, for a service that took cost_ns, before it is
 * pushed again. When nobody waits, all accounts are settled. */
void srv_fair_charge(struct srv_fairqueue *queue, struct srv_fair *entry,
                     uint64_t cost_ns);

/* A thing that two jobs must not use at once, such as a shared scene. All zero: it is
 * free. */
struct srv_claim {
    bool is_taken;
};

static inline bool srv_claims_are_free(struct srv_claim *const *claims, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (claims[i]->is_taken) {
            return false;
        }
    }
    return true;
}

static inline void srv_claims_set(struct srv_claim *const *claims, uint32_t count,
                                  bool is_taken)
{
    for (uint32_t i = 0; i < count; i++) {
        claims[i]->is_taken = is_taken;
    }
}

struct srv_job;
typedef void (*srv_job_fn)(struct srv_job *job);

enum srv_job_state {
    SRV_JOB_IDLE = 0,
    SRV_JOB_QUEUED = 1,
    SRV_JOB_RUNNING = 2,
    SRV_JOB_DONE = 3
};

/* A user's lists. This and the next belong to the queue's lock; all zero but for
 * list.group: nothing waits. */
struct srv_group {
    struct srv_fair turn; /* first */
    struct srv_fairqueue lists;
    uint32_t running;              /* jobs of its lists */
    struct srv_group *next_served; /* while one is chosen: that have their share */
};

/* The jobs of one session, of which one runs at a time. */
struct srv_job_list {
    struct srv_fair turn; /* first; among the lists of its group */
    struct srv_group *group;
    struct srv_job *first;
    struct srv_job *last;
    struct srv_job_list *next_aside; /* of srv_turns.aside */
    bool serving;                    /* a job of it runs */
    bool is_background; /* its first job waits for what another has claimed */
};

/* A long job may run in parts, and those of others come between them: after each part it
 * is QUEUED again, the first of its list, and can be removed.
 * All above `run` belongs to the queue's lock; the rest to whom the state says. */
struct srv_job {
    struct srv_job *next;
    struct srv_job_list *list;
    enum srv_job_state state;
    bool counts;        /* towards the capacity of the queue, while it waits */
    srv_job_fn run;     /* [compute] */
    srv_job_fn done;    /* [loop]; may free the job */
    atomic_bool cancel; /* set by [loop], polled by [compute]; relaxed: a hint, no data */
    bool heeds_end;     /* its `run` ends soon after it is cancelled, or after */
    atomic_uint_least64_t end_ns; /* [compute] this time; 0: none. Relaxed */
    bool goes_on; /* [compute] set by `run`: a part is done; call it again */
    /* What it uses that other lists' jobs may use, too; constant while it is queued. */
    struct srv_claim *const *claims;
    uint32_t claim_count;
};

/* All zero: nothing waits. */
struct srv_turns {
    struct srv_fairqueue groups;
    struct srv_job_list *aside; /* lists that wait for a claim */
};

/* Queue or remove a list that has changed: it waits if it has a job that could run and
 * none of them does; its group if one of its lists waits. */
void srv_turns_update(struct srv_turns *turns, struct srv_job_list *list);

/* Take the list whose first job is next, while `running` jobs run, out of its queue, and
 * return it; NULL: there is none. A user has no more jobs than are left of place_max, or
 * one if none is left: the others wait on. A list whose first job has to wait for a claim
 * is put aside. */
struct srv_job_list *srv_turns_choose(struct srv_turns *turns, uint32_t running,
                                      uint32_t place_max);

/* Take back a list that was put aside, as another job is its first now; srv_turns_update
 * follows. At most as many are aside as there are sessions. */
void srv_turns_take_from_aside(struct srv_turns *turns, struct srv_job_list *list);

/* Let all lists that were put aside try anew when it is their turn, as claims were given
 * back. */
void srv_turns_empty_aside(struct srv_turns *turns);

#endif
