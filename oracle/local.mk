# oracle/local.mk - exact ground truth; shares nothing with the engine.

noinst_LTLIBRARIES += liboracle.la

liboracle_la_SOURCES = \
    oracle/oracle.c \
    oracle/oracle.h \
    oracle/oracle_scene.c \
    oracle/oracle_scene.h \
    oracle/oracle_poly.c \
    oracle/oracle_poly.h \
    oracle/oracle_root.c \
    oracle/oracle_root.h
liboracle_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/oracle
liboracle_la_LIBADD = $(GMP_LIBS) $(LIBM)
