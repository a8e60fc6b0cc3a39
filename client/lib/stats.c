/* stats.c - how the daemon is: ping, counters, traces. */
#include <stdio.h>
#include <string.h>

#include "attach.h"
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

/* ---- traces ------------------------------------------------------------------------ */

#define PAGE_EVENTS 16384u /* asked for at a time: half a megabyte */

int pccd_trace_start(struct pccd_client *client, uint32_t events, uint64_t min_ns,
                     struct pccd_trace_info *info)
{
    struct proto_TRACE_START_request request = {.events = events, .min_ns = min_ns};
    struct proto_TRACE_START_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_call_sync(client, PROTO_METHOD_TRACE_START, &request, &result,
                           cli_deadline(client, -1));
    if (status == 0 && info != NULL) {
        *info = (struct pccd_trace_info){.threads = result.threads,
                                         .events_max = result.events};
    }
    return status;
}

int pccd_trace_stop(struct pccd_client *client, struct pccd_trace_info *info)
{
    struct proto_TRACE_STOP_request request = {.reserved = 0};
    struct proto_TRACE_STOP_result result;
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_call_sync(client, PROTO_METHOD_TRACE_STOP, &request, &result,
                           cli_deadline(client, -1));
    if (status == 0 && info != NULL) {
        info->events = result.events;
        info->lost = result.lost;
    }
    return status;
}

/* One page: `each` sees it where it lies, then it is given back. */
static int dump_page(struct pccd_client *client, uint64_t cursor, pccd_trace_fn each,
                     void *context, struct proto_TRACE_DUMP_result *result)
{
    struct proto_TRACE_DUMP_request request = {.cursor = cursor, .count = PAGE_EVENTS};
    uint64_t page;
    int status = cli_call_page(client, PROTO_METHOD_TRACE_DUMP, &request, result,
                               cli_deadline(client, -1), &page);

    if (status == 0 && result->count == 0 && cursor < result->events) {
        status =
            cli_fail(client, PCCD_E_BUSY,
                     "trace.dump: no room in the result region: release answers first");
    }
    if (status == 0 && result->count > 0) {
        const uint8_t *at = cli_page_base(client, page) + result->offset;

        each(context, (const struct pccd_trace_event *)(const void *)at, result->count);
    }
    cli_page_release(client, page);
    return status;
}

int pccd_trace_dump(struct pccd_client *client, pccd_trace_fn each, void *context)
{
    struct proto_TRACE_DUMP_result result = {.count = 0};
    uint64_t cursor = 0;
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (each == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "trace.dump: each is NULL");
    }
    status = cli_ring_ensure(client);
    while (status == 0) { /* every page but the last has an event at least */
        status = dump_page(client, cursor, each, context, &result);
        cursor += status == 0 ? result.count : 0;
        if (status == 0 && cursor >= result.events) {
            break;
        }
    }
    return status;
}

const char *pccd_method_name(uint32_t number)
{
    return number < PROTO_METHOD_COUNT ? proto_messages[number].name : NULL;
}
