/* receive.c - what the daemon says. */
#include <assert.h>
#include <stdio.h>

#include "connection.h"
#include "rpc.h"

/* The call that an answer is for. */
static struct cli_call *find_call(struct pccd_client *client, uint32_t id)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->id == id && !call->held && cli_call_is_sent(call)) {
            return call;
        }
    }
    return NULL;
}

/* Return whether it is answered by numbers and a page of records (proto_answer). */
static bool is_answered(const struct cli_call *call)
{
    return call->method == PROTO_METHOD_FRAME_SUBMIT ||
           call->method == PROTO_METHOD_FRAME_FETCH ||
           call->method == PROTO_METHOD_SCENE_NEAR ||
           call->method == PROTO_METHOD_NEAR_FETCH;
}

static uint32_t record_bytes_of(const struct cli_call *call)
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

/* Results with a page that are kept nowhere, when nobody waits for them any more. */
union result {
#define MEMBER(ID, name, since, flags, text) struct proto_##ID##_result ID;
    PROTO_METHODS(MEMBER)
#undef MEMBER
};

/* Return where the result of a call goes. A journal is read by whoever records, also when
 * nobody waits for it any more. */
static void *result_of(struct cli_call *call, union result *unused)
{
    return is_answered(call)                            ? &call->answer
           : call->method == PROTO_METHOD_BATCH_SUBMIT  ? (void *)&call->batch
           : call->method == PROTO_METHOD_SCENE_JOURNAL ? (void *)&call->journal
           : call->result != NULL                       ? call->result
                                                        : (void *)unused;
}

/* The handle that a result brings; not 0 where it brings none. */
static uint32_t handle_in(const struct cli_call *call, const void *result)
{
    const struct proto_SCENE_CREATE_result *scene = result;
    const struct proto_SCENE_ADD_result *object = result;
    const struct proto_MESH_CREATE_result *mesh = result;

    return call->method == PROTO_METHOD_SCENE_CREATE  ? scene->scene
           : call->method == PROTO_METHOD_SCENE_ADD   ? object->object
           : call->method == PROTO_METHOD_MESH_CREATE ? mesh->mesh
                                                      : 1;
}

/* Check what a result must be, whatever a daemon says. */
static int check_result(const struct cli_call *call, const void *result,
                        struct proto_error *error)
{
    if (is_answered(call) && call->answer.count > 0 &&
        call->answer.record_bytes != record_bytes_of(call)) {
        return proto_error_set(error, PCCD_E_BADMSG, "records of %u bytes",
                               call->answer.record_bytes);
    }
    if (call->method == PROTO_METHOD_BATCH_SUBMIT &&
        call->batch.count != call->params.BATCH_SUBMIT.scenes) {
        return proto_error_set(error, PCCD_E_BADMSG, "%llu answers to %u scenes",
                               (unsigned long long)call->batch.count,
                               call->params.BATCH_SUBMIT.scenes);
    }
    return handle_in(call, result) != 0
               ? 0
               : proto_error_set(error, PCCD_E_BADMSG,
                                 "the daemon gives 0, which is no handle");
}

/* The page that a result brings; of a step, without looking for its fields by name. */
static struct proto_page page_of(const struct cli_call *call, const void *result)
{
    const struct proto_answer *answer = &call->answer;
    const struct proto_BATCH_SUBMIT_result *batch = &call->batch;

    if (is_answered(call)) {
        return (struct proto_page){answer->offset, answer->count, answer->release,
                                   answer->record_bytes};
    }
    if (call->method == PROTO_METHOD_BATCH_SUBMIT) {
        return (struct proto_page){batch->offset, batch->count, batch->release,
                                   sizeof(struct pccd_scene_answer)};
    }
    return proto_page_of(call->method, result);
}

/* Return whether the records of a scene lie inside the result region. */
static bool are_inside(const struct pccd_client *client,
                       const struct pccd_scene_answer *scene, uint64_t record_bytes)
{
    uint64_t size = client->ring.result.bytes;

    return scene->count == 0 ||
           (scene->offset % 8 == 0 && scene->offset >= PROTO_SHM_PAGE &&
            scene->offset <= size &&
            scene->count <= (size - scene->offset) / record_bytes);
}

/* The records of a batch, which lie beside its page of answers. */
static int touch_records(struct pccd_client *client, const struct cli_call *call)
{
    const struct pccd_scene_answer *scenes = cli_batch_answers(client, call);
    uint64_t record_bytes = call->params.BATCH_SUBMIT.mode == PCCD_MODE_PAIRS
                                ? sizeof(struct pccd_pair)
                                : sizeof(struct pccd_contact);

    for (uint64_t i = 0; i < call->batch.count; i++) {
        if (!are_inside(client, &scenes[i], record_bytes)) {
            return PCCD_E_BADMSG;
        }
        if (scenes[i].count > 0) {
            proto_memory_touch(&client->ring.result,
                               scenes[i].offset + scenes[i].count * record_bytes);
        }
    }
    return 0;
}

static int take_page(struct pccd_client *client, struct cli_call *call,
                     const void *result)
{
    const struct proto_page page = page_of(call, result);
    uint64_t step =
        call->step != 0 || !is_answered(call) ? call->step : call->answer.step;
    int status = cli_page_add(client, &page, step, &call->page);

    if (status == 0 && call->method == PROTO_METHOD_BATCH_SUBMIT) {
        status = touch_records(client, call);
    }
    if (status != 0) {
        cli_page_release(client, call->page);
        call->page = 0;
    }
    return status;
}

/* The result of a call, and the page that it brings. */
static int take_result(struct pccd_client *client, struct cli_call *call,
                       const struct proto_envelope *envelope, struct proto_error *error)
{
    const struct proto_message_info *info = &proto_messages[call->method];
    bool has_page = (info->flags & PROTO_F_HAS_PAGE) != 0;
    union result unused;
    void *result = result_of(call, &unused);
    int status;

    if (result == &unused && !has_page) {
        return 0;
    }
    status = proto_decode_body(envelope, &info->result, result, error);
    status = status != 0 ? status : check_result(call, result, error);
    if (status != 0 || !has_page) {
        return status;
    }
    status = take_page(client, call, result);
    return status == 0
               ? 0
               : proto_error_set(error, status, "a page outside the result region");
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
    assert(cli_call_is_sent(call));
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
    client->callbacks->answered(client, call);
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
        client->callbacks->notified(client, envelope);
    }
}

/* Nothing more comes, now or for ever. */
static int lost(struct pccd_client *client, const char *why)
{
    int status = cli_lose(client, why);

    return client->link.is_down ? PCCD_E_AGAIN : status;
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
    status = cli_message_receive(client, waits, &bytes, &fd_count);
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
