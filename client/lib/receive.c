/* receive.c - what the daemon says. */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "connection.h"
#include "rpc.h"

/* The call that an answer is for. */
static struct cli_call *find_call(struct pccd_client *client, uint32_t id)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->id == id && !call->held &&
            (call->state == CLI_CALL_SENT || call->state == CLI_CALL_LOST)) {
            return call;
        }
    }
    return NULL;
}

static size_t record_bytes_of(const struct cli_call *call)
{
    const struct proto_answer *answer = &call->answer;

    if (call->method == PROTO_METHOD_SCENE_NEAR ||
        call->method == PROTO_METHOD_NEAR_FETCH) {
        return answer->what == PCCD_NEAR_VERTICES ? sizeof(double)
                                                  : sizeof(struct pccd_near);
    }
    return answer->mode == PCCD_MODE_PAIRS ? sizeof(struct pccd_pair)
                                           : sizeof(struct pccd_contact);
}

/* The answer of a step, or about what is near, and its first page. */
static int take_answer(struct pccd_client *client, struct cli_call *call,
                       const struct proto_envelope *envelope, struct proto_error *error)
{
    struct proto_answer *answer = &call->answer;
    int status =
        proto_decode_body(envelope, &proto_messages[call->method].result, answer, error);
    if (status != 0) {
        return status;
    }
    if (answer->count > 0 && answer->record_bytes != record_bytes_of(call)) {
        return proto_error_set(error, PCCD_E_BADMSG, "records of %u bytes",
                               answer->record_bytes);
    }
    return cli_page_add(client, answer->offset, answer->count, answer->record_bytes,
                        answer->release, &call->page);
}

/* Whether the records of a scene lie inside the result region. */
static bool are_inside(const struct pccd_client *client,
                       const struct pccd_scene_answer *scene, uint64_t record_bytes)
{
    uint64_t size = client->ring.result.bytes;

    return scene->count == 0 ||
           (scene->offset % 8 == 0 && scene->offset >= PROTO_SHM_PAGE &&
            scene->offset <= size &&
            scene->count <= (size - scene->offset) / record_bytes);
}

/* The answers of a batch, and their records. */
static int take_batch(struct pccd_client *client, struct cli_call *call,
                      const struct proto_envelope *envelope, struct proto_error *error)
{
    const struct proto_BATCH_SUBMIT_request *asked = &call->params.BATCH_SUBMIT;
    struct proto_BATCH_SUBMIT_result *batch = &call->batch;
    uint64_t record_bytes = asked->mode == PCCD_MODE_PAIRS ? sizeof(struct pccd_pair)
                                                           : sizeof(struct pccd_contact);
    int status =
        proto_decode_body(envelope, &proto_messages[call->method].result, batch, error);

    if (status == 0 && batch->count != asked->scenes) {
        status = proto_error_set(error, PCCD_E_BADMSG, "%llu answers to %u scenes",
                                 (unsigned long long)batch->count, asked->scenes);
    }
    if (status == 0) {
        status =
            cli_page_add(client, batch->offset, batch->count,
                         sizeof(struct pccd_scene_answer), batch->release, &call->page);
    }
    for (uint64_t i = 0; status == 0 && i < batch->count; i++) {
        const struct pccd_scene_answer *scene =
            (const void *)((const uint8_t *)client->ring.result.base + batch->offset +
                           i * sizeof *scene);

        if (!are_inside(client, scene, record_bytes)) {
            cli_page_release(client, call->page);
            call->page = 0;
            status = PCCD_E_BADMSG;
        } else if (scene->count > 0) {
            proto_memory_touch(&client->ring.result,
                               scene->offset + scene->count * record_bytes);
        }
    }
    return status;
}

/* Every result that brings a page. */
union result {
#define MEMBER(ID, name, since, flags, text) struct proto_##ID##_result ID;
    PROTO_METHODS(MEMBER)
#undef MEMBER
};

/* A result, and the page that it brings. */
static int take_page(struct pccd_client *client, struct cli_call *call,
                     const struct proto_envelope *envelope, struct proto_error *error)
{
    const struct proto_fields *fields = &proto_messages[call->method].result;
    /* A journal is read by whoever records, also when nobody waits for it any more. */
    void *to = call->method == PROTO_METHOD_SCENE_JOURNAL ? &call->journal : call->result;
    union result result;
    int status = proto_decode_body(envelope, fields, &result, error);
    if (status == 0) {
        const struct proto_page page = proto_page_of(call->method, &result);
        status = cli_page_add(client, page.offset, page.count, page.record_bytes,
                              page.release, &call->page);
    }
    if (status == 0 && to != NULL) {
        memcpy(to, &result, fields->struct_bytes);
    }
    return status;
}

