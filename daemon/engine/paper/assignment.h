/* assignment.h - how the threads of the method `paper` ask each other for work: queues,
 * requests, sleep and wake-up.
 *
 * Threads: filled in by [compute] before the region; each field says who writes it
 * inside.
 * Source: paper sections 4.2, 4.3 and 5.1.
 */
#ifndef ENG_ASSIGNMENT_H
#define ENG_ASSIGNMENT_H

#include <pthread.h>
#include <stdatomic.h>

#include "trees.h"

/* Front task units whose sizes a thread publishes: a request looks at the one behind
 * those that earlier requests will get. */
#define ENG_OFFERS_MAX 8u

/* Pairs of a high-level task unit are dealt out when there are this many for each thread.
 * */
#define ENG_PAIRS_PER_THREAD 16u

enum eng_reply { ENG_REPLY_NONE, ENG_REPLY_GIVEN, ENG_REPLY_DENIED };

/* One thread's place. A thread that asks for work holds no lock but that of its victim; a
 * thread that answers holds its own and takes the asker's: the asker is asleep on it, and
 * sleeping threads take no requests, so there is no circle. */
struct eng_seat {
    _Alignas(128) pthread_mutex_t lock;
    pthread_cond_t wake;
    /* Under the lock. */
    bool takes_requests;
    uint32_t request_count;
    uint32_t *requests; /* [threads] who waits for a node of ours, oldest first */
    enum eng_reply reply;
    uint32_t given; /* node of a task unit, with ENG_REPLY_GIVEN */
    /* Read by all without the lock, written by the owner (offers) or under the lock
     * (requests): hints for the choice of a victim, checked under the lock afterwards. */
    _Alignas(128) atomic_uint offers[ENG_OFFERS_MAX];
    atomic_uint requests_seen;
    atomic_uint current; /* validating builds: node of the task unit at hand */
};

/* Where threads sleep that find nobody with a node to spare. */
struct eng_idle_list {
    _Alignas(128) pthread_mutex_t lock; /* taken with no other lock held, and last */
    pthread_cond_t wake;
    uint32_t calls;       /* under the lock: sleepers told to get up, not yet up */
    atomic_uint sleepers; /* those not told yet; written under the lock */
};

struct eng_assignment {
    struct eng_seat *seats; /* [capacity] */
    uint32_t capacity;      /* seats with lock and queue */
    uint32_t *high;         /* high-level nodes, breadth-first */
    uint32_t high_count;
    uint64_t *pairs; /* of the high-level unit at hand: n << 32 | m */
    uint32_t pair_count;
    struct eng_idle_list idle;
    atomic_uint active; /* threads with work, or with work on its way to them */
};

void eng_assignment_init(struct eng_assignment *assignment);
void eng_assignment_deinit(struct eng_assignment *assignment);

/* Make seats for that many threads. PCCD_E_NOMEM: those at hand stay. */
int eng_assignment_reserve(struct eng_assignment *assignment, uint32_t threads);

/* Sleep until somebody has nodes to spare or nobody has work; either may be wrong by the
 * time the caller looks. Returns at once if nobody has work. [team] */
void eng_idle_sleep(struct eng_assignment *assignment);

/* Wake as many sleepers as the caller has `nodes` to spare. Costs one relaxed load while
 * nobody sleeps. A sleeper that lies down meanwhile may be missed: whoever has nodes to
 * spare calls again after its next task unit. [team] */
void eng_idle_wake(struct eng_assignment *assignment, uint32_t nodes);

/* Note, with PCCD_VALIDATE, that the thread of `seat`, one of the first `seat_count`,
 * performs the task unit of `node` now, or none (ENG_NO_NODE); assert that no other
 * thread performs that of a node above or below it (section 4.1, "Disjoint property").
 * [team] */
void eng_assignment_enter(struct eng_assignment *assignment, uint32_t seat_count,
                          const struct eng_scene *scene, uint32_t seat, uint32_t node);

/* Note that the caller has no work any more; wake everybody if nobody has. [team] */
void eng_assignment_leave(struct eng_assignment *assignment);

#endif
