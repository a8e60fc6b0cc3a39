/* priority.h - sets how soon a thread gets a processor (its scheduling priority).
 *
 * Set it for the calling thread alone, with no rights beyond those of a user. Where the
 * system does not know or allow it, nothing is returned: answers come later, but are
 * right.
 *
 * Threads: [any]; threads that it makes afterwards begin like it.
 */
#ifndef SRV_PRIORITY_H
#define SRV_PRIORITY_H

/* This thread's work is urgent and takes microseconds: it is to run when it is woken, and
 * not when the next tick (4 ms) takes the processor from one that computes. It gets no
 * more time than others do. Not in the sandbox. */
void srv_priority_prompt(void);

/* This thread sleeps as long as it says, not up to 50 us longer. Not in the sandbox. */
void srv_priority_punctual(void);

/* This thread's work can wait: beside another it gets a tenth of what that gets. */
void srv_priority_behind(void);

#endif
