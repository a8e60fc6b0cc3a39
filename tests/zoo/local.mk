# tests/zoo/local.mk - hostile clients beside an honest one.

check_PROGRAMS += tests/zoo/test_zoo_animals
TESTS += tests/zoo/test_zoo_animals

tests_zoo_test_zoo_animals_SOURCES = \
    tests/zoo/animals.h \
    tests/zoo/animals_data.c \
    tests/zoo/animals_talk.c \
    tests/zoo/animals_work.c \
    tests/zoo/cage.c \
    tests/zoo/cage.h \
    tests/zoo/keeper.c \
    tests/zoo/keeper.h \
    tests/zoo/test_zoo_animals.c
tests_zoo_test_zoo_animals_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/proto -I$(top_srcdir)/client/lib \
    -I$(top_srcdir)/tests/support -I$(top_srcdir)/tests/zoo $(CMOCKA_CFLAGS)
tests_zoo_test_zoo_animals_LDADD = libtestdaemon.la libpccd.la libproto.la $(CMOCKA_LIBS) -lm

# All of it: seconds become minutes, and the figures are printed.
.PHONY: zoo
zoo: tests/zoo/test_zoo_animals pccdd
	@$(AM_TESTS_ENVIRONMENT) tests/zoo/test_zoo_animals --long
