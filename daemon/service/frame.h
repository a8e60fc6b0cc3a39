/* frame.h - answers of steps that did not run.
 *
 * Room:     service. May include: the protocol's headers.
 * Does:     declare what handlers_frame.c knows of the answer to a step.
 * Threads:  [any].
 */
#ifndef SRV_FRAME_H
#define SRV_FRAME_H

#include "codec.h"
#include "messages.h"
#include "pccd_types.h"

/* The answer of a step that found nothing because it ended before it began; the page is
 * the caller's affair. */
void srv_frame_nothing(const struct proto_FRAME_SUBMIT_request *submit,
                       enum pccd_incomplete why,
                       struct proto_FRAME_SUBMIT_result *answer);

#endif
