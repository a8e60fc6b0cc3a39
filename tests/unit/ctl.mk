# tests/unit/ctl.mk - the readers and the demo's scene.

CTL_TEST_CPPFLAGS = $(AM_CPPFLAGS) $(ctl_cppflags) -I$(top_srcdir)/tests/unit \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
CTL_TEST_LDADD = libctl.la libclient.la $(CMOCKA_LIBS) $(LIBM)

check_LTLIBRARIES += libctlkit.la
libctlkit_la_SOURCES = tests/unit/ctl_kit.c
libctlkit_la_CPPFLAGS = $(CTL_TEST_CPPFLAGS)

CTL_TESTS = \
    tests/unit/test_ctl_meshfile \
    tests/unit/test_ctl_malformed \
    tests/unit/test_ctl_parts \
    tests/unit/test_ctl_polygon \
    tests/unit/test_ctl_writers \
    tests/unit/test_ctl_point_cache \
    tests/unit/test_ctl_stl_glb \
    tests/unit/test_ctl_gltf \
    tests/unit/test_ctl_weld \
    tests/unit/test_ctl_cloth \
    tests/unit/test_ctl_output \
    tests/unit/test_ctl_trace \
    tests/unit/test_ctl_inspect
check_PROGRAMS += $(CTL_TESTS)
TESTS += $(CTL_TESTS)

tests_unit_test_ctl_meshfile_SOURCES = tests/unit/test_ctl_meshfile.c
tests_unit_test_ctl_meshfile_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_meshfile_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_malformed_SOURCES = tests/unit/test_ctl_malformed.c
tests_unit_test_ctl_malformed_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_malformed_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_parts_SOURCES = tests/unit/test_ctl_parts.c
tests_unit_test_ctl_parts_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_parts_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_writers_SOURCES = tests/unit/test_ctl_writers.c
tests_unit_test_ctl_writers_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_writers_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_polygon_SOURCES = tests/unit/test_ctl_polygon.c
tests_unit_test_ctl_polygon_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_polygon_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_point_cache_SOURCES = tests/unit/test_ctl_point_cache.c
tests_unit_test_ctl_point_cache_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_point_cache_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_stl_glb_SOURCES = tests/unit/test_ctl_stl_glb.c
tests_unit_test_ctl_stl_glb_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_stl_glb_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_gltf_SOURCES = tests/unit/test_ctl_gltf.c
tests_unit_test_ctl_gltf_CPPFLAGS = $(CTL_TEST_CPPFLAGS) $(JANSSON_CFLAGS)
tests_unit_test_ctl_gltf_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_weld_SOURCES = tests/unit/test_ctl_weld.c
tests_unit_test_ctl_weld_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_weld_LDADD = libctlkit.la $(CTL_TEST_LDADD) $(JANSSON_LIBS)

tests_unit_test_ctl_cloth_SOURCES = tests/unit/test_ctl_cloth.c
tests_unit_test_ctl_cloth_CPPFLAGS = $(CTL_TEST_CPPFLAGS)
tests_unit_test_ctl_cloth_LDADD = libctl.la libpccd.la $(CMOCKA_LIBS) $(LIBM)

tests_unit_test_ctl_output_SOURCES = tests/unit/test_ctl_output.c
tests_unit_test_ctl_output_CPPFLAGS = $(CTL_TEST_CPPFLAGS) $(PNG_CFLAGS) $(JANSSON_CFLAGS)
tests_unit_test_ctl_output_LDADD = $(CTL_TEST_LDADD) $(PNG_LIBS) $(JANSSON_LIBS)

tests_unit_test_ctl_trace_SOURCES = tests/unit/test_ctl_trace.c
tests_unit_test_ctl_trace_CPPFLAGS = $(CTL_TEST_CPPFLAGS) $(JANSSON_CFLAGS)
tests_unit_test_ctl_trace_LDADD = libctl.la libpccd.la $(CMOCKA_LIBS) $(JANSSON_LIBS) $(LIBM)

tests_unit_test_ctl_inspect_SOURCES = tests/unit/test_ctl_inspect.c
tests_unit_test_ctl_inspect_CPPFLAGS = $(CTL_TEST_CPPFLAGS) $(JANSSON_CFLAGS)
tests_unit_test_ctl_inspect_LDADD = libctl.la libpccd.la librecord.la liboracle.la \
    $(CMOCKA_LIBS) $(JANSSON_LIBS) $(LIBM)
