/* flight.c - requests that are sent one behind the other, and waited for together. */
#include "flight.h"

#include <assert.h>

#include "page.h"

static bool is_computed(int method)
{
    return (proto_messages[method].flags & PROTO_F_COMPUTE) != 0;
}

static bool is_full(const struct cli_flight *flight, int method)
{
    uint32_t count = flight->end - flight->first;

    assert(count <= CLI_FLIGHT_MAX && flight->computed <= count);
    return count >= (flight->is_careful ? 1 : CLI_FLIGHT_MAX) ||
           (is_computed(method) && flight->computed >= CLI_FLIGHT_COMPUTED);
}

static int finish_oldest(struct cli_flight *flight)
{
    struct pccd_client *client = flight->client;
    struct cli_call *call = flight->calls[flight->first % CLI_FLIGHT_MAX];
    int status = cli_call_wait(client, call, cli_deadline(client, -1));

    if (status != 0) {
        return status;
    }
    flight->first++;
    assert(flight->computed >= is_computed(call->method));
    flight->computed -= is_computed(call->method);
    cli_page_release(client, call->page);
    return cli_call_finish(client, call);
}

int cli_flight_send(struct cli_flight *flight, int method, const void *request,
                    uint32_t slot, void *result)
{
    struct pccd_client *client = flight->client;
    struct cli_call *call = NULL;
    int status = 0;

    while (status == 0 && is_full(flight, method)) {
        status = finish_oldest(flight);
    }
    if (status == 0) {
        status =
            cli_call_send(client, method, request, slot, cli_deadline(client, -1), &call);
    }
    if (status != 0) {
        return status;
    }
    call->result = result;
    flight->computed += is_computed(method);
    flight->calls[flight->end++ % CLI_FLIGHT_MAX] = call;
    return 0;
}

int cli_flight_end(struct cli_flight *flight, int status)
{
    while (status == 0 && flight->first != flight->end) {
        status = finish_oldest(flight);
    }
    while (flight->first != flight->end) {
        cli_call_drop(flight->client, flight->calls[flight->first++ % CLI_FLIGHT_MAX]);
    }
    return status;
}
