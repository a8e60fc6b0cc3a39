# tests/local.mk - tests whose folders need no list of their own, and what several tests share.
#
# A new test is one line: tests/FOLDER/test_X.c is the program tests/FOLDER/test_X, by the flags
# and libraries that Makefile.am gives to all of them (AM_CPPFLAGS, LDADD). What several tests
# share goes into libtests.la.

check_LTLIBRARIES += libtests.la
libtests_la_SOURCES = \
    tests/support/cases.c \
    tests/support/must.c \
    tests/support/crossing.c \
    tests/support/daemon.c \
    tests/support/data.c \
    tests/support/false_daemon.c \
    tests/support/farm.c \
    tests/support/fixture.c \
    tests/support/golden.c \
    tests/support/grid.c \
    tests/support/hog.c \
    tests/support/lingering.c \
    tests/support/play.c \
    tests/support/play_actor.c \
    tests/support/play_wild.c \
    tests/support/ply.c \
    tests/support/raw.c \
    tests/support/raw_scene.c \
    tests/support/recording.c \
    tests/support/run_ctl.c \
    tests/support/scenes.c \
    tests/support/taken.c \
    tests/support/witness.c \
    tests/unit/eng_blast.c \
    tests/unit/eng_case.c \
    tests/unit/eng_crew.c \
    tests/unit/eng_filters.c \
    tests/unit/eng_kit.c \
    tests/unit/eng_answer.c \
    tests/unit/eng_player.c \
    tests/unit/eng_stir.c \
    tests/unit/eng_way.c \
    tests/unit/thick_cases.c \
    tests/unit/turning_draw.c \
    tests/unit/turning_truth.c \
    tests/property/judge.c \
    tests/property/near_judge.c \
    tests/property/sequences.c \
    tests/property/thick_judge.c \
    tests/truth/thick_trial.c \
    tests/truth/truth_engine.c \
    tests/truth/truth_kit.c \
    tests/integration/forge.c \
    tests/fault/fault.c \
    tests/fault/keeper.c \
    tests/fault/life.c \
    tests/fuzz/fuzz_distance.c \
    tests/fuzz/fuzz_jobs.c \
    tests/fuzz/fuzz_lanes.c \
    tests/fuzz/fuzz_query.c \
    tests/fuzz/fuzz_run.c \
    tests/fuzz/fuzz_sharp.c \
    tests/fuzz/fuzz_sieve.c \
    tests/fuzz/fuzz_spans.c \
    tests/fuzz/fuzz_spans_long.c \
    tests/fuzz/fuzz_thick.c \
    tests/fuzz/fuzz_thick_lanes.c \
    tests/fuzz/fuzz_thick_make.c \
    tests/fuzz/fuzz_truth.c

test_programs += \
    tests/abi/test_abi_layout \
    tests/determinism/test_eng_anew \
    tests/determinism/test_eng_fuzz \
    tests/determinism/test_eng_golden \
    tests/determinism/test_eng_recorded \
    tests/property/test_eng_against_oracle \
    tests/property/test_eng_near_objects \
    tests/property/test_eng_near_oracle \
    tests/property/test_eng_part \
    tests/property/test_eng_per_pair \
    tests/property/test_eng_plays \
    tests/property/test_eng_rigid \
    tests/property/test_eng_standing \
    tests/property/test_eng_thick_plays \
    tests/property/test_eng_touching \
    tests/property/test_eng_turning \
    tests/property/test_eng_turning_scenes \
    tests/proto/test_proto_codec \
    tests/proto/test_proto_damage \
    tests/proto/test_proto_joints \
    tests/proto/test_proto_malformed \
    tests/proto/test_proto_memfd \
    tests/proto/test_proto_seqpacket \
    tests/truth/test_eng_thick_truth \
    tests/truth/test_eng_truth \
    tests/truth/test_oracle_truth
test_scripts += \
    tests/abi/test_abi_headers.sh \
    tests/blender/test_blender_addon.sh \
    tests/blender/test_blender_logic.sh \
    tests/cpp/test_cpp.sh \
    tests/docs/docs_commands.sh \
    tests/docs/docs_pages.sh \
    tests/docs/test_site.sh \
    tests/inspect/test_inspect_page.sh \
    tests/inspect/test_make_page.sh \
    tests/mcp/test_mcp.sh \
    tests/model/check_models.sh \
    tests/proto/test_proto_document.sh \
    tests/python/test_python_client.sh \
    tests/python/test_python_contacts.sh \
    tests/python/test_python_files.sh \
    tests/python/test_python_use.sh \
    tests/python/test_python_vtk.sh \
    tests/python/test_python_wheel.sh

include $(top_srcdir)/tests/unit/local.mk
include $(top_srcdir)/tests/integration/local.mk
include $(top_srcdir)/tests/fault/local.mk
include $(top_srcdir)/tests/fuzz/local.mk
include $(top_srcdir)/tests/zoo/local.mk
include $(top_srcdir)/tests/mpi/local.mk
include $(top_srcdir)/tests/ipc/local.mk
include $(top_srcdir)/tests/planner/local.mk
include $(top_srcdir)/tests/files/local.mk
include $(top_srcdir)/tests/dist/local.mk
include $(top_srcdir)/tests/style/local.mk
