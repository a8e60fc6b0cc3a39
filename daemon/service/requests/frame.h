/* frame.h - builds the answer to a step, or to a question about what is near. */
#ifndef SRV_FRAME_H
#define SRV_FRAME_H

#include "codec.h"
#include "engine.h"
#include "messages.h"
#include "pccd_types.h"

struct srv_call;
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
struct eng_step_settings srv_frame_settings(struct srv_request *request,
                                            const struct srv_wanted *wanted);

/* Who makes a step. */
struct srv_stepper {
    uint64_t session;
    uint64_t step; /* the session's number for it */
    bool places;   /* it only brings objects back */
};
/* Run the step that is staged in the scene, which has its engine, and keep what comes of
 * it there. 0; PCCD_E_AGAIN, of a brief step (brief.h); or another status with *error
 * set. [compute]; of different scenes on several threads, [team] */
int srv_frame_compute(struct srv_scene *scene, const struct eng_step_settings *settings,
                      const struct srv_stepper *by, struct eng_step_result *step,
                      struct proto_error *error);

/* The answer of a step that found nothing because it ended before it began; the page is
 * the caller's affair. [any] */
void srv_frame_nothing(const struct proto_FRAME_SUBMIT_request *submit,
                       enum pccd_incomplete why,
                       struct proto_FRAME_SUBMIT_result *answer);

/* The records of an answer that its scene keeps. */
struct srv_records {
    const void *data; /* NULL: there are none */
    uint32_t record_bytes;
    uint64_t total;
    uint32_t incomplete; /* enum pccd_incomplete */
    bool is_of_step;
};

/* Those of them that have been written to the result region; `incomplete` counts that
 * further ones are left. */
struct srv_records_page {
    uint64_t first;
    uint64_t count;
    uint64_t cursor;
    uint64_t offset;
    uint64_t release;
    uint32_t incomplete;
};

/* Copy records from `first` on into the result region, as many as fit. Returns 0 or a
 * status with the request's error set. [compute] */
int srv_records_write(struct srv_request *request, const struct srv_records *records,
                      uint64_t first, struct srv_records_page *page);
#define SRV_RECORDS_PAGE(answer, page)                                                   \
    ((answer)->first = (page)->first, (answer)->count = (page)->count,                   \
     (answer)->cursor = (page)->cursor, (answer)->offset = (page)->offset,               \
     (answer)->release = (page)->release, (answer)->incomplete = (page)->incomplete)

/* The same of the scene's last answer to a step. [compute] */
int srv_frame_page(struct srv_request *request, uint64_t first,
                   struct proto_FRAME_SUBMIT_result *answer);
/* And of its last answer about what is near. [compute] */
int srv_near_page(struct srv_request *request, uint64_t first,
                  struct proto_SCENE_NEAR_result *answer);

#endif
