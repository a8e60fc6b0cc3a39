/* recover.c - another connection when one is lost.
 *
 * The states of a link:
 *
 *     UP -- lost (rpc.c) --> DOWN --- try -----> RECOVERING
 *      ^                      |  ^-- failed, pause --'  |
 *      |                      | patience is over        | hello answered,
 *      |                      v                         | told anew unless resumed,
 *      |                     DEAD                       | all sent again
 *      `------------------------------------------------'
 *
 * Pauses double from 1 ms to 1 s, with a random part, so that a thousand clients of one
 * daemon do not come at the same moment.
 */

#include <assert.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "connection.h"
#include "link.h"
#include "recorder_shared.h"
#include "rpc.h"

/* The longest pause; the first is CLI_PAUSE_NS, each next one twice as long. */
#define CLI_PAUSE_NS_MAX 1000000000u
#define HELLO_NS         100000000u /* for an answer to hello, whatever the deadline */

/* ---- one try ----------------------------------------------------------------------- */

/* Part of a mesh's upload, which another daemon must be sent from the beginning. */
static bool is_upload(const struct cli_call *call)
{
    return call->method == PROTO_METHOD_MESH_CREATE ||
           call->method == PROTO_METHOD_MESH_REPLACE ||
           call->method == PROTO_METHOD_MESH_DATA ||
           call->method == PROTO_METHOD_MESH_COMMIT;
}

/* It gets no answer from any daemon. */
static void end_call(struct pccd_client *client, struct cli_call *call, int status,
                     const char *why)
{
    assert(cli_call_is_sent(call) && call->held);
    if (call->slot != CLI_SLOT_NONE) {
        client->ring.slots[call->slot].state = CLI_SLOT_FREE;
        cli_slot_offer(&client->ring, call->slot);
    }
    call->held = false;
    call->page = 0;
    call->status = status;
    (void)snprintf(call->text, sizeof call->text, "%s: %s",
                   proto_messages[call->method].name, why);
    call->state = call->state == CLI_CALL_LOST ? CLI_CALL_FREE : CLI_CALL_DONE;
}

/* Requests are computed in their order, so that a daemon most likely ended over the first
 * one that it left without an answer. */
static void blame(struct pccd_client *client, struct cli_call *first)
{
    if (first != NULL && is_upload(first)) {
        client->link.uploads_ended++; /* its caller starts over, or gives up (mesh.c) */
    } else if (first != NULL && ++first->daemons_ended >= client->link.daemons_max) {
        end_call(client, first, PCCD_E_DISCONNECTED,
                 "daemon after daemon has ended before it answered");
    }
}

/* Parts of a mesh are nothing to a daemon that was not told of it: whoever sends them
 * starts over (mesh.c). */
static void end_uploads(struct pccd_client *client)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (cli_call_is_sent(call) && call->held && is_upload(call)) {
            end_call(client, call, PCCD_E_AGAIN, "the daemon is another one");
        }
    }
}

/* Forget what this file has sent; hold the rest. */
static void hold_all(struct pccd_client *client, bool rest)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (cli_call_is_sent(call) && call->recovery) {
            call->state = CLI_CALL_FREE;
        } else if (cli_call_is_sent(call) && rest) {
            call->held = true;
        }
    }
}

/* Return whether what is held may go right behind hello: another daemon is to be told of
 * nothing before it, and however hello is answered there is no cause to keep it back. It
 * saves a round trip, and with a thousand clients that come back at once everybody's. */
static bool needs_no_answer(const struct pccd_client *client)
{
    bool needs = !client->keeps || !client->link.can_restore ||
                 client->registry.meshes != NULL || client->registry.scenes != NULL ||
                 client->ring.upload.base != NULL || client->link.tries > 1;

    for (uint32_t i = 0; i < client->calls_end; i++) {
        const struct cli_call *call = &client->calls[i];

        needs =
            needs ||
            (cli_call_is_sent(call) && call->held &&
             (is_upload(call) || call->daemons_ended + 1 >= client->link.daemons_max));
    }
    return !needs;
}

/* Another daemon holds no step for another client yet. */
static void end_waits(struct pccd_client *client)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        client->calls[i].waits = false;
    }
}

static int open_again(struct pccd_client *client, uint64_t deadline_ns, bool *resumed)
{
    struct cli_call *first = cli_call_first_held(client);
    int status = cli_link_again(client, needs_no_answer(client), deadline_ns, resumed);

    if (status != 0 || *resumed) {
        return status;
    }
    if (!client->keeps || !client->link.can_restore) {
        return cli_fail(client, PCCD_E_STATE,
                        "the session is over, and nothing was kept to begin another");
    }
    cli_journal_lost(client);
    end_waits(client);
    status = cli_restore(client);
    if (status != 0) {
        cli_link_forget(client); /* or the next try would go on with half of all */
        return status;
    }
    client->link.told_anew++;
    if (first != NULL) {
        blame(client, first);
    }
    end_uploads(client);
    return 0;
}

