/* test_proto_seqpacket.c - datagrams and the descriptors that travel beside them. */
#include "cases.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "pccd_types.h"
#include "proto_limits.h"
#include "seqpacket.h"

#define FD_LIMIT 1024

struct fixture {
    int near; /* sends */
    int far;  /* receives */
    int open_before;
    char buffer[PROTO_MESSAGE_BYTES_MAX];
};

static int count_open(void)
{
    int count = 0;
    for (int fd = 0; fd < FD_LIMIT; fd++) {
        count += fcntl(fd, F_GETFD) != -1;
    }
    return count;
}

static int set_up(void **state)
{
    static struct fixture fixture;
    int pair[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair) !=
        0) {
        return -1;
    }
    fixture.near = pair[0];
    fixture.far = pair[1];
    fixture.open_before = count_open();
    *state = &fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    if (fixture->near >= 0) {
        close(fixture->near);
    }
    close(fixture->far);
    return 0;
}

/* Send `count` copies of a descriptor without the help of proto_send. */
static bool try_send_fds(int socket, const char *message, size_t bytes, int count)
{
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(253 * sizeof(int))];
    } control;
    struct iovec iov = {(void *)message, bytes};
    struct msghdr header = {.msg_iov = &iov, .msg_iovlen = 1};
    memset(&control, 0, sizeof control);
    header.msg_control = control.bytes;
    header.msg_controllen = CMSG_SPACE((size_t)count * sizeof(int));
    struct cmsghdr *cmsg = CMSG_FIRSTHDR(&header);
    cmsg->cmsg_level = SOL_SOCKET;
    cmsg->cmsg_type = SCM_RIGHTS;
    cmsg->cmsg_len = CMSG_LEN((size_t)count * sizeof(int));
    for (int i = 0; i < count; i++) {
        int fd = STDERR_FILENO;
        memcpy(CMSG_DATA(cmsg) + (size_t)i * sizeof(int), &fd, sizeof fd);
    }
    return sendmsg(socket, &header, 0) == (ssize_t)bytes;
}

static void send_fds(int socket, const char *message, size_t bytes, int count)
{
    assert_true(try_send_fds(socket, message, bytes, count));
}

/* If this failed, two messages could run into one, or one be cut. */
CASE_WITH(message__keeps_its_bounds, set_up, tear_down)
{
    struct fixture *fixture = *state;
    static char longest[PROTO_MESSAGE_BYTES_MAX];
    size_t bytes = 0;
    int fd_count = -1;
    memset(longest, 'l', sizeof longest);
    assert_int_equal(proto_send(fixture->near, "a", 1, NULL, 0), 0);
    assert_int_equal(proto_send(fixture->near, longest, sizeof longest, NULL, 0), 0);
    assert_ok(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer, &bytes,
                            NULL, &fd_count));
    assert_int_equal(bytes, 1);
    assert_int_equal(fd_count, 0);
    assert_ok(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer, &bytes,
                            NULL, &fd_count));
    assert_int_equal(bytes, sizeof longest);
    assert_memory_equal(fixture->buffer, longest, sizeof longest);
}

/* If this failed, an attach would arrive without its memories. */
CASE_WITH(descriptors__arrive_as_the_same_files, set_up, tear_down)
{
    struct fixture *fixture = *state;
    int sent[2], got[2] = {-1, -1}, fd_count;
    size_t bytes;
    struct stat before, after;
    assert_int_equal(pipe2(sent, O_CLOEXEC), 0);
    assert_int_equal(proto_send(fixture->near, "x", 1, sent, 2), 0);
    assert_ok(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer, &bytes,
                            got, &fd_count));
    assert_int_equal(fd_count, 2);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(fstat(sent[i], &before), 0);
        assert_int_equal(fstat(got[i], &after), 0);
        assert_true(before.st_ino == after.st_ino && before.st_dev == after.st_dev);
        assert_int_equal(fcntl(got[i], F_GETFD), FD_CLOEXEC);
        close(sent[i]);
        close(got[i]);
    }
    assert_int_equal(count_open(), fixture->open_before);
}

