# bench/local.mk - measurements: built and tried by make check, run by make bench.
#
# make bench                               the paper's evaluation (bench/paper/local.mk)
# make bench-tables                        tables of everything
# make bench-tables BENCH_ARGS=--json      the same as JSON
# make bench-tables BENCH_ARGS=cloth-20k   one scene
# bench/tables.sh wide n-body              ways to take the same steps, side by side

check_PROGRAMS += bench/turns

# What several measurements share.
check_LTLIBRARIES += libbench.la
libbench_la_SOURCES = \
    bench/asker.c \
    bench/report.c \
    bench/resident.c \
    bench/wide_sweep.c \
    bench/workload.c \
    bench/scenes/bench_scene.c \
    bench/scenes/bodies.c \
    bench/scenes/breaking.c \
    bench/scenes/cloth.c \
    bench/scenes/drape.c \
    bench/scenes/exploding.c \
    bench/scenes/game.c \
    bench/scenes/layers.c \
    bench/scenes/near.c \
    bench/scenes/overlap.c \
    bench/scenes/partial.c \
    bench/scenes/shards.c \
    bench/scenes/sheets.c \
    bench/scenes/surface.c \
    bench/scenes/thin.c \
    bench/scenes/tumble.c
bench_cppflags = $(AM_CPPFLAGS) -DBENCH_FLAGS='"$(PCCD_CFLAGS) $(CFLAGS)"'
libbench_la_CPPFLAGS = $(bench_cppflags)

# A daemon under a supervisor, killed: make death DEATH_CLIENTS=1000 DEATH_KILLS=10
DEATH_CLIENTS = 1
DEATH_KILLS = 100
.PHONY: death
death: bench/pccd-bench$(EXEEXT) pccdd$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) bench/pccd-bench client death --clients $(DEATH_CLIENTS) \
	    --kills $(DEATH_KILLS)

test_scripts += bench/smoke.sh bench/compare_smoke.sh

# Python beside C.
PYTHON_ROUNDS = 40
.PHONY: bench-python
bench-python: pccdd bench/turns$(EXEEXT) libpccd-direct.la
	@$(AM_TESTS_ENVIRONMENT) . $(top_srcdir)/tests/python/find.sh; \
	[ -n "$$python" ] || { echo "$$no_python" >&2; exit 1; }; \
	PCCD_DIRECT=$(abs_builddir)/.libs/libpccd-direct.so.0 \
	    PYTHON_ROUNDS=$(PYTHON_ROUNDS) "$$python" $(top_srcdir)/bench/python.py bench/turns

# What a step costs of which little moves.
.PHONY: standing
standing: bench/pccd-bench pccdd libpccd-direct.la
	@$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/bench/tables.sh $(BENCH_ARGS) standing \
	    standing-all standing-daemon standing-daemon-all standing-threads standing-avx2 \
	    standing-sse4 standing-paper game

.PHONY: bench-tables
bench-tables: bench/pccd-bench pccdd pccdctl
	@$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/bench/tables.sh $(BENCH_ARGS) && \
	for section in kernel pair client; do \
	    bench/pccd-bench $$section $(BENCH_ARGS) || exit 1; done
