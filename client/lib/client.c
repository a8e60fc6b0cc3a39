/* client.c - what every file of the library uses of a client. */
#include "client.h"

#include <assert.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char connect_error[CLI_TEXT_BYTES];
/* The client that another thread was in a call with when this one called last. Its text
 * is the other thread's meanwhile. */
static _Thread_local const struct pccd_client *refused;

int cli_fail(struct pccd_client *client, int status, const char *format, ...)
{
    char *text = client != NULL ? client->error : connect_error;
    va_list arguments;

    va_start(arguments, format);
    (void)vsnprintf(text, CLI_TEXT_BYTES, format, arguments);
    va_end(arguments);
    return status;
}

uint64_t cli_deadline(const struct pccd_client *client, int timeout_ms)
{
    int wait_ms = timeout_ms < 0 ? client->timeout_ms : timeout_ms;

    return common_now_ns() + (uint64_t)wait_ms * 1000000u;
}

const char *pccd_error_text(const struct pccd_client *client)
{
    if (client != NULL && client == refused) {
        return "another thread is in a call with this client, which belongs to one "
               "thread at a time";
    }
    return client != NULL ? client->error : connect_error;
}

/* ---- whose turn it is -------------------------------------------------------------- */

int cli_turn_init(struct pccd_client *client)
{
    pthread_mutexattr_t attributes;
    int cause = pthread_mutexattr_init(&attributes);

    if (cause == 0) {
        (void)pthread_mutexattr_settype(&attributes, PTHREAD_MUTEX_RECURSIVE);
        cause = pthread_mutex_init(&client->turn, &attributes);
        (void)pthread_mutexattr_destroy(&attributes);
    }
    return cause == 0 ? 0 : PCCD_E_NOMEM;
}

void cli_turn_deinit(struct pccd_client *client)
{
    if (!cli_is_copy(client)) { /* else a thread that is not here may be in a call */
        (void)pthread_mutex_destroy(&client->turn);
    }
}

/* A call that has its turn. In a forked copy there is no other thread to wait for. */
static struct cli_turn begin(struct pccd_client *client)
{
    refused = NULL;
    client->depth++;
    return (struct cli_turn){.client = client};
}

struct cli_turn cli_enter(struct pccd_client *client)
{
    if (client == NULL) {
        return (struct cli_turn){
            .status = cli_fail(NULL, PCCD_E_INVAL, "there is no client: it is NULL")};
    }
    if (cli_is_copy(client)) {
        return (struct cli_turn){.status = 0};
    }
    if (pthread_mutex_trylock(&client->turn) != 0) {
        refused = client;
        return (struct cli_turn){.status = PCCD_E_BUSY};
    }
    return begin(client);
}

struct cli_turn cli_enter_late(struct pccd_client *client)
{
    if (client == NULL || cli_is_copy(client) || pthread_mutex_lock(&client->turn) != 0) {
        return (struct cli_turn){.status = 0};
    }
    return begin(client);
}

void cli_leave(struct cli_turn *turn)
{
    if (turn->client != NULL) {
        turn->client->depth--;
        (void)pthread_mutex_unlock(&turn->client->turn);
    }
    turn->client = NULL;
}

/* ---- forked copies ----------------------------------------------------------------- */

static uint32_t forks; /* written by a forked copy, before it goes on */

static void on_forked(void)
{
    forks++;
}

static void watch_forks(void)
{
    (void)pthread_atfork(NULL, NULL, on_forked);
}

uint32_t cli_forks(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;

    (void)pthread_once(&once, watch_forks);
    return forks;
}

bool cli_is_copy(const struct pccd_client *client)
{
    assert(client->forks <= forks);
    return client->forks != forks;
}

/* ---- the handle that is wanted ----------------------------------------------------- */

uint32_t cli_take_handle(struct pccd_client *client)
{
    uint32_t want = client->want;

    client->want = 0;
    return want;
}

int pccd_request_handle(struct pccd_client *client, uint32_t handle)
{
    CLI_ENTER_OR_RETURN(client);
    client->want = handle;
    return 0;
}

/* ---- structs of other releases ----------------------------------------------------- */

#define STRUCT_BYTES_MAX 4096u /* no release will ever need a longer struct */

static size_t bytes_of(const void *from)
{
    size_t struct_bytes;

    memcpy(&struct_bytes, from, sizeof struct_bytes);
    return struct_bytes;
}

/* No struct has grown since the first release, so that a shorter one is a mistake. The
 * release that makes one longer has to take the former length, too, and to read 0 as the
 * length of the first release. */
int cli_struct_check(struct pccd_client *client, const char *name, const void *to,
                     size_t known_bytes)
{
    size_t struct_bytes = bytes_of(to);

    assert(known_bytes >= sizeof struct_bytes && known_bytes <= STRUCT_BYTES_MAX);
    if (struct_bytes != 0 &&
        (struct_bytes < known_bytes || struct_bytes > STRUCT_BYTES_MAX)) {
        return cli_fail(client, PCCD_E_INVAL, "%s: struct_bytes is %zu, not %zu", name,
                        struct_bytes, known_bytes);
    }
    return 0;
}

int cli_struct_read(struct pccd_client *client, const char *name, const void *asked,
                    void *known, size_t known_bytes)
{
    const unsigned char *bytes = asked;
    int status = cli_struct_check(client, name, asked, known_bytes);

    if (status != 0) {
        return status;
    }
    for (size_t i = known_bytes; i < bytes_of(asked); i++) {
        if (bytes[i] != 0) {
            return cli_fail(client, PCCD_E_INVAL,
                            "%s: something is set that libpccd %s does not know", name,
                            pccd_version());
        }
    }
    memcpy(known, asked, known_bytes);
    return 0;
}

void cli_struct_fill(void *to, const void *known, size_t known_bytes)
{
    size_t to_bytes = bytes_of(to);
    size_t head = sizeof to_bytes;

    assert(to_bytes == 0 || (to_bytes >= known_bytes && to_bytes <= STRUCT_BYTES_MAX));
    memcpy((char *)to + head, (const char *)known + head, known_bytes - head);
    if (to_bytes > known_bytes) {
        memset((char *)to + known_bytes, 0, to_bytes - known_bytes);
    }
}
