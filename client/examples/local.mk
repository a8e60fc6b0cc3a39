# client/examples/local.mk - small programs, built and run by make check.
#
# Each checks its own answers and exits with 1 when one is wrong. run_examples.sh wraps them
# in TAP.

example_names = \
    client/examples/hello \
    client/examples/cloth \
    client/examples/cloth_near \
    client/examples/cloth_thick \
    client/examples/game_balls \
    client/examples/game_loop \
    client/examples/two_processes
check_PROGRAMS += $(example_names)

example_cppflags = $(AM_CPPFLAGS) -I$(top_srcdir)/client/lib -I$(top_srcdir)/proto/common

client_examples_hello_SOURCES = client/examples/hello.c
client_examples_hello_CPPFLAGS = $(example_cppflags)
client_examples_hello_LDADD = libpccd.la
client_examples_cloth_SOURCES = client/examples/cloth.c
client_examples_cloth_CPPFLAGS = $(example_cppflags)
client_examples_cloth_LDADD = libpccd.la -lm
client_examples_cloth_thick_SOURCES = client/examples/cloth_thick.c
client_examples_cloth_thick_CPPFLAGS = $(example_cppflags)
client_examples_cloth_thick_LDADD = libpccd.la -lm

client_examples_cloth_near_SOURCES = client/examples/cloth_near.c
client_examples_cloth_near_CPPFLAGS = $(example_cppflags)
client_examples_cloth_near_LDADD = libpccd.la -lm
client_examples_game_balls_SOURCES = client/examples/game_balls.c
client_examples_game_balls_CPPFLAGS = $(example_cppflags)
client_examples_game_balls_LDADD = libpccd.la -lm
client_examples_game_loop_SOURCES = client/examples/game_loop.c
client_examples_game_loop_CPPFLAGS = $(example_cppflags)
client_examples_game_loop_LDADD = libpccd.la -lm
client_examples_two_processes_SOURCES = client/examples/two_processes.c
client_examples_two_processes_CPPFLAGS = $(example_cppflags)
client_examples_two_processes_LDADD = libpccd.la

TESTS += client/examples/run_examples.sh
