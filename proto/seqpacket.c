/* seqpacket.c - one message in, one message out, descriptors beside it. */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "pccd_types.h"
#include "seqpacket.h"

static int status_of_errno(int cause)
{
    switch (cause) {
    case EINTR: /* of a wait: its timeout would begin anew with every signal */
    case EAGAIN:
#if EWOULDBLOCK != EAGAIN
    case EWOULDBLOCK:
#endif
        return PCCD_E_AGAIN;
    case EPIPE:
    case ECONNRESET:
    case ECONNREFUSED:
    case ENOTCONN:
        return PCCD_E_DISCONNECTED;
    default:
        return PCCD_E_SYSTEM;
    }
}

static ssize_t send_with_fds(int socket, const void *message, size_t bytes,
                             const int *fds, int fd_count)
{
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(PROTO_FDS_MAX * sizeof(int))];
    } control = {.bytes = {0}};
    size_t fd_bytes = (size_t)fd_count * sizeof(int);
    struct iovec iov = {.iov_base = (void *)message, .iov_len = bytes};
    struct msghdr header = {.msg_iov = &iov,
                            .msg_iovlen = 1,
                            .msg_control = control.bytes,
                            .msg_controllen = CMSG_SPACE(fd_bytes)};
    struct cmsghdr *cmsg = CMSG_FIRSTHDR(&header);

    cmsg->cmsg_level = SOL_SOCKET;
    cmsg->cmsg_type = SCM_RIGHTS;
    cmsg->cmsg_len = CMSG_LEN(fd_bytes);
    memcpy(CMSG_DATA(cmsg), fds, fd_bytes);
    return sendmsg(socket, &header, MSG_NOSIGNAL | MSG_DONTWAIT);
}

int proto_send(int socket, const void *message, size_t bytes, const int *fds,
               int fd_count)
{
    ssize_t sent;

    assert(bytes > 0 && fd_count >= 0 && fd_count <= PROTO_FDS_MAX);
    do {
        /* Nearly every message goes alone: by sendto the kernel has less to read. */
        sent = fd_count == 0
                   ? sendto(socket, message, bytes, MSG_NOSIGNAL | MSG_DONTWAIT, NULL, 0)
                   : send_with_fds(socket, message, bytes, fds, fd_count);
    } while (sent < 0 && errno == EINTR);
    return sent < 0 ? status_of_errno(errno) : 0;
}

/* Store every descriptor in `header`; returns how many came. */
static int take_fds(struct msghdr *header, int fds[PROTO_FDS_RECEIVED_MAX])
{
    int count = 0;
    for (struct cmsghdr *cmsg = CMSG_FIRSTHDR(header); cmsg != NULL;
         cmsg = CMSG_NXTHDR(header, cmsg)) {
        if (cmsg->cmsg_level != SOL_SOCKET || cmsg->cmsg_type != SCM_RIGHTS) {
            continue;
        }
        size_t in_block = (cmsg->cmsg_len - CMSG_LEN(0)) / sizeof(int);
        assert(in_block <= (size_t)(PROTO_FDS_RECEIVED_MAX - count));
        memcpy(fds + count, CMSG_DATA(cmsg), in_block * sizeof(int));
        count += (int)in_block;
    }
    return count;
}

static int receive_all(int socket, struct iovec buffer, size_t *bytes,
                       int fds[PROTO_FDS_RECEIVED_MAX], int *fd_count, int flags)
{
    /* Room for as many as can come, so that each is seen, counted and closed. */
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(PROTO_FDS_RECEIVED_MAX * sizeof(int))];
    } control;
    struct msghdr header;
    ssize_t got;

    *fd_count = 0;
    do {
        header = (struct msghdr){.msg_iov = &buffer,
                                 .msg_iovlen = 1,
                                 .msg_control = control.bytes,
                                 .msg_controllen = sizeof control.bytes};
        got = recvmsg(socket, &header, flags | MSG_CMSG_CLOEXEC);
    } while (got < 0 && errno == EINTR && flags == MSG_DONTWAIT);
    if (got < 0) {
        return status_of_errno(errno);
    }
    *fd_count = take_fds(&header, fds);
    if (got == 0 || (header.msg_flags & MSG_TRUNC) != 0) {
        return got == 0 ? PCCD_E_DISCONNECTED : PCCD_E_BADMSG;
    }
    *bytes = (size_t)got;
    return 0;
}

