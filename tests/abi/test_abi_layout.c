/* test_abi_layout.c - what a compiled client relies on does not move. */
#include "cases.h"
#include "codec.h"
#include "messages.h"
#include "pccd.h"
#include "records.h"
#include "seqpacket.h"
#include "shm.h"

/* The test links nothing of ours, so the names come from the manifest. */
#define NAME(ID, name, since, flags, text) name,
static const char *const method_names[] = {PROTO_METHODS(NAME)};
#undef NAME

#define SIZE(type, bytes)         assert_int_equal(sizeof(struct type), bytes)
#define AT(type, member, bytes)   assert_int_equal(offsetof(struct type, member), bytes)
#define VALUE(constant, expected) assert_int_equal(constant, expected)

/* If this failed, a client would read the records of an answer wrongly. */
CASE(records__keep_their_layout)
{
    SIZE(pccd_scene_answer, 320);
    AT(pccd_scene_answer, scene, 0);
    AT(pccd_scene_answer, status, 4);
    AT(pccd_scene_answer, incomplete, 8);
    AT(pccd_scene_answer, verdict, 12);
    AT(pccd_scene_answer, number, 16);
    AT(pccd_scene_answer, total, 24);
    AT(pccd_scene_answer, counts, 32);
    AT(pccd_scene_answer, possible, 96);
    AT(pccd_scene_answer, initial, 104);
    AT(pccd_scene_answer, inside, 112);
    AT(pccd_scene_answer, toi_first, 120);
    AT(pccd_scene_answer, safe_step, 128);
    AT(pccd_scene_answer, hash, 136);
    AT(pccd_scene_answer, count, 152);
    AT(pccd_scene_answer, offset, 160);
    AT(pccd_scene_answer, ns_step, 168);
    AT(pccd_scene_answer, threads, 176);
    AT(pccd_scene_answer, crowded, 180);
    AT(pccd_scene_answer, why, 184);
    SIZE(pccd_contact, 64);
    AT(pccd_contact, kind, 0);
    AT(pccd_contact, flags, 4);
    AT(pccd_contact, object_a, 8);
    AT(pccd_contact, feature_a, 12);
    AT(pccd_contact, object_b, 16);
    AT(pccd_contact, feature_b, 20);
    AT(pccd_contact, toi, 24);
    AT(pccd_contact, toi_hi, 32);
    AT(pccd_contact, param, 40);
    AT(pccd_contact, normal, 48);
    AT(pccd_contact, reserved, 60);
    SIZE(pccd_near, 64);
    AT(pccd_near, kind, 0);
    AT(pccd_near, flags, 4);
    AT(pccd_near, object_a, 8);
    AT(pccd_near, feature_a, 12);
    AT(pccd_near, object_b, 16);
    AT(pccd_near, feature_b, 20);
    AT(pccd_near, d_lo, 24);
    AT(pccd_near, d_hi, 32);
    AT(pccd_near, param, 40);
    AT(pccd_near, direction, 48);
    AT(pccd_near, count, 60);
    SIZE(pccd_pair, 20);
    AT(pccd_pair, kind, 0);
    AT(pccd_pair, object_a, 4);
    AT(pccd_pair, feature_a, 8);
    AT(pccd_pair, object_b, 12);
    AT(pccd_pair, feature_b, 16);
    SIZE(pccd_trace_event, 32);
    AT(pccd_trace_event, begin_ns, 0);
    AT(pccd_trace_event, end_ns, 8);
    AT(pccd_trace_event, kind, 16);
    AT(pccd_trace_event, thread, 20);
    AT(pccd_trace_event, a, 24);
    AT(pccd_trace_event, b, 28);
    SIZE(pccd_edge, 8);
    AT(pccd_edge, a, 0);
    AT(pccd_edge, b, 4);
    SIZE(pccd_box, 48);
    AT(pccd_box, low0, 0);
    AT(pccd_box, high0, 12);
    AT(pccd_box, low1, 24);
    AT(pccd_box, high1, 36);
}

