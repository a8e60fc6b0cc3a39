/* stats.c - how the daemon is: ping and counters. */
#include <stdio.h>
#include <string.h>

#include "client.h"
#include "rpc.h"

int pccd_ping(struct pccd_client *client, uint64_t *round_trip_ns)
{
    struct proto_PING_request request;
    struct proto_PING_result result;
    uint64_t begin_ns;
    int status;

    CLI_ENTER_OR_RETURN(client);
    begin_ns = common_now_ns();
    request.token = begin_ns;
    status = cli_call_sync(client, PROTO_METHOD_PING, &request, &result,
                           begin_ns + (uint64_t)client->timeout_ms * 1000000u);
    if (status != 0) {
        return status;
    }
    if (result.token != request.token) {
        return cli_fail(client, PCCD_E_BADMSG, "ping: another token came back");
    }
    if (round_trip_ns != NULL) {
        *round_trip_ns = common_now_ns() - begin_ns;
    }
    return 0;
}

/* Every whole number of a result, with its name and meaning. */
static void each_number(const struct proto_fields *fields, const void *result,
                        pccd_stat_fn each, void *context)
{
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        const char *value = (const char *)result + field->offset;
        uint32_t narrow = 0;
        uint64_t wide = 0;

        if (field->type == PROTO_TYPE_u32) {
            memcpy(&narrow, value, sizeof narrow);
            each(context, field->name, narrow, field->text);
        } else if (field->type == PROTO_TYPE_u64) {
            memcpy(&wide, value, sizeof wide);
            each(context, field->name, wide, field->text);
        }
    }
}

int pccd_stats(struct pccd_client *client, pccd_stat_fn each, void *context)
{
    const struct proto_fields *fields = &proto_messages[PROTO_METHOD_STATS].result;
    struct proto_STATS_request request = {.reserved = 0};
    struct proto_STATS_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (each == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "stats: each is NULL");
    }
    status = cli_call_sync(client, PROTO_METHOD_STATS, &request, &result,
                           cli_deadline(client, -1));
    if (status != 0) {
        return status;
    }
    each_number(fields, &result, each, context);
    return 0;
}

int pccd_stats_thread(struct pccd_client *client, bool any, uint32_t thread,
                      pccd_stat_fn each, void *context, char tuning[PCCD_TUNING_BYTES])
{
    struct proto_STATS_THREAD_request request = {.thread = thread, .any = any};
    struct proto_STATS_THREAD_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (each == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "stats.thread: each is NULL");
    }
    status = cli_call_sync(client, PROTO_METHOD_STATS_THREAD, &request, &result,
                           cli_deadline(client, -1));
    if (status == 0) {
        each_number(&proto_messages[PROTO_METHOD_STATS_THREAD].result, &result, each,
                    context);
    }
    if (status == 0 && tuning != NULL) {
        (void)snprintf(tuning, PCCD_TUNING_BYTES, "%.*s", PCCD_TUNING_BYTES - 1,
                       result.tuning);
    }
    return status;
}
