/* near_number.h - tells the number of a question about what is near (pccd_near.h) from
 * that of a step, as both are asked for further pages in the same words.
 */
#ifndef CLI_NEAR_NUMBER_H
#define CLI_NEAR_NUMBER_H

#include "client.h"

/* scene.near has been answered: its pages are those of the scene from now on. */
void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request);
/* The scene is gone. */
void cli_near_forget(struct pccd_client *client, uint32_t scene);
/* Whether `step` numbers the last answered question about the scene. */
bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step);

#endif
