/* events.c - steps of others, in scenes that are shared and in those that are watched. */
#include "events.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "attach.h"
#include "connection.h"
#include "pccd_daemon.h"
#include "recorder_shared.h"
#include "rpc.h"
#include "step.h"

/* The events of a shared scene that the user was not told yet. */
struct cli_shared {
    uint32_t scene; /* 0: none here */
    struct pccd_scene_news news;
};

#define ROOM_MIN 64u

/* The entry of a scene, or with 0 one that is free; NULL: there is none. */
static struct cli_shared *find_entry(struct pccd_client *client, uint32_t scene)
{
    for (uint32_t i = 0; i < client->shared_room; i++) {
        if (client->shared[i].scene == scene) {
            return &client->shared[i];
        }
    }
    return NULL;
}

/* Make a place for news, with an entry that is free. Return 0 or PCCD_E_NOMEM. */
static int make_room(struct pccd_client *client)
{
    uint32_t room = client->shared_room == 0 ? ROOM_MIN : client->shared_room * 2;
    struct cli_shared *larger;

    if (find_entry(client, 0) != NULL) {
        return 0;
    }
    larger = realloc(client->shared, room * sizeof *larger);
    if (larger == NULL) {
        return PCCD_E_NOMEM;
    }
    memset(larger + client->shared_room, 0,
           (room - client->shared_room) * sizeof *larger);
    client->shared = larger;
    client->shared_room = room;
    return 0;
}

void cli_shared_take_step(struct pccd_client *client,
                          const struct proto_envelope *envelope)
{
    struct proto_SCENE_STEP_request note;
    struct proto_error error;
    struct cli_shared *entry;

    if (proto_decode_body(envelope, &proto_messages[PROTO_NOTE_SCENE_STEP].request, &note,
                          &error) != 0 ||
        note.scene == 0) {
        return;
    }
    entry = find_entry(client, note.scene);
    entry = entry == NULL && make_room(client) == 0 ? find_entry(client, 0) : entry;
    if (entry == NULL) {
        return; /* no memory for it: the next step is told */
    }
    cli_journal_note(client, note.scene);
    assert(entry->scene == 0 || entry->scene == note.scene);
    entry->scene = note.scene;
    entry->news = (struct pccd_scene_news){
        .number = note.number,
        .mode = (enum pccd_mode)note.mode,
        .incomplete = (enum pccd_incomplete)note.incomplete,
        .total = note.total,
        .hash = {note.hash_hi, note.hash_lo},
    };
}

/* A step that may be held; NULL: there is none. */
static struct cli_call *find_frame(struct pccd_client *client, uint64_t step)
{
    struct cli_call *call = cli_step_find(client, step);

    return call != NULL && call->method == PROTO_METHOD_FRAME_SUBMIT ? call : NULL;
}

void cli_shared_held(struct pccd_client *client, const struct proto_envelope *envelope)
{
    struct proto_SCENE_HELD_request note;
    struct proto_error error;
    struct cli_call *call;

    if (proto_decode_body(envelope, &proto_messages[PROTO_NOTE_SCENE_HELD].request, &note,
                          &error) == 0 &&
        (call = find_frame(client, note.step)) != NULL) {
        call->waits = true;
    }
}

int pccd_wait_held(struct pccd_client *client, uint64_t step, int timeout_ms)
{
    uint64_t deadline_ns;
    struct cli_call *call;
    int status = 0;

    CLI_ENTER_OR_RETURN(client);
    deadline_ns = cli_deadline(client, timeout_ms);
    cli_step_drain(client);
    call = find_frame(client, step);
    if (call == NULL && client->dead) {
        return cli_alive(client);
    }
    if (call == NULL || !call->params.FRAME_SUBMIT.hold) {
        return cli_fail(client, PCCD_E_INVAL, "step %llu is not pending, or not to hold",
                        (unsigned long long)step);
    }
    while (status == 0 && !call->waits && call->state == CLI_CALL_SENT) {
        status = timeout_ms == 0
                     ? cli_fail(client, PCCD_E_AGAIN, "step %llu is on its way",
                                (unsigned long long)step)
                     : cli_progress(client, deadline_ns);
    }
    return status;
}

void cli_shared_forget(struct pccd_client *client, uint32_t scene)
{
    struct cli_shared *entry = find_entry(client, scene);

    if (entry != NULL) {
        entry->scene = 0;
    }
}

void cli_shared_deinit(struct pccd_client *client)
{
    free(client->shared);
    client->shared = NULL;
    client->shared_room = 0;
}

int pccd_scene_wait(struct pccd_client *client, uint32_t scene, int timeout_ms,
                    struct pccd_scene_news *news)
{
    struct cli_shared *entry;
    uint64_t deadline_ns;
    int status = 0;

    CLI_ENTER_OR_RETURN(client);
    if (news == NULL || scene == 0) {
        return cli_fail(client, PCCD_E_INVAL, "%s",
                        news == NULL ? "news is NULL" : "there is no scene 0");
    }
    deadline_ns = cli_deadline(client, timeout_ms);
    if (make_room(client) != 0) {
        return cli_fail(client, PCCD_E_NOMEM, "no memory for news of scenes");
    }
    cli_step_drain(client);
    while ((entry = find_entry(client, scene)) == NULL && status == 0) {
        status = timeout_ms != 0 ? cli_progress(client, deadline_ns)
                 : client->dead
                     ? cli_alive(client)
                     : cli_fail(client, PCCD_E_AGAIN,
                                "no other client has stepped scene 0x%x", scene);
    }
    if (entry == NULL) {
        return status;
    }
    *news = entry->news;
    entry->scene = 0;
    return 0;
}

int pccd_scene_read(struct pccd_client *client, uint32_t scene, uint64_t number,
                    uint64_t cursor, struct pccd_answer *answer)
{
    struct proto_FRAME_FETCH_request request = {
        .scene = scene, .cursor = cursor, .number = number};
    int status;

    CLI_ENTER_OR_RETURN(client);
    if (number == 0) {
        return cli_fail(client, PCCD_E_INVAL, "steps count from 1");
    }
    status = cli_ring_ensure(client);
    return status != 0
               ? status
               : cli_answer_fetch(client, PROTO_METHOD_FRAME_FETCH, &request, answer);
}

/* ---- steps that a client watches --------------------------------------------------- */

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
    int status = cli_call_sync(client, PROTO_METHOD_WATCH_START, &request, NULL,
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
