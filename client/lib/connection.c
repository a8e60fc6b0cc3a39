/* connection.c - the connection to a daemon, until it is lost. */
#include "connection.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "launch.h"

void cli_fds_close(struct pccd_client *client)
{
    for (int i = 0; i < PROTO_FDS_MAX; i++) {
        if (client->fds[i] >= 0) {
            (void)close(client->fds[i]);
        }
        client->fds[i] = -1;
    }
}

/* A call whose answer does not come. */
static void fail_call(const struct pccd_client *client, struct cli_call *call)
{
    call->held = false;
    call->page = 0;
    call->status = PCCD_E_DISCONNECTED;
    memcpy(call->text, client->dead_text, sizeof call->text);
    call->state = call->state == CLI_CALL_LOST ? CLI_CALL_FREE : CLI_CALL_DONE;
}

int cli_die(struct pccd_client *client)
{
    client->dead = true;
    client->link.is_down = false;
    for (uint32_t i = 0; i < client->calls_end; i++) {
        if (cli_call_is_sent(&client->calls[i])) {
            fail_call(client, &client->calls[i]);
        }
    }
    for (uint32_t i = 0; i < client->ring.slot_count; i++) {
        if (client->ring.slots[i].state == CLI_SLOT_SENT) {
            client->ring.slots[i].state = CLI_SLOT_FREE;
            cli_slot_offer(&client->ring, i);
        }
    }
    return cli_fail(client, PCCD_E_DISCONNECTED, "%s", client->dead_text);
}

/* Hold what has no answer, for another connection; what recover.c sent itself fails. */
static void hold_calls(struct pccd_client *client)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (cli_call_is_sent(call) && call->recovery) {
            fail_call(client, call);
        } else if (cli_call_is_sent(call)) {
            call->held = true;
        }
    }
}

void cli_hang_up(struct pccd_client *client)
{
    if (client->socket >= 0) {
        (void)shutdown(client->socket, SHUT_RDWR); /* it may be over already */
    }
}

int cli_lose(struct pccd_client *client, const char *why)
{
    struct cli_link *link = &client->link;

    assert(!client->dead); /* it is lost once */
    if (client->goaway == 0) {
        char words[CLI_WORDS_BYTES] = "";

        if (link->way == CLI_WAY_USER || link->way == CLI_WAY_PRIVATE) {
            cli_launch_words(client, link->path, words);
        }
        (void)snprintf(client->dead_text, sizeof client->dead_text,
                       "the daemon at %s is gone: %s%s", client->url, why, words);
    }
    /* A forked copy has no claim on the session. */
    if (!link->is_established || link->patience_ns == 0 || client->owner != getpid()) {
        return cli_die(client);
    }
    cli_hang_up(client);
    hold_calls(client);
    if (!link->is_recovering) {
        link->lost_ns = common_now_ns();
        link->retry_ns = link->lost_ns;
        link->pause_ns = CLI_PAUSE_NS;
        link->tries = 0;
    }
    link->is_down = true;
    memcpy(client->error, client->dead_text, sizeof client->error);
    return PCCD_E_DISCONNECTED;
}

int cli_alive(struct pccd_client *client)
{
    if (cli_is_copy(client) && !client->dead) {
        (void)snprintf(client->dead_text, sizeof client->dead_text,
                       "this process is a copy of the one that connected to the daemon "
                       "at %s: it must connect itself",
                       client->url);
        return cli_die(client);
    }
    if (client->dead) {
        return cli_fail(client, PCCD_E_DISCONNECTED, "%s", client->dead_text);
    }
    return 0;
}

void cli_connection_close(struct pccd_client *client)
{
    if (client->socket >= 0) {
        (void)close(client->socket);
    }
    client->socket = -1;
    cli_direct_close(client);
    cli_fds_close(client);
    memset(client->calls, 0, sizeof client->calls);
    client->dead = false;
    client->goaway = 0;
}

int pccd_fd(const struct pccd_client *client)
{
    if (client == NULL) {
        return -1;
    }
    return client->direct.line != NULL ? cli_direct_descriptor(client) : client->socket;
}

/* ---- messages ---------------------------------------------------------------------- */

int cli_message_send(struct pccd_client *client)
{
    const struct proto_encoder *encoder = &client->encoder;

    return client->link.way == CLI_WAY_DIRECT
               ? cli_direct_send(client, encoder->data, encoder->bytes)
               : proto_send(client->socket, encoder->data, encoder->bytes, NULL, 0);
}

/* From the socket. Only one answer brings descriptors. */
static int receive(struct pccd_client *client, bool waits, size_t *bytes, int *fd_count)
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

int cli_message_receive(struct pccd_client *client, bool waits, size_t *bytes,
                        int *fd_count)
{
    int status;

    if (client->link.way == CLI_WAY_DIRECT) {
        return cli_direct_receive(client, bytes, fd_count);
    }
    errno = 0;
    status = receive(client, waits, bytes, fd_count);
    /* A peer that closed with our messages unread is a reset first; what it had said
     * before can still be read after it. */
    return status == PCCD_E_DISCONNECTED && errno == ECONNRESET
               ? receive(client, false, bytes, fd_count)
               : status;
}
