# bench/peers/local.mk - other libraries' candidate pairs, for those that are installed;
# what is near, by us and by ipc-toolkit.
#
# make bench-peers                             tables of all scenes
# make bench-peers BENCH_ARGS=--json           one JSON line a row
# make bench-near BENCH_ARGS=cloth-ball        what is near, of one scene
# make bench-allowed BENCH_ARGS=cloth-ball     how much of a step is safe
# make bench-queries                           who is right on pairs that were made to be hard
#
# The only C++ here, and built only where configure has found a library: apt-get install
# libembree-dev libfcl-dev libbullet-dev libcgal-dev

PEERS_CXXFLAGS = -std=c++17 -Wall -Wextra -Wshadow

# What is near, and how much of a step is safe: ours is measured by itself where there is no
# ipc-toolkit.
check_PROGRAMS += bench/peers/near
bench_peers_near_SOURCES = \
    bench/peers/allowed.c \
    bench/peers/near.c \
    bench/peers/near_judge.c \
    bench/peers/near_ours.c \
    bench/peers/swept.c
bench_peers_near_CPPFLAGS = $(AM_CPPFLAGS)
bench_peers_near_CXXFLAGS = $(PEERS_CXXFLAGS) $(IPC_TOOLKIT_CXXFLAGS)
bench_peers_near_LINK = $(LINK) $(OPENMP_CFLAGS)
bench_peers_near_LDADD = $(LDADD)
if HAVE_IPC_TOOLKIT
bench_peers_near_SOURCES += bench/peers/ipc_toolkit.cc
bench_peers_near_CPPFLAGS += -DPEERS_IPC_TOOLKIT
bench_peers_near_LDADD += $(IPC_TOOLKIT_LIBS) -lstdc++
endif

.PHONY: bench-near
bench-near: bench/peers/near$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) bench/peers/near $(BENCH_ARGS)

.PHONY: bench-allowed
bench-allowed: bench/peers/near$(EXEEXT)
	@$(AM_TESTS_ENVIRONMENT) bench/peers/near allowed $(BENCH_ARGS)

if HAVE_PEERS
check_PROGRAMS += bench/peers/peers

bench_peers_peers_SOURCES = \
    bench/peers/swept.c \
    bench/peers/ours.c \
    bench/peers/peers.c \
    bench/peers/tests.c
bench_peers_peers_CPPFLAGS = $(AM_CPPFLAGS) $(PEERS_CPPFLAGS)
bench_peers_peers_CXXFLAGS = $(PEERS_CXXFLAGS)
# Linked by the C compiler, which knows the OpenMP and the sanitizers that ours has been
# compiled for; CXX may be another one's.
bench_peers_peers_LINK = $(LINK) $(OPENMP_CFLAGS)
bench_peers_peers_LDADD = $(LDADD) $(PEERS_LIBS) -lstdc++
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

# Bodies that turn, beside FCL asked at poses.
if HAVE_FCL
check_PROGRAMS += bench/peers/turning
bench_peers_turning_SOURCES = bench/peers/turning.cc
bench_peers_turning_CPPFLAGS = $(AM_CPPFLAGS) $(PEERS_CPPFLAGS)
bench_peers_turning_CXXFLAGS = $(PEERS_CXXFLAGS)
bench_peers_turning_LDADD = libbench.la libtests.la libpccd.la $(PEERS_LIBS) $(JANSSON_LIBS) \
    $(GMP_LIBS)

bench-turning: bench/peers/turning
	@$(AM_TESTS_ENVIRONMENT) bench/peers/turning $(BENCH_ARGS)

# Who is right on pairs that were made to be hard?
check_PROGRAMS += bench/peers/queries
bench_peers_queries_SOURCES = bench/peers/queries.cc
bench_peers_queries_CPPFLAGS = $(AM_CPPFLAGS) $(PEERS_CPPFLAGS)
bench_peers_queries_CXXFLAGS = $(PEERS_CXXFLAGS) $(IPC_TOOLKIT_CXXFLAGS)
bench_peers_queries_LDADD = libpccd.la libtests.la $(PEERS_LIBS) $(CMOCKA_LIBS) $(GMP_LIBS)
if HAVE_IPC_TOOLKIT
bench_peers_queries_CPPFLAGS += -DPEERS_IPC_TOOLKIT
bench_peers_queries_LDADD += $(IPC_TOOLKIT_LIBS)
endif

bench-queries: bench/peers/queries
	@$(AM_TESTS_ENVIRONMENT) bench/peers/queries
else
bench-turning bench-queries:
	@echo 'configure has not found FCL (on Debian: libfcl-dev)'; exit 1
endif
.PHONY: bench-turning bench-queries

test_scripts += bench/peers/smoke.sh
