# tests/unit/engine.mk - the parts of the engine, one program a part.

ENG_TEST_CPPFLAGS = $(AM_CPPFLAGS) $(ENGINE_CPPFLAGS) \
    -I$(top_srcdir)/tests/unit -I$(top_srcdir)/tests/support $(XXHASH_CFLAGS) \
    $(CMOCKA_CFLAGS)
ENG_TEST_LDADD = libengkit.la libengine.la $(CMOCKA_LIBS) $(GMP_LIBS) $(LIBM)

check_LTLIBRARIES += libengkit.la
libengkit_la_SOURCES = \
    tests/unit/eng_blast.c \
    tests/unit/eng_case.c \
    tests/unit/eng_crew.c \
    tests/unit/eng_filters.c \
    tests/unit/eng_fresh.c \
    tests/unit/eng_kit.c \
    tests/unit/eng_near.c \
    tests/unit/eng_player.c \
    tests/unit/eng_stir.c \
    tests/unit/eng_way.c \
    tests/unit/near_kit.c
libengkit_la_CPPFLAGS = $(ENG_TEST_CPPFLAGS) -I$(top_srcdir)/tests/support

ENG_TESTS = \
    tests/unit/test_eng_memory \
    tests/unit/test_eng_range \
    tests/unit/test_eng_radix \
    tests/unit/test_eng_mesh \
    tests/unit/test_eng_aabb \
    tests/unit/test_eng_build \
    tests/unit/test_eng_foreign \
    tests/unit/test_eng_frames \
    tests/unit/test_eng_free \
    tests/unit/test_eng_refit \
    tests/unit/test_eng_rebuild \
    tests/unit/test_eng_grow \
    tests/unit/test_eng_background \
    tests/unit/test_eng_stage \
    tests/unit/test_eng_still \
    tests/unit/test_eng_filter \
    tests/unit/test_eng_sieve \
    tests/unit/test_eng_sieve_near \
    tests/unit/test_eng_sieve_thick \
    tests/unit/test_eng_exact \
    tests/unit/test_eng_nearest \
    tests/unit/test_eng_plane \
    tests/unit/test_eng_separate \
    tests/unit/test_eng_solve \
    tests/unit/test_eng_thick \
    tests/unit/test_eng_thick_step \
    tests/unit/test_eng_batch \
    tests/unit/test_eng_hash \
    tests/unit/test_eng_kernel \
    tests/unit/test_eng_result \
    tests/unit/test_eng_merge \
    tests/unit/test_eng_step \
    tests/unit/test_eng_teleport \
    tests/unit/test_eng_warm \
    tests/unit/test_eng_fault \
    tests/unit/test_eng_fault_team \
    tests/unit/test_eng_replace \
    tests/unit/test_eng_deque \
    tests/unit/test_eng_divisor \
    tests/unit/test_eng_ids \
    tests/unit/test_eng_team \
    tests/unit/test_eng_record \
    tests/unit/test_eng_trace \
    tests/unit/test_eng_subtree \
    tests/unit/test_eng_brief \
    tests/unit/test_eng_effort \
    tests/unit/test_eng_affinity \
    tests/unit/test_eng_refit_plan \
    tests/unit/test_eng_boxes \
    tests/unit/test_eng_rounds \
    tests/unit/test_eng_quantised \
    tests/unit/test_eng_order \
    tests/unit/test_eng_resort \
    tests/unit/test_eng_wide \
    tests/unit/test_eng_footprint \
    tests/unit/test_eng_lend \
    tests/unit/test_eng_masks \
    tests/unit/test_eng_pairset \
    tests/unit/test_eng_rounding \
    tests/unit/test_eng_near \
    tests/unit/test_eng_near_depth \
    tests/unit/test_eng_near_nearest \
    tests/unit/test_eng_crowded
check_PROGRAMS += $(ENG_TESTS)
TESTS += $(ENG_TESTS)

