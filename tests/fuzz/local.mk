# tests/fuzz/local.mk - elementary tests against exact arithmetic, on random queries.
#
# make fuzz-elementary FUZZ_QUERIES=1e8 FUZZ_SEED=1 FUZZ_JOBS=2    half an hour; as well
#                                                                  fuzz-distance, fuzz-thick
# tests/fuzz/elementary --replay FILE     lines that a failure has printed

check_PROGRAMS += tests/fuzz/distance tests/fuzz/elementary tests/fuzz/thick
test_programs += \
    tests/fuzz/test_eng_distance \
    tests/fuzz/test_eng_elementary \
    tests/fuzz/test_eng_thick_fuzz
test_scripts += tests/fuzz/test_fuzz_corpus.sh

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

libfuzztargets_la_SOURCES = \
    $(fault_sources) \
    tests/fuzz/fuzz_query.c \
    tests/fuzz/fuzz_run.c \
    tests/fuzz/fuzz_sieve.c \
    tests/fuzz/fuzz_spans.c \
    tests/fuzz/fuzz_spans_long.c \
    tests/fuzz/fuzz_truth.c \
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
check_LTLIBRARIES += libfuzztargets.la libfuzzreader.la
libfuzztargets_la_CPPFLAGS = $(server_cppflags) $(MSGPACK_CFLAGS) \
    -iquote $(top_srcdir)/tests/fault -iquote $(top_srcdir)/tests/fuzz \
    -iquote $(top_srcdir)/tests/support -iquote $(top_srcdir)/client/oracle
libfuzztargets_la_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) -pthread
# By itself: two rooms have a step.h.
libfuzzreader_la_SOURCES = tests/fuzz/target_reader.c tests/fuzz/target_record.c
libfuzzreader_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(ctl_cppflags) $(XXHASH_CFLAGS) \
    -iquote $(top_srcdir)/tests/fault -iquote $(top_srcdir)/tests/fuzz
# Allocations of all that is linked in can fail; the fuzzer's own are not counted.
target_ldflags = $(AM_LDFLAGS) $(FAULT_WRAP_MEMORY) $(FAULT_WRAP_CALLS)
target_ldadd = $(MSGPACK_ARCHIVE) libfuzztargets.la libfuzzreader.la libserver.la \
    libengine.la libctl.la librecord.la \
    liboracle.la libtests.la libproto.la $(UV_ARCHIVE) $(GMP_LIBS) $(JANSSON_LIBS) \
    $(PNG_LIBS) $(LIBM)

check_PROGRAMS += tests/fuzz/replay
tests_fuzz_replay_LDFLAGS = $(target_ldflags)
tests_fuzz_replay_LDADD = $(target_ldadd)

FUZZ_SECONDS = 60
.PHONY: fuzz fuzz-here
if FUZZ
fuzz_programs = tests/fuzz/fuzz
EXTRA_PROGRAMS += tests/fuzz/fuzz
tests_fuzz_fuzz_SOURCES = tests/fuzz/entry.c
tests_fuzz_fuzz_LDFLAGS = $(target_ldflags) -fsanitize=fuzzer
tests_fuzz_fuzz_LDADD = $(target_ldadd)
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
.PHONY: fuzz-seeds
fuzz-seeds: tests/fuzz/seeds
	tests/fuzz/seeds $(srcdir)/tests/fuzz/corpus