int proto_receive_all(int socket, void *buffer, size_t capacity, size_t *bytes,
                      int fds[PROTO_FDS_RECEIVED_MAX], int *fd_count)
{
    return receive_all(socket, (struct iovec){buffer, capacity}, bytes, fds, fd_count,
                       MSG_DONTWAIT);
}

static int receive(int socket, struct iovec buffer, size_t *bytes, int *fds,
                   int *fd_count, int flags)
{
    int came[PROTO_FDS_RECEIVED_MAX];
    int count = 0;
    int status = receive_all(socket, buffer, bytes, came, &count, flags);

    for (int i = 0; i < count; i++) {
        if (status == 0 && fds != NULL && i < PROTO_FDS_MAX) {
            fds[i] = came[i];
        } else {
            close(came[i]);
        }
    }
    *fd_count = status == 0 ? count : 0;
    return status;
}

int proto_receive(int socket, void *buffer, size_t capacity, size_t *bytes, int *fds,
                  int *fd_count)
{
    return receive(socket, (struct iovec){buffer, capacity}, bytes, fds, fd_count,
                   MSG_DONTWAIT);
}

int proto_await(int socket, void *buffer, size_t capacity, size_t *bytes, int *fds,
                int *fd_count)
{
    return receive(socket, (struct iovec){buffer, capacity}, bytes, fds, fd_count, 0);
}

static int receive_bare(int socket, void *buffer, size_t capacity, size_t *bytes,
                        int flags)
{
    ssize_t got;

    do {
        got = recvfrom(socket, buffer, capacity, flags | MSG_TRUNC, NULL, NULL);
    } while (got < 0 && errno == EINTR && flags == MSG_DONTWAIT);
    if (got < 0) {
        return status_of_errno(errno);
    }
    if (got == 0 || (size_t)got > capacity) {
        return got == 0 ? PCCD_E_DISCONNECTED : PCCD_E_BADMSG;
    }
    *bytes = (size_t)got;
    return 0;
}

int proto_receive_bare(int socket, void *buffer, size_t capacity, size_t *bytes)
{
    return receive_bare(socket, buffer, capacity, bytes, MSG_DONTWAIT);
}

int proto_await_bare(int socket, void *buffer, size_t capacity, size_t *bytes)
{
    return receive_bare(socket, buffer, capacity, bytes, 0);
}

/* Newer than the headers of many who build this; the number is that of all machines but
 * these two. */
#if !defined(SO_PASSRIGHTS) && !defined(__hppa__) && !defined(__sparc__)
#define SO_PASSRIGHTS 83
#endif

bool proto_refuse_fds(int socket)
{
#ifdef SO_PASSRIGHTS
    int passes = 0;

    return setsockopt(socket, SOL_SOCKET, SO_PASSRIGHTS, &passes, sizeof passes) == 0;
#else
    (void)socket;
    return false;
#endif
}

int proto_default_socket_path(char *path, size_t capacity)
{
    const char *directory = getenv("XDG_RUNTIME_DIR");
    size_t longest = sizeof(((struct sockaddr_un *)0)->sun_path); /* with the NUL */
    int length;

    if (directory != NULL && directory[0] == '/') {
        length = snprintf(path, capacity, "%s/pccd/pccd.sock", directory);
    } else {
        length =
            snprintf(path, capacity, "/tmp/pccd-%lu/pccd.sock", (unsigned long)getuid());
    }
    if (length < 0 || (size_t)length >= capacity || (size_t)length >= longest) {
        return PCCD_E_LIMIT;
    }
    return 0;
}
