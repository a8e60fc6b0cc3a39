/* scene.c - scenes, the objects in them, which of these may meet, and their boxes. */
#include <stddef.h>
#include <string.h>

#include "attach.h"
#include "client.h"
#include "events.h"
#include "recorder_shared.h"
#include "replica.h"
#include "rpc.h"

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
    memcpy(request->name, name, bytes + 1);
    return 0;
}

/* Share a scene as its settings say. */
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

    request->want = cli_take_handle(client);
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
        cli_user_data_forget(client, scene);
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
    request.want = cli_take_handle(client);
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
    int status = cli_call_sync(client, PROTO_METHOD_SCENE_REMOVE, &request, NULL,
                               cli_deadline(client, -1));
    return status != 0 ? status : cli_user_data_note(client, scene, object, 0);
}

/* ---- which objects are tested against each other ----------------------------------- */

static int check_settings(struct pccd_client *client,
                          const struct pccd_object_settings *settings)
{
    struct pccd_object_settings known;
    int status = cli_struct_read(client, "object.set", settings, &known, sizeof known);

    if (status != 0) {
        return status;
    }
    if ((COMMON_OBJECT_BITS(settings->what) & ~COMMON_OBJECT_KNOWN) != 0) {
        return cli_fail(client, PCCD_E_INVAL,
                        "object.set: what is 0x%x, this library knows the bits 0x%x",
                        settings->what, COMMON_OBJECT_KNOWN);
    }
    return 0;
}

static int call_set(struct pccd_client *client,
                    const struct proto_OBJECT_SET_request *request,
                    struct proto_OBJECT_SET_result *result)
{
    int status = cli_call_sync(client, PROTO_METHOD_OBJECT_SET, request, result,
                               cli_deadline(client, -1));

    return status != 0 ? status
                       : cli_user_data_note(client, request->scene, request->object,
                                            result->user_data);
}

int pccd_object_set(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const struct pccd_object_settings *settings)
{
    struct proto_OBJECT_SET_request request = {.scene = scene, .object = object};
    struct proto_OBJECT_SET_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (settings == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "object.set: settings is NULL");
    }
    if (settings->what == 0) {
        return cli_fail(client, PCCD_E_INVAL,
                        "object.set: what is 0, it names nothing to set");
    }
    status = check_settings(client, settings);
    if (status != 0) {
        return status;
    }
    request.what = settings->what;
    COMMON_ATTRIBUTES_COPY(&request, settings);
    return call_set(client, &request, &result);
}

int pccd_object_name(struct pccd_client *client, uint32_t scene, uint32_t object,
                     const char *name)
{
    struct proto_OBJECT_SET_request request = {
        .scene = scene, .object = object, .has_name = true};
    struct proto_OBJECT_SET_result result;
    size_t bytes = name != NULL ? strlen(name) : 0;

    CLI_ENTER_OR_RETURN(client);
    if (bytes > PROTO_STR_MAX) {
        return cli_fail(client, PCCD_E_INVAL,
                        "object.set: a name of %zu bytes, not of up to %u", bytes,
                        PROTO_STR_MAX);
    }
    if (bytes > 0) {
        memcpy(request.name, name, bytes);
    }
    return call_set(client, &request, &result);
}

int pccd_object_get(struct pccd_client *client, uint32_t scene, uint32_t object,
                    struct pccd_object_settings *settings)
{
    struct proto_OBJECT_SET_request request = {.scene = scene, .object = object};
    struct proto_OBJECT_SET_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (settings == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "object_get: settings is NULL");
    }
    status = call_set(client, &request, &result);
    if (status == 0) {
        struct pccd_object_settings known = {.struct_bytes = settings->struct_bytes,
                                             .what = PCCD_OBJECT_ALL};

        COMMON_ATTRIBUTES_COPY(&known, &result);
        memcpy(settings, &known,
               settings->struct_bytes == sizeof known
                   ? sizeof known
                   : offsetof(struct pccd_object_settings, user_data));
    }
    return status;
}

static int set_pair(struct pccd_client *client,
                    const struct proto_SCENE_IGNORE_request *request)
{
    CLI_ENTER_OR_RETURN(client);
    return cli_call_sync(client, PROTO_METHOD_SCENE_IGNORE, request, NULL,
                         cli_deadline(client, -1));
}

int pccd_pair_ignore(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                     uint32_t object_b, bool ignored)
{
    const struct proto_SCENE_IGNORE_request request = {
        .scene = scene, .a = object_a, .b = object_b, .ignored = ignored};

    return set_pair(client, &request);
}

int pccd_pair_clearance(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                        uint32_t object_b, double clearance)
{
    const struct proto_SCENE_IGNORE_request request = {.scene = scene,
                                                       .a = object_a,
                                                       .b = object_b,
                                                       .has_clearance = true,
                                                       .clearance = clearance};

    return set_pair(client, &request);
}

/* ---- what its hierarchies look like ------------------------------------------------ */

/* One page, from request->first on. */
static int fetch(struct pccd_client *client, struct proto_SCENE_BOXES_request *request,
                 struct pccd_box *boxes, struct proto_SCENE_BOXES_result *result)
{
    uint64_t page;
    int status = cli_call_page(client, PROTO_METHOD_SCENE_BOXES, request, result,
                               cli_deadline(client, -1), &page);
    if (status == 0 &&
        (result->count > request->count ||
         (result->count == 0 && request->count > 0 && request->first < result->boxes))) {
        status =
            cli_fail(client, PCCD_E_BUSY,
                     "scene.boxes: no room in the result region: release answers first");
    }
    if (status == 0 && result->count > 0) {
        memcpy(boxes, cli_page_base(client, page) + result->offset,
               result->count * sizeof *boxes);
    }
    cli_page_release(client, page);
    return status;
}

int pccd_scene_boxes(struct pccd_client *client, uint32_t scene, enum pccd_tree tree,
                     uint32_t level, struct pccd_box *boxes, uint32_t room,
                     uint32_t *count)
{
    struct proto_SCENE_BOXES_request request = {
        .scene = scene, .tree = (uint32_t)tree, .level = level, .count = room};
    struct proto_SCENE_BOXES_result result = {.boxes = 0};
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (count == NULL || (boxes == NULL && room > 0)) {
        return cli_fail(client, PCCD_E_INVAL, "scene.boxes: boxes or count is NULL");
    }
    status = cli_ring_ensure(client);
    while (status == 0) { /* every page but the last has a box at least */
        status = fetch(client, &request, boxes, &result);
        request.first += status == 0 ? result.count : 0;
        request.count = room - request.first;
        boxes = result.count > 0 ? boxes + result.count : boxes;
        if (request.count == 0 || request.first >= result.boxes) {
            break;
        }
    }
    if (status == 0) {
        *count = result.boxes;
    }
    return status;
}
