# tests/determinism/local.mk - the same bytes whatever the settings, threads and history.

DETERMINISM_CPPFLAGS = $(AM_CPPFLAGS) $(ENGINE_CPPFLAGS) -I$(top_srcdir)/tests/support \
    -I$(top_srcdir)/client/oracle -I$(top_srcdir)/tests/unit $(XXHASH_CFLAGS) \
    $(CMOCKA_CFLAGS)
DETERMINISM_LDADD = libengkit.la libengine.la libtestscenes.la $(CMOCKA_LIBS) \
    $(GMP_LIBS) $(LIBM)

determinism_names = \
    tests/determinism/test_eng_anew \
    tests/determinism/test_eng_fuzz \
    tests/determinism/test_eng_golden \
    tests/determinism/test_eng_recorded
check_PROGRAMS += $(determinism_names)
TESTS += $(determinism_names)

tests_determinism_test_eng_anew_SOURCES = tests/determinism/test_eng_anew.c
tests_determinism_test_eng_anew_CPPFLAGS = $(DETERMINISM_CPPFLAGS)
tests_determinism_test_eng_anew_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_determinism_test_eng_anew_LDADD = $(DETERMINISM_LDADD)

tests_determinism_test_eng_golden_SOURCES = tests/determinism/test_eng_golden.c
tests_determinism_test_eng_golden_CPPFLAGS = $(DETERMINISM_CPPFLAGS)
tests_determinism_test_eng_golden_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_determinism_test_eng_golden_LDADD = $(DETERMINISM_LDADD)

# A short run; PCCD_FUZZ_SECONDS makes it longer.
tests_determinism_test_eng_fuzz_SOURCES = tests/determinism/test_eng_fuzz.c
tests_determinism_test_eng_fuzz_CPPFLAGS = $(DETERMINISM_CPPFLAGS)
tests_determinism_test_eng_fuzz_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_determinism_test_eng_fuzz_LDADD = $(DETERMINISM_LDADD)

tests_determinism_test_eng_recorded_SOURCES = tests/determinism/test_eng_recorded.c
tests_determinism_test_eng_recorded_CPPFLAGS = $(DETERMINISM_CPPFLAGS)
tests_determinism_test_eng_recorded_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_determinism_test_eng_recorded_LDADD = $(DETERMINISM_LDADD)
