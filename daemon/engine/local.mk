# daemon/engine/local.mk - pure computation: meshes, hierarchies, contacts.

noinst_LTLIBRARIES += libengine.la

libengine_la_SOURCES = \
    daemon/engine/aabb.h \
    daemon/engine/answer.c \
    daemon/engine/answer.h \
    daemon/engine/assignment.c \
    daemon/engine/assignment.h \
    daemon/engine/build.c \
    daemon/engine/build.h \
    daemon/engine/clock.h \
    daemon/engine/closest.c \
    daemon/engine/closest.h \
    daemon/engine/deque.c \
    daemon/engine/deque.h \
    daemon/engine/direction.c \
    daemon/engine/direction.h \
    daemon/engine/exact.c \
    daemon/engine/exact.h \
    daemon/engine/exact_span.c \
    daemon/engine/feature.c \
    daemon/engine/feature.h \
    daemon/engine/filter.c \
    daemon/engine/filter.h \
    daemon/engine/ingest.c \
    daemon/engine/ingest.h \
    daemon/engine/median.c \
    daemon/engine/median.h \
    daemon/engine/memory.c \
    daemon/engine/memory.h \
    daemon/engine/mesh.c \
    daemon/engine/mesh.h \
    daemon/engine/motion.c \
    daemon/engine/motion.h \
    daemon/engine/poly.c \
    daemon/engine/poly.h \
    daemon/engine/pool.c \
    daemon/engine/pool.h \
    daemon/engine/query.h \
    daemon/engine/radix.c \
    daemon/engine/radix.h \
    daemon/engine/range.c \
    daemon/engine/range.h \
    daemon/engine/rebase.c \
    daemon/engine/rebase.h \
    daemon/engine/refit.c \
    daemon/engine/refit.h \
    daemon/engine/result.c \
    daemon/engine/result.h \
    daemon/engine/scene.c \
    daemon/engine/scene.h \
    daemon/engine/schedule.h \
    daemon/engine/schedule_paper.c \
    daemon/engine/schedule_serial.c \
    daemon/engine/schedule_steal.c \
    daemon/engine/solve.c \
    daemon/engine/solve.h \
    daemon/engine/stage.c \
    daemon/engine/stage.h \
    daemon/engine/status.h \
    daemon/engine/step.c \
    daemon/engine/step.h \
    daemon/engine/step_memory.c \
    daemon/engine/step_memory.h \
    daemon/engine/taskunit.c \
    daemon/engine/taskunit.h \
    daemon/engine/team.h \
    daemon/engine/test.c \
    daemon/engine/test.h \
    daemon/engine/topology.h \
    daemon/engine/vec.h \
    daemon/engine/worker.c \
    daemon/engine/worker.h \
    daemon/engine/world.c \
    daemon/engine/world.h
libengine_la_CPPFLAGS = $(AM_CPPFLAGS) -I$(top_srcdir)/daemon/engine
libengine_la_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS) $(XXHASH_CFLAGS)
# libtool hands -fopenmp on to whatever links this library.
libengine_la_LDFLAGS = $(OPENMP_CFLAGS)
libengine_la_LIBADD = $(XXHASH_LIBS) $(GMP_LIBS) $(LIBM)

EXTRA_DIST += daemon/engine/BOUNDS.md
