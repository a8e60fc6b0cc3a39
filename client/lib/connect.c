/* connect.c - a client: options, connect, close, error text. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client.h"
#include "connection.h"
#include "events.h"
#include "launch.h"
#include "link.h"
#include "recorder.h"
#include "records.h" /* asserts that the records have the layout of the wire */
#include "replica.h"
#include "rpc.h"
#include "step.h"

#define CLI_TIMEOUT_MS     30000
#define CLI_TIMEOUT_MS_MAX 3600000
#define CLI_SPIN_US        200u
#define CLI_SPIN_US_MAX    1000u
#define CLI_SLOT_COUNT     4u
#define CLI_RESULT_BYTES   (64ull << 20)
#define CLI_RECONNECT_MS   10000

const char *pccd_status_name(int status)
{
    return proto_status_name(status);
}

const char *pccd_status_text(int status)
{
    return proto_status_text(status);
}

#define CLI_STR_(x) #x
#define CLI_STR(x)  CLI_STR_(x)

const char *pccd_version(void)
{
    return CLI_STR(PCCD_VERSION_MAJOR) "." CLI_STR(PCCD_VERSION_MINOR) "." CLI_STR(
        PCCD_VERSION_PATCH);
}

void pccd_options_init(struct pccd_options *options)
{
    if (options == NULL) {
        return;
    }
    memset(options, 0, sizeof *options);
    options->struct_bytes = sizeof *options;
    options->timeout_ms = CLI_TIMEOUT_MS;
    options->slot_count = CLI_SLOT_COUNT;
    options->result_bytes = CLI_RESULT_BYTES;
    options->reconnect_ms = CLI_RECONNECT_MS;
    /* With one CPU a spin only keeps the daemon from running. */
    options->spin_us = sysconf(_SC_NPROCESSORS_ONLN) > 1 ? CLI_SPIN_US : 0;
}

/* Check what no daemon has to be asked for. */
static int check_options(struct pccd_client *client, const struct pccd_options *asked)
{
    if (asked->timeout_ms < 0 || asked->timeout_ms > CLI_TIMEOUT_MS_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.timeout_ms is %d, not 1 .. %d",
                        asked->timeout_ms, CLI_TIMEOUT_MS_MAX);
    }
    if (asked->reconnect_ms > CLI_TIMEOUT_MS_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.reconnect_ms is %d, not up to %d",
                        asked->reconnect_ms, CLI_TIMEOUT_MS_MAX);
    }
    if (asked->slot_count > PROTO_SLOTS_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.slot_count is %u, not 1 .. %u",
                        asked->slot_count, PROTO_SLOTS_MAX);
    }
    if (asked->spin_us > CLI_SPIN_US_MAX) {
        return cli_fail(client, PCCD_E_INVAL, "options.spin_us is %u, not 0 .. %u",
                        asked->spin_us, CLI_SPIN_US_MAX);
    }
    if (asked->result_bytes != 0 && asked->result_bytes < PROTO_RESULT_BYTES_MIN) {
        return cli_fail(client, PCCD_E_INVAL,
                        "options.result_bytes is %llu, less than %u",
                        (unsigned long long)asked->result_bytes, PROTO_RESULT_BYTES_MIN);
    }
    if (asked->slot_bytes != 0 && asked->slot_bytes < PROTO_SLOT_BYTES_MIN) {
        return cli_fail(client, PCCD_E_INVAL, "options.slot_bytes is %llu, less than %u",
                        (unsigned long long)asked->slot_bytes, PROTO_SLOT_BYTES_MIN);
    }
    if (asked->private_daemon && (asked->no_autostart || asked->url != NULL)) {
        return cli_fail(client, PCCD_E_INVAL,
                        "options.private_daemon excludes url and no_autostart");
    }
    return 0;
}

/* Check what the user asked for and fill in what was left open. */
static int take_options(struct pccd_client *client, const struct pccd_options *asked,
                        struct pccd_options *options)
{
    struct pccd_options defaults;
    int status;

