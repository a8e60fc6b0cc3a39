/* closer.h - closes descriptors on a thread of its own, because close(2) may block.
 *
 * Close whatever a client has sent or holds. A client can make close(2) block for as long
 * as it likes: it can send a socket that lingers, or a file of a file system that it
 * serves itself, even as an unread message.
 */
#ifndef SRV_CLOSER_H
#define SRV_CLOSER_H

struct srv_closer;

/* Start the thread, all signals blocked in it. NULL: no memory or no thread. [loop] */
struct srv_closer *srv_closer_new(void);

/* Wait a second for what is left, then leave it to the end of the process. [loop] */
void srv_closer_free(struct srv_closer *closer);

/* Close `fd` soon. Waits while there are many that do close. [loop] */
void srv_closer_push(struct srv_closer *closer, int fd);

#endif
