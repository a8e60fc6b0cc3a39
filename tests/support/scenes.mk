# tests/support/scenes.mk - generated scenes, and readers of the public ones.

check_LTLIBRARIES += libtestscenes.la

libtestscenes_la_SOURCES = \
    tests/support/data.c \
    tests/support/data.h \
    tests/support/golden.c \
    tests/support/golden.h \
    tests/support/play.c \
    tests/support/play.h \
    tests/support/play_actor.c \
    tests/support/play_actor.h \
    tests/support/play_wild.c \
    tests/support/ply.c \
    tests/support/ply.h \
    tests/support/prng.h \
    tests/support/scenes.c \
    tests/support/scenes.h
libtestscenes_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/tests/support
libtestscenes_la_LIBADD = $(GMP_LIBS) $(LIBM)
