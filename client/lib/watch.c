/* watch.c - steps that a client is told of. */
#include "watch.h"

#include <assert.h>
#include <stdlib.h>

#include "connection.h"
#include "pccd_daemon.h"
#include "rpc.h"
#include "step.h"

#define CLI_WATCH_ROOM 256u

struct cli_watch {
    uint64_t of_session;
    uint32_t of_scene;
    uint64_t epoch; /* of the daemon that was asked */
    uint64_t lost;  /* here, since the step taken last */
    uint32_t first;
    uint32_t count;
    struct pccd_step_event ring[CLI_WATCH_ROOM];
};

void cli_watch_take(struct pccd_client *client, const struct proto_envelope *envelope)
{
    struct cli_watch *watch = client->watch;
    struct proto_STEP_request step;
    struct proto_error error;

    if (watch == NULL ||
        proto_decode_body(envelope, &proto_messages[PROTO_NOTE_STEP].request, &step,
                          &error) != 0) {
        return; /* of a newer protocol, or not wanted any more */
    }
    if (watch->count == CLI_WATCH_ROOM) {
        watch->lost += step.lost + 1;
        return;
    }
    assert(watch->count < CLI_WATCH_ROOM && watch->first < CLI_WATCH_ROOM);
    watch->ring[(watch->first + watch->count++) % CLI_WATCH_ROOM] =
        (struct pccd_step_event){
            .number = step.number,
            .session = step.session,
            .scene = step.scene,
            .status = step.code > INT32_MAX ? PCCD_E_INTERNAL : -(int)step.code,
            .step = step.step,
            .mode = step.mode,
            .incomplete = step.incomplete,
            .verdict = step.verdict,
            .threads = step.threads,
            .total = step.total,
            .hash = {step.hash_hi, step.hash_lo},
            .ns_queue = step.ns_queue,
            .ns_step = step.ns_step,
            .lost = step.lost + watch->lost,
        };
    watch->lost = 0;
}

void cli_watch_deinit(struct pccd_client *client)
{
    free(client->watch);
    client->watch = NULL;
}

/* Ask the daemon that is there now. */
static int ask(struct pccd_client *client)
{
    struct proto_WATCH_START_request request = {.session = client->watch->of_session,
                                                .scene = client->watch->of_scene};
    int status;

    if ((client->link.features & PROTO_FEATURE_OBSERVE) == 0) {
        return cli_fail(client, PCCD_E_VERSION, "watch: %s is too old for it",
                        client->daemon);
    }
    status = cli_call_sync(client, PROTO_METHOD_WATCH_START, &request, NULL,
                           cli_deadline(client, -1));
    client->watch->epoch = client->link.epoch;
    return status;
}

int pccd_watch_start(struct pccd_client *client, uint64_t session, uint32_t scene)
{
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (client->watch == NULL) {
        client->watch = malloc(sizeof *client->watch);
        if (client->watch == NULL) {
            return cli_fail(client, PCCD_E_NOMEM, "no memory for %u steps",
                            CLI_WATCH_ROOM);
        }
    }
    client->watch->of_session = session;
    client->watch->of_scene = scene;
    client->watch->first = client->watch->count = 0;
    client->watch->lost = 0;
    status = ask(client);
    if (status != 0) {
        cli_watch_deinit(client);
    }
    return status;
}

/* Take in what is there, without waiting. 0: there are steps, or another daemon is to be
 * asked. */
static int look(struct pccd_client *client)
{
    cli_step_drain(client);
    if (client->watch->count > 0) {
        return 0;
    }
    if (client->dead) {
        return cli_alive(client);
    }
    return !client->link.is_down && client->watch->epoch != client->link.epoch
               ? 0
               : cli_fail(client, PCCD_E_AGAIN, "no step has been answered");
}

int pccd_watch_next(struct pccd_client *client, int timeout_ms,
                    struct pccd_step_event *event)
{
    uint64_t deadline_ns;
    int status = 0;

    CLI_ENTER_OR_RETURN(client);
    if (client->watch == NULL || event == NULL) {
        return event == NULL
                   ? cli_fail(client, PCCD_E_INVAL, "watch: event is NULL")
                   : cli_fail(client, PCCD_E_STATE, "pccd_watch_start comes first");
    }
    deadline_ns = cli_deadline(client, timeout_ms);
    while (client->watch->count == 0 && status == 0) {
        if (!client->link.is_down && client->watch->epoch != client->link.epoch) {
            status = ask(client); /* the daemon that was asked is gone */
        } else {
            status = timeout_ms == 0 ? look(client) : cli_progress(client, deadline_ns);
        }
    }
    if (client->watch->count == 0) {
        return status;
    }
    *event = client->watch->ring[client->watch->first];
    client->watch->first = (client->watch->first + 1) % CLI_WATCH_ROOM;
    client->watch->count--;
    return 0;
}

int pccd_watch_stop(struct pccd_client *client)
{
    struct proto_WATCH_STOP_request request = {.reserved = 0};
    int status;

    CLI_ENTER_OR_RETURN(client);
    status = cli_call_sync(client, PROTO_METHOD_WATCH_STOP, &request, NULL,
                           cli_deadline(client, -1));
    cli_watch_deinit(client);
    return status;
}
