/* lifeline.h - lets the supervisor notice the death of its worker within a fraction of a
 * millisecond.
 *
 * Give a supervisor one end of a pair of sockets and its worker the other. The supervisor
 * sees the end of it as soon as no thread of the worker runs any more, but before the
 * worker's other sockets are closed. With a thousand clients closing them takes some 50
 * ms, because each client is woken and takes the processor away. The supervisor also
 * passes another listening socket to the worker over it.
 *
 * Threads: [main] of either process.
 * Source: Linux, kernel/exit.c: do_exit of each thread gives its memory (exit_mm) and
 * then its part in the table of descriptors (exit_files) up; the last one's closes them
 * all, so that by then no thread of the process is in user mode nor ever will be.
 * fs/file.c, close_files goes through them in ascending order, but fput (fs/file_table.c)
 * leaves each to exit_task_work, whose list is a stack: the file with the highest number
 * is let go of first. Measured on 6.18 with 1000 sockets: 0.3 ms after the signal the
 * highest, 8 the lowest.
 */
#ifndef SRV_LIFELINE_H
#define SRV_LIFELINE_H

#include <stdint.h>

/* Make both ends, of a supervisor and of a worker to be, closed on exec. Returns 0 or a
 * status, errno set. */
int srv_lifeline_make(int ends[2]);

/* Hold `fd`, the worker's end, open across exec; negative: none. In a child, before exec.
 * Returns 0 or a status, errno set. */
int srv_lifeline_give(int fd);

/* Take over what this process was given, if it was; no program it starts inherits it. */
void srv_lifeline_take(void);
/* Move the worker's end to the number count - 1, or the next free one, if this process
 * may have it: see above. */
void srv_lifeline_raise(uint32_t count);

/* Return the worker's end; -1: nobody supervises us. */
int srv_lifeline_fd(void);

/* Tell the worker at the other end of `lifeline` to listen on a socket from now on;
 * negative: on none any more. Returns 0 or a status. */
int srv_lifeline_tell(int lifeline, int listen_fd);
/* Hear, in the worker, what was told: *fd is the socket, which is the caller's, or -1.
 * Returns 0, PCCD_E_AGAIN: nothing was told, or another status: the supervisor is
 * gone. */
int srv_lifeline_hear(int *fd);

/* Say that this process is about to end in order: the end of the lifeline is no crash. */
void srv_lifeline_say_end(void);

#endif
