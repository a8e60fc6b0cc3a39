/* filter.h - writes and reads the attributes of an object in a recording (chunk
 * FILTER).
 */
#ifndef RECORD_FILTER_H
#define RECORD_FILTER_H

#include "payload.h"

/* Of `given`, those that `what` names (bits of enum pccd_object_what, or all). */
void record_filter_make(struct record_filter *filter, uint32_t scene, uint32_t object,
                        uint32_t what, const struct common_attributes *given);
/* A payload that was judged. */
void record_filter_read(const void *payload, uint64_t bytes, struct record_filter *filter,
                        struct common_attributes *given);

#endif