static void check_meshes(void)
{
    SIZE(pccd_weld_counts, 24);
    AT(pccd_weld_counts, joined, 0);
    AT(pccd_weld_counts, apart, 4);
    AT(pccd_weld_counts, more, 8);
    AT(pccd_weld_counts, more_distance, 16);
    SIZE(pccd_mesh_info, 48);
    AT(pccd_mesh_info, vertex_count, 0);
    AT(pccd_mesh_info, triangle_count, 4);
    AT(pccd_mesh_info, edge_count, 8);
    AT(pccd_mesh_info, duplicate_count, 12);
    AT(pccd_mesh_info, degenerate_count, 16);
    AT(pccd_mesh_info, isolated_count, 20);
    AT(pccd_mesh_info, generation, 24);
    AT(pccd_mesh_info, build_ns, 32);
    AT(pccd_mesh_info, free_edge_count, 40);
    AT(pccd_mesh_info, free_point_count, 44);
    SIZE(pccd_mesh_data, 72);
    AT(pccd_mesh_data, struct_bytes, 0);
    AT(pccd_mesh_data, x, 8);
    AT(pccd_mesh_data, format, 16);
    AT(pccd_mesh_data, vertex_count, 20);
    AT(pccd_mesh_data, triangle_count, 24);
    AT(pccd_mesh_data, triangles, 32);
    AT(pccd_mesh_data, radii, 40);
    AT(pccd_mesh_data, edges, 48);
    AT(pccd_mesh_data, points, 56);
    AT(pccd_mesh_data, edge_count, 64);
    AT(pccd_mesh_data, point_count, 68);
}

/* If this failed, a program linked against an older library would corrupt its memory. */
CASE(library__structs_keep_their_layout)
{
    check_meshes();
    SIZE(pccd_options, 96);
    AT(pccd_options, struct_bytes, 0);
    AT(pccd_options, url, 8);
    AT(pccd_options, daemon, 16);
    AT(pccd_options, name, 24);
    AT(pccd_options, timeout_ms, 32);
    AT(pccd_options, no_autostart, 36);
    AT(pccd_options, private_daemon, 37);
    AT(pccd_options, slot_count, 40);
    AT(pccd_options, slot_bytes, 48);
    AT(pccd_options, result_bytes, 56);
    AT(pccd_options, spin_us, 64);
    AT(pccd_options, reconnect_ms, 68);
    AT(pccd_options, no_keep, 72);
    AT(pccd_options, observes, 73);
    AT(pccd_options, daemons_max, 76);
    AT(pccd_options, unmap, 80);
    AT(pccd_options, unmap_context, 88);
    SIZE(pccd_link_info, 40);
    AT(pccd_link_info, gap_ns, 24);
    SIZE(pccd_trace_info, 24);
    AT(pccd_trace_info, threads, 0);
    AT(pccd_trace_info, events_max, 4);
    AT(pccd_trace_info, events, 8);
    AT(pccd_trace_info, lost, 16);
    SIZE(pccd_record_settings, 24);
    AT(pccd_record_settings, max_bytes, 0);
    AT(pccd_record_settings, segments, 8);
    AT(pccd_record_settings, contacts, 12);
    AT(pccd_record_settings, level, 16);
    AT(pccd_record_settings, up, 20);
    SIZE(pccd_record_info, 48);
    AT(pccd_record_info, frames, 16);
    AT(pccd_record_info, ns, 32);
    AT(pccd_record_info, segments, 40);
    AT(pccd_record_info, status, 44);
    SIZE(pccd_object_settings, 64);
    AT(pccd_object_settings, struct_bytes, 0);
    AT(pccd_object_settings, what, 8);
    AT(pccd_object_settings, self_collision, 12);
    AT(pccd_object_settings, group, 16);
    AT(pccd_object_settings, mask, 24);
    AT(pccd_object_settings, radius, 32);
    AT(pccd_object_settings, rest_distance, 40);
    AT(pccd_object_settings, rest_rings, 48);
    AT(pccd_object_settings, user_data, 56);
    SIZE(pccd_scene_settings, 16);
    AT(pccd_scene_settings, name, 0);
    AT(pccd_scene_settings, share, 8);
    AT(pccd_scene_settings, rights, 12);
    SIZE(pccd_scene_news, 40);
    AT(pccd_scene_news, number, 0);
    AT(pccd_scene_news, mode, 8);
    AT(pccd_scene_news, incomplete, 12);
    AT(pccd_scene_news, total, 16);
    AT(pccd_scene_news, hash, 24);
}

