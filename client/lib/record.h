/* record.h - starts and ends the recording of a client.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     begin a recording that the environment asks for, and end it at close.
 * Threads:  [owner].
 */
#ifndef CLI_RECORD_H
#define CLI_RECORD_H

#include "client.h"

/* As $PCCD_RECORD and $PCCD_RECORD_OPTIONS say; 0 when they say nothing. */
int cli_record_environment(struct pccd_client *client);
/* End it, and free it. */
void cli_record_close(struct pccd_client *client);

#endif
