/* restore.h - tell another daemon what the last one knew.
 *
 * Room:     client/lib, private. May include: client.h.
 * Does:     a ring like the one there was, scenes, meshes and objects under their old
 *           handles, and where the objects were.
 * Threads:  [owner].
 */
#ifndef CLI_RESTORE_H
#define CLI_RESTORE_H

#include "client.h"

/* In a new session, with nothing in flight but what is held. On failure the client is as
 * before, and all can be tried again in another session. */
int cli_restore(struct pccd_client *client);

#endif
