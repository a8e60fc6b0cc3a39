# tests/integration/local.mk - a real daemon and real clients; our programs, from outside.

test_programs += \
    tests/integration/test_int_allow \
    tests/integration/test_int_autostart \
    tests/integration/test_int_backlog \
    tests/integration/test_int_batch \
    tests/integration/test_int_boxes \
    tests/integration/test_int_brief \
    tests/integration/test_int_broken \
    tests/integration/test_int_choice \
    tests/integration/test_int_contract \
    tests/integration/test_int_crossed \
    tests/integration/test_int_deadline \
    tests/integration/test_int_death \
    tests/integration/test_int_direct \
    tests/integration/test_int_expected \
    tests/integration/test_int_filter \
    tests/integration/test_int_flow \
    tests/integration/test_int_free \
    tests/integration/test_int_hostile \
    tests/integration/test_int_journal \
    tests/integration/test_int_long \
    tests/integration/test_int_loss \
    tests/integration/test_int_misuse \
    tests/integration/test_int_motions \
    tests/integration/test_int_near \
    tests/integration/test_int_near_long \
    tests/integration/test_int_notify \
    tests/integration/test_int_observe \
    tests/integration/test_int_overdue \
    tests/integration/test_int_owner \
    tests/integration/test_int_peer \
    tests/integration/test_int_protocol \
    tests/integration/test_int_quota \
    tests/integration/test_int_reconnect \
    tests/integration/test_int_record \
    tests/integration/test_int_record_filter \
    tests/integration/test_int_record_shared \
    tests/integration/test_int_refused \
    tests/integration/test_int_replace \
    tests/integration/test_int_reply \
    tests/integration/test_int_restore \
    tests/integration/test_int_resume \
    tests/integration/test_int_rivals \
    tests/integration/test_int_room \
    tests/integration/test_int_rounding \
    tests/integration/test_int_sandbox \
    tests/integration/test_int_session \
    tests/integration/test_int_shared \
    tests/integration/test_int_slot \
    tests/integration/test_int_socketfile \
    tests/integration/test_int_standing \
    tests/integration/test_int_step \
    tests/integration/test_int_supervise \
    tests/integration/test_int_taken \
    tests/integration/test_int_thick \
    tests/integration/test_int_threads \
    tests/integration/test_int_verify \
    tests/integration/test_int_verify_fields \
    tests/integration/test_int_turning \
    tests/integration/test_int_verify_near \
    tests/integration/test_int_verify_turning \
    tests/integration/test_int_version \
    tests/integration/test_int_warm \
    tests/integration/test_int_watch
# direct_check.sh runs the programs that need no daemon once more without one.
test_scripts += \
    tests/integration/unit_check.sh \
    tests/integration/ctl_check.sh \
    tests/integration/ctl_observe.sh \
    tests/integration/ctl_operate.sh \
    tests/integration/load_check.sh \
    tests/integration/ctl_files.sh \
    tests/integration/ctl_record.sh \
    tests/integration/ctl_near.sh \
    tests/integration/ctl_sweep.sh \
    tests/integration/ctl_see.sh \
    tests/integration/ctl_judge.sh \
    tests/integration/ctl_scene.sh \
    tests/integration/ctl_sequence.sh \
    tests/integration/ctl_objects.sh \
    tests/integration/direct_check.sh \
    tests/integration/libuv_check.sh

tests_integration_test_int_direct_SOURCES = tests/integration/test_int_direct.c \
    tests/support/allocations.c
tests_integration_test_int_warm_SOURCES = tests/integration/test_int_warm.c \
    tests/support/allocations.c
