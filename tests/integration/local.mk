# tests/integration/local.mk - a real daemon and real clients.

integration_names = \
    tests/integration/test_int_backlog \
    tests/integration/test_int_batch \
    tests/integration/test_int_allow \
    tests/integration/test_int_autostart \
    tests/integration/test_int_boxes \
    tests/integration/test_int_brief \
    tests/integration/test_int_broken \
    tests/integration/test_int_choice \
    tests/integration/test_int_contract \
    tests/integration/test_int_cut \
    tests/integration/test_int_deadline \
    tests/integration/test_int_death \
    tests/integration/test_int_direct \
    tests/integration/test_int_expected \
    tests/integration/test_int_filter \
    tests/integration/test_int_flow \
    tests/integration/test_int_free \
    tests/integration/test_int_hostile \
    tests/integration/test_int_journal \
    tests/integration/test_int_leave \
    tests/integration/test_int_long \
    tests/integration/test_int_loss \
    tests/integration/test_int_misuse \
    tests/integration/test_int_null \
    tests/integration/test_int_motions \
    tests/integration/test_int_near \
    tests/integration/test_int_near_long \
    tests/integration/test_int_notify \
    tests/integration/test_int_orphan \
    tests/integration/test_int_observe \
    tests/integration/test_int_overdue \
    tests/integration/test_int_owner \
    tests/integration/test_int_peer \
    tests/integration/test_int_protocol \
    tests/integration/test_int_quota \
    tests/integration/test_int_taken \
    tests/integration/test_int_record \
    tests/integration/test_int_record_filter \
    tests/integration/test_int_record_shared \
    tests/integration/test_int_refused \
    tests/integration/test_int_replace \
    tests/integration/test_int_reconnect \
    tests/integration/test_int_restore \
    tests/integration/test_int_reply \
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
    tests/integration/test_int_crossed \
    tests/integration/test_int_thick \
    tests/integration/test_int_threads \
    tests/integration/test_int_verify \
    tests/integration/test_int_verify_fields \
    tests/integration/test_int_verify_near \
    tests/integration/test_int_version \
    tests/integration/test_int_warm \
    tests/integration/test_int_watch
check_PROGRAMS += $(integration_names)
TESTS += $(integration_names)

integration_cppflags = $(AM_CPPFLAGS) -I$(top_srcdir)/proto -I$(top_srcdir)/client/lib \
    -I$(top_srcdir)/tests/support $(CMOCKA_CFLAGS)
integration_libs = libtestdaemon.la libpccd.la libproto.la $(CMOCKA_LIBS) -lm

tests_integration_test_int_standing_SOURCES = tests/integration/test_int_standing.c
tests_integration_test_int_standing_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_standing_LDADD = $(integration_libs)

tests_integration_test_int_socketfile_SOURCES = tests/integration/test_int_socketfile.c
tests_integration_test_int_socketfile_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_socketfile_LDADD = $(integration_libs)

tests_integration_test_int_near_SOURCES = tests/integration/test_int_near.c
tests_integration_test_int_near_CPPFLAGS = $(integration_cppflags) $(XXHASH_CFLAGS)
tests_integration_test_int_near_LDADD = $(integration_libs)

tests_integration_test_int_near_long_SOURCES = tests/integration/test_int_near_long.c
tests_integration_test_int_near_long_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_near_long_LDADD = $(integration_libs)

tests_integration_test_int_refused_SOURCES = tests/integration/test_int_refused.c
tests_integration_test_int_refused_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_refused_LDADD = $(integration_libs)

tests_integration_test_int_owner_SOURCES = tests/integration/test_int_owner.c
tests_integration_test_int_owner_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_owner_LDADD = $(integration_libs)

tests_integration_test_int_allow_SOURCES = tests/integration/test_int_allow.c
tests_integration_test_int_allow_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_allow_LDADD = $(integration_libs)

