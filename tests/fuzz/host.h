/* host.h - runs the daemon's server as a thread of the fuzzer's process.
 *
 * Threads: one calls; the server has its own.
 */
#ifndef FUZZ_HOST_H
#define FUZZ_HOST_H

/* Start it, once; further calls do nothing. */
void fuzz_host_start(void);

/* The path of its socket. */
const char *fuzz_host_socket(void);

/* A connected, blocking socket. */
int fuzz_host_connect(void);

/* All clients have gone: the server holds nothing more than at the start, soon, and
 * serves an honest one. No allocation may fail meanwhile. */
void fuzz_host_check(void);

#endif
