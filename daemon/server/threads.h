/* threads.h - how many threads the system grants, and how soon one gets a processor.
 *
 * Threads: [loop], before the threads are made.
 */
#ifndef SRV_THREADS_H
#define SRV_THREADS_H

#include <stdint.h>

#define SRV_OWN_THREADS 3u /* the compute thread, that of pages and that of descriptors */

/* Return the size of the team that can be had with `own` threads besides, of which the
 * one that computes belongs to it: `wanted`, or less, and then it is said; at least 1. */
uint32_t srv_threads_granted(uint32_t wanted, uint32_t own);

/* Return on how many processors the threads could run if whoever started the process had
 * not bound it to fewer: those of its cpuset. 0: not known. */
uint32_t srv_processors_allowed(void);

/* ---- Sets how soon a thread gets a processor (its scheduling priority).
 *
 * Set it for the calling thread alone, with no rights beyond those of a user. Where the
 * system does not know or allow it, nothing is returned: answers come later, but are
 * right. */

/* Let this thread run when it is woken, and not when the next tick (4 ms) takes the
 * processor from one that computes: its work is urgent and takes microseconds. It gets no
 * more time than others do. Not in the sandbox. */
void srv_priority_prompt(void);

/* Let this thread sleep as long as it says, not up to 50 us longer. Not in the
 * sandbox. */
void srv_priority_punctual(void);

/* Let this thread, whose work can wait, get a tenth of what another one beside it
 * gets. */
void srv_priority_behind(void);

#endif
