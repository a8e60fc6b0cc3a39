/* srv_step.h - a step of a scene, or a question about what is near in it: of one scene or
 * of each of a batch, from the message to what is told of it.
 *
 *     [loop]     handlers_step.c   decodes and checks the message, starts a request
 *     [compute]  srv_step.c        runs the request, scene by scene
 *                srv_batch.c       of many scenes: which thread runs which, their answers
 *                handlers_fetch.c  writes the page of records
 *     [loop]     step_tell.c       counts it, and tells those who watch and take part
 *
 * A step is a batch of one, and a question is a step with another verb.
 */
#ifndef SRV_STEP_H
#define SRV_STEP_H

#include "call.h"
#include "engine.h"
#include "request.h"
#include "staging.h"

/* The settings of frame.submit, scene.near or batch.submit for each scene. */
struct srv_step_params {
    struct srv_slot_ref slot;
    uint32_t scene;  /* handle; of a batch 0 */
    uint32_t scenes; /* of a batch; else 0 */
    uint32_t method;
    uint32_t threads;
    uint64_t deadline_ns; /* from arrival; 0: none */
    uint64_t step;        /* of the first scene; each next one has the next */
    const char *tuning;   /* of the message */
    bool is_near;         /* it is the question of scene.near: all that follows is 0 */
    uint32_t mode;
    double tolerance;
    double separation;
    double approach;
    uint32_t touching;
    double resolution;
    bool tells_start;
    bool holds;
    bool places; /* it only brings objects to their places */
};

struct srv_step_params srv_step_params_of(int method, const union srv_params *params);

/* Return arrival plus the client's budget; 0: none. */
uint64_t srv_step_deadline(uint64_t budget_ns, uint64_t arrival_ns);

/* Write the question of a request that was checked. [compute], or [loop] while nothing is
 * computed. */
void srv_step_ask(struct srv_request *request, struct eng_question *question);

/* A scene while its step or question runs. */
struct srv_step_run {
    struct srv_request *request;
    struct srv_item *item;
    const struct srv_step_params *params;
    const struct eng_question *question;
    uint64_t step;                  /* the client's number for it */
    bool is_answered; /* of a batch: its client has the answer; it is only to move */
    struct srv_staging staging;     /* all but scene and member is the caller's */
    struct eng_step_result *result; /* filled in */
};

/* Stage what the scene's objects move, unless a brief step has. 0; or another status with
 * *staging.error set: nothing is staged then. [compute]; of different scenes on several
 * threads, [team] */
int srv_step_stage(struct srv_step_run *run);
/* Step or ask, from what was staged, and keep the answer in the scene. 0; PCCD_E_AGAIN,
 * of a brief step (step.h); or another status with *staging.error set: nothing is kept
 * then. Threads as above. */
int srv_step_compute(struct srv_step_run *run);

/* Do the work of a plan for one scene; srv_batch_work does it for many. [compute] */
int srv_step_work(struct srv_request *request);

/* Begin the turn of a request, for one scene or for many: write its question as
 * srv_step_ask does, with a trace that is lent, to be returned (tracing.h). Returns the
 * time. [compute] */
uint64_t srv_step_begin(struct srv_request *request, struct eng_question *question);

#define SRV_KEPT_BYTES (2u << 20) /* half a millisecond, as a rule */
/* Copy what a request uses of its slot, if that is at most SRV_KEPT_BYTES: for when it
 * has been answered. *copy is of malloc, and charged as *bytes of SRV_QUOTA_SHM_BYTES.
 * Returns 0, or a status with *error set: nothing is copied then. [any] */
int srv_step_keep(const struct srv_request *request, uint8_t **copy, uint64_t *bytes,
                  struct proto_error *error);

/* Note how a scene's step went, for those who watch. [compute], [team] */
void srv_step_note(struct srv_item *item, const struct proto_answer *answer);

/* Write the answer of one that ended before it began; the page is the caller's affair. */
void srv_step_nothing(const struct srv_request *request, enum pccd_incomplete why,
                      struct proto_answer *answer);

/* Finish a plan: count it, tell whom it concerns, and give its batch back. [loop] */
void srv_step_finish(struct srv_request *request);

/* Write a page of what the scene keeps to the result region: records from `first` on, as
 * many as fit. *answer is set also without a page: others hear of a step. 0, or a status
 * with the request's error set. [compute] */
int srv_answer_page(struct srv_request *request, const struct srv_kept *kept,
                    uint64_t first, struct proto_answer *answer);

#endif
