# tests/unit/client.mk - parts of the library, which exports nothing of them.

check_PROGRAMS += tests/unit/test_cli_pairs
TESTS += tests/unit/test_cli_pairs

tests_unit_test_cli_pairs_SOURCES = tests/unit/test_cli_pairs.c client/lib/kept_pairs.c
tests_unit_test_cli_pairs_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/client/lib \
    -iquote $(top_srcdir)/proto -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
tests_unit_test_cli_pairs_LDADD = $(CMOCKA_LIBS)
