# tests/unit/local.mk - one part of a room each.

test_programs += \
    tests/unit/test_cli_turning \
    tests/unit/test_cli_points \
    tests/unit/test_cli_weld \
    tests/unit/test_ctl_cloth \
    tests/unit/test_ctl_gltf \
    tests/unit/test_ctl_inspect \
    tests/unit/test_ctl_malformed \
    tests/unit/test_ctl_meshfile \
    tests/unit/test_ctl_output \
    tests/unit/test_ctl_parts \
    tests/unit/test_ctl_point_cache \
    tests/unit/test_ctl_polygon \
    tests/unit/test_ctl_stl_glb \
    tests/unit/test_ctl_trace \
    tests/unit/test_ctl_weld \
    tests/unit/test_ctl_writers \
    tests/unit/test_eng_aabb \
    tests/unit/test_eng_affinity \
    tests/unit/test_eng_background \
    tests/unit/test_eng_batch \
    tests/unit/test_eng_rounding \
    tests/unit/test_eng_boxes \
    tests/unit/test_eng_brief \
    tests/unit/test_eng_build \
    tests/unit/test_eng_decide \
    tests/unit/test_eng_deque \
    tests/unit/test_eng_effort \
    tests/unit/test_eng_exact \
    tests/unit/test_eng_fault \
    tests/unit/test_eng_filter \
    tests/unit/test_eng_footprint \
    tests/unit/test_eng_foreign \
    tests/unit/test_eng_frames \
    tests/unit/test_eng_free \
    tests/unit/test_eng_grow \
    tests/unit/test_eng_hash \
    tests/unit/test_eng_kernel \
    tests/unit/test_eng_lend \
    tests/unit/test_eng_masks \
    tests/unit/test_eng_memory \
    tests/unit/test_eng_merge \
    tests/unit/test_eng_mesh \
    tests/unit/test_eng_near \
    tests/unit/test_eng_near_depth \
    tests/unit/test_eng_near_nearest \
    tests/unit/test_eng_nearest \
    tests/unit/test_eng_order \
    tests/unit/test_eng_parts \
    tests/unit/test_eng_pairset \
    tests/unit/test_eng_path \
    tests/unit/test_eng_plane \
    tests/unit/test_eng_quantised \
    tests/unit/test_eng_range \
    tests/unit/test_eng_rebuild \
    tests/unit/test_eng_record \
    tests/unit/test_eng_refit \
    tests/unit/test_eng_refit_plan \
    tests/unit/test_eng_replace \
    tests/unit/test_eng_resort \
    tests/unit/test_eng_rounds \
    tests/unit/test_eng_sieve \
    tests/unit/test_eng_sieve_near \
    tests/unit/test_eng_sieve_thick \
    tests/unit/test_eng_solve \
    tests/unit/test_eng_crowded \
    tests/unit/test_eng_stage \
    tests/unit/test_eng_step \
    tests/unit/test_eng_still \
    tests/unit/test_eng_sweep \
    tests/unit/test_eng_team \
    tests/unit/test_eng_teleport \
    tests/unit/test_eng_thick \
    tests/unit/test_eng_thick_step \
    tests/unit/test_eng_touching \
    tests/unit/test_eng_trace \
    tests/unit/test_eng_turning \
    tests/unit/test_eng_turning_step \
    tests/unit/test_eng_warm \
    tests/unit/test_eng_wide \
    tests/unit/test_load_judge \
    tests/unit/test_load_pace \
    tests/unit/test_oracle \
    tests/unit/test_oracle_distance \
    tests/unit/test_oracle_thick \
    tests/unit/test_oracle_turning \
    tests/unit/test_rank_moving \
    tests/unit/test_rank_sort \
    tests/unit/test_rec_format \
    tests/unit/test_reg_registry \
    tests/unit/test_srv_compute \
    tests/unit/test_srv_fairqueue \
    tests/unit/test_srv_handles \
    tests/unit/test_srv_log \
    tests/unit/test_srv_outlet \
    tests/unit/test_srv_quota \
    tests/unit/test_srv_region \
    tests/unit/test_srv_runners \
    tests/unit/test_srv_sandbox \
    tests/unit/test_tool_shown \
    tests/unit/test_tool_whole_file
