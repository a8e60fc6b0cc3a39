# tests/truth/local.mk - published ground truth; skipped by name where it is absent.

TRUTH_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/client/oracle -I$(top_srcdir)/tests/support \
    $(CMOCKA_CFLAGS)
TRUTH_LDADD = liboracle.la libtestscenes.la $(CMOCKA_LIBS) $(GMP_LIBS) $(LIBM)

check_PROGRAMS += tests/truth/test_oracle_truth tests/truth/test_eng_truth
TESTS += tests/truth/test_oracle_truth tests/truth/test_eng_truth

tests_truth_test_oracle_truth_SOURCES = tests/truth/test_oracle_truth.c
tests_truth_test_oracle_truth_CPPFLAGS = $(TRUTH_CPPFLAGS)
tests_truth_test_oracle_truth_LDADD = $(TRUTH_LDADD)

tests_truth_test_eng_truth_SOURCES = tests/truth/test_eng_truth.c
tests_truth_test_eng_truth_CPPFLAGS = $(TRUTH_CPPFLAGS) $(ENGINE_CPPFLAGS) \
    -I$(top_srcdir)/tests/unit
tests_truth_test_eng_truth_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_truth_test_eng_truth_LDADD = libengkit.la libengine.la $(TRUTH_LDADD)
