# tests/fuzz/local.mk - the elementary tests against exact arithmetic, on random queries.
#
# make fuzz-elementary FUZZ_QUERIES=1e8 FUZZ_SEED=1 FUZZ_JOBS=2    half an hour
# tests/fuzz/elementary --replay FILE     lines that a failure has printed

fuzz_sources = \
    tests/fuzz/fuzz_query.c \
    tests/fuzz/fuzz_query.h \
    tests/fuzz/fuzz_range.h \
    tests/fuzz/fuzz_run.c \
    tests/fuzz/fuzz_run.h \
    tests/fuzz/fuzz_sieve.c \
    tests/fuzz/fuzz_sieve.h \
    tests/fuzz/fuzz_spans.c \
    tests/fuzz/fuzz_spans.h \
    tests/fuzz/fuzz_spans_long.c \
    tests/fuzz/fuzz_truth.c \
    tests/fuzz/fuzz_truth.h
FUZZ_CPPFLAGS = $(AM_CPPFLAGS) $(ENGINE_CPPFLAGS) -I$(top_srcdir)/tests/oracle \
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

FUZZ_QUERIES = 1e7
FUZZ_SEED = 1
FUZZ_JOBS = 2
.PHONY: fuzz-elementary
fuzz-elementary: tests/fuzz/elementary
	nice -n 19 tests/fuzz/elementary --queries $(FUZZ_QUERIES) --seed $(FUZZ_SEED) \
	    --jobs $(FUZZ_JOBS)
