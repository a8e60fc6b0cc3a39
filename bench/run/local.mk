# bench/run/local.mk - pccd-bench: one scene, one way to compute it, every step.
#
# bench/pccd-bench --help      what it takes
# bench/pccd-bench --list      the scenes

check_PROGRAMS += bench/pccd-bench

bench_pccd_bench_SOURCES = \
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
bench_pccd_bench_CPPFLAGS = $(bench_cppflags) -DBENCH_DAEMON='"$(abs_top_builddir)/pccdd"'

test_scripts += bench/run/smoke.sh

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
