# tests/unit/client.mk - what clients do without a daemon.

# What a client has told a daemon, for those who tell it another.
registry_tests = \
    tests/unit/test_reg_map \
    tests/unit/test_reg_pairs \
    tests/unit/test_reg_positions \
    tests/unit/test_reg_registry
check_PROGRAMS += $(registry_tests)
TESTS += $(registry_tests)

reg_test_cppflags = $(AM_CPPFLAGS) $(registry_cppflags) -I$(top_srcdir)/tests/support \
    $(CMOCKA_CFLAGS)
reg_test_ldadd = libregistry.la $(CMOCKA_LIBS)
tests_unit_test_reg_map_CPPFLAGS = $(reg_test_cppflags)
tests_unit_test_reg_map_LDADD = $(reg_test_ldadd)
tests_unit_test_reg_pairs_CPPFLAGS = $(reg_test_cppflags)
tests_unit_test_reg_pairs_LDADD = $(reg_test_ldadd)
tests_unit_test_reg_positions_CPPFLAGS = $(reg_test_cppflags)
tests_unit_test_reg_positions_LDADD = $(reg_test_ldadd)
tests_unit_test_reg_registry_CPPFLAGS = $(reg_test_cppflags)
tests_unit_test_reg_registry_LDADD = $(reg_test_ldadd)

# What libpccd does by itself.
check_PROGRAMS += tests/unit/test_cli_weld
TESTS += tests/unit/test_cli_weld
tests_unit_test_cli_weld_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/client/lib \
    -iquote $(top_srcdir)/proto/common -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
tests_unit_test_cli_weld_LDADD = libpccd.la $(CMOCKA_LIBS) $(LIBM)

# What libpccd-mpi does without MPI.
check_PROGRAMS += tests/unit/test_rank_moving
TESTS += tests/unit/test_rank_moving
tests_unit_test_rank_moving_SOURCES = tests/unit/test_rank_moving.c
tests_unit_test_rank_moving_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/client/mpi \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
tests_unit_test_rank_moving_LDADD = $(CMOCKA_LIBS) -lm

check_PROGRAMS += tests/unit/test_rank_sort
TESTS += tests/unit/test_rank_sort
tests_unit_test_rank_sort_SOURCES = tests/unit/test_rank_sort.c client/mpi/rank_sort.c
tests_unit_test_rank_sort_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/client/mpi \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
tests_unit_test_rank_sort_LDADD = $(CMOCKA_LIBS)