tests_integration_test_int_brief_SOURCES = tests/integration/test_int_brief.c
tests_integration_test_int_brief_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_brief_LDADD = $(integration_libs)

tests_integration_test_int_choice_SOURCES = tests/integration/test_int_choice.c
tests_integration_test_int_choice_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_choice_LDADD = $(integration_libs)

tests_integration_test_int_contract_SOURCES = tests/integration/test_int_contract.c
tests_integration_test_int_contract_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_contract_LDADD = $(integration_libs)

tests_integration_test_int_cut_SOURCES = tests/integration/test_int_cut.c
tests_integration_test_int_cut_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_cut_LDADD = $(integration_libs)

tests_integration_test_int_deadline_SOURCES = tests/integration/test_int_deadline.c
tests_integration_test_int_deadline_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_deadline_LDADD = $(integration_libs)

tests_integration_test_int_death_SOURCES = tests/integration/test_int_death.c
tests_integration_test_int_death_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_death_LDADD = $(integration_libs)

tests_integration_test_int_rounding_SOURCES = tests/integration/test_int_rounding.c
tests_integration_test_int_rounding_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_rounding_CFLAGS = $(AM_CFLAGS) $(OPENMP_CFLAGS) -pthread
tests_integration_test_int_rounding_LDADD = $(integration_libs)

tests_integration_test_int_direct_SOURCES = tests/integration/test_int_direct.c \
    tests/support/allocations.c
tests_integration_test_int_direct_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_direct_CFLAGS = $(AM_CFLAGS) -pthread
tests_integration_test_int_direct_LDADD = $(integration_libs)

tests_integration_test_int_expected_SOURCES = tests/integration/test_int_expected.c
tests_integration_test_int_expected_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_expected_LDADD = $(integration_libs)

# The programs that need no daemon, once more without one.
TESTS += tests/integration/direct_check.sh

# The sandbox, over what other Debians have.
TESTS += tests/integration/libuv_check.sh

tests_integration_test_int_autostart_SOURCES = tests/integration/test_int_autostart.c
tests_integration_test_int_autostart_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_autostart_LDADD = $(integration_libs)

tests_integration_test_int_batch_SOURCES = tests/integration/test_int_batch.c
tests_integration_test_int_batch_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_batch_LDADD = $(integration_libs)

tests_integration_test_int_boxes_SOURCES = tests/integration/test_int_boxes.c
tests_integration_test_int_boxes_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_boxes_LDADD = $(integration_libs)

tests_integration_test_int_filter_SOURCES = tests/integration/test_int_filter.c
tests_integration_test_int_filter_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_filter_LDADD = $(integration_libs)

tests_integration_test_int_flow_SOURCES = tests/integration/test_int_flow.c
tests_integration_test_int_flow_CPPFLAGS = $(integration_cppflags) $(XXHASH_CFLAGS)
tests_integration_test_int_flow_LDADD = $(integration_libs)

tests_integration_test_int_motions_SOURCES = tests/integration/test_int_motions.c
tests_integration_test_int_motions_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_motions_LDADD = $(integration_libs)

tests_integration_test_int_backlog_SOURCES = tests/integration/test_int_backlog.c
tests_integration_test_int_backlog_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_backlog_LDADD = $(integration_libs)

tests_integration_test_int_hostile_SOURCES = tests/integration/test_int_hostile.c
tests_integration_test_int_hostile_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_hostile_LDADD = $(integration_libs)

tests_integration_test_int_journal_SOURCES = tests/integration/test_int_journal.c
tests_integration_test_int_journal_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_journal_LDADD = $(integration_libs)

tests_integration_test_int_observe_SOURCES = tests/integration/test_int_observe.c
tests_integration_test_int_observe_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_observe_LDADD = $(integration_libs)

tests_integration_test_int_leave_SOURCES = tests/integration/test_int_leave.c
tests_integration_test_int_leave_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_leave_LDADD = $(integration_libs)

