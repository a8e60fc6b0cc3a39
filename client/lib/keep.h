/* keep.h - notes what the client has registered, so that another daemon can be told
 * after a crash.
 */
#ifndef CLI_KEEP_H
#define CLI_KEEP_H

#include "client.h"

/* The mesh `handle` has been committed, or replaced, with what is in `copy`, which is
 * taken over. */
void cli_keep_mesh(struct pccd_client *client, uint32_t handle,
                   struct registry_mesh *copy);

/* A request has been answered with success: note what it has changed. */
void cli_keep_answer(struct pccd_client *client, struct cli_call *call);

/* scene.near has been answered: its pages are those of the scene from now on. */
void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request);
/* The scene is gone. */
void cli_near_forget(struct pccd_client *client, uint32_t scene);
/* Whether `step` numbers the last answered question about the scene. */
bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step);

#endif
