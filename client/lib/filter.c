/* filter.c - which objects are tested against each other.
 *
 * Room:     client/lib. May include: rpc.h.
 * Does:     one request each; what has been set is kept as all else is (keep.h).
 * Threads:  [owner].
 */
#include <stddef.h>
#include <string.h>

#include "client.h"
#include "rpc.h"

#define BYTES_MAX 4096u /* of struct_bytes: no release will ever need more */

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

/* A newer program may hold more than this library knows: only its zero. */
static int check_settings(struct pccd_client *client,
                          const struct pccd_object_settings *settings)
{
    const unsigned char *bytes = (const unsigned char *)settings;

    if (settings->struct_bytes != 0 && (settings->struct_bytes < sizeof(*settings) ||
                                        settings->struct_bytes > BYTES_MAX)) {
        return cli_fail(client, PCCD_E_INVAL, "object.set: struct_bytes is %zu, not %zu",
                        settings->struct_bytes, sizeof(*settings));
    }
    for (size_t i = sizeof(*settings); i < settings->struct_bytes; i++) {
        if (bytes[i] != 0) {
            return cli_fail(client, PCCD_E_INVAL,
                            "object.set: the settings hold something that libpccd %s "
                            "does not know",
                            pccd_version());
        }
    }
    if ((settings->what & ~(uint32_t)PCCD_OBJECT_ALL) != 0) {
        return cli_fail(client, PCCD_E_INVAL,
                        "object.set: what is 0x%x, this library knows the bits 0x%x",
                        settings->what, (unsigned)PCCD_OBJECT_ALL);
    }
    return 0;
}

static int call_set(struct pccd_client *client,
                    const struct proto_OBJECT_SET_request *request,
                    struct proto_OBJECT_SET_result *result)
{
    int rc = check_daemon(client, "object.set");

    return rc != 0 ? rc
                   : cli_call_sync(client, PROTO_METHOD_OBJECT_SET, request, result,
                                   cli_deadline(client, -1));
}

int pccd_object_set(struct pccd_client *client, uint32_t scene, uint32_t object,
                    const struct pccd_object_settings *settings)
{
    struct proto_OBJECT_SET_request request = {.scene = scene, .object = object};
    struct proto_OBJECT_SET_result result;
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (settings == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "object.set: settings is NULL");
    }
    rc = check_settings(client, settings);
    if (rc != 0) {
        return rc;
    }
    request.what = settings->what;
    request.group = settings->group;
    request.mask = settings->mask;
    request.self = settings->self_collision;
    return call_set(client, &request, &result);
}

int pccd_object_get(struct pccd_client *client, uint32_t scene, uint32_t object,
                    struct pccd_object_settings *settings)
{
    struct proto_OBJECT_SET_request request = {.scene = scene, .object = object};
    struct proto_OBJECT_SET_result result;
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (settings == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "object.set: settings is NULL");
    }
    rc = call_set(client, &request, &result);
    if (rc == 0) {
        settings->what = PCCD_OBJECT_ALL;
        settings->self_collision = result.self;
        settings->group = result.group;
        settings->mask = result.mask;
    }
    return rc;
}

int pccd_pair_ignore(struct pccd_client *client, uint32_t scene, uint32_t object_a,
                     uint32_t object_b, bool ignored)
{
    struct proto_SCENE_IGNORE_request request = {
        .scene = scene, .a = object_a, .b = object_b, .ignored = ignored};
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    rc = check_daemon(client, "scene.ignore");
    return rc != 0 ? rc
                   : cli_call_sync(client, PROTO_METHOD_SCENE_IGNORE, &request, NULL,
                                   cli_deadline(client, -1));
}
