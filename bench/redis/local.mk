# bench/redis/local.mk - what it costs to ask pccdd, beside Redis from its package.
#
# make bench-ipc                      the table of design.md's targets, two minutes
# make bench-ipc IPC_ARGS=updates     one part: trips, crowd, updates, busy
# make bench-ipc IPC_ARGS=--json      one JSON line a row

check_PROGRAMS += bench/redis/beside_redis

bench_redis_beside_redis_SOURCES = \
    bench/redis/busy.c \
    bench/redis/crowd.c \
    bench/redis/least.c \
    bench/redis/main.c \
    bench/redis/pairs.c \
    bench/redis/redis.c \
    bench/redis/trips.c \
    bench/redis/updates.c
bench_redis_beside_redis_CPPFLAGS = $(AM_CPPFLAGS) $(SECCOMP_CFLAGS)
bench_redis_beside_redis_LDADD = $(LDADD) $(SECCOMP_LIBS)

.PHONY: bench-ipc
bench-ipc: bench/redis/beside_redis$(EXEEXT) pccdd$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) ./bench/redis/beside_redis $(IPC_ARGS)
