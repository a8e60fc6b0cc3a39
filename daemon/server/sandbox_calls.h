/* sandbox_calls.h - the system calls that a serving daemon may make, whatever their
 * arguments.
 *
 * Each call that a processor lacks has the one beside it that the C library makes there:
 * those of AArch64 and of what came after it lack unlink, rmdir, poll and epoll_wait.
 */
#ifndef SRV_SANDBOX_CALLS_H
#define SRV_SANDBOX_CALLS_H

/* clang-format off */
#define SRV_SANDBOX_CALLS(X) \
    /* clients: taken over by accept4, not made */ \
    X(accept4) \
    X(recvmsg) \
    X(recvfrom) \
    X(sendmsg) \
    X(sendto) \
    X(shutdown) \
    X(getsockopt) \
    X(setsockopt) \
    X(read) \
    X(write) \
    X(writev) \
    X(close) \
    X(dup3) /* a listening socket in the place of another */ \
    X(fcntl) \
    X(geteuid) /* is a client this process's own user? */ \
    /* the event loop */ \
    X(epoll_wait) \
    X(epoll_pwait) \
    X(epoll_ctl) \
    X(poll) \
    X(ppoll) \
    /* memory, shared and private; executable: see sandbox.c */ \
    X(memfd_create) \
    X(ftruncate) \
    X(fallocate) \
    X(fstat) /* and fchmod and openat: see sandbox.c */ \
    X(newfstatat) \
    X(munmap) \
    X(mremap) \
    X(madvise) \
    X(brk) \
    X(lseek) \
    /* threads */ \
    X(futex) \
    X(sched_yield) \
    X(sched_getaffinity) \
    X(sched_setaffinity) \
    X(getcpu) /* where neither rseq nor the vDSO tells it */ \
    X(set_robust_list) \
    X(rseq) \
    X(gettid) \
    X(getpid) \
    X(membarrier) \
    X(exit) \
    /* time and chance */ \
    X(clock_gettime) \
    X(clock_nanosleep) \
    X(nanosleep) \
    X(getrandom) \
    X(restart_syscall) \
    X(getrusage) \
    X(sysinfo) \
    X(uname) \
    /* signals, and the end: the socket and its lock are removed */ \
    X(rt_sigaction) \
    X(rt_sigprocmask) \
    X(rt_sigreturn) \
    X(sigaltstack) \
    X(tgkill) \
    X(unlink) \
    X(rmdir) \
    X(unlinkat) \
    X(exit_group)
/* clang-format on */

#endif
