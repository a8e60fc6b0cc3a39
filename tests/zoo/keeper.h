/* keeper.h - an honest client that is measured while hostile ones attack the daemon. */
#ifndef ZOO_KEEPER_H
#define ZOO_KEEPER_H

#include <stdbool.h>
#include <stdint.h>

#include "daemon.h"
#include "grid.h"

struct zoo_keeper {
    struct test_daemon daemon;
    struct test_grid grid;
    struct pccd_contact *alone[2]; /* the answers to a step down and one up */
    uint64_t count;
    uint64_t *taken_us; /* scratch: times of the last round */
};

/* Latencies of a round. */
struct zoo_times {
    double p50_ms;
    double p99_ms;
    double most_ms;
};

/* Holdings of the daemon that a client could have left there. */
struct zoo_held {
    uint64_t sessions;
    uint64_t meshes;
    uint64_t scenes;
    uint64_t objects;
    uint64_t shm_bytes;
    uint64_t jobs;
    uint64_t engine_bytes;
    uint64_t heap_bytes; /* anonymous memory of its process */
    int fds;
};

/* Start a daemon and a client with a scene, and see what its answers are. */
bool zoo_keeper_start(struct zoo_keeper *keeper, uint32_t requests_max);
/* False: the daemon did not end with 0. */
bool zoo_keeper_stop(struct zoo_keeper *keeper);

/* Step `requests` times. False, with a line on stderr: an answer was not what it was
 * alone. */
bool zoo_keeper_work(struct zoo_keeper *keeper, uint32_t requests,
                     struct zoo_times *times);

void zoo_keeper_look(struct zoo_keeper *keeper, struct zoo_held *held);
/* Wait until nothing but the keeper's is left, 10 s at most. False, with a line on
 * stderr: something is. */
bool zoo_keeper_await(struct zoo_keeper *keeper, const struct zoo_held *before);

#endif
