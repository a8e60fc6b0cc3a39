/* filter.c - which objects are tested against each other. */
#include <stddef.h>
#include <string.h>

#include "client.h"
#include "rpc.h"
#include "struct_size.h"

/* A daemon without these would answer E_NOMETHOD, which says less. */
static int check_daemon(struct pccd_client *client, const char *method)
{
    if ((client->link.features & PROTO_FEATURE_FILTERS) == 0) {
        return cli_fail(client, PCCD_E_VERSION,
                        "%s: the daemon at %s is older than this; it tests every object "
                        "against every other one",
                        method, client->url);
    }
    return 0;
}

int cli_check_thick(struct pccd_client *client, const char *method)
{
    if ((client->link.features & PROTO_FEATURE_THICK) == 0) {
        return cli_fail(client, PCCD_E_VERSION,
                        "%s: the daemon at %s is older than this; to it all features are "
                        "without thickness",
                        method, client->url);
    }
    return 0;
}

int cli_check_tells(struct pccd_client *client, const char *method)
{
    if ((client->link.features & PROTO_FEATURE_TELLS) == 0) {
        return cli_fail(client, PCCD_E_VERSION,
                        "%s: the daemon at %s is older than this; it does not tell what "
                        "crosses",
                        method, client->url);
    }
    return 0;
}

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
    if (settings->what != (uint32_t)PCCD_OBJECT_ALL &&
        (settings->what & COMMON_OBJECT_THICK) != 0) {
        return cli_check_thick(client, "object.set");
    }
    return 0;
}

static int call_set(struct pccd_client *client,
                    const struct proto_OBJECT_SET_request *request,
                    struct proto_OBJECT_SET_result *result)
{
    int status = check_daemon(client, "object.set");

    return status != 0 ? status
                       : cli_call_sync(client, PROTO_METHOD_OBJECT_SET, request, result,
                                       cli_deadline(client, -1));
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
    status = check_settings(client, settings);
    if (status != 0) {
        return status;
    }
    request.what = settings->what;
    COMMON_ATTRIBUTES_COPY(&request, settings);
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
        return cli_fail(client, PCCD_E_INVAL, "object.set: settings is NULL");
    }
    status = call_set(client, &request, &result);
    if (status == 0) {
        settings->what = PCCD_OBJECT_ALL;
        COMMON_ATTRIBUTES_COPY(settings, &result);
    }
    return status;
}

int pccd_pair_ignore(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                     uint32_t object_b, bool ignored)
{
    struct proto_SCENE_IGNORE_request request = {
        .scene = scene, .a = object_a, .b = object_b, .ignored = ignored};
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = check_daemon(client, "scene.ignore");
    return status != 0 ? status
                       : cli_call_sync(client, PROTO_METHOD_SCENE_IGNORE, &request, NULL,
                                       cli_deadline(client, -1));
}
