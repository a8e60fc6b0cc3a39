/* trace.c - recordings of what the daemon does. */
#include "attach.h"
#include "client.h"
#include "page.h"
#include "rpc.h"

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
