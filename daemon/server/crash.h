/* crash.h - writes a last report when the daemon crashes.
 *
 * On a fatal signal, write version, thread, request and a backtrace to standard error,
 * then die of that signal. The same when a library ends the process: OpenMP's runtime
 * does so when it gets no memory or no thread.
 */
#ifndef SRV_CRASH_H
#define SRV_CRASH_H

/* Handle SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT and SIGSYS, and exit by any thread but
 * the main one; the calling thread gets a stack for it. Once, at the start. */
void srv_crash_install(void);

/* Give the calling thread a stack for the handler, for when its own has overflowed,
 * unless it has one. */
void srv_crash_thread(void);

#endif
