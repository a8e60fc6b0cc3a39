# tests/property/local.mk - the engine against the oracle on generated scenes.

check_PROGRAMS += tests/property/test_eng_against_oracle
TESTS += tests/property/test_eng_against_oracle

tests_property_test_eng_against_oracle_SOURCES = \
    tests/property/judge.c \
    tests/property/judge.h \
    tests/property/test_eng_against_oracle.c
tests_property_test_eng_against_oracle_CPPFLAGS = $(AM_CPPFLAGS) \
    $(ENGINE_CPPFLAGS) -I$(top_srcdir)/tests/oracle \
    -I$(top_srcdir)/tests/support -I$(top_srcdir)/tests/property $(CMOCKA_CFLAGS)
tests_property_test_eng_against_oracle_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_against_oracle_LDADD = libengine.la liboracle.la libtestscenes.la \
    $(CMOCKA_LIBS) $(GMP_LIBS) $(LIBM)
