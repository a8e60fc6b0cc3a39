/* list.c - what a daemon tells about itself and about its clients.
 *
 * Room:     client/lib. May include: rpc.h, proto.
 * Does:     lists, one request an entry; settings; histograms.
 * Does not: keep anything of it.
 * Threads:  [owner].
 */
#include <assert.h>
#include <string.h>

#include "connection.h"
#include "pccd_daemon.h"
#include "rpc.h"

int pccd_daemon(const struct pccd_client *client, struct pccd_daemon_info *info)
{
    if (client == NULL || info == NULL) {
        return PCCD_E_INVAL;
    }
    *info = (struct pccd_daemon_info){
        .name = client->daemon,
        .cpu = client->cpu,
        .pid = client->pid,
        .version = client->version,
        .threads_max = client->threads_max,
        .features = client->link.features,
        .epoch = client->link.epoch,
        .session = client->session,
    };
    return 0;
}

/* A request that may be made: nothing that must be given is NULL, and the daemon knows
 * the method. */
static int check(struct pccd_client *client, const char *what, bool given)
{
    int status;

    if (!given) {
        return cli_fail(client, PCCD_E_INVAL, "%s: an argument is NULL", what);
    }
    status = cli_alive(client);
    if (status == 0 && (client->link.features & PROTO_FEATURE_OBSERVE) == 0) {
        status = cli_fail(client, PCCD_E_VERSION, "%s: %s is too old for it", what,
                          client->daemon);
    }
    return status;
}

static int call(struct pccd_client *client, int method, const void *request, void *result)
{
    return cli_call_sync(client, method, request, result, cli_deadline(client, -1));
}

/* ---- lists ------------------------------------------------------------------------- */

static struct pccd_session_info
session_info(const struct proto_LIST_SESSION_result *result)
{
    return (struct pccd_session_info){
        .session = result->session,
        .client = result->client,
        .uid = result->uid,
        .pid = result->pid,
        .waiting = result->waiting,
        .ns_open = result->ns_open,
        .scenes = result->scenes,
        .objects = result->objects,
        .meshes = result->meshes,
        .requests = result->requests,
        .triangles = result->triangles,
        .shm_bytes = result->shm_bytes,
        .errors = result->errors,
        .steps = result->steps,
        .steps_incomplete = result->steps_incomplete,
        .contacts = result->contacts,
        .upload_bytes = result->upload_bytes,
        .result_bytes = result->result_bytes,
        .ns_queue = result->ns_queue,
        .ns_ingest = result->ns_ingest,
        .ns_refit = result->ns_refit,
        .ns_traversal = result->ns_traversal,
        .ns_tests = result->ns_tests,
        .ns_merge = result->ns_merge,
        .ns_step = result->ns_step,
        .batch = result->batch,
        .batch_done = result->batch_done,
    };
}

int pccd_list_sessions(struct pccd_client *client, pccd_session_fn each, void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_SESSION_request request = {.before = 0};
    struct proto_LIST_SESSION_result result;
    int status = check(client, "list.session", each != NULL);

    while (status == 0) { /* numbers only fall */
        status = call(client, PROTO_METHOD_LIST_SESSION, &request, &result);
        if (status != 0 || result.session == 0) {
            break;
        }
        if (request.before != 0 && result.session >= request.before) {
            return cli_fail(client, PCCD_E_BADMSG, "list.session: not in order");
        }
        const struct pccd_session_info info = session_info(&result);

        each(context, &info);
        request.before = result.session;
    }
    return status;
}

/* The cursor of the next entry, which must grow. */
static int advance(struct pccd_client *client, uint32_t *cursor, uint32_t next)
{
    if (next <= *cursor) {
        return cli_fail(client, PCCD_E_BADMSG, "a list that does not end");
    }
    *cursor = next;
    return 0;
}

int pccd_list_scenes(struct pccd_client *client, uint64_t session, pccd_scene_fn each,
                     void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_SCENE_request request = {.session = session};
    struct proto_LIST_SCENE_result result;
    int status = check(client, "list.scene", each != NULL);

    while (status == 0) {
        status = call(client, PROTO_METHOD_LIST_SCENE, &request, &result);
        if (status != 0 || result.scene == 0) {
            break;
        }
        const struct pccd_scene_info info = {
            .scene = result.scene,
            .objects = result.objects,
            .steps = result.steps,
            .number = result.number,
            .total = result.total,
            .hash = {result.hash_hi, result.hash_lo},
            .ns_step = result.ns_step,
            .ignored = result.ignored,
            .name = result.name,
            .uid = result.uid,
            .rights = result.rights,
            .members = result.members,
            .held = result.held,
            .writable = result.writable,
        };

        each(context, &info);
        status = advance(client, &request.cursor, result.next);
    }
    return status;
}

