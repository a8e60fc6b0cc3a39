/* rpc.c - requests, and waiting for their replies. */
#include "rpc.h"

#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "connection.h"

static bool is_compute(int method)
{
    return (proto_messages[method].flags & PROTO_F_COMPUTE) != 0;
}

/* Requests whose replies have not come. */
struct inflight {
    uint32_t all, computed, steps;
};

/* Count what is in flight. What is held is, to everybody but recover.c, which sends it
 * again itself. */
static struct inflight count_inflight(const struct pccd_client *client)
{
    struct inflight count = {0};

    for (uint32_t i = 0; i < client->calls_end; i++) {
        const struct cli_call *call = &client->calls[i];

        if (cli_call_is_sent(call) && !(call->held && client->link.is_recovering)) {
            count.all++;
            count.computed += is_compute(call->method);
            count.steps += cli_call_is_step(call->method);
        }
    }
    return count;
}

uint32_t cli_call_inflight(const struct pccd_client *client)
{
    return count_inflight(client).all;
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
        uint64_t now_ns = common_now_ns();
        uint64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
        struct timespec left = {(time_t)(left_ns / 1000000000u),
                                (long)(left_ns % 1000000000u)};
        struct pollfd watched = {.fd = pccd_fd(client), .events = events};
        int ready = ppoll(&watched, 1, &left, NULL);

        if (ready > 0) {
            return 0;
        }
        if (ready == 0) {
            return PCCD_E_TIMEOUT;
        }
        if (errno != EINTR) {
            return cli_lose(client, strerror(errno));
        }
    }
}

/* Wait for a message and handle it, by one system call where the deadline is far. */
static int wait_and_receive(struct pccd_client *client, uint64_t deadline_ns)
{
    uint64_t now_ns = common_now_ns();
    int status;

    if (client->link.way != CLI_WAY_DIRECT && now_ns < deadline_ns &&
        deadline_ns - now_ns > CLI_AWAIT_NS) {
        return cli_await(client);
    }
    status = wait_socket(client, POLLIN, deadline_ns);
    return status == 0 ? cli_receive(client) : status;
}

/* Spins in a row may be for nothing: the step takes longer, or the daemon waits for this
 * very processor. After n of them the next 2^n waits go without. The number of waits from
 * one try to the next is odd, so that of two requests by turns both are tried. */
#define SPINS_IN_VAIN_MAX 8u
#define SPIN_LOOK_NS      10000u

static bool may_spin(struct pccd_client *client)
{
    if (client->waits_unspun > 0) {
        client->waits_unspun--;
        return false;
    }
    return client->spin_us > 0;
}

static void note_spin(struct pccd_client *client, bool was_in_vain)
{
    uint32_t count = was_in_vain ? client->spins_in_vain + 1 : 0;

    client->spins_in_vain = count < SPINS_IN_VAIN_MAX ? count : SPINS_IN_VAIN_MAX;
    client->waits_unspun = count > 0 ? 1u << client->spins_in_vain : 0;
}

/* Spin until a message has come or the budget is spent. done_seq changes a little before
 * the reply comes; reading it costs no system call. It may have changed before done_seen
 * was read, and the reply have come since: so look once more after a while. */
