# bench/local.mk - measurements: built and tried by make check, run by make bench.
#
# make bench                               the paper's evaluation (bench/paper/local.mk)
# make bench-tables                        tables of everything
# make bench-tables BENCH_ARGS=--json      the same as JSON
# make bench-tables BENCH_ARGS=cloth-20k   one scene
# bench/tables.sh wide n-body              ways to take the same steps, side by side

bench_names = bench/batch bench/distances bench/exact bench/slowest bench/kernels bench/roofline bench/ipc \
    bench/connect bench/thickness bench/thin
check_PROGRAMS += $(bench_names)

# -iquote: bench/compare is no header of C++, <compare> is.
bench_cppflags = $(AM_CPPFLAGS) -DBENCH_FLAGS='"$(PCCD_CFLAGS) $(CFLAGS)"' \
    -iquote $(top_srcdir)/bench -I$(top_srcdir)/bench/scenes
bench_engine_cppflags = $(bench_cppflags) $(ENGINE_CPPFLAGS) \
    -I$(top_srcdir)/tests/support
bench_scenes_sources = \
    bench/scenes/bench_scene.c \
    bench/scenes/bodies.c \
    bench/scenes/breaking.c \
    bench/scenes/cloth.c \
    bench/scenes/drape.c \
    bench/scenes/exploding.c \
    bench/scenes/game.c \
    bench/scenes/layers.c \
    bench/scenes/needles.c \
    bench/scenes/passing.c \
    bench/scenes/over_box.c \
    bench/scenes/overlap.c \
    bench/scenes/partial.c \
    bench/scenes/recorded.c \
    bench/scenes/shards.c \
    bench/scenes/sheets.c \
    bench/scenes/surface.c \
    bench/scenes/thin.c \
    bench/scenes/tumble.c \
    tests/support/data.c \
    tests/support/ply.c
bench_engine_sources = \
    $(bench_scenes_sources) \
    bench/report.c \
    bench/resident.c \
    bench/traverse.c \
    bench/workload.c
bench_engine_libs = libengine.la $(GMP_LIBS) $(LIBM)

bench_distances_SOURCES = bench/distances.c $(bench_engine_sources)
bench_distances_CPPFLAGS = $(bench_engine_cppflags)
bench_distances_LDADD = $(bench_engine_libs)

bench_exact_SOURCES = bench/exact.c $(bench_engine_sources)
bench_exact_CPPFLAGS = $(bench_engine_cppflags)
bench_exact_LDADD = $(bench_engine_libs)
bench_slowest_SOURCES = bench/slowest.c $(bench_engine_sources)
bench_slowest_CPPFLAGS = $(bench_engine_cppflags)
bench_slowest_LDADD = $(bench_engine_libs)

bench_thickness_SOURCES = bench/thickness.c $(bench_engine_sources)
bench_thickness_CPPFLAGS = $(bench_engine_cppflags)
bench_thickness_LDADD = $(bench_engine_libs)

bench_thin_SOURCES = bench/thin.c $(bench_engine_sources)
bench_thin_CPPFLAGS = $(bench_engine_cppflags)
bench_thin_LDADD = $(bench_engine_libs)

bench_kernels_SOURCES = \
    bench/gather.c \
    bench/kernels.c \
    bench/sorting.c \
    $(bench_engine_sources)
bench_kernels_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
bench_kernels_CPPFLAGS = $(bench_engine_cppflags)
bench_kernels_LDADD = $(bench_engine_libs)

bench_roofline_SOURCES = \
    bench/floor.c \
    bench/parts.c \
    bench/roofline.c \
    $(bench_engine_sources)
bench_roofline_CPPFLAGS = $(bench_engine_cppflags)
bench_roofline_LDADD = $(bench_engine_libs)

# The public header alone: what a client can see.
# Needs a daemon of its own under a supervisor: make death DEATH_CLIENTS=1000 DEATH_KILLS=10
check_PROGRAMS += bench/death
bench_death_SOURCES = bench/bareend.c bench/death.c
bench_death_CPPFLAGS = $(bench_cppflags) -I$(top_srcdir)/client/lib \
    -I$(top_srcdir)/proto -I$(top_srcdir)/tests/support
bench_death_LDADD = libtestdaemon.la libpccd.la libproto.la $(CMOCKA_LIBS) $(LIBM)
DEATH_CLIENTS = 1
DEATH_KILLS = 100
.PHONY: death
death: bench/death$(EXEEXT) pccdd$(EXEEXT)
	PCCDD=$(abs_builddir)/pccdd bench/death -c $(DEATH_CLIENTS) -k $(DEATH_KILLS) -e
	PCCDD=$(abs_builddir)/pccdd bench/death -c $(DEATH_CLIENTS) -k $(DEATH_KILLS)

bench_connect_SOURCES = bench/connect.c bench/report.c
bench_connect_CPPFLAGS = $(bench_cppflags) -I$(top_srcdir)/client/lib -I$(top_srcdir)/proto \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
bench_connect_LDADD = libtestdaemon.la libtestraw.la libpccd.la libproto.la \
    $(CMOCKA_LIBS) $(LIBM)

bench_batch_SOURCES = bench/asker.c bench/batch.c bench/report.c \
    tests/support/farm.c
bench_batch_CPPFLAGS = $(bench_cppflags) -I$(top_srcdir)/client/lib -I$(top_srcdir)/proto \
    -I$(top_srcdir)/tests/support
bench_batch_LDADD = libpccd.la $(LIBM)

bench_ipc_SOURCES = bench/asker.c bench/ipc.c bench/report.c
bench_ipc_CPPFLAGS = $(bench_cppflags) -I$(top_srcdir)/client/lib -I$(top_srcdir)/proto
bench_ipc_LDADD = libpccd.la

TESTS += bench/smoke.sh bench/compare_smoke.sh

# Python beside C.
check_PROGRAMS += bench/turns
bench_turns_SOURCES = bench/turns.c
bench_turns_CPPFLAGS = $(bench_cppflags) -I$(top_srcdir)/client/lib -iquote $(top_srcdir)/proto/text
bench_turns_LDADD = libpccd.la libproto.la $(LIBM)
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
bench-tables: $(bench_names) bench/pccd-bench pccdd pccdctl
	@$(AM_TESTS_ENVIRONMENT) $(BASH) $(top_srcdir)/bench/tables.sh $(BENCH_ARGS) && \
	for program in $(bench_names); do ./$$program $(BENCH_ARGS) || exit 1; done