int pccd_list_objects(struct pccd_client *client, uint64_t session, uint32_t scene,
                      pccd_object_fn each, void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_OBJECT_request request = {.session = session, .scene = scene};
    struct proto_LIST_OBJECT_result result;
    int status = check(client, "list.object", each != NULL);

    while (status == 0) {
        status = call(client, PROTO_METHOD_LIST_OBJECT, &request, &result);
        if (status != 0 || result.object == 0) {
            break;
        }
        struct pccd_object_info info = {.object = result.object,
                                        .mesh = result.mesh,
                                        .triangles = result.triangles,
                                        .owner = result.owner};

        COMMON_ATTRIBUTES_COPY(&info, &result);
        each(context, &info);
        status = advance(client, &request.cursor, result.next);
    }
    return status;
}

int pccd_list_pairs(struct pccd_client *client, uint64_t session, uint32_t scene,
                    pccd_pair_fn each, void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_PAIR_request request = {.session = session, .scene = scene};
    struct proto_LIST_PAIR_result result;
    int status = check(client, "list.pair", each != NULL);

    while (status == 0) {
        status = call(client, PROTO_METHOD_LIST_PAIR, &request, &result);
        if (status != 0 || result.a == 0) {
            break;
        }
        const struct pccd_ignored_pair pair = {result.a, result.b};

        each(context, &pair);
        status = advance(client, &request.cursor, result.next);
    }
    return status;
}

int pccd_list_meshes(struct pccd_client *client, uint64_t session, pccd_mesh_fn each,
                     void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_MESH_request request = {.session = session};
    struct proto_LIST_MESH_result result;
    int status = check(client, "list.mesh", each != NULL);

    while (status == 0) {
        status = call(client, PROTO_METHOD_LIST_MESH, &request, &result);
        if (status != 0 || result.mesh == 0) {
            break;
        }
        const struct pccd_registered_mesh info = {
            .mesh = result.mesh,
            .vertex_count = result.vertex_count,
            .triangle_count = result.triangle_count,
            .generation = result.generation,
            .objects = result.objects,
            .committed = result.committed,
            .replacing = result.replacing,
            .edge_count = result.edge_count,
            .point_count = result.point_count,
        };

        each(context, &info);
        status = advance(client, &request.cursor, result.next);
    }
    return status;
}

/* ---- histograms -------------------------------------------------------------------- */

int pccd_histogram(struct pccd_client *client, enum pccd_histogram_kind kind,
                   struct pccd_histogram_info *info)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_STATS_HISTOGRAM_request request = {.kind = (uint32_t)kind};
    struct proto_STATS_HISTOGRAM_result result;
    int status = check(client, "stats.histogram", info != NULL);

    if (status == 0) {
        status = call(client, PROTO_METHOD_STATS_HISTOGRAM, &request, &result);
    }
    if (status == 0) {
        info->count = result.count;
        info->ns_sum = result.ns_sum;
        static_assert(sizeof result ==
                          offsetof(struct proto_STATS_HISTOGRAM_result, b10) +
                              sizeof info->bucket,
                      "the buckets are the last members");
        memcpy(info->bucket,
               (const char *)&result + offsetof(struct proto_STATS_HISTOGRAM_result, b10),
               sizeof info->bucket);
    }
    return status;
}

/* ---- settings ---------------------------------------------------------------------- */

static int get(struct pccd_client *client, const struct proto_CONFIG_GET_request *request,
               pccd_setting_fn each, void *context, uint32_t *count)
{
    struct proto_CONFIG_GET_result result;
    int status = call(client, PROTO_METHOD_CONFIG_GET, request, &result);

    if (status == 0) {
        const struct pccd_setting setting = {.name = result.name,
                                             .value = result.value,
                                             .text = result.text,
                                             .changed = result.changed};

        each(context, &setting);
        *count = result.count;
    }
    return status;
}

/* Put a string into a field of a request. */
static int put(struct pccd_client *client, char field[PROTO_STR_MAX + 1],
               const char *text)
{
    size_t length = strlen(text);

    if (length > PROTO_STR_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "config: a string of %zu bytes", length);
    }
    memcpy(field, text, length + 1);
    return 0;
}

int pccd_config_get(struct pccd_client *client, const char *name, pccd_setting_fn each,
                    void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_CONFIG_GET_request request = {.index = 0};
    uint32_t count = 1;
    int status = check(client, "config.get", each != NULL);

    if (status == 0 && name != NULL) {
        status = put(client, request.name, name);
        return status == 0 ? get(client, &request, each, context, &count) : status;
    }
    for (; status == 0 && request.index < count; request.index++) {
        status = get(client, &request, each, context, &count);
    }
    return status;
}

int pccd_config_set(struct pccd_client *client, const char *name, const char *value)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_CONFIG_SET_request request = {.name = ""};
    int status = check(client, "config.set", name != NULL && value != NULL);

    if (status == 0) {
        status = put(client, request.name, name);
    }
    if (status == 0) {
        status = put(client, request.value, value);
    }
    return status == 0 ? call(client, PROTO_METHOD_CONFIG_SET, &request, NULL) : status;
}