/* If this failed, a program would read what a daemon tells of itself at wrong places. */
CASE(daemon__structs_keep_their_layout)
{
    SIZE(pccd_daemon_info, 56);
    AT(pccd_daemon_info, pid, 16);
    AT(pccd_daemon_info, features, 32);
    AT(pccd_daemon_info, session, 48);
    AT(pccd_session_info, client, 8);
    AT(pccd_session_info, ns_open, 32);
    AT(pccd_session_info, triangles, 56);
    AT(pccd_session_info, steps, 80);
    AT(pccd_session_info, ns_step, 168);
    AT(pccd_session_info, batch, 176);
    AT(pccd_session_info, batch_done, 180);
    AT(pccd_scene_info, hash, 32);
    AT(pccd_scene_info, ns_step, 48);
    AT(pccd_object_info, triangles, 8);
    AT(pccd_registered_mesh, objects, 16);
    AT(pccd_registered_mesh, replacing, 25);
    AT(pccd_registered_mesh, edge_count, 28);
    AT(pccd_registered_mesh, point_count, 32);
    SIZE(pccd_histogram_info, 232);
    AT(pccd_histogram_info, bucket, 16);
    VALUE(PCCD_HISTOGRAM_STEPS, 0);
    VALUE(PCCD_HISTOGRAM_REQUESTS, 1);
    AT(pccd_setting, text, 16);
    AT(pccd_setting, changed, 24);
    SIZE(pccd_step_event, 96);
    AT(pccd_step_event, status, 20);
    AT(pccd_step_event, mode, 32);
    AT(pccd_step_event, total, 48);
    AT(pccd_step_event, lost, 88);
}

/* If this failed, a step would be computed or described in another way than asked for. */
CASE(step__structs_keep_their_layout)
{
    SIZE(pccd_motion, 48);
    AT(pccd_motion, object, 0);
    AT(pccd_motion, first, 4);
    AT(pccd_motion, count, 8);
    AT(pccd_motion, format, 12);
    AT(pccd_motion, x0, 16);
    AT(pccd_motion, x1, 24);
    AT(pccd_motion, m0, 32);
    AT(pccd_motion, m1, 40);
    SIZE(pccd_step_settings, 104);
    AT(pccd_step_settings, struct_bytes, 0);
    AT(pccd_step_settings, mode, 8);
    AT(pccd_step_settings, method, 12);
    AT(pccd_step_settings, threads, 16);
    AT(pccd_step_settings, tuning, 24);
    AT(pccd_step_settings, tolerance, 32);
    AT(pccd_step_settings, deadline_ns, 40);
    AT(pccd_step_settings, hold, 48);
    AT(pccd_step_settings, separation, 56);
    AT(pccd_step_settings, approach, 64);
    AT(pccd_step_settings, tells_start, 72);
    AT(pccd_step_settings, touching, 76);
    AT(pccd_step_settings, resolution, 80);
    AT(pccd_step_settings, joints, 88);
    AT(pccd_step_settings, joint_count, 96);
}

/* If this failed, a question about what is near would be another one. */
CASE(near__structs_keep_their_layout)
{
    SIZE(pccd_near_settings, 152);
    AT(pccd_near_settings, struct_bytes, 0);
    AT(pccd_near_settings, what, 8);
    AT(pccd_near_settings, distance, 16);
    AT(pccd_near_settings, gap, 24);
    AT(pccd_near_settings, at_begin, 32);
    AT(pccd_near_settings, object_a, 36);
    AT(pccd_near_settings, object_b, 40);
    AT(pccd_near_settings, threads, 44);
    AT(pccd_near_settings, deadline_ns, 48);
    AT(pccd_near_settings, method, 56);
    AT(pccd_near_settings, tuning, 60);
    AT(pccd_near_settings, reserved, 124);
    AT(pccd_near_settings, tells_crossings, 128);
    AT(pccd_near_settings, joints, 136);
    AT(pccd_near_settings, joint_count, 144);
}

