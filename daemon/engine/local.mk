# daemon/engine/local.mk - pure computation: meshes, hierarchies, contacts.

# The folders are one room: whoever may include one of its headers may include all.
ENGINE_CPPFLAGS = \
    -iquote $(top_srcdir)/daemon/engine \
    -iquote $(top_srcdir)/daemon/engine/base \
    -iquote $(top_srcdir)/daemon/engine/kernel \
    -iquote $(top_srcdir)/daemon/engine/elementary \
    -iquote $(top_srcdir)/daemon/engine/result \
    -iquote $(top_srcdir)/daemon/engine/team \
    -iquote $(top_srcdir)/daemon/engine/scene \
    -iquote $(top_srcdir)/daemon/engine/turning \
    -iquote $(top_srcdir)/daemon/engine/narrow \
    -iquote $(top_srcdir)/daemon/engine/near \
    -iquote $(top_srcdir)/daemon/engine/paper \
    -iquote $(top_srcdir)/daemon/engine/wide

include $(top_srcdir)/daemon/engine/kernel/local.mk

noinst_LTLIBRARIES += libengine.la

libengine_la_SOURCES = \
    daemon/engine/base/array.c \
    daemon/engine/base/sort.c \
    daemon/engine/base/memory.c \
    daemon/engine/base/question.c \
    daemon/engine/kernel/choose.c \
    daemon/engine/elementary/batch.c \
    daemon/engine/elementary/distance.c \
    daemon/engine/elementary/distance_order.c \
    daemon/engine/elementary/distance_rule.c \
    daemon/engine/elementary/divisor.c \
    daemon/engine/elementary/exact.c \
    daemon/engine/elementary/exact_memory.c \
    daemon/engine/elementary/exact_roots.c \
    daemon/engine/elementary/exact_signs.c \
    daemon/engine/elementary/exact_span.c \
    daemon/engine/elementary/isolate.c \
    daemon/engine/elementary/motion.c \
    daemon/engine/elementary/number.c \
    daemon/engine/elementary/plane.c \
    daemon/engine/elementary/poly.c \
    daemon/engine/elementary/residue.c \
    daemon/engine/elementary/root_sign.c \
    daemon/engine/elementary/solve.c \
    daemon/engine/elementary/thick.c \
    daemon/engine/elementary/thick_exact.c \
    daemon/engine/elementary/thick_roots.c \
    daemon/engine/elementary/touching.c \
    daemon/engine/elementary/winding.c \
    daemon/engine/result/bucket.c \
    daemon/engine/result/found.c \
    daemon/engine/result/merge.c \
    daemon/engine/result/order.c \
    daemon/engine/result/per_pair.c \
    daemon/engine/team/deque.c \
    daemon/engine/team/affinity.c \
    daemon/engine/team/parallel.c \
    daemon/engine/team/schedule_steal.c \
    daemon/engine/team/trace.c \
    daemon/engine/team/wait.c \
    daemon/engine/team/worker.c \
    daemon/engine/scene/feature.c \
    daemon/engine/scene/box_frames.c \
    daemon/engine/scene/ingest.c \
    daemon/engine/scene/masks.c \
    daemon/engine/scene/mesh_fill.c \
    daemon/engine/scene/moving.c \
    daemon/engine/scene/objects.c \
    daemon/engine/scene/rigid.c \
    daemon/engine/scene/rings.c \
    daemon/engine/scene/stars.c \
    daemon/engine/scene/stage.c \
    daemon/engine/scene/thickness.c \
    daemon/engine/scene/world.c \
    daemon/engine/paper/background.c \
    daemon/engine/paper/assignment.c \
    daemon/engine/paper/build.c \
    daemon/engine/paper/grow.c \
    daemon/engine/paper/paper.c \
    daemon/engine/paper/paper_method.c \
    daemon/engine/paper/paper_work.c \
    daemon/engine/paper/rebuild.c \
    daemon/engine/paper/refit.c \
    daemon/engine/paper/schedule_paper.c \
    daemon/engine/paper/taskunit.c \
    daemon/engine/paper/paper_test.c \
    daemon/engine/paper/trees.c \
    daemon/engine/wide/wide.c \
    daemon/engine/wide/wide_crowded.c \
    daemon/engine/wide/wide_leaves.c \
    daemon/engine/wide/wide_join.c \
    daemon/engine/wide/wide_leads.c \
    daemon/engine/wide/wide_sort.c \
    daemon/engine/wide/wide_method.c \
    daemon/engine/wide/wide_cells.c \
    daemon/engine/wide/wide_order.c \
    daemon/engine/wide/wide_owner.c \
    daemon/engine/wide/wide_refit.c \
    daemon/engine/wide/wide_resort.c \
    daemon/engine/wide/wide_state.c \
    daemon/engine/wide/wide_still.c \
    daemon/engine/wide/wide_team.c \
    daemon/engine/wide/wide_test.c \
    daemon/engine/turning/body_tree.c \
    daemon/engine/turning/decide_turning.c \
    daemon/engine/turning/joints.c \
    daemon/engine/turning/pace.c \
    daemon/engine/turning/path.c \
    daemon/engine/turning/path_make.c \
    daemon/engine/turning/poses.c \
    daemon/engine/turning/rotation.c \
    daemon/engine/turning/stage_turning.c \
    daemon/engine/turning/sweep_sets.c \
    daemon/engine/turning/turning.c \
    daemon/engine/turning/turning_step.c \
    daemon/engine/answer.c \
    daemon/engine/bodies.c \
    daemon/engine/detect.c \
    daemon/engine/near.c \
    daemon/engine/narrow/closest_features.c \
    daemon/engine/narrow/narrow.c \
    daemon/engine/narrow/narrow_near.c \
    daemon/engine/narrow/narrow_thick.c \
    daemon/engine/narrow/narrow_touching.c \
    daemon/engine/near/near_best.c \
    daemon/engine/near/near_objects.c \
    daemon/engine/near/near_search.c \
    daemon/engine/effort.c \
    daemon/engine/answer_cache.c \
    daemon/engine/levels.c \
    daemon/engine/methods.c \
    daemon/engine/step.c \
    daemon/engine/step_memory.c
libengine_la_CPPFLAGS = $(PCCD_CPPFLAGS) $(ENGINE_CPPFLAGS)
libengine_la_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS) $(XXHASH_CFLAGS)
# libtool hands -fopenmp on to whatever links this library.
libengine_la_LDFLAGS = $(OPENMP_CFLAGS)
libengine_la_LIBADD = $(kernel_libraries) $(GMP_LIBS) $(LIBM)
libengine_la_DEPENDENCIES = $(kernel_libraries)
