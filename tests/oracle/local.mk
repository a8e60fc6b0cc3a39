# tests/oracle/local.mk - exact ground truth; shares nothing with the engine.

check_LTLIBRARIES += liboracle.la

liboracle_la_SOURCES = \
    tests/oracle/oracle.c \
    tests/oracle/oracle.h \
    tests/oracle/oracle_scene.c \
    tests/oracle/oracle_scene.h \
    tests/oracle/oracle_poly.c \
    tests/oracle/oracle_poly.h \
    tests/oracle/oracle_root.c \
    tests/oracle/oracle_root.h
liboracle_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/tests/oracle
liboracle_la_LIBADD = $(GMP_LIBS) $(LIBM)