/* If this failed, what a step took and did would be told of something else. */
CASE(counters__keep_their_layout)
{
    SIZE(pccd_step_times, 80);
    AT(pccd_step_times, queue, 0);
    AT(pccd_step_times, ingest, 8);
    AT(pccd_step_times, refit, 16);
    AT(pccd_step_times, traversal, 24);
    AT(pccd_step_times, tests, 32);
    AT(pccd_step_times, merge, 40);
    AT(pccd_step_times, step, 48);
    AT(pccd_step_times, low, 56);
    AT(pccd_step_times, high, 64);
    AT(pccd_step_times, rebuild, 72);
    SIZE(pccd_step_counters, 208);
    AT(pccd_step_counters, task_units, 0);
    AT(pccd_step_counters, box_tests, 8);
    AT(pccd_step_counters, leaf_pairs, 16);
    AT(pccd_step_counters, candidates, 24);
    AT(pccd_step_counters, survivors, 88);
    AT(pccd_step_counters, exact, 96);
    AT(pccd_step_counters, builds, 104);
    AT(pccd_step_counters, allocs, 112);
    AT(pccd_step_counters, rebuilds, 120);
    AT(pccd_step_counters, rebuilt_triangles, 128);
    AT(pccd_step_counters, swaps, 136);
    AT(pccd_step_counters, swapped_triangles, 144);
    AT(pccd_step_counters, still_features, 152);
    AT(pccd_step_counters, still_pairs, 160);
    AT(pccd_step_counters, kept_records, 168);
    AT(pccd_step_counters, rigid_objects, 176);
    AT(pccd_step_counters, thick_candidates, 184);
    AT(pccd_step_counters, thick_exact, 200);
}

/* If this failed, a batch would move other things than a program says, or its answers be
 * read at the wrong places. */
CASE(batch__keeps_its_layout)
{
    SIZE(pccd_batch_part, 24);
    AT(pccd_batch_part, scene, 0);
    AT(pccd_batch_part, object, 4);
    AT(pccd_batch_part, first, 8);
    AT(pccd_batch_part, count, 12);
    AT(pccd_batch_part, format, 16);
    AT(pccd_batch_part, way, 20);
    SIZE(pccd_batch_answer, 120);
    AT(pccd_batch_answer, struct_bytes, 0);
    AT(pccd_batch_answer, step, 8);
    AT(pccd_batch_answer, status, 16);
    AT(pccd_batch_answer, failed, 20);
    AT(pccd_batch_answer, incomplete, 24);
    AT(pccd_batch_answer, scenes, 32);
    AT(pccd_batch_answer, count, 40);
    AT(pccd_batch_answer, total, 48);
    AT(pccd_batch_answer, threads, 56);
    AT(pccd_batch_answer, queue_ns, 64);
    AT(pccd_batch_answer, batch_ns, 72);
    AT(pccd_batch_answer, steps_ns, 80);
    AT(pccd_batch_answer, mode, 88);
    AT(pccd_batch_answer, offset, 96);
    AT(pccd_batch_answer, reserved, 104);
}

