# tests/fuzz/local.mk - the elementary tests against exact arithmetic, on random queries.
#
# make fuzz-elementary FUZZ_QUERIES=1e8 FUZZ_SEED=1 FUZZ_JOBS=2    half an hour
# tests/fuzz/elementary --replay FILE     lines that a failure has printed

fuzz_sources = \
    tests/fuzz/fuzz_query.c \
    tests/fuzz/fuzz_run.c \
    tests/fuzz/fuzz_sieve.c \
    tests/fuzz/fuzz_spans.c \
    tests/fuzz/fuzz_spans_long.c \
    tests/fuzz/fuzz_truth.c
FUZZ_CPPFLAGS = $(AM_CPPFLAGS) $(ENGINE_CPPFLAGS) -I$(top_srcdir)/client/oracle \
    -I$(top_srcdir)/tests/support -I$(top_srcdir)/tests/fuzz $(CMOCKA_CFLAGS)
FUZZ_LDADD = libengine.la liboracle.la $(GMP_LIBS) $(LIBM)

check_PROGRAMS += tests/fuzz/elementary tests/fuzz/test_eng_elementary
TESTS += tests/fuzz/test_eng_elementary

tests_fuzz_elementary_SOURCES = tests/fuzz/elementary.c $(fuzz_sources)
tests_fuzz_elementary_CPPFLAGS = $(FUZZ_CPPFLAGS)
tests_fuzz_elementary_LDADD = $(FUZZ_LDADD)

tests_fuzz_test_eng_elementary_SOURCES = tests/fuzz/test_eng_elementary.c $(fuzz_sources)
tests_fuzz_test_eng_elementary_CPPFLAGS = $(FUZZ_CPPFLAGS)
tests_fuzz_test_eng_elementary_LDADD = $(FUZZ_LDADD) $(CMOCKA_LIBS)

# ---- distances ----------------------------------------------------------------------
#
# make fuzz-distance FUZZ_QUERIES=1e8 FUZZ_SEED=1 FUZZ_JOBS=2
fuzz_distance_sources = \
    tests/fuzz/fuzz_distance.c \
    tests/fuzz/fuzz_lanes.c \
    tests/fuzz/fuzz_sharp.c

check_PROGRAMS += tests/fuzz/distance tests/fuzz/test_eng_distance
TESTS += tests/fuzz/test_eng_distance

fuzz_jobs = tests/fuzz/fuzz_jobs.c

tests_fuzz_distance_SOURCES = tests/fuzz/distance.c $(fuzz_jobs) $(fuzz_distance_sources)
tests_fuzz_distance_CPPFLAGS = $(FUZZ_CPPFLAGS)
tests_fuzz_distance_LDADD = $(FUZZ_LDADD)

tests_fuzz_test_eng_distance_SOURCES = tests/fuzz/test_eng_distance.c \
    $(fuzz_distance_sources)
tests_fuzz_test_eng_distance_CPPFLAGS = $(FUZZ_CPPFLAGS)
tests_fuzz_test_eng_distance_LDADD = $(FUZZ_LDADD) $(CMOCKA_LIBS)

# ---- thick features -----------------------------------------------------------------
#
# make fuzz-thick FUZZ_QUERIES=1e7 FUZZ_SEED=1 FUZZ_JOBS=2
fuzz_thick_sources = tests/fuzz/fuzz_thick.c \
    tests/fuzz/fuzz_thick_lanes.c \
    tests/fuzz/fuzz_thick_make.c

check_PROGRAMS += tests/fuzz/thick tests/fuzz/test_eng_thick_fuzz
TESTS += tests/fuzz/test_eng_thick_fuzz

tests_fuzz_thick_SOURCES = tests/fuzz/thick.c $(fuzz_jobs) $(fuzz_thick_sources)
tests_fuzz_thick_CPPFLAGS = $(FUZZ_CPPFLAGS)
tests_fuzz_thick_LDADD = $(FUZZ_LDADD)

tests_fuzz_test_eng_thick_fuzz_SOURCES = tests/fuzz/test_eng_thick_fuzz.c \
    $(fuzz_thick_sources)
tests_fuzz_test_eng_thick_fuzz_CPPFLAGS = $(FUZZ_CPPFLAGS)
tests_fuzz_test_eng_thick_fuzz_LDADD = $(FUZZ_LDADD) $(CMOCKA_LIBS)

FUZZ_QUERIES = 1e7
FUZZ_SEED = 1
FUZZ_JOBS = 2
.PHONY: fuzz-elementary
fuzz-elementary: tests/fuzz/elementary
	nice -n 19 tests/fuzz/elementary --queries $(FUZZ_QUERIES) --seed $(FUZZ_SEED) \
	    --jobs $(FUZZ_JOBS)

.PHONY: fuzz-distance
fuzz-distance: tests/fuzz/distance
	nice -n 19 tests/fuzz/distance --cases $(FUZZ_QUERIES) --seed $(FUZZ_SEED) \
	    --jobs $(FUZZ_JOBS)

.PHONY: fuzz-thick
fuzz-thick: tests/fuzz/thick
	nice -n 19 tests/fuzz/thick --cases $(FUZZ_QUERIES) --seed $(FUZZ_SEED) \
	    --jobs $(FUZZ_JOBS)

# ---- targets for libFuzzer ----------------------------------------------------------
#
# make fuzz FUZZ_SECONDS=600                    each target so long, built by clang beside
# FUZZ_TARGETS="mesh slot" make fuzz            some of them
# tests/fuzz/replay TARGET FILE...              without a fuzzer, in any build