    pccd_options_init(&defaults);
    *options = defaults;
    if (asked == NULL) {
        return 0;
    }
    status = cli_struct_read(client, "options", asked, options, sizeof *options);
    status = status != 0 ? status : check_options(client, options);
    if (options->timeout_ms == 0) {
        options->timeout_ms = defaults.timeout_ms;
    }
    if (options->reconnect_ms == 0) {
        options->reconnect_ms = defaults.reconnect_ms;
    }
    if (options->slot_count == 0) {
        options->slot_count = defaults.slot_count;
    }
    if (options->result_bytes == 0) {
        options->result_bytes = defaults.result_bytes;
    }
    if (options->struct_bytes == 0) {
        options->spin_us = defaults.spin_us;
    }
    return status;
}

/* Choose the way by which the options, or the environment, lead to a daemon. */
static int choose_way(struct pccd_client *client, const struct pccd_options *options)
{
    struct cli_link *link = &client->link;
    const char *url = options->url != NULL ? options->url : getenv("PCCD_URL");

    link->no_autostart = options->no_autostart;
    link->observes = options->observes;
    link->patience_ns =
        options->reconnect_ms < 0 ? 0 : (uint64_t)options->reconnect_ms * 1000000u;
    link->daemons_max = options->daemons_max == 0  ? CLI_DAEMONS_MAX
                        : options->daemons_max < 0 ? UINT32_MAX
                                                   : (uint32_t)options->daemons_max;
    if (options->name != NULL) {
        (void)snprintf(link->name, sizeof link->name, "%s", options->name);
    }
    if (options->daemon != NULL) {
        link->daemon = strdup(options->daemon);
        if (link->daemon == NULL) {
            return cli_fail(client, PCCD_E_NOMEM, "no memory for a name");
        }
    }
    bool is_direct = url != NULL && strcmp(url, CLI_DIRECT_URL) == 0;
    if (options->private_daemon && !is_direct) {
        link->way = CLI_WAY_PRIVATE;
        return 0;
    }
    if (url == NULL || (url[0] == '\0' && options->url == NULL)) { /* PCCD_URL= is none */
        link->way = CLI_WAY_USER;
        return 0;
    }
    if (is_direct) { /* of the process alone, as a private daemon is */
        link->way = CLI_WAY_DIRECT;
        link->patience_ns = 0; /* it is never lost */
        return 0;
    }
    link->way = CLI_WAY_URL;
    if (strncmp(url, "unix:", 5) != 0 || url[5] == '\0') {
        return cli_fail(client, PCCD_E_INVAL,
                        "url \"%.200s\" is neither unix:PATH nor direct:", url);
    }
    if (strlen(url + 5) >= CLI_SOCKET_BYTES) {
        return cli_fail(client, PCCD_E_INVAL, "the path of \"%.200s\" is longer than %u",
                        url, CLI_SOCKET_BYTES - 1);
    }
    memcpy(link->path, url + 5, strlen(url + 5) + 1);
    return 0;
}

static int connect_any(struct pccd_client *client, const struct pccd_options *asked)
{
    struct pccd_options options;
    int status = take_options(client, asked, &options);

    if (status != 0) {
        return status;
    }
    client->timeout_ms = options.timeout_ms;
    client->spin_us = options.spin_us;
    client->slots_chosen = asked != NULL && asked->slot_count != 0;
    client->slot_count = options.slot_count;
    client->slot_bytes = options.slot_bytes;
    client->result_bytes = options.result_bytes;
    client->unmap = (struct proto_unmap){options.unmap, options.unmap_context};
    status = choose_way(client, &options);
    if (status == 0) {
        status = cli_link_first(client, cli_deadline(client, -1));
    }
    if (status == 0) {
        client->link.is_established = true;
        client->link.can_restore = client->link.patience_ns > 0 && !options.no_keep;
        client->keeps = client->link.can_restore;
        status = cli_record_environment(client);
    }
    return status;
}

