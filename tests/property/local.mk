# tests/property/local.mk - the engine against the oracle on generated scenes.

property_names = \
    tests/property/test_eng_against_oracle \
    tests/property/test_eng_near_objects \
    tests/property/test_eng_plays \
    tests/property/test_eng_standing \
    tests/property/test_eng_rigid \
    tests/property/test_eng_near \
    tests/property/test_eng_near_oracle \
    tests/property/test_eng_thick_plays
check_PROGRAMS += $(property_names)
TESTS += $(property_names)

PROPERTY_CPPFLAGS = $(AM_CPPFLAGS) $(ENGINE_CPPFLAGS) -I$(top_srcdir)/client/oracle \
    -I$(top_srcdir)/tests/support -I$(top_srcdir)/tests/property \
    -I$(top_srcdir)/tests/unit $(XXHASH_CFLAGS) $(CMOCKA_CFLAGS)
PROPERTY_LDADD = libengkit.la libengine.la liboracle.la libtestscenes.la $(CMOCKA_LIBS) \
    $(GMP_LIBS) $(LIBM)
property_sequences = tests/property/sequences.c
property_thick_judge = tests/property/thick_judge.c
property_near_judge = tests/property/near_judge.c
property_judge = \
    tests/property/judge.c

tests_property_test_eng_against_oracle_SOURCES = \
    tests/property/test_eng_against_oracle.c $(property_judge)
tests_property_test_eng_against_oracle_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_against_oracle_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_against_oracle_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_near_objects_SOURCES = \
    tests/property/test_eng_near_objects.c $(property_sequences) $(property_near_judge)
tests_property_test_eng_near_objects_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_near_objects_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_near_objects_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_plays_SOURCES = tests/property/test_eng_plays.c $(property_judge)
tests_property_test_eng_plays_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_plays_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_plays_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_standing_SOURCES = tests/property/test_eng_standing.c \
    $(property_sequences) $(property_judge)
tests_property_test_eng_standing_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_standing_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_standing_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_rigid_SOURCES = tests/property/test_eng_rigid.c \
    $(property_sequences) $(property_judge)
tests_property_test_eng_rigid_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_rigid_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_rigid_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_near_oracle_SOURCES = tests/property/test_eng_near_oracle.c \
    $(property_sequences) $(property_near_judge) $(property_thick_judge)
tests_property_test_eng_near_oracle_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_near_oracle_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_near_oracle_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_thick_plays_SOURCES = tests/property/test_eng_thick_plays.c \
    $(property_thick_judge)
tests_property_test_eng_thick_plays_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_thick_plays_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_thick_plays_LDADD = $(PROPERTY_LDADD)

tests_property_test_eng_near_SOURCES = tests/property/test_eng_near.c
tests_property_test_eng_near_CPPFLAGS = $(PROPERTY_CPPFLAGS)
tests_property_test_eng_near_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_property_test_eng_near_LDADD = $(PROPERTY_LDADD)