/* If this failed, a program would read an answer's members at the wrong places. */
CASE(answer__keeps_its_layout)
{
    SIZE(pccd_answer, 688);
    AT(pccd_answer, struct_bytes, 0);
    AT(pccd_answer, step, 8);
    AT(pccd_answer, status, 16);
    AT(pccd_answer, mode, 20);
    AT(pccd_answer, method, 24);
    AT(pccd_answer, incomplete, 28);
    AT(pccd_answer, verdict, 32);
    AT(pccd_answer, contacts, 40);
    AT(pccd_answer, pairs, 48);
    AT(pccd_answer, count, 56);
    AT(pccd_answer, first, 64);
    AT(pccd_answer, cursor, 72);
    AT(pccd_answer, total, 80);
    AT(pccd_answer, counts, 88);
    AT(pccd_answer, possible, 152);
    AT(pccd_answer, initial, 160);
    AT(pccd_answer, toi_first, 168);
    AT(pccd_answer, hash, 176);
    AT(pccd_answer, number, 192);
    AT(pccd_answer, threads, 200);
    AT(pccd_answer, tuning, 204);
    AT(pccd_answer, times, 272);
    AT(pccd_answer, counters, 352);
    AT(pccd_answer, is_near, 560);
    AT(pccd_answer, what, 564);
    AT(pccd_answer, near, 568);
    AT(pccd_answer, vertex_bounds, 576);
    AT(pccd_answer, distance_min, 584);
    AT(pccd_answer, distance_max, 592);
    AT(pccd_answer, crossings, 600);
    AT(pccd_answer, reserved, 608);
    AT(pccd_answer, safe_step, 624);
    AT(pccd_answer, inside, 632);
    AT(pccd_answer, crowded, 640);
    AT(pccd_answer, start_inside, 648);
    AT(pccd_answer, coincident, 656);
    AT(pccd_answer, entering, 664);
    AT(pccd_answer, sliding, 672);
    AT(pccd_answer, leaving, 680);
    SIZE(pccd_frame, 32);
    AT(pccd_frame, client, 0);
    AT(pccd_frame, scene, 8);
    AT(pccd_frame, slot, 12);
    AT(pccd_frame, segment_count, 16);
    AT(pccd_frame, segment_max, 20);
    AT(pccd_frame, used_bytes, 24);
}

/* If this failed, client and daemon would look for the same word at different places. */
CASE(shared_memory__keeps_its_layout)
{
    SIZE(proto_shm_word, 128);
    AT(proto_shm_word, value, 0);
    SIZE(proto_shm_header, 128);
    AT(proto_shm_header, magic, 0);
    AT(proto_shm_header, version, 4);
    AT(proto_shm_header, header_bytes, 6);
    AT(proto_shm_header, size, 8);
    AT(proto_shm_header, slot_count, 16);
    AT(proto_shm_header, reserved, 20);
    AT(proto_shm_header, slot_stride, 24);
    AT(proto_shm_header, slot0_offset, 32);
    AT(proto_shm_header, epoch, 40);
    SIZE(proto_slot, 64);
    AT(proto_slot, seq, 0);
    AT(proto_slot, user, 8);
    SIZE(proto_upload, 4096);
    AT(proto_upload, header, 0);
    AT(proto_upload, head, 128);
    AT(proto_upload, tail, 256);
    AT(proto_upload, done_seq, 384);
    AT(proto_upload, client_wait, 512);
    AT(proto_upload, result_head, 640);
    AT(proto_upload, slots, 1024);
    SIZE(proto_segment, 32);
    AT(proto_segment, object, 0);
    AT(proto_segment, kind, 4);
    AT(proto_segment, format, 6);
    AT(proto_segment, first, 8);
    AT(proto_segment, count, 12);
    AT(proto_segment, offset0, 16);
    AT(proto_segment, offset1, 24);
    VALUE(PROTO_UPLOAD_MAGIC, 0x75636370);
    VALUE(PROTO_RESULT_MAGIC, 0x72636370);
    VALUE(PROTO_LAYOUT_VERSION, 1);
    VALUE(PROTO_RIGID_BYTES, 96);
    VALUE(PROTO_SEGMENT_X1, 0);
    VALUE(PROTO_SEGMENT_X0X1, 1);
    VALUE(PROTO_SEGMENT_RIGID, 2);
    VALUE(PROTO_SEGMENT_TURNING, 3);
    VALUE(PCCD_NO_JOINT, 4294967295);
    VALUE(PCCD_JOINT_FIXED, 0);
    VALUE(PCCD_JOINT_TURN, 1);
    VALUE(PCCD_JOINT_SLIDE, 2);
    VALUE(PCCD_JOINT_SHIFT, 3);
    VALUE(PCCD_JOINT_VECTOR, 4);
    SIZE(proto_joints, 8);
    SIZE(pccd_pose, 56);
    AT(pccd_pose, rotation, 24);
    SIZE(pccd_joint, 136);
    AT(pccd_joint, kind, 0);
    AT(pccd_joint, parent, 4);
    AT(pccd_joint, position, 8);
    AT(pccd_joint, rotation, 32);
    AT(pccd_joint, axis, 64);
    AT(pccd_joint, from, 88);
    AT(pccd_joint, to, 112);
}

