# client/planner/local.mk - the header for planners of OMPL, and an example, which is built
# where configure has found OMPL.

include_HEADERS += client/planner/pccd_motion.hpp
if HAVE_OMPL
check_PROGRAMS += client/planner/planner
client_planner_planner_SOURCES = client/planner/planner.cc
client_planner_planner_CPPFLAGS = -I$(top_srcdir)/client/planner -Iinclude $(OMPL_CPPFLAGS)
client_planner_planner_CXXFLAGS = -std=c++17 -Wall -Wextra -Wconversion -Wshadow $(CXXFLAGS)
client_planner_planner_LDADD = libpccd.la $(OMPL_LIBS)
endif