/* A result that brings no page. 0 is the handle of nothing, and is kept nowhere. */
static int take_plain(const struct cli_call *call, const struct proto_envelope *envelope,
                      struct proto_error *error)
{
    const struct proto_fields *fields = &proto_messages[call->method].result;
    const struct proto_SCENE_CREATE_result *scene = call->result;
    const struct proto_SCENE_ADD_result *object = call->result;
    const struct proto_MESH_CREATE_result *mesh = call->result;
    uint32_t handle = 1;
    int status;

    if (call->result == NULL) {
        return 0;
    }
    status = proto_decode_body(envelope, fields, call->result, error);
    if (status != 0) {
        return status;
    }
    if (call->method == PROTO_METHOD_SCENE_CREATE) {
        handle = scene->scene;
    } else if (call->method == PROTO_METHOD_SCENE_ADD) {
        handle = object->object;
    } else if (call->method == PROTO_METHOD_MESH_CREATE) {
        handle = mesh->mesh;
    }
    return handle != 0 ? 0
                       : proto_error_set(error, PCCD_E_BADMSG,
                                         "the daemon gives 0, which is no handle");
}

/* The result of a call, and the page that it brings. */
static int take_result(struct pccd_client *client, struct cli_call *call,
                       const struct proto_envelope *envelope, struct proto_error *error)
{
    const struct proto_message_info *info = &proto_messages[call->method];
    int status;

    if ((info->flags & PROTO_F_HAS_PAGE) == 0) {
        return take_plain(call, envelope, error);
    }
    switch (call->method) {
    case PROTO_METHOD_FRAME_SUBMIT:
    case PROTO_METHOD_FRAME_FETCH:
    case PROTO_METHOD_SCENE_NEAR:
    case PROTO_METHOD_NEAR_FETCH:
        status = take_answer(client, call, envelope, error);
        break;
    case PROTO_METHOD_BATCH_SUBMIT:
        status = take_batch(client, call, envelope, error);
        break;
    default:
        status = take_page(client, call, envelope, error);
        break;
    }
    if (status != 0 && error->text[0] == '\0') {
        (void)proto_error_set(error, status, "a page outside the result region");
    }
    return status;
}

/* An answer to nobody: when the daemon closes after it, its last words. */
static void take_last_words(struct pccd_client *client,
                            const struct proto_envelope *envelope)
{
    if (!envelope->failed || !envelope->error.fatal) {
        return;
    }
    client->goaway = envelope->error.code;
    (void)snprintf(client->dead_text, sizeof client->dead_text,
                   "the daemon at %s says: %s", client->url, envelope->error.text);
}

/* A daemon that is about to go has not begun what it refuses so: it waits for the next
 * one. */
static bool is_for_another_daemon(const struct pccd_client *client,
                                  const struct cli_call *call,
                                  const struct proto_envelope *envelope)
{
    return envelope->failed && envelope->error.code == PCCD_E_SHUTDOWN &&
           client->link.is_established && client->link.patience_ns > 0 && !call->recovery;
}

static void take_reply(struct pccd_client *client, const struct proto_envelope *envelope)
{
    struct cli_call *call = find_call(client, envelope->id);
    struct proto_error error = {0};
    const char *text;

    if (call == NULL) {
        take_last_words(client, envelope);
        return;
    }
    if (is_for_another_daemon(client, call, envelope)) {
        return;
    }
    assert(call->state == CLI_CALL_SENT || call->state == CLI_CALL_LOST);
    assert(call->slot == CLI_SLOT_NONE ||
           client->ring.slots[call->slot].state == CLI_SLOT_SENT);
    if (call->slot != CLI_SLOT_NONE) {
        client->ring.slots[call->slot].state = CLI_SLOT_FREE;
    }
    call->page = 0;
    if (envelope->failed) {
        call->status = envelope->error.code < 0 ? envelope->error.code : PCCD_E_INTERNAL;
    } else {
        call->status = take_result(client, call, envelope, &error);
    }
    client->upcalls->answered(client, call);
    if (call->slot != CLI_SLOT_NONE &&
        client->ring.slots[call->slot].state == CLI_SLOT_FREE) {
        cli_slot_offer(&client->ring, call->slot); /* it is not KEPT */
    }
    if (call->state == CLI_CALL_LOST) {
        cli_page_release(client, call->page);
        call->state = CLI_CALL_FREE;
        return;
    }
    call->state = CLI_CALL_DONE;
    if (call->status == 0) {
        return;
    }
    text = envelope->failed ? envelope->error.text : error.text;
    (void)snprintf(call->text, sizeof call->text, "%s: %s",
                   proto_messages[call->method].name,
                   text[0] != '\0' ? text : proto_status_text(call->status));
}

