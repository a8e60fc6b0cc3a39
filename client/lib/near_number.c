/* near_number.c - the numbers of questions about what is near.
 *
 * Room:     client/lib. May include: near_number.h.
 * Does:     keep one for each scene.
 * Threads:  [owner].
 */
#include "near_number.h"

/* That of a scene, or one that is free: a client has no more scenes than entries. */
static struct cli_near *entry_of(struct pccd_client *client, uint32_t scene)
{
    struct cli_near *free_one = NULL;

    for (uint32_t i = 0; i < PROTO_SCENES_PER_CLIENT; i++) {
        struct cli_near *entry = &client->nears[i];

        if (entry->scene == scene) {
            return entry;
        }
        free_one = entry->scene == 0 ? entry : free_one;
    }
    return free_one;
}

void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request)
{
    struct cli_near *entry = entry_of(client, request->scene);

    if (entry != NULL) {
        *entry = (struct cli_near){request->scene, request->step};
    }
}

void cli_near_forget(struct pccd_client *client, uint32_t scene)
{
    struct cli_near *entry = entry_of(client, scene);

    if (entry != NULL) {
        *entry = (struct cli_near){0, 0};
    }
}

bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step)
{
    for (uint32_t i = 0; step != 0 && i < PROTO_SCENES_PER_CLIENT; i++) {
        if (client->nears[i].scene == scene && client->nears[i].step == step) {
            return true;
        }
    }
    return false;
}
