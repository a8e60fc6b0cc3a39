# tests/fault/local.mk - the daemon in a world that fails on order.
#
# make fault-sweep               every allocation and every call, one after the other
# make fault-sweep FAULT_EVERY=5 every fifth

# Calls of the objects that are linked in go to wrap_*.c; libuv and msgpack-c among them,
# where the system has them as archives.
FAULT_WRAP_MEMORY = \
    -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free
FAULT_WRAP_CALLS = \
    -Wl,--wrap=accept4,--wrap=bind,--wrap=close,--wrap=epoll_create1,--wrap=epoll_ctl \
    -Wl,--wrap=epoll_wait,--wrap=eventfd,--wrap=fchmod,--wrap=fcntl,--wrap=flock,--wrap=fork,--wrap=getrandom \
    -Wl,--wrap=getsockopt,--wrap=listen,--wrap=lstat,--wrap=madvise,--wrap=memfd_create,--wrap=mkdir \
    -Wl,--wrap=mmap,--wrap=open,--wrap=pipe2,--wrap=poll,--wrap=posix_fallocate \
    -Wl,--wrap=pthread_create,--wrap=read,--wrap=recvfrom,--wrap=recvmsg,--wrap=sendmsg \
    -Wl,--wrap=sendto,--wrap=setsockopt,--wrap=shutdown \
    -Wl,--wrap=dup3,--wrap=inotify_add_watch,--wrap=inotify_init1,--wrap=socketpair \
    -Wl,--wrap=sigaction,--wrap=socket,--wrap=unlink,--wrap=write
fault_sources = \
    tests/fault/fault.c \
    tests/fault/wrap_calls.c \
    tests/fault/wrap_memory.c \
    tests/fault/wrap_page.c

check_PROGRAMS += tests/fault/pccdd-faulty
tests_fault_pccdd_faulty_SOURCES = daemon/server/main.c $(fault_sources)
tests_fault_pccdd_faulty_CPPFLAGS = $(server_cppflags) -iquote $(top_srcdir)/tests/fault
tests_fault_pccdd_faulty_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) -pthread
tests_fault_pccdd_faulty_LDFLAGS = $(AM_LDFLAGS) $(FAULT_WRAP_MEMORY) $(FAULT_WRAP_CALLS)
tests_fault_pccdd_faulty_LDADD = $(MSGPACK_ARCHIVE) libserver.la libengine.la libproto.la \
    $(UV_ARCHIVE)

fault_tests = \
    tests/fault/test_fault_calls \
    tests/fault/test_fault_limits \
    tests/fault/test_fault_memory \
    tests/fault/test_fault_start \
    tests/fault/test_fault_threads
test_programs += $(fault_tests)
test_scripts += tests/fault/archives_check.sh

# Every fault; make check tries a sample of the slower ones.
FAULT_EVERY = 1
.PHONY: fault-sweep
fault-sweep: $(fault_tests) tests/fault/pccdd-faulty pccdd
	@$(AM_TESTS_ENVIRONMENT) unset CMOCKA_MESSAGE_OUTPUT; \
	FAULT_EVERY=$(FAULT_EVERY); export FAULT_EVERY; \
	for test in $(fault_tests); do ./$$test || exit 1; done
