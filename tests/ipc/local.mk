# tests/ipc/local.mk - the header for ipc-toolkit, where configure was told of that. Without
# it the script skips its cases by name.

test_scripts += tests/ipc/test_ipc.sh
if HAVE_IPC_TOOLKIT
check_PROGRAMS += tests/ipc/check
tests_ipc_check_SOURCES = tests/ipc/check.cc
tests_ipc_check_CPPFLAGS = $(AM_CPPFLAGS) $(ipc_cppflags)
tests_ipc_check_CXXFLAGS = $(ipc_cxxflags)
tests_ipc_check_LDADD = libpccd.la libtests.la liboracle.la $(ipc_libs) $(GMP_LIBS)
endif
