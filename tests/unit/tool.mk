# tests/unit/tool.mk - what pccdctl and pccd-load share.

TOOL_TESTS = tests/unit/test_tool_shown tests/unit/test_tool_whole_file
check_PROGRAMS += $(TOOL_TESTS)
TESTS += $(TOOL_TESTS)

TOOL_TEST_CPPFLAGS = $(AM_CPPFLAGS) $(tool_cppflags) -I$(top_srcdir)/tests/support \
    $(CMOCKA_CFLAGS)
TOOL_TEST_LDADD = libtools.la $(CMOCKA_LIBS)
tests_unit_test_tool_shown_SOURCES = tests/unit/test_tool_shown.c
tests_unit_test_tool_shown_CPPFLAGS = $(TOOL_TEST_CPPFLAGS)
tests_unit_test_tool_shown_LDADD = $(TOOL_TEST_LDADD)
tests_unit_test_tool_whole_file_SOURCES = tests/unit/test_tool_whole_file.c
tests_unit_test_tool_whole_file_CPPFLAGS = $(TOOL_TEST_CPPFLAGS)
tests_unit_test_tool_whole_file_LDADD = $(TOOL_TEST_LDADD)
