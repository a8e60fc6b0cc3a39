# tests/unit/ctl.mk - the readers and the demo's scene.

CTL_TEST_CPPFLAGS = $(AM_CPPFLAGS) $(ctl_cppflags) $(CMOCKA_CFLAGS)
CTL_TEST_LDADD = libctl.la $(CMOCKA_LIBS) $(LIBM)

check_PROGRAMS += tests/unit/test_ctl_meshfile tests/unit/test_ctl_cloth \
    tests/unit/test_ctl_output
TESTS += tests/unit/test_ctl_meshfile tests/unit/test_ctl_cloth tests/unit/test_ctl_output

tests_unit_test_ctl_meshfile_SOURCES = tests/unit/test_ctl_meshfile.c
tests_unit_test_ctl_meshfile_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_meshfile_LDADD = $(CTL_TEST_LDADD)

tests_unit_test_ctl_cloth_SOURCES = tests/unit/test_ctl_cloth.c
tests_unit_test_ctl_cloth_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_cloth_LDADD = $(CTL_TEST_LDADD)

tests_unit_test_ctl_output_SOURCES = tests/unit/test_ctl_output.c
tests_unit_test_ctl_output_CPPFLAGS = $(CTL_TEST_CPPFLAGS) $(PNG_CFLAGS) $(JANSSON_CFLAGS)
tests_unit_test_ctl_output_LDADD = $(CTL_TEST_LDADD) $(PNG_LIBS) $(JANSSON_LIBS)
