/* pace.h - decides when each simulated client sends its next request.
 *
 * In the open loop, follow a plan that does not depend on answers: clients join one by
 * one, spread over the period, and send at even or at random intervals. In the closed
 * loop, send when the client has paused after its answer.
 *
 * Threads: one process for one client.
 */
#ifndef LOAD_PACE_H
#define LOAD_PACE_H

#include "load.h"

struct load_pace {
    uint32_t client;
    uint64_t count;  /* of requests planned */
    uint64_t due_ns; /* of the next one; 0: the load has not begun */
};

/* Requests that are due before it are the warm-up's: nobody measures them. */
uint64_t load_measured_from_ns(const struct load *load);

/* The first request, when the load has begun. */
void load_pace_begin(struct load_pace *pace, const struct load *load, uint32_t client);

/* The next one: a request has been submitted at now_ns. */
void load_pace_next(struct load_pace *pace, const struct load *load, uint64_t now_ns);

/* How long its client stops before it takes the answer to the last request; mostly 0. */
uint64_t load_pace_stall_ns(const struct load_pace *pace, const struct load *load);

#endif
