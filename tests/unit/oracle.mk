# tests/unit/oracle.mk - the exact oracle itself.

check_PROGRAMS += tests/unit/test_oracle
TESTS += tests/unit/test_oracle

tests_unit_test_oracle_SOURCES = tests/unit/test_oracle.c
tests_unit_test_oracle_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/client/oracle \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
tests_unit_test_oracle_LDADD = liboracle.la $(CMOCKA_LIBS) $(GMP_LIBS) $(LIBM)

check_PROGRAMS += tests/unit/test_oracle_distance
TESTS += tests/unit/test_oracle_distance

tests_unit_test_oracle_distance_SOURCES = tests/unit/test_oracle_distance.c
tests_unit_test_oracle_distance_CPPFLAGS = $(tests_unit_test_oracle_CPPFLAGS)
tests_unit_test_oracle_distance_LDADD = $(tests_unit_test_oracle_LDADD)

check_PROGRAMS += tests/unit/test_oracle_thick
TESTS += tests/unit/test_oracle_thick

tests_unit_test_oracle_thick_SOURCES = tests/unit/test_oracle_thick.c \
    tests/unit/thick_cases.c
tests_unit_test_oracle_thick_CPPFLAGS = $(tests_unit_test_oracle_CPPFLAGS)
tests_unit_test_oracle_thick_LDADD = $(tests_unit_test_oracle_LDADD)
