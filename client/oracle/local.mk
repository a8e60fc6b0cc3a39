# client/oracle/local.mk - exact ground truth; shares nothing with the engine.

noinst_LTLIBRARIES += liboracle.la

liboracle_la_SOURCES = \
    client/oracle/oracle.c \
    client/oracle/oracle_candidates.c \
    client/oracle/oracle_distance.c \
    client/oracle/oracle_features.c \
    client/oracle/oracle_first.c \
    client/oracle/oracle_near.c \
    client/oracle/oracle_objects.c \
    client/oracle/oracle_inside.c \
    client/oracle/oracle_scene.c \
    client/oracle/oracle_poly.c \
    client/oracle/oracle_root.c \
    client/oracle/oracle_thick.c \
    client/oracle/oracle_touching.c \
    client/oracle/oracle_turning.c \
    client/oracle/oracle_turning_fine.c \
    client/oracle/oracle_vec.c \
    client/oracle/oracle_within.c
liboracle_la_CPPFLAGS = $(PCCD_CPPFLAGS) -I$(top_srcdir)/client/oracle
liboracle_la_LIBADD = $(GMP_LIBS) $(LIBM)