tests_integration_test_int_notify_SOURCES = tests/integration/test_int_notify.c
tests_integration_test_int_notify_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_notify_LDADD = $(integration_libs)

tests_integration_test_int_overdue_SOURCES = tests/integration/test_int_overdue.c
tests_integration_test_int_overdue_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_overdue_LDADD = $(integration_libs)
tests_integration_test_int_orphan_SOURCES = tests/integration/test_int_orphan.c
tests_integration_test_int_orphan_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_orphan_LDADD = $(integration_libs)

tests_integration_test_int_long_SOURCES = tests/integration/test_int_long.c
tests_integration_test_int_long_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_long_LDADD = $(integration_libs)

tests_integration_test_int_loss_SOURCES = tests/integration/test_int_loss.c
tests_integration_test_int_loss_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_loss_LDADD = $(integration_libs)

tests_integration_test_int_null_SOURCES = tests/integration/test_int_null.c
tests_integration_test_int_null_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_null_LDADD = $(integration_libs)
tests_integration_test_int_misuse_SOURCES = tests/integration/test_int_misuse.c
tests_integration_test_int_misuse_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_misuse_CFLAGS = $(AM_CFLAGS) -pthread
tests_integration_test_int_misuse_LDADD = $(integration_libs)

tests_integration_test_int_peer_SOURCES = tests/integration/test_int_peer.c
tests_integration_test_int_peer_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_peer_LDADD = $(integration_libs)

tests_integration_test_int_protocol_SOURCES = tests/integration/test_int_protocol.c
tests_integration_test_int_protocol_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_protocol_LDADD = $(integration_libs)

tests_integration_test_int_taken_SOURCES = tests/integration/test_int_taken.c
tests_integration_test_int_taken_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_taken_LDADD = $(integration_libs)
tests_integration_test_int_quota_SOURCES = tests/integration/test_int_quota.c
tests_integration_test_int_quota_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_quota_LDADD = $(integration_libs)

tests_integration_test_int_record_SOURCES = tests/integration/test_int_record.c
tests_integration_test_int_record_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_record_LDADD = $(integration_libs)

tests_integration_test_int_record_filter_SOURCES = tests/integration/test_int_record_filter.c
tests_integration_test_int_record_filter_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_record_filter_LDADD = $(integration_libs)

tests_integration_test_int_record_shared_SOURCES = tests/integration/test_int_record_shared.c
tests_integration_test_int_record_shared_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_record_shared_LDADD = $(integration_libs)

tests_integration_test_int_replace_SOURCES = tests/integration/test_int_replace.c
tests_integration_test_int_replace_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_replace_LDADD = $(integration_libs)

tests_integration_test_int_reconnect_SOURCES = \
    tests/integration/test_int_reconnect.c
tests_integration_test_int_reconnect_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_reconnect_LDADD = $(integration_libs)

tests_integration_test_int_restore_SOURCES = \
    tests/integration/test_int_restore.c
tests_integration_test_int_restore_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_restore_LDADD = $(integration_libs)
tests_integration_test_int_reply_SOURCES = tests/integration/test_int_reply.c
tests_integration_test_int_reply_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_reply_LDADD = $(integration_libs)

tests_integration_test_int_resume_SOURCES = tests/integration/test_int_resume.c
tests_integration_test_int_resume_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_resume_LDADD = $(integration_libs)

tests_integration_test_int_rivals_SOURCES = \
    tests/integration/test_int_rivals.c
tests_integration_test_int_rivals_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_rivals_CFLAGS = $(AM_CFLAGS) -pthread
tests_integration_test_int_rivals_LDADD = $(integration_libs)

tests_integration_test_int_room_SOURCES = tests/integration/test_int_room.c
tests_integration_test_int_room_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_room_LDADD = $(integration_libs)

tests_integration_test_int_sandbox_SOURCES = tests/integration/test_int_sandbox.c
tests_integration_test_int_sandbox_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_sandbox_LDADD = $(integration_libs)

