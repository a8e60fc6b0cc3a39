/* wrap_calls.c - system calls that fail on order. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/epoll.h>
#include <sys/inotify.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "fault.h"

/* WRAP(result, name, (parameters), (arguments)): fails with -1. */
#define WRAP(type, name, parameters, arguments)                                          \
    type __real_##name parameters;                                                       \
    type __wrap_##name parameters;                                                       \
    type __wrap_##name parameters                                                        \
    {                                                                                    \
        return fault_strikes(FAULT_##name) ? -1 : __real_##name arguments;               \
    }

WRAP(int, accept4, (int fd, struct sockaddr *address, socklen_t *bytes, int flags),
     (fd, address, bytes, flags))
WRAP(int, bind, (int fd, const struct sockaddr *address, socklen_t bytes),
     (fd, address, bytes))
WRAP(int, dup3, (int from, int to, int flags), (from, to, flags))
WRAP(int, epoll_create1, (int flags), (flags))
WRAP(int, epoll_wait, (int fd, struct epoll_event *events, int count, int timeout_ms),
     (fd, events, count, timeout_ms))
WRAP(int, eventfd, (unsigned value, int flags), (value, flags))
WRAP(int, fchmod, (int fd, mode_t mode), (fd, mode))
WRAP(int, flock, (int fd, int operation), (fd, operation))
WRAP(pid_t, fork, (void), ())
WRAP(ssize_t, getrandom, (void *at, size_t bytes, unsigned flags), (at, bytes, flags))
WRAP(int, getsockopt, (int fd, int level, int name, void *value, socklen_t *bytes),
     (fd, level, name, value, bytes))
WRAP(int, inotify_add_watch, (int fd, const char *path, uint32_t mask), (fd, path, mask))
WRAP(int, inotify_init1, (int flags), (flags))
WRAP(int, listen, (int fd, int backlog), (fd, backlog))
WRAP(int, lstat, (const char *path, struct stat *info), (path, info))
WRAP(int, madvise, (void *at, size_t bytes, int advice), (at, bytes, advice))
WRAP(int, memfd_create, (const char *name, unsigned flags), (name, flags))
WRAP(int, mkdir, (const char *path, mode_t mode), (path, mode))
WRAP(int, pipe2, (int fds[2], int flags), (fds, flags))
WRAP(int, poll, (struct pollfd * fds, nfds_t count, int timeout_ms),
     (fds, count, timeout_ms))
WRAP(ssize_t, read, (int fd, void *at, size_t bytes), (fd, at, bytes))
WRAP(ssize_t, recvfrom,
     (int fd, void *at, size_t bytes, int flags, struct sockaddr *address,
      socklen_t *address_bytes),
     (fd, at, bytes, flags, address, address_bytes))
WRAP(ssize_t, recvmsg, (int fd, struct msghdr *message, int flags), (fd, message, flags))
WRAP(ssize_t, sendmsg, (int fd, const struct msghdr *message, int flags),
     (fd, message, flags))
WRAP(ssize_t, sendto,
     (int fd, const void *from, size_t bytes, int flags, const struct sockaddr *address,
      socklen_t address_bytes),
     (fd, from, bytes, flags, address, address_bytes))
WRAP(int, setsockopt, (int fd, int level, int name, const void *value, socklen_t bytes),
     (fd, level, name, value, bytes))
WRAP(int, shutdown, (int fd, int how), (fd, how))
WRAP(int, sigaction,
     (int number, const struct sigaction *action, struct sigaction *before),
     (number, action, before))
WRAP(int, socket, (int family, int type, int protocol), (family, type, protocol))
WRAP(int, socketpair, (int family, int type, int protocol, int fds[2]),
     (family, type, protocol, fds))
WRAP(int, unlink, (const char *path), (path))
WRAP(ssize_t, write, (int fd, const void *from, size_t bytes), (fd, from, bytes))

int __real_close(int fd);
int __wrap_close(int fd);
int __wrap_close(int fd)
{
    int status = __real_close(fd);
    int error = errno;
    if (fault_strikes(FAULT_close)) {
        return -1;
    }
    errno = error;
    return status;
}

/* Only what adds takes memory: the rest cannot fail on a descriptor that is there. A
 * descriptor that was added before is said to be there, however little memory is left. */
int __real_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);
int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event);
int __wrap_epoll_ctl(int epoll, int operation, int fd, struct epoll_event *event)
{
    int status = __real_epoll_ctl(epoll, operation, fd, event);
    if (operation == EPOLL_CTL_ADD && status == 0 && fault_strikes(FAULT_epoll_ctl)) {
        int error = errno;
        struct epoll_event none = {0};
        __real_epoll_ctl(epoll, EPOLL_CTL_DEL, fd, &none);
        errno = error;
        return -1;
    }
    return status;
}

/* One argument at most, an int or none; both are passed alike. */
int __real_fcntl(int fd, int command, ...);
int __wrap_fcntl(int fd, int command, ...);
int __wrap_fcntl(int fd, int command, ...)
{
    va_list arguments;
    va_start(arguments, command);
    long argument = va_arg(arguments, long);
    va_end(arguments);
    return fault_strikes(FAULT_fcntl) ? -1 : __real_fcntl(fd, command, argument);
}

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    mode_t mode = va_arg(arguments, mode_t);
    va_end(arguments);
    return fault_strikes(FAULT_open) ? -1 : __real_open(path, flags, mode);
}

void *__real_mmap(void *at, size_t bytes, int protection, int flags, int fd, off_t from);
void *__wrap_mmap(void *at, size_t bytes, int protection, int flags, int fd, off_t from);
void *__wrap_mmap(void *at, size_t bytes, int protection, int flags, int fd, off_t from)
{
    return fault_strikes(FAULT_mmap)
               ? MAP_FAILED
               : __real_mmap(at, bytes, protection, flags, fd, from);
}

/* These two return their error. */
int __real_posix_fallocate(int fd, off_t from, off_t bytes);
int __wrap_posix_fallocate(int fd, off_t from, off_t bytes);
int __wrap_posix_fallocate(int fd, off_t from, off_t bytes)
{
    return fault_strikes(FAULT_posix_fallocate) ? errno
                                                : __real_posix_fallocate(fd, from, bytes);
}

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*start)(void *), void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*start)(void *), void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*start)(void *), void *argument)
{
    return fault_strikes(FAULT_pthread_create)
               ? errno
               : __real_pthread_create(thread, attributes, start, argument);
}
