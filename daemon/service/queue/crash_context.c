/* crash_context.c - what is being worked on, for whoever reports a crash. */
#include "crash_context.h"

#include "compute.h"
#include "engine.h"
#include "invariant.h"

/* Contexts of the loop thread, and of those that compute, by number. Each is written by
 * one. */
static struct srv_crash_context contexts[1 + SRV_RUNNERS_MAX];

static struct srv_crash_context *context_of_thread(void)
{
    return &contexts[srv_thread_is_loop() ? 0 : 1 + eng_payer()->number];
}

void srv_crash_context_set(const char *method, uint64_t session, uint32_t id)
{
    *context_of_thread() = (struct srv_crash_context){method, session, id};
}

const struct srv_crash_context *srv_crash_context_of_thread(void)
{
    return context_of_thread();
}