static int try_once(struct pccd_client *client, uint64_t deadline_ns)
{
    struct cli_link *link = &client->link;
    bool resumed = false;
    int status;

    assert(link->is_down && !link->is_recovering && !client->dead);
    link->tries++;
    link->is_down = false;
    link->is_recovering = true;
    client->goaway = 0;
    cli_fds_close(client);
    status = open_again(client, deadline_ns, &resumed);
    if (status == 0) {
        status = cli_call_resend_all(client, cli_deadline(client, -1));
    }
    link->is_recovering = false;
    hold_all(client, status != 0);
    if (status != 0) {
        cli_hang_up(client); /* one that was too slow may go on being so */
        link->is_down = true;
        return status;
    }
    link->info.reconnects++;
    link->info.resumed += resumed;
    link->info.gap_ns = common_now_ns() - link->lost_ns;
    return 0;
}

/* ---- again and again --------------------------------------------------------------- */

static bool is_worth_retrying(int status)
{
    return status == PCCD_E_NODAEMON || status == PCCD_E_DISCONNECTED ||
           status == PCCD_E_SHUTDOWN || status == PCCD_E_TIMEOUT ||
           status == PCCD_E_QUOTA || status == PCCD_E_BUSY || status == PCCD_E_NOMEM ||
           status == PCCD_E_SYSTEM || status == PCCD_E_AGAIN;
}

static int give_up(struct pccd_client *client)
{
    const struct cli_link *link = &client->link;
    char last[CLI_TEXT_BYTES];

    memcpy(last, client->error, sizeof last);
    (void)snprintf(client->dead_text, sizeof client->dead_text,
                   "the daemon at %s is gone, after %u tries in %.1f s: %.300s",
                   client->url, link->tries,
                   (double)(common_now_ns() - link->lost_ns) * 1e-9, last);
    return cli_die(client);
}

/* Between half of the pause and one and a half. */
static void plan_next(struct pccd_client *client)
{
    struct cli_link *link = &client->link;
    uint64_t now_ns = common_now_ns();
    uint64_t chance = (now_ns ^ (uint64_t)getpid() << 32 ^ (uint64_t)(uintptr_t)client) *
                          0x9e3779b97f4a7c15u >>
                      32;

    assert(link->pause_ns >= CLI_PAUSE_NS && link->pause_ns <= CLI_PAUSE_NS_MAX);
    link->retry_ns = now_ns + link->pause_ns / 2 + chance % link->pause_ns;
    link->pause_ns =
        link->pause_ns * 2 < CLI_PAUSE_NS_MAX ? link->pause_ns * 2 : CLI_PAUSE_NS_MAX;
}

/* Try once, now: 0, PCCD_E_AGAIN (there is a next time) or PCCD_E_DISCONNECTED. */
static int try_now(struct pccd_client *client, uint64_t deadline_ns)
{
    const struct cli_link *link = &client->link;
    uint64_t end_ns = link->lost_ns + link->patience_ns;
    uint64_t least_ns = common_now_ns() + HELLO_NS;
    int status;

    deadline_ns = deadline_ns < least_ns ? least_ns : deadline_ns;
    status = try_once(client, deadline_ns < end_ns ? deadline_ns : end_ns);
    if (status == 0) {
        return 0;
    }
    plan_next(client);
    if (!is_worth_retrying(status) || common_now_ns() >= end_ns) {
        return give_up(client);
    }
    return PCCD_E_AGAIN;
}

int cli_recover(struct pccd_client *client, uint64_t deadline_ns)
{
    struct cli_link *link = &client->link;
    uint64_t end_ns = link->lost_ns + link->patience_ns;

    if (link->is_recovering) {
        return PCCD_E_DISCONNECTED; /* whoever is at it starts over */
    }
    for (;;) {
        uint64_t now_ns = common_now_ns();
        uint64_t until_ns = link->retry_ns < deadline_ns ? link->retry_ns : deadline_ns;

        if (now_ns >= end_ns) {
            return give_up(client);
        }
        if (now_ns >= link->retry_ns) {
            int status = try_now(client, deadline_ns);

            if (status != PCCD_E_AGAIN) {
                return status;
            }
        } else if (now_ns >= deadline_ns) {
            return cli_fail(client, PCCD_E_TIMEOUT, "%s, and not back yet",
                            client->dead_text);
        } else {
            until_ns = until_ns < end_ns ? until_ns : end_ns;
            cli_sleep_ns(until_ns - now_ns);
        }
    }
}

void cli_recover_poll(struct pccd_client *client)
{
    struct cli_link *link = &client->link;

    if (link->is_recovering || !link->is_down) {
        return;
    }
    if (common_now_ns() >= link->lost_ns + link->patience_ns) {
        (void)give_up(client);
    } else if (common_now_ns() >= link->retry_ns) {
        (void)try_now(client, 0);
    } else {
        cli_sleep_ns(CLI_PAUSE_NS); /* whoever watches the descriptor would spin */
    }
}
