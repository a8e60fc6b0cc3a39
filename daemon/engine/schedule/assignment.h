/* daemon/engine/schedule/assignment.h - what the paper's dynamic task assignment shares.
 *
 * Room:     engine. May include: world.h, the C library, POSIX threads.
 * Does:     name the seats of the threads, their scheduling queues, and the high-level
 *           nodes.
 * Threads:  filled in by [compute] before the region; each field says who writes it
 *           inside.
 * Source:   paper sections 4.2, 4.3 and 5.1.
 */
#ifndef ENG_ASSIGNMENT_H
#define ENG_ASSIGNMENT_H

#include <pthread.h>

#include "world.h"

/* Front nodes whose triangle counts a thread publishes: a request looks at the one behind
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
    uint32_t given; /* node, with ENG_REPLY_GIVEN */
    /* Read by all without the lock, written by the owner (offers) or under the lock
     * (requests): hints for the choice of a victim, checked under the lock afterwards. */
    _Alignas(128) atomic_uint offers[ENG_OFFERS_MAX];
    atomic_uint requests_seen;
    uint32_t first_node; /* initial assignment, or ENG_NO_NODE */
};

struct eng_assignment {
    struct eng_seat *seats; /* [capacity] */
    uint32_t capacity;      /* seats with lock and queue */
    uint32_t *high;         /* high-level nodes, breadth-first */
    uint32_t high_count;
    uint64_t *pairs; /* of the high-level unit at hand: n << 32 | m */
    uint32_t pair_count;
    atomic_uint active; /* threads with work, or with work on its way to them */
};

void eng_assignment_init(struct eng_assignment *assignment);
void eng_assignment_deinit(struct eng_assignment *assignment);

/* Seats for that many threads. ENG_E_NOMEM: those at hand stay. */
int eng_assignment_reserve(struct eng_assignment *assignment, uint32_t threads);

#endif
