# tests/unit/load.mk - would the load harness notice?

check_PROGRAMS += tests/unit/test_load_judge
TESTS += tests/unit/test_load_judge

tests_unit_test_load_judge_SOURCES = tests/unit/test_load_judge.c
tests_unit_test_load_judge_CPPFLAGS = $(AM_CPPFLAGS) $(load_cppflags) $(CMOCKA_CFLAGS)
tests_unit_test_load_judge_LDADD = libload.la libpccd.la $(CMOCKA_LIBS) $(LIBM)
