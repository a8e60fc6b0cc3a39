/* flight.h - sends several requests at once and waits for all of their answers, which
 * saves round trips.
 *
 * Send requests that do not depend on each other's answers. The daemon computes those of
 * a session in their order, and answers all others at once, in their order, too.
 */
#ifndef CLI_FLIGHT_H
#define CLI_FLIGHT_H

#include "rpc.h"

#define CLI_FLIGHT_MAX 16u /* as many as wait at the daemon before it reads no more */
/* Of these, computed: four thousand clients that come back at once find room in the
 * daemon's queue, which takes 32768 unless it is told otherwise. */
#define CLI_FLIGHT_COMPUTED 8u

struct cli_flight {
    struct pccd_client *client;
    bool is_careful; /* the last try has failed, perhaps for want of room: one by one */
    uint32_t computed;
    struct cli_call *calls[CLI_FLIGHT_MAX];
    uint32_t first; /* free-running: the oldest that is not finished */
    uint32_t end;
};

/* Send one more, with `slot` or CLI_SLOT_NONE; when there are too many the oldest are
 * finished first. Its answer goes to `result`, which may be NULL and stays the caller's
 * until the flight is over. Not sent on failure: the slot is the caller's still. */
int cli_flight_send(struct cli_flight *flight, int method, const void *request,
                    uint32_t slot, void *result);

/* End the flight that has come to `status`: wait for all answers, or drop them once
 * something has failed. Returns what failed first, or 0. Each wait has a deadline of its
 * own: much may take long, a silent daemon may not. */
int cli_flight_end(struct cli_flight *flight, int status);

#endif
