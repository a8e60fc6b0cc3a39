/* rpc.c - requests and their replies.
 *
 * Room:     client/lib. May include: rpc.h, page.h, proto.
 * Does:     the only place that reads and writes the socket. Replies come in any order
 *           and are matched by id; every wait has a deadline; the end of the connection
 *           fails every call that is in flight.
 * Does not: know what the methods mean, but for the pages that some replies bring.
 * Threads:  [owner].
 */
#include "rpc.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "page.h"

static void close_fds(struct pccd_client *client)
{
    for (int i = 0; i < PROTO_FDS_MAX; i++) {
        if (client->fds[i] >= 0) {
            (void)close(client->fds[i]);
        }
        client->fds[i] = -1;
    }
}

/* The connection is lost: whatever was in flight has failed. */
static int die(struct pccd_client *client, const char *why)
{
    client->dead = true;
    if (client->goaway == 0) {
        (void)snprintf(client->dead_text, sizeof(client->dead_text),
                       "the daemon at %s is gone: %s", client->url, why);
    }
    for (uint32_t i = 0; i < CLI_CALLS; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->state == CLI_CALL_LOST) {
            call->state = CLI_CALL_FREE;
        }
        if (call->state != CLI_CALL_SENT) {
            continue;
        }
        call->state = CLI_CALL_DONE;
        call->status = PCCD_E_DISCONNECTED;
        call->page = 0;
        memcpy(call->text, client->dead_text, sizeof(call->text));
    }
    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        if (client->ring.slots[i].state == CLI_SLOT_SENT) {
            client->ring.slots[i].state = CLI_SLOT_FREE;
        }
    }
    return cli_fail(client, PCCD_E_DISCONNECTED, "%s", client->dead_text);
}

int cli_alive(struct pccd_client *client)
{
    if (client->dead) {
        return cli_fail(client, PCCD_E_DISCONNECTED, "%s", client->dead_text);
    }
    return 0;
}

void cli_rpc_close(struct pccd_client *client)
{
    if (client->socket >= 0) {
        (void)close(client->socket);
    }
    client->socket = -1;
    close_fds(client);
    memset(client->calls, 0, sizeof(client->calls));
    client->dead = false;
    client->goaway = 0;
}

uint32_t cli_call_inflight(const struct pccd_client *client)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < CLI_CALLS; i++) {
        count += client->calls[i].state == CLI_CALL_SENT ||
                 client->calls[i].state == CLI_CALL_LOST;
    }
    return count;
}

static bool is_compute(int method)
{
    return (proto_messages[method].flags & PROTO_F_COMPUTE) != 0;
}

static uint32_t compute_inflight(const struct pccd_client *client)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < CLI_CALLS; i++) {
        const struct cli_call *call = &client->calls[i];

        count += (call->state == CLI_CALL_SENT || call->state == CLI_CALL_LOST) &&
                 is_compute(call->method);
    }
    return count;
}

/* ---- replies ----------------------------------------------------------------------- */

static struct cli_call *find_call(struct pccd_client *client, uint32_t id)
{
    for (uint32_t i = 0; i < CLI_CALLS; i++) {
        struct cli_call *call = &client->calls[i];

        if (call->id == id &&
            (call->state == CLI_CALL_SENT || call->state == CLI_CALL_LOST)) {
            return call;
        }
    }
    return NULL;
}