tests_unit_test_eng_masks_SOURCES = tests/unit/test_eng_masks.c
tests_unit_test_eng_masks_CPPFLAGS = $(ENG_TEST_CPPFLAGS) -I$(top_srcdir)/tests/support
tests_unit_test_eng_masks_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_rounding_SOURCES = tests/unit/test_eng_rounding.c
tests_unit_test_eng_rounding_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_rounding_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_crowded_SOURCES = tests/unit/test_eng_crowded.c
tests_unit_test_eng_crowded_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_crowded_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_near_SOURCES = tests/unit/test_eng_near.c
tests_unit_test_eng_near_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_near_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_near_depth_SOURCES = tests/unit/test_eng_near_depth.c
tests_unit_test_eng_near_depth_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_near_depth_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_near_nearest_SOURCES = tests/unit/test_eng_near_nearest.c
tests_unit_test_eng_near_nearest_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_near_nearest_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_pairset_SOURCES = tests/unit/test_eng_pairset.c
tests_unit_test_eng_pairset_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_pairset_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_nearest_SOURCES = tests/unit/test_eng_nearest.c
tests_unit_test_eng_nearest_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_nearest_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_memory_SOURCES = tests/unit/test_eng_memory.c
tests_unit_test_eng_memory_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_memory_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_range_SOURCES = tests/unit/test_eng_range.c
tests_unit_test_eng_range_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_range_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_radix_SOURCES = tests/unit/test_eng_radix.c
tests_unit_test_eng_radix_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_radix_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_mesh_SOURCES = tests/unit/test_eng_mesh.c
tests_unit_test_eng_mesh_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_mesh_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_aabb_SOURCES = tests/unit/test_eng_aabb.c
tests_unit_test_eng_aabb_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_aabb_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_build_SOURCES = tests/unit/test_eng_build.c
tests_unit_test_eng_build_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_build_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_frames_SOURCES = tests/unit/test_eng_frames.c
tests_unit_test_eng_frames_CPPFLAGS = $(ENG_TEST_CPPFLAGS) -I$(top_srcdir)/tests/support
tests_unit_test_eng_frames_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_refit_SOURCES = tests/unit/test_eng_refit.c
tests_unit_test_eng_refit_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_refit_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_rebuild_SOURCES = tests/unit/test_eng_rebuild.c
tests_unit_test_eng_rebuild_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_rebuild_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_grow_SOURCES = tests/unit/test_eng_grow.c
tests_unit_test_eng_grow_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_grow_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_background_SOURCES = tests/unit/test_eng_background.c
tests_unit_test_eng_background_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_background_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_stage_SOURCES = tests/unit/test_eng_stage.c
tests_unit_test_eng_stage_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_stage_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_foreign_SOURCES = tests/unit/test_eng_foreign.c
tests_unit_test_eng_foreign_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_foreign_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_still_SOURCES = tests/unit/test_eng_still.c
tests_unit_test_eng_still_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_still_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_filter_SOURCES = tests/unit/test_eng_filter.c
tests_unit_test_eng_filter_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_filter_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_sieve_SOURCES = tests/unit/test_eng_sieve.c
tests_unit_test_eng_sieve_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_sieve_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_sieve_near_SOURCES = tests/unit/test_eng_sieve_near.c
tests_unit_test_eng_sieve_near_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_sieve_near_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_sieve_thick_SOURCES = tests/unit/test_eng_sieve_thick.c
tests_unit_test_eng_sieve_thick_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_sieve_thick_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_exact_SOURCES = tests/unit/test_eng_exact.c
tests_unit_test_eng_exact_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_exact_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_separate_SOURCES = tests/unit/test_eng_separate.c
tests_unit_test_eng_separate_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_separate_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_thick_SOURCES = tests/unit/test_eng_thick.c \
    tests/unit/thick_cases.c
tests_unit_test_eng_thick_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_thick_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_free_SOURCES = tests/unit/test_eng_free.c
tests_unit_test_eng_free_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_free_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_divisor_SOURCES = tests/unit/test_eng_divisor.c
tests_unit_test_eng_divisor_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_divisor_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_ids_SOURCES = tests/unit/test_eng_ids.c
tests_unit_test_eng_ids_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_ids_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_thick_step_SOURCES = tests/unit/test_eng_thick_step.c
tests_unit_test_eng_thick_step_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_thick_step_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_solve_SOURCES = tests/unit/test_eng_solve.c
tests_unit_test_eng_solve_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_solve_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_kernel_SOURCES = tests/unit/test_eng_kernel.c
tests_unit_test_eng_kernel_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_kernel_LDADD = $(ENG_TEST_LDADD)
tests_unit_test_eng_batch_SOURCES = tests/unit/test_eng_batch.c
tests_unit_test_eng_batch_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_batch_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_plane_SOURCES = tests/unit/test_eng_plane.c
tests_unit_test_eng_plane_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_plane_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_hash_SOURCES = tests/unit/test_eng_hash.c
tests_unit_test_eng_hash_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_hash_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_result_SOURCES = tests/unit/test_eng_result.c
tests_unit_test_eng_result_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_result_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_merge_SOURCES = tests/unit/test_eng_merge.c
tests_unit_test_eng_merge_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_merge_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_step_SOURCES = tests/unit/test_eng_step.c
tests_unit_test_eng_step_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_step_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_teleport_SOURCES = tests/unit/test_eng_teleport.c
tests_unit_test_eng_teleport_CPPFLAGS = $(ENG_TEST_CPPFLAGS) -I$(top_srcdir)/tests/support
tests_unit_test_eng_teleport_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_warm_SOURCES = tests/unit/test_eng_warm.c
tests_unit_test_eng_warm_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_warm_LDADD = $(ENG_TEST_LDADD)

