/* recorder_events.h - writes each request and answer of a client into its recording.
 *
 * Append an event when it has happened: what was made or destroyed when its answer comes;
 * a step when it has been sent; its answer when that comes. The positions of a step are
 * read from its slot then, while the daemon computes.
 *
 * Threads: [owner]. There is no other thread, and no buffer that a crash could lose: each
 * event is one write.
 */
#ifndef CLI_RECORDER_EVENTS_H
#define CLI_RECORDER_EVENTS_H

#include "client.h"

/* Begin a segment. 0 or why not: the recording has ended then. */
int cli_record_open(struct pccd_client *client);

/* Each does nothing without a recorder. The handle of a mesh that was made or
 * replaced, and is kept already: */
void cli_record_mesh(struct pccd_client *client, uint32_t mesh,
                     const struct registry_shape *shape);
/* A step has been sent; its slot is the daemon's. */
void cli_record_frame(struct pccd_client *client, const struct cli_call *call);
/* A request has been answered; cli_keep_answer has seen it. */
void cli_record_answer(struct pccd_client *client, const struct cli_call *call);
void cli_record_cancel(struct pccd_client *client, uint64_t step);

#endif
