/* kept.h - settings that were changed while the daemon ran outlive a crash of the worker.
 *
 * Threads: [main] of either process.
 */
#ifndef SRV_KEPT_H
#define SRV_KEPT_H

struct srv_config_kept;

/* In a supervisor: the memory's descriptor, closed on exec; -1: none is to be had, and a
 * crash loses the changes. */
int srv_kept_make(void);

/* In a child, before exec: let it share the memory of `fd`; negative: none. Returns 0 or
 * a status, errno set. */
int srv_kept_give(int fd);

/* What this process was given, for as long as it runs; NULL: nothing. Once. */
struct srv_config_kept *srv_kept_take(void);

#endif
