/* watch.h - news of steps that other clients compute (pccd_watch_next). */
#ifndef CLI_WATCH_H
#define CLI_WATCH_H

#include "client.h"

/* A notification of a step has come. */
void cli_watch_take(struct pccd_client *client, const struct proto_envelope *envelope);

/* The client goes. */
void cli_watch_deinit(struct pccd_client *client);

#endif
