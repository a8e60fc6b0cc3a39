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
    client/examples/game_boxes \
    client/examples/game_loop \
    client/examples/two_processes
check_PROGRAMS += $(example_names)

example_libs = libpccd.la $(LIBM)
client_examples_hello_LDADD = $(example_libs)
client_examples_cloth_LDADD = $(example_libs)
client_examples_cloth_near_LDADD = $(example_libs)
client_examples_cloth_thick_LDADD = $(example_libs)
client_examples_game_balls_LDADD = $(example_libs)
client_examples_game_boxes_LDADD = $(example_libs)
client_examples_game_loop_LDADD = $(example_libs)
client_examples_two_processes_LDADD = $(example_libs)

test_scripts += client/examples/run_examples.sh