static void take_goaway(struct pccd_client *client, const struct proto_envelope *envelope)
{
    struct proto_GOAWAY_request goaway;
    struct proto_error error;

    if (proto_decode_body(envelope, &proto_messages[PROTO_NOTE_GOAWAY].request, &goaway,
                          &error) != 0) {
        return;
    }
    client->goaway = goaway.code == 0 || goaway.code > INT32_MAX ? PCCD_E_DISCONNECTED
                                                                 : -(int)goaway.code;
    (void)snprintf(client->dead_text, sizeof client->dead_text,
                   "the daemon at %s says: %s", client->url,
                   goaway.text[0] != '\0' ? goaway.text
                                          : proto_status_text(client->goaway));
}

static void take_notification(struct pccd_client *client,
                              const struct proto_envelope *envelope)
{
    if (envelope->method == PROTO_NOTE_GOAWAY) {
        take_goaway(client, envelope);
    } else {
        client->upcalls->notified(client, envelope);
    }
}

/* Nothing more comes, now or for ever. */
static int lost(struct pccd_client *client, const char *why)
{
    int status = cli_lose(client, why);

    return client->link.is_down ? PCCD_E_AGAIN : status;
}

/* From the socket. Only one answer brings descriptors. */
static int receive_message(struct pccd_client *client, bool waits, size_t *bytes,
                           int *fd_count)
{
    if (client->is_attaching) {
        return (waits ? proto_await : proto_receive)(client->socket, client->message,
                                                     sizeof client->message, bytes,
                                                     client->fds, fd_count);
    }
    *fd_count = 0;
    return (waits ? proto_await_bare : proto_receive_bare)(
        client->socket, client->message, sizeof client->message, bytes);
}

/* One message into client->message, as proto_receive; `waits`: as proto_await. */
static int receive(struct pccd_client *client, bool waits, size_t *bytes, int *fd_count)
{
    int status;

    if (client->link.way == CLI_WAY_DIRECT) {
        return cli_direct_receive(client, bytes, fd_count);
    }
    errno = 0;
    status = receive_message(client, waits, bytes, fd_count);
    /* A peer that closed with our messages unread is a reset first; what it had said
     * before can still be read after it. */
    if (status == PCCD_E_DISCONNECTED && errno == ECONNRESET) {
        status = receive_message(client, false, bytes, fd_count);
    }
    return status;
}

static int take(struct pccd_client *client, bool waits)
{
    struct proto_envelope envelope;
    struct proto_error error;
    size_t bytes = 0;
    int fd_count = 0;
    int status = cli_alive(client);

    if (status != 0) {
        return status;
    }
    if (client->link.is_down) {
        return PCCD_E_AGAIN;
    }
    status = receive(client, waits, &bytes, &fd_count);
    if (status == PCCD_E_AGAIN) {
        return status;
    }
    if (status != 0) {
        return lost(client, status == PCCD_E_DISCONNECTED ? "the connection was closed"
                                                          : proto_status_text(status));
    }
    for (int i = fd_count; i < PROTO_FDS_MAX; i++) {
        client->fds[i] = -1;
    }
    status = proto_decode(client->decoder, client->message, bytes, &envelope, &error);
    if (status != 0) {
        cli_fds_close(client);
        return lost(client, error.text);
    }
    if (envelope.kind == PROTO_RESPONSE) {
        struct cli_call *call = find_call(client, envelope.id);
        bool wanted = call != NULL && call->state == CLI_CALL_SENT &&
                      call->method == PROTO_METHOD_SHM_ATTACH;

        take_reply(client, &envelope);
        if (!wanted) {
            cli_fds_close(client);
        }
        return 0;
    }
    cli_fds_close(client);
    if (envelope.kind == PROTO_NOTIFICATION) {
        take_notification(client, &envelope);
    }
    return 0;
}

int cli_receive(struct pccd_client *client)
{
    return take(client, false);
}

int cli_await(struct pccd_client *client)
{
    return take(client, true);
}
