/* crash_context.h - what each thread is working on, so that a crash report can
 * name it.
 *
 * Threads: [any]; a note is written by one thread.
 */
#ifndef SRV_CRASH_CONTEXT_H
#define SRV_CRASH_CONTEXT_H

#include <stdint.h>

struct srv_crash_context {
    const char *method; /* NULL: none */
    uint64_t session;
    uint32_t id;
};

/* Note that the loop thread, or else the thread that computes with its team, works on
 * that request from now on; `method` NULL: on none. The text must stay. [loop],
 * [compute] */
void srv_crash_context_set(const char *method, uint64_t session, uint32_t id);

/* Return the note of the calling thread's kind. */
const struct srv_crash_context *srv_crash_context_of_thread(void);

#endif
