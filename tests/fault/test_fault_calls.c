/* test_fault_calls.c - no system call that serves a client may be the daemon's last. */
#include "cases.h"

#include <errno.h>

#include "keeper.h"

#define CALLS_MAX  10000u
#define ERRORS_MAX 8

struct plausible {
    enum fault_call call;
    int errors[ERRORS_MAX]; /* ends with 0 */
};

static const struct plausible all[] = {
    {FAULT_accept4, {EINTR, EAGAIN, ECONNABORTED, EMFILE, ENFILE, ENOBUFS, ENOMEM}},
    {FAULT_close, {EINTR, EIO}},
    {FAULT_epoll_ctl, {ENOMEM, ENOSPC}},
    {FAULT_epoll_wait, {EINTR}},
    {FAULT_fchmod, {EPERM}},
    {FAULT_fcntl, {ENOMEM, EBUSY}},
    {FAULT_getsockopt, {ENOMEM}},
    {FAULT_madvise, {ENOMEM, EFAULT}},
    {FAULT_memfd_create, {EMFILE, ENFILE, ENOMEM}},
    {FAULT_mmap, {ENOMEM, EAGAIN, ENFILE}},
    {FAULT_open, {ENOENT, ENFILE}}, /* of the result region, anew, to be read */
    {FAULT_poll, {EINTR, ENOMEM}},
    {FAULT_posix_fallocate, {EINTR, ENOMEM, ENOSPC}},
    {FAULT_read, {EINTR, EAGAIN}},
    {FAULT_recvfrom, {EINTR, EAGAIN, ENOMEM, ENOBUFS, ECONNRESET}},
    {FAULT_recvmsg, {EINTR, EAGAIN, ENOMEM, ENOBUFS, ECONNRESET}},
    {FAULT_sendmsg, {EINTR, EAGAIN, ENOMEM, ENOBUFS, EPIPE, ECONNRESET, ETOOMANYREFS}},
    {FAULT_sendto, {EINTR, EAGAIN, ENOMEM, ENOBUFS, EPIPE, ECONNRESET}},
    {FAULT_setsockopt, {ENOPROTOOPT}}, /* as of Linux before 6.16 */
    {FAULT_shutdown, {ENOTCONN}},
    {FAULT_write, {EINTR}}, /* the wake-up of the loop is full only when it is awake */
};

/* If this failed, a refusal of the system that concerns one client would end the daemon,
 * or another client's session, or leave something behind. */
CASE(calls__fail_once)
{
    uint64_t stride = keeper_stride(7);
    uint64_t tried = 0;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        for (size_t e = 0; e < ERRORS_MAX && all[i].errors[e] != 0; e++) {
            for (uint64_t first = 1; first < CALLS_MAX; first += stride) {
                if (keeper_try(all[i].call, first, 1, all[i].errors[e]) == 0) {
                    break;
                }
                tried++;
            }
        }
    }
    print_message("# %llu calls failed, one a life\n", (unsigned long long)tried);
}

CASES_WITH(keeper_start, keeper_stop);
