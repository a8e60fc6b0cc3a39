# tests/support/local.mk - what several tests need: a real daemon, a raw peer, a known scene.

check_LTLIBRARIES += libtestdaemon.la

libtestdaemon_la_SOURCES = \
    tests/support/crossing.c \
    tests/support/recording.c \
    tests/support/run_ctl.c \
    tests/support/daemon.c \
    tests/support/false_daemon.c \
    tests/support/farm.c \
    tests/support/fixture.c \
    tests/support/grid.c \
    tests/support/hog.c \
    tests/support/lingering.c \
    tests/support/raw.c \
    tests/support/taken.c \
    tests/support/witness.c
libtestdaemon_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/proto -I$(top_srcdir)/client/lib \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
libtestdaemon_la_LIBADD = libpccd.la libproto.la -lm

# The raw peer alone, where libpccd has no place.
check_LTLIBRARIES += libtestraw.la
libtestraw_la_SOURCES = tests/support/raw.c
libtestraw_la_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/tests/support

# Sourced by the test scripts.

# What the leak sanitizer is told not to mind.
