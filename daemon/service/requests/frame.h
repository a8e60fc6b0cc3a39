/* frame.h - builds the answer to a step, or to a question about what is near. */
#ifndef SRV_FRAME_H
#define SRV_FRAME_H

#include "codec.h"
#include "engine.h"
#include "messages.h"
#include "pccd_types.h"

struct srv_call;
struct srv_kept;
struct srv_request;
struct srv_scene;

/* What is asked of a step, of frame.submit or of each scene of batch.submit. */
struct srv_wanted {
    uint32_t mode;
    double tolerance, separation, approach;
};
#define SRV_WANTED_OF(request)                                                           \
    ((const struct srv_wanted){(request)->mode, (request)->tolerance,                    \
                               (request)->separation, (request)->approach})

/* 0, or PCCD_E_INVAL or PCCD_E_LIMIT with call->error set. [loop] */
int srv_frame_check(struct srv_call *call, const struct srv_wanted *wanted);
/* The engine's settings for a request that was checked. [compute] */
struct eng_question srv_frame_settings(struct srv_request *request,
                                       const struct srv_wanted *wanted);

/* What the engine says, in the terms of the message, but for the page. [any] */
void srv_answer_describe(const struct eng_step_result *result, uint32_t record_bytes,
                         struct proto_answer *answer);

/* Who makes a step. */
struct srv_stepper {
    uint64_t session;
    uint64_t step; /* the session's number for it */
    bool places;   /* it only brings objects back */
};
/* Run the step that is staged in the scene, which has its engine, and keep what comes of
 * it there. 0; PCCD_E_AGAIN, of a brief step (brief.h); or another status with *error
 * set. [compute]; of different scenes on several threads, [team] */
int srv_frame_compute(struct srv_scene *scene, const struct eng_question *settings,
                      const struct srv_stepper *by, struct eng_step_result *step,
                      struct proto_error *error);

/* The answer of a step that found nothing because it ended before it began; the page is
 * the caller's affair. [any] */
void srv_frame_nothing(const struct proto_FRAME_SUBMIT_request *submit,
                       enum pccd_incomplete why, struct proto_answer *answer);

/* Write a page of what the scene keeps to the result region: records from `first` on, as
 * many as fit. *answer is set also without a page: others hear of a step. 0, or a status
 * with the request's error set. [compute] */
int srv_answer_page(struct srv_request *request, const struct srv_kept *kept,
                    uint64_t first, struct proto_answer *answer);

#endif
