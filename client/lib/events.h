/* events.h - what a daemon tells that nobody has asked for at that moment. */
#ifndef CLI_EVENTS_H
#define CLI_EVENTS_H

#include "client.h"

/* Keep what a scene.step says until the user asks for it. */
void cli_shared_take_step(struct pccd_client *client,
                          const struct proto_envelope *envelope);
/* Note that a frame is held, as scene.held says. */
void cli_shared_held(struct pccd_client *client, const struct proto_envelope *envelope);
/* Forget the news of a scene that is no longer this client's. */
void cli_shared_forget(struct pccd_client *client, uint32_t scene);
void cli_shared_deinit(struct pccd_client *client);

/* Keep what a notification of a step says, or count it as lost where no room is left. */
void cli_watch_take(struct pccd_client *client, const struct proto_envelope *envelope);

/* Free what was kept of steps, when the client goes. */
void cli_watch_deinit(struct pccd_client *client);

#endif
