# tests/unit/client.mk - what a client has told a daemon, for those who tell it another.

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