# Their own eng_alloc comes first, so the library's memory.o is not linked.
tests_unit_test_eng_fault_SOURCES = \
    tests/unit/eng_scarce.c \
    tests/unit/test_eng_fault.c
tests_unit_test_eng_fault_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_fault_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_fault_team_SOURCES = \
    tests/unit/eng_scarce.c \
    tests/unit/test_eng_fault_team.c
tests_unit_test_eng_fault_team_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_fault_team_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_replace_SOURCES = tests/unit/test_eng_replace.c
tests_unit_test_eng_replace_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_replace_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_deque_SOURCES = tests/unit/test_eng_deque.c
tests_unit_test_eng_deque_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_deque_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_team_SOURCES = tests/unit/test_eng_team.c
tests_unit_test_eng_team_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_team_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_record_SOURCES = tests/unit/test_eng_record.c
tests_unit_test_eng_record_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_record_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_trace_SOURCES = tests/unit/test_eng_trace.c
tests_unit_test_eng_trace_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_trace_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_refit_plan_SOURCES = tests/unit/test_eng_refit_plan.c
tests_unit_test_eng_refit_plan_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_refit_plan_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_subtree_SOURCES = tests/unit/test_eng_subtree.c
tests_unit_test_eng_subtree_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_subtree_LDADD = $(ENG_TEST_LDADD)

# It opens regions of its own.
tests_unit_test_eng_affinity_SOURCES = tests/unit/test_eng_affinity.c
tests_unit_test_eng_affinity_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_affinity_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS)
tests_unit_test_eng_affinity_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_brief_SOURCES = tests/unit/test_eng_brief.c
tests_unit_test_eng_brief_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_brief_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_effort_SOURCES = tests/unit/test_eng_effort.c
tests_unit_test_eng_effort_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_effort_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_quantised_SOURCES = tests/unit/test_eng_quantised.c
tests_unit_test_eng_quantised_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_quantised_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_rounds_SOURCES = tests/unit/test_eng_rounds.c
tests_unit_test_eng_rounds_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_rounds_LDADD = $(ENG_TEST_LDADD)
tests_unit_test_eng_boxes_SOURCES = tests/unit/test_eng_boxes.c
tests_unit_test_eng_boxes_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_boxes_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_order_SOURCES = tests/unit/test_eng_order.c
tests_unit_test_eng_order_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_order_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_resort_SOURCES = tests/unit/test_eng_resort.c
tests_unit_test_eng_resort_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_resort_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_lend_SOURCES = tests/unit/test_eng_lend.c
tests_unit_test_eng_lend_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_lend_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_footprint_SOURCES = tests/unit/test_eng_footprint.c
tests_unit_test_eng_footprint_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_footprint_LDADD = $(ENG_TEST_LDADD)

tests_unit_test_eng_wide_SOURCES = tests/unit/test_eng_wide.c
tests_unit_test_eng_wide_CPPFLAGS = $(ENG_TEST_CPPFLAGS)
tests_unit_test_eng_wide_LDADD = $(ENG_TEST_LDADD)

# The kernels once more for another processor, where a compiler for it is.
check_PROGRAMS += tests/unit/kernel_digest
TESTS += tests/unit/test_eng_neon.sh tests/unit/test_eng_sets.sh
tests_unit_kernel_digest_SOURCES = tests/unit/kernel_digest.c
tests_unit_kernel_digest_CPPFLAGS = $(ENG_TEST_CPPFLAGS) -I$(top_srcdir)/tests/support
tests_unit_kernel_digest_LDADD = libengine.la $(LIBM)
