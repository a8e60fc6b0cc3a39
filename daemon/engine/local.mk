# daemon/engine/local.mk - pure computation: meshes, hierarchies, contacts.

# The folders are one room: whoever may include one of its headers may include all.
ENGINE_CPPFLAGS = \
    -I$(top_srcdir)/daemon/engine \
    -I$(top_srcdir)/daemon/engine/elementary \
    -I$(top_srcdir)/daemon/engine/kernel \
    -I$(top_srcdir)/daemon/engine/result \
    -I$(top_srcdir)/daemon/engine/scene \
    -I$(top_srcdir)/daemon/engine/schedule \
    -I$(top_srcdir)/daemon/engine/tree \
    -I$(top_srcdir)/daemon/engine/wide

include $(top_srcdir)/daemon/engine/kernel/local.mk

noinst_LTLIBRARIES += libengine.la

libengine_la_SOURCES = \
    daemon/engine/clock.h \
    daemon/engine/elementary/batch.c \
    daemon/engine/elementary/batch.h \
    daemon/engine/elementary/closest.c \
    daemon/engine/elementary/closest.h \
    daemon/engine/elementary/direction.c \
    daemon/engine/elementary/direction.h \
    daemon/engine/elementary/exact.c \
    daemon/engine/elementary/exact.h \
    daemon/engine/elementary/exact_roots.c \
    daemon/engine/elementary/exact_roots.h \
    daemon/engine/elementary/exact_span.c \
    daemon/engine/elementary/motion.c \
    daemon/engine/elementary/motion.h \
    daemon/engine/elementary/plane.c \
    daemon/engine/elementary/plane.h \
    daemon/engine/elementary/poly.c \
    daemon/engine/elementary/poly.h \
    daemon/engine/elementary/query.h \
    daemon/engine/elementary/rebase.c \
    daemon/engine/elementary/rebase.h \
    daemon/engine/elementary/residue.c \
    daemon/engine/elementary/residue.h \
    daemon/engine/elementary/separate.c \
    daemon/engine/elementary/separate.h \
    daemon/engine/elementary/solve.c \
    daemon/engine/elementary/solve.h \
    daemon/engine/elementary/test.c \
    daemon/engine/elementary/test.h \
    daemon/engine/elementary/vec.h \
    daemon/engine/kernel/choose.c \
    daemon/engine/kernel/kernel.h \
    daemon/engine/memory.c \
    daemon/engine/memory.h \
    daemon/engine/result/answer.c \
    daemon/engine/result/answer.h \
    daemon/engine/result/bucket.c \
    daemon/engine/result/bucket.h \
    daemon/engine/result/hash.c \
    daemon/engine/result/hash.h \
    daemon/engine/result/merge.c \
    daemon/engine/result/merge.h \
    daemon/engine/result/order.c \
    daemon/engine/result/order.h \
    daemon/engine/result/pool.c \
    daemon/engine/result/pool.h \
    daemon/engine/result/radix.c \
    daemon/engine/result/radix.h \
    daemon/engine/result/result.c \
    daemon/engine/result/result.h \
    daemon/engine/result/split.c \
    daemon/engine/result/split.h \
    daemon/engine/scene/feature.c \
    daemon/engine/scene/feature.h \
    daemon/engine/scene/frames.c \
    daemon/engine/scene/frames.h \
    daemon/engine/scene/ingest.c \
    daemon/engine/scene/ingest.h \
    daemon/engine/scene/masks.c \
    daemon/engine/scene/masks.h \
    daemon/engine/scene/mesh.c \
    daemon/engine/scene/mesh.h \
    daemon/engine/scene/pairset.c \
    daemon/engine/scene/pairset.h \
    daemon/engine/scene/range.c \
    daemon/engine/scene/range.h \
    daemon/engine/scene/scene.c \
    daemon/engine/scene/scene.h \
    daemon/engine/scene/stage.c \
    daemon/engine/scene/stage.h \
    daemon/engine/scene/topology.h \
    daemon/engine/scene/world.c \
    daemon/engine/scene/world.h \
    daemon/engine/schedule/assignment.c \
    daemon/engine/schedule/assignment.h \
    daemon/engine/schedule/brief.c \
    daemon/engine/schedule/brief.h \
    daemon/engine/schedule/deque.c \
    daemon/engine/schedule/deque.h \
    daemon/engine/schedule/effort.c \
    daemon/engine/schedule/effort.h \
    daemon/engine/schedule/highlevel.c \
    daemon/engine/schedule/highlevel.h \
    daemon/engine/schedule/method.h \
    daemon/engine/schedule/method_paper.c \
    daemon/engine/schedule/place.c \
    daemon/engine/schedule/place.h \
    daemon/engine/schedule/relax.h \
    daemon/engine/schedule/schedule.h \
    daemon/engine/schedule/schedule_paper.c \
    daemon/engine/schedule/schedule_serial.c \
    daemon/engine/schedule/schedule_steal.c \
    daemon/engine/schedule/seat.c \
    daemon/engine/schedule/seat.h \
    daemon/engine/schedule/share.h \
    daemon/engine/schedule/taskunit.c \
    daemon/engine/schedule/taskunit.h \
    daemon/engine/schedule/team.h \
    daemon/engine/schedule/trace.c \
    daemon/engine/schedule/trace.h \
    daemon/engine/schedule/units.h \
    daemon/engine/schedule/wait.c \
    daemon/engine/schedule/wait.h \
    daemon/engine/schedule/worker.c \
    daemon/engine/schedule/worker.h \
    daemon/engine/status.h \
    daemon/engine/step.c \
    daemon/engine/step.h \
    daemon/engine/step_memory.c \
    daemon/engine/step_memory.h \
    daemon/engine/tree/aabb.h \
    daemon/engine/tree/aside.c \
    daemon/engine/tree/aside.h \
    daemon/engine/tree/build.c \
    daemon/engine/tree/build.h \
    daemon/engine/tree/grow.c \
    daemon/engine/tree/grow.h \
    daemon/engine/tree/levels.c \
    daemon/engine/tree/levels.h \
    daemon/engine/tree/median.c \
    daemon/engine/tree/median.h \
    daemon/engine/tree/metric.h \
    daemon/engine/tree/object.c \
    daemon/engine/tree/rebuild.c \
    daemon/engine/tree/rebuild.h \
    daemon/engine/tree/refit.c \
    daemon/engine/tree/refit.h \
    daemon/engine/tree/refit_plan.c \
    daemon/engine/tree/refit_plan.h \
    daemon/engine/tree/sah.c \
    daemon/engine/tree/sah.h \
    daemon/engine/tree/subtree.c \
    daemon/engine/tree/subtree.h \
    daemon/engine/tree/validate.c \
    daemon/engine/wide/wide.c \
    daemon/engine/wide/wide.h \
    daemon/engine/wide/wide_grid.c \
    daemon/engine/wide/wide_grid.h \
    daemon/engine/wide/wide_join.c \
    daemon/engine/wide/wide_join.h \
    daemon/engine/wide/wide_method.c \
    daemon/engine/wide/wide_narrow.c \
    daemon/engine/wide/wide_narrow.h \
    daemon/engine/wide/wide_order.c \
    daemon/engine/wide/wide_order.h \
    daemon/engine/wide/wide_owner.c \
    daemon/engine/wide/wide_owner.h \
    daemon/engine/wide/wide_pieces.c \
    daemon/engine/wide/wide_pieces.h \
    daemon/engine/wide/wide_resort.c \
    daemon/engine/wide/wide_resort.h \
    daemon/engine/wide/wide_refit.c \
    daemon/engine/wide/wide_sweep.c \
    daemon/engine/wide/wide_sweep.h \
    daemon/engine/wide/wide_team.c \
    daemon/engine/wide/wide_team.h \
    daemon/engine/wide/wide_test.c \
    daemon/engine/wide/wide_test.h
libengine_la_CPPFLAGS = $(AM_CPPFLAGS) $(ENGINE_CPPFLAGS)
libengine_la_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS) $(XXHASH_CFLAGS)
# libtool hands -fopenmp on to whatever links this library.
libengine_la_LDFLAGS = $(OPENMP_CFLAGS)
libengine_la_LIBADD = $(kernel_libraries) $(XXHASH_LIBS) $(GMP_LIBS) $(LIBM)

EXTRA_DIST += daemon/engine/README.md daemon/engine/elementary/BOUNDS.md