test_scripts += \
    tests/unit/test_eng_margins.sh \
    tests/unit/test_eng_neon.sh \
    tests/unit/test_eng_sets.sh \
    tests/unit/test_eng_sine.sh
# What test_eng_neon.sh and test_eng_sets.sh run for a set.
check_PROGRAMS += tests/unit/kernel_digest

# Their own eng_alloc comes first, so the library's memory.o is not linked.
tests_unit_test_eng_path_SOURCES = tests/unit/test_eng_path.c tests/unit/eng_turns.c
tests_unit_test_eng_sweep_SOURCES = tests/unit/test_eng_sweep.c tests/unit/eng_turns.c
tests_unit_test_eng_turning_SOURCES = tests/unit/test_eng_turning.c tests/unit/eng_turns.c
tests_unit_test_eng_fault_SOURCES = tests/unit/test_eng_fault.c tests/unit/eng_scarce.c

# Rooms whose headers have names of the engine's.
rank_test_cppflags = -iquote $(top_srcdir)/client/mpi $(AM_CPPFLAGS)
tests_unit_test_rank_moving_CPPFLAGS = $(rank_test_cppflags)
tests_unit_test_rank_sort_CPPFLAGS = $(rank_test_cppflags)
tests_unit_test_rank_sort_SOURCES = tests/unit/test_rank_sort.c client/mpi/rank_sort.c
tests_unit_test_load_judge_CPPFLAGS = $(load_cppflags) $(AM_CPPFLAGS)
tests_unit_test_load_judge_LDADD = libload.la $(LDADD)
tests_unit_test_load_pace_CPPFLAGS = $(load_cppflags) $(AM_CPPFLAGS)
tests_unit_test_load_pace_LDADD = libload.la $(LDADD)

# pccdctl's.
ctl_test_cppflags = $(ctl_cppflags) $(AM_CPPFLAGS) $(PNG_CFLAGS)
ctl_test_libs = libctlkit.la libctl.la $(LDADD) $(PNG_LIBS)
check_LTLIBRARIES += libctlkit.la
libctlkit_la_SOURCES = tests/unit/ctl_kit.c
libctlkit_la_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_cloth_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_cloth_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_gltf_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_gltf_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_inspect_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_inspect_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_malformed_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_malformed_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_meshfile_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_meshfile_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_output_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_output_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_parts_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_parts_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_point_cache_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_point_cache_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_polygon_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_polygon_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_stl_glb_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_stl_glb_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_trace_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_trace_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_weld_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_weld_LDADD = $(ctl_test_libs)
tests_unit_test_ctl_writers_CPPFLAGS = $(ctl_test_cppflags)
tests_unit_test_ctl_writers_LDADD = $(ctl_test_libs)

# The daemon's, without a socket.
server_test_cppflags = $(server_cppflags) $(AM_CPPFLAGS) $(UV_CFLAGS)
server_test_libs = libserver.la $(LDADD) $(UV_LIBS)
tests_unit_test_srv_compute_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_compute_LDADD = $(server_test_libs)
tests_unit_test_srv_fairqueue_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_fairqueue_LDADD = $(server_test_libs)
tests_unit_test_srv_handles_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_handles_LDADD = $(server_test_libs)
tests_unit_test_srv_log_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_log_LDADD = $(server_test_libs)
tests_unit_test_srv_outlet_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_outlet_LDADD = $(server_test_libs)
tests_unit_test_srv_quota_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_quota_LDADD = $(server_test_libs)
tests_unit_test_srv_region_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_region_LDADD = $(server_test_libs)
tests_unit_test_srv_runners_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_runners_LDADD = $(server_test_libs)
tests_unit_test_srv_sandbox_CPPFLAGS = $(server_test_cppflags)
tests_unit_test_srv_sandbox_LDADD = $(server_test_libs)