tests_integration_test_int_session_SOURCES = tests/integration/test_int_session.c
tests_integration_test_int_session_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_session_LDADD = $(integration_libs)

tests_integration_test_int_step_SOURCES = tests/integration/test_int_step.c
tests_integration_test_int_step_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_step_LDADD = $(integration_libs)

tests_integration_test_int_supervise_SOURCES = tests/integration/test_int_supervise.c
tests_integration_test_int_supervise_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_supervise_LDADD = $(integration_libs)

tests_integration_test_int_free_SOURCES = tests/integration/test_int_free.c
tests_integration_test_int_free_CPPFLAGS = $(integration_cppflags) -I$(top_srcdir)/client/record
tests_integration_test_int_free_LDADD = $(integration_libs)

tests_integration_test_int_crossed_SOURCES = tests/integration/test_int_crossed.c
tests_integration_test_int_crossed_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_crossed_LDADD = $(integration_libs)

tests_integration_test_int_thick_SOURCES = tests/integration/test_int_thick.c
tests_integration_test_int_thick_CPPFLAGS = $(integration_cppflags) -I$(top_srcdir)/client/record
tests_integration_test_int_thick_LDADD = $(integration_libs)

tests_integration_test_int_threads_SOURCES = tests/integration/test_int_threads.c
tests_integration_test_int_threads_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_threads_LDADD = $(integration_libs)

tests_integration_test_int_broken_SOURCES = tests/integration/test_int_broken.c \
    tests/integration/forge.c
tests_integration_test_int_broken_CPPFLAGS = $(integration_cppflags) $(record_cppflags) \
    -iquote $(top_srcdir)/tests/integration
tests_integration_test_int_broken_LDADD = librecord.la $(integration_libs)

tests_integration_test_int_verify_SOURCES = tests/integration/test_int_verify.c
tests_integration_test_int_verify_CPPFLAGS = $(integration_cppflags) $(record_cppflags) $(XXHASH_CFLAGS)
tests_integration_test_int_verify_LDADD = librecord.la $(integration_libs)

tests_integration_test_int_verify_fields_SOURCES = \
    tests/integration/test_int_verify_fields.c \
    tests/integration/forge.c
tests_integration_test_int_verify_fields_CPPFLAGS = $(integration_cppflags) $(record_cppflags) \
    $(XXHASH_CFLAGS) -iquote $(top_srcdir)/tests/integration
tests_integration_test_int_verify_fields_LDADD = librecord.la $(integration_libs) $(LIBM)

tests_integration_test_int_verify_near_SOURCES = tests/integration/test_int_verify_near.c
tests_integration_test_int_verify_near_CPPFLAGS = $(integration_cppflags) $(record_cppflags) $(XXHASH_CFLAGS)
tests_integration_test_int_verify_near_LDADD = librecord.la $(integration_libs) $(LIBM)

tests_integration_test_int_version_SOURCES = tests/integration/test_int_version.c
tests_integration_test_int_version_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_version_LDADD = $(integration_libs)

tests_integration_test_int_warm_SOURCES = tests/integration/test_int_warm.c \
    tests/support/allocations.c
tests_integration_test_int_warm_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_warm_LDADD = $(integration_libs)

tests_integration_test_int_watch_SOURCES = tests/integration/test_int_watch.c
tests_integration_test_int_watch_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_watch_LDADD = $(integration_libs)

include $(top_srcdir)/tests/integration/ctl.mk

tests_integration_test_int_shared_SOURCES = tests/integration/test_int_shared.c
tests_integration_test_int_shared_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_shared_LDADD = $(integration_libs)

tests_integration_test_int_slot_SOURCES = tests/integration/test_int_slot.c
tests_integration_test_int_slot_CPPFLAGS = $(integration_cppflags)
tests_integration_test_int_slot_LDADD = $(integration_libs) -lpthread