/* If this failed, a client could fill the daemon's table of descriptors. */
CASE_WITH(descriptors__unwanted_ones_are_closed_and_counted, set_up, tear_down)
{
    struct fixture *fixture = *state;
    static const int counts[] = {1, 2, 3, 253};
    for (int i = 0; i < 4; i++) {
        size_t bytes;
        int fd_count = -1;
        send_fds(fixture->near, "x", 1, counts[i]);
        assert_ok(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                &bytes, NULL, &fd_count));
        assert_int_equal(fd_count, counts[i]);
        assert_int_equal(count_open(), fixture->open_before);
    }
}

/* If this failed, what a daemon sends beyond two descriptors would stay open in a
 * client. */
CASE_WITH(descriptors__surplus_ones_are_closed_and_counted, set_up, tear_down)
{
    struct fixture *fixture = *state;
    static const int counts[] = {1, 2, 3, 253};
    for (int i = 0; i < 4; i++) {
        size_t bytes;
        int fds[2] = {-1, -1}, fd_count = -1;
        int stored = counts[i] < 2 ? counts[i] : 2;
        send_fds(fixture->near, "x", 1, counts[i]);
        assert_ok(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                &bytes, fds, &fd_count));
        assert_int_equal(fd_count, counts[i]);
        assert_int_equal(count_open(), fixture->open_before + stored);
        for (int k = 0; k < stored; k++) {
            assert_int_equal(close(fds[k]), 0);
        }
    }
}

/* If this failed, a message that was cut would be taken, or its descriptors leak. */
CASE_WITH(truncated__is_refused_and_its_descriptors_closed, set_up, tear_down)
{
    struct fixture *fixture = *state;
    size_t bytes;
    int fds[2] = {-1, -1}, fd_count = -1;
    send_fds(fixture->near, "0123456789", 10, 3);
    assert_int_equal(
        proto_receive(fixture->far, fixture->buffer, 9, &bytes, fds, &fd_count),
        PCCD_E_BADMSG);
    assert_int_equal(count_open(), fixture->open_before);
    send_fds(fixture->near, "0123456789", 10, 3);
    assert_int_equal(
        proto_receive(fixture->far, fixture->buffer, 9, &bytes, NULL, &fd_count),
        PCCD_E_BADMSG);
    assert_int_equal(count_open(), fixture->open_before);
    /* One byte of room more and it is whole. */
    assert_int_equal(proto_send(fixture->near, "0123456789", 10, NULL, 0), 0);
    assert_ok(proto_receive(fixture->far, fixture->buffer, 10, &bytes, NULL, &fd_count));
}

/* If this failed, an empty datagram could be taken for a message of no bytes. */
CASE_WITH(empty__datagram_reads_as_the_end, set_up, tear_down)
{
    struct fixture *fixture = *state;
    size_t bytes = 99;
    int fd_count = -1;
    assert_int_equal(send(fixture->near, "", 0, 0), 0);
    assert_int_equal(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                   &bytes, NULL, &fd_count),
                     PCCD_E_DISCONNECTED);
    send_fds(fixture->near, "", 0, 2);
    assert_int_equal(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                   &bytes, NULL, &fd_count),
                     PCCD_E_DISCONNECTED);
    assert_int_equal(bytes, 99);
    assert_int_equal(count_open(), fixture->open_before);
}

static uint64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

/* If this failed, a client that polls would be held up by its own socket, or one that
 * waits would burn its processor, or never look at its deadline. */
