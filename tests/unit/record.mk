# tests/unit/record.mk - the file format of recordings.

check_PROGRAMS += tests/unit/test_rec_format
TESTS += tests/unit/test_rec_format

tests_unit_test_rec_format_SOURCES = tests/unit/test_rec_format.c
tests_unit_test_rec_format_CPPFLAGS = $(AM_CPPFLAGS) $(record_cppflags) $(CMOCKA_CFLAGS)
tests_unit_test_rec_format_LDADD = librecord.la $(CMOCKA_LIBS)
