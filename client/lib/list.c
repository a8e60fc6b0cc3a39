/* list.c - what a daemon tells about itself and about its clients. */
#include <assert.h>
#include <stdlib.h>
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

/* Check that a request may be made: nothing that must be given is NULL. */
static int check(struct pccd_client *client, int method, bool given)
{
    return given ? cli_alive(client)
                 : cli_fail(client, PCCD_E_INVAL, "%s: an argument is NULL",
                            proto_messages[method].name);
}

static int call(struct pccd_client *client, int method, const void *request, void *result)
{
    return cli_call_sync(client, method, request, result, cli_deadline(client, -1));
}

/* ---- lists ------------------------------------------------------------------------- */

/* Daemons that may end while one list is read. */
#define ENDED_MAX 16u

/* Entries are kept until all are there. If another daemon takes the place of the one that
 * is asked, it may have them in another order, and the list is read anew. */
struct list {
    int method;
    uint64_t session; /* that was asked for; 0: the client's own, or no such */
    void *request;
    void *result;
    size_t result_bytes;
    /* Make the request that for the entry behind `result`, NULL: for the first one. 1;
     * 0: `result` is the end; or an error. */
    int (*next)(struct pccd_client *client, void *request, const void *result);
    char *entries; /* results, to be freed */
    size_t count, room;
};

static int keep(struct pccd_client *client, struct list *list)
{
    if (list->count == list->room) {
        size_t room = 2 * list->room + 16;
        char *entries = realloc(list->entries, room * list->result_bytes);

        if (entries == NULL) {
            return cli_fail(client, PCCD_E_NOMEM, "%s: no memory for the list",
                            proto_messages[list->method].name);
        }
        list->entries = entries;
        list->room = room;
    }
    memcpy(list->entries + list->count++ * list->result_bytes, list->result,
           list->result_bytes);
    return 0;
}

/* Another daemon has answered. */
static int begin_anew(struct pccd_client *client, struct list *list, uint32_t ended)
{
    if (list->session != 0) {
        return cli_fail(
            client, PCCD_E_HANDLE, "%s: the daemon that had session %llu has ended",
            proto_messages[list->method].name, (unsigned long long)list->session);
    }
    if (ended == ENDED_MAX) {
        return cli_fail(client, PCCD_E_DISCONNECTED,
                        "%s: %u daemons have ended while it was read",
                        proto_messages[list->method].name, ended);
    }
    list->count = 0;
    return list->next(client, list->request, NULL);
}

/* All entries, none on failure. `given`: as check says. */
static int read_list(struct pccd_client *client, struct list *list, bool given)
{
    int status = check(client, list->method, given);
    uint64_t epoch = status == 0 ? client->link.epoch : 0;
    uint32_t ended = 0;

    status = status == 0 ? list->next(client, list->request, NULL) : status;
    while (status == 1) {
        status = call(client, list->method, list->request, list->result);
        if (status == 0 && client->link.epoch != epoch) {
            epoch = client->link.epoch;
            status = begin_anew(client, list, ++ended);
            continue;
        }
        if (status == 0) {
            status = list->next(client, list->request, list->result);
        }
        if (status == 1) {
            int failed = keep(client, list);

            status = failed != 0 ? failed : 1;
        }
    }
    list->count = status == 0 ? list->count : 0;
    return status;
}

/* The cursor of the next entry, which must grow. */
static int advance(struct pccd_client *client, uint32_t *cursor, uint32_t next)
{
    if (next <= *cursor) {
        return cli_fail(client, PCCD_E_BADMSG, "a list that does not end");
    }
    *cursor = next;
    return 1;
}

/* The next member of a list of handles, `first` being the member that is 0 at its end. */
#define NEXT_OF(METHOD, first)                                                           \
    static int next_##METHOD(struct pccd_client *client, void *request,                  \
                             const void *result)                                         \
    {                                                                                    \
        struct proto_##METHOD##_request *asked = request;                                \
        const struct proto_##METHOD##_result *got = result;                              \
                                                                                         \
        if (got == NULL) {                                                               \
            asked->cursor = 0;                                                           \
            return 1;                                                                    \
        }                                                                                \
        return got->first == 0 ? 0 : advance(client, &asked->cursor, got->next);         \
    }
NEXT_OF(LIST_SCENE, scene)
NEXT_OF(LIST_OBJECT, object)
NEXT_OF(LIST_PAIR, a)
NEXT_OF(LIST_MESH, mesh)

static int next_LIST_SESSION(struct pccd_client *client, void *request,
                             const void *result)
{
    struct proto_LIST_SESSION_request *asked = request;
    const struct proto_LIST_SESSION_result *got = result;

    if (got == NULL || got->session == 0) {
        asked->before = 0;
        return got == NULL;
    }
    if (asked->before != 0 && got->session >= asked->before) { /* numbers only fall */
        return cli_fail(client, PCCD_E_BADMSG, "list.session: not in order");
    }
    asked->before = got->session;
    return 1;
}

