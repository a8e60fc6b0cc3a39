# tests/zoo/local.mk - hostile clients beside an honest one.

test_programs += tests/zoo/test_zoo_animals tests/zoo/test_zoo_idle

tests_zoo_test_zoo_animals_SOURCES = \
    tests/zoo/animals_data.c \
    tests/zoo/animals_long.c \
    tests/zoo/animals_share.c \
    tests/zoo/animals_talk.c \
    tests/zoo/animals_work.c \
    tests/zoo/cage.c \
    tests/zoo/keeper.c \
    tests/zoo/test_zoo_animals.c

# All of it: seconds become minutes, and the figures are printed.
.PHONY: zoo idle deadlines long-requests
zoo: tests/zoo/test_zoo_animals pccdd
	@$(AM_TESTS_ENVIRONMENT) tests/zoo/test_zoo_animals --long

IDLE_CLIENTS = 2000
IDLE_SECONDS = 10
idle: tests/zoo/test_zoo_idle pccdd
	@$(AM_TESTS_ENVIRONMENT) IDLE_CLIENTS=$(IDLE_CLIENTS) IDLE_SECONDS=$(IDLE_SECONDS) \
	    tests/zoo/test_zoo_idle

DEADLINE_ROUNDS = 2000
deadlines: tests/integration/test_int_deadline pccdd
	@$(AM_TESTS_ENVIRONMENT) DEADLINE_ROUNDS=$(DEADLINE_ROUNDS) tests/integration/test_int_deadline

LONG_STEPS = 1000
long-requests: tests/integration/test_int_long pccdd
	@$(AM_TESTS_ENVIRONMENT) LONG_STEPS=$(LONG_STEPS) tests/integration/test_int_long