/* The result of a call, and the page that it brings. */
static int take_result(struct pccd_client *client, struct cli_call *call,
                       const struct proto_envelope *envelope, struct proto_error *error)
{
    const struct proto_fields *fields = &proto_messages[call->method].result;
    struct proto_FRAME_SUBMIT_result *answer = &call->answer;
    struct proto_MESH_EDGES_result edges;
    struct proto_TRACE_DUMP_result dump;
    int rc;

    switch (call->method) {
    case PROTO_METHOD_FRAME_SUBMIT:
    case PROTO_METHOD_FRAME_FETCH:
        rc = proto_decode_body(envelope, fields, answer, error);
        if (rc == 0 && answer->count > 0 &&
            answer->record_bytes != (answer->mode == PCCD_MODE_PAIRS
                                         ? sizeof(struct pccd_pair)
                                         : sizeof(struct pccd_contact))) {
            return proto_error_set(error, PCCD_E_BADMSG, "records of %u bytes",
                                   answer->record_bytes);
        }
        if (rc == 0) {
            rc = cli_page_add(client, answer->offset, answer->count, answer->record_bytes,
                              answer->release, &call->page);
        }
        break;
    case PROTO_METHOD_MESH_EDGES:
        rc = proto_decode_body(envelope, fields, &edges, error);
        if (rc == 0) {
            rc = cli_page_add(client, edges.offset, edges.count, sizeof(struct pccd_edge),
                              edges.release, &call->page);
        }
        if (rc == 0 && call->result != NULL) {
            memcpy(call->result, &edges, sizeof(edges));
        }
        break;
    case PROTO_METHOD_TRACE_DUMP:
        rc = proto_decode_body(envelope, fields, &dump, error);
        if (rc == 0) {
            rc = cli_page_add(client, dump.offset, dump.count,
                              sizeof(struct pccd_trace_event), dump.release, &call->page);
        }
        if (rc == 0 && call->result != NULL) {
            memcpy(call->result, &dump, sizeof(dump));
        }
        break;
    default:
        return call->result != NULL
                   ? proto_decode_body(envelope, fields, call->result, error)
                   : 0;
    }
    if (rc != 0 && error->text[0] == '\0') {
        (void)proto_error_set(error, rc, "a page outside the result region");
    }
    return rc;
}