/* A list, with its `request` at hand; of a session or, 0, of no other. */
#define LIST_OF(METHOD, of_session)                                                      \
    struct proto_##METHOD##_result result;                                               \
    struct list list = {.method = PROTO_METHOD_##METHOD,                                 \
                        .session = of_session,                                           \
                        .request = &request,                                             \
                        .result = &result,                                               \
                        .result_bytes = sizeof result,                                   \
                        .next = next_##METHOD}

static const void *entry_of(const struct list *list, size_t i)
{
    return list->entries + i * list->result_bytes;
}

int pccd_list_sessions(struct pccd_client *client, pccd_session_fn each, void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_SESSION_request request = {.before = 0};
    LIST_OF(LIST_SESSION, 0);
    int status = read_list(client, &list, each != NULL);

    for (size_t i = 0; i < list.count; i++) {
        const struct proto_LIST_SESSION_result *entry = entry_of(&list, i);
#define GET(type, name, presence, meaning) .name = entry->name,
        const struct pccd_session_info info = {PROTO_LIST_SESSION_RESULT(GET)};
#undef GET

        each(context, &info);
    }
    free(list.entries);
    return status;
}

int pccd_list_scenes(struct pccd_client *client, uint64_t session, pccd_scene_fn each,
                     void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_SCENE_request request = {.session = session};
    LIST_OF(LIST_SCENE, session);
    int status = read_list(client, &list, each != NULL);

    for (size_t i = 0; i < list.count; i++) {
        const struct proto_LIST_SCENE_result *entry = entry_of(&list, i);
        const struct pccd_scene_info info = {
            .scene = entry->scene,
            .objects = entry->objects,
            .steps = entry->steps,
            .number = entry->number,
            .total = entry->total,
            .hash = {entry->hash_hi, entry->hash_lo},
            .ns_step = entry->ns_step,
            .ignored = entry->ignored,
            .name = entry->name,
            .uid = entry->uid,
            .rights = entry->rights,
            .members = entry->members,
            .held = entry->held,
            .writable = entry->writable,
        };

        each(context, &info);
    }
    free(list.entries);
    return status;
}

int pccd_list_objects(struct pccd_client *client, uint64_t session, uint32_t scene,
                      pccd_object_fn each, void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_OBJECT_request request = {.session = session, .scene = scene};
    LIST_OF(LIST_OBJECT, session);
    int status = read_list(client, &list, each != NULL);

    for (size_t i = 0; i < list.count; i++) {
        const struct proto_LIST_OBJECT_result *entry = entry_of(&list, i);
        struct pccd_object_info info = {.object = entry->object,
                                        .mesh = entry->mesh,
                                        .triangles = entry->triangles,
                                        .owner = entry->owner,
                                        .name = entry->name};

        COMMON_ATTRIBUTES_COPY(&info, entry);
        each(context, &info);
    }
    free(list.entries);
    return status;
}

int pccd_list_pairs(struct pccd_client *client, uint64_t session, uint32_t scene,
                    pccd_pair_fn each, void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_PAIR_request request = {.session = session, .scene = scene};
    LIST_OF(LIST_PAIR, session);
    int status = read_list(client, &list, each != NULL);

    for (size_t i = 0; i < list.count; i++) {
        const struct proto_LIST_PAIR_result *entry = entry_of(&list, i);
        const struct pccd_ignored_pair pair = {entry->a, entry->b};

        each(context, &pair);
    }
    free(list.entries);
    return status;
}

int pccd_list_meshes(struct pccd_client *client, uint64_t session, pccd_mesh_fn each,
                     void *context)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_LIST_MESH_request request = {.session = session};
    LIST_OF(LIST_MESH, session);
    int status = read_list(client, &list, each != NULL);

    for (size_t i = 0; i < list.count; i++) {
        const struct proto_LIST_MESH_result *entry = entry_of(&list, i);
        const struct pccd_registered_mesh info = {
            .mesh = entry->mesh,
            .vertex_count = entry->vertex_count,
            .triangle_count = entry->triangle_count,
            .generation = entry->generation,
            .objects = entry->objects,
            .committed = entry->committed,
            .replacing = entry->replacing,
            .edge_count = entry->edge_count,
            .point_count = entry->point_count,
        };

        each(context, &info);
    }
    free(list.entries);
    return status;
}

/* ---- histograms -------------------------------------------------------------------- */

int pccd_histogram(struct pccd_client *client, enum pccd_histogram_kind kind,
                   struct pccd_histogram_info *info)
{
    CLI_ENTER_OR_RETURN(client);
    struct proto_STATS_HISTOGRAM_request request = {.kind = (uint32_t)kind};
    struct proto_STATS_HISTOGRAM_result result;
    int status = check(client, PROTO_METHOD_STATS_HISTOGRAM, info != NULL);

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
    int status = check(client, PROTO_METHOD_CONFIG_GET, each != NULL);

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
    int status = check(client, PROTO_METHOD_CONFIG_SET, name != NULL && value != NULL);

    if (status == 0) {
        status = put(client, request.name, name);
    }
    if (status == 0) {
        status = put(client, request.value, value);
    }
    return status == 0 ? call(client, PROTO_METHOD_CONFIG_SET, &request, NULL) : status;
}
