# tests/planner/local.mk - what the planner calls free, by dense samples. Where configure has
# not found OMPL the script skips its cases by name.

test_scripts += tests/planner/test_planner.sh
if HAVE_OMPL
check_PROGRAMS += tests/planner/check tests/planner/turns
tests_planner_check_SOURCES = tests/planner/check.cc
tests_planner_check_CPPFLAGS = -I$(top_srcdir)/client/planner -Iinclude
tests_planner_check_CXXFLAGS = $(client_planner_planner_CXXFLAGS)
tests_planner_check_LDADD = libpccd.la
tests_planner_turns_SOURCES = tests/planner/turns.cc
tests_planner_turns_CPPFLAGS = $(client_planner_planner_CPPFLAGS)
tests_planner_turns_CXXFLAGS = $(client_planner_planner_CXXFLAGS)
tests_planner_turns_LDADD = libpccd.la $(OMPL_LIBS)
endif