target_sources = \
    $(fault_sources) \
    $(fuzz_sources) \
    tests/fuzz/host.c \
    tests/fuzz/peer.c \
    tests/fuzz/fuzz_target.c \
    tests/fuzz/target_decoder.c \
    tests/fuzz/target_dispatch.c \
    tests/fuzz/target_mesh.c \
    tests/fuzz/target_query.c \
    tests/fuzz/target_slot.c \
    tests/fuzz/target_travel.c \
    tests/fuzz/fuzz_scene.c \
    tests/fuzz/visitor.c \
    tests/fault/life.c
check_LTLIBRARIES += libfuzztargets.la
libfuzztargets_la_SOURCES = $(target_sources)
libfuzztargets_la_CPPFLAGS = $(server_cppflags) $(MSGPACK_CFLAGS) \
    -iquote $(top_srcdir)/tests/fault -iquote $(top_srcdir)/tests/fuzz \
    -iquote $(top_srcdir)/tests/support -iquote $(top_srcdir)/client/oracle
libfuzztargets_la_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) -pthread
# By itself: two rooms have a step.h.
check_LTLIBRARIES += libfuzzreader.la
libfuzzreader_la_SOURCES = tests/fuzz/target_reader.c tests/fuzz/target_record.c
libfuzzreader_la_CPPFLAGS = $(AM_CPPFLAGS) $(ctl_cppflags) $(XXHASH_CFLAGS) \
    -iquote $(top_srcdir)/tests/fault -iquote $(top_srcdir)/tests/fuzz
# Allocations of all that is linked in can fail; the fuzzer's own are not counted.
target_ldflags = $(AM_LDFLAGS) $(FAULT_WRAP_MEMORY) $(FAULT_WRAP_CALLS)
target_ldadd = $(MSGPACK_ARCHIVE) libfuzzreader.la libfuzztargets.la libserver.la \
    libengine.la libctl.la librecord.la \
    liboracle.la libtestraw.la libproto.la $(UV_ARCHIVE) $(GMP_LIBS) $(JANSSON_LIBS) \
    $(PNG_LIBS) $(LIBM)

check_PROGRAMS += tests/fuzz/replay
tests_fuzz_replay_SOURCES = tests/fuzz/replay.c
tests_fuzz_replay_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz
tests_fuzz_replay_CFLAGS = $(AM_CFLAGS) -pthread
tests_fuzz_replay_LDFLAGS = $(target_ldflags)
tests_fuzz_replay_LDADD = $(target_ldadd)

TESTS += tests/fuzz/test_fuzz_corpus.sh

FUZZ_SECONDS = 60
.PHONY: fuzz fuzz-here
if FUZZ
fuzz_programs =
fuzz_programs += tests/fuzz/fuzz_decoder
EXTRA_PROGRAMS += tests/fuzz/fuzz_decoder
tests_fuzz_fuzz_decoder_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_decoder_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_decoder
tests_fuzz_fuzz_decoder_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_decoder_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_dispatch
EXTRA_PROGRAMS += tests/fuzz/fuzz_dispatch
tests_fuzz_fuzz_dispatch_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_dispatch_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_dispatch
tests_fuzz_fuzz_dispatch_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_dispatch_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_slot
EXTRA_PROGRAMS += tests/fuzz/fuzz_slot
tests_fuzz_fuzz_slot_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_slot_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_slot
tests_fuzz_fuzz_slot_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_slot_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_mesh
EXTRA_PROGRAMS += tests/fuzz/fuzz_mesh
tests_fuzz_fuzz_mesh_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_mesh_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_mesh
tests_fuzz_fuzz_mesh_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_mesh_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_reader
EXTRA_PROGRAMS += tests/fuzz/fuzz_reader
tests_fuzz_fuzz_reader_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_reader_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_reader
tests_fuzz_fuzz_reader_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_reader_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_query
EXTRA_PROGRAMS += tests/fuzz/fuzz_query
tests_fuzz_fuzz_query_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_query_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_query
tests_fuzz_fuzz_query_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_query_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_travel
EXTRA_PROGRAMS += tests/fuzz/fuzz_travel
tests_fuzz_fuzz_travel_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_travel_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_travel
tests_fuzz_fuzz_travel_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_travel_LDADD = $(target_ldadd)
fuzz_programs += tests/fuzz/fuzz_record
EXTRA_PROGRAMS += tests/fuzz/fuzz_record
tests_fuzz_fuzz_record_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_record_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/tests/fuzz -DFUZZ_TARGET=fuzz_record
tests_fuzz_fuzz_record_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_record_LDADD = $(target_ldadd)
fuzz: fuzz-here
else
# In a build of its own, by clang and with its sanitisers.
fuzz:
	$(MKDIR_P) fuzz-build
	cd fuzz-build && { test -f Makefile || $(abs_top_srcdir)/configure -q CC=clang-14 \
	    --enable-fuzz --enable-sanitize=address,undefined CFLAGS='-O1 -g'; }
	$(MAKE) -C fuzz-build fuzz-here FUZZ_SECONDS=$(FUZZ_SECONDS)
endif
fuzz-here: $(fuzz_programs)
	$(BASH) $(top_srcdir)/tests/fuzz/run_fuzz.sh $(FUZZ_SECONDS) $(abs_top_builddir) \
	    $(abs_top_srcdir)/tests/fuzz/corpus

# The first inputs; `make fuzz-seeds` writes them anew after the manifest has changed.
check_PROGRAMS += tests/fuzz/seeds
tests_fuzz_seeds_SOURCES = tests/fuzz/seeds.c
tests_fuzz_seeds_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/client/record
tests_fuzz_seeds_LDADD = libproto.la
.PHONY: fuzz-seeds
fuzz-seeds: tests/fuzz/seeds
	tests/fuzz/seeds $(srcdir)/tests/fuzz/corpus
