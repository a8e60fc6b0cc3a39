/* near_number.c - the numbers of questions about what is near. */
#include "near_number.h"

void cli_near_answered(struct pccd_client *client,
                       const struct proto_SCENE_NEAR_request *request)
{
    /* Without memory for it, its further pages are refused as those of a step. There is
     * no scene 0, whatever a daemon says of it. */
    if (request->scene != 0) {
        (void)registry_map_put(&client->nears, request->scene, request->step);
    }
}

void cli_near_forget(struct pccd_client *client, uint32_t scene)
{
    registry_map_remove(&client->nears, scene);
}

bool cli_near_is(const struct pccd_client *client, uint32_t scene, uint64_t step)
{
    uint64_t last = 0;

    return step != 0 && registry_map_get(&client->nears, scene, &last) && last == step;
}
