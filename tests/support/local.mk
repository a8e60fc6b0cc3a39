# tests/support/local.mk - what several tests need: a real daemon, a raw peer, a known scene.

check_LTLIBRARIES += libtestdaemon.la

libtestdaemon_la_SOURCES = \
    tests/support/crossing.c \
    tests/support/crossing.h \
    tests/support/recording.c \
    tests/support/recording.h \
    tests/support/run_ctl.c \
    tests/support/run_ctl.h \
    tests/support/daemon.c \
    tests/support/daemon.h \
    tests/support/false_daemon.c \
    tests/support/false_daemon.h \
    tests/support/farm.c \
    tests/support/farm.h \
    tests/support/fixture.c \
    tests/support/fixture.h \
    tests/support/grid.c \
    tests/support/grid.h \
    tests/support/hog.c \
    tests/support/hog.h \
    tests/support/lingering.c \
    tests/support/lingering.h \
    tests/support/raw.c \
    tests/support/raw.h \
    tests/support/record_hash.h \
    tests/support/taken.c \
    tests/support/taken.h \
    tests/support/witness.c \
    tests/support/witness.h
libtestdaemon_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/proto -I$(top_srcdir)/client/lib \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
libtestdaemon_la_LIBADD = libpccd.la libproto.la -lm

# The raw peer alone, where libpccd has no place.
check_LTLIBRARIES += libtestraw.la
libtestraw_la_SOURCES = tests/support/raw.c tests/support/raw.h
libtestraw_la_CPPFLAGS = $(AM_CPPFLAGS) -iquote $(top_srcdir)/proto \
    -iquote $(top_srcdir)/tests/support

EXTRA_DIST += tests/support/cmocka.sh tests/support/skip.h

# Sourced by the test scripts.
EXTRA_DIST += tests/support/check.sh tests/support/tap.sh

# What the leak sanitizer is told not to mind.
EXTRA_DIST += tests/support/lsan.supp
