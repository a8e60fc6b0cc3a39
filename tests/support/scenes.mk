# tests/support/scenes.mk - generated scenes, and readers of the public ones.

check_LTLIBRARIES += libtestscenes.la

libtestscenes_la_SOURCES = \
    tests/support/data.c \
    tests/support/golden.c \
    tests/support/play.c \
    tests/support/play_actor.c \
    tests/support/play_wild.c \
    tests/support/ply.c \
    tests/support/scenes.c
libtestscenes_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/tests/support
libtestscenes_la_LIBADD = $(GMP_LIBS) $(LIBM)
