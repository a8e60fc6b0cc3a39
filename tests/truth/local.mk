# tests/truth/local.mk - published ground truth; skipped by name where it is absent.

TRUTH_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/client/oracle -I$(top_srcdir)/tests/support \
    $(CMOCKA_CFLAGS)
TRUTH_LDADD = liboracle.la libtestscenes.la $(CMOCKA_LIBS) $(GMP_LIBS) $(LIBM)
TRUTH_ENGINE_CPPFLAGS = $(TRUTH_CPPFLAGS) $(ENGINE_CPPFLAGS) -I$(top_srcdir)/tests/unit
TRUTH_ENGINE_LDADD = libengkit.la libengine.la $(TRUTH_LDADD)

check_PROGRAMS += tests/truth/test_oracle_truth tests/truth/test_eng_truth \
    tests/truth/test_eng_thick_truth
TESTS += tests/truth/test_oracle_truth tests/truth/test_eng_truth \
    tests/truth/test_eng_thick_truth

truth_kit = tests/truth/truth_kit.c
truth_engine = $(truth_kit) tests/truth/truth_engine.c

tests_truth_test_oracle_truth_SOURCES = tests/truth/test_oracle_truth.c $(truth_kit)
tests_truth_test_oracle_truth_CPPFLAGS = $(TRUTH_CPPFLAGS)
tests_truth_test_oracle_truth_LDADD = $(TRUTH_LDADD)

tests_truth_test_eng_truth_SOURCES = tests/truth/test_eng_truth.c $(truth_engine)
tests_truth_test_eng_truth_CPPFLAGS = $(TRUTH_ENGINE_CPPFLAGS)
tests_truth_test_eng_truth_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_truth_test_eng_truth_LDADD = $(TRUTH_ENGINE_LDADD)

tests_truth_test_eng_thick_truth_SOURCES = tests/truth/test_eng_thick_truth.c \
    tests/truth/thick_trial.c \
    tests/fuzz/fuzz_thick.c tests/fuzz/fuzz_thick_make.c \
    $(truth_engine)
tests_truth_test_eng_thick_truth_CPPFLAGS = $(TRUTH_ENGINE_CPPFLAGS) \
    -I$(top_srcdir)/tests/fuzz
tests_truth_test_eng_thick_truth_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_truth_test_eng_thick_truth_LDADD = $(TRUTH_ENGINE_LDADD)
