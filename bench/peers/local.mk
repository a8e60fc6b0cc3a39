# bench/peers/local.mk - other libraries' candidate pairs; for those that are installed.
#
# make bench-peers                             tables of all scenes
# make bench-peers BENCH_ARGS=--json           one JSON line a row
#
# The only C++ here, and built only where configure has found a library: apt-get install
# libembree-dev libfcl-dev libbullet-dev libcgal-dev

PEERS_CXXFLAGS = -std=c++17 -Wall -Wextra -Wshadow
EXTRA_DIST += \
    bench/peers/bullet.cc \
    bench/peers/cgal.cc \
    bench/peers/embree.cc \
    bench/peers/fcl.cc

if HAVE_PEERS
check_PROGRAMS += bench/peers/peers

bench_peers_peers_SOURCES = \
    bench/peers/swept.c \
    bench/peers/swept.h \
    bench/peers/ours.c \
    bench/peers/ours.h \
    bench/peers/peer.h \
    bench/peers/peers.c \
    bench/peers/steps.c \
    bench/peers/steps.h \
    bench/peers/tests.c \
    bench/peers/tests.h \
    $(bench_engine_sources)
bench_peers_peers_CPPFLAGS = $(bench_engine_cppflags) $(PEERS_CPPFLAGS) \
    -I$(top_srcdir)/bench/peers
bench_peers_peers_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
bench_peers_peers_CXXFLAGS = $(PEERS_CXXFLAGS)
# Linked by the C compiler, which knows the OpenMP and the sanitizers that ours has been
# compiled for; CXX may be another one's.
bench_peers_peers_LINK = $(LINK) $(OPENMP_CFLAGS)
bench_peers_peers_LDADD = $(bench_engine_libs) $(PEERS_LIBS) -lstdc++
if HAVE_EMBREE
bench_peers_peers_SOURCES += bench/peers/embree.cc
endif
if HAVE_BULLET
bench_peers_peers_SOURCES += bench/peers/bullet.cc
endif
if HAVE_FCL
bench_peers_peers_SOURCES += bench/peers/fcl.cc
endif
if HAVE_CGAL
bench_peers_peers_SOURCES += bench/peers/cgal.cc
endif

bench-peers: bench/peers/peers
	@$(AM_TESTS_ENVIRONMENT) bench/peers/peers $(BENCH_ARGS)
else
bench-peers:
	@echo 'configure has found none of Embree, Bullet, FCL, CGAL'; exit 1
endif
.PHONY: bench-peers

TESTS += bench/peers/smoke.sh
dist_check_SCRIPTS += bench/peers/smoke.sh
