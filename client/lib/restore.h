/* restore.h - registers everything again with a new daemon after the old one was lost.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     make a ring like the old one, and scenes, meshes and objects under their old
 *           handles, at their last positions.
 * Threads:  [owner].
 */
#ifndef CLI_RESTORE_H
#define CLI_RESTORE_H

#include "client.h"

/* In a new session, with nothing in flight but what is held. On failure the client is as
 * before, and all can be tried again in another session. */
int cli_restore(struct pccd_client *client);

#endif
