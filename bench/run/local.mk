# bench/run/local.mk - pccd-bench: the steps of a scene, in one or more ways; and sections.
#
# bench/pccd-bench --help      what it takes
# bench/pccd-bench --list      the scenes
# bench/pccd-bench kernel      a section: kernel, pair, client; or a part: kernel roofline

check_PROGRAMS += bench/pccd-bench

bench_pccd_bench_SOURCES = \
    bench/batch.c \
    bench/connect.c \
    bench/death.c \
    bench/late.c \
    bench/pair.c \
    bench/roofline.c \
    bench/redis/busy.c \
    bench/redis/crowd.c \
    bench/redis/ipc.c \
    bench/redis/least.c \
    bench/redis/redis.c \
    bench/redis/trips.c \
    bench/redis/updates.c \
    bench/run/frame.c \
    bench/run/output.c \
    bench/run/output_json.c \
    bench/run/pccd_bench.c \
    bench/run/play.c \
    bench/run/settings.c \
    bench/run/setup.c \
    bench/run/way_client.c \
    bench/run/way_engine.c
nodist_bench_pccd_bench_SOURCES = bench/run/commit.c
bench_pccd_bench_CPPFLAGS = $(bench_cppflags) -DBENCH_DAEMON='"$(abs_top_builddir)/pccdd"' \
    $(SECCOMP_CFLAGS)
bench_pccd_bench_LDADD = $(LDADD) $(SECCOMP_LIBS)

test_scripts += bench/run/smoke.sh

# What it costs to ask pccdd, beside Redis from its package: a table, two minutes. Also
# make bench-ipc IPC_ARGS=updates (or trips, crowd, busy); IPC_ARGS=--json: a line a row.
.PHONY: bench-ipc
bench-ipc: bench/pccd-bench$(EXEEXT) pccdd$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) bench/pccd-bench client ipc $(IPC_ARGS)

# Which sources these are; written anew only when that has changed.
bench/run/commit.c: bench-commit
.PHONY: bench-commit
bench-commit:
	@$(MKDIR_P) bench/run; \
	commit=; [ ! -e $(top_srcdir)/.git ] || commit=`git -C $(top_srcdir) describe \
	    --always --dirty --abbrev=12 '--exclude=*' 2>/dev/null`; \
	{ echo 'extern const char run_commit[];'; \
	    echo "const char run_commit[] = \"$${commit:-unknown}\";"; } >bench/run/commit.new; \
	if cmp -s bench/run/commit.new bench/run/commit.c; then rm bench/run/commit.new; \
	else mv bench/run/commit.new bench/run/commit.c; fi
CLEANFILES += bench/run/commit.c
