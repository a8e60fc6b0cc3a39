# tests/abi/local.mk - what compiled clients rely on.

check_PROGRAMS += test_abi_layout
TESTS += test_abi_layout
test_abi_layout_SOURCES = tests/abi/test_abi_layout.c
test_abi_layout_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/client/lib $(CMOCKA_CFLAGS)
test_abi_layout_LDADD = $(CMOCKA_LIBS)

TESTS += tests/abi/test_abi_headers.sh
