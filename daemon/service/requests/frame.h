/* frame.h - builds the answer to a step, or to a question about what is near.
 *
 * Room:     service. May include: the protocol's headers.
 * Does:     declare the answer of a step that did not run, and the pages of records of
 *           one that did.
 * Threads:  functions say.
 */
#ifndef SRV_FRAME_H
#define SRV_FRAME_H

#include "codec.h"
#include "messages.h"
#include "pccd_types.h"

struct srv_request;

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
