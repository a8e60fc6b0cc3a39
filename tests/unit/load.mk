# tests/unit/load.mk - would the load harness notice, and does it ask as it says?

load_tests = tests/unit/test_load_judge tests/unit/test_load_pace
check_PROGRAMS += $(load_tests)
TESTS += $(load_tests)

tests_unit_test_load_judge_SOURCES = tests/unit/test_load_judge.c
tests_unit_test_load_judge_CPPFLAGS = $(AM_CPPFLAGS) $(load_cppflags) $(CMOCKA_CFLAGS)
tests_unit_test_load_judge_LDADD = libload.la libpccd.la $(CMOCKA_LIBS) $(LIBM)

tests_unit_test_load_pace_SOURCES = tests/unit/test_load_pace.c
tests_unit_test_load_pace_CPPFLAGS = $(AM_CPPFLAGS) $(load_cppflags) $(CMOCKA_CFLAGS)
tests_unit_test_load_pace_LDADD = libload.la libpccd.la $(CMOCKA_LIBS) $(LIBM)
