# client/ipc/local.mk - the header for programs that use ipc-toolkit, and an example.
#
# The header is installed always; nothing is compiled here but where configure was told of
# ipc-toolkit (IPC_TOOLKIT_CXXFLAGS, IPC_TOOLKIT_LIBS). Flags of its headers are -isystem's:
# they are not written for our warnings.

include_HEADERS += client/ipc/pccd_ipc.hpp
if HAVE_IPC_TOOLKIT
ipc_cppflags = -I$(top_srcdir)/client/ipc -Iinclude
ipc_cxxflags = -std=c++17 -Wall -Wextra -Wshadow $(IPC_TOOLKIT_CXXFLAGS)
ipc_libs = $(IPC_TOOLKIT_LIBS)
check_PROGRAMS += client/ipc/cloth
client_ipc_cloth_SOURCES = client/ipc/cloth.cc
client_ipc_cloth_CPPFLAGS = $(ipc_cppflags)
client_ipc_cloth_CXXFLAGS = $(ipc_cxxflags)
client_ipc_cloth_LDADD = libpccd.la $(ipc_libs)

# An implicit cloth by both, side by side; its page has the table.
bench-ipc-cloth: client/ipc/cloth$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) client/ipc/cloth $(BENCH_ARGS)
endif
.PHONY: bench-ipc-cloth