/* An answer to nobody: when the daemon closes after it, its last words. */
static void take_last_words(struct pccd_client *client,
                            const struct proto_envelope *envelope)
{
    if (!envelope->failed || !envelope->error.fatal) {
        return;
    }
    client->goaway = envelope->error.code;
    (void)snprintf(client->dead_text, sizeof(client->dead_text),
                   "the daemon at %s says: %s", client->url, envelope->error.text);
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
    if (call->slot != CLI_SLOT_NONE) {
        client->ring.slots[call->slot].state = CLI_SLOT_FREE;
    }
    call->page = 0;
    if (envelope->failed) {
        call->status = envelope->error.code < 0 ? envelope->error.code : PCCD_E_INTERNAL;
    } else {
        call->status = take_result(client, call, envelope, &error);
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
    (void)snprintf(call->text, sizeof(call->text), "%s: %s",
                   proto_messages[call->method].name,
                   text[0] != '\0' ? text : proto_status_text(call->status));
}

static void take_notification(struct pccd_client *client,
                              const struct proto_envelope *envelope)
{
    struct proto_GOAWAY_request goaway;
    struct proto_error error;

    if (envelope->method != PROTO_NOTE_GOAWAY ||
        proto_decode_body(envelope, &proto_messages[PROTO_NOTE_GOAWAY].request, &goaway,
                          &error) != 0) {
        return; /* of a newer protocol */
    }
    client->goaway = goaway.code == 0 || goaway.code > INT32_MAX ? PCCD_E_DISCONNECTED
                                                                 : -(int)goaway.code;
    (void)snprintf(client->dead_text, sizeof(client->dead_text),
                   "the daemon at %s says: %s", client->url,
                   goaway.text[0] != '\0' ? goaway.text
                                          : proto_status_text(client->goaway));
}

int cli_receive(struct pccd_client *client)
{
    struct proto_envelope envelope;
    struct proto_error error;
    size_t bytes = 0;
    int fd_count = 0;
    int rc;

    if (client->dead) {
        return cli_alive(client);
    }
    rc = proto_receive(client->socket, client->message, sizeof(client->message), &bytes,
                       client->fds, &fd_count);
    /* A peer that closed with our messages unread is a reset first; what it had said
     * before can still be read after it. */
    if (rc == PCCD_E_DISCONNECTED) {
        rc = proto_receive(client->socket, client->message, sizeof(client->message),
                           &bytes, client->fds, &fd_count);
    }
    if (rc == PCCD_E_AGAIN) {
        return rc;
    }
    if (rc == PCCD_E_DISCONNECTED) {
        return die(client, "the connection was closed");
    }
    if (rc != 0) {
        return die(client, proto_status_text(rc));
    }
    for (int i = fd_count; i < PROTO_FDS_MAX; i++) {
        client->fds[i] = -1;
    }
    rc = proto_decode(client->decoder, client->message, bytes, &envelope, &error);
    if (rc != 0) {
        close_fds(client);
        return die(client, error.text);
    }
    if (envelope.kind == PROTO_RESPONSE) {
        struct cli_call *call = find_call(client, envelope.id);
        bool wanted = call != NULL && call->state == CLI_CALL_SENT &&
                      call->method == PROTO_METHOD_SHM_ATTACH;

        take_reply(client, &envelope);
        if (!wanted) {
            close_fds(client);
        }
        return 0;
    }
    close_fds(client);
    if (envelope.kind == PROTO_NOTIFICATION) {
        take_notification(client, &envelope);
    }
    return 0;
}

/* ---- waiting ----------------------------------------------------------------------- */

static void relax(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

/* Wait until the socket has one of `events` (or is closed) or the deadline passes. */
static int wait_socket(struct pccd_client *client, short events, uint64_t deadline_ns)
{
    for (;;) {
        uint64_t now_ns = cli_now_ns();
        uint64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
        struct timespec left = {(time_t)(left_ns / 1000000000u),
                                (long)(left_ns % 1000000000u)};
        struct pollfd watched = {.fd = client->socket, .events = events};
        int ready = ppoll(&watched, 1, &left, NULL);

        if (ready > 0) {
            return 0;
        }
        if (ready == 0) {
            return PCCD_E_TIMEOUT;
        }
        if (errno != EINTR) {
            return die(client, strerror(errno));
        }
    }
}

/* Spin until a message has come or the budget is spent. done_seq changes a little before
 * the reply comes; reading it costs no system call. */
static int spin(struct pccd_client *client, struct proto_upload *upload,
                uint64_t done_seen, uint64_t deadline_ns)
{
    uint64_t until_ns = cli_now_ns() + (uint64_t)client->spin_us * 1000u;

    if (until_ns > deadline_ns) {
        until_ns = deadline_ns;
    }
    while (cli_now_ns() < until_ns) {
        if (atomic_load(&upload->done_seq.value) != done_seen) {
            int rc = cli_receive(client);

            if (rc != PCCD_E_AGAIN) {
                return rc;
            }
        }
        relax();
    }
    return PCCD_E_AGAIN;
}

int cli_progress(struct pccd_client *client, uint64_t deadline_ns)
{
    struct proto_upload *upload = client->ring.upload.base;
    uint64_t done_seen = upload != NULL ? atomic_load(&upload->done_seq.value) : 0;
    int rc = cli_receive(client);

    if (rc == PCCD_E_AGAIN && upload != NULL && client->spin_us > 0 &&
        compute_inflight(client) > 0) {
        rc = spin(client, upload, done_seen, deadline_ns);
    }
    if (rc != PCCD_E_AGAIN) {
        return rc;
    }
    /* Pairs with the daemon's store to done_seq and load of client_wait: one of the two
     * sides sees the other's, so a reply that is left out because nobody waits is never
     * one that somebody waits for. */
    if (upload != NULL) {
        atomic_store(&upload->client_wait.value, 1);
    }
    do {
        rc = cli_receive(client);
        if (rc == PCCD_E_AGAIN && wait_socket(client, POLLIN, deadline_ns) != 0) {
            rc = client->dead ? PCCD_E_DISCONNECTED
                              : cli_fail(client, PCCD_E_TIMEOUT,
                                         "the daemon at %s does not answer", client->url);
        }
    } while (rc == PCCD_E_AGAIN);
    if (upload != NULL) {
        atomic_store(&upload->client_wait.value, 0);
    }
    return rc;
}

/* ---- calls ------------------------------------------------------------------------- */

static struct cli_call *free_call(struct pccd_client *client)
{
    for (uint32_t i = 0; i < CLI_CALLS; i++) {
        if (client->calls[i].state == CLI_CALL_FREE) {
            return &client->calls[i];
        }
    }
    return NULL;
}

/* Send the encoded message. While the socket takes nothing the replies must be read: the
 * daemon does not read from a client that does not. */
static int send_encoded(struct pccd_client *client, uint64_t deadline_ns)
{
    for (;;) {
        int rc = proto_send(client->socket, client->encoder.data, client->encoder.bytes,
                            NULL, 0);

        if (rc == 0) {
            return 0;
        }
        if (rc != PCCD_E_AGAIN) {
            /* What the daemon said before it went is still to be read. */
            while (cli_receive(client) == 0) {
                ;
            }
            return client->dead ? cli_alive(client) : die(client, proto_status_text(rc));
        }
        if (wait_socket(client, POLLIN | POLLOUT, deadline_ns) != 0) {
            return client->dead ? cli_alive(client)
                                : cli_fail(client, PCCD_E_TIMEOUT,
                                           "the daemon at %s reads nothing", client->url);
        }
        do {
            rc = cli_receive(client);
        } while (rc == 0 && cli_now_ns() < deadline_ns);
        if (rc == PCCD_E_DISCONNECTED) {
            return rc;
        }
    }
}

int cli_call_send(struct pccd_client *client, int method, const void *request,
                  uint32_t slot, uint64_t deadline_ns, struct cli_call **call)
{
    uint32_t inflight_max =
        client->ring.inflight_max > 0 ? client->ring.inflight_max : PROTO_INFLIGHT_MAX;
    struct cli_call *made;
    int rc = cli_alive(client);

    while (rc == 0 && is_compute(method) && compute_inflight(client) >= inflight_max) {
        rc = cli_progress(client, deadline_ns);
    }
    if (rc != 0) {
        return rc;
    }
    made = free_call(client);
    if (made == NULL) {
        return cli_fail(client, PCCD_E_BUSY, "%u requests wait for answers", CLI_CALLS);
    }
    rc = proto_encode_request(&client->encoder, client->next_id, method, request);
    if (rc != 0) {
        return cli_fail(client, rc, "%s does not fit a message",
                        proto_messages[method].name);
    }
    rc = send_encoded(client, deadline_ns);
    if (rc != 0) {
        return rc;
    }
    /* Replies that were read meanwhile only free entries, so `made` is still free. */
    made->state = CLI_CALL_SENT;
    made->method = method;
    made->id = client->next_id;
    made->slot = slot;
    made->step = 0;
    made->result = NULL;
    made->status = 0;
    made->page = 0;
    made->text[0] = '\0';
    client->next_id = client->next_id == UINT32_MAX ? 1 : client->next_id + 1;
    *call = made;
    return 0;
}

int cli_call_wait(struct pccd_client *client, struct cli_call *call, uint64_t deadline_ns)
{
    int rc = 0;

    while (rc == 0 && call->state == CLI_CALL_SENT) {
        rc = cli_progress(client, deadline_ns);
    }
    /* The end of the connection is an answer to every call, as its status. */
    return call->state == CLI_CALL_DONE ? 0 : rc;
}

int cli_call_finish(struct pccd_client *client, struct cli_call *call)
{
    call->state = CLI_CALL_FREE;
    if (call->status != 0) {
        return cli_fail(client, call->status, "%s", call->text);
    }
    return 0;
}

void cli_call_drop(struct pccd_client *client, struct cli_call *call)
{
    if (call->state == CLI_CALL_DONE) {
        cli_page_release(client, call->page);
        call->state = CLI_CALL_FREE;
    } else if (call->state == CLI_CALL_SENT) {
        call->state = CLI_CALL_LOST;
        call->result = NULL;
    }
}

int cli_call_page(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns, uint64_t *page)
{
    struct cli_call *call = NULL;
    int rc = cli_call_send(client, method, request, CLI_SLOT_NONE, deadline_ns, &call);

    *page = 0;
    if (rc != 0) {
        return rc;
    }
    call->result = result;
    rc = cli_call_wait(client, call, deadline_ns);
    if (rc != 0) {
        cli_call_drop(client, call);
        return cli_fail(client, rc, "no answer to %s in time",
                        proto_messages[method].name);
    }
    *page = call->page;
    return cli_call_finish(client, call);
}

int cli_call_sync(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns)
{
    uint64_t page;

    return cli_call_page(client, method, request, result, deadline_ns, &page);
}