CASE_WITH(await__waits_and_nothing_else_does, set_up, tear_down)
{
    struct fixture *fixture = *state;
    const struct timeval timeout = {.tv_usec = 30000};
    size_t bytes;
    int fd_count;
    int flags = fcntl(fixture->far, F_GETFL);
    assert_int_equal(fcntl(fixture->far, F_SETFL, flags & ~O_NONBLOCK), 0);
    assert_ok(
        setsockopt(fixture->far, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout));
    uint64_t begin_ns = now_ns();
    assert_int_equal(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                   &bytes, NULL, &fd_count),
                     PCCD_E_AGAIN);
    assert_true(now_ns() - begin_ns < 20000000);
    assert_int_equal(proto_await(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                 &bytes, NULL, &fd_count),
                     PCCD_E_AGAIN);
    assert_true(now_ns() - begin_ns >= 29000000);
    assert_int_equal(proto_send(fixture->near, "x", 1, NULL, 0), 0);
    assert_ok(proto_await(fixture->far, fixture->buffer, sizeof fixture->buffer, &bytes,
                          NULL, &fd_count));
    assert_int_equal(bytes, 1);
}

/* If this failed, who expects no descriptors would misread messages or keep some open. */
CASE_WITH(bare__is_the_same_but_for_descriptors, set_up, tear_down)
{
    struct fixture *fixture = *state;
    static char longest[PROTO_MESSAGE_BYTES_MAX];
    const struct timeval timeout = {.tv_usec = 30000};
    size_t bytes = 0;
    memset(longest, 'l', sizeof longest);
    send_fds(fixture->near, longest, sizeof longest, 3);
    send_fds(fixture->near, "ab", 2, 1);
    assert_int_equal(proto_send(fixture->near, "ab", 2, NULL, 0), 0);
    assert_ok(proto_receive_bare(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                 &bytes));
    assert_int_equal(bytes, sizeof longest);
    assert_memory_equal(fixture->buffer, longest, sizeof longest);
    assert_int_equal(proto_receive_bare(fixture->far, fixture->buffer, 1, &bytes),
                     PCCD_E_BADMSG);
    assert_int_equal(proto_await_bare(fixture->far, fixture->buffer, 2, &bytes), 0);
    assert_int_equal(bytes, 2);
    assert_memory_equal(fixture->buffer, "ab", 2);
    assert_int_equal(count_open(), fixture->open_before);
    assert_int_equal(fcntl(fixture->far, F_SETFL, 0), 0); /* it blocks */
    assert_ok(
        setsockopt(fixture->far, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout));
    uint64_t begin_ns = now_ns();
    assert_int_equal(proto_receive_bare(fixture->far, fixture->buffer, 2, &bytes),
                     PCCD_E_AGAIN);
    assert_true(now_ns() - begin_ns < 20000000);
    assert_int_equal(proto_await_bare(fixture->far, fixture->buffer, 2, &bytes),
                     PCCD_E_AGAIN);
    assert_true(now_ns() - begin_ns >= 29000000);
    close(fixture->near);
    fixture->near = -1;
    assert_int_equal(proto_receive_bare(fixture->far, fixture->buffer, 2, &bytes),
                     PCCD_E_DISCONNECTED);
    assert_int_equal(proto_receive_bare(-1, fixture->buffer, 2, &bytes), PCCD_E_SYSTEM);
}

/* If this failed, a daemon that trusts it would let descriptors pass unseen. */
CASE_WITH(refused__descriptors_stay_with_the_sender, set_up, tear_down)
{
    struct fixture *fixture = *state;
    size_t bytes;
    int fd_count = 0;
    send_fds(fixture->near, "x", 1, 2); /* on its way already */
    if (!proto_refuse_fds(fixture->far)) {
        test_skip("this kernel cannot refuse descriptors (Linux before 6.16)");
    }
    assert_false(try_send_fds(fixture->near, "x", 1, 1));
    assert_int_equal(errno, EPERM);
    assert_int_equal(proto_send(fixture->near, "x", 1, NULL, 0), 0);
    assert_ok(proto_receive(fixture->far, fixture->buffer, 1, &bytes, NULL, &fd_count));
    assert_int_equal(fd_count, 2);
    assert_int_equal(proto_receive_bare(fixture->far, fixture->buffer, 1, &bytes), 0);
    assert_int_equal(proto_receive_bare(fixture->far, fixture->buffer, 1, &bytes),
                     PCCD_E_AGAIN);
    send_fds(fixture->far, "x", 1, 1); /* the other way they pass */
    assert_int_equal(count_open(), fixture->open_before);
}

