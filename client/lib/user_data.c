/* user_data.c - the numbers that the user has given to objects, at hand. */
#include <stdlib.h>

#include "client.h"

struct cli_user_data {
    struct cli_user_data *next;
    uint32_t scene;
    struct registry_map objects; /* numbers that are not 0 by handles */
};

/* The link to what is known of a scene; to NULL: nothing is. */
static struct cli_user_data **find(struct pccd_client *client, uint32_t scene)
{
    struct cli_user_data **link = &client->user_data;
    while (*link != NULL && (*link)->scene != scene) {
        link = &(*link)->next;
    }
    return link;
}

int cli_user_data_note(struct pccd_client *client, uint32_t scene, uint32_t object,
                       uint64_t user_data)
{
    struct cli_user_data *known = *find(client, scene);
    if (user_data == 0) {
        if (known != NULL) {
            registry_map_remove(&known->objects, object);
        }
        return PCCD_OK;
    }
    if (known == NULL) {
        known = calloc(1, sizeof *known);
        if (known != NULL) {
            *known = (struct cli_user_data){.next = client->user_data, .scene = scene};
            client->user_data = known;
        }
    }
    return known != NULL &&
                   registry_map_put(&known->objects, object, user_data) == PCCD_OK
               ? PCCD_OK
               : cli_fail(client, PCCD_E_NOMEM, "object.set: no memory for user_data");
}

void cli_user_data_forget(struct pccd_client *client, uint32_t scene)
{
    struct cli_user_data **link = find(client, scene);
    struct cli_user_data *known = *link;
    if (known != NULL) {
        *link = known->next;
        registry_map_deinit(&known->objects);
        free(known);
    }
}

void cli_user_data_deinit(struct pccd_client *client)
{
    while (client->user_data != NULL) {
        cli_user_data_forget(client, client->user_data->scene);
    }
}

int pccd_user_data(struct pccd_client *client, uint32_t scene, const uint32_t *objects,
                   uint64_t count, uint64_t *user_data)
{
    CLI_ENTER_OR_RETURN(client);
    if ((objects == NULL || user_data == NULL) && count > 0) {
        return cli_fail(client, PCCD_E_INVAL, "user_data: %s is NULL",
                        objects == NULL ? "objects" : "user_data");
    }
    const struct cli_user_data *known = *find(client, scene);
    for (uint64_t i = 0; i < count; i++) {
        user_data[i] = 0;
        if (known != NULL) {
            (void)registry_map_get(&known->objects, objects[i], &user_data[i]);
        }
    }
    return PCCD_OK;
}
