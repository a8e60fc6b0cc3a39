/* restore.h - registers everything again with a new daemon after the old one was lost. */
#ifndef CLI_RESTORE_H
#define CLI_RESTORE_H

#include "client.h"

/* In a new session, with nothing in flight but what is held. On failure the client is as
 * before, and all can be tried again in another session. */
int cli_restore(struct pccd_client *client);

#endif
