/* stats.c - how the daemon is: ping and counters.
 *
 * Room:     client/lib. May include: rpc.h, proto.
 * Does:     a timed round trip; the counters with names and meanings from the manifest.
 * Threads:  [owner].
 */
#include "client.h"
#include "rpc.h"

int pccd_ping(struct pccd_client *client, uint64_t *round_trip_ns)
{
    struct proto_PING_request request;
    struct proto_PING_result result;
    uint64_t begin_ns;
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    begin_ns = cli_now_ns();
    request.token = begin_ns;
    rc = cli_call_sync(client, PROTO_METHOD_PING, &request, &result,
                       cli_deadline(client, -1));
    if (rc != 0) {
        return rc;
    }
    if (result.token != request.token) {
        return cli_fail(client, PCCD_E_BADMSG, "ping: another token came back");
    }
    if (round_trip_ns != NULL) {
        *round_trip_ns = cli_now_ns() - begin_ns;
    }
    return 0;
}

int pccd_stats(struct pccd_client *client, pccd_stat_fn each, void *context)
{
    const struct proto_fields *fields = &proto_messages[PROTO_METHOD_STATS].result;
    struct proto_STATS_request request = {.reserved = 0};
    struct proto_STATS_result result;
    int rc;

    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    if (each == NULL) {
        return cli_fail(client, PCCD_E_INVAL, "stats: each is NULL");
    }
    rc = cli_call_sync(client, PROTO_METHOD_STATS, &request, &result,
                       cli_deadline(client, -1));
    if (rc != 0) {
        return rc;
    }
    for (uint32_t i = 0; i < fields->count; i++) {
        const struct proto_field *field = &fields->items[i];
        const uint8_t *value = (const uint8_t *)&result + field->offset;

        if (field->type == PROTO_TYPE_u64) {
            each(context, field->name, *(const uint64_t *)(const void *)value,
                 field->text);
        }
    }
    return 0;
}
