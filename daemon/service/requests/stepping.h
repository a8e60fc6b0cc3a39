/* stepping.h - what the requests have in common that move a scene, or ask about it at
 * one moment: frame.submit, scene.near and batch.submit.
 */
#ifndef SRV_STEPPING_H
#define SRV_STEPPING_H

#include "call.h"
#include "engine.h"
#include "request.h"
#include "staging.h"

/* What they ask for in the same words. */
struct srv_asked {
    struct srv_cargo cargo; /* segments 0: nothing moves */
    uint32_t method;
    uint32_t threads;
    uint64_t deadline_ns;
    uint64_t step;
    const char *tuning;
};

/* Of frame.submit, scene.near or batch.submit. The text is that of the message. [any] */
struct srv_asked srv_asked_of(int method, const union srv_params *params);

/* Before anything else is looked at: 0, or with call->error set why the request cannot be
 * computed, whatever its scene holds. [loop] */
int srv_stepping_check(struct srv_call *call, const struct srv_asked *asked,
                       struct srv_ring **ring);
/* Choices of a message by name, each of 0 .. count-1: 0, or PCCD_E_INVAL with call->error
 * set. [loop] */
struct srv_choice {
    const char *name;
    uint32_t value;
    uint32_t count;
};
int srv_stepping_choose(struct srv_call *call, const struct srv_choice *choices,
                        size_t count);

/* A length of a message, 0 .. 1e18: 0; or, with call->error set, PCCD_E_INVAL: negative
 * or not finite, PCCD_E_LIMIT: longer. [loop] */
int srv_check_length(struct srv_call *call, const char *name, double length);

/* Arrival plus the client's budget; 0: none. [any] */
uint64_t srv_stepping_deadline(uint64_t budget_ns, uint64_t arrival_ns);

/* The engine's settings for a request that was checked, but for mode and tolerance.
 * [compute] */
struct eng_question srv_stepping_settings(struct srv_request *request);

/* Its turn begins: what an earlier one of the session could not be told any more, or that
 * the client's result_head makes no sense; 0: go on. [compute] */
int srv_stepping_begin(struct srv_request *request);
/* Where to leave the error of one that was answered already. [compute] */
struct proto_error *srv_stepping_owed(const struct srv_request *request);

/* Stage what the request moves itself, out of its slot or of the copy of it, in the
 * staging that is open, and give the slot back. [compute] */
int srv_stepping_stage(struct srv_request *request);
/* Open the staging; threads of the step may copy. [compute] */
void srv_stepping_open(struct srv_request *request, struct eng_scene *engine);

/* It is to end, and others are still before it: answer it with `result`, whose `release`
 * is set here, and copy its slot for its turn; or leave it to its turn. [loop] */
void srv_stepping_answer_early(struct srv_request *request, void *result,
                               uint64_t *release);

#endif
