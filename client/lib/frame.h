/* frame.h - positions that are written into a slot, before they are sent with a
 * request.
 */
#ifndef CLI_FRAME_H
#define CLI_FRAME_H

#include "client.h"

/* Begin a slot and write all motions into it. The slot is the caller's, to be sent or
 * aborted; on failure there is none. */
int cli_frame_write(struct pccd_client *client, uint32_t scene,
                    const struct pccd_motion *motions, uint32_t motion_count,
                    uint32_t *slot);

/* Take the slot of a frame that is to be sent now, which the frame gives up also on
 * failure: it is aborted then. `step` is only looked at: NULL is refused. */
int cli_frame_take(struct pccd_frame *frame, const uint64_t *step, uint32_t *scene,
                   uint32_t *slot);

/* Where things lie in the payload of a slot. */
#define CLI_PAYLOAD_ALIGN 64u /* of the first range: a cache line */
#define CLI_RANGE_ALIGN   8u  /* of every range: the protocol's */

static inline uint64_t cli_round_up(uint64_t bytes, uint64_t unit)
{
    return (bytes + unit - 1) / unit * unit;
}

#endif
