/* recorder_snapshot.h - writes the beginning of a recording's segment: everything that
 * is registered at that time.
 */
#ifndef CLI_RECORDER_SNAPSHOT_H
#define CLI_RECORDER_SNAPSHOT_H

#include "recorder.h"

/* Everything that is kept, into the segment that has just begun, then LOG, then the steps
 * without an answer. 0 or why it could not be written. */
int cli_record_snapshot(struct pccd_client *client);

typedef int (*cli_record_fn)(struct pccd_client *client, enum record_kind kind,
                             const struct record_part *parts, size_t count);
/* A mesh, written by `add`. */
int cli_record_put_mesh(struct pccd_client *client, uint32_t mesh,
                        const struct registry_shape *shape, cli_record_fn add);
/* A step that has been sent, with the payload of its slot. */
int cli_record_step(struct pccd_client *client, const struct cli_call *call);

#endif
