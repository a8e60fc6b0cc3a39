/* scene.c - scenes and the objects in them. */
#include <string.h>

#include "client.h"
#include "keep.h"
#include "recorder_shared.h"
#include "rpc.h"
#include "shared.h"

/* That there may be a scene of that name. */
static int take_name(struct pccd_client *client, const char *name,
                     struct proto_SCENE_CREATE_request *request)
{
    size_t bytes = strlen(name);

    if (bytes == 0 || bytes > PROTO_STR_MAX) {
        return cli_fail(client, PCCD_E_INVAL,
                        "scene.create: a name of %zu bytes, not of 1 to %u", bytes,
                        PROTO_STR_MAX);
    }
    if ((client->link.features & PROTO_FEATURE_SHARED) == 0) {
        return cli_fail(client, PCCD_E_VERSION,
                        "the daemon at %s is too old for scenes that clients share",
                        client->url);
    }
    memcpy(request->name, name, bytes + 1);
    return 0;
}

/* What a scene is shared as. */
static int share(struct pccd_client *client, const struct pccd_scene_settings *settings,
                 struct proto_SCENE_CREATE_request *request)
{
    if (settings->name == NULL) {
        return settings->share == 0 && settings->rights == 0
                   ? 0
                   : cli_fail(client, PCCD_E_INVAL,
                              "scene.create: only a scene with a "
                              "name has share and rights");
    }
    if (settings->share == PCCD_SHARE_OTHER) {
        return cli_fail(client, PCCD_E_INVAL,
                        "scene.create: a scene of another user is for pccd_scene_join");
    }
    request->share = (uint32_t)settings->share;
    request->rights = settings->rights;
    return take_name(client, settings->name, request);
}

/* As `request` says, under the handle that is wanted. */
static int create(struct pccd_client *client, struct proto_SCENE_CREATE_request *request,
                  uint32_t *scene)
{
    struct proto_SCENE_CREATE_result result;
    int status;

    request->want = cli_take_want(client);
    status = cli_call_sync(client, PROTO_METHOD_SCENE_CREATE, request, &result,
                           cli_deadline(client, -1));
    if (status == 0) {
        *scene = result.scene;
        if (request->name[0] != '\0') {
            (void)cli_journal_begin(client, result.scene);
        }
    }
    return status;
}

int pccd_scene_create(struct pccd_client *client,
                      const struct pccd_scene_settings *settings, uint32_t *scene)
{
    struct proto_SCENE_CREATE_request request = {.share = PCCD_SHARE_CREATE};
    int status = 0;

    CLI_ENTER_OR_RETURN(client);
    if (scene == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "scene.create: scene is NULL");
    }
    if (settings != NULL) {
        status = share(client, settings, &request);
    }
    return status != 0 ? status : create(client, &request, scene);
}

int pccd_scene_join(struct pccd_client *client, uint32_t owner, const char *name,
                    uint32_t *scene)
{
    struct proto_SCENE_CREATE_request request = {.share = PCCD_SHARE_OTHER,
                                                 .owner = owner};
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (scene == NULL || name == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "scene.create: %s is NULL",
                        scene == NULL ? "scene" : "name");
    }
    status = take_name(client, name, &request);
    return status != 0 ? status : create(client, &request, scene);
}

int pccd_scene_destroy(struct pccd_client *client, uint32_t scene)
{
    struct proto_SCENE_DESTROY_request request = {.scene = scene};
    int status;

    CLI_ENTER_OR_RETURN(client);
    cli_journal_settle(client, scene); /* while there is one */
    status = cli_call_sync(client, PROTO_METHOD_SCENE_DESTROY, &request, NULL,
                           cli_deadline(client, -1));
    if (status == 0) { /* what was said of it has come before that */
        cli_shared_forget(client, scene);
        cli_near_forget(client, scene);
    }
    return status;
}

int pccd_scene_add(struct pccd_client *client, uint32_t scene, uint32_t mesh,
                   uint32_t *object)
{
    struct proto_SCENE_ADD_request request = {.scene = scene, .mesh = mesh};
    struct proto_SCENE_ADD_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (object == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "scene.add: object is NULL");
    }
    request.want = cli_take_want(client);
    status = cli_call_sync(client, PROTO_METHOD_SCENE_ADD, &request, &result,
                           cli_deadline(client, -1));
    if (status == 0) {
        *object = result.object;
    }
    return status;
}

int pccd_scene_remove(struct pccd_client *client, uint32_t scene, uint32_t object)
{
    struct proto_SCENE_REMOVE_request request = {.scene = scene, .object = object};

    CLI_ENTER_OR_RETURN(client);
    return cli_call_sync(client, PROTO_METHOD_SCENE_REMOVE, &request, NULL,
                         cli_deadline(client, -1));
}
