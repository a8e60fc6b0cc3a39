/* record.h - starts and ends the recording of a client. */
#ifndef CLI_RECORD_H
#define CLI_RECORD_H

#include "client.h"

/* As $PCCD_RECORD and $PCCD_RECORD_OPTIONS say; 0 when they say nothing. */
int cli_record_environment(struct pccd_client *client);
/* End it, and free it. */
void cli_record_close(struct pccd_client *client);

#endif