/* If this failed, an old client would call an error by another's name. */
CASE(status__keeps_its_number)
{
    VALUE(PCCD_OK, 0);
    VALUE(PCCD_E_NOMEM, -1);
    VALUE(PCCD_E_INVAL, -2);
    VALUE(PCCD_E_QUOTA, -3);
    VALUE(PCCD_E_LIMIT, -4);
    VALUE(PCCD_E_BADMSG, -5);
    VALUE(PCCD_E_VERSION, -6);
    VALUE(PCCD_E_NOHELLO, -7);
    VALUE(PCCD_E_NOMETHOD, -8);
    VALUE(PCCD_E_HANDLE, -9);
    VALUE(PCCD_E_STATE, -10);
    VALUE(PCCD_E_BUSY, -11);
    VALUE(PCCD_E_SLOT_STALE, -12);
    VALUE(PCCD_E_SLOT_TORN, -13);
    VALUE(PCCD_E_SEGMENT, -14);
    VALUE(PCCD_E_NOTFINITE, -15);
    VALUE(PCCD_E_INDEX, -16);
    VALUE(PCCD_E_DISCONNECTED, -17);
    VALUE(PCCD_E_TIMEOUT, -18);
    VALUE(PCCD_E_NODAEMON, -19);
    VALUE(PCCD_E_SHUTDOWN, -20);
    VALUE(PCCD_E_CANCELLED, -21);
    VALUE(PCCD_E_SYSTEM, -22);
    VALUE(PCCD_E_AGAIN, -23);
    VALUE(PCCD_E_FORMAT, -24);
    VALUE(PCCD_E_INTERNAL, -25);
    VALUE(PCCD_E_ACCESS, -26);
}

/* If this failed, a mode, format or flag would mean something else to the other side. */
CASE(enums__keep_their_values)
{
    VALUE(PCCD_MODE_ALL, 0);
    VALUE(PCCD_MODE_FIRST, 1);
    VALUE(PCCD_MODE_ANY, 2);
    VALUE(PCCD_MODE_PAIRS, 3);
    VALUE(PCCD_MODE_FIRST_PER_PAIR, 4);
    VALUE(PCCD_METHOD_DEFAULT, 0);
    VALUE(PCCD_METHOD_PAPER, 1);
    VALUE(PCCD_METHOD_WIDE, 2);
    VALUE(PCCD_OBJECT_GROUP, 1);
    VALUE(PCCD_OBJECT_MASK, 2);
    VALUE(PCCD_OBJECT_SELF, 4);
    VALUE(PCCD_OBJECT_RADIUS, 8);
    VALUE(PCCD_OBJECT_REST_DISTANCE, 16);
    VALUE(PCCD_OBJECT_REST_RINGS, 32);
    VALUE(PCCD_OBJECT_USER_DATA, 64);
    VALUE(PCCD_OBJECT_ALL, 0x7fffffff);
    VALUE(PCCD_KINDS_MAX, 8);
    VALUE(PCCD_FORMAT_F32, 0);
    VALUE(PCCD_FORMAT_F64, 1);
    VALUE(PCCD_VF, 0);
    VALUE(PCCD_EE, 1);
    VALUE(PCCD_VE, 2);
    VALUE(PCCD_VV, 3);
    VALUE(PCCD_EF, 4);
    VALUE(PCCD_NEAR_PAIRS, 0);
    VALUE(PCCD_NEAR_FEATURES, 1);
    VALUE(PCCD_NEAR_VERTICES, 2);
    VALUE(PCCD_NEAR_NEAREST, 3);
    VALUE(PCCD_NEAR_CROSSINGS, 4);
    VALUE(PCCD_NEAR_DEPTH, 5);
    VALUE(PCCD_NEAR_GAP, 4);
    VALUE(PCCD_NEAR_TYPE(0xabcd02ff), 0x02);
    VALUE(PCCD_PROVED, 1);
    VALUE(PCCD_INITIAL, 2);
    VALUE(PCCD_COMPLETE, 0);
    VALUE(PCCD_INCOMPLETE_RESULT_FULL, 1);
    VALUE(PCCD_INCOMPLETE_DEADLINE, 2);
    VALUE(PCCD_INCOMPLETE_CANCELLED, 3);
    VALUE(PCCD_INCOMPLETE_CONTACT_LIMIT, 4);
    VALUE(PCCD_INCOMPLETE_UNDECIDED, 5);
    VALUE(PCCD_VERDICT_NO, 0);
    VALUE(PCCD_VERDICT_POSSIBLE, 1);
    VALUE(PCCD_VERDICT_YES, 2);
    VALUE(PCCD_VERDICT_NONE, 3);
    VALUE(PROTO_REQUEST, 0);
    VALUE(PROTO_RESPONSE, 1);
    VALUE(PROTO_NOTIFICATION, 2);
}

