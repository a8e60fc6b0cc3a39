# tests/integration/local.mk - a real daemon and real clients.

INTEGRATION_PROGRAMS = \
    tests/integration/test_int_session
check_PROGRAMS += $(INTEGRATION_PROGRAMS)
TESTS += $(INTEGRATION_PROGRAMS)

INTEGRATION_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/proto -I$(top_srcdir)/client/lib \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
INTEGRATION_LIBS = libtestdaemon.la libpccd.la libproto.la $(CMOCKA_LIBS) -lm

tests_integration_test_int_session_SOURCES = tests/integration/test_int_session.c
tests_integration_test_int_session_CPPFLAGS = $(INTEGRATION_CPPFLAGS)
tests_integration_test_int_session_LDADD = $(INTEGRATION_LIBS)
