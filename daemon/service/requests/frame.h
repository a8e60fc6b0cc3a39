/* frame.h - builds the answer to a step.
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

/* Copy the records of the scene's answer from `first` on into the result region, as many
 * as fit, and say in *answer which those are. Returns 0 or a status with the request's
 * error set. [compute] */
int srv_frame_page(struct srv_request *request, uint64_t first,
                   struct proto_FRAME_SUBMIT_result *answer);

#endif