/* If this failed, a recording would name requests and work by others' names. */
CASE(recordings__keep_their_numbers)
{
    static const char *const methods[] = {
        "hello",         "ping",         "shm.attach",      "scene.create",
        "scene.destroy", "mesh.create",  "mesh.data",       "mesh.commit",
        "mesh.edges",    "mesh.destroy", "scene.add",       "scene.remove",
        "frame.submit",  "frame.fetch",  "cancel",          "stats",
        "mesh.replace",  "stats.thread", "trace.start",     "trace.stop",
        "trace.dump",    "bye",          "list.session",    "list.scene",
        "list.object",   "list.mesh",    "stats.histogram", "config.get",
        "config.set",    "watch.start",  "watch.stop",      "object.set",
        "scene.ignore",  "scene.boxes",  "scene.journal",   "list.pair",
        "shm.take",      "scene.near",   "near.fetch",      "batch.submit",
    };
    for (int i = 0; i < PROTO_METHOD_COUNT; i++) {
        assert_true((size_t)i < sizeof methods / sizeof methods[0]);
        assert_string_equal(method_names[i], methods[i]);
    }
    VALUE(PCCD_TREE_VERTICES, 0);
    VALUE(PCCD_TREE_EDGES, 1);
    VALUE(PCCD_TREE_FACES, 2);
    VALUE(PCCD_TREE_TRIANGLES, 3);
    VALUE(PCCD_TRACE_STEP, 0);
    VALUE(PCCD_TRACE_REFIT, 1);
    VALUE(PCCD_TRACE_UNIT, 2);
    VALUE(PCCD_TRACE_SUBTREE, 3);
    VALUE(PCCD_TRACE_PAIRS, 4);
    VALUE(PCCD_TRACE_HIGH, 5);
    VALUE(PCCD_TRACE_TESTS, 6);
    VALUE(PCCD_TRACE_REBUILD, 7);
    VALUE(PCCD_TRACE_BACKGROUND, 8);
    VALUE(PCCD_TRACE_WAIT, 9);
    VALUE(PCCD_TRACE_MERGE, 10);
    VALUE(PCCD_TRACE_REQUEST, 11);
    VALUE(PCCD_TRACE_RECEIVE, 12);
    VALUE(PCCD_TRACE_ANSWER, 13);
}

/* If this failed, peers of one protocol version would keep different limits. */
CASE(limits__of_version_1_stay)
{
    VALUE(PROTO_VERSION_MIN, 1);
    VALUE(PROTO_VERSION_MAX, 1);
    VALUE(PROTO_MESSAGE_BYTES_MAX, 65536);
    VALUE(PROTO_DEPTH_MAX, 16);
    VALUE(PROTO_ELEMENTS_MAX, 4096);
    VALUE(PROTO_STR_MAX, 255);
    VALUE(PROTO_SLOTS_MAX, 16);
    VALUE(PROTO_INFLIGHT_MAX, 16);
    VALUE(PROTO_SEGMENTS_MAX, 65536);
    VALUE(PROTO_SLOT_BYTES_MIN, 4096);
    VALUE(PROTO_RESULT_BYTES_MIN, 65536);
    VALUE(PROTO_COUNT_MAX, 2147483647);
    VALUE(PROTO_FDS_MAX, 2);
    VALUE(PROTO_TRACE_EVENTS_MAX, 1048576);
}