static int spin(struct pccd_client *client, struct proto_upload *upload,
                uint64_t done_seen, uint64_t deadline_ns)
{
    uint64_t now_ns = common_now_ns();
    uint64_t until_ns = now_ns + (uint64_t)client->spin_us * 1000u;
    uint64_t look_ns = now_ns + SPIN_LOOK_NS;

    if (until_ns > deadline_ns) {
        until_ns = deadline_ns;
    }
    for (; now_ns < until_ns && !client->link.is_down; now_ns = common_now_ns()) {
        bool looks = now_ns >= look_ns;
        if (looks || atomic_load(&upload->done_seq.value) != done_seen) {
            look_ns = looks ? UINT64_MAX : look_ns;
            int status = cli_receive(client);

            if (status != PCCD_E_AGAIN) {
                return status;
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
    bool spins =
        upload != NULL && count_inflight(client).computed > 0 && may_spin(client);
    int status = cli_alive(client);

    if (status != 0) {
        return status;
    }
    /* What has just been asked is not answered yet: who will wait need not look. */
    status = client->has_sent && !spins ? PCCD_E_AGAIN : cli_receive(client);
    client->has_sent = false;
    if (client->link.is_down) {
        return client->callbacks->recover(client, deadline_ns);
    }
    if (status == PCCD_E_AGAIN && spins) {
        status = spin(client, upload, done_seen, deadline_ns);
        note_spin(client, status == PCCD_E_AGAIN);
    }
    if (status != PCCD_E_AGAIN || client->link.is_down) {
        return client->link.is_down ? client->callbacks->recover(client, deadline_ns)
                                    : status;
    }
    /* Pairs with the daemon's store to done_seq and load of client_wait: one of the two
     * sides sees the other's, so a reply that is left out because nobody waits is never
     * one that somebody waits for. One that was sent before is there to be read. */
    if (upload != NULL) {
        atomic_store(&upload->client_wait.value, 1);
    }
    do {
        status = wait_and_receive(client, deadline_ns);
        if (status == PCCD_E_TIMEOUT) {
            status = cli_fail(client, PCCD_E_TIMEOUT,
                              "the daemon at %s has not answered in time", client->url);
        }
    } while (status == PCCD_E_AGAIN && !client->link.is_down);
    if (upload != NULL) {
        atomic_store(&upload->client_wait.value, 0);
    }
    return client->link.is_down ? client->callbacks->recover(client, deadline_ns)
                                : status;
}

/* ---- calls ------------------------------------------------------------------------- */

static struct cli_call *free_call(struct pccd_client *client)
{
    for (uint32_t i = 0; i < client->calls_end; i++) {
        if (client->calls[i].state == CLI_CALL_FREE) {
            return &client->calls[i];
        }
    }
    return client->calls_end < CLI_CALLS ? &client->calls[client->calls_end++] : NULL;
}

/* Send the encoded message. While the socket takes nothing the replies must be read: the
 * daemon does not read from a client that does not. */
static int send_encoded(struct pccd_client *client, uint64_t deadline_ns)
{
    for (;;) {
        int status = cli_message_send(client);

        if (status == 0) { /* in the process, the answer is there already */
            client->has_sent = client->link.way != CLI_WAY_DIRECT;
            return 0;
        }
        if (status != PCCD_E_AGAIN) {
            /* What the daemon said before it went is still to be read. */
            while (cli_receive(client) == 0) {
                ;
            }
            return client->dead           ? cli_alive(client)
                   : client->link.is_down ? PCCD_E_DISCONNECTED
                                          : cli_lose(client, proto_status_text(status));
        }
        if (wait_socket(client, POLLIN | POLLOUT, deadline_ns) != 0) {
            return client->link.is_down ? PCCD_E_DISCONNECTED
                   : client->dead
                       ? cli_alive(client)
                       : cli_fail(client, PCCD_E_TIMEOUT,
                                  "the daemon at %s reads nothing", client->url);
        }
        do {
            status = cli_receive(client);
        } while (status == 0 && common_now_ns() < deadline_ns);
        if (status == PCCD_E_DISCONNECTED || client->link.is_down) {
            return PCCD_E_DISCONNECTED;
        }
    }
}

struct cli_call *cli_call_first_held(struct pccd_client *client)
{
    struct cli_call *first = NULL;

    for (uint32_t i = 0; i < client->calls_end; i++) {
        struct cli_call *call = &client->calls[i];

        if (cli_call_is_sent(call) && call->held &&
            (first == NULL || call->serial < first->serial)) {
            first = call;
        }
    }
    return first;
}

static int resend(struct pccd_client *client, struct cli_call *call, uint64_t deadline_ns)
{
    int status =
        proto_encode_request(&client->encoder, call->id, call->method, &call->params);

    if (status != 0) {
        return cli_fail(client, status, "%s does not fit a message",
                        proto_messages[call->method].name);
    }
    call->held = false; /* the answer may come while the message is still being sent */
    status = send_encoded(client, deadline_ns);
    call->held = call->held || (status != 0 && call->state != CLI_CALL_DONE);
    return status;
}

int cli_call_resend_all(struct pccd_client *client, uint64_t deadline_ns)
{
    for (struct cli_call *call; (call = cli_call_first_held(client)) != NULL;) {
        int status = resend(client, call, deadline_ns);

        if (status != 0) {
            return status;
        }
        client->link.info.resent++;
    }
    return 0;
}

bool cli_call_is_step(int method)
{
    return method == PROTO_METHOD_FRAME_SUBMIT || method == PROTO_METHOD_SCENE_NEAR ||
           method == PROTO_METHOD_BATCH_SUBMIT;
}

/* A daemon keeps so many answers for the case that they are lost on their way, and takes
 * so many steps. */
static bool is_full(const struct pccd_client *client, int method)
{
    const struct inflight count = count_inflight(client);
    uint32_t inflight_max =
        client->ring.inflight_max > 0 ? client->ring.inflight_max : PROTO_INFLIGHT_MAX;

    return count.all >= PROTO_REPLIES_KEPT ||
           (cli_call_is_step(method) && count.steps >= inflight_max);
}

int cli_call_send(struct pccd_client *client, int method, const void *request,
                  uint32_t slot, uint64_t deadline_ns, struct cli_call **call)
{
    struct cli_link *link = &client->link;
    struct cli_call *made;
    int status = cli_alive(client);

    while (status == 0 && (link->is_down || is_full(client, method))) {
        status = cli_progress(client, deadline_ns);
    }
    if (status != 0) {
        return status;
    }
    made = free_call(client);
    if (made == NULL) {
        return cli_fail(client, PCCD_E_BUSY, "%u requests wait for answers", CLI_CALLS);
    }
    status = proto_encode_request(&client->encoder, client->next_id, method, request);
    if (status != 0) {
        return cli_fail(client, status, "%s does not fit a message",
                        proto_messages[method].name);
    }
    /* The entry comes first: when the connection is lost, it is sent over the next. */
    assert(made->state == CLI_CALL_FREE && client->next_id != 0);
    made->state = CLI_CALL_SENT;
    assert(method >= 0 && method < PROTO_METHOD_COUNT);
    made->held = false;
    made->waits = false;
    made->recovery = link->is_recovering;
    made->method = method;
    made->serial = client->next_serial++;
    memcpy(&made->params, request, proto_messages[method].request.struct_bytes);
    made->id = client->next_id;
    made->slot = slot;
    made->step = 0;
    made->daemons_ended = 0;
    made->result = NULL;
    made->status = 0;
    made->page = 0;
    made->text[0] = '\0';
    status = send_encoded(client, deadline_ns);
    if (status != 0 && !made->held) {
        made->state = CLI_CALL_FREE;
        return status;
    }
    client->next_id = client->next_id == UINT32_MAX ? 1 : client->next_id + 1;
    *call = made;
    return 0;
}

int cli_call_wait(struct pccd_client *client, struct cli_call *call, uint64_t deadline_ns)
{
    int status = 0;

    while (status == 0 && call->state == CLI_CALL_SENT) {
        status = cli_progress(client, deadline_ns);
    }
    /* The end of the connection is an answer to every call, as its status. */
    return call->state == CLI_CALL_DONE ? 0 : status;
}

int cli_call_finish(struct pccd_client *client, struct cli_call *call)
{
    assert(call->state == CLI_CALL_DONE && !call->held);
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

static int call_and_wait(struct pccd_client *client, int method, const void *request,
                         void *result, uint64_t deadline_ns, uint64_t *page)
{
    struct cli_call *call = NULL;
    int status =
        cli_call_send(client, method, request, CLI_SLOT_NONE, deadline_ns, &call);

    *page = 0;
    if (status != 0) {
        return status;
    }
    call->result = result;
    status = cli_call_wait(client, call, deadline_ns);
    if (status != 0) {
        cli_call_drop(client, call);
        return cli_fail(client, status, "no answer to %s in time",
                        proto_messages[method].name);
    }
    *page = call->page;
    return cli_call_finish(client, call);
}

int cli_call_page(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns, uint64_t *page)
{
    int status = cli_page_check(client);

    *page = 0;
    return status != 0
               ? status
               : call_and_wait(client, method, request, result, deadline_ns, page);
}

int cli_call_sync(struct pccd_client *client, int method, const void *request,
                  void *result, uint64_t deadline_ns)
{
    uint64_t page;

    return call_and_wait(client, method, request, result, deadline_ns, &page);
}

/* ---- several requests at once ------------------------------------------------------ */

static bool has_no_room(const struct cli_pipeline *pipeline, int method)
{
    uint32_t count = pipeline->end - pipeline->first;

    assert(count <= CLI_PIPELINE_MAX && pipeline->computed <= count);
    return count >= (pipeline->is_careful ? 1 : CLI_PIPELINE_MAX) ||
           (is_compute(method) && pipeline->computed >= CLI_PIPELINE_COMPUTED);
}

static int finish_oldest(struct cli_pipeline *pipeline)
{
    struct pccd_client *client = pipeline->client;
    struct cli_call *call = pipeline->calls[pipeline->first % CLI_PIPELINE_MAX];
    int status = cli_call_wait(client, call, cli_deadline(client, -1));

    if (status != 0) {
        return status;
    }
    pipeline->first++;
    assert(pipeline->computed >= is_compute(call->method));
    pipeline->computed -= is_compute(call->method);
    cli_page_release(client, call->page);
    return cli_call_finish(client, call);
}

int cli_pipeline_send(struct cli_pipeline *pipeline, int method, const void *request,
                      uint32_t slot, void *result)
{
    struct pccd_client *client = pipeline->client;
    struct cli_call *call = NULL;
    int status = 0;

    while (status == 0 && has_no_room(pipeline, method)) {
        status = finish_oldest(pipeline);
    }
    if (status == 0) {
        status =
            cli_call_send(client, method, request, slot, cli_deadline(client, -1), &call);
    }
    if (status != 0) {
        return status;
    }
    call->result = result;
    pipeline->computed += is_compute(method);
    pipeline->calls[pipeline->end++ % CLI_PIPELINE_MAX] = call;
    return 0;
}

int cli_pipeline_end(struct cli_pipeline *pipeline, int status)
{
    while (status == 0 && pipeline->first != pipeline->end) {
        status = finish_oldest(pipeline);
    }
    while (pipeline->first != pipeline->end) {
        cli_call_drop(pipeline->client,
                      pipeline->calls[pipeline->first++ % CLI_PIPELINE_MAX]);
    }
    return status;
}
