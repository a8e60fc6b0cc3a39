# tests/unit/server.mk - the parts of the daemon that need no socket.

SERVER_TEST_CPPFLAGS = $(server_cppflags) $(CMOCKA_CFLAGS)
SERVER_TEST_LDADD = libserver.la libengine.la libproto.la $(UV_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_srv_region tests/unit/test_srv_handles \
    tests/unit/test_srv_quota tests/unit/test_srv_compute tests/unit/test_srv_fairqueue \
    tests/unit/test_srv_runners \
    tests/unit/test_srv_log tests/unit/test_srv_outbox \
    tests/unit/test_srv_outlet tests/unit/test_srv_replies tests/unit/test_srv_sandbox
TESTS += tests/unit/test_srv_region tests/unit/test_srv_handles \
    tests/unit/test_srv_quota tests/unit/test_srv_compute tests/unit/test_srv_fairqueue \
    tests/unit/test_srv_runners \
    tests/unit/test_srv_log tests/unit/test_srv_outbox \
    tests/unit/test_srv_outlet tests/unit/test_srv_replies tests/unit/test_srv_sandbox

tests_unit_test_srv_outbox_SOURCES = tests/unit/test_srv_outbox.c
tests_unit_test_srv_outbox_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_outbox_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_outlet_SOURCES = tests/unit/test_srv_outlet.c
tests_unit_test_srv_outlet_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_outlet_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_log_SOURCES = tests/unit/test_srv_log.c
tests_unit_test_srv_log_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_log_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_replies_SOURCES = tests/unit/test_srv_replies.c
tests_unit_test_srv_replies_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_replies_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_region_SOURCES = tests/unit/test_srv_region.c
tests_unit_test_srv_region_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_region_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_handles_SOURCES = tests/unit/test_srv_handles.c
tests_unit_test_srv_handles_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_handles_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_quota_SOURCES = tests/unit/test_srv_quota.c
tests_unit_test_srv_quota_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_quota_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_fairqueue_SOURCES = tests/unit/test_srv_fairqueue.c
tests_unit_test_srv_fairqueue_CPPFLAGS = $(SERVER_TEST_CPPFLAGS) -I$(top_srcdir)/tests/support
tests_unit_test_srv_fairqueue_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_runners_SOURCES = tests/unit/test_srv_runners.c
tests_unit_test_srv_runners_CPPFLAGS = $(SERVER_TEST_CPPFLAGS) $(ENGINE_CPPFLAGS)
tests_unit_test_srv_runners_CFLAGS = $(AM_CFLAGS) -pthread
tests_unit_test_srv_runners_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_compute_SOURCES = tests/unit/test_srv_compute.c
tests_unit_test_srv_compute_CPPFLAGS = $(SERVER_TEST_CPPFLAGS)
tests_unit_test_srv_compute_CFLAGS = $(AM_CFLAGS) -pthread
tests_unit_test_srv_compute_LDADD = $(SERVER_TEST_LDADD)

tests_unit_test_srv_sandbox_SOURCES = tests/unit/test_srv_sandbox.c
tests_unit_test_srv_sandbox_CPPFLAGS = $(SERVER_TEST_CPPFLAGS) $(SECCOMP_CFLAGS) \
    -I$(top_srcdir)/tests/support
tests_unit_test_srv_sandbox_LDADD = $(SECCOMP_LIBS) $(CMOCKA_LIBS)
