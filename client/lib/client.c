/* client.c - what every file of the library uses of a client.
 *
 * Room:     client/lib. May include: client.h.
 * Does:     the text of the last error, the clock, and whether this process is a forked
 *           copy.
 * Does not: make or end a client (connect.c).
 * Threads:  [owner].
 */
#include "client.h"

#include <assert.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <time.h>

static _Thread_local char connect_error[CLI_TEXT_BYTES];

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
    return client != NULL ? client->error : connect_error;
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

uint32_t cli_take_want(struct pccd_client *client)
{
    uint32_t want = client->want;

    client->want = 0;
    return want;
}

int pccd_want(struct pccd_client *client, uint32_t handle)
{
    if (client == NULL) {
        return PCCD_E_INVAL;
    }
    client->want = handle;
    return 0;
}