/* If this failed, the loop would block, or close a client that is merely slow. */
CASE_WITH(socket__that_would_block_says_again, set_up, tear_down)
{
    struct fixture *fixture = *state;
    static char block[PROTO_MESSAGE_BYTES_MAX];
    size_t bytes;
    int fd_count, status = 0, sent = 0;
    assert_int_equal(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                   &bytes, NULL, &fd_count),
                     PCCD_E_AGAIN);
    while (sent < 10000 &&
           (status = proto_send(fixture->near, block, sizeof block, NULL, 0)) == 0) {
        sent++;
    }
    assert_int_equal(status, PCCD_E_AGAIN);
    assert_true(sent >= 1);
    /* What was sent before is whole, and nothing of the refused message came. */
    for (int i = 0; i < sent; i++) {
        assert_ok(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                &bytes, NULL, &fd_count));
    }
    assert_int_equal(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                   &bytes, NULL, &fd_count),
                     PCCD_E_AGAIN);
}

/* If this failed, a peer that died would raise SIGPIPE or look like a fault of the
 * system. */
CASE_WITH(peer__that_is_gone_reads_as_disconnected, set_up, tear_down)
{
    struct fixture *fixture = *state;
    size_t bytes;
    int fd_count;
    close(fixture->near);
    fixture->near = -1;
    assert_int_equal(proto_receive(fixture->far, fixture->buffer, sizeof fixture->buffer,
                                   &bytes, NULL, &fd_count),
                     PCCD_E_DISCONNECTED);
    assert_int_equal(proto_send(fixture->far, "x", 1, NULL, 0), PCCD_E_DISCONNECTED);
}

/* If this failed, a broken descriptor would look like a peer that went. */
CASE_WITH(socket__that_is_none_is_a_system_error, set_up, tear_down)
{
    struct fixture *fixture = *state;
    size_t bytes;
    int fd_count;
    assert_int_equal(proto_receive(-1, fixture->buffer, 1, &bytes, NULL, &fd_count),
                     PCCD_E_SYSTEM);
    assert_int_equal(errno, EBADF);
    assert_int_equal(proto_send(-1, "x", 1, NULL, 0), PCCD_E_SYSTEM);
    assert_int_equal(errno, EBADF);
}

/* If this failed, client and daemon would not meet, or a long path be cut silently. */
CASE(default_path__follows_the_runtime_directory)
{
    char path[512], expected[64], directory[108];
    assert_int_equal(setenv("XDG_RUNTIME_DIR", "/run/user/7", 1), 0);
    assert_int_equal(proto_default_socket_path(path, sizeof path), 0);
    assert_string_equal(path, "/run/user/7/pccd/pccd.sock");
    assert_int_equal(proto_default_socket_path(path, strlen(path)), PCCD_E_LIMIT);
    assert_ok(proto_default_socket_path(path, strlen("/run/user/7/pccd/pccd.sock") + 1));

    snprintf(expected, sizeof expected, "/tmp/pccd-%lu/pccd.sock",
             (unsigned long)getuid());
    assert_int_equal(setenv("XDG_RUNTIME_DIR", "relative", 1), 0);
    assert_int_equal(proto_default_socket_path(path, sizeof path), 0);
    assert_string_equal(path, expected);
    assert_int_equal(unsetenv("XDG_RUNTIME_DIR"), 0);
    assert_int_equal(proto_default_socket_path(path, sizeof path), 0);
    assert_string_equal(path, expected);

    /* 107 bytes fit a sockaddr_un with their NUL, 108 do not. */
    for (size_t bytes = 107; bytes <= 108; bytes++) {
        size_t room = bytes - strlen("/pccd/pccd.sock");
        memset(directory, 'd', room);
        directory[0] = '/';
        directory[room] = '\0';
        assert_int_equal(setenv("XDG_RUNTIME_DIR", directory, 1), 0);
        assert_int_equal(proto_default_socket_path(path, sizeof path),
                         bytes == 107 ? 0 : PCCD_E_LIMIT);
    }
}
