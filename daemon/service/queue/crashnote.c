/* crashnote.c - what is being worked on, for whoever reports a crash. */
#include "crashnote.h"

#include "compute.h"
#include "engine.h"
#include "invariant.h"

/* Of the loop thread, and of those that compute, by number. Each is written by one. */
static struct srv_crashnote notes[1 + SRV_RUNNERS_MAX];

static struct srv_crashnote *note_of_thread(void)
{
    return &notes[srv_thread_is_loop() ? 0 : 1 + eng_payer()->number];
}

void srv_crash_note(const char *method, uint64_t session, uint32_t id)
{
    *note_of_thread() = (struct srv_crashnote){method, session, id};
}

const struct srv_crashnote *srv_crashnote_of_thread(void)
{
    return note_of_thread();
}
