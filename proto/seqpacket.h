/* seqpacket.h - sends and receives one message at a time over a Unix socket, with file
 * descriptors beside it.
 *
 * Threads: [any], one per socket and direction at a time.
 */
#ifndef PROTO_SEQPACKET_H
#define PROTO_SEQPACKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define PROTO_FDS_MAX 2

/* The kernel passes at most this many in one message (SCM_MAX_FD). */
#define PROTO_FDS_RECEIVED_MAX 253

/* Send one message. EINTR is retried, SIGPIPE never raised.
 * fds[fd_count] are passed along, fd_count 0 .. PROTO_FDS_MAX; they stay the caller's.
 * Returns 0, PCCD_E_AGAIN (would block, nothing sent), PCCD_E_DISCONNECTED or
 * PCCD_E_SYSTEM (errno is set). */
int proto_send(int socket, const void *message, size_t bytes, const int *fds,
               int fd_count);

/* Receive one message into buffer[capacity] (PROTO_MESSAGE_BYTES_MAX).
 * fds == NULL: any descriptor is closed and counted in *fd_count.
 * fds != NULL: up to PROTO_FDS_MAX are stored, close-on-exec; surplus ones are closed,
 * and *fd_count is the number that came, surplus included.
 * Returns 0 with *bytes >= 1, PCCD_E_AGAIN, PCCD_E_DISCONNECTED (end of file, a
 * zero-length datagram counts as one), PCCD_E_BADMSG (truncated: longer than capacity) or
 * PCCD_E_SYSTEM. */
int proto_receive(int socket, void *buffer, size_t capacity, size_t *bytes, int *fds,
                  int *fd_count);

/* Receive as proto_receive does, but wait for a message as long as the socket's
 * SO_RCVTIMEO has it, 0 for ever, if the socket blocks (one call in the place of poll and
 * proto_receive). Then, and when a signal was handled meanwhile, PCCD_E_AGAIN. */
int proto_await(int socket, void *buffer, size_t capacity, size_t *bytes, int *fds,
                int *fd_count);

/* Receive as proto_receive and proto_await do with fds == NULL, but uncounted, where none
 * is expected: the kernel has less to do, and closes one that comes after all before the
 * call returns. */
int proto_receive_bare(int socket, void *buffer, size_t capacity, size_t *bytes);
int proto_await_bare(int socket, void *buffer, size_t capacity, size_t *bytes);

/* Have the peer's sendmsg fail with EPERM from here on where it passes descriptors; what
 * it sent before can still bring some. False: the kernel cannot (Linux before 6.16). */
bool proto_refuse_fds(int socket);

/* Receive as proto_receive does, where every descriptor that came is the caller's,
 * whatever is returned: fds[0 .. *fd_count-1]. Closing one may block for as long as its
 * sender likes. */
int proto_receive_all(int socket, void *buffer, size_t capacity, size_t *bytes,
                      int fds[PROTO_FDS_RECEIVED_MAX], int *fd_count);

/* Get the user's socket path: $XDG_RUNTIME_DIR/pccd/pccd.sock, or /tmp/pccd-UID/pccd.sock
 * when the variable is unset (or not absolute). Returns 0 or PCCD_E_LIMIT (longer than
 * capacity or than sockaddr_un holds, 107 bytes). */
int proto_default_socket_path(char *path, size_t capacity);

#endif