/* An answer has arrived: tell who keeps and who records. */
static void take_answered(struct pccd_client *client, struct cli_call *call)
{
    if (call->status == 0 && !call->recovery) {
        cli_replica_answer(client, call);
        if (client->keeps && cli_call_is_step(call->method) &&
            call->slot != CLI_SLOT_NONE) {
            if (call->method == PROTO_METHOD_BATCH_SUBMIT) {
                cli_positions_leave_out(client, call->slot,
                                        cli_batch_answers(client, call));
            }
            cli_positions_answered(client, call->slot, call->step);
        }
        if (call->method == PROTO_METHOD_SCENE_NEAR) {
            cli_near_answered(client, &call->params.SCENE_NEAR);
        }
    }
    if (client->recorder != NULL) {
        cli_record_answer(client, call);
    }
}

static void take_notified(struct pccd_client *client,
                          const struct proto_envelope *envelope)
{
    switch (envelope->method) {
    case PROTO_NOTE_SCENE_STEP:
        cli_shared_take_step(client, envelope);
        break;
    case PROTO_NOTE_SCENE_HELD:
        cli_shared_held(client, envelope);
        break;
    case PROTO_NOTE_STEP:
        cli_watch_take(client, envelope);
        break;
    default: /* of a newer protocol */
        break;
    }
}

static const struct cli_callbacks callbacks = {
    .recover = cli_recover, .answered = take_answered, .notified = take_notified};

int pccd_connect(const struct pccd_options *options, struct pccd_client **client)
{
    struct pccd_client *made;
    int status;

    if (client == NULL) {
        return cli_fail(NULL, PCCD_E_INVAL, "client is NULL");
    }
    made = calloc(1, sizeof *made);
    if (made == NULL) {
        return cli_fail(NULL, PCCD_E_NOMEM, "no memory for a client");
    }
    made->forks = cli_forks();
    if (cli_turn_init(made) != 0) {
        free(made);
        return cli_fail(NULL, PCCD_E_NOMEM, "no memory for a client");
    }
    made->callbacks = &callbacks;
    made->socket = -1;
    made->fds[0] = made->fds[1] = -1;
    made->owner = getpid();
    made->next_id = 1;
    made->next_serial = 1;
    made->next_step = 1;
    made->page_first = made->page_end = 1;
    made->ring.upload = made->ring.result = (struct proto_memory)PROTO_MEMORY_NONE;
    made->decoder = proto_decoder_new();
    status = made->decoder == NULL
                 ? cli_fail(made, PCCD_E_NOMEM, "no memory for a decoder")
                 : connect_any(made, options);
    if (status != 0) {
        (void)cli_fail(NULL, status, "%s", made->error);
        pccd_close(made);
        return status;
    }
    (void)cli_fail(NULL, 0, "%s", "");
    made->error[0] = '\0';
    *client = made;
    return 0;
}

/* Wait until no other thread is in a call. false: there is nothing to end, or this thread
 * is in one itself, which calls back. */
static bool begin_end(struct pccd_client *client)
{
    CLI_TURN cli_turn = cli_enter_late(client);

    return client != NULL && client->depth <= 1;
}

void pccd_close(struct pccd_client *client)
{
    if (!begin_end(client)) {
        return;
    }
    cli_batch_forget_all(client);
    cli_record_close(client);
    cli_link_bye(client);
    cli_connection_close(client);
    if (client->owner == getpid()) {
        cli_launch_ask_to_end(&client->child);
    }
    cli_page_deinit(client);
    cli_ring_deinit(&client->ring);
    registry_deinit(&client->registry);
    registry_map_deinit(&client->nears);
    cli_user_data_deinit(client);
    cli_shared_deinit(client);
    cli_watch_deinit(client);
    if (client->owner == getpid()) {
        cli_launch_stop(&client->child);
    }
    proto_decoder_free(client->decoder);
    free(client->link.daemon);
    cli_turn_deinit(client);
    free(client);
}

uint32_t pccd_daemon_pid(const struct pccd_client *client)
{
    return client != NULL ? client->pid : 0;
}

const char *pccd_daemon_cpu(const struct pccd_client *client)
{
    return client != NULL ? client->cpu : "";
}

const char *pccd_url(const struct pccd_client *client)
{
    return client != NULL ? client->url : "";
}

int pccd_link(const struct pccd_client *client, struct pccd_link_info *info)
{
    if (client == NULL || info == NULL) {
        return PCCD_E_INVAL;
    }
    *info = client->link.info;
    return 0;
}
