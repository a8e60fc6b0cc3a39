/* wire.h - the engine's terms in the wire's terms.
 *
 * Room:     service. May include: the engine's and the protocol's headers.
 * Does:     assert that both rooms mean the same bytes and numbers; map the statuses.
 * Threads:  [any].
 */
#ifndef SRV_WIRE_H
#define SRV_WIRE_H

#include <assert.h>
#include <stddef.h>

#include "levels.h"
#include "mesh.h"
#include "pccd_types.h"
#include "records.h"
#include "shm.h"
#include "status.h"
#include "step.h"
#include "trace.h"

/* Records are copied to the result region as they are. */
#define SRV_SAME(eng, wire, member)                                                      \
    static_assert(offsetof(struct eng, member) == offsetof(struct wire, member) &&       \
                      sizeof(((struct eng *)0)->member) ==                               \
                          sizeof(((struct wire *)0)->member),                            \
                  #eng "." #member)

static_assert(sizeof(struct eng_contact) == sizeof(struct pccd_contact), "contact");
SRV_SAME(eng_contact, pccd_contact, kind);
SRV_SAME(eng_contact, pccd_contact, flags);
SRV_SAME(eng_contact, pccd_contact, object_a);
SRV_SAME(eng_contact, pccd_contact, feature_a);
SRV_SAME(eng_contact, pccd_contact, object_b);
SRV_SAME(eng_contact, pccd_contact, feature_b);
SRV_SAME(eng_contact, pccd_contact, toi);
SRV_SAME(eng_contact, pccd_contact, toi_hi);
SRV_SAME(eng_contact, pccd_contact, param);
SRV_SAME(eng_contact, pccd_contact, normal);
SRV_SAME(eng_contact, pccd_contact, reserved);
static_assert(sizeof(struct eng_pair) == sizeof(struct pccd_pair), "pair");
SRV_SAME(eng_pair, pccd_pair, kind);
SRV_SAME(eng_pair, pccd_pair, object_a);
SRV_SAME(eng_pair, pccd_pair, feature_a);
SRV_SAME(eng_pair, pccd_pair, object_b);
SRV_SAME(eng_pair, pccd_pair, feature_b);
static_assert(sizeof(struct eng_trace_event) == sizeof(struct pccd_trace_event), "event");
SRV_SAME(eng_trace_event, pccd_trace_event, begin_ns);
SRV_SAME(eng_trace_event, pccd_trace_event, end_ns);
SRV_SAME(eng_trace_event, pccd_trace_event, kind);
SRV_SAME(eng_trace_event, pccd_trace_event, thread);
SRV_SAME(eng_trace_event, pccd_trace_event, a);
SRV_SAME(eng_trace_event, pccd_trace_event, b);
static_assert(sizeof(struct pccd_edge) == sizeof(uint32_t[2]), "edge");
static_assert(sizeof(struct eng_level_box) == sizeof(struct pccd_box), "box");
SRV_SAME(eng_level_box, pccd_box, low0);
SRV_SAME(eng_level_box, pccd_box, high0);
SRV_SAME(eng_level_box, pccd_box, low1);
SRV_SAME(eng_level_box, pccd_box, high1);
#undef SRV_SAME

#define SRV_EQUAL(eng, wire) static_assert((int)(eng) == (int)(wire), #eng)
SRV_EQUAL(ENG_MODE_ALL, PCCD_MODE_ALL);
SRV_EQUAL(ENG_MODE_FIRST, PCCD_MODE_FIRST);
SRV_EQUAL(ENG_MODE_ANY, PCCD_MODE_ANY);
SRV_EQUAL(ENG_MODE_PAIRS, PCCD_MODE_PAIRS);
SRV_EQUAL(ENG_METHOD_DEFAULT, PCCD_METHOD_DEFAULT);
SRV_EQUAL(ENG_METHOD_PAPER, PCCD_METHOD_PAPER);
SRV_EQUAL(ENG_METHOD_WIDE, PCCD_METHOD_WIDE);
/* The wire's 0 is the default, so the choices are one more there. */
SRV_EQUAL(ENG_SCHEDULER_STEAL + 1, PCCD_SCHEDULER_STEAL);
SRV_EQUAL(ENG_SCHEDULER_PAPER + 1, PCCD_SCHEDULER_PAPER);
SRV_EQUAL(ENG_HIGH_ROUND_ROBIN + 1, PCCD_HIGH_LEVEL_ROUND_ROBIN);
SRV_EQUAL(ENG_HIGH_DISJOINT + 1, PCCD_HIGH_LEVEL_DISJOINT);
SRV_EQUAL(ENG_REFIT_EVEN + 1, PCCD_REFIT_EVEN);
SRV_EQUAL(ENG_REFIT_PAPER + 1, PCCD_REFIT_PAPER);
SRV_EQUAL(ENG_QUALITY_MEDIAN + 1, PCCD_QUALITY_MEDIAN);
SRV_EQUAL(ENG_QUALITY_SAH + 1, PCCD_QUALITY_SAH);
SRV_EQUAL(ENG_TREE_VERTICES, PCCD_TREE_VERTICES);
SRV_EQUAL(ENG_TREE_EDGES, PCCD_TREE_EDGES);
SRV_EQUAL(ENG_TREE_FACES, PCCD_TREE_FACES);
SRV_EQUAL(ENG_TREE_TRIANGLES, PCCD_TREE_TRIANGLES);
SRV_EQUAL(ENG_TREES, PCCD_TREE_COUNT);
SRV_EQUAL(ENG_TRACE_STEP, PCCD_TRACE_STEP);
SRV_EQUAL(ENG_TRACE_REFIT, PCCD_TRACE_REFIT);
SRV_EQUAL(ENG_TRACE_UNIT, PCCD_TRACE_UNIT);
SRV_EQUAL(ENG_TRACE_SUBTREE, PCCD_TRACE_SUBTREE);
SRV_EQUAL(ENG_TRACE_PAIRS, PCCD_TRACE_PAIRS);
SRV_EQUAL(ENG_TRACE_HIGH, PCCD_TRACE_HIGH);
SRV_EQUAL(ENG_TRACE_TESTS, PCCD_TRACE_TESTS);
SRV_EQUAL(ENG_TRACE_REBUILD, PCCD_TRACE_REBUILD);
SRV_EQUAL(ENG_TRACE_ASIDE, PCCD_TRACE_ASIDE);
SRV_EQUAL(ENG_TRACE_WAIT, PCCD_TRACE_WAIT);
SRV_EQUAL(ENG_TRACE_MERGE, PCCD_TRACE_MERGE);
SRV_EQUAL(ENG_TRACE_KINDS, PCCD_TRACE_REQUEST);
SRV_EQUAL(ENG_VF, PCCD_VF);
SRV_EQUAL(ENG_EE, PCCD_EE);
SRV_EQUAL(ENG_PROVED, PCCD_PROVED);
SRV_EQUAL(ENG_INITIAL, PCCD_INITIAL);
SRV_EQUAL(ENG_VERDICT_NO, PCCD_VERDICT_NO);
SRV_EQUAL(ENG_VERDICT_POSSIBLE, PCCD_VERDICT_POSSIBLE);
SRV_EQUAL(ENG_VERDICT_YES, PCCD_VERDICT_YES);
SRV_EQUAL(ENG_VERDICT_NONE, PCCD_VERDICT_NONE);
SRV_EQUAL(ENG_COMPLETE, PCCD_COMPLETE);
SRV_EQUAL(ENG_INCOMPLETE_DEADLINE, PCCD_INCOMPLETE_DEADLINE);
SRV_EQUAL(ENG_INCOMPLETE_CANCELLED, PCCD_INCOMPLETE_CANCELLED);
SRV_EQUAL(ENG_INCOMPLETE_CONTACT_LIMIT, PCCD_INCOMPLETE_CONTACT_LIMIT);
SRV_EQUAL(ENG_F32, PCCD_FORMAT_F32);
SRV_EQUAL(ENG_F64, PCCD_FORMAT_F64);
static_assert(ENG_COUNT_MAX == PROTO_COUNT_MAX, "counts");
#undef SRV_EQUAL

/* Bytes of one vertex in a slot; `format` was checked. */
static inline uint64_t srv_vertex_bytes(uint32_t format)
{
    return format == PCCD_FORMAT_F64 ? 3 * sizeof(double) : 3 * sizeof(float);
}

/* What an engine status is called on the wire. */
int srv_wire_status(int engine_status);

#endif
