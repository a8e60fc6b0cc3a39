/* records.h - checks, when it is compiled, that the layout of the public records has
 * not changed.
 */
#ifndef PROTO_RECORDS_H
#define PROTO_RECORDS_H

#include <assert.h>
#include <stddef.h>

#include "pccd_trace.h"
#include "pccd_types.h"

static_assert(sizeof(struct pccd_contact) == 64, "a contact is one cache line");
static_assert(offsetof(struct pccd_contact, flags) == 4, "contact.flags");
static_assert(offsetof(struct pccd_contact, object_a) == 8, "contact.object_a");
static_assert(offsetof(struct pccd_contact, feature_a) == 12, "contact.feature_a");
static_assert(offsetof(struct pccd_contact, object_b) == 16, "contact.object_b");
static_assert(offsetof(struct pccd_contact, feature_b) == 20, "contact.feature_b");
static_assert(offsetof(struct pccd_contact, toi) == 24, "contact.toi");
static_assert(offsetof(struct pccd_contact, toi_hi) == 32, "contact.toi_hi");
static_assert(offsetof(struct pccd_contact, param) == 40, "contact.param");
static_assert(offsetof(struct pccd_contact, normal) == 48, "contact.normal");
static_assert(offsetof(struct pccd_contact, reserved) == 60, "contact.reserved");
static_assert(sizeof(struct pccd_near) == 64, "a record of what is near has 64 bytes");
static_assert(offsetof(struct pccd_near, flags) == 4, "near.flags");
static_assert(offsetof(struct pccd_near, object_a) == 8, "near.object_a");
static_assert(offsetof(struct pccd_near, feature_a) == 12, "near.feature_a");
static_assert(offsetof(struct pccd_near, object_b) == 16, "near.object_b");
static_assert(offsetof(struct pccd_near, feature_b) == 20, "near.feature_b");
static_assert(offsetof(struct pccd_near, d_lo) == 24, "near.d_lo");
static_assert(offsetof(struct pccd_near, d_hi) == 32, "near.d_hi");
static_assert(offsetof(struct pccd_near, param) == 40, "near.param");
static_assert(offsetof(struct pccd_near, direction) == 48, "near.direction");
static_assert(offsetof(struct pccd_near, count) == 60, "near.count");
static_assert(sizeof(struct pccd_pair) == 20, "a pair has 20 bytes");
static_assert(sizeof(struct pccd_scene_answer) == 320, "five cache lines");
static_assert(offsetof(struct pccd_scene_answer, number) == 16, "scene.number");
static_assert(offsetof(struct pccd_scene_answer, total) == 24, "scene.total");
static_assert(offsetof(struct pccd_scene_answer, counts) == 32, "scene.counts");
static_assert(offsetof(struct pccd_scene_answer, possible) == 96, "scene.possible");
static_assert(offsetof(struct pccd_scene_answer, toi_first) == 120, "scene.toi_first");
static_assert(offsetof(struct pccd_scene_answer, safe_step) == 128, "scene.safe_step");
static_assert(offsetof(struct pccd_scene_answer, hash) == 136, "scene.hash");
static_assert(offsetof(struct pccd_scene_answer, count) == 152, "scene.count");
static_assert(offsetof(struct pccd_scene_answer, offset) == 160, "scene.offset");
static_assert(offsetof(struct pccd_scene_answer, ns_step) == 168, "scene.ns_step");
static_assert(offsetof(struct pccd_scene_answer, threads) == 176, "scene.threads");
static_assert(offsetof(struct pccd_scene_answer, why) == 184, "scene.why");
static_assert(sizeof(struct pccd_trace_event) == 32, "an event has 32 bytes");
static_assert(offsetof(struct pccd_trace_event, kind) == 16, "event.kind");
static_assert(sizeof(struct pccd_edge) == 8, "an edge has 8 bytes");
static_assert(sizeof(struct pccd_box) == 48, "a box has 48 bytes");
static_assert(offsetof(struct pccd_box, low0) == 0, "box.low0");
static_assert(offsetof(struct pccd_box, high0) == 12, "box.high0");
static_assert(offsetof(struct pccd_box, low1) == 24, "box.low1");
static_assert(offsetof(struct pccd_box, high1) == 36, "box.high1");

#endif
